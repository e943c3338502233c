"""Water in three dimensions as lit spheres: pictures and a movie of the comparison of water with a free surface."""
from pathlib import Path

import numpy as np

from .. import movie, pages, plots, spheres, style
from ..runs import Snapshot
from .flow_figures import RATE, at_times, finest
from .outcomes import Outcome

TIMES = (0.25, 0.4, 0.5, 0.65, 0.8, 1.0)  # s
LATER = (1.4, 1.9, 2.6, 4.0)
FASTEST = 3.0                             # m/s, the end of the colours of speed
COLUMNS, MOVIE_COLUMNS = 760, 640         # pixels of a view


def view(snapshot: Snapshot, columns: int) -> tuple[np.ndarray, spheres.Eye]:
    """Water coloured by its speed, bodies grey. Places above the box are cut off."""
    eye = spheres.Eye(np.zeros(3), snapshot.lengths, columns)
    table = style.plt.get_cmap("viridis")
    water, wall = snapshot["Coordinates"], snapshot.wall("Coordinates").reshape(-1, 3)
    colours = np.concatenate([table(snapshot["Speed"] / FASTEST)[:, :3], np.full((len(wall), 3), 0.62)])
    return spheres.draw(eye, np.concatenate([water, wall]), 1.1 * float(np.median(snapshot.spacing)), colours), eye


def draw_view(ax, snapshot: Snapshot, columns: int) -> None:
    picture, eye = view(snapshot, columns)
    for index, line in enumerate(spheres.edges(eye, np.zeros(3), snapshot.lengths)):
        ax.plot(*line.T, color=style.GREY, linewidth=0.6, zorder=1 if index < 3 else 3)
    ax.imshow(np.clip(picture, 0, 1), origin="lower", extent=eye.extent, interpolation="antialiased", zorder=2)
    ax.set(xlim=eye.extent[:2], ylim=eye.extent[2:], aspect="equal")
    ax.axis("off")
    ax.set_title(plots.when(snapshot))


def course(outcome: Outcome | None, times):
    if outcome is None or not (states := at_times(outcome, times)):
        return None
    _, eye = view(states[0], 60)
    figure, axes = style.panels(len(states), 2, 0.45 * style.WIDTH * eye.shape[0] / eye.shape[1] + 0.25)
    for ax, snapshot in zip(axes, states):
        draw_view(ax, snapshot, COLUMNS)
    style.colour_bar(figure, style.plt.cm.ScalarMappable(style.plt.Normalize(0, FASTEST), "viridis"), axes, "speed [m/s]", shrink=0.5)
    return figure


def later(runs: list[Outcome]):
    """The finest of the runs that go on longest."""
    longest = max((o.snapshots[-1].time for o in runs if o.snapshots), default=0.0)
    if longest < LATER[0]:
        return None
    return course(finest([o for o in runs if o.snapshots and o.snapshots[-1].time > 0.99 * longest]), LATER)


def moving(outcome: Outcome | None, target: Path) -> str:
    if outcome is None:
        return ""

    def frames():
        _, eye = view(outcome.snapshots[0], 60)
        for snapshot in outcome.snapshots:
            figure, ax = style.plt.subplots(figsize=(MOVIE_COLUMNS / 100, MOVIE_COLUMNS / 100 * eye.shape[0] / eye.shape[1] + 0.3), dpi=100)
            draw_view(ax, snapshot, MOVIE_COLUMNS)
            figure.canvas.draw()
            yield np.asarray(figure.canvas.buffer_rgba())[..., :3].copy()
            style.plt.close(figure)

    movie.write_gif(frames(), target, RATE)
    return pages.movie(target, f"The same, {len(outcome.snapshots)} states (<code>{target.name}</code>).")
