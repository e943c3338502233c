"""Pressure error against depth, from the last snapshots: one panel for each input."""
from pathlib import Path

import numpy as np

from ... import style
from ..results import Snapshot, last_snapshot, representatives
from ..runner import Outcome

ROUND_OFF = 1e-16  # smaller errors, zero too, are drawn here


def by_row(snapshot: Snapshot) -> tuple[np.ndarray, np.ndarray]:
    """Depth (km) of each row of the start lattice, and the mean relative pressure error in it."""
    y = snapshot.position[:, 1]
    rows = round(snapshot.length[1] / snapshot.spacing)
    row = np.clip(np.floor(y / snapshot.spacing).astype(int), 0, rows - 1)
    reference = snapshot.pressure_reference
    relative = np.abs(snapshot.pressure - reference) / np.abs(reference)
    count = np.bincount(row, minlength=rows)
    full = count > 0
    mean = np.bincount(row, relative, minlength=rows)[full] / count[full]
    depth = snapshot.length[1] - np.bincount(row, y, minlength=rows)[full] / count[full]
    return depth / 1e3, np.maximum(mean, ROUND_OFF)


def draw(outcomes: list[Outcome], files: list[str], path: Path) -> bool:
    curves = {}
    for file in files:
        for outcome in representatives(outcomes, file):
            snapshot = last_snapshot(outcome.folder)
            if snapshot is not None and snapshot.pressure_reference is not None:
                curves.setdefault(file, []).append((outcome.case, by_row(snapshot)))
    if not curves:
        return False

    # One panel more than there are inputs holds the legend.
    figure, axes = style.panels(len(curves) + 1, 3, 3.1, sharex=True, sharey=True)
    handles = {}
    for ax, (file, lines) in zip(axes, curves.items()):
        for case, (depth, error) in lines:
            label = f"{case.program} (cured)" if case.variant else case.program
            handles[label], = ax.plot(error, depth, **style.line(case.program), label=label)
        ax.set_title(f"File {file}")
    axes[0].set_xscale("log")
    axes[0].set_xlim(ROUND_OFF / 3, 1)
    axes[0].set_ylim(bottom=0)
    axes[0].invert_yaxis()
    for ax in axes[:-1]:
        ax.set_xticks([1e-16, 1e-12, 1e-8, 1e-4, 1], ["≤ 1e-16", "1e-12", "1e-8", "1e-4", ""])
        ax.tick_params(labelbottom=True)
        ax.set_xlabel("mean |p − p_ref| / p_ref in a row")
        if ax.get_subplotspec().is_first_col():
            ax.set_ylabel("depth (km)")
    axes[-1].set_axis_off()
    axes[-1].legend(handles=[handles[label] for label in sorted(handles)], loc="center left", title="Program",
                    alignment="left", fontsize=10, labelspacing=0.7)
    style.save(figure, path)
    return True
