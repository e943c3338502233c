"""One look for all figures: a colour and a marker for each program, the same everywhere."""
import io
import logging
import os
import textwrap
import warnings

import numpy as np

os.environ["MPLBACKEND"] = "Agg"  # figures go to files; a name that matplotlib does not know would end it
logging.getLogger("matplotlib").setLevel(logging.ERROR)  # where it keeps its lists of fonts is of no interest
warnings.filterwarnings("ignore", message="Glyph ")  # of a folder's name in letters that the font has not

import matplotlib.pyplot as plt  # noqa: E402  (the backend is chosen first)
from matplotlib.collections import PolyCollection  # noqa: E402

INK, GREY, FAINT, ALARM = "#222222", "#767676", "#dddddd", "#a1160a"

# Okabe and Ito's palette: told apart with any common colour blindness.
BLUE, ORANGE, GREEN, PINK, VERMILION, SKY = "#0072B2", "#E69F00", "#009E73", "#CC79A7", "#D55E00", "#56B4E9"
CYCLE = (BLUE, ORANGE, GREEN, PINK, VERMILION, SKY, INK)  # of runs that have no colour of their own

# The programs, in the order of table 1. C and E often coincide, so E's line is dashed and its marker open.
COLOUR = {"A": ORANGE, "B": PINK, "C": BLUE, "D": VERMILION, "E": SKY, "F": GREEN,
          "F2": "#33BBAA", "Y": "#8C8200", "N": "#111111", "SSPH": "#882255", "rti": "#777777",
          "C-tied": "#002266", "E-tied": "#3377AA", "F-tied": "#114422", "Y-tied": "#554400"}
MARKER = {"A": "s", "B": "D", "C": "o", "D": "v", "E": "o", "F": "^"}
DASHED = {"E", "F2", "C-tied", "E-tied", "F-tied", "Y-tied"}

# The schemes for contacts and shocks: what weighs energy is cold, what weighs mass is warm.
SCHEME = {"ssph": ("SSPH", ORANGE), "disph": ("DISPH", SKY), "gsph": ("GSPH", VERMILION), "gdisph": ("Godunov DISPH", BLUE),
          "remix": ("REMIX", GREEN)}

# Methods of time integration, by the notes' and ARKODE's names.
METHOD = {"euler": INK, "order_2": ORANGE, "order_3": PINK, "order_4": VERMILION, "order_5": "#8C8200", "ssp_rk3": SKY, "rk4": BLUE,
          "rkc2": "#882255", "rkl2": "#AA4499"}
ADAPTIVE = {2: "#66A61E", 3: GREEN, 5: "#00553B"}  # by order

DENSE, LIGHT = "#d62020", "#2040d0"  # two liquids or gases in contact, as Saitoh and Makino drew them
OUTSIDE = "#f3d9c6"  # of a region that is recommended

# The stages of a step, in its order.
STAGE = {"lists": "#8C8C6E", "halo": "#DDD8B8", "volume": "#99C7DB", "walls": "#CC3311", "pressure": "#66A5CC",
         "densities": "#99C7DB", "corrections": "#7FA889", "gradient": "#4477AA", "gradients": "#66A5CC", "forces": "#4477AA",
         "rates": "#B8B38F", "integration": "#BBBBBB", "rest": "#e4e4e4"}

ABOUT_ONE = "RdBu_r"  # the colours of a ratio to a mean: more and less are told apart
WIDTH = 10.4  # inches: the report's column
TALLEST = 7.0  # inches: a map

plt.rcdefaults()  # whatever a user's matplotlibrc says
plt.rcParams.update({
    "figure.max_open_warning": 0,
    "figure.dpi": 150, "savefig.dpi": 150, "figure.constrained_layout.use": True,
    "font.family": "DejaVu Sans", "font.size": 9, "axes.titlesize": 9.5, "axes.titleweight": "bold",
    "axes.titlelocation": "left", "axes.edgecolor": GREY, "axes.labelcolor": INK, "axes.linewidth": 0.7,
    "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "axes.axisbelow": True, "grid.color": FAINT,
    "grid.linewidth": 0.6, "xtick.color": GREY, "ytick.color": GREY, "xtick.labelcolor": INK,
    "ytick.labelcolor": INK, "legend.frameon": False, "lines.linewidth": 1.6, "text.color": INK,
})


def line(program: str) -> dict:
    """Keyword arguments of plot() for a program."""
    dashed = program in DASHED
    return {"color": COLOUR[program], "marker": MARKER[program], "markersize": 4,
            "linestyle": (0, (4, 2)) if dashed else "-",
            "markerfacecolor": "white" if dashed else COLOUR[program],
            # An open, dashed line over a full one shows both.
            "zorder": 4 if dashed else 3}


def numbered(index: int) -> dict:
    """As line(), of a run that has no colour of its own."""
    return {"color": CYCLE[index % len(CYCLE)], "linewidth": 1.3, "linestyle": "-" if index < len(CYCLE) else "--"}


def panels(count: int, columns: int, height: float, ylabel: str = "", **options):
    """A grid of axes, those too many removed; the axes wanted, as a list. ylabel: of those in the first column."""
    columns = min(columns, count)
    rows = -(-count // columns)
    figure, grid = plt.subplots(rows, columns, figsize=(WIDTH, height * rows), squeeze=False, **options)
    flat = list(grid.flat)
    for axes in flat[count:]:
        axes.remove()
    for axes in flat[:count:columns]:
        axes.set_ylabel(ylabel)
    return figure, flat[:count]


def map_panels(count: int, wide: float = 1.0, columns: int = 3, bars: bool = True, **options):
    """As panels(), of maps `wide` times as wide as high: about so many columns that no row is half empty, and a figure no wider than
    they need. bars: each has a colour bar of its own; else one stands beside all."""
    near = [few for few in range(max(columns - 1, 1), columns + 2) if few <= count] or [count]
    columns = min(near, key=lambda few: (-count % few / few, abs(few - columns), few == 1, few))
    beside, for_all = (1.7, 0.0) if bars else (0.5, 1.0)
    width = min((WIDTH - for_all) / columns, max(3.5 * wide, 2.0) + beside)
    figure, axes = panels(count, columns, min((width - beside) / wide, TALLEST) + 1.0, **options)  # with a line of title, ticks and a label
    figure.set_size_inches(width * columns + for_all, figure.get_size_inches()[1])
    return figure, axes


def across(names: list[str], height: float = 0.42, margin: float = 1.2):
    """A figure of horizontal bars, one line a name from the top down, and its axes."""
    figure, (ax,) = panels(1, 1, height * len(names) + margin)
    ax.set_yticks(range(len(names)), names)
    ax.set_ylim(len(names) - 0.4, -0.6)
    ax.grid(axis="y", visible=False)
    return figure, ax


def stacked(names: list[str], parts: dict[str, tuple[str, list[float]]], label: str, **options):
    """Bars of across(), each of the parts (by name: colour and widths) that are there; the figure, its axes and where the bars end."""
    figure, ax = across(names, **options)
    ends = [0.0] * len(names)
    for name, (colour, widths) in parts.items():
        if any(widths):
            ax.barh(range(len(names)), widths, left=ends, height=0.68, color=colour, edgecolor="white", linewidth=0.6, label=name)
            ends = [end + width for end, width in zip(ends, widths)]
    ax.set_xlabel(label)
    legend_beside(ax)
    return figure, ax, ends


def say_at_ends(ax, ends: list[float], texts: list[str]) -> None:
    for index, (end, text) in enumerate(zip(ends, texts)):
        ax.annotate(text, (end, index), xytext=(4, 0), textcoords="offset points", va="center", fontsize=8)
    ax.margins(x=0.08)


def legend_beside(ax) -> None:
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize=8)


def legend_above(figure, axes) -> None:
    """Of all panels, each label once, in a strip above: there it covers no line."""
    found = {plain(label): handle for ax in axes for handle, label in zip(*ax.get_legend_handles_labels())}
    labels, handles = list(found), list(found.values())
    width, height = figure.get_size_inches()
    columns = min(max(int(width / (0.6 + 0.075 * max(map(len, labels)))), 1), len(labels))
    strip = 0.12 + 0.19 * -(-len(labels) // columns)  # inches
    figure.set_size_inches(width, height + strip)
    figure.get_layout_engine().set(rect=(0, 0, 1, height / (height + strip)))
    figure.legend(handles, labels, loc="upper left", ncol=columns, fontsize=8)


def entitle(ax, *lines: str) -> None:
    """A title over its panel alone: what is longer goes on in the next line."""
    wide = ax.figure.get_size_inches()[0] / ax.get_subplotspec().get_gridspec().ncols - 0.9
    ax.set_title("\n".join(part for line in lines for part in textwrap.wrap(plain(line), max(int(wide / 0.093), 10))))


def room_for_titles(figure, axes) -> None:
    """A figure higher by what titles of several lines take from their panels."""
    more = max(ax.get_title(loc="left").count("\n") for ax in axes)
    width, height = figure.get_size_inches()
    figure.set_size_inches(width, height + 0.17 * more * axes[0].get_subplotspec().get_gridspec().nrows)


def stopped(ax, x: float, y: float | None, colour: str, below: int = 0) -> None:
    """A cross where a run stopped, wholly within the axes, whose limits are kept. y None: at the upper edge, below so many others."""
    def within(value: float, axis) -> float:
        low, high, here = axis.get_transform().transform(np.array([*axis.get_view_interval(), value], float))
        return min(max((here - low) / (high - low), 0.03), 0.96) if np.isfinite(here) else 0.96

    up = 0.96 - 0.08 * below if y is None else within(y, ax.yaxis)
    ax.plot(within(x, ax.xaxis), up, "x", color=colour, markersize=7, markeredgewidth=2, zorder=5, transform=ax.transAxes)


def colour_bar(figure, drawn, axes, label: str, names: tuple[str, ...] = (), **options) -> None:
    """names: of what the values number, from 0."""
    bar = figure.colorbar(drawn, ax=axes, **options)
    bar.set_label(label)
    if names:
        bar.set_ticks(range(len(names)), labels=names)
    bar.outline.set_visible(False)


def tiles(ax, places, edge: float, **options):
    """Squares of this edge about these places, in the units of the axes."""
    corners = 0.5 * edge * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    return ax.add_collection(PolyCollection(np.asarray(places)[:, None, :] + corners, linewidths=0, **options))


def as_map(ax, x: tuple[float, float], y: tuple[float, float]) -> None:
    """Lengths alike along both axes, nothing between the ticks."""
    ax.set(aspect="equal", xlim=x, ylim=y)
    if max(map(abs, x)) >= 1e4:  # room for long numbers
        ax.locator_params(axis="x", nbins=4)
    ax.grid(False)


def plain(text: str) -> str:
    """Of a name that is not ours: nothing in it is an equation."""
    return text.replace("$", r"\$")


def png(figure) -> bytes:
    """The picture of a figure, which is closed."""
    buffer = io.BytesIO()
    figure.savefig(buffer)
    plt.close(figure)
    return buffer.getvalue()
