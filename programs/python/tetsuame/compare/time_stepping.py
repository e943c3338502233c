"""Error against right-hand sides: which time integration is the cheapest for a given error, and what bounds its steps."""
import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .. import pages, style
from ..runs import Snapshot, by_id
from . import orders
from .cases import Run
from .outcomes import COMPLETED, Outcome
from .parts import chosen, count, said, state_class

NAME = "time_stepping"
TITLE = "Time integration: error against right-hand sides"
ABOUT = "Run four problems with every time integration at many step sizes; find the cheapest for a given error."
INTRODUCTION = "The same particles from the same start, by Runge–Kutta methods with equal steps, with steps from an error estimate, and by the " \
               "methods stabilised for diffusion. Error: rms over the particles of the distance from where a run with very small steps has " \
               "them, over the rms way that they went there; of convection, where particles are shifted by a part of each step, the larger " \
               "relative error of Nu (volume) and v_rms at the end. Errors of the discretisation in space are in both and do not show."
TARGETS = (1e-2, 1e-3, 1e-4)
REFERENCE, OWN = "reference", "as shipped"


@dataclass(frozen=True)
class Case:
    """A problem. step: s, near where four-stage methods become unstable; the fixed steps are parts of it."""
    program: str
    input: str
    about: str
    t_end: float
    step: float
    finest: int                   # the reference's step is `step` over this
    settings: tuple[str, ...] = ()
    stabilised: bool = False      # the program has methods for diffusion
    columns: tuple[str, ...] = ()  # of history.csv, by which the error is judged; none: the particles' ways
    seconds: float = 1.0          # of a run with 4 right-hand sides for each `step`


CASES = {
    "column": Case("disph_f", "hydrostatic_column", "the column of program F below 10 GPa, its lattice disturbed by a tenth of a spacing, one "
                   "crossing of sound", 17.0, 0.7, 64, ("domain.jitter=0.1", "initial.pressure=1e10", "time.steps=1000000000",
                                                        "output.interval=17"), seconds=0.3),
    "overturn": Case("rti", "rti_note", "metal over silicate in the note's box at 6e11 Pa s, 24 × 24 particles, half of the overturn",
                     2500.0, 20.0, 64, ("domain.particles_x=24", "domain.particles_y=24", "rti.viscosity_upper=6e11",
                                        "rti.viscosity_lower=6e11", "output.interval=2500"), stabilised=True, seconds=1.0),
    "stiff overturn": Case("rti", "rti_note", "the same at 2e13 Pa s, 16 × 16 particles: steps are bound by diffusion of momentum",
                           400.0, 3.0, 16, ("domain.particles_x=16", "domain.particles_y=16", "rti.viscosity_upper=2e13",
                                           "rti.viscosity_lower=2e13", "output.interval=400"), stabilised=True, seconds=0.6),
    "sod": Case("shock", "sod", "Sod's tube by Godunov DISPH, 400 particles", 0.2, 2e-3, 64, ("output.interval=0.2",), seconds=0.8),
    "convection": Case("convection", "air_1e4", "air in a square at Ra 1e4, 16 × 16 particles, its first overshoot from rest", 40.0, 0.4, 64,
                       ("domain.particles_x=16", "domain.particles_y=16", "output.interval=40"), stabilised=True,
                       columns=("nusselt_volume", "v_rms"), seconds=0.3),
}
PROGRAMS = tuple(sorted({case.program for case in CASES.values()}))
FIXED = {"euler": 1, "order_2": 2, "order_3": 3, "order_4": 5, "order_5": 7, "ssp_rk3": 3, "rk4": 4}  # right-hand sides a step
STABILISED = ("rkc2", "rkl2")
RTOL = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5)
ADAPTIVE_ORDERS = (2, 3, 5)
PARTS, QUICK_PARTS = (1, 2, 4, 8), (1, 4)  # of Case.step


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--cases", default=",".join(CASES), metavar="NAME,…", help="problems to run (default: %(default)s)")


def plan(given: argparse.Namespace, root: Path, parser: argparse.ArgumentParser) -> list[Run]:
    names = chosen("--cases", "problem", given.cases, ",", CASES, parser)
    return [run for name in names for run in runs_of(name, CASES[name], given, root)]


def runs_of(name: str, case: Case, given: argparse.Namespace, root: Path) -> list[Run]:
    path = root / "inputs" / f"{case.input}.nml"

    def run(method: str, said: str, steps: int, seconds: float, *settings: str) -> Run:
        folder = f"{name}/{method} {said}".replace(" ", "_")
        own = (f"time.t_end={case.t_end:g}", *case.settings, *settings, *given.settings)
        return Run(case.program, path, name, f"{method} {said}".strip(), folder, method, own, steps, seconds=seconds)

    def fixed(method: str, part: int, label: str = "") -> Run:
        steps = round(part * case.t_end / case.step)
        return run(label or method, f"{steps} steps", 0 if label else steps, case.seconds * part * FIXED[method] / 4,
                   f"time.method={method}", f"time.dt={case.t_end / steps:.17g}")

    found = [fixed("rk4", case.finest, REFERENCE), run(OWN, "", 0, case.seconds)]
    for method, stages in FIXED.items():
        parts = QUICK_PARTS if given.quick else (*PARTS, *((16, 32) if stages == 1 else ()))
        found += [fixed(method, part) for part in parts if part < case.finest]
    tolerances = RTOL[:3] if given.quick else RTOL
    for order in ADAPTIVE_ORDERS:
        found += [run(f"adaptive, order {order}", f"rtol {rtol:g}", 0, case.seconds, "time.method=adaptive", f"expert.time_order={order}",
                      f"time.rtol={rtol:g}") for rtol in tolerances]
    for method in STABILISED if case.stabilised else ():
        found += [run(method, f"rtol {rtol:g}", 0, case.seconds, f"time.method={method}", f"time.rtol={rtol:g}") for rtol in tolerances]
    return found


def row(outcome: Outcome, outcomes: list[Outcome]) -> dict | None:
    if outcome.case.variant == REFERENCE:
        return None
    reference = next((o for o in outcomes if o.case.variant == REFERENCE and o.case.file == outcome.case.file), None)
    done = outcome.kind == COMPLETED and reference is not None and reference.kind == COMPLETED
    lists, total = outcome.stages.get("lists", 0.0), sum(outcome.stages.values())
    return {"how": outcome.case.label, "error": error(outcome, reference) if done else None, "attempts": outcome.number("attempts"),
            "steps": outcome.number("steps"), "rejections": outcome.number("rejections"),
            "bound_by": outcome.summary.get("steps_limited_by") or {}, "lists_share": lists / total if total > 0 else None}


def error(outcome: Outcome, reference: Outcome) -> float | None:
    columns = CASES[outcome.case.file].columns
    if not columns:
        return distance(outcome, reference)
    return max(abs(float(outcome.history[name][-1] / reference.history[name][-1]) - 1.0) for name in columns)


def distance(outcome: Outcome, reference: Outcome) -> float | None:
    """rms |x − x_reference| over rms |x_reference − x_start|, the nearest image where the box is periodic."""
    start = Snapshot(sorted(reference.folder.glob("snapshot_*.h5"))[0])

    def rms(first: Snapshot, second: Snapshot) -> float:
        here, there = by_id(first, second, "Coordinates")
        way = (here - there)[:, :first.dimension]
        way -= np.where(first.periodic, first.lengths * np.round(way / first.lengths), 0.0)
        return float(np.sqrt((way**2).sum(axis=1).mean()))

    length = rms(reference.snapshot, start)
    return rms(outcome.snapshot, reference.snapshot) / length if length > 0.0 else None


def judged(one: dict) -> dict[str, tuple[float, float]]:
    """Errors of equal steps, for their order over the number of steps; from one on the method has blown up or is not yet its order."""
    return {"way": (one["error"], 0.0)} if one["error"] is not None and one["n"] and one["error"] < 0.1 else {}


def sections(_outcomes: list[Outcome], measured: dict, folder: Path) -> list[str]:
    names = list(dict.fromkeys(one["case"] for one in measured["runs"]))
    return [pages.section("The cheapest", pages.paragraph(
                "Of all runs of a problem the one with the fewest right-hand sides among those whose error is not larger than the target."),
                cheapest_table(measured, names)),
            pages.section("Error against right-hand sides", pages.figure(
                work(measured, names), folder / "work.png",
                "Each point a run, equal steps of one method joined by full lines, error control by dashed ones; red cross: what the input as "
                "shipped does. Missing points: the run stopped.")),
            *(pages.section(f"{name}: {CASES[name].about}", case_table(measured, name)) for name in names)]


def work(measured: dict, names: list[str]):
    figure, (*axes, key) = style.panels(len(names) + 1, 3, 3.6, "error")
    lines = {}
    for ax, name in zip(axes, names):
        runs = [one for one in measured["runs"] if one["case"] == name and one["error"] and one["right_hand_sides"]]
        for method in dict.fromkeys(one["variant"] for one in runs):
            points = sorted((one["right_hand_sides"], one["error"]) for one in runs if one["variant"] == method)
            adaptive = method not in FIXED
            (lines[method],) = ax.plot(*zip(*points), color=colour(method), linestyle="--" if adaptive else "-", linewidth=1.1,
                                       marker="x" if method == OWN else "o", markersize=7 if method == OWN else 3.5,
                                       zorder=5 if method == OWN else 3)
        ax.set(xscale="log", yscale="log", title=name, xlabel="right-hand sides")
        for target in TARGETS:
            ax.axhline(target, color=style.GREY, linewidth=0.6, linestyle=":")
    key.axis("off")
    key.legend(lines.values(), lines, fontsize=8, loc="upper left")
    return figure


def colour(method: str) -> str:
    if method == OWN:
        return style.ALARM
    return style.METHOD.get(method) or style.ADAPTIVE[int(method[-1])]


def cheapest(runs: list[dict], target: float) -> dict | None:
    """The completed run with the fewest right-hand sides whose error is at most the target."""
    fit = [one for one in runs if one["error"] is not None and one["error"] <= target]
    return min(fit, key=lambda one: one["right_hand_sides"], default=None)


def cheapest_table(measured: dict, names: list[str]) -> str:
    def shown(name: str, target: float) -> str:
        one = cheapest([run for run in measured["runs"] if run["case"] == name], target)
        return pages.cell("none" if one is None else f"{one['how']}: {count(one['right_hand_sides'])}")

    def shipped(name: str) -> str:
        one = next(run for run in measured["runs"] if run["case"] == name and run["variant"] == OWN)
        return pages.cell(f"{said(one['error'], '{:.1e}')}: {count(one['right_hand_sides'])}", state_class(one["outcome"]))

    return pages.columns(names, {"Problem": pages.name, **{f"error ≤ {target:g}": lambda name, target=target: shown(name, target)
                                                           for target in TARGETS}, "as shipped, error": shipped})


def case_table(measured: dict, name: str) -> str:
    runs = [one for one in measured["runs"] if one["case"] == name]

    def bound(one: dict) -> str:
        limits = sorted(one["bound_by"].items(), key=lambda item: -item[1])
        return pages.cell(", ".join(f"{what} {number}" for what, number in limits) or one["reason"] or "")

    def order(one: dict) -> str:
        finest = max(run["n"] for run in runs if run["variant"] == one["variant"])
        return pages.number(orders.of(measured, name, one["variant"]) if one["n"] and one["n"] == finest else "")

    return pages.columns(runs, {
        "Method": lambda one: pages.name(one["how"], colour(one["variant"])),
        "outcome": lambda one: pages.cell(one["outcome"], state_class(one["outcome"])),
        "right-hand sides": lambda one: pages.number(count(one["right_hand_sides"])),
        "error": lambda one: pages.error(one["error"], said(one["error"], "{:.1e}")), "order": order,
        "rejected": lambda one: pages.number(count(one["rejections"])),
        "steps bound by": bound,
        "lists": lambda one: pages.number(said(one["lists_share"] and 100 * one["lists_share"], "{:.0f} %")),
        "seconds": lambda one: pages.number(said(one["seconds"]))}, "wide", lambda one: one["variant"])


def terminal(_outcomes: list[Outcome], measured: dict) -> list[str]:
    lines = [f"{'problem':<16}" + "".join(f"{f'error <= {target:g}':<34}" for target in TARGETS)]
    for name in dict.fromkeys(one["case"] for one in measured["runs"]):
        runs = [run for run in measured["runs"] if run["case"] == name]
        found = [cheapest(runs, target) for target in TARGETS]
        lines.append(f"{name:<16}" + "".join(f"{'none' if one is None else '{how}: {right_hand_sides:.0f}'.format(**one):<34}" for one in found))
    return lines
