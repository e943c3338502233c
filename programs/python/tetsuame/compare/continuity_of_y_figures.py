"""What is read of the snapshots of a contact, and its figures; a square of density 4 in 1, drawn as Saitoh and Makino draw it."""
import numpy as np

from .. import runs, style
from .outcomes import COMPLETED, Outcome

NEAR = 4.0  # spacings of the box's lattice: a little more than the kernel reaches
FRAME = 0.3  # of p/p at rest - 1
RED, BLUE = style.DENSE, style.LIGHT
SNAPSHOTS = (0.1, 0.3, 0.5, 1.0, 8.0)  # s, those of their figure
EQUAL_MASS, EQUAL_SPACING = "shock.masses=equal_mass", "shock.masses=equal_spacing"
# Rows, from the top.
THEIRS = {"SSPH, equal masses": ("shock.scheme=ssph", EQUAL_MASS), "SSPH, equal separation": ("shock.scheme=ssph", EQUAL_SPACING),
          "DISPH, equal masses": ("shock.scheme=disph", EQUAL_MASS), "DISPH, equal separation": ("shock.scheme=disph", EQUAL_SPACING)}
OURS = {"Godunov DISPH": ("shock.scheme=gdisph", EQUAL_MASS),
        "DISPH, f of [S4]": ("shock.scheme=disph", EQUAL_MASS, "shock.support_terms=weight"),
        "Godunov DISPH, f of [S4]": ("shock.scheme=gdisph", EQUAL_MASS, "shock.support_terms=weight")}


def snapshots(outcome: Outcome) -> list[runs.Snapshot]:
    return [runs.Snapshot(path) for path in sorted(outcome.folder.glob("snapshot_*.h5"))]


def pressure_at_rest(outcome: Outcome, first: runs.Snapshot):
    """p over y of the column at rest, from the weight of the start's rows: heights (m, upwards) and pressures (Pa), the contact's own among them."""
    gravity, top, height = outcome.setting("rti.gravity"), outcome.setting("rti.p_top"), first.lengths[1]
    y, rows = np.unique(np.round(first["Coordinates"][:, 1] / height, 9), return_index=True)
    density, y = first["DensityReference"][rows], y * height
    if gravity == 0.0:
        return np.array([0.0, height]), np.array([top, top])
    heights, pressures, above = [height], [top], top
    for upper in (True, False):
        layer = (y > height / 2) == upper
        thick = height / 2 / layer.sum()
        for here, rho in zip(y[layer][::-1], density[layer][::-1]):
            heights.append(here)
            pressures.append(above + 0.5 * rho * gravity * thick)
            above += rho * gravity * thick
        heights.append(height / 2 if upper else 0.0)
        pressures.append(above)
    return np.array(heights[::-1]), np.array(pressures[::-1])


def course(outcome: Outcome) -> dict[str, np.ndarray]:
    """By snapshot: mean |p/p at rest - 1| and root mean square of the speed (m/s), near the contact and elsewhere. The speed of a sheared contact is
    that across it."""
    states = snapshots(outcome)
    if len(states) < 2:
        return {}
    at_rest = pressure_at_rest(outcome, states[0])
    spacing = outcome.setting("domain.length_x") / outcome.setting("domain.particles_x")
    sheared = outcome.setting("expert.shear") != 0.0
    found = {name: [] for name in ("time", "pressure_near", "pressure_elsewhere", "speed_near", "speed_elsewhere")}
    for state in states:
        y, v = state["Coordinates"][:, 1], state["Velocities"]
        error = np.abs(state["Pressure"] / np.interp(y, *at_rest) - 1.0)
        squares = v[:, 1] ** 2 if sheared else (v**2).sum(axis=1)
        near = np.abs(y - state.lengths[1] / 2) < NEAR * spacing
        found["time"].append(state.time)
        for where, chosen in (("near", near), ("elsewhere", ~near)):
            found[f"pressure_{where}"].append(error[chosen].mean())
            found[f"speed_{where}"].append(np.sqrt(squares[chosen].mean()))
    return {name: np.array(values) for name, values in found.items()}


def finest(outcomes: list[Outcome], case: str = "") -> list[Outcome]:
    """Of a contact, or of all, each form's run with the most particles, where it is complete."""
    found = {}
    for o in sorted(outcomes, key=lambda o: o.case.n):
        if o.case.file != "square" and case in ("", o.case.file):
            found[o.case.file, o.case.variant] = o
    return [found[key] for key in dict.fromkeys((o.case.file, o.case.variant) for o in outcomes) if key in found and found[key].kind == COMPLETED]


def courses(outcomes: list[Outcome]):
    """Columns: the contacts of one kind of masses; rows: pressure and speed, first of equal spacing, then of equal masses."""
    done = finest(outcomes)
    motions = list(dict.fromkeys(o.case.file.partition("_")[0] for o in done))
    if not motions:
        return None
    kinds = [(masses, quantity) for masses in ("equal_spacing", "equal_mass") for quantity in ("pressure_near", "speed_near")]
    figure, axes = style.panels(len(kinds) * len(motions), len(motions), 1.9, sharex=True, sharey="row")
    found = {(o.case.file, o.case.variant): course(o) for o in done}
    for row, (masses, quantity) in enumerate(kinds):
        for column, motion in enumerate(motions):
            ax = axes[row * len(motions) + column]
            for (case, form), lines in found.items():
                if case == f"{motion}_{masses}" and lines:
                    ax.plot(lines["time"], np.maximum(lines[quantity], 1e-16), label=form, color=style.COLOUR[form], linewidth=1.3,
                            linestyle=(0, (4, 2)) if form in style.DASHED else "-")
            ax.set_yscale("log")
            if row == 0:
                ax.set_title(motion)
            if column == 0:
                ax.set_ylabel(f"{masses.replace('_', ' ')}\n{'error of p' if quantity == 'pressure_near' else 'speed (m/s)'}")
            if row == len(kinds) - 1:
                ax.set_xlabel("time (s)")
    for row, (_, quantity) in enumerate(kinds):
        low, high = (1e-6, 1.0) if quantity == "pressure_near" else (1e-3, 1e3)
        axes[row * len(motions)].set_ylim(low, high)
    style.legend_above(figure, axes)
    return figure


def profiles(outcomes: list[Outcome]):
    done = finest(outcomes, "rest_equal_mass")
    if not done:
        return None
    figure, axes = style.panels(len(done), 4, 2.1, "p/p at rest − 1", sharex=True, sharey=True)
    for ax, o in zip(axes, done):
        last, spacing = snapshots(o)[-1], o.setting("domain.length_x") / o.setting("domain.particles_x")
        place = (last["Coordinates"][:, 1] - last.lengths[1] / 2) / spacing
        near = np.abs(place) < 20
        error = last["Pressure"][near] / o.setting("rti.p_top") - 1
        if outside := int((np.abs(error) > FRAME).sum()):
            ax.text(0.98, 0.95, f"{outside} outside", transform=ax.transAxes, ha="right", va="top", fontsize=7.5, color=style.GREY)
        ax.plot(place[near], error, ".", color=style.COLOUR[o.case.variant], markersize=2,
                markeredgewidth=0, rasterized=True)
        ax.axvline(0, color=style.GREY, linewidth=0.7)
        ax.set(title=o.case.variant, xlabel="distance from the contact (Δx)")
    axes[0].set_ylim(-FRAME, FRAME)
    return figure


def squares(outcomes: list[Outcome], rows: dict[str, tuple[str, ...]]):
    """Particles that were of the dense square red, the others blue; a row for each of `rows`."""
    shown = [o for name in rows for o in outcomes if o.case.file == "square" and o.case.variant == name and (o.folder / "summary.json").is_file()]
    if not shown:
        return None
    columns = len(SNAPSHOTS)
    figure, axes = style.plt.subplots(len(shown), columns, figsize=(style.WIDTH, style.WIDTH / columns * len(shown)), squeeze=False)
    for ax, time in zip(axes[0], SNAPSHOTS):
        ax.set_title(f"t = {time:g}")
    for row, o in zip(axes, shown):
        states = snapshots(o)
        start = states[0]["Coordinates"][:, :2] / states[0].lengths[:2]
        dense = set(states[0]["ParticleIDs"][(np.abs(start - 0.5) < 0.25).all(axis=1)].astype(int))
        for ax, time in zip(row, SNAPSHOTS):
            state = min(states, key=lambda one: abs(one.time - time))
            x = state["Coordinates"]
            red = np.array([int(one) in dense for one in state["ParticleIDs"]])
            for chosen, colour in ((~red, BLUE), (red, RED)):
                ax.plot(x[chosen, 0], x[chosen, 1], ".", color=colour, markersize=100 / o.case.n, markeredgewidth=0, rasterized=True)
            ax.set(aspect="equal", xlim=(0, 1), ylim=(0, 1), xticks=[], yticks=[])
            ax.grid(False)
            if abs(state.time - time) > 0.06:
                ax.set_title(f"stopped at t = {state.time:.2f}", color=style.ALARM)
        row[0].set_ylabel(o.case.variant, fontsize=8)
    return figure
