"""The five schemes side by side on contacts and shocks."""
import argparse
from dataclasses import dataclass
from html import escape
from pathlib import Path

import numpy as np

from .. import pages
from ..style import SCHEME
from . import fit, report
from .cases import Run, of_size
from .convection import count, percent, seconds
from .figures import resolution
from .figures import shock as figures
from .options import chosen, sizes
from .results import cost, fluid, number
from .runner import COMPLETED, Outcome
from .table import place, verdict

NAME = "shock"
TITLE = "SSPH, DISPH, GSPH, Godunov DISPH and REMIX on contacts and shocks"
ABOUT = "Run the program shock with its five schemes on shock tubes and small tests in two dimensions; compare with exact solutions."
SCHEMES = ("ssph", "disph", "gsph", "gdisph", "remix")


@dataclass(frozen=True)
class Test:
    input: str
    n: tuple[int, ...]
    quick: tuple[int, ...]
    about: str
    settings: tuple[str, ...] = ()
    refined: bool = False        # no exact solution: the last n again with gsph and twice the particles is the reference


TESTS = {
    "sod": Test("sod", (100, 200, 400), (50, 100, 200), "Sod's tube"),
    "strong": Test("strong", (100, 200, 400), (100, 200), "a pressure jump of 10⁵"),
    "vacuum": Test("vacuum", (140, 280, 560), (70, 140), "two streams that part and leave almost nothing between them"),
    "melts": Test("melts_shock", (100, 200, 400), (50, 100), "liquid iron beside liquid silicate, a shock into the silicate"),
    "blasts": Test("blasts", (200, 400), (100,), "two blasts that meet; no exact solution", refined=True),
    "square": Test("square", (16, 32), (16, 24), "a dense square in pressure balance, particles on one lattice, t = 2", ("time.t_end=2",)),
    "square_equal_mass": Test("square", (16, 32), (16,), "the same of equal masses: two lattices meet, t = 1",
                              ("time.t_end=1", "shock.masses=equal_mass")),
    "explosion_2d": Test("sedov", (24, 48), (16, 24), "Sedov's explosion in the plane, gas of pressure 10⁻³ ahead, t = 0.1",
                         ("domain.dimension=2", "time.t_end=0.1", "shock.p_l=1e-3")),
    "gresho": Test("gresho", (16, 32), (16, 24), "Gresho's vortex, which should stay as it is"),
    "kelvin_helmholtz": Test("kelvin_helmholtz", (48, 96), (40,), "growth of a wave on a shear layer, against linear theory"),
}
ERRORS = ("density_l1", "velocity_l1", "pressure_l1")
METRICS = {"shock_radius": ("shock radius", "shock_radius_exact"), "growth_rate": ("growth rate", "growth_rate_theory"),
           "square_area_change": ("change of area", None), "square_corner_radius": ("corner radius/edge", None),
           "density_max": ("largest density", None)}


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--tests", default=",".join(TESTS), metavar="NAME,…", help="tests to run (default: %(default)s)")
    parser.add_argument("--schemes", default=",".join(SCHEMES), metavar="NAME,…", help="schemes (default: all five)")
    parser.add_argument("--particles", nargs="+", type=int, metavar="N",
                        help="particles along x, for every test named (default: each test's own)")


def plan(given: argparse.Namespace, root: Path, parser: argparse.ArgumentParser) -> list[Run]:
    tests = chosen("--tests", "test", given.tests, ",", TESTS, parser)
    schemes = chosen("--schemes", "scheme", given.schemes, ",", SCHEMES, parser)
    runs = []
    for name in tests:
        test = TESTS[name]
        counts = sizes(given, parser, 8, test.n, test.quick)

        def run(scheme, n, variant):
            settings = (f"domain.particles_x={n}", f"shock.scheme={scheme}", *test.settings, *given.settings)
            return of_size("shock", root / "inputs" / f"{test.input}.nml", variant, n, settings, name)

        runs += [run(scheme, n, scheme) for n in counts for scheme in schemes]
        if test.refined:
            runs.append(run("gsph", 2 * counts[-1], "reference"))
    return runs


def rows(outcomes: list[Outcome]) -> list[dict]:
    fine = {o.case.file: o for o in outcomes if o.case.variant == "reference" and o.kind == COMPLETED}
    return [row(outcome, fine.get(outcome.case.file)) for outcome in outcomes if outcome.case.variant != "reference"]


def judged(one: dict) -> dict[str, tuple[float, float]]:
    name = figures.judged_by(one["case"])
    return {name: (one["errors"][name], 0.0)} if one["errors"].get(name) else {}


def row(outcome: Outcome, fine: Outcome | None) -> dict:
    summary, done = outcome.summary, outcome.kind == COMPLETED
    errors = {name: number(summary, "errors", name) for name in ERRORS} if done else {}
    against = "exact solution"
    if done and fine is not None:
        errors, against = errors_against(outcome.folder, fine.folder), f"gsph with {fine.case.n} particles"
    values = {}
    for name, (_, right) in METRICS.items():
        value = number(summary, "metrics", name)
        if value is not None and done:
            exact = number(summary, "metrics", right) if right else None
            values[name] = {"value": value, "exact": exact, "error": value / exact - 1 if exact else None}
    return {"case": outcome.case.file, "variant": outcome.case.variant, "n": outcome.case.n, "outcome": verdict(outcome),
            "reason": outcome.reason or None, "place": place(outcome) or None,
            "errors": {name: value for name, value in errors.items() if value is not None},
            "errors_against": against if any(value is not None for value in errors.values()) else None, "metrics": values,
            "energy_drift": number(summary, "conservation", "energy") if done else None, **cost(outcome)}


def errors_against(folder: Path, fine: Path) -> dict[str, float]:
    """L1 errors in one dimension against another run: means over the volume, its values interpolated between particles."""
    here, there = fluid(folder), fluid(fine)
    return {} if here is None or there is None else l1(here, there)


def l1(here: dict, there: dict) -> dict[str, float]:
    x, order = here["Coordinates"][:, 0], np.argsort(there["Coordinates"][:, 0])
    volume = here["Masses"] / here["Density"]
    errors = {}
    for name, mine, other in (("density_l1", here["Density"], there["Density"]),
                              ("velocity_l1", here["Velocities"][:, 0], there["Velocities"][:, 0]),
                              ("pressure_l1", here["Pressure"], there["Pressure"])):
        right = np.interp(x, there["Coordinates"][order, 0], other[order])
        errors[name] = float((volume * np.abs(mine - right)).sum() / volume.sum())
    return errors


def sections(outcomes: list[Outcome], measured: dict, folder: Path) -> list[str]:
    tests = list(dict.fromkeys(one["case"] for one in measured["runs"]))
    parts = ["<p>One kernel and one time integration; the schemes differ in what they smooth (mass, energy, or nothing: REMIX) and in where "
             "dissipation comes from (artificial viscosity or Riemann problems).</p>",
             "<h2>At a glance</h2>", glance(measured, tests),
             "<h2>Convergence</h2>",
             report.drawn(resolution.convergence(fit.series(measured["runs"], judged),
                                                 lambda test, scheme, _: (test, *SCHEME[scheme]), "L1 error"), folder / "convergence.png",
                          "Mean of |ρ − ρ_exact| over the volume, of the vortex |v − v_exact|. Lines: the fitted order.")]
    for test in tests:
        parts += [f"<h2>{escape(test)}: {escape(TESTS[test].about)}</h2>",
                  report.drawn(figures.state(outcomes, test), folder / f"{test}.png", figures.caption(outcomes, test)),
                  test_table(measured, test)]
    parts += ["<h2>What it costs</h2>",
              report.drawn(resolution.cost(measured["runs"], SCHEME, "updates_per_second", "million particle updates a second", 1e6),
                           folder / "cost.png",
                           "Particle updates (particles times right-hand sides) a second at each test's largest number of particles, one "
                           "thread; other work on the machine shows in it.")]
    return parts


def glance(measured: dict, tests: list[str]) -> str:
    """Each test at its finest resolution: the density's error, or what stands for it; the least is marked."""
    schemes = [s for s in SCHEMES if any(one["variant"] == s for one in measured["runs"])]
    rows = []
    for test in tests:
        runs = [one for one in measured["runs"] if one["case"] == test]
        finest = max(one["n"] for one in runs)
        by_scheme = {one["variant"]: one for one in runs if one["n"] == finest}
        name = headline(list(by_scheme.values()))
        values = {s: size(one, name) for s, one in by_scheme.items()}
        least = min((v for v in values.values() if v is not None), default=None)
        cells = ""
        for scheme in schemes:
            one = by_scheme.get(scheme)
            if one is None:
                cells += "<td></td>"
            elif one["outcome"] != COMPLETED:
                cells += f"<td class=\"stop\">{escape(one['outcome'])}{', ' + one['place'] if one['place'] else ''}</td>"
            else:
                best = values[scheme] is not None and least is not None and values[scheme] <= max(1.001 * least, 1e-9)
                cells += f"<td class=\"number{' good' if best else ''}\">{headline_text(one, name)}</td>"
        rows.append(f"<tr>{pages.name(test)}{pages.numbers(finest)}<td>{headline_name(name)}</td>{cells}</tr>")
    return pages.table(["Test", "n", "measure", *(SCHEME[s][0] for s in schemes)], rows,
                        numbers=frozenset({1, *range(3, 3 + len(schemes))})) + \
        "<p class=\"small\">Green: the least error. A run that stopped says why below its test.</p>"


def headline(runs: list[dict]) -> str:
    """What a test is judged by: a rate or a shape where it has one, else an error."""
    names = {name for one in runs for name in one["metrics"]}
    for name in ("growth_rate", "square_area_change"):
        if name in names:
            return name
    return figures.judged_by(next(one["case"] for one in runs))


def headline_name(name: str) -> str:
    return f"{METRICS[name][0]}{', error' if METRICS[name][1] else ''}" if name in METRICS else \
        {"density_l1": "L1 error of ρ", "velocity_l1": "L1 error of v"}[name]


def size(one: dict, name: str) -> float | None:
    if name in METRICS:
        value = one["metrics"].get(name)
        if value is None:
            return None
        return abs(value["error"] if value["exact"] else value["value"])
    return one["errors"].get(name)


def headline_text(one: dict, name: str) -> str:
    value = one["metrics"].get(name) if name in METRICS else None
    if value is not None:
        return percent(value["error"] if value["exact"] else value["value"])
    return scientific(one["errors"].get(name))


def scientific(value: float | None) -> str:
    return "–" if value is None else f"{value:.2e}".replace("e-0", "e-").replace("e+00", "").replace("e+0", "e")


def test_table(measured: dict, test: str) -> str:
    runs = [one for one in measured["runs"] if one["case"] == test]
    metrics = [name for name in METRICS if any(name in one["metrics"] for one in runs)]
    errors = [name for name in ERRORS if any(name in one["errors"] for one in runs)]
    rows = []
    for one in sorted(runs, key=lambda r: (SCHEMES.index(r["variant"]), r["n"])):
        label, colour = SCHEME[one["variant"]]
        first = " class=\"first\"" if one["n"] == min(r["n"] for r in runs) else ""
        said = one["outcome"] if one["outcome"] == COMPLETED else f"{one['outcome']}: {one['reason']}"
        values = [scientific(one["errors"].get(name)) for name in errors]
        last = one["n"] == max(r["n"] for r in runs)
        if errors:
            values.append(fit.order_of(measured, one["case"], one["variant"]) if last else "")
        for name in metrics:
            value = one["metrics"].get(name)
            values.append("–" if value is None else f"{value['value']:.3g}" + (f" ({percent(value['error'])})" if value["exact"] else ""))
        values += [scientific(one["energy_drift"]), count(one["right_hand_sides"]), seconds(one["seconds"])]
        rows.append(f"<tr{first}>{pages.name(label, colour)}{pages.numbers(one['n'])}<td class=\"{report.state_class(one['outcome'])}\">{escape(said)}</td>"
                    f"{pages.numbers(*values)}</tr>")
    names = {"density_l1": "L1 of ρ", "velocity_l1": "L1 of v", "pressure_l1": "L1 of p"}
    head = ["Scheme", "n", "Outcome", *(names[name] for name in errors), *(["order"] if errors else []),
            *(METRICS[name][0] for name in metrics), "energy drift", "right-hand sides", "seconds"]
    against = next((one["errors_against"] for one in runs if one["errors_against"]), None)
    note = f"<p class=\"small\">Errors against the {escape(against)}.</p>" if against and against.startswith("exact") else \
        f"<p class=\"small\">Errors against {escape(against)}: what both have wrong does not show.</p>" if against else ""
    return pages.table(head, rows, "wide", frozenset({1, *range(3, len(head))})) + note


def terminal(outcomes: list[Outcome], measured: dict) -> str:
    lines = [f"{'test':<19}{'n':>5}  {'measure':<24}" + "".join(f"{SCHEME[s][0]:>12}" for s in SCHEMES)]
    for test in dict.fromkeys(one["case"] for one in measured["runs"]):
        for n in sorted({one["n"] for one in measured["runs"] if one["case"] == test}):
            runs = {one["variant"]: one for one in measured["runs"] if one["case"] == test and one["n"] == n}
            name = headline(list(runs.values()))
            cells = "".join(f"{('' if s not in runs else runs[s]['outcome'] if runs[s]['outcome'] != COMPLETED else headline_text(runs[s], name)):>12}"
                            for s in SCHEMES)
            lines.append(f"{test:<19}{n:>5}  {headline_name(name):<24}{cells}")
    return "\n".join(lines + report.crash_lines(outcomes))
