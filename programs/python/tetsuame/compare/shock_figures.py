"""The figures of the comparison of schemes on contacts and shocks."""
import numpy as np

from .. import plots, style
from .outcomes import COMPLETED, Outcome

MAPS = ("square", "square_equal_mass", "kelvin_helmholtz")   # shown from above; the others over x or the radius
ROUND = {"gresho"}                                           # the velocity shown is that around the centre


def judged_by(test: str) -> str:
    """The error that a test is judged by: of a vortex of even density the velocity's."""
    return "velocity_l1" if test in ROUND else "density_l1"


def chosen(outcomes: list[Outcome], test: str) -> list[Outcome]:
    """Of each scheme the completed run with the most particles."""
    done = [o for o in outcomes if o.case.file == test and o.kind == COMPLETED]
    by_scheme = ([o for o in done if o.case.variant == name] for name in style.SCHEME)
    return [max(runs, key=lambda o: o.case.n) for runs in by_scheme if runs]


def caption(outcomes: list[Outcome], test: str) -> str:
    n = ", ".join(sorted({str(o.case.n) for o in chosen(outcomes, test)}))
    if test in MAPS:
        return f"Density at the end, n = {n}; the colours of all panels are the same."
    exact = "line: a run of GSPH with twice the particles." if test == "blasts" else "line: the exact solution."
    return f"Every particle at the end, n = {n}; {exact}"


def state(outcomes: list[Outcome], test: str):
    runs = [o for o in chosen(outcomes, test) if o.snapshot is not None]
    if not runs:
        return None
    if test in MAPS:
        return maps(runs)
    fine = next((o.snapshot for o in outcomes if o.case.file == test and o.case.variant == "reference" and o.kind == COMPLETED), None)
    return scatter(runs, fine, test)


def maps(runs: list[Outcome]):
    every = np.concatenate([o.snapshot["Density"] for o in runs])
    low, high = np.quantile(every, [0.005, 0.995])
    if high - low < 1e-6 * high:
        low, high = 0.9 * low, 1.1 * high
    figure, axes = style.map_panels(len(runs), 1.0, 4, bars=False)
    for ax, o in zip(axes, runs):
        image = plots.draw_map(ax, o.snapshot.map("Density"), "Density", "", (low, high), length="", bar=False)
        ax.set_title(style.SCHEME[o.case.variant][0])
        ax.set(xticks=[], yticks=[], xlabel="", ylabel="")
    style.colour_bar(figure, image, axes, "density", shrink=0.8, aspect=22)
    return figure


def over_place(snapshot, swirl: bool, ending: str = "") -> tuple[np.ndarray, list[np.ndarray]]:
    """Of a snapshot, or with the ending "Reference" of the exact solution in it: the place (x, or beyond one dimension the distance from the
    centre), and density, velocity along the place (or around the centre) and pressure."""
    x, v = snapshot["Coordinates"], snapshot["Velocities" + ending]
    if snapshot.dimension == 1:
        place, velocity = x[:, 0], v[:, 0]
    else:
        from_centre = x - snapshot.lengths / 2
        place = np.sqrt((from_centre**2).sum(axis=1))
        unit = from_centre / np.maximum(place, 1e-300)[:, None]
        velocity = unit[:, 0] * v[:, 1] - unit[:, 1] * v[:, 0] if swirl else (unit * v).sum(axis=1)
    return place, [snapshot["Density" + ending], velocity, snapshot["Pressure" + ending]]


def scatter(runs: list[Outcome], fine, test: str):
    figure, axes = style.panels(3 * len(runs), len(runs), 1.95, sharex=True, sharey="row")
    for column, o in enumerate(runs):
        snapshot, swirl, flat = o.snapshot, test in ROUND, o.snapshot.dimension == 1
        title, colour = style.SCHEME[o.case.variant]
        panels = axes[column::len(runs)]
        place, fields = over_place(snapshot, swirl)
        for ax, values in zip(panels, fields):
            ax.plot(place, values, ".", color=colour, markersize=3.2 if flat else 1.8, markeredgewidth=0, rasterized=True)
        if "DensityReference" in snapshot or fine is not None:
            place, right = over_place(snapshot, swirl, "Reference") if "DensityReference" in snapshot else over_place(fine, swirl)
            order = np.argsort(place)
            for ax, values in zip(panels, right):
                ax.plot(place[order], values[order], color=style.INK, linewidth=0.9, zorder=4)
        panels[0].set_title(title)
        panels[2].set_xlabel("x" if flat else "distance from the centre")
        if not flat:
            panels[0].set_xlim(0, snapshot.lengths[0] / 2)
    for row, name in enumerate(("density", "velocity around" if test in ROUND else "velocity", "pressure")):
        axes[row * len(runs)].set_ylabel(name)
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
