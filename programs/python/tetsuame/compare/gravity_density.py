"""The density that gravity feels where sound is slowed: the slowed one or a separated one; and the steps that the note's rules foretell."""
import argparse
import functools
import math
from html import escape
from itertools import takewhile
from pathlib import Path

import numpy as np

from .. import pages, style
from . import steady_flow
from .cases import Run, of_size
from .outcomes import COMPLETED, Outcome
from .parts import count, error_cell, percent, said, sizes, state_class

NAME = "gravity_density"
TITLE = "Which density gravity feels, and how many steps it takes"
ABOUT = "Convection with conventional and with separated gravity density over zeta; the note's tables 2 and 4, their steps counted."
PROGRAMS = ("convection",)

SEPARATED, CONVENTIONAL, STEPS = "separated", "conventional", "steps"
LOOK = {SEPARATED: style.BLUE, CONVENTIONAL: style.VERMILION}
# Of the steady state as the aim: inertia of the case's own rule, the same for all zeta. Air: noise of sound that is hardly damped, by
# the largest smoothing and short steps.
STEADY = ("relaxation.xi=2.354e12", "convection.levels=0", "convection.pressure_diffusion=0.4", "time.t_end=6e17")
AIR = ("relaxation.xi=1", "convection.pressure_diffusion=1", "time.cfl=0.4", "initial.perturbation=0.3", "time.t_end=500")
# Input -> its settings, n, and by density the zetas; with --quick.
DENSITIES = {
    "blankenbach_1a": (STEADY, 24, {SEPARATED: (1, 2, 3, 4, 5, 7, 10, 14, 20), CONVENTIONAL: (2, 3, 4, 5, 7, 10, 14, 20)}),
    "air_1e4": (AIR, 16, {SEPARATED: (1400, 4440, 10800), CONVENTIONAL: (500, 700, 900, 1400, 4440, 10800)})}
QUICK = {
    "blankenbach_1a": (STEADY, 16, {SEPARATED: (2, 5, 20), CONVENTIONAL: (3, 4, 5)}),
    "air_1e4": (AIR, 16, {SEPARATED: (4440, 10800), CONVENTIONAL: (900, 4440)})}
# Evaluations that a run takes are at its zeta so many times as many; seconds of one core at zeta 1 (1a), 1000 (air), by n.
COST = {("blankenbach_1a", 24): 19.0, ("blankenbach_1a", 16): 6.0, ("air_1e4", 16): 32.0}

# Of the note's inputs, as they stand (the first, to L/V) and smaller ones, until the flow has been seen (kappa t/L²).
AS_THEY_STAND = ("note_air_1e4", "note_air_1e5", "note_air_1e6")
SEEN = {"note_air_1e4": (32, 0.2), "note_mantle_1a": (16, 0.018), "note_mantle_1b": (16, 2e-3), "note_mantle_1c": (16, 2.2e-4)}
V_RMS = {"note_air_1e4": 14.2195, "note_air_1e5": 59.856, "note_air_1e6": 195.50,
         "note_mantle_1a": 42.865, "note_mantle_1b": 193.21, "note_mantle_1c": 833.99}
FRACTION, PHI_XI = 0.1, 0.5  # of the note: the step's part of its bound; of xi
PLACES = 10                  # of the line of what is foretold
LOUD = 1.0                   # v_rms has risen by more: sound, not the flow


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--particles", nargs="+", type=int, metavar="N", help="particles along an edge for 1a (default: 24; with --quick 16)")


def plan(given: argparse.Namespace, root: Path, parser: argparse.ArgumentParser) -> list[Run]:
    chosen = QUICK if given.quick else DENSITIES
    runs = []
    for name, (own, usual, by_density) in chosen.items():
        for n in sizes(given, parser, 8, (usual,), (usual,)) if name == "blankenbach_1a" else (usual,):
            runs += [density_run(root, name, density, zeta, n, own, given) for density, zetas in by_density.items() for zeta in zetas]
    runs += [steps_run(root, name, n, end, given) for name, (n, end) in SEEN.items() if not given.quick or name in ("note_air_1e4", "note_mantle_1b")]
    return runs + ([] if given.quick else [steps_run(root, name, 100, None, given) for name in AS_THEY_STAND])


def lattice(n: int) -> tuple[str, ...]:
    return f"domain.particles_x={n}", f"domain.particles_y={n}"


def density_run(root: Path, name: str, density: str, zeta: float, n: int, own, given) -> Run:
    settings = (*lattice(n), f"relaxation.zeta={zeta:g}", f"convection.gravity_density={density}", *own, *given.settings)
    cost = COST.get((name, n), 10.0) / (zeta if name == "blankenbach_1a" else zeta / 1000)
    blown = density == CONVENTIONAL and weight(name, zeta) > 6.5
    return of_size("convection", root / "inputs" / f"{name}.nml", f"{density}, zeta = {zeta:g}", n, settings, seconds=1.0 if blown else cost + 2.0)


def steps_run(root: Path, name: str, n: int, end: float | None, given) -> Run:
    """end: κt/L²; None: as the input has it"""
    unit = 1e18 if "mantle" in name else 1e3  # s, L²/κ
    settings = (*(lattice(n) if end else ()), *((f"time.t_end={end * unit:g}",) if end else ()), *given.settings)
    return of_size("convection", root / "inputs" / f"{name}.nml", STEPS, n, settings, seconds=70.0 if not end else 20.0)


def weight(name: str, zeta: float) -> float:
    """gL/c_ζ², for the density q = ζ²."""
    return zeta**2 * (0.4 if name == "blankenbach_1a" else 1.0 / 1.4e5)


def zeta_of(one: dict) -> float:
    return float(one["variant"].rpartition("=")[2])


@functools.cache
def foretold(name: str, q: float) -> tuple[float, float] | None:
    """Nu and v_rms of the steady equations at the weight q ρ₀gL/K₀. None: no steady flow was found"""
    kind = dict(prandtl=math.inf, no_slip=False) if name == "blankenbach_1a" else dict(prandtl=0.71, no_slip=True)
    flow = steady_flow.solve(1e4, weight=weight(name, math.sqrt(q)), **kind)
    return (flow.nusselt, flow.v_rms) if flow.residual < 1e-6 else None


def judged(_one: dict) -> dict[str, tuple[float, float]]:
    return {}


def row(outcome: Outcome, _outcomes: list[Outcome]) -> dict:
    columns = outcome.history
    found = {"kind": STEPS if outcome.case.variant == STEPS else outcome.case.variant.partition(",")[0], "time": outcome.number("time")}
    if outcome.case.variant == STEPS:
        return found | counted(outcome.case.file, outcome.case.n, columns)
    if outcome.kind != COMPLETED or not len(columns.get("time", ())):
        return found | {"nusselt": None, "v_rms": None}
    late = columns["time"] > 0.7 * columns["time"][-1]
    return found | {name: float(np.mean(columns[column][late])) for name, column in (("nusselt", "nusselt_volume"), ("v_rms", "v_rms"))}


def counted(name: str, n: int, columns) -> dict:
    """Steps: as (80) or (105) has them, within the note's L/V, in a turnover of the steady flow, and until v_rms is highest."""
    mantle = "mantle" in name
    rayleigh = 10.0**{"4": 4, "5": 5, "6": 6, "a": 4, "b": 5, "c": 6}[name[-1]]
    V = rayleigh**(2 / 3) if mantle else (0.71 * rayleigh)**0.4  # κ/L
    rule = 2.0 * n**2 / (FRACTION * PHI_XI**2) if mantle else 10.0 * n / FRACTION
    found = {"rule": rule, "V": V, "taken": None, "turnover": None, "seen": None, "highest": None}
    if not len(columns.get("time", ())) or columns["step"][-1] < 1:
        return found
    unit = 1e18 if mantle else 1e3
    per_time = columns["step"][-1] / columns["time"][-1] * unit  # steps in L²/κ: all are alike
    highest = int(np.argmax(columns["v_rms"]))
    passed = highest + 1 < len(columns["time"]) and columns["v_rms"][-1] < 0.995 * columns["v_rms"][highest]
    return found | {"taken": per_time / V, "turnover": per_time / V_RMS[name], "seen": int(columns["step"][highest]) if passed else None,
                    "highest": float(columns["v_rms"][highest])}


def compared(one: dict, runs: list[dict]) -> dict:
    """Changes of Nu and v_rms from the least ζ of the separated density at the same n, and those foretold."""
    base = min((r for r in runs if r["case"] == one["case"] and r["n"] == one["n"] and r["kind"] == SEPARATED and r["nusselt"]),
               key=zeta_of, default=None)
    own = foretold(one["case"], zeta_of(one)**2 if one["kind"] == CONVENTIONAL else 1.0)
    start = foretold(one["case"], 1.0)

    def change(value, reference) -> float | None:
        return value / reference - 1.0 if value and reference else None

    measured = {name: change(one[name], base and base[name]) for name in ("nusselt", "v_rms")}
    loud = measured["v_rms"] is not None and measured["v_rms"] > LOUD
    if loud:
        measured = dict.fromkeys(measured)
    return {"said": "full of sound" if loud else one["outcome"],
            "zeta": zeta_of(one), "weight": weight(one["case"], zeta_of(one)), "measured": measured,
            "foretold": {name: change(own and own[i], start[i]) for i, name in enumerate(("nusselt", "v_rms"))}}


def densities(measured: dict) -> list[tuple[dict, dict]]:
    runs = [one for one in measured["runs"] if one["kind"] != STEPS]
    return [(one, compared(one, runs)) for one in sorted(runs, key=lambda one: (one["case"], one["kind"], zeta_of(one)))]


def sections(_outcomes: list[Outcome], measured: dict, folder: Path) -> list[str]:
    both = densities(measured)
    stepped = [one for one in measured["runs"] if one["kind"] == STEPS]
    columns = {"Case": lambda pair: pages.name(pair[0]["case"]),
               "Density of gravity": lambda pair: pages.name(pair[0]["kind"], LOOK[pair[0]["kind"]]),
               "ζ": lambda pair: pages.number(f"{pair[1]['zeta']:g}"), "gL/c_ζ²": lambda pair: pages.number(said(pair[1]["weight"])),
               "Outcome": lambda pair: pages.cell(escape(pair[1]["said"]), state_class(pair[1]["said"])),
               "Nu": lambda pair: pages.number(said(pair[0]["nusselt"], "{:.4f}")),
               "Nu, change": lambda pair: error_cell(pair[1]["measured"]["nusselt"]),
               "foretold": lambda pair: pages.number(percent(pair[1]["foretold"]["nusselt"])),
               "v_rms, change": lambda pair: error_cell(pair[1]["measured"]["v_rms"]),
               "foretold ": lambda pair: pages.number(percent(pair[1]["foretold"]["v_rms"])),
               "right-hand sides": lambda pair: pages.number(count(pair[0]["right_hand_sides"]))}
    return [pages.paragraph("Conventional: buoyancy by the density that makes the slowed sound, ρ′ᴳ = ρ′ˢ, so that gravity weighs the pressure ζ² "
                            "times as much as it should. Separated: by the true equation of state. Changes are from the least ζ of the separated "
                            "density; what is foretold is a spectral solution of the steady equations with the conventional buoyancy in it."),
            pages.section("Over ζ", pages.figure(
                over_zeta(both), folder / "over_zeta.png",
                "Nusselt number over that of the least ζ with separated density. Lines: foretold. ×: the run blew up, or filled with sound; dotted: "
                "gL/c_ζ² = 1, the note's (17), and 2π, where sound feeds itself."),
                pages.columns(both, columns, "wide", lambda pair: (pair[0]["case"], pair[0]["kind"])) + pages.error_key()),
            pages.section("Steps", steps_table(stepped))]


def steps_table(stepped: list[dict]) -> str:
    def ratio(one: dict, name: str) -> str:
        value = one[name]
        return pages.number("–" if value is None else f"{count(value)} ({value / one['rule']:.2f})")

    columns = {"Input": lambda one: pages.name(one["case"]), "n": lambda one: pages.number(one["n"]),
               "Outcome": lambda one: pages.cell(escape(one["outcome"]), state_class(one["outcome"])),
               "(80), (105)": lambda one: pages.number(count(one["rule"])), "taken for L/V": lambda one: ratio(one, "taken"),
               "for L/v_rms of the steady flow": lambda one: ratio(one, "turnover"), "until the first overshoot": lambda one: ratio(one, "seen"),
               "V, highest v_rms (κ/L)": lambda one: pages.number(f"{one['V']:.4g}, {said(one['highest'], '{:.4g}')}"),
               "seconds": lambda one: pages.number(said(one["seconds"]))}
    return pages.columns(stepped, columns, "wide") + pages.small("In brackets: over (80) or (105). V: the note's speed, with boundary layers.")


def terminal(_outcomes: list[Outcome], measured: dict) -> list[str]:
    lines = [f"{'case':<16}{'density':<14}{'zeta':>7}{'gL/c²':>8}  {'outcome':<14}{'Nu':>9}"
             f"{'change':>10}{'foretold':>10}{'v_rms':>10}{'foretold':>10}"]
    for one, by in densities(measured):
        lines.append(f"{one['case']:<16}{one['kind']:<14}{by['zeta']:>7g}{by['weight']:>8.3g}  {by['said']:<14}{said(one['nusselt'], '{:.4f}'):>9}"
                     + "".join(f"{percent(by[of][name]):>10}" for name in ("nusselt", "v_rms") for of in ("measured", "foretold")))
    lines.append(f"{'input':<16}{'n':>5}  {'outcome':<10}{'rule':>9}{'L/V':>9}{'turnover':>10}{'seen':>9}")
    for one in (one for one in measured["runs"] if one["kind"] == STEPS):
        lines.append(f"{one['case']:<16}{one['n']:>5}  {one['outcome']:<10}{count(one['rule']):>9}"
                     + f"{count(one['taken']):>9}{count(one['turnover']):>10}{count(one['seen']):>9}")
    return lines


def over_zeta(both: list[tuple[dict, dict]]):
    cases = list(dict.fromkeys(one["case"] for one, _ in both))
    if not cases:
        return None
    figure, axes = style.panels(len(cases), 2, 3.4, "Nu over that of the least ζ")
    for ax, case in zip(axes, cases):
        start = foretold(case, 1.0)
        for kind, colour in LOOK.items():
            own = [(one, by) for one, by in both if one["case"] == case and one["kind"] == kind]
            known = [(by["zeta"], 1.0 + by["measured"]["nusselt"]) for one, by in own if by["measured"]["nusselt"] is not None]
            ax.plot(*(zip(*known) if known else ((), ())), "o", color=colour, markersize=5, label=kind)
            for one, by in own:
                if by["said"] != COMPLETED:
                    ax.plot(by["zeta"], 0.05, "x", color=colour)
        last = max(by["zeta"] for one, by in both if one["case"] == case)
        zetas = np.geomspace(min(by["zeta"] for one, by in both if one["case"] == case), last, PLACES)
        line = [(zeta, found[0] / start[0]) for zeta, found in takewhile(lambda each: each[1], ((zeta, foretold(case, zeta**2)) for zeta in zetas))]
        ax.plot(*zip(*line), color=LOOK[CONVENTIONAL], linewidth=1)
        ax.axhline(1.0, color=LOOK[SEPARATED], linewidth=1)
        for limit in (1.0, 2.0 * math.pi):
            ax.axvline(math.sqrt(limit / weight(case, 1.0)), color=style.GREY, linestyle=":", linewidth=1)
        ax.set(title=case, xscale="log", xlabel="ζ", ylim=(0, 1.15))
        ax.legend(loc="lower left", fontsize=8)
    return figure
