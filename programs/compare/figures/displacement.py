"""How far the particles have moved, where nothing should: one map for each program on one input."""
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm

from ..results import last_snapshot, representatives
from ..runner import Outcome
from . import style

SMALLEST, LARGEST = 1e-9, 1e-1  # of the spacing: the range of the colours
ARROW = 0.9                     # length of the longest arrow, in spacings


def draw(outcomes: list[Outcome], file: str, path: Path) -> bool:
    states = [(outcome.case, snapshot) for outcome in representatives(outcomes, file)
              if (snapshot := last_snapshot(outcome.folder)) is not None and snapshot.displacement is not None]
    if not states:
        return False
    figure, axes = style.panels(len(states), 3, 3.3, sharex=True, sharey=True)
    norm = LogNorm(SMALLEST, LARGEST, clip=True)
    points = None
    for ax, (case, snapshot) in zip(axes, states):
        points = draw_map(ax, case, snapshot, norm)
        if ax.get_subplotspec().is_first_col():
            ax.set_ylabel("y (km)")
        if ax.get_subplotspec().is_last_row():
            ax.set_xlabel("x (km)")
    bar = figure.colorbar(points, ax=axes, shrink=0.75, aspect=30, pad=0.015, extend="both")
    bar.set_label("|displacement| / spacing")
    bar.outline.set_visible(False)
    style.save(figure, path)
    return True


def draw_map(ax, case, snapshot, norm):
    position, moved = snapshot.position[:, :2] / 1e3, snapshot.displacement[:, :2]
    distance = np.hypot(*moved.T) / snapshot.spacing
    largest = distance.max()
    wall = snapshot.wall_position[:, :2] / 1e3
    ax.scatter(*wall.T, s=7, marker="s", color="#d0d0d0", linewidths=0)
    points = ax.scatter(*position.T, s=20, c=np.maximum(distance, SMALLEST), norm=norm, cmap=plt.cm.cividis_r,
                        linewidths=0)
    # Below the colours' range the directions are those of round-off.
    if largest > SMALLEST:
        arrows = moved / snapshot.spacing / largest * ARROW * snapshot.spacing / 1e3
        longer = distance > 0.05 * largest
        ax.quiver(*position[longer].T, *arrows[longer].T, angles="xy", scale_units="xy", scale=1,
                  color=style.INK, width=0.004, headwidth=4, headlength=4)
    ax.set_title(f"{case.label}: at most {largest:.1e} spacings")
    ax.set_aspect("equal")
    ax.grid(False)
    margin = 3.2 * snapshot.spacing / 1e3
    ax.set_xlim(-margin, snapshot.length[0] / 1e3 + margin)
    ax.set_ylim(-margin, snapshot.length[1] / 1e3 + margin)
    return points
