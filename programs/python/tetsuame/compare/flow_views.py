"""Water in three dimensions: pictures and movies of the comparison of water with a free surface."""
from pathlib import Path

from .. import movie, pages, plots, scene, style
from .flow_figures import RATE, at_times, finest
from .outcomes import Outcome

TIMES = (0.25, 0.4, 0.5, 0.65, 0.8, 1.0)  # s, of the tank with a box
LATER = (1.4, 1.9, 2.6, 4.0)
FASTEST = 3.0                             # m/s, the end of the colours of speed
COLUMNS, MOVIE_COLUMNS = 760, 640         # pixels of a view


def course(outcome: Outcome | None, times, fastest: float = FASTEST, cut: float | None = None):
    """cut: the z, m, before which everything is cut away."""
    if outcome is None or not (states := at_times(outcome, times)):
        return None
    figure, axes = style.panels(len(states), 2, 0.45 * style.WIDTH * scene.tall(states[0]) + 0.25)
    for ax, snapshot in zip(axes, states):
        scene.draw(ax, snapshot, COLUMNS, fastest, cut)
        ax.set_title(plots.when(snapshot))
    scene.speed_bar(figure, axes, fastest)
    return figure


def later(runs: list[Outcome]):
    """The finest of the runs that go on longest."""
    longest = max((o.snapshots[-1].time for o in runs if o.snapshots), default=0.0)
    if longest < LATER[0]:
        return None
    return course(finest([o for o in runs if o.snapshots and o.snapshots[-1].time > 0.99 * longest]), LATER)


def moving(outcome: Outcome | None, target: Path, fastest: float = FASTEST, cut: float | None = None) -> str:
    if outcome is None:
        return ""

    movie.write_gif(movie.views(outcome.snapshots, MOVIE_COLUMNS, fastest, cut), target, RATE)
    return pages.movie(target, f"The same, {len(outcome.snapshots)} states (<code>{target.name}</code>).")
