"""The figures of bodies in water: a pushed tank, a floating box, the bowl, the building."""
import csv
from pathlib import Path

import numpy as np

from .. import gauges, pages, style
from . import flow_bodies as bodies
from . import flow_views as views
from .flow_figures import by_n, curve, finest, of_case
from .outcomes import Outcome

BOWL_TIMES = (0.2, 0.4, 0.6, 1.0, 1.5, 2.0)  # s
BUILDING_TIMES = (0.25, 0.4, 0.6, 0.8, 1.1, 1.6)
FASTEST = 4.0     # m/s, of the water at the building
OPENED = 0.65     # of the tank's width: through the openings before the middle row of columns
SMOOTHED = 0.02   # s, over which readings of forces are averaged


def rest_of(runs: list[Outcome], name: str) -> list[Outcome]:
    return [o for o in runs if len(curve(o, name)[0]) > 1]


def averaged(times: np.ndarray, values: np.ndarray, width: float) -> np.ndarray:
    """Over so many seconds about each reading: an impact's spikes are those of the speed of sound that the run has."""
    count = max(int(round(width / np.median(np.diff(times)))) | 1, 1)
    sums = np.cumsum(np.pad(values, (count // 2 + 1, count // 2), mode="edge"))
    return (sums[count:] - sums[:-count]) / count


def decisions(path: Path, names: tuple[str, ...]) -> list[np.ndarray]:
    """Columns of balance.csv, whose last one is a reason in words; empty without the file."""
    if not path.is_file():
        return [np.empty(0) for _ in names]
    with open(path, newline="", encoding="utf-8") as file:
        heads, *rows = csv.reader(file)
    places = [[head.partition(" ")[0] for head in heads].index(name) for name in names]
    return [np.array([float(row[place]) for row in rows]) for place in places]


def swing(runs: list[Outcome]):
    """The difference of the depths at the tank's ends, beside a swing of the exact period; and the weight."""
    if not (runs := rest_of(runs, "height_2")):
        return None
    figure, (left, right) = style.panels(2, 2, 3.0)
    for look, label, o in by_n(runs):
        readings = gauges.read(o.folder)
        left.plot(readings["time"], 1e3 * (readings["height_2"] - readings["height_1"]), **look, label=label)
        right.plot(readings["time"], -averaged(readings["time"], readings["force_1_y"], SMOOTHED) / bodies.weight(o), **look, label=label)
    readings, (length, depth) = gauges.read(runs[-1].folder), bodies.tank(runs[-1])
    turn, free = bodies.frequency(length, depth, runs[-1].setting("flow.gravity")), readings["time"] > bodies.FREE
    t, h = readings["time"][free], 1e3 * (readings["height_2"] - readings["height_1"])[free]
    begin = t < t[0] + 2.0 * np.pi / turn
    waves = np.column_stack([np.cos(turn * t), np.sin(turn * t)])
    left.plot(t, waves @ np.linalg.lstsq(waves[begin], h[begin], rcond=None)[0], color=style.INK, linewidth=0.9, linestyle="--", zorder=4,
              label="exact period")
    left.set(xlabel="time [s]", ylabel="difference of depths [mm]")
    right.axhline(1.0, color=style.GREY, linestyle=":")
    right.set(xlabel="time [s]", ylabel="force down over the water's weight")
    left.legend(fontsize=8)
    return figure


def heave(runs: list[Outcome]):
    if not (runs := rest_of(runs, "motion_1_y")):
        return None
    figure, (left, right) = style.panels(2, 2, 3.0)
    for look, label, o in by_n(runs):
        readings, metrics = gauges.read(o.folder), bodies.floating(o, [])
        left.plot(readings["time"], 1e3 * readings["motion_1_y"], **look, label=label)
        right.plot(readings["time"], readings["angle_1"], color=style.ORANGE, label="turned by [degrees]")
        right.plot(readings["time"], averaged(readings["time"], readings["force_1_y"], SMOOTHED) / metrics["carried_theory"], **look,
                   label="force up over its weight")
    left.axhline(1e3 * metrics["heave_place_theory"], color=style.INK, linewidth=0.9, linestyle="--", label="Archimedes")
    left.axvspan(*bodies.HEAVES, color=style.GREY, alpha=0.25, linewidth=0, label="lowest first, by theory")
    left.set(xlabel="time [s]", ylabel="heave [mm]")
    right.set(xlabel="time [s]")
    for ax in (left, right):
        ax.legend(fontsize=8)
    return figure


def energies(runs: list[Outcome], ranks: list[Outcome]):
    """Of water in the bowl, and the load of its ranks."""
    runs = [o for o in runs if len(o.history.get("time", ())) > 1]
    if not runs:
        return None
    figure, (left, right) = style.panels(2, 2, 3.0)
    for look, label, o in by_n(runs):
        history = o.history
        total = bodies.mechanical(history)
        left.plot(history["time"], total - total[0], **look, label=f"{label}, all of it")
        left.plot(history["time"], history["kinetic_energy"], **look | {"color": style.ORANGE}, label=f"{label}, kinetic")
    left.axhline(0.0, color=style.GREY, linestyle=":")
    left.set(xlabel="time [s]", ylabel="energy beyond the start's [J]")
    left.legend(fontsize=8)
    for o in ranks:
        steps, *shares = decisions(o.folder / "balance.csv", ("step", "max_over_mean", "particles_max_over_mean"))
        for share, label in zip(shares, (f"load, {o.case.variant}", "particles")):
            if len(steps):
                right.plot(steps, share, label=label)
    if right.lines:
        right.axhline(1.1, color=style.GREY, linestyle=":")
        right.set(xlabel="step", ylabel="largest over mean", ylim=(1.0, None))
        right.legend(fontsize=8)
    else:
        right.remove()
    return figure


def loads(runs: list[Outcome]):
    """Forces on the building, and depths of the water."""
    if not (runs := rest_of(runs, "force_1_x")):
        return None
    figure, (left, middle, right) = style.panels(3, 3, 2.9)
    for look, label, o in by_n(runs):
        readings = gauges.read(o.folder)
        for ax, columns in ((left, {"force_1_x": ("along the flow", -1.0), "force_1_y": ("upwards", 1.0)}),
                            (middle, {"moment_1_z": ("that turns it over", 1.0)})):
            for (column, (what, sign)), colour in zip(columns.items(), (style.BLUE, style.ORANGE)):
                ax.plot(readings["time"], sign * averaged(readings["time"], readings[column], SMOOTHED), **look | {"color": colour}, label=what)
        for k, (where, colour) in enumerate((("before it", style.BLUE), ("beside it", style.ORANGE), ("behind it", style.GREEN)), 1):
            right.plot(readings["time"], readings[f"height_{k}"], **look | {"color": colour}, label=where)
    for ax, what in ((left, "force [N]"), (middle, "moment about its foot [N m]"), (right, "depth [m]")):
        ax.set(xlabel="time [s]", ylabel=what)
        ax.legend(fontsize=8)
    return figure


# ---- sections of the page ---------------------------------------------------------------------------


def moving_bodies(done: list[Outcome], _runs: list[dict], folder: Path) -> str:
    return pages.section("Bodies that move", pages.figure(
        swing(of_case(done, "sloshing")), folder / "sloshing.png",
        "A tank that is pushed aside within 0.7 s. Left: the depth near its right end less that near its left; dashed: the exact period "
        f"2π/√(g k tanh kd), with place and size of the first swing. Right: the water's force on the tank, over {1e3 * SMOOTHED:g} ms."),
        pages.figure(heave(of_case(done, "floating_box")), folder / "floating.png",
                     "A box of half the water's density, let go 3 cm above where it floats."))


def bowl(done: list[Outcome], _runs: list[dict], folder: Path) -> str:
    runs = of_case(done, "bowl")
    best, ranks = finest(runs), [o for o in of_case(done, "bowl_ranks") if o.case.ranks > 1]
    half = 0.5 * best.snapshot.lengths[2] if best else None
    return pages.section("Water in a bowl", pages.figure(
        views.course(best, BOWL_TIMES, views.FASTEST, half), folder / "bowl.png", "The nearer half is cut away; coloured by speed."),
        views.moving(best, folder / "bowl.gif", views.FASTEST, half),
        pages.figure(energies(runs, ranks), folder / "bowl_energy.png",
                     "Left: mechanical energy less that of the start. Right: load and particles of the ranks when cuts were decided on; dotted: "
                     "what is asked."))


def building(done: list[Outcome], _runs: list[dict], folder: Path) -> str:
    runs = of_case(done, "dam_break_building")
    best = finest(runs)
    opened = OPENED * best.snapshot.lengths[2] if best else None
    return pages.section("A dam break through a building", pages.figure(
        views.course(best, BUILDING_TIMES, FASTEST, opened), folder / "building.png",
        "Water comes from the right, passes the ground floor and climbs onto the floor above. What is nearer than the middle of the "
        "openings is cut away; coloured by speed."),
        views.moving(best, folder / "building.gif", FASTEST),
        pages.figure(loads(runs), folder / "building_loads.png",
                     f"The water's force and moment on the building, over {1e3 * SMOOTHED:g} ms, and depths of the water."))


SECTIONS = (moving_bodies, bowl, building)
