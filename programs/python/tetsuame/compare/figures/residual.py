"""The residual of the Hosono iteration by pass, A and B, beside the growth that theory predicts."""
from pathlib import Path

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from ... import style
from ..results import Residuals, number, residuals
from ..runner import COMPLETED, Outcome

DASHES = {"": "-", "anderson": (0, (5, 2)), "newton": (0, (1, 1.2)), "under_relaxed": (0, (5, 1.5, 1, 1.5))}
NAMES = {"": "solver as in the input", "anderson": "Anderson", "newton": "Newton", "under_relaxed": "under-relaxed"}


def shown(outcome: Outcome) -> Residuals | None:
    """The evaluation to show: the last one of a run that stopped, else the one with most passes."""
    histories = residuals(outcome.folder)
    if not histories:
        return None
    return histories[-1] if outcome.kind != COMPLETED else max(histories, key=lambda one: len(one.iteration))


def draw(outcomes: list[Outcome], files: list[str], path: Path) -> bool:
    curves = [(outcome, history) for outcome in outcomes if (history := shown(outcome)) is not None]
    if not curves:
        return False
    shown_files = [file for file in files if any(outcome.case.file == file for outcome, _ in curves)]
    # One panel more than there are inputs holds the legend.
    figure, axes = style.panels(len(shown_files) + 1, 3, 2.9)
    for ax, file in zip(axes, shown_files):
        for outcome, history in curves:
            if outcome.case.file == file:
                draw_line(ax, outcome, history)
        ax.set_yscale("log")
        ax.xaxis.set_major_locator(MaxNLocator(integer=True))
        ax.set_title(f"File {file}")
        ax.set_xlabel("pass")
        if ax.get_subplotspec().is_first_col():
            ax.set_ylabel("largest |ln(Y_new/Y)|")
    draw_legend(axes[-1], curves)
    style.save(figure, path)
    return True


def draw_line(ax, outcome: Outcome, history: Residuals) -> None:
    variant, stopped = outcome.case.variant, outcome.kind != COMPLETED
    good = (history.residual > 0) & np.isfinite(history.residual)
    passes, values = history.iteration[good], history.residual[good]
    colour = style.COLOUR[outcome.case.program]
    if stopped and not good[-1]:
        # p^ <= 0: the logarithm has no value. The mark stands at the upper edge, B's below A's.
        ax.plot(history.iteration[-1], 0.96 if outcome.case.program == "A" else 0.88, color=colour, marker="x", markersize=7, markeredgewidth=2,
                transform=ax.get_xaxis_transform())
    if len(passes) == 0:
        return
    # A single value makes no line.
    ax.plot(passes, values, color=colour, linestyle=DASHES.get(variant.split(",")[0], "-"),
            marker="o" if len(passes) == 1 else None, markersize=3.5)
    if stopped and good[-1]:
        ax.plot(passes[-1], values[-1], color=colour, marker="x", markersize=7, markeredgewidth=2)
    growth = number(outcome.summary, "metrics", "hosono_growth_predicted")
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
