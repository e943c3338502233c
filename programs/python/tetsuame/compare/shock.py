"""The five schemes side by side on contacts and shocks."""
import argparse
from dataclasses import dataclass
from html import escape
from pathlib import Path

import numpy as np

from .. import pages
from ..style import SCHEME
from . import orders
from . import shock_figures as figures
from .cases import Run, of_size
from .outcomes import COMPLETED, Outcome
from .parts import chosen, count, percent, said, sizes, state_class
from .table import place

NAME = "shock"
TITLE = "SSPH, DISPH, GSPH, Godunov DISPH and REMIX on contacts and shocks"
ABOUT = "Run the program shock with its five schemes on shock tubes and small tests in two dimensions; compare with exact solutions."


@dataclass(frozen=True)
class Test:
    input: str
    n: tuple[int, ...]
    quick: tuple[int, ...]
    about: str
    seconds: float = 1.0         # that one run with the most particles takes, roughly; with REMIX REMIX_COSTS times as many
    settings: tuple[str, ...] = ()
    refined: bool = False        # no exact solution: the last n again with gsph and twice the particles is the reference


TESTS = {
    "sod": Test("sod", (100, 200, 400), (50, 100, 200), "Sod's tube"),
    "strong": Test("strong", (100, 200, 400), (100, 200), "a pressure jump of 10⁵"),
    "vacuum": Test("vacuum", (140, 280, 560), (70, 140), "two streams that part and leave almost nothing between them"),
    "melts": Test("melts_shock", (100, 200, 400), (50, 100), "liquid iron beside liquid silicate, a shock into the silicate"),
    "blasts": Test("blasts", (200, 400), (100,), "two blasts that meet; no exact solution", 3.5, refined=True),
    "square": Test("square", (16, 32), (16, 24), "a dense square in pressure balance, particles on one lattice, t = 2", 2.0, ("time.t_end=2",)),
    "square_equal_mass": Test("square", (16, 32), (16,), "the same of equal masses: two lattices meet, t = 1", 2.0,
                              ("time.t_end=1", "shock.masses=equal_mass")),
    "explosion_2d": Test("sedov", (24, 48), (16, 24), "Sedov's explosion in the plane, gas of pressure 10⁻³ ahead, t = 0.1", 2.5,
                         ("domain.dimension=2", "time.t_end=0.1", "shock.p_l=1e-3")),
    "gresho": Test("gresho", (16, 32), (16, 24), "Gresho's vortex, which should stay as it is", 1.5),
    "kelvin_helmholtz": Test("kelvin_helmholtz", (48, 96), (40,), "growth of a wave on a shear layer, against linear theory", 14.0),
}
PROGRAMS = ("shock",)
REMIX_COSTS = 3.0
OVER = "Errors of ρ, v and p are coloured by their part of the exact field's largest value."
WIDE = max(len(name) for name, _ in SCHEME.values()) + 2  # of a column on the terminal
# Of each L1 error its sign, and the field.
ERRORS = {"density_l1": ("ρ", "Density"), "velocity_l1": ("v", "Velocities"), "pressure_l1": ("p", "Pressure")}
METRICS = {"shock_radius": ("shock radius", "shock_radius_exact"), "growth_rate": ("growth rate", "growth_rate_theory"),
           "square_area_change": ("change of area", None), "square_corner_radius": ("corner radius/edge", None),
           "density_max": ("largest density", None)}


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--tests", default=",".join(TESTS), metavar="NAME,…", help="tests to run (default: %(default)s)")
    parser.add_argument("--schemes", default=",".join(SCHEME), metavar="NAME,…", help="schemes (default: all five)")
    parser.add_argument("--particles", nargs="+", type=int, metavar="N",
                        help="particles along x, for every test named (default: each test's own)")


def plan(given: argparse.Namespace, root: Path, parser: argparse.ArgumentParser) -> list[Run]:
    tests = chosen("--tests", "test", given.tests, ",", TESTS, parser)
    schemes = chosen("--schemes", "scheme", given.schemes, ",", SCHEME, parser)
    runs = []
    for name in tests:
        test = TESTS[name]
        counts = sizes(given, parser, 8, test.n, test.quick)

        def run(scheme, n, variant):
            settings = (f"domain.particles_x={n}", f"shock.scheme={scheme}", *test.settings, *given.settings)
            seconds = test.seconds * (n / test.n[-1])**2.5 * (REMIX_COSTS if scheme == "remix" else 1.0)
            return of_size("shock", root / "inputs" / f"{test.input}.nml", variant, n, settings, name, seconds)

        runs += [run(scheme, n, scheme) for n in counts for scheme in schemes]
        if test.refined:
            runs.append(run("gsph", 2 * counts[-1], "reference"))
    return runs


def judged(one: dict) -> dict[str, tuple[float, float]]:
    name = figures.judged_by(one["case"])
    return {name: (one["errors"][name], 0.0)} if one["errors"].get(name) else {}


def row(outcome: Outcome, outcomes: list[Outcome]) -> dict | None:
    if outcome.case.variant == "reference":
        return None
    done = outcome.kind == COMPLETED
    errors = {name: outcome.number("errors", name) for name in ERRORS} if done else {}
    against = "exact solution"
    fine = next((o for o in outcomes if (o.case.file, o.case.variant, o.kind) == (outcome.case.file, "reference", COMPLETED)), None)
    if done and fine is not None:
        errors, against = l1(outcome.snapshot, fine.snapshot), f"gsph with {fine.case.n} particles"
    values = {}
    for name, (_, right) in METRICS.items():
        value = outcome.number("metrics", name)
        if value is not None and done:
            exact = outcome.number("metrics", right) if right else None
            values[name] = {"value": value, "exact": exact, "error": value / exact - 1 if exact else None}
    errors = {name: value for name, value in errors.items() if value is not None}
    return {"place": place(outcome) or None, "sizes": sizes_of(outcome, fine) if done else {}, "errors": errors,
            "errors_against": against if errors else None, "metrics": values,
            "energy_drift": outcome.number("conservation", "energy") if done else None}


def sizes_of(outcome: Outcome, fine: Outcome | None) -> dict[str, float]:
    """Of each field that an L1 error is of, the largest value in the solution it is held against: the errors are shown over them."""
    fields = (fine or outcome).snapshot or {}
    ending = "" if fine else "Reference"
    return {error: float(np.abs(fields[name + ending]).max()) for error, (_, name) in ERRORS.items() if name + ending in fields}


def l1(here, there) -> dict[str, float]:
    """L1 errors in one dimension against another snapshot: means over the volume, its values interpolated between particles."""
    if here is None or there is None:
        return {}
    x, order = here["Coordinates"][:, 0], np.argsort(there["Coordinates"][:, 0])
    volume = here["Masses"] / here["Density"]
    errors = {}
    for error, (_, name) in ERRORS.items():
        mine, other = (fields[name] if fields[name].ndim == 1 else fields[name][:, 0] for fields in (here, there))
        right = np.interp(x, there["Coordinates"][order, 0], other[order])
        errors[error] = float((volume * np.abs(mine - right)).sum() / volume.sum())
    return errors


def sections(outcomes: list[Outcome], measured: dict, folder: Path) -> list[str]:
    tests = list(dict.fromkeys(one["case"] for one in measured["runs"]))
    parts = [pages.paragraph("One kernel and one time integration; the schemes differ in what they smooth (mass, energy, or nothing: REMIX) and "
                             "in where dissipation comes from (artificial viscosity or Riemann problems)."),
             pages.section("At a glance", glance(measured, tests)),
             pages.section("Convergence", pages.figure(
                 orders.convergence(orders.series(measured["runs"], judged), lambda test, scheme, _: (test, *SCHEME[scheme]), "L1 error"),
                 folder / "convergence.png",
                 f"Mean of |ρ − ρ_exact| over the volume, of the vortex |v − v_exact|. {orders.LINES}"))]
    parts += [pages.section(f"{test.replace('_', ' ')}: {TESTS[test].about}",
                            pages.figure(figures.state(outcomes, test), folder / f"{test}.png", figures.caption(outcomes, test)),
                            test_table(measured, test)) for test in tests]
    return [*parts, pages.section("What it costs", pages.figure(
        orders.cost(measured["runs"], SCHEME, "updates_per_second", "million particle updates a second", 1e6), folder / "cost.png",
        "Particle updates (particles times right-hand sides) a second at each test's largest number of particles, one thread; other work on "
        "the machine shows in it."))]


def glance(measured: dict, tests: list[str]) -> str:
    """Each test at its finest resolution: the density's error, or what stands for it; the least is bold."""
    schemes = [s for s in SCHEME if any(one["variant"] == s for one in measured["runs"])]
    rows = []
    for test in tests:
        runs = [one for one in measured["runs"] if one["case"] == test]
        finest = max(one["n"] for one in runs)
        by_scheme = {one["variant"]: one for one in runs if one["n"] == finest}
        name = headline(list(by_scheme.values()))
        least = min((size for one in by_scheme.values() if (size := measure(one, name)[0]) is not None), default=None)

        def result(scheme: str) -> str:
            one = by_scheme.get(scheme)
            if one is None:
                return pages.cell("")
            if one["outcome"] != COMPLETED:
                return pages.cell(escape(", ".join(filter(None, (one["outcome"], one["place"])))), "stop")
            size, relative, text = measure(one, name)
            best = size is not None and size <= max(1.001 * least, 1e-9)
            return pages.error(relative, text, "best" if best else "")

        rows.append([pages.name(test), pages.number(finest), pages.cell(headline_name(name)), *map(result, schemes)])
    return pages.table(["Test", "n", "measure", *(SCHEME[s][0] for s in schemes)], rows) + \
        pages.error_key(f"Bold: the least error. {OVER} A run that stopped says why below its test.")


def headline(runs: list[dict]) -> str:
    """What a test is judged by: a rate or a shape where it has one, else an error."""
    names = {name for one in runs for name in one["metrics"]}
    for name in ("growth_rate", "square_area_change"):
        if name in names:
            return name
    return figures.judged_by(next(one["case"] for one in runs))


def headline_name(name: str) -> str:
    return f"{METRICS[name][0]}{', error' if METRICS[name][1] else ''}" if name in METRICS else f"L1 error of {ERRORS[name][0]}"


def measure(one: dict, name: str) -> tuple[float | None, float | None, str]:
    """A measure's size, the size of which it has its colour (of an L1 error over the largest value of its field), and its text."""
    if name in METRICS and (value := one["metrics"].get(name)) is not None:
        shown = value["error"] if value["exact"] else value["value"]
        return abs(shown), abs(shown), percent(shown)
    size, largest = one["errors"].get(name), one["sizes"].get(name)
    return size, size / largest if size is not None and largest else None, scientific(size)


def scientific(value: float | None) -> str:
    return said(value, "{:.2e}").replace("e-0", "e-").replace("e+00", "").replace("e+0", "e")


def test_table(measured: dict, test: str) -> str:
    runs = sorted((one for one in measured["runs"] if one["case"] == test), key=lambda one: (list(SCHEME).index(one["variant"]), one["n"]))
    finest = max(one["n"] for one in runs)

    def metric(one: dict, name: str) -> str:
        value = one["metrics"].get(name)
        if value is None:
            return pages.number("–")
        text = f"{value['value']:.3g}" + (f" ({percent(value['error'])})" if value["exact"] else "")
        return pages.error(value["error"], text)

    def order(one: dict) -> str:
        return pages.number(orders.of(measured, test, one["variant"]) if one["n"] == finest else "")

    def outcome(one: dict) -> str:
        text = one["outcome"] if one["outcome"] == COMPLETED else f"{one['outcome']}: {one['reason']}"
        return pages.cell(escape(text), state_class(one["outcome"]))

    errors = {f"L1 of {ERRORS[name][0]}": lambda one, name=name: pages.error(*measure(one, name)[1:])
              for name in ERRORS if any(name in one["errors"] for one in runs)}
    metrics = {METRICS[name][0]: lambda one, name=name: metric(one, name)
               for name in METRICS if any(name in one["metrics"] for one in runs)}
    columns = {"Scheme": lambda one: pages.name(*SCHEME[one["variant"]]), "n": lambda one: pages.number(one["n"]), "Outcome": outcome,
               **errors, **({"order": order} if errors else {}), **metrics,
               "energy drift": lambda one: pages.error(one["energy_drift"], scientific(one["energy_drift"])),
               "right-hand sides": lambda one: pages.number(count(one["right_hand_sides"])),
               "seconds": lambda one: pages.number(said(one["seconds"]))}
    against = next((one["errors_against"] for one in runs if one["errors_against"]), None)
    note = "" if not against else f"the {against}." if against.startswith("exact") else f"{against}: what both have wrong does not show."
    none = errors and any(one["order"] is None for one in measured["orders"] if one["case"] == test)
    return pages.columns(runs, columns, "wide", lambda one: one["variant"]) + \
        pages.small(" ".join(filter(None, (f"Errors against {escape(note)}" if note else "", orders.WHY_NONE if none else ""))))


def terminal(_outcomes: list[Outcome], measured: dict) -> list[str]:
    lines = [f"{'test':<19}{'n':>5}  {'measure':<24}" + "".join(f"{SCHEME[s][0]:>{WIDE}}" for s in SCHEME)]
    for test in dict.fromkeys(one["case"] for one in measured["runs"]):
        for n in sorted({one["n"] for one in measured["runs"] if one["case"] == test}):
            runs = {one["variant"]: one for one in measured["runs"] if one["case"] == test and one["n"] == n}
            name = headline(list(runs.values()))
            cells = "".join(f"{('' if s not in runs else runs[s]['outcome'] if runs[s]['outcome'] != COMPLETED else measure(runs[s], name)[2]):>{WIDE}}"
                            for s in SCHEME)
            lines.append(f"{test:<19}{n:>5}  {headline_name(name):<24}{cells}")
    return lines
