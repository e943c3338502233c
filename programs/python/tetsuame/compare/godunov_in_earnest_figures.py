"""The figures of the comparison of Godunov DISPH in earnest."""
import numpy as np

from .. import style
from .outcomes import COMPLETED, Outcome

CAPTIONS = {
    "tube": "Errors over how fast the terms of varying supports fade with the pair's jump of pressure: 0 is <i>number</i>, the terms throughout. "
            "Left: Sod's tube, dashed: GSPH. Right: the square of equal masses, change of its area and radius of its corners.",
    "sedov": "Velocity along the radius of every particle over that of the gas behind the shock; line: exact.",
    "overturn": "Iron (red) and silicate (blue) at the end. With terms that fade Godunov DISPH looks the same.",
    "impact": "Iron (red) and granite (blue): above, when the shocks are in the cores; below, at the end."}
SHOWN = ("ssph, α = 0.5", "ssph, α = 1", "ssph, α = 3", "disph, α = 1", "gsph", "gdisph")


def colour(variant: str) -> str:
    scheme = variant.partition(",")[0]
    return style.SCHEME[scheme][1] if scheme in style.SCHEME else style.COLOUR["rti"]


def radial(snapshot) -> dict[str, np.ndarray]:
    """About the origin."""
    x = snapshot["Coordinates"]
    r = np.linalg.norm(x, axis=1)
    along = x / np.maximum(r, 1e-300)[:, None]
    return {"r": r, "rho": snapshot["Density"], "v": (snapshot["Velocities"] * along).sum(axis=1),
            "v_exact": (snapshot["VelocitiesReference"] * along).sum(axis=1)}


def asymmetry(outcome: Outcome) -> float:
    """Of the impact at the end: rms distance of a particle from the mirror image of that which began as its mirror image, in spacings."""
    snapshot, n, radius = outcome.snapshot, outcome.case.n, outcome.setting("expert.radius")
    edge = snapshot.lengths[0]
    at = (np.arange(n) + 0.5) * edge / n - 0.5 * edge
    held = np.hypot(np.abs(at)[None, :] - radius, at[:, None]) < radius  # [y, x]: particles are numbered along x first
    number = np.full(held.shape, -1)
    number[held] = np.arange(held.sum())
    order = np.argsort(snapshot["ParticleIDs"])
    x = snapshot["Coordinates"][order]
    image = x[number[:, ::-1][held]] * (-1, 1) + (edge, 0)
    off = x - image
    off -= snapshot.lengths * np.round(off / snapshot.lengths)
    return float(np.sqrt((off**2).sum(axis=1).mean()) / (edge / n))


def draw(case: str, outcomes: list[Outcome], runs: list[dict]):
    done = [o for o in outcomes if o.case.file == case and o.kind == COMPLETED and o.snapshot is not None]
    if not done or case not in CAPTIONS:
        return None
    return {"tube": lambda: trade(runs), "sedov": lambda: explosion(done), "overturn": lambda: places(done, [-1]),
            "impact": lambda: places(done, [4, -1])}[case]()


def fading_of(variant: str) -> float | None:
    word = variant.partition(", ")[2]
    return 0.0 if word == "number" else float(word.split()[1]) if word.startswith("fading") else None


def trade(runs: list[dict]):
    figure, (left, right) = style.panels(2, 2, 3.2)
    curves = {case: sorted(((fading_of(one["variant"]), one) for one in runs if one["case"] == case and one["outcome"] == COMPLETED
                            and fading_of(one["variant"]) is not None), key=lambda pair: pair[0]) for case in ("tube", "square")}
    left.plot([k for k, _ in curves["tube"]], [one["density_l1"] for _, one in curves["tube"]], "o-", color=colour("gdisph"), label="Godunov DISPH")
    for one in runs:
        if one["case"] == "tube" and one["variant"] == "gsph" and one.get("density_l1"):
            left.axhline(one["density_l1"], color=colour("gsph"), linestyle="--", linewidth=1, label="GSPH")
    left.set_ylabel("Sod: L1 error of ρ")
    for key, label, look in (("area_change", "change of area", "o-"), ("corner_radius", "corner radius/edge", "s--")):
        right.plot([k for k, _ in curves["square"]], [abs(one[key]) for _, one in curves["square"]], look, color=colour("gdisph"), label=label)
    right.axhline(0.01, color=style.GREY, linestyle=":", linewidth=1)
    right.set(ylabel="square of equal masses", yscale="log")
    for ax in (left, right):
        ax.set_xscale("symlog", linthresh=1.0)
        ax.set_xlim(-0.1, 1500.0)
        ax.set_xlabel("fading")
        ax.legend(fontsize=8)
    return figure


def explosion(done: list[Outcome]):
    shown = [o for o in done if o.case.variant in SHOWN]
    if not shown:
        return None
    figure, axes = style.panels(len(shown), 3, 2.3, "v", sharex=True, sharey=True)
    for ax, o in zip(axes, shown):
        state = radial(o.snapshot)
        exact = o.number("metrics", "shock_radius_exact")
        speed = 0.75 * 0.4 * exact / o.number("time")
        near = np.argsort(state["r"])
        ax.plot(state["r"] / exact, state["v"] / speed, ".", markersize=1.5, color=colour(o.case.variant))
        ax.plot(state["r"][near] / exact, state["v_exact"][near] / speed, color=style.INK, linewidth=1)
        ax.set(title=o.case.variant, xlim=(0, 1.4), ylim=(-0.5, 1.5))
    for ax in axes[-3:]:
        ax.set_xlabel("r over the shock's")
    return figure


def places(done: list[Outcome], which: list[int]):
    """Every particle, a row for each of these snapshots."""
    done = [o for o in done if "fading" not in o.case.variant and o.case.variant != "rti"]
    figure, axes = style.plt.subplots(len(which), max(len(done), 1), figsize=(style.WIDTH, 1.9 * len(which)), squeeze=False)
    for k, index in enumerate(which):
        for ax, o in zip(axes[k], done):
            snapshot = o.snapshots[min(index, len(o.snapshots) - 1)]
            x, iron = snapshot["Coordinates"], snapshot["Material"] == 1
            for of, shade in ((~iron, style.LIGHT), (iron, style.DENSE)):
                ax.plot(*x[of].T, ".", markersize=1.2, color=shade)
            style.as_map(ax, (0, snapshot.lengths[0]), (0, snapshot.lengths[1]))
            ax.set(xticks=[], yticks=[])
            ax.set_title(f"{o.case.variant}, {snapshot.time:.3g} s", fontsize=6.5)
    return figure
