"""Pictures of a run of `balance`: the cuts and the ranks' times, and their course. In 3-D the cells are those of the columns along z:
their mean time is shown."""
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.collections import PolyCollection

from . import style
from .reading import Unreadable, read_columns, read_json

OURS, OTHERS = "#0072B2", {"rcb": "#E69F00", "hsfc": "#CC79A7"}


@dataclass
class Run:
    history: dict[str, np.ndarray]  # by column, without the unit
    times: dict[int, np.ndarray]  # s of each rank, by decision
    cuts: dict[int, list[np.ndarray]]  # by decision: of each axis, groups x (counts + 1), m


def read(folder: Path) -> Run:
    try:
        summary = read_json(folder / "summary.json", "balance")
        history, times, cuts = (read_columns(folder / f"{name}.csv") for name in ("history", "times", "cuts"))
        total = times["computing"] + times["communication"]
        decisions = np.unique(times["decision"]).astype(int)
        by_axis = {}
        for d in decisions:
            here = cuts["decision"] == d
            by_axis[d] = [cuts["position"][here & (cuts["axis"] == a)].reshape(-1, n + 1)
                          for a, n in enumerate(summary["counts"])]
        return Run(history, {d: total[times["decision"] == d] for d in decisions}, by_axis)
    except (OSError, ValueError, KeyError, IndexError) as problem:
        raise Unreadable(f"{folder}: not the results of a run of balance: {problem}") from problem


def cells(run: Run, decision: int) -> tuple[np.ndarray, np.ndarray]:
    """Corners of each cell in the plane of x and y, and its time over the mean."""
    x, y = run.cuts[decision][0][0], run.cuts[decision][1]
    corners = [[(x[i], y[i, j]), (x[i + 1], y[i, j]), (x[i + 1], y[i, j + 1]), (x[i], y[i, j + 1])]
               for i in range(len(x) - 1) for j in range(y.shape[1] - 1)]
    time = run.times[decision].reshape(len(corners), -1).mean(axis=1)
    mean = time.mean()
    return np.array(corners), time / mean if mean > 0 else np.ones(len(time))


def cuts(run: Run):
    """First, second, fourth and last cuts, each cell coloured by its time."""
    last = max(run.times)
    shown = sorted({0, min(1, last), min(3, last), last})
    figure, axes = style.panels(len(shown), len(shown), 3.1)
    for ax, decision in zip(axes, shown):
        corners, time = cells(run, decision)
        drawn = PolyCollection(corners, array=time, cmap="RdBu_r", edgecolors="#333333",
                               linewidths=min(0.5, 8.0 / np.sqrt(len(corners))))
        drawn.set_clim(0, 2)
        ax.add_collection(drawn)
        style.as_map(ax, *((corners[..., a].min(), corners[..., a].max()) for a in (0, 1)))
        ax.set_xticks([])
        ax.set_yticks([])
        spread = 100 * run.history["spread"][decision]
        ax.set_title(f"decision {decision}: spread {spread:.1f} %", fontsize=9)
    figure.colorbar(drawn, ax=list(axes), label="time of a rank / mean", shrink=0.7)
    return figure


def course(run: Run):
    """Spread and moved particles over the steps."""
    figure, (left, right) = style.panels(2, 2, 3.2)
    step = run.history["step"]
    names = {"": ("balancer", OURS)} | {f"{k}_": (f"Zoltan {k.upper()}", c) for k, c in OTHERS.items()
                                        if f"{k}_spread" in run.history}
    for prefix, (label, colour) in names.items():
        left.plot(step, 100 * run.history[f"{prefix}spread"], marker="o", markersize=3, color=colour, label=label)
        right.plot(step, 100 * np.cumsum(run.history[f"{prefix}migrated_fraction"]), color=colour, label=label)
    if max(run.history["spread"]) > 0:
        left.set_yscale("log")
    left.set_ylabel("(max - min)/mean of time (%)")
    right.set_ylabel("particles moved so far (% of all)")
    for ax in (left, right):
        ax.set_xlabel("step")
    left.legend(fontsize=8)
    return figure


def make(folder: Path) -> str:
    """Draws; what is said of it."""
    run = read(folder)
    paths = {folder / "cuts.png": cuts(run), folder / "course.png": course(run)}
    for path, figure in paths.items():
        style.save(figure, path, dpi=110)
    return " ".join(["Pictures:", *map(str, paths)])
