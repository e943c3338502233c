"""States at rest, judged: A to F, Y and standard SPH on lattices, jittered lattices and a glass, for a hundred crossings of sound."""
import argparse
import math
from html import escape
from pathlib import Path

import numpy as np

from .. import pages, style
from . import hydrostatic_figures as figures
from . import hydrostatic_prose as prose
from . import table
from .cases import Run
from .outcomes import COMPLETED, CRASHED, Outcome, passes
from .parts import chosen, said, state_class

NAME = "hydrostatic"
TITLE = "Who holds a liquid at rest"
ABOUT = "Run A to F, Y and standard SPH on file 13 from jittered lattices and a glass, for 100 crossings of sound; and what the note leaves open."
SCHEMES = {letter: f"disph_{letter.lower()}" for letter in "ABCDEFY"} | {"SSPH": "ssph"}
PROGRAMS = tuple(SCHEMES.values())

JITTER = {"lattice": 0.0, "jitter 5 %": 0.05, "jitter 10 %": 0.1, "jitter 20 %": 0.2}  # of the spacing
GLASS, MAKING, OPEN, PLAIN = "glass", "making of the glass", "without correction", "plain iteration"
STARTS = (*JITTER, GLASS)
CROSSING = 22.0            # s, of sound through the box: 100 km at 4545 m/s, of the iron at 10 GPa
LONG, SHORT = 100, 20      # crossings; B, whose Newton steps grow long as its pressure falls, and --quick have the short time
STEP = 0.3                 # s: 98 % of the largest at the start, that of the viscosity
VISCOSITY = 1.5e11         # Pa s: equation (18) of the note, c rho_min dx, with its 1e4 m/s and 3000 kg/m3
HOLDS = 1000               # crossings that a particle needs for one spacing, at the rate of the second half of its run: at least
NEWTON = ("hosono.solver=newton",)
WHOLE = ("smoothing.normalise=.true.",)
NO_STEP = ("time.steps=0",)

# What 1 % may be: D (and C beside it) with what differs from the input.
OF_OPEN = {
    "D, file 11": ("disph_d", "11", ()),
    "D, file 12": ("disph_d", "12", ()),
    "D, file 13": ("disph_d", "13", ()),
    "D, file 12, 40 × 40": ("disph_d", "12", (*NO_STEP, "domain.particles_x=40", "domain.particles_y=40")),
    "D, file 12, 60 × 60": ("disph_d", "12", (*NO_STEP, "domain.particles_x=60", "domain.particles_y=60")),
    "D, file 12, cubic spline": ("disph_d", "12", (*NO_STEP, "kernel.name=cubic")),
    "D, file 12, four walls": ("disph_d", "12", (*NO_STEP, "domain.periodic_x=.false.")),
    "C, file 12": ("disph_c", "12", ()),
    "C, file 13": ("disph_c", "13", ()),
}
# Starts of the plain iteration, which goes on to the end of its doubles: where a program stops in it is read off its residuals.
OF_PLAIN = {
    "A, file 11": ("disph_a", "11", ()),
    "A, file 11, sum of one": ("disph_a", "11", WHOLE),
    "A, file 11, sum of one, jitter 1e-8": ("disph_a", "11", (*WHOLE, "domain.jitter=1e-8")),
    "A, file 12": ("disph_a", "12", ()),
    "A, file 12, sum of one": ("disph_a", "12", WHOLE),
    "A, file 12, sum of one, jitter 1e-8": ("disph_a", "12", (*WHOLE, "domain.jitter=1e-8")),
    "B, file 11": ("disph_b", "11", ()),
    "B, file 12": ("disph_b", "12", ()),
}
TOLERANCES = [10.0**-k for k in range(14, 1, -1)]
NOTED = {"A": (2, 2), "B": (1, 2)}  # step and iteration in the note, on both files


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--schemes", metavar="NAME;…", help=f"schemes to run, by semicolons (there are {'; '.join(SCHEMES)})")
    parser.add_argument("--starts", metavar="NAME;…", help=f"starts, by semicolons (there are {'; '.join(STARTS)}; with --quick two of them)")


def plan(given: argparse.Namespace, root: Path, parser: argparse.ArgumentParser) -> list[Run]:
    names = chosen("--schemes", "scheme", given.schemes or ";".join(SCHEMES), ";", SCHEMES, parser)
    starts = chosen("--starts", "start", given.starts or ";".join(("jitter 10 %", GLASS) if given.quick else STARTS), ";", STARTS, parser)
    inputs = root / "inputs"
    made = rest(inputs, "A", MAKING, SHORT, (f"domain.jitter={JITTER['jitter 20 %']}", *given.settings)) if GLASS in starts else None
    runs = [made] if made else []
    for start in starts:
        for name in names:
            crossings = SHORT if given.quick or name == "B" else LONG
            own = () if start == GLASS else (f"domain.jitter={JITTER[start]}",)
            runs.append(rest(inputs, name, start, crossings, (*own, *given.settings), made if start == GLASS else None))
    for case, of in ((OPEN, OF_OPEN), (PLAIN, OF_PLAIN)):
        for name, (binary, file, own) in of.items():
            end = ("hosono.tolerance=1e-15",) if case == PLAIN else ("output.interval=0",)
            runs.append(Run(binary, inputs / f"hydrostatic_{file}.nml", case, name, f"{folder(case)}/{folder(name)}", name,
                            (*own, *end, *given.settings), seconds=0.5))
    return runs


def rest(inputs: Path, name: str, case: str, crossings: int, settings: tuple[str, ...], start: Run | None = None) -> Run:
    """A scheme on file 13, damped, with equal steps near the largest. Ten times it leaves a snapshot."""
    end = crossings * CROSSING
    common = (f"material.viscosity={VISCOSITY:g}", f"time.dt={STEP:g}", "time.steps=1000000", f"time.t_end={end:g}",
              f"output.interval={end / 10:g}", f"output.history_interval={crossings // 2}", *(NEWTON if name in "AB" else ()))
    seconds = {"A": 0.3, "B": 2.5, "D": 0.01}.get(name, 0.03) * crossings
    return Run(SCHEMES[name], inputs / "hydrostatic_13.nml", case, name, f"{folder(case)}/{SCHEMES[name]}", name, (*common, *settings),
               program=name, seconds=seconds, start=start)


def folder(words: str) -> str:
    return "_".join("".join(c if c.isalnum() or c in "-." else " " for c in words).split())


# ---- what a run came to -----------------------------------------------------------------------------------------------


def row(outcome: Outcome, _outcomes: list[Outcome]) -> dict:
    found = {"stopped_step": table.stopped_step(outcome), "time": outcome.number("time"), "steps": outcome.number("steps")}
    if outcome.kind == CRASHED:
        return found
    if outcome.case.file == PLAIN:
        return found | {"residuals": passes(outcome.folder)}
    if outcome.case.file == OPEN:
        own = {name: table.error(outcome, name) for name in ("density_max", "displacement_max_over_dx")}
        return found | errors_of_pressure(outcome.snapshot) | own
    return found | course(outcome)


def errors_of_pressure(snapshot) -> dict:
    """Relative errors of p, several measures; inner: of particles further than two spacings from a wall."""
    if snapshot is None:
        return {}
    error = np.abs(snapshot["Pressure"] / snapshot["PressureReference"] - 1)
    x, dx = snapshot["Coordinates"], snapshot.spacing.mean()
    inner = np.ones(len(x), bool)
    for axis in np.flatnonzero(~snapshot.periodic):
        inner &= (x[:, axis] > 2 * dx) & (x[:, axis] < snapshot.lengths[axis] - 2 * dx)
    return {"pressure_mean": error.mean(), "pressure_rms": math.sqrt((error**2).mean()), "pressure_max": error.max(),
            "pressure_median": float(np.median(error)), "pressure_inner": error[inner].mean()}


def course(outcome: Outcome) -> dict:
    """Of a run at rest. moved, moved_late: from the start and from half time to the end, root mean square in spacings;
    crossings_a_spacing: at the rate of the second half; weight_spread: of Y, standard deviation over mean."""
    states = outcome.snapshots
    if outcome.kind != COMPLETED or len(states) < 3:
        return {}
    half = min(states, key=lambda state: abs(state.time - 0.5 * states[-1].time))
    late, speed = moved(half, states[-1]), math.sqrt((states[-1]["Speed"]**2).mean())
    slowness = (states[-1].time - half.time) / CROSSING / late if late > 0.0 else math.inf
    weight = states[-1]["Weight"]
    return errors_of_pressure(states[-1]) | {
        "moved": moved(states[0], states[-1]), "moved_late": late, "crossings_a_spacing": slowness, "speed": speed,
        "weight_spread": weight.std() / weight.mean(), "verdict": "holds" if slowness >= HOLDS else "drifts"}


def moved(first, last) -> float:
    d = last["Displacement"] - first["Displacement"]
    d -= np.where(last.periodic, last.lengths * np.round(d / last.lengths), 0.0)
    return math.sqrt((d**2).sum(1).mean()) / first.spacing.mean()


def judged(_one: dict) -> dict:
    return {}  # no orders


def dies(residuals: list[float], tolerance: float) -> tuple[int, int] | None:
    """Step and iteration in which a program stops that has a residual below the tolerance for converged, one that grows for
    diverged, no eye for the sign of a pressure but in the pass after, and counts an evaluation to the step that begins with it."""
    step, iteration, before = 1, 0, math.inf
    for residual in residuals:
        iteration += 1
        if iteration > 1 and not residual < before:
            return step, iteration
        if not math.isfinite(residual):
            return step, iteration + 1
        before = residual
        if residual < tolerance:
            step, iteration, before = step + 1, 0, math.inf
    return None


# ---- the page ---------------------------------------------------------------------------------------------------------


def sections(outcomes: list[Outcome], measured: dict, folder: Path) -> list[str]:
    runs = measured["runs"]
    at_rest = [one for one in runs if one["case"] in STARTS]
    return [pages.paragraph(prose.setting(VISCOSITY, STEP, CROSSING, SHORT)),
            pages.section("Who holds, who drifts, who stops", glance(at_rest), full(at_rest)),
            pages.figure(figures.courses(outcomes, STARTS, CROSSING), folder / "courses.png",
                         "Root-mean-square speed, and mean error of the pressure, over time. ×: stopped. The perfect lattice is not shown: "
                         "all but B and D stay as they are, to rounding."),
            pages.section("Where C and E part", *map(pages.paragraph, prose.parting(at_rest, STARTS))),
            pages.section("Without correction, 1 %?", open_table([one for one in runs if one["case"] == OPEN])),
            pages.section("Where A and B die", pages.paragraph(prose.DYING), plain_table([one for one in runs if one["case"] == PLAIN]),
                          pages.figure(figures.chains(outcomes, PLAIN), folder / "chains.png",
                                       "Residuals of the plain iteration by pass, of starts that differ. A program accepts an evaluation in "
                                       "the first pass below its tolerance; where the line rises above it, it diverges. The first pass of "
                                       "B, and of A on file 11 as it is, leaves p &lt; 0 and no residual."))]


def glance(runs: list[dict]) -> str:
    starts = list(dict.fromkeys(one["case"] for one in runs))
    found = {(one["case"], one["variant"]): one for one in runs}
    columns = {"Scheme": lambda name: pages.name(name, style.COLOUR[name]),
               **{start: lambda name, start=start: result(found.get((start, name))) for start in starts}}
    return pages.columns(list(dict.fromkeys(one["variant"] for one in runs)), columns) + pages.error_key(
        f"Holds: at the rate of the second half of the run (root mean square) a particle needs at least {HOLDS} crossings of sound to move "
        f"by a spacing, ten times the run. Percent: mean |p/p_ref − 1| at the end. B: {SHORT} crossings.")


def result(one: dict | None) -> str:
    if one is None:
        return pages.cell("")
    if "verdict" not in one:
        return pages.cell(f"stops, step {one['stopped_step']}" if one["stopped_step"] else escape(one["outcome"]), "number stop")
    error = one["pressure_mean"]
    return pages.error(error, f"{one['verdict']}, {'&lt; 0.001 %' if error < 1e-5 else f'{100 * error:.2g} %'}")


def full(runs: list[dict]) -> str:
    columns = {"Start": lambda one: pages.cell(escape(one["case"])),
               "Scheme": lambda one: pages.name(one["variant"], style.COLOUR[one["variant"]]),
               "Outcome": lambda one: pages.cell(one.get("verdict") or f"stops, step {one['stopped_step']}", state_class(one["outcome"])),
               "crossings": lambda one: pages.number(said(one["time"] and one["time"] / CROSSING, "{:.3g}")),
               "p error, mean": error_cell("pressure_mean"), "max": error_cell("pressure_max"),
               "moved/Δx, rms": lambda one: pages.number(said(one.get("moved"), "{:.2g}")),
               "crossings a spacing": lambda one: pages.number(slow(one)),
               "spread of Y": error_cell("weight_spread"),
               "speed at the end (m/s)": lambda one: pages.number(said(one.get("speed"), "{:.2g}"))}
    return pages.folded("All numbers", pages.columns(runs, columns, "wide", lambda one: one["case"]))


def slow(one: dict) -> str:
    value = one.get("crossings_a_spacing")
    return "–" if value is None else f"{value:.2g}" if value < 1e6 else "&gt; 1e6"


def error_cell(what: str):
    return lambda one: pages.error(one.get(what), said(one.get(what), "{:.1e}"))


def open_table(runs: list[dict]) -> str:
    columns = {"": lambda one: pages.cell(escape(one["variant"])), "p error, mean": error_cell("pressure_mean"), "rms": error_cell("pressure_rms"),
               "max": error_cell("pressure_max"), "median": error_cell("pressure_median"),
               "mean, further than 2 Δx from a wall": error_cell("pressure_inner"), "ρ error, max": error_cell("density_max"),
               "moved/Δx, max": lambda one: pages.number(said(one.get("displacement_max_over_dx"), "{:.1e}"))}
    return pages.columns(runs, columns, "wide") + pages.small(prose.WITHOUT)


def plain_table(runs: list[dict]) -> str:
    def place(one: dict, tolerance: float) -> str:
        where = dies(one.get("residuals") or [], tolerance)
        text = "–" if where is None else f"{where[0]}/{where[1]}"
        return pages.number(f"<b>{text}</b>" if where == NOTED[one["variant"][0]] else text)

    columns = {"Tolerance": lambda one: pages.cell(escape(one["variant"])),
               **{f"{tolerance:.0e}".replace("e-0", "e-"): lambda one, tolerance=tolerance: place(one, tolerance) for tolerance in TOLERANCES}}
    return pages.columns(runs, columns, "wide") + pages.small("Step/iteration. –: not within the passes that there are.")


def terminal(_outcomes: list[Outcome], measured: dict) -> list[str]:
    lines = [f"{'start':<22}{'scheme':<8}{'outcome':<18}{'p error':>9}{'moved/dx':>10}{'2nd half':>10}{'m/s':>10}"]
    for one in measured["runs"]:
        if one["case"] in STARTS:
            numbers = [said(one.get(name), "{:.1e}") for name in ("pressure_mean", "moved", "moved_late", "speed")]
            outcome = one.get("verdict") or f"stops, step {one['stopped_step']}"
            lines.append(f"{one['case']:<22}{one['variant']:<8}{outcome:<18}{numbers[0]:>9}" + "".join(f"{text:>10}" for text in numbers[1:]))
    return lines
