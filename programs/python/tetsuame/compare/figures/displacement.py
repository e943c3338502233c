"""How far the particles have moved, where nothing should: one map for each program on one input."""
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import ListedColormap, LogNorm

from ... import style
from ..results import last_snapshot, representatives
from ..runner import Outcome

SMALLEST, LARGEST = 1e-9, 1e-1  # of the spacing: the range of the colours
ARROW = 0.85                    # length of the longest arrow, in spacings
# The darkest part is left out: the arrows are drawn over the colours.
COLOURS = ListedColormap(colormaps["YlOrBr"](np.linspace(0.1, 0.72, 256)))


def draw(outcomes: list[Outcome], file: str, path: Path) -> bool:
    states = [(outcome.case, snapshot) for outcome in representatives(outcomes, file)
              if (snapshot := last_snapshot(outcome.folder)) is not None and snapshot.displacement is not None]
    if not states:
        return False
    figure, axes = style.panels(len(states), 3 if len(states) != 4 else 2, 3.6 if len(states) != 4 else 4.4,
                                sharex=True, sharey=True)
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
    # Tiles that nearly touch, in points squared: the panel is about 2.6 inches for the box and its walls.
    size = (0.8 * 72 * ax.get_position().width * style.WIDTH * 0.86 / (snapshot.length[0] / snapshot.spacing + 6.4)) ** 2
    wall = snapshot.wall_position[:, :2] / 1e3
    ax.scatter(*wall.T, s=size / 6, marker="s", color="#bdbdbd", linewidths=0)
    points = ax.scatter(*position.T, s=size, marker="s", c=np.maximum(distance, SMALLEST), norm=norm, cmap=COLOURS,
                        linewidths=0)
    # Below the colours' range the directions are those of round-off.
    if largest > SMALLEST:
        arrows = moved / snapshot.spacing / largest * ARROW * snapshot.spacing / 1e3
        longer = distance > 0.05 * largest
        ax.quiver(*position[longer].T, *arrows[longer].T, angles="xy", scale_units="xy", scale=1,
                  pivot="mid", color=style.INK, width=0.0035, headwidth=4, headlength=4, headaxislength=3.5)
    ax.set_title(f"{case.label}\n", pad=2)
    said = f"largest: {largest:.1e} spacings" if largest > 0 else "none moved"
    ax.text(0, 1.015, said, transform=ax.transAxes, fontsize=8.5, color=style.GREY)
    ax.set_aspect("equal")
    ax.grid(False)
    margin = 3.2 * snapshot.spacing / 1e3
    ax.set_xlim(-margin, snapshot.length[0] / 1e3 + margin)
    ax.set_ylim(-margin, snapshot.length[1] / 1e3 + margin)
    return points
