"""Water with a free surface: at rest, waves, dam breaks beside what was measured of them."""
import argparse
import dataclasses
import math
import shutil
from dataclasses import dataclass
from html import escape
from pathlib import Path

import numpy as np

from .. import gauges, pages, style
from . import flow_bodies as bodies
from . import flow_bodies_figures as body_figures
from . import flow_figures as figures
from . import flow_questions as questions
from . import flow_views as views
from . import orders
from .cases import Run, of_size
from .outcomes import COMPLETED, Outcome
from .parts import chosen, count, error_cell, said, state_class

NAME = "flow"
TITLE = "Water with a free surface beside theory and experiments"
ABOUT = "Run flow on water at rest, a wave, a drop and dam breaks at several resolutions; compare with exact solutions and measurements."
PROGRAMS = ("flow",)
PARTS = ("rest", "tanks", "waves", "columns", "box", "bodies", "bowl", "building")


@dataclass(frozen=True)
class Case:
    """An input. n: particles in `unit`, the length that the problem is told in; `along`: lengths of the box in it."""
    input: str
    part: str
    about: str
    unit: float                    # m
    along: tuple[float, ...]
    n: tuple[int, ...]
    quick: tuple[int, ...]
    usual: int                     # the n of `seconds`
    seconds: float                 # of one core, as the input ends
    settings: tuple[str, ...] = ()
    t_end: float = 0.0             # s, of the input
    ends: tuple[tuple[int, bool, float], ...] = ()  # n, whether quick, another t_end
    ranks: tuple[int, ...] = (1,)


CASES = {
    "still_wedge": Case("still_wedge", "rest", "over a wedge", 1.0, (2.0, 1.2), (25, 50), (25,), 50, 150.0,
                        ("output.interval=0", "output.history_interval=20"), 31.93),
    "still_wedge_3d": Case("still_wedge_3d", "rest", "the same in three dimensions, a tank as wide as deep, periodic along the wedge", 1.0,
                           (1.0, 1.2, 0.4), (20,), (20,), 20, 175.0, ("output.interval=0", "output.history_interval=20"), 31.93,
                           ((20, True, 3.193),)),
    "tilted_tank": Case("tilted_tank", "tanks", "in a closed tank at 20 degrees", 1.0, (1.2, 1.0), (50,), (50,), 50, 90.0, t_end=46.0,
                        ends=((50, True, 4.0),)),
    "stl_tank": Case("stl_tank", "tanks", "in a closed tank of triangles, in three dimensions", 1.0, (1.2, 1.0, 0.6), (20,), (), 20, 1400.0,
                     ("output.interval=0",), 115.0, ((20, False, 4.6),)),
    "standing_wave": Case("standing_wave", "waves", "a standing wave, five periods", 1.0, (2.0, 1.2), (10, 25, 50), (10, 25), 50, 34.0,
                          t_end=5.7),
    "elliptical_drop": Case("elliptical_drop", "waves", "a drop that is drawn out", 1.0, (4.4, 4.4), (25, 50), (25, 50), 50, 3.5,
                            ("output.interval=0.0019",), t_end=0.0076),
    "dam_break_2d": Case("dam_break_2d", "columns", "a column of 0.3 m against a wall", 0.3, (1.61 / 0.3, 2.0), (30, 60, 90), (30, 60), 60, 30.0,
                         ("output.interval=0.025",), 0.875),
    "dam_break_front": Case("dam_break_front", "columns", "the front of a column of 0.6 m", 0.6, (1.61 / 0.6, 1.5), (30, 60, 120), (30, 60),
                            60, 8.0, t_end=0.4),
    "dam_break_martin_moyce": Case("dam_break_martin_moyce", "columns", "the front of a column of 114 mm", 0.1143, (2.5, 1.0), (20, 40, 80),
                                   (20, 40), 40, 0.8, t_end=0.19),
    "dam_break_square_column": Case("dam_break_square_column", "columns", "the front of a square column of 57 mm", 0.05715, (8.0, 1.0),
                                    (20, 40), (20,), 40, 9.0, t_end=0.26),
    "dam_break_box": Case("dam_break_box", "box", "a tank of 3.22 m with a box on its floor, in three dimensions", 1.0, (3.22, 1.0, 1.0),
                          (25, 50), (25,), 50, 560.0, ("output.interval=0.05",), 1.0, ((25, False, 4.0),)),
    "sloshing": Case("sloshing", "bodies", "a tank that is pushed", 0.4, (4.0, 2.0), (10, 20), (10,), 20, 32.0, ("output.interval=0",), 8.0),
    "floating_box": Case("floating_box", "bodies", "a box that heaves until it floats", 0.1, (32.0, 8.0), (5,), (5,), 5, 45.0,
                         ("output.interval=0",), 5.0, ((5, True, 1.0),)),
    "bowl": Case("bowl", "bowl", "water that sloshes in a hemisphere", 1.0, (1.2, 1.0, 1.2), (25,), (25,), 25, 60.0, t_end=2.0,
                 ends=((25, True, 0.5),)),
    "bowl_ranks": Case("bowl", "bowl", "its first quarter of a second, on several ranks", 1.0, (1.2, 1.0, 1.2), (25,), (), 25, 15.0,
                       ("output.interval=0",), 0.25, ranks=(1, bodies.RANKS)),
    "dam_break_building": Case("dam_break_building", "building", "a dam break through a building", 0.12, (30.0, 12.0, 10.0), (3,), (3,), 3, 170.0,
                               t_end=1.6, ends=((3, True, 0.4),)),
}
FRONTS = {"dam_break_front": "Lobovský", "dam_break_martin_moyce": "Martin and Moyce, n² = 2", "dam_break_square_column": "Martin and Moyce, n² = 1"}
LONG = (("dam_break_box", 50, 4.0), ("dam_break_box", 100, 1.0), ("stl_tank", 20, 115.0))
KEPT = ("pressure_", "height_", "front_", "period", "energy_decay", "semi_axis", "kinetic_", "hydrostatic_", "particles_put_back")  # of metrics


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--parts", default=",".join(PARTS), metavar="NAME,…", help="parts to run (default: %(default)s)")
    parser.add_argument("--long", action="store_true",
                        help="the tank with a box in earnest too, 4 s with a spacing of 20 mm, 1 s with 10 mm, and 100 000 steps of the tank of "
                             "triangles (some four hours of one core)")


def plan(given: argparse.Namespace, root: Path, parser: argparse.ArgumentParser) -> list[Run]:
    parts = chosen("--parts", "part", given.parts, ",", PARTS, parser)
    longer = {(name, n): end for name, n, end in LONG if given.long}
    runs = []
    for name, case in CASES.items():
        if case.part not in parts:
            continue
        own = {n: next((end for at, quick, end in case.ends if (at, quick) == (n, given.quick)), case.t_end)
               for n in (case.quick if given.quick else case.n)}
        own |= {n: end for (of, n), end in longer.items() if of == name}
        for n, end in own.items():
            one = run_of(name, case, n, end, root, given.settings)
            runs += [one] if case.ranks == (1,) else on_ranks(one, case.ranks)
    return runs


def on_ranks(one: Run, ranks: tuple[int, ...]) -> list[Run]:
    """Variants of a run; none where there is no mpirun."""
    if shutil.which("mpirun") is None:
        return []
    return [dataclasses.replace(one, variant=(name := bodies.on_ranks(count)), label=f"{one.label}, {name}",
                                folder=f"{one.folder}_{name.replace(' ', '_')}", ranks=count) for count in ranks]


def run_of(name: str, case: Case, n: int, end: float, root: Path, more) -> Run:
    seconds = case.seconds * (n / case.usual)**(len(case.along) + 1) * end / case.t_end
    settings = (*lattice(case, n), f"time.t_end={end:g}", *case.settings, *more)
    return of_size("flow", root / "inputs" / f"{case.input}.nml", "", n, settings, name, max(seconds, 0.3))


def lattice(case: Case, n: int) -> list[str]:
    """Particles along the box; where no whole number fits, the box ends by a part of a spacing later."""
    found = []
    for axis, length in zip("xyz", case.along):
        particles = math.ceil(length * n - 1e-9)
        found.append(f"domain.particles_{axis}={particles}")
        if particles > length * n + 1e-9:
            found.append(f"domain.length_{axis}={particles * case.unit / n:.17g}")
    return found


def judged(one: dict) -> dict[str, tuple[float, float]]:
    """Errors whose fall with n is fitted."""
    return {what: (value, 0.0) for what, value in questions.errors(one).items() if value is not None}


def row(outcome: Outcome, outcomes: list[Outcome]) -> dict | None:
    if outcome.case.variant == bodies.ONE:
        return None  # what others are compared with
    done = outcome.kind == COMPLETED
    metrics = {name: value for name in (outcome.summary.get("metrics") or {}) if done and name.startswith(KEPT)
               and (value := outcome.number("metrics", name)) is not None}
    metrics |= bodies.measured(outcome, outcomes) if done else {}
    return {"time": outcome.number("time"), "particles": outcome.number("fluid_particles"), "dimension": outcome.number("dimension"),
            "mass": outcome.number("conservation", "mass") if done else None, "energy": outcome.number("conservation", "energy") if done else None,
            "metrics": metrics, "kinetic": kinetic(outcome, metrics) if done else None, "rise": rise(outcome) if done else None,
            "semi_axes": semi_axes(outcome) if done and outcome.case.file == "elliptical_drop" else None}


def kinetic(outcome: Outcome, metrics: dict) -> dict[str, float] | None:
    """Over m g H: at the end, at most, and at most after a quarter of the time."""
    history, end = outcome.history, metrics.get("kinetic_energy_over_mgh")
    if not outcome.case.file.startswith("still") or not end or not len(history.get("time", ())):
        return None
    energy = history["kinetic_energy"] * end / history["kinetic_energy"][-1]
    return {"end": end, "largest": float(energy.max()), "late": float(energy[history["time"] > 0.25 * history["time"][-1]].max())}


def rise(outcome: Outcome) -> float | None:
    """The most by which the mechanical energy exceeds what it was at an earlier line of the history, over that at the start."""
    history = outcome.history
    if not len(history.get("time", ())):
        return None
    energy = history["kinetic_energy"] + history["potential_energy"] + history["elastic_energy"]
    return float((energy - np.minimum.accumulate(energy)).max() / abs(energy[0])) if energy[0] else None


def semi_axes(outcome: Outcome) -> dict[str, float]:
    """The longer one, m, at the published times."""
    readings = gauges.read(outcome.folder)
    return {str(t): float(np.interp(t, readings["time"], readings["semi_axis_y"])) for t in questions.SEMI_AXIS}


# ---- the page -----------------------------------------------------------------------------------------


def sections(outcomes: list[Outcome], measured: dict, folder: Path) -> list[str]:
    runs = measured["runs"]
    done = [o for o in outcomes if o.kind == COMPLETED]
    parts = [pages.section("What was asked", questions.table(runs))]
    parts += [section(done, runs, folder) for section in (rest, waves, columns, box, *body_figures.SECTIONS)]
    return [*parts, pages.section("Over resolution", pages.figure(
        orders.convergence(orders.series(runs, judged), look, "error"), folder / "resolution.png",
        f"Relative errors of what the table above has, over n. {orders.LINES}"), errors_table(runs)),
        pages.section("Runs", runs_table(runs))]


def look(case: str, _variant: str, quantity: str) -> tuple[str, str, str]:
    """Title of the panel, label and colour of the curve."""
    if case in FRONTS:
        return "front", FRONTS[case], style.CYCLE[list(FRONTS).index(case)]
    alike = [name for name in questions.QUANTITIES[case] if case not in ("dam_break_2d", "dam_break_box") or name[:4] == quantity[:4]]
    title = plain(case) if len(alike) == len(questions.QUANTITIES[case]) else f"{plain(case)}: {quantity.partition(' ')[0]}"
    return title, quantity.rpartition(" ")[2] if ":" in title else quantity, style.CYCLE[alike.index(quantity)]


def plain(case: str) -> str:
    return case.replace("_3d", ", 3-D").replace("_", " ")


def rest(done: list[Outcome], _runs: list[dict], folder: Path) -> str:
    chosen = figures.of_case(done, "still_wedge", "still_wedge_3d")
    return pages.section("Water at rest", pages.figure(figures.kinetic(chosen), folder / "rest.png",
                                                       "Kinetic energy over m g H. Dotted: the largest asked for."),
                         pages.figure(figures.state(figures.finest(chosen), "Pressure"), folder / "rest_pressure.png",
                                      "The water over the wedge at the end, particle by particle."))


def waves(done: list[Outcome], _runs: list[dict], folder: Path) -> str:
    wave, drop = figures.of_case(done, "standing_wave"), figures.of_case(done, "elliptical_drop")
    return pages.section("A standing wave and a drop", pages.figure(
        figures.waves(wave, drop), folder / "waves.png",
        "Left: the water's velocity along that of the start, black: cos ωt exp(−2νk²t). Right: semi-axes of the drop, black: exact."),
        pages.figure(figures.drop(figures.finest(drop)), folder / "drop.png",
                     "The drop, coloured by pressure; black: the exact ellipse."))


def columns(done: list[Outcome], _runs: list[dict], folder: Path) -> str:
    impact, fronts = figures.of_case(done, "dam_break_2d"), figures.of_case(done, *FRONTS)
    return pages.section("Columns of water that fall", pages.figure(
        figures.pressures(impact, 4), folder / "impact.png",
        "Pressures on the wall ahead, and below them their integrals over time, that is impulses (black: measured [Lobovský et al. 2014]). "
        "A peak that leaves its panel is named."),
        pages.figure(figures.course(figures.finest(impact), figures.TIMES_2D), folder / "impact_course.png",
                     "The finest run, coloured by pressure over ρgH; what is above is as yellow as 1."),
        figures.movie_2d(figures.finest(impact), folder / "dam_break_2d.gif"),
        pages.figure(figures.fronts(fronts), folder / "fronts.png",
                     "How far the front has come (black: measured [Lobovský et al. 2014; Martin and Moyce 1952])."))


def box(done: list[Outcome], _runs: list[dict], folder: Path) -> str:
    tank = figures.of_case(done, "dam_break_box")
    return pages.section("A dam break over a box", pages.figure(
        figures.pressures(tank, 4), folder / "box_pressures.png",
        "Pressures on the face of the box that the water meets, upwards, and their integrals from 0.35 s on (black: measured "
        "[Kleefsman et al. 2005])."),
        pages.figure(figures.heights(tank), folder / "box_heights.png", "Depths of the water behind the box (H1) and before it."),
        pages.figure(views.course(figures.finest(tank), views.TIMES), folder / "box_course.png",
                     "The finest run, coloured by speed; the box is grey."),
        pages.figure(views.later(tank), folder / "box_later.png", "The longest run later on: back from the wall, and over the box again."),
        views.moving(figures.finest(tank), folder / "dam_break_box.gif"))


def errors_table(runs: list[dict]) -> str:
    """Each error of a case at its resolutions."""
    rows, groups = [], []
    for case in dict.fromkeys(one["case"] for one in runs if one["case"] in questions.QUANTITIES):
        own = sorted((one for one in runs if one["case"] == case), key=lambda one: one["n"])
        for what in questions.QUANTITIES[case]:
            cells = [error_cell(questions.errors(one).get(what)) for one in own] + [pages.cell("")] * (3 - len(own))
            rows.append([pages.name(plain(case)), pages.cell(escape(what)), pages.cell(", ".join(str(one["n"]) for one in own)), *cells])
            groups.append(case)
    return pages.table(["Case", "error of", "n", "coarse", "", "fine"], rows, "wide", groups) + pages.error_key()


def runs_table(runs: list[dict]) -> str:
    return pages.columns(runs, {
        "Case": lambda one: pages.name(plain(one["case"])), "about": lambda one: pages.cell(escape(CASES[one["case"]].about)),
        "n": lambda one: pages.number(one["n"]), "Outcome": lambda one: pages.cell(escape(one["outcome"]), state_class(one["outcome"])),
        "particles": lambda one: pages.number(count(one["particles"])), "until, s": lambda one: pages.number(said(one["time"], "{:.4g}")),
        "right-hand sides": lambda one: pages.number(count(one["right_hand_sides"])),
        "put back at a wall": lambda one: pages.number(count(one["metrics"].get("particles_put_back"))),
        "energy": lambda one: error_cell(one["energy"]), "seconds": lambda one: pages.number(said(one["seconds"])),
        "updates/s": lambda one: pages.number(said(one["updates_per_second"], "{:.2e}"))}, "wide", lambda one: one["case"]) + \
        pages.small("n: particles in the water's depth (dam breaks, water at rest, wave, sloshing), in the radius (drop), in a metre (tank with a "
                    "box, bowl), in the draught (floating box), in a column's thickness (building). Updates of a particle a second, one thread "
                    "a rank; other work on the machine shows in it.")


def terminal(_outcomes: list[Outcome], measured: dict) -> list[str]:
    return questions.lines(measured["runs"])
