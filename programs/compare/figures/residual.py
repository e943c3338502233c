"""The residual of the Hosono iteration by pass, A and B, beside the growth that theory predicts."""
from pathlib import Path

import numpy as np

from ..results import Residuals, number, residuals
from ..runner import COMPLETED, Outcome
from . import style

DASHES = {"": "-", "anderson": (0, (5, 2)), "newton": (0, (1, 1.2)), "under_relaxed": (0, (5, 1.5, 1, 1.5))}


def shown(outcome: Outcome) -> Residuals | None:
    """The evaluation to show: the last one of a run that stopped, else the one with most passes."""
    histories = residuals(outcome.folder)
    if not histories:
        return None
    return histories[-1] if outcome.kind != COMPLETED else max(histories, key=lambda one: len(one.iteration))


def draw(outcomes: list[Outcome], files: list[str], path: Path) -> bool:
    curves = {}
    for outcome in outcomes:
        if (history := shown(outcome)) is not None:
            curves.setdefault((outcome.case.file, outcome.case.program), []).append((outcome, history))
    if not curves:
        return False
    shown_files = [file for file in files if any(key[0] == file for key in curves)]
    figure, axes = style.panels(len(shown_files), 3, 3.2)
    for ax, file in zip(axes, shown_files):
        for (_, program), lines in ((key, value) for key, value in curves.items() if key[0] == file):
            for outcome, history in lines:
                draw_line(ax, program, outcome, history)
        ax.set_yscale("log")
        ax.set_xscale("log")
        ax.set_title(f"File {file}")
        ax.set_xlabel("pass")
        if ax.get_subplotspec().is_first_col():
            ax.set_ylabel("largest relative change of Y")
        ax.legend(fontsize=7.5, handlelength=2.6)
    style.save(figure, path)
    return True


def draw_line(ax, program: str, outcome: Outcome, history: Residuals) -> None:
    variant = outcome.case.variant
    stopped = outcome.kind != COMPLETED
    where = f", step {history.step}" if stopped else ""
    positive = history.residual > 0
    passes, values = history.iteration[positive], history.residual[positive]
    if len(passes) == 0:
        return
    ax.plot(passes, values, color=style.COLOUR[program], linestyle=DASHES.get(variant.split(",")[0], "-"),
            marker="x" if stopped else style.MARKER[program], markersize=5 if stopped else 2.5,
            markevery=[-1] if stopped else None, markeredgewidth=2 if stopped else 1,
            label=f"{outcome.case.label}{where}")
    growth = number(outcome.summary, "metrics", "hosono_growth_predicted")
    if not variant and growth is not None and growth > 1:
        # As many passes as were made, at least three so that the slope is seen, from the first residual.
        line = np.arange(passes[0], passes[0] + max(len(passes), 3))
        ax.plot(line, values[0] * growth ** (line - line[0]), color=style.GREY, linewidth=1,
                linestyle=(0, (2, 2)), zorder=1,
                label=f"theory: × {growth:.3g} a pass ({program})")
