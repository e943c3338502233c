"""The figures of programs A to F. A figure without data to show is none."""
import numpy as np
from matplotlib import colormaps
from matplotlib.colors import ListedColormap, LogNorm
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from .. import style
from .outcomes import COMPLETED, Outcome, Residuals, representatives, residuals

# ---- pressure error against depth, from the last snapshots: one panel for each input ----------------------------------

ROUND_OFF = 1e-16  # smaller errors, zero too, are drawn here


def spacing_of(outcome: Outcome) -> float:
    """Of the start lattice, m."""
    return outcome.snapshot.lengths[1] / outcome.setting("domain.particles_y")


def by_row(outcome: Outcome) -> tuple[np.ndarray, np.ndarray]:
    """Depth (km) of each row of the start lattice, and the mean relative pressure error in it."""
    snapshot, height, spacing = outcome.snapshot, outcome.snapshot.lengths[1], spacing_of(outcome)
    y, reference = snapshot["Coordinates"][:, 1], snapshot["PressureReference"]
    rows = round(height / spacing)
    row = np.clip(np.floor(y / spacing).astype(int), 0, rows - 1)
    relative = np.abs(snapshot["Pressure"] - reference) / np.abs(reference)
    count = np.bincount(row, minlength=rows)
    full = count > 0
    mean = np.bincount(row, relative, minlength=rows)[full] / count[full]
    depth = height - np.bincount(row, y, minlength=rows)[full] / count[full]
    return depth / 1e3, np.maximum(mean, ROUND_OFF)


def pressure(outcomes: list[Outcome], files: list[str]):
    shown = ((file, [o for o in representatives(outcomes, file) if o.snapshot and "PressureReference" in o.snapshot]) for file in files)
    curves = {file: runs for file, runs in shown if runs}
    if not curves:
        return None
    # One panel more than there are inputs holds the legend.
    figure, axes = style.panels(len(curves) + 1, 3, 3.1, "depth (km)", sharex=True, sharey=True)
    handles = {}
    for ax, (file, runs) in zip(axes, curves.items()):
        for o in runs:
            depth, error = by_row(o)
            label = f"{o.case.program} (cured)" if o.case.variant else o.case.program
            handles[label], = ax.plot(error, depth, **style.line(o.case.program), label=label)
        ax.set_title(f"File {file}")
    axes[0].set(xscale="log", xlim=(ROUND_OFF / 3, 1))
    axes[0].set_ylim(bottom=0)
    axes[0].invert_yaxis()
    for ax in axes[:-1]:
        ax.set_xticks([1e-16, 1e-12, 1e-8, 1e-4, 1], ["≤ 1e-16", "1e-12", "1e-8", "1e-4", ""])
        ax.tick_params(labelbottom=True)
        ax.set_xlabel("mean |p − p_ref| / p_ref in a row")
    axes[-1].set_axis_off()
    axes[-1].legend(handles=[handles[label] for label in sorted(handles)], loc="center left", title="Program",
                    alignment="left", fontsize=10, labelspacing=0.7)
    return figure


# ---- how far the particles have moved, where nothing should: one map for each program on one input -------------------

SMALLEST, LARGEST = 1e-9, 1e-1  # of the spacing: the range of the colours
ARROW = 0.85                    # length of the longest arrow, in spacings
# The darkest part is left out: the arrows are drawn over the colours.
COLOURS = ListedColormap(colormaps["YlOrBr"](np.linspace(0.1, 0.72, 256)))


def displacement(outcomes: list[Outcome], file: str):
    runs = [o for o in representatives(outcomes, file) if o.snapshot and "Displacement" in o.snapshot]
    if not runs:
        return None
    lengths = runs[0].snapshot.lengths
    figure, axes = style.map_panels(len(runs), lengths[0] / lengths[1], bars=False, ylabel="y (km)", sharex=True, sharey=True)
    for ax, outcome in zip(axes, runs):
        points = draw_map(ax, outcome)
        if ax.get_subplotspec().is_last_row():
            ax.set_xlabel("x (km)")
    style.colour_bar(figure, points, axes, "|displacement| / spacing", shrink=0.75, aspect=30, pad=0.015, extend="both")
    return figure


def draw_map(ax, outcome: Outcome):
    snapshot, spacing = outcome.snapshot, spacing_of(outcome)
    position, moved = snapshot["Coordinates"] / 1e3, snapshot["Displacement"]
    distance = np.hypot(*moved.T) / spacing
    largest = distance.max()
    if len(walls := snapshot.wall("Coordinates")):
        style.tiles(ax, walls / 1e3, 0.3 * spacing / 1e3, color=style.FAINT)
    points = style.tiles(ax, position, 0.92 * spacing / 1e3, array=np.maximum(distance, SMALLEST), cmap=COLOURS,
                         norm=LogNorm(SMALLEST, LARGEST, clip=True))
    # Below the colours' range the directions are those of round-off.
    if largest > SMALLEST:
        arrows = moved / spacing / largest * ARROW * spacing / 1e3
        longer = distance > 0.05 * largest
        ax.quiver(*position[longer].T, *arrows[longer].T, angles="xy", scale_units="xy", scale=1,
                  pivot="mid", color=style.INK, width=0.0035, headwidth=4, headlength=4, headaxislength=3.5)
    ax.set_title(f"{outcome.case.label}\n", pad=2)
    said = f"largest: {largest:.1e} spacings" if largest > 0 else "none moved"
    ax.text(0, 1.015, said, transform=ax.transAxes, fontsize=8.5, color=style.GREY)
    margin = 3.2 * spacing / 1e3
    style.as_map(ax, *((-margin, length / 1e3 + margin) for length in snapshot.lengths))
    return points


# ---- the residual of the Hosono iteration by pass, A and B, beside the growth that theory predicts -------------------

DASHES = {"": "-", "anderson": (0, (5, 2)), "newton": (0, (1, 1.2)), "under_relaxed": (0, (5, 1.5, 1, 1.5))}
NAMES = {"": "solver as in the input", "anderson": "Anderson", "newton": "Newton", "under_relaxed": "under-relaxed"}


def shown(outcome: Outcome) -> Residuals | None:
    """The evaluation to show: the last one of a run that stopped, else the one with most passes."""
    histories = residuals(outcome.folder)
    if not histories:
        return None
    return histories[-1] if outcome.kind != COMPLETED else max(histories, key=lambda one: len(one.iteration))


def residual(outcomes: list[Outcome], files: list[str]):
    curves = [(outcome, history) for outcome in outcomes if (history := shown(outcome)) is not None]
    if not curves:
        return None
    shown_files = [file for file in files if any(outcome.case.file == file for outcome, _ in curves)]
    # One panel more than there are inputs holds the legend.
    figure, axes = style.panels(len(shown_files) + 1, 3, 2.9, "largest |ln(Y_new/Y)|")
    for ax, file in zip(axes, shown_files):
        crosses: list = []
        ax.set_yscale("log")
        for outcome, history in curves:
            if outcome.case.file == file:
                draw_line(ax, outcome, history, crosses)
        if not ax.lines:  # nothing but crosses
            ax.set_ylim(1e-3, 1.0)
        ends = [*(ax.get_xlim() if ax.lines else ()), *(x for x, *_ in crosses)]
        ax.set_xlim(min(min(ends) - 0.3, 0.7), max(max(ends) + 0.3, 2.3))
        for cross in crosses:
            style.stopped(ax, *cross)
        ax.xaxis.set_major_locator(MaxNLocator(integer=True))
        ax.set(title=f"File {file}", xlabel="pass")
    draw_legend(axes[-1], curves)
    return figure


def draw_line(ax, outcome: Outcome, history: Residuals, crosses: list) -> None:
    """`crosses`: those of runs that stopped are put there, to be drawn when the limits are known."""
    variant, stopped = outcome.case.variant, outcome.kind != COMPLETED
    good = (history.residual > 0) & np.isfinite(history.residual)
    passes, values = history.iteration[good], history.residual[good]
    colour = style.COLOUR[outcome.case.program]
    if stopped and not good[-1]:
        # p^ <= 0: the logarithm has no value. The cross stands at the upper edge, B's below A's.
        crosses.append((history.iteration[-1], None, colour, int(outcome.case.program == "B")))
    if len(passes) == 0:
        return
    # A single value makes no line.
    ax.plot(passes, values, color=colour, linestyle=DASHES.get(variant.split(",")[0], "-"),
            marker="o" if len(passes) == 1 else None, markersize=3.5)
    if stopped and good[-1]:
        crosses.append((passes[-1], values[-1], colour))
    growth = outcome.number("metrics", "hosono_growth_predicted")
    if not variant and growth is not None and growth > 1:
        # From the first residual, as many passes as were made, at least two so that the slope is seen.
        line = np.arange(passes[0], passes[0] + max(len(passes), 2))
        ax.plot(line, values[0] * growth ** (line - line[0]), color=style.GREY, linewidth=4, alpha=0.35, zorder=1)


def draw_legend(ax, curves: list) -> None:
    ax.set_axis_off()
    programs = sorted({outcome.case.program for outcome, _ in curves})
    solvers = list(dict.fromkeys(outcome.case.variant.split(",")[0] for outcome, _ in curves))
    handles = [Line2D([], [], color=style.COLOUR[name], linewidth=3, label=f"program {name}") for name in programs]
    handles += [Line2D([], [], color=style.INK, linestyle=DASHES.get(name, "-"), label=NAMES.get(name, name))
                for name in solvers]
    handles += [Line2D([], [], color=style.INK, marker="x", linestyle="", markersize=7, markeredgewidth=2,
                       label="stopped here (upper edge: p̂ ≤ 0)"),
                Line2D([], [], color=style.GREY, linewidth=4, alpha=0.35, label="theory, × |G| a pass")]
    ax.legend(handles=handles, loc="center left", fontsize=9.5, labelspacing=0.6, handlelength=2.8)


# ---- time a step by stage, for the runs of one input; what treats walls stands out ------------------------------------

SMALL, MOST = 0.01, 6  # of the time of all runs: stages below are not told apart; nor more than so many


def cost(outcomes: list[Outcome], files: list[str]):
    """Of the input with most completed runs, the last of equals: cost depends little on the input."""
    timed = [o.case.file for o in outcomes if o.kind == COMPLETED and o.cost_per_step]
    if not timed:
        return None
    file = max(reversed(files), key=timed.count)
    runs = [o for o in representatives(outcomes, file) if o.cost_per_step]
    total: dict[str, float] = {}
    for outcome in runs:
        for name, seconds in outcome.stages.items():
            total[name] = total.get(name, 0.0) + seconds
    walls = [name for name in total if name.startswith("wall")]
    seen = [name for name in total if name not in walls and total[name] > SMALL * sum(total.values())]
    others = sorted(seen, key=total.get, reverse=True)[:MOST]

    # Of each part its colour and the stages in it.
    parts = {"wall correction": (style.STAGE["walls"], walls)} | \
        {name.replace("_", " "): (style.STAGE.get(name, style.GREY), [name]) for name in others}
    rest = [name for name in total if name not in {*walls, *others}]
    milliseconds = {label: (colour, [1e3 * sum(o.stages.get(name, 0.0) for name in names) / o.summary["steps"] for o in runs])
                    for label, (colour, names) in (parts | {"everything else": (style.STAGE["rest"], rest)}).items()}
    figure, ax, ends = style.stacked([outcome.case.label for outcome in runs], milliseconds, "time a step without output (ms), one thread",
                                     margin=1.3)
    style.say_at_ends(ax, ends, [f"{end:.2g} ms" for end in ends])
    ax.set_title(f"File {file}")
    return figure
