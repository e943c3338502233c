"""The pictures. In 3-D the cells are those of the columns along z: their mean time is shown."""
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

from .. import style
from .results import Run

OURS, OTHERS = "#0072B2", {"rcb": "#E69F00", "hsfc": "#CC79A7"}


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
        ax.set_xlim(corners[..., 0].min(), corners[..., 0].max())
        ax.set_ylim(corners[..., 1].min(), corners[..., 1].max())
        ax.set_aspect("equal")
        ax.grid(visible=False)
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


def draw(run: Run, folder) -> list[str]:
    written = []
    for name, figure in (("cuts.png", cuts(run)), ("course.png", course(run))):
        figure.savefig(folder / name, dpi=110)
        plt.close(figure)
        written.append(name)
    return written
