"""The figures of the comparison of schemes on contacts and shocks."""
import numpy as np

from ... import plots, style
from ..results import fluid, last_snapshot, resolved
from ..runner import COMPLETED, Outcome

ORDER = tuple(style.SCHEME)
MAPS = ("square", "square_equal_mass", "kelvin_helmholtz")   # shown from above; the others over x or the radius
ROUND = {"gresho"}                                           # the velocity shown is that around the centre


def judged_by(test: str) -> str:
    """The error that a test is judged by: of a vortex of even density the velocity's."""
    return "velocity_l1" if test in ROUND else "density_l1"


def chosen(outcomes: list[Outcome], test: str) -> list[Outcome]:
    """Of each scheme the completed run with the most particles."""
    done = [o for o in outcomes if o.case.file == test and o.kind == COMPLETED]
    by_scheme = ([o for o in done if o.case.variant == name] for name in ORDER)
    return [max(runs, key=lambda o: o.case.n) for runs in by_scheme if runs]


def caption(outcomes: list[Outcome], test: str) -> str:
    n = ", ".join(sorted({str(o.case.n) for o in chosen(outcomes, test)}))
    if test in MAPS:
        return f"Density at the end, n = {n}; the colours of all panels are the same."
    exact = "line: a run of GSPH with twice the particles." if test == "blasts" else "line: the exact solution."
    return f"Every particle at the end, n = {n}; {exact}"


def state(outcomes: list[Outcome], test: str):
    if test in MAPS:
        return maps([(o, snapshot) for o in chosen(outcomes, test) if (snapshot := last_snapshot(o.folder)) is not None])
    runs = [(o, fields) for o in chosen(outcomes, test) if (fields := fluid(o.folder)) is not None]
    if not runs:
        return None
    fine = next((fluid(o.folder) for o in outcomes if o.case.file == test and o.case.variant == "reference" and o.kind == COMPLETED), None)
    return scatter(runs, fine, test)


def maps(runs):
    if not runs:
        return None
    every = np.concatenate([snapshot["Density"] for _, snapshot in runs])
    low, high = np.quantile(every, [0.005, 0.995])
    if high - low < 1e-6 * high:
        low, high = 0.9 * low, 1.1 * high
    figure, axes = style.map_panels(len(runs), 1.0, 4, bars=False)
    for ax, (o, snapshot) in zip(axes, runs):
        image = plots.draw_map(ax, snapshot.map("Density"), "Density", "", (low, high), length="", bar=False)
        ax.set_title(style.SCHEME[o.case.variant][0])
        ax.set(xticks=[], yticks=[], xlabel="", ylabel="")
    style.colour_bar(figure, image, axes, "density", shrink=0.8, aspect=22)
    return figure


def along(fields: dict, centre: np.ndarray | None, swirl: bool, velocities: str = "Velocities") -> tuple[np.ndarray, np.ndarray]:
    """Place (x, or the distance from the centre) and the velocity along it (or around the centre)."""
    x, v = fields["Coordinates"], fields[velocities]
    if centre is None:
        return x[:, 0], v[:, 0]
    from_centre = x - centre
    r = np.sqrt((from_centre**2).sum(axis=1))
    unit = from_centre / np.maximum(r, 1e-300)[:, None]
    if swirl:
        return r, unit[:, 0] * v[:, 1] - unit[:, 1] * v[:, 0]
    return r, (unit * v).sum(axis=1)


def scatter(runs, fine, test: str):
    figure, axes = style.panels(3 * len(runs), len(runs), 1.95, sharex=True, sharey="row")
    for column, (o, fields) in enumerate(runs):
        dimension = int(resolved(o.folder, "domain", "dimension"))
        centre = None
        if dimension > 1:
            centre = np.array([resolved(o.folder, "domain", f"length_{a}") / 2 if k < dimension else 0.0 for k, a in enumerate("xyz")])
        place, v = along(fields, centre, test in ROUND)
        label, colour = style.SCHEME[o.case.variant]
        panels = [axes[column + row * len(runs)] for row in range(3)]
        for ax, values in zip(panels, (fields["Density"], v, fields["Pressure"])):
            ax.plot(place, values, ".", color=colour, markersize=3.2 if dimension == 1 else 1.8, markeredgewidth=0, rasterized=True)
        right = fields if "DensityReference" in fields else None
        if right is not None:
            _, v_right = along(fields, centre, test in ROUND, "VelocitiesReference")
            lines = (place, right["DensityReference"], v_right, right["PressureReference"])
        elif fine is not None:
            there, v_there = along(fine, centre, test in ROUND)
            lines = (there, fine["Density"], v_there, fine["Pressure"])
        else:
            lines = None
        if lines is not None:
            order = np.argsort(lines[0])
            for ax, values in zip(panels, lines[1:]):
                ax.plot(lines[0][order], values[order], color=style.INK, linewidth=0.9, zorder=4)
        panels[0].set_title(label)
        panels[2].set_xlabel("x" if centre is None else "distance from the centre")
        if centre is not None:
            panels[0].set_xlim(0, centre[0])
        if column == 0:
            for ax, name in zip(panels, ("density", "velocity around" if test in ROUND else "velocity", "pressure")):
                ax.set_ylabel(name)
    for row in range(3):
        frame(axes[row * len(runs):(row + 1) * len(runs)])
    figure.align_ylabels()
    return figure


def frame(row) -> None:
    """Single particles far off must not press all others flat: the frame holds the lines and all but a hundredth of each panel's
    particles, as far as these are not off by more than the lines' own height; what is outside is counted."""
    particles = [line.get_ydata() for ax in row for line in ax.lines if line.get_marker() == "."]
    lines = [line.get_ydata() for ax in row for line in ax.lines if line.get_marker() != "."]
    low, high = min(np.quantile(values, 0.005) for values in particles), max(np.quantile(values, 0.995) for values in particles)
    if lines:
        least, most = min(values.min() for values in lines), max(values.max() for values in lines)
        far = (most - least) or np.inf
        low, high = min(least, max(low, least - far)), max(most, min(high, most + far))
    margin = 0.08 * (high - low) or 0.05 * abs(high) or 1.0
    for ax in row:
        ax.set_ylim(low - margin, high + margin)
        values = ax.lines[0].get_ydata()
        outside = int(((values < low - margin) | (values > high + margin)).sum())
        if outside:
            ax.text(0.98, 0.96, f"{outside} outside", transform=ax.transAxes, ha="right", va="top", fontsize=7.5, color=style.GREY)
