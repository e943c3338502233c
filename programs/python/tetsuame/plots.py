"""Pictures of runs: histories, maps, profiles; and `tetsuame plot`."""
import argparse
from pathlib import Path

import numpy as np

from . import COMPLETED, fields, gauges, runs, scene, style, writing
from .reading import Damaged
from .style import plt

OF_THE_RUN = {"step", "time", "dt"}  # columns of a history that say nothing of the flow

KEPT = ("momentum", "angular_momentum")  # what is conserved, or nearly so


def varies(values: np.ndarray) -> bool:
    good = values[np.isfinite(values)]
    return len(good) > 1 and np.ptp(good) > 1e-12 * max(np.abs(good).max(), 1e-300)


def histories(of: list[tuple[str, runs.Run]], columns: list[str] | None = None, most: int = 12):
    """A panel for each column that varies in any of the runs, a line for each run; None without any."""
    for _, run in of:
        if run.history and "time" not in run.history:
            raise Damaged(f"{run.directory / 'history.csv'}: has no column time")
    if columns is None:
        columns = []
        for _, run in of:
            columns += [name for name in run.history if name not in OF_THE_RUN | set(columns) and varies(run.history[name])]
        columns.sort(key=lambda name: name.startswith(KEPT))  # what is measured comes first: there may be no room for all
    columns = columns[:most]
    if not columns:
        return None
    largest = max((run.history["time"].max() for _, run in of if "time" in run.history and len(run.history["time"])), default=1.0)
    size, unit = fields.scaled("s", largest)
    figure, panels = style.panels(len(columns), 3, 2.1)
    for ax, name in zip(panels, columns):
        units = ""
        for index, (title, run) in enumerate(of):
            if name in run.history:
                ax.plot(run.history["time"] / size, run.history[name], **style.numbered(index), label=title)
                units = run.history.units[name]
        style.entitle(ax, name.replace("_", " ") + fields.bracketed(units))
        ax.margins(x=0)
    for ax in panels[-3:]:
        ax.set_xlabel(f"time [{unit}]")
    if len(of) > 1:
        style.legend_above(figure, panels)
    return figure


def draw_map(ax, picture, name: str, unit: str, limits: tuple[float, float] | None = None, length: str = "m", bar: bool = True):
    """A rendered field, with its colour bar if it is to have one; the image, for a movie to fill anew. length: unit of the places, ""
    of those without one."""
    look = fields.look(name)
    low, high = limits or (np.nanmin(picture.values), np.nanmax(picture.values))
    size, unit = fields.scaled(unit, max(abs(low), abs(high)))
    across, length = fields.scaled(length, max(np.abs(picture.extent)))
    logarithmic = look.logarithmic and low > 0 and high > 3 * low
    norm = (plt.matplotlib.colors.LogNorm if logarithmic else plt.Normalize)(low / size, high / size)
    image = ax.imshow(picture.values / size, origin="lower", extent=[edge / across for edge in picture.extent], cmap=look.colours, norm=norm,
                      interpolation="nearest" if picture.sharp or len(picture.names) > 2 else "bilinear")
    image.tetsuame_size, image.tetsuame_across = size, across
    style.as_map(ax, *(np.reshape(picture.extent, (2, 2)) / across))
    for axis, place in zip("xy", picture.axes):
        getattr(ax, f"set_{axis}label")(f"{'xyz'[place]}{fields.bracketed(length)}")
    if bar:
        style.colour_bar(ax.figure, image, ax, fields.label(name, unit), picture.names, shrink=0.85)
    return image


def draw_bodies(ax, snapshot, picture):
    """Particles of the walls within a map of draw_map, in 3-D those in its plane through the middle; None where there are none."""
    places = snapshot.wall("Coordinates")
    if not len(places):
        return None
    edge = float(np.median(snapshot.spacing))
    flat, (left, right, low, high) = places[:, list(picture.axes)], picture.extent
    seen = ((flat > (left, low)) & (flat < (right, high))).all(axis=1)
    for axis in set(range(snapshot.dimension)) - set(picture.axes):
        seen &= np.abs(places[:, axis] - snapshot.lengths[axis] / 2) <= 0.5 * edge
    across, _ = fields.scaled("m", max(np.abs(picture.extent)))
    return style.tiles(ax, flat[seen] / across, 1.02 * edge / across, color=style.GREY) if seen.any() else None


def isolines(ax, picture, levels) -> None:
    """Over a map of draw_map, in the units of the picture's places, from edge to edge."""
    left, right, low, high = picture.extent
    ax.contour(np.r_[left, picture.x, right], np.r_[low, picture.y, high], to_the_edges(picture.values), levels=levels, colors="white",
               linewidths=0.7, alpha=0.85)


def to_the_edges(values: np.ndarray) -> np.ndarray:
    """With a row and a column more at each side, half a pixel beyond the last: as the last two go on."""
    if min(values.shape) < 2:
        return np.pad(values, 1, mode="edge")
    wider = np.pad(values, 1, mode="reflect", reflect_type="odd")
    for axis in (0, 1):
        for edge, last in ((0, 1), (-1, -2)):
            rows = np.moveaxis(wider, axis, 0)
            rows[edge] = 0.5 * (rows[edge] + rows[last])
    return wider


def wide(picture) -> float:
    """A picture's width over its height."""
    left, right, low, high = picture.extent
    return (right - left) / (high - low)


def when(snapshot) -> str:
    size, unit = fields.scaled("s", snapshot.time)
    return f"t = {snapshot.time / size:.4g} {unit}"


def maps(snapshot, names: list[str], pixels: int = 400):
    """A panel for each field; in 3-D the slice through the middle."""
    pictures = [snapshot.map(name, pixels) for name in names]
    figure, panels = style.map_panels(len(names), wide(pictures[0]), 2)
    for ax, name, picture in zip(panels, names, pictures):
        draw_map(ax, picture, name, snapshot.unit(name), fields.limits([snapshot], name) if fields.is_water(snapshot) else None)
        draw_bodies(ax, snapshot, picture)
        ax.set_title(when(snapshot))
    return figure


def views(snapshot):
    """Water in three dimensions, whole and with its nearer half cut away, by its speed."""
    fastest = max(fields.limits([snapshot], "Speed")[1], 1e-300)
    figure, panels = style.panels(2, 2, 0.45 * style.WIDTH * scene.tall(snapshot) + 0.25)
    for ax, cut in zip(panels, (None, 0.5 * snapshot.lengths[2])):
        scene.draw(ax, snapshot, 760, fastest, cut)
    panels[0].set_title(when(snapshot))
    scene.speed_bar(figure, panels, fastest)
    return figure


def profiles(of: list, names: list[str], axis: int | None = None):
    """Layer means of the fields of several snapshots: (title, snapshot); of bodies that attract themselves by_radius()."""
    if axis is None and all("GravitationalPotential" in snapshot for _, snapshot in of):
        return by_radius(of, names)
    last = min(1, of[0][1].dimension - 1) if axis is None else axis
    figure, panels = style.panels(len(names), min(len(names), 4), 3.2)
    for ax, name in zip(panels, names):
        lines = []
        for title, snapshot in of:
            places, values = snapshot.profile(name, axis)
            filled = np.isfinite(values)  # a layer may lie between two particles
            lines.append((title, places[filled], values[filled]))
        size, unit = fields.scaled(of[0][1].unit(name), max((np.abs(values).max() for _, _, values in lines if len(values)), default=0.0))
        across, length = fields.scaled("m", max((places.max() for _, places, _ in lines if len(places)), default=1.0))
        for index, (title, places, values) in enumerate(lines):
            # A height stands upright.
            ax.plot(*((places / across, values / size) if last == 0 else (values / size, places / across)), **style.numbered(index), label=title)
        labels = fields.label(name, unit), f"{'xyz'[last]} [{length}]"
        ax.set(**dict(zip(("ylabel", "xlabel") if last == 0 else ("xlabel", "ylabel"), labels)))
    if len(of) > 1:
        style.legend_above(figure, panels)
    return figure


def by_radius(of: list, names: list[str]):
    """The fields of bodies that attract themselves, of every particle over its distance from the deepest place; but for the last hundredth, which may have
    flown far away. of: (title, snapshot)."""
    figure, panels = style.panels(len(names), min(len(names), 4), 3.2)
    for ax, name in zip(panels, names):
        points = []
        for title, snapshot in of:
            places, potential = snapshot["Coordinates"], snapshot["GravitationalPotential"]
            deepest = potential <= np.quantile(potential, 0.002)
            r = np.linalg.norm(places - places[deepest].mean(axis=0), axis=1)
            near = r <= np.quantile(r, 0.99)
            points.append((title, r[near], snapshot[name][near]))
        size, unit = fields.scaled(of[0][1].unit(name), max(np.abs(values).max() for _, _, values in points))
        across, length = fields.scaled("m", max(r.max() for _, r, _ in points))
        for index, (title, r, values) in enumerate(points):
            ax.plot(r / across, values / size, ".", markersize=2 if index else 5, color=style.numbered(index)["color"], label=title, rasterized=True)
        ax.set(xlabel=f"radius [{length}]", ylabel=fields.label(name, unit), xlim=(0, None))
    if len(of) > 1:
        style.legend_above(figure, panels)
    return figure


def make(run: runs.Run, target: Path, wanted: list[str] | None = None, time: float | None = None) -> list[Path]:
    """history.png, gauges.png, map.png, view.png and profile.png, as far as there is something to draw, and where they are."""
    figures = {"history": histories([("", run)]), "gauges": gauges.draw([("", run.directory)])}
    if run.snapshots:
        last = run.snapshot(time)
        names = fields.shown(last, wanted)
        if last.dimension > 1:
            figures["map"] = maps(last, names)
        if last.dimension == 3 and fields.is_water(last) and "Speed" in last:
            figures["view"] = views(last)
        figures["profile"] = profiles([(when(snapshot), snapshot) for snapshot in dict.fromkeys((run.snapshots[0], last))], names)
    drawn = {writing.folder(target) / f"{name}.png": picture for name, picture in
             {name: style.png(figure) for name, figure in figures.items() if figure is not None}.items()}
    for path, picture in drawn.items():
        writing.contents(path, picture)
    return list(drawn)


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="tetsuame plot", description="Draws a run: its history, what its gauges read, maps and profiles of its fields.")
    parser.add_argument("directory", metavar="DIR", help="of the run")
    parser.add_argument("--fields", metavar="A,B", type=lambda text: text.split(","), help="instead of the first few that vary")
    parser.add_argument("--time", type=float, help="of the snapshot that is drawn, s (the last)")
    parser.add_argument("--output", metavar="FOLDER", type=Path, help="for the pictures (DIR/plots)")
    o = parser.parse_args(arguments)
    if o.time is not None and not np.isfinite(o.time):
        parser.error("--time is a number")
    run = runs.Run(o.directory)
    print("\n".join(map(str, make(run, o.output or run.directory / "plots", o.fields, o.time))))
    return COMPLETED
