"""Godunov DISPH and GSPH beside DISPH and SSPH: Sod's tube against the square of equal masses, Sedov's explosion over alpha, metal over
silicate and an impact with equations of state."""
import argparse
from html import escape
from pathlib import Path

import numpy as np

from .. import pages
from . import godunov_in_earnest_figures as figures
from .cases import Run, of_size
from .outcomes import COMPLETED, Outcome
from .parts import count, error_cell, percent, said, state_class

NAME = "godunov_in_earnest"
TITLE = "Godunov DISPH in earnest"
ABOUT = "Godunov DISPH and GSPH: Sod's tube against the square of equal masses, Sedov over alpha, an overturn and an impact of real materials."
PROGRAMS = ("shock", "rti")

# Terms of varying supports of Godunov DISPH, and how fast they fade ('fading': over the jump of pressure).
TERMS = {"number": ("shock.support_terms=number",), "none": ("shock.support_terms=none",),
         **{f"fading {k:g}": ("shock.support_terms=fading", f"shock.fading={k:g}") for k in (1, 5, 20, 100, 1000)}}
QUICK_TERMS, OF_ALPHA = ("number", "none", "fading 20", "fading 100"), "time-dependent"
ALPHAS = (0.5, 1.0, 2.0, 3.0)
# Scheme -> its settings in the problems of equations of state; what they call it.
VOLUME = ("shock.weight=volume",)
FULL = (*VOLUME, "shock.star_pressure=full")
REAL = {"gdisph": ("gdisph", FULL), "gdisph, balsara": ("gdisph", (*VOLUME, "shock.star_pressure=balsara")),
        "gdisph, fading": ("gdisph", (*FULL, "shock.support_terms=fading")),
        "gdisph, fading, balsara": ("gdisph", (*VOLUME, "shock.star_pressure=balsara", "shock.support_terms=fading")),
        "disph": ("disph", VOLUME), "gsph": ("gsph", ()), "ssph": ("ssph", ()), "remix": ("remix", ())}
SLOW = ("gdisph", "gdisph, balsara", "disph", "ssph", "gsph")
GRAVITY = {"overturn": 10.0, "slow_overturn": 0.1}  # m/s²
# The same layers in the program rti, which has a viscosity: the least that 24 particles bear, smaller as growth is slower.
RTI, VISCOSITY = "rti", 1e9
RTI_SETTINGS = ("domain.length_x=1e5", "domain.length_y=1e5", "domain.periodic_x=T", "rti.eos_upper=liquid_iron_isentrope",
                "rti.eos_lower=liquid_silicate", "rti.temperature=3000", "rti.wavelength=1e5", "rti.amplitude=500",
                "walls.slip_bottom=free_slip", "walls.slip_top=free_slip")


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--parts", default="tube,square,sedov,overturn,impact", metavar="NAME,…", help="parts to run (default: %(default)s)")


def plan(given: argparse.Namespace, root: Path, parser: argparse.ArgumentParser) -> list[Run]:
    made = {"tube": tube_runs, "square": square_runs, "sedov": sedov_runs, "overturn": overturn_runs, "impact": impact_runs}
    names = [name.strip() for name in given.parts.split(",")]
    for name in names:
        if name not in made:
            parser.error(f"--parts: no part '{name}' (there are {', '.join(made)})")
    return [run for name in names for run in made[name](root / "inputs", given)]


def of(given, path: Path, case: str, variant: str, n: int, settings, seconds: float) -> Run:
    return of_size("shock", path, variant, n, (*settings, *given.settings), case, seconds)


def terms(given) -> dict[str, tuple[str, ...]]:
    return {name: settings for name, settings in TERMS.items() if not given.quick or name in QUICK_TERMS}


def tube_runs(inputs: Path, given) -> list[Run]:
    n = 200 if given.quick else 400
    schemes = {"gsph": (), "disph": ()} | {f"gdisph, {name}": settings for name, settings in terms(given).items()}
    return [of(given, inputs / "sod.nml", "tube", name, n, (f"domain.particles_x={n}", f"shock.scheme={name.split(',')[0]}", *settings), 2.0)
            for name, settings in schemes.items()]


def square_runs(inputs: Path, given) -> list[Run]:
    n, end = (24, 4) if given.quick else (32, 8)
    common = (f"domain.particles_x={n}", "shock.masses=equal_mass", f"time.t_end={end}")
    runs = [of(given, inputs / "square.nml", "square", f"gdisph, {name}", n, (*common, *settings), 3.0 if given.quick else 15.0)
            for name, settings in terms(given).items()]
    return runs + [of(given, inputs / "square.nml", "square", "disph", n, (*common, "shock.scheme=disph"), 3.0 if given.quick else 8.0)]


def sedov_runs(inputs: Path, given) -> list[Run]:
    n = 12 if given.quick else 16  # of an octant
    cube = tuple(f"domain.particles_{axis}={n}" for axis in "xyz")
    alphas = (0.5, 1.0, 3.0) if given.quick else ALPHAS
    runs = []
    for scheme in ("ssph", "disph"):
        fixed = {f"{scheme}, α = {alpha:g}": (f"shock.alpha={alpha:g}", "shock.time_dependent_alpha=F") for alpha in alphas}
        runs += [(name, scheme, own) for name, own in {**fixed, f"{scheme}, {OF_ALPHA}": ()}.items()]
    runs += [("gsph", "gsph", ()), ("gdisph", "gdisph", ())]
    return [of(given, inputs / "sedov_octant.nml", "sedov", name, n, (*cube, f"shock.scheme={scheme}", *own), 5.0 if given.quick else 16.0)
            for name, scheme, own in runs]


def overturn_runs(inputs: Path, given) -> list[Run]:
    """The slow one has a hundredth of gravity and of pressure: all is alike but sound, ten times as fast beside the flow."""
    runs = []
    for case, gravity in GRAVITY.items():
        slow, size = case != "overturn", gravity / 10.0
        n = 24 if given.quick or slow else 32
        end = 400.0 if not slow else 1.4e3  # s: to the bottom; two growth times
        both = (f"domain.particles_x={n}", f"domain.particles_y={n}")
        common = (*both, f"shock.gravity={gravity:g}", f"shock.p_l={1e10 * size:g}", f"shock.perturbation={10.0 * size**0.5:g}",
                  f"time.t_end={end:g}")
        runs += [of(given, inputs / "iron_over_silicate.nml", case, name, n, (*common, f"shock.scheme={scheme}", *own), 3.0 if n == 24 else 7.0)
                 for name, (scheme, own) in REAL.items() if not slow or name in SLOW]
        viscosity = VISCOSITY * size**0.5
        layers = (f"rti.gravity={gravity:g}", f"rti.p_top={(1e10 - 7800.0 * 10.0 * 5e4) * size:g}", f"rti.viscosity_upper={viscosity:g}",
                  f"rti.viscosity_lower={viscosity:g}", f"time.t_end={200.0 * size**-0.5:g}")
        runs.append(of_size("rti", inputs / "rti_linear.nml", RTI, n, (*both, *RTI_SETTINGS, *layers, *given.settings), case, 2.0))
    return runs


def impact_runs(inputs: Path, given) -> list[Run]:
    n = 64 if given.quick else 96
    common = (f"domain.particles_x={n}", f"domain.particles_y={n}", "output.interval=2.5")
    return [of(given, inputs / "impact_2d.nml", "impact", name, n, (*common, f"shock.scheme={scheme}", *own), 2.0 if given.quick else 6.0)
            for name, (scheme, own) in REAL.items()]


def judged(one: dict) -> dict[str, tuple[float, float]]:
    return {"density_l1": (one["density_l1"], 0.0)} if one["case"] == "tube" and one.get("density_l1") else {}


def row(outcome: Outcome, _outcomes: list[Outcome]) -> dict:
    measures = {"tube": tube_row, "square": square_row, "sedov": sedov_row, "overturn": overturn_row, "slow_overturn": overturn_row,
                "impact": impact_row}
    own = measures[outcome.case.file](outcome) if outcome.kind == COMPLETED else {}
    return own | {"time": outcome.number("time"), "momentum": outcome.number("conservation", "momentum"),
                  "energy": outcome.number("conservation", "energy")}


def tube_row(outcome: Outcome) -> dict:
    return {name: outcome.number("errors", name) for name in ("density_l1", "velocity_l1", "pressure_l1")} | zones(outcome.snapshot)


def zones(snapshot) -> dict:
    """Of Sod's tube at the end: ∫|ρ − exact| dx by waves, 1e-4 kg/m²."""
    x, rho = snapshot["Coordinates"][:, 0], snapshot["Density"]
    errors = snapshot["Masses"] / rho * np.abs(rho - snapshot["DensityReference"])
    edges = {"head": (0.2, 0.3), "fan": (0.3, 0.47), "contact": (0.6, 0.75), "shock": (0.75, 0.95)}
    return {name: float(1e4 * errors[(x >= low) & (x < high)].sum()) for name, (low, high) in edges.items()}


def square_row(outcome: Outcome) -> dict:
    return {name: outcome.number("metrics", f"square_{name}") for name in ("area_change", "corner_radius")}


def sedov_row(outcome: Outcome) -> dict:
    radius, exact = (outcome.number("metrics", name) for name in ("shock_radius", "shock_radius_exact"))
    found = {name: outcome.number("errors", name) for name in ("density_l1", "velocity_l1", "pressure_l1")}
    state = figures.radial(outcome.snapshot)
    speed = 2.0 / (1.0 + 5.0 / 3.0) * 0.4 * exact / outcome.number("time")  # of the gas behind the shock
    shells = np.floor(state["r"] / (0.5 / outcome.case.n)).astype(int)
    counts = np.maximum(np.bincount(shells), 1)
    peak = np.max((np.bincount(shells, state["rho"]) / counts)[np.bincount(shells) > 2])
    off = state["v"] - state["v_exact"]
    inside = (state["r"] > 0.5 * exact) & (state["r"] < 0.95 * exact)
    return found | {"radius_error": radius / exact - 1.0, "peak": float(peak), "scatter": float(np.std(off[inside]) / speed)}


def overturn_row(outcome: Outcome) -> dict:
    growth, theory = (outcome.number("metrics", name) for name in ("growth_rate", "growth_rate_theory"))
    columns, eighth = outcome.history, 0.625 * outcome.setting("domain.length_y")
    passed = np.flatnonzero(columns["mean_height"] < eighth) if "mean_height" in columns else ()
    # Of a wave that a viscosity η slows, σ² + 2ηk²σ/ρ = σ₀²: the viscosity that the scheme seems to have.
    snapshot, k = outcome.snapshot, 2.0 * np.pi / outcome.setting("domain.length_x")
    viscosity = (theory**2 - growth**2) / (2.0 * k**2 * growth) * float(snapshot["Density"].mean()) if growth and growth > 0.0 else None
    if outcome.case.variant == RTI:  # its theory has its viscosity
        viscosity = None
    return {"growth": growth, "theory": theory, "growth_error": growth / theory - 1.0 if growth else None, "viscosity": viscosity,
            "overturn": float(columns["time"][passed[0]]) if len(passed) else None}


def impact_row(outcome: Outcome) -> dict:
    early, later = (next((s for s in outcome.snapshots if s.time > after), None) for after in (2.0, 4.5))
    p_star, radius = outcome.number("metrics", "p_star"), outcome.setting("expert.radius")
    found = {"p_min": float(outcome.history["pressure_min"].min()), "asymmetry": figures.asymmetry(outcome)}
    if later is None:
        return found
    middle = np.abs(later["Coordinates"] - 0.5 * later.lengths).max(axis=1) < 0.2 * radius
    off = early["Coordinates"] - 0.5 * early.lengths
    untouched = (np.abs(early["Velocities"][:, 0]) > 0.9 * abs(outcome.setting("shock.u_l"))) & (np.abs(off[:, 0]) > 0.5 * radius)
    pressures = later["Pressure"][middle] / p_star
    return found | {"p_middle": float(pressures.mean()), "p_scatter": float(pressures.std()),
                    "p_untouched": float(np.abs(early["Pressure"][untouched]).max() / p_star)}


COLUMNS = {"tube": {"ρ, L1": ("density_l1", "{:.5f}"), "v, L1": ("velocity_l1", "{:.5f}"), "p, L1": ("pressure_l1", "{:.5f}"),
                    "head": ("head", "{:.1f}"), "fan": ("fan", "{:.1f}"), "contact": ("contact", "{:.1f}"), "shock": ("shock", "{:.1f}")},
           "square": {"area": ("area_change", "%"), "corner radius/edge": ("corner_radius", "{:.3f}")},
           "sedov": {"radius": ("radius_error", "%"), "ρ, L1": ("density_l1", "{:.3f}"), "v, L1": ("velocity_l1", "{:.3f}"),
                     "p, L1": ("pressure_l1", "{:.3f}"), "peak ρ (exact 4)": ("peak", "{:.2f}"), "scatter of v": ("scatter", "{:.3f}")},
           "overturn": {"growth rate": ("growth_error", "%"), "as by a viscosity of, Pa s": ("viscosity", "{:.1e}"),
                        "iron has fallen by L/8, s": ("overturn", "{:.1f}")},
           "slow_overturn": {"growth rate": ("growth_error", "%"), "as by a viscosity of, Pa s": ("viscosity", "{:.1e}")},
           "impact": {"p in the middle/p*": ("p_middle", "{:.3f}"), "its scatter": ("p_scatter", "{:.3f}"), "|p| ahead/p*": ("p_untouched", "{:.1e}"),
                      "least p, Pa": ("p_min", "{:.2e}"), "asymmetry, spacings": ("asymmetry", "{:.1e}")}}
QUESTIONS = {
    "tube": "Terms of varying supports as they are, without, and fading where pressures jump: may Godunov DISPH have at most GSPH's error?",
    "square": "And does the square of equal masses, which the terms hold, still stay?",
    "sedov": "Which α do SSPH and DISPH need where Godunov's schemes need none?",
    "overturn": "Liquids with equations of state, without viscosity: growth against the linear theory of these compressible layers, and overturn.",
    "slow_overturn": "Sound is ten times as fast beside the flow. What slows the growth more now goes with sound.",
    "impact": "Granite with cores of iron, Tillotson's equation of state, empty space around."}
HEADS = {"tube": "Sod's tube", "square": "The square of equal masses", "sedov": "Sedov's explosion over α", "overturn": "Iron over silicate",
         "slow_overturn": "The same, slow: a hundredth of gravity and pressure", "impact": "Impact of two bodies"}


def sections(outcomes: list[Outcome], measured: dict, folder: Path) -> list[str]:
    parts = []
    for case, head in HEADS.items():
        runs = [one for one in measured["runs"] if one["case"] == case]
        if not runs:
            continue
        drawn = figures.draw(case, outcomes, measured["runs"])
        parts.append(pages.section(head, pages.paragraph(QUESTIONS[case]),
                                   pages.figure(drawn, folder / f"{case}.png", figures.CAPTIONS.get(case, "")), table(runs, case)))
    return parts


def table(runs: list[dict], case: str) -> str:
    def value(one: dict, key: str, form: str) -> str:
        return error_cell(one.get(key)) if form == "%" else pages.number(said(one.get(key), form))

    columns = {"Scheme": lambda one: pages.name(one["variant"], figures.colour(one["variant"])),
               "n": lambda one: pages.number(one["n"]),
               "Outcome": lambda one: pages.cell(escape(one["outcome"]), state_class(one["outcome"])),
               **{head: lambda one, key=key, form=form: value(one, key, form) for head, (key, form) in COLUMNS[case].items()},
               "energy": lambda one: pages.number(said(one["energy"], "{:.0e}")),
               "right-hand sides": lambda one: pages.number(count(one["right_hand_sides"])),
               "seconds": lambda one: pages.number(said(one["seconds"]))}
    return pages.columns(runs, columns, "wide") + (pages.error_key() if any(form == "%" for _, form in COLUMNS[case].values()) else "")


def terminal(_outcomes: list[Outcome], measured: dict) -> list[str]:
    lines = []
    for case, columns in COLUMNS.items():
        runs = [one for one in measured["runs"] if one["case"] == case]
        if runs:
            lines.append(f"{case:<24}{'outcome':<12}" + "".join(f"{head[:17]:>18}" for head in columns) + f"{'seconds':>9}")
        for one in runs:
            cells = [percent(one.get(key)) if form == "%" else said(one.get(key), form) for key, form in columns.values()]
            lines.append(f"{one['variant']:<24}{one['outcome'][:11]:<12}" + "".join(f"{cell:>18}" for cell in cells) + f"{said(one['seconds']):>9}")
    return lines
