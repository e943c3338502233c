"""The balancer's default method, the quasi-Newton step and Zoltan's partitioners on the same particles and costs."""
import argparse
from dataclasses import dataclass
from html import escape
from pathlib import Path

import numpy as np

from .. import pages, style
from .cases import Run
from .outcomes import COMPLETED, Outcome
from .parts import chosen, said

NAME = "balance"
TITLE = "Load balance: the quasi-Newton step beside the others"
ABOUT = "Run balance (virtual ranks) with both of its methods and Zoltan's on the bowl, a blast, a free surface and ranks of unequal speed."
PROGRAMS = ("balance", "shock", "rti")
BALANCED = 0.05  # (max - min)/mean of the ranks' times
MOVE = ("schedule.move=always", "schedule.updates=25", "schedule.steps=2600")
EQUAL_CELLS = ("distribution.kind=snapshot", "schedule.start=equal_size")  # as a run starts
METHODS = {"remap": style.BLUE, "level_relaxation": style.VERMILION}
PARTITIONERS = {"rcb": style.ORANGE, "hsfc": style.PINK}


@dataclass(frozen=True)
class Case:
    about: str
    input: str
    settings: tuple[str, ...] = ()
    seconds: float = 1.0
    snapshot: tuple[str, str, tuple[str, ...], float] | None = None  # whose last one it is: program, input, settings, seconds
    quick: bool = True


CASES = {
    "bowl_2e5": Case("bowl, 2e5 particles, 484 ranks", "balance_bowl", ("distribution.particles=200000",)),
    "bowl_2e6": Case("bowl, 2e6 particles, 484 ranks", "balance_bowl", (), 12.0, quick=False),
    "slow_half": Case("half of 256 ranks 10 % slower, 1e6 particles", "balance_slow_half", (), 6.0, quick=False),
    "slow_bowl": Case("bowl, 2e6 particles, half of 484 ranks twice as slow", "balance_bowl",
                      ("machine.slow_fraction=0.5", "machine.slow_factor=2"), 12.0, quick=False),
    "blast": Case("Sedov's blast in 3-D, 4096 particles, 8 ranks", "balance_bowl", (*EQUAL_CELLS, "machine.ranks=8"),
                  1.0, ("shock", "sedov_octant", ("domain.particles_x=16",), 20.0)),
    "free_surface": Case("the poster's free surface, 2304 particles, 8 ranks", "balance_bowl", (*EQUAL_CELLS, "machine.ranks=8"),
                         1.0, ("rti", "rti_poster", ("time.t_end=1000", "output.interval=1000"), 30.0), False),
}


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--cases", metavar="NAME,…", help=f"(default: {','.join(CASES)}; with --quick those that are quick)")
    parser.add_argument("--partitioners", metavar="NAME,…", default=",".join(PARTITIONERS),
                        help="Zoltan's (default: %(default)s); none: balance is built without Zoltan")


def plan(given: argparse.Namespace, root: Path, parser: argparse.ArgumentParser) -> list[Run]:
    names = ",".join(name for name, case in CASES.items() if case.quick or not given.quick)
    others = () if given.partitioners == "none" else chosen("--partitioners", "partitioner", given.partitioners, ",", PARTITIONERS, parser)
    compared = ",".join(f"'{name}'" for name in others) or "'none'"
    runs = []
    for name in chosen("--cases", "case", given.cases or names, ",", CASES, parser):
        case, start = CASES[name], None
        if case.snapshot:
            program, source, settings, seconds = case.snapshot
            start = run(root, program, source, name, "particles", settings, seconds)
            runs.append(start)
        for method in METHODS:
            own = (f"balancer.method={method}", f"compare.methods={compared if method == 'remap' else chr(39) + 'none' + chr(39)}")
            runs.append(run(root, "balance", case.input, name, method, (*MOVE, *case.settings, *own, *given.settings), case.seconds, start))
    return runs


def run(root: Path, program: str, source: str, case: str, variant: str, settings: tuple[str, ...], seconds: float, start: Run | None = None) -> Run:
    return Run(program, root / f"inputs/{source}.nml", case, f"{variant}, {case}", f"{case}/{variant}", variant, settings, seconds=seconds,
               start=start, start_key="distribution.file")


def courses(outcome: Outcome) -> dict[str, str]:
    """Of each method in a run, what its columns and metrics begin with."""
    if outcome.case.binary != "balance" or outcome.kind != COMPLETED:
        return {}
    found = {outcome.case.variant: ""}
    return found | {name: f"{name}_" for name in PARTITIONERS if outcome.number("metrics", f"{name}_spread_final") is not None}


# ---- what is measured -------------------------------------------------------------------------

def row(outcome: Outcome, _outcomes: list[Outcome]) -> dict:
    methods = {}
    for name, prefix in courses(outcome).items():
        measured = {key: outcome.number("metrics", prefix + metric) for key, metric in
                    (("start", "spread_initial"), ("end", "spread_final"), ("updates_to_5_percent", "updates_to_5_percent"),
                     ("moved", "migrated_fraction"), ("run_time", "run_time_balanced"))}
        methods[name] = measured | {"spread": [float(value) for value in outcome.history[f"{prefix}spread"]]}
    return {"methods": methods, "run_time_equal_counts": outcome.number("metrics", "run_time_equal_counts")}


def judged(_one: dict) -> dict[str, tuple[float, float]]:
    return {}


def lines(measured: dict) -> list[dict]:
    """One for each case and method."""
    return [{"case": one["case"], "method": name, "kept": one["run_time_equal_counts"], **found}
            for one in measured["runs"] for name, found in one["methods"].items()]


def factor(count: int, omega: float, levels: int = 30) -> float:
    """By which an update of the quasi-Newton step multiplies the slowest error near the balance: Jacobi's iteration on groups of 2^l of
    `count` slabs, from coarse to fine. For times t of slabs of one density, a border that moves passes time from one group to the other."""
    step = np.eye(count)
    coarsest = min(levels, (count - 1).bit_length() - 1)  # two groups
    for level in range(coarsest, -1, -1):
        borders = np.unique(np.minimum(np.arange(0, count + (1 << level), 1 << level), count))
        slabs = np.diff(borders)
        means = np.add.reduceat(step, borders[:-1], axis=0) / slabs[:, None]
        passes = omega * np.diff(means, axis=0) / (1 / slabs[1:] + 1 / slabs[:-1])[:, None]
        gained = np.zeros_like(means)
        gained[:-1] += passes
        gained[1:] -= passes
        step = step + np.repeat(gained / slabs[:, None], slabs, axis=0)
    return float(np.abs(np.linalg.eigvals(step @ (np.eye(count) - 1.0 / count))).max())


# ---- the page ---------------------------------------------------------------------------------

def verdict(measured: dict) -> str:
    found = [one for one in lines(measured) if one["method"] == "level_relaxation"]
    never = [CASES[one["case"]].about for one in found if min(one["spread"]) > BALANCED]
    if not never:
        return "At its default relaxation the quasi-Newton step comes below 5 % in every case."
    return (f"At its default relaxation the quasi-Newton step comes below 5 % in {len(found) - len(never)} of {len(found)} cases; "
            f"not in: {'; '.join(never)}.")


def sections(_outcomes: list[Outcome], measured: dict, folder: Path) -> list[str]:
    found = lines(measured)
    if not found:
        return [pages.paragraph("No run of balance was completed.", "bad")]
    colour = METHODS | PARTITIONERS
    columns = {"": lambda one: pages.cell(escape(CASES[one["case"]].about)), "method": lambda one: pages.name(one["method"], colour[one["method"]]),
               "spread at first": lambda one: pages.number(percent(one["start"])), "largest": lambda one: pages.number(percent(max(one["spread"]))),
               "at the end": lambda one: pages.number(percent(one["end"])),
               "updates to 5 %": lambda one: pages.number(said(one["updates_to_5_percent"], "{:.0f}")),
               "moved, in all": lambda one: pages.number(percent(one["moved"])),
               "run time, s": lambda one: pages.number(said(one["run_time"], "{:.4g}")),
               "first cuts kept": lambda one: pages.number(said(one["kept"], "{:.4g}"))}
    omegas, counts = (1.0, 0.6, 2.0 / 3.0), (8, 22, 128)
    rows = [[pages.cell(f"ω = {omega:.2f}"),
             *(pages.number(f"{factor(n, omega, levels):.3f}") for levels in (0, 30) for n in counts)] for omega in omegas]
    head = ["", *(f"{n} slabs, {what}" for what in ("no levels", "levels") for n in counts)]
    return [pages.section("The answer", pages.paragraph(escape(verdict(measured)))),
            pages.section("Spread and cost", pages.columns(found, columns, "wide", lambda one: one["case"]), pages.small(
                "Spread: (max − min)/mean of the ranks' times. Each of 25 decisions, 100 steps apart, moves our cuts; Zoltan's partitioners start "
                "from their own equal counts and see each particle's cost. Times by the model of the input; moved: of all particles.")),
            pages.section("By decision", pages.figure(drawn(found), folder / "spread.png", "Dotted: 5 %.")),
            pages.section("Why ω = 2/3", pages.paragraph(
                "By what an update multiplies the slowest error near the balance, where slabs have one density (computed here)."),
                pages.table(head, rows))]


def drawn(found: list[dict]):
    cases = list(dict.fromkeys(one["case"] for one in found))
    figure, axes = style.panels(len(cases), 3, 2.9, "spread (%)")
    for ax, case in zip(axes, cases):
        for one in found:
            if one["case"] == case:
                ax.plot(100 * np.maximum(one["spread"], 1e-4), marker="o", markersize=2.5, linewidth=1.2,
                        color=(METHODS | PARTITIONERS)[one["method"]], label=one["method"])
        ax.axhline(100 * BALANCED, color=style.INK, linestyle=":", linewidth=0.8)
        ax.set_yscale("log")
        ax.set_title(CASES[case].about, fontsize=8)
        ax.set_xlabel("decision")
    axes[0].legend(fontsize=7)
    return figure


def percent(value: float | None) -> str:
    return said(value and 100 * value, "{:.3g} %")


def terminal(_outcomes: list[Outcome], measured: dict) -> list[str]:
    return [f"{CASES[one['case']].about:<54}{one['method']:<18}{percent(one['start']):>8} → {percent(one['end']):>8}"
            f"{said(one['updates_to_5_percent'], '{:.0f}'):>5} updates to 5 %, {said(one['run_time']):>6} s"
            for one in lines(measured)] + [verdict(measured)]
