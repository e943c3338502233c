"""Two liquids in contact under one pressure: which form of the pressure gradient needs Y to be continuous."""
import argparse
from dataclasses import dataclass
from html import escape
from pathlib import Path

import numpy as np

from .. import pages, style
from . import continuity_of_y_figures as figures
from . import orders
from .cases import Run, of_size
from .outcomes import COMPLETED, Outcome
from .parts import chosen, percent, said, sizes, state_class

NAME = "continuity_of_y"
TITLE = "Two liquids in contact: where Y must be continuous"
ABOUT = ("Run the schemes' programs on iron under silicate, or on linear liquids, of equal spacing and of equal masses: error of pressure and "
         "spurious speed at the contact; and shock on a dense square.")

# Name -> its program, and what it is.
FORMS = {
    "A": ("disph_a", "pattern 1, smoothed pressure, Y by Hosono's iteration (newton)"),
    "C": ("disph_c", "pattern 1, smoothed pressure, Y = m p/ρ with ρ by continuity"),
    "E": ("disph_e", "pattern 2, else as C"),
    "F": ("disph_f", "pattern 1, pressure from the equation of state, ρ by continuity"),
    "F2": ("disph_f2", "pattern 2, else as F"),
    "Y": ("disph_y", "pattern 1, smoothed pressure, Y by its own evolution equation"),
    "N": ("disph_n", "pattern 1, pressure from the equation of state, volumes by the number of neighbours"),
    "SSPH": ("ssph", "standard SPH: ρ by summation, pressure from the equation of state"),
}
PROGRAMS = (*(program for program, _ in FORMS.values()), "shock")
MASSES = {"equal_spacing": "equal spacing", "equal_mass": "equal masses"}


@dataclass(frozen=True)
class Motion:
    about: str
    settings: tuple[str, ...] = ()


MOTIONS = {
    "rest": Motion("at rest"),
    "linear": Motion("linear liquids at rest", ("rti.eos_upper=linear", "rti.eos_lower=linear", "rti.density_upper=3000",
                                                "rti.density_lower=7000", "rti.bulk_modulus=5e11")),
    "jittered": Motion("jittered by 10 %", ("domain.jitter=0.1",)),
    "sheared": Motion("sheared by 200 m/s", ("rti.shear=200",)),
    "gravity": Motion("at rest under gravity", ("rti.gravity=10",)),
}
HOLDS = 1e-3  # of the pressure: what the note's corrected programs stay below (its section 1.1)
# Rounding of sums: errors and speeds (m/s) below are zero.
ROUNDING = {"pressure": 1e-11, "speed": 1e-8}
SQUARE = "square"
# A takes some thirty times as long: unless it is asked for by name it runs on the first two contacts' coarser lattices.
SLOW, SLOW_MOTIONS, SLOW_MOST = "A", ("rest", "jittered"), 64


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--forms", metavar="NAME;…", help=f"forms to run, by semicolons (default: {'; '.join(FORMS)}, of A some)")
    parser.add_argument("--motions", metavar="NAME,…", default=",".join(MOTIONS), help="of the contact (default: %(default)s)")
    parser.add_argument("--particles", nargs="+", type=int, metavar="N",
                        help="particles along the height (default: 32 64 128; with --quick 32 64)")
    parser.add_argument("--square", type=int, metavar="N", help="particles along the box of the square (default: 32; with --quick 16); 0: no square")


def plan(given: argparse.Namespace, root: Path, parser: argparse.ArgumentParser) -> list[Run]:
    forms = chosen("--forms", "form", given.forms or ";".join(FORMS), ";", FORMS, parser)
    motions = chosen("--motions", "motion", given.motions, ",", MOTIONS, parser)
    counts = sizes(given, parser, 32, (32, 64, 128), (32, 64))
    if any(n % 4 for n in counts):
        parser.error("--particles: multiples of 4, as the box is four times as high as wide")
    square = (16 if given.quick else 32) if given.square is None else given.square
    if square and square < 8:
        parser.error("--square: at least 8, for the kernel reaches some spacings")
    runs = [contact(root, form, motion, masses, n, given) for motion in motions for masses in MASSES for n in counts for form in forms
            if given.forms or form != SLOW or (motion in SLOW_MOTIONS and n <= SLOW_MOST)]
    if square:
        known = figures.THEIRS if given.quick else {**figures.THEIRS, **figures.OURS}
        runs += [square_of(root, name, settings, square, given) for name, settings in known.items()]
    return runs


def contact(root: Path, form: str, motion: str, masses: str, n: int, given: argparse.Namespace) -> Run:
    settings = (f"domain.particles_x={n // 4}", f"domain.particles_y={n}", f"rti.masses={masses}",
                "output.fields='Pressure','Velocities','DensityReference'", *MOTIONS[motion].settings, *given.settings)
    seconds = (n / 64) ** 3 * (20.0 if form == SLOW else 0.7) * (1.6 if masses == "equal_mass" else 1.0)
    return of_size(FORMS[form][0], root / "inputs/contact.nml", form, n, settings, f"{motion}_{masses}", seconds)


def square_of(root: Path, name: str, own: tuple[str, ...], n: int, given: argparse.Namespace) -> Run:
    settings = (f"domain.particles_x={n}", *own, "output.interval=0.1", "output.fields='Density'", *given.settings)
    return of_size("shock", root / "inputs/square.nml", name, n, settings, SQUARE, 20.0 * (n / 32) ** 3)


# ---- what is measured -------------------------------------------------------------------------

def row(outcome: Outcome, _outcomes: list[Outcome]) -> dict:
    if outcome.case.file == SQUARE:
        return {"area_change": outcome.number("metrics", "square_area_change"), "corner_radius": outcome.number("metrics", "square_corner_radius")}
    motion, _, masses = outcome.case.file.partition("_")
    found = figures.course(outcome) if outcome.kind == COMPLETED else {}
    measured = {name: float(np.mean(values[1:])) for name, values in found.items() if name != "time"}
    low, high = (outcome.number("metrics", f"density_ratio_{end}") for end in ("min", "max"))
    changed = max(high - 1.0, 1.0 - low) if found and low is not None and high is not None else None
    return {"motion": motion, "masses": masses, "time": outcome.number("time"), "density_change": changed,
            **{name: measured.get(name) for name in ("pressure_near", "pressure_elsewhere", "speed_near", "speed_elsewhere")}}


def judged(one: dict) -> dict[str, tuple[float, float]]:
    if one["case"] == SQUARE:
        return {}
    return {name: (one[name], ROUNDING[name.partition("_")[0]]) for name in ("pressure_near", "speed_near") if one[name] is not None}


def order(measured: dict, one: dict, quantity: str) -> str:
    if one[quantity] is None:
        return "–"
    if one[quantity] <= judged(one)[quantity][1]:
        return "exact"
    return next((orders.said(each).replace("-0.00", "0.00") for each in measured["orders"]
                 if (each["case"], each["variant"], each["quantity"]) == (one["case"], one["variant"], quantity)), "–")


def finest(measured: dict) -> list[dict]:
    """Of each contact and form the run with the most particles."""
    found: dict[tuple[str, str], dict] = {}
    for one in contacts(measured):
        key = one["case"], one["variant"]
        if key not in found or one["n"] > found[key]["n"]:
            found[key] = one
    return list(found.values())


def contacts(measured: dict) -> list[dict]:
    return [one for one in measured["runs"] if one["case"] != SQUARE]


# ---- the answer -------------------------------------------------------------------------------

def verdict(measured: dict) -> list[str]:
    """For each contact, who holds it at the finest lattice, and how far off the others are."""
    lines = []
    for case in dict.fromkeys(one["case"] for one in finest(measured)):
        runs = [one for one in finest(measured) if one["case"] == case]
        done = sorted((one for one in runs if one["pressure_near"] is not None), key=lambda one: one["pressure_near"])
        hold = [one["variant"] for one in done if one["pressure_near"] <= HOLDS]
        off = [f"{one['variant']} {pressure(one['pressure_near'])}" for one in done if one["pressure_near"] > HOLDS]
        stopped = [one["variant"] for one in runs if one["pressure_near"] is None]
        motion, masses = runs[0]["motion"], runs[0]["masses"]
        parts = [f"held by {', '.join(hold)}" if hold else "held by none", f"not by {', '.join(off)}" if off else "",
                 f"stopped: {', '.join(stopped)}" if stopped else ""]
        lines.append(f"{MOTIONS[motion].about}, {MASSES[masses]}: {'; '.join(filter(None, parts))}")
    return lines


def conclusion(measured: dict) -> str:
    """Who holds all contacts that nothing disturbs, and who those of one lattice alone."""
    still = [one for one in finest(measured) if one["motion"] != "jittered"]

    def holding(masses: tuple[str, ...]) -> list[str]:
        asked = [one for one in still if one["masses"] in masses]
        lost = {one["variant"] for one in asked if one["pressure_near"] is None or one["pressure_near"] > HOLDS}
        return [form for form in dict.fromkeys(one["variant"] for one in asked) if form not in lost]

    every = holding(tuple(MASSES))
    spacing = [form for form in holding(("equal_spacing",)) if form not in every]
    return (f"Contacts on regular lattices, at rest, sheared or under gravity: both kinds of masses are held by {', '.join(every) or 'none'}; "
            f"equal spacing alone by {', '.join(spacing) or 'none'}.")


def counts_said(measured: dict) -> str:
    """'128 (A: 64)'"""
    of_form = {one["variant"]: one["n"] for one in sorted(contacts(measured), key=lambda one: one["n"])}
    most = max(of_form.values())
    fewer = ", ".join(f"{form}: {n}" for form, n in of_form.items() if n < most)
    return f"{most} ({fewer})" if fewer else str(most)


def pressure(value: float | None) -> str:
    if value is None:
        return "–"
    if value <= ROUNDING["pressure"]:
        return "0"
    if value >= 1.0:
        return f"{100 * value:.0f} %"
    return f"{100 * value:.2g} %" if value >= 1e-3 else f"{value:.1e}".replace("e-0", "e-")


def speed(value: float | None) -> str:
    return "–" if value is None else "0" if value <= ROUNDING["speed"] else f"{value:.3g}"


# ---- the page ---------------------------------------------------------------------------------

def sections(outcomes: list[Outcome], measured: dict, folder: Path) -> list[str]:
    parts = []
    if runs := contacts(measured):
        names = list(dict.fromkeys(one["variant"] for one in runs))
        parts = [pages.listed([f"<b>{escape(name)}</b> ({FORMS[name][0]}): {escape(FORMS[name][1])}" for name in names]),
                 pages.paragraph(
                     "Where the pressure p is the same everywhere, the accelerations by the two patterns differ by −(p/m) Σ (ΔV_i − ΔV_j)² ∇W, "
                     "ΔV = Y/p: nothing on one lattice, whatever the masses; where two lattices meet, an acceleration of the order of p/(ρ Δx), "
                     "which a finer lattice makes no smaller."),
                 pages.section("Who holds which contact", pages.paragraph(
                     f"Held: a mean error of the pressure of at most {100 * HOLDS:g} % within four spacings of the contact, over time and "
                     f"at the largest number of particles of each form: {counts_said(measured)}."),
                     pages.paragraph(f"<b>{escape(conclusion(measured))}</b>"),
                     pages.listed([escape(line) for line in verdict(measured)]), glance(measured, names)),
                 pages.section("Over time", pages.figure(
                     figures.courses(outcomes), folder / "courses.png",
                     "Mean error of the pressure, and root mean square of the speed (of a sheared contact across it), within four spacings of the "
                     "contact, at the largest number of particles. A line that is not there is at rounding, or its run stopped.")),
                 pages.section("Across the contact", pages.figure(
                     figures.profiles(outcomes), folder / "profiles.png",
                     "Every particle at the end: error of the pressure over the distance from the contact, at rest, of equal masses.")),
                 pages.section("Orders", pages.figure(
                     orders.convergence(inexact(runs), look, "error of p at the contact"), folder / "convergence.png",
                     f"{orders.LINES} What is exact to rounding is not drawn."),
                     *(order_table(measured, motion) for motion in dict.fromkeys(one["motion"] for one in runs)))]
    squares = [one for one in measured["runs"] if one["case"] == SQUARE]
    if squares:
        parts.append(pages.section(
            "Saitoh and Makino's figure 5",
            pages.figure(figures.squares(outcomes, figures.THEIRS), folder / "square.png",
                         "A square of density 4 (red) in 1 (blue) under one pressure, as their figure 5 has it: SSPH and DISPH, equal masses "
                         "and equal separation."),
            pages.figure(figures.squares(outcomes, figures.OURS), folder / "square_others.png",
                         "The same of equal masses: Godunov DISPH, and both with f of [S4] in the terms of varying supports."),
            pages.columns(squares, {"": lambda one: pages.name(one["variant"]), "n": lambda one: pages.number(one["n"]),
                                    "outcome": lambda one: pages.cell(escape(one["outcome"]), state_class(one["outcome"])),
                                    "change of area": lambda one: pages.error(one["area_change"], percent(one["area_change"])),
                                    "corner radius/edge": lambda one: pages.number(said(one["corner_radius"], "{:.2f}"))})))
    return parts


def inexact(runs: list[dict]) -> dict:
    """As orders.series(): errors of the pressure at the contact, where one is above rounding."""
    return {key: points for key, points in orders.series(runs, judged).items()
            if key[2] == "pressure_near" and any(error > rounding for _, error, rounding in points)}


def look(case: str, form: str, _quantity: str) -> tuple[str, str, str]:
    motion, _, masses = case.partition("_")
    return f"{motion}, {MASSES[masses]}", form, style.COLOUR[form]


def glance(measured: dict, names: list[str]) -> str:
    """Errors of the pressure at the contact and spurious speeds, at the finest lattice."""
    runs = {(one["case"], one["variant"]): one for one in finest(measured)}
    cases = list(dict.fromkeys(case for case, _ in runs))

    def result(one: dict | None) -> str:
        if one is None:
            return pages.cell("")
        if one["outcome"] != COMPLETED:
            return pages.cell(escape(f"{one['outcome']}, {said(one['time'], '{:.1f} s')}"), "stop")
        return pages.error(one["pressure_near"], f"{pressure(one['pressure_near'])} | {speed(one['speed_near'])}")

    columns = {"contact": lambda case: pages.cell("{}, {}".format(*look(case, names[0], "")[0].split(", "))),
               **{name: lambda case, name=name: result(runs.get((case, name))) for name in names}}
    return pages.columns(cases, columns, "wide") + pages.error_key("Mean error of the pressure | root mean square of the spurious speed, m/s.")


def order_table(measured: dict, motion: str) -> str:
    runs = [one for one in contacts(measured) if one["motion"] == motion]
    counts = sorted({one["n"] for one in runs})
    by_place = {(one["masses"], one["variant"], one["n"]): one for one in runs}
    kinds = list(dict.fromkeys((one["masses"], one["variant"]) for one in runs))
    last = {(one["masses"], one["variant"]): one for one in sorted(runs, key=lambda one: one["n"])}

    def value(kind: tuple[str, str], n: int, quantity: str, shown) -> str:
        one = by_place.get((*kind, n))
        if one is None:
            return pages.cell("")
        text = one["outcome"] if one[quantity] is None else shown(one[quantity])
        return pages.error(one[quantity], text) if quantity == "pressure_near" else pages.number(text)

    columns = {"": lambda kind: pages.cell(MASSES[kind[0]]), "form": lambda kind: pages.name(kind[1], style.COLOUR[kind[1]]),
               **{f"error of p, {n}": lambda kind, n=n: value(kind, n, "pressure_near", pressure) for n in counts},
               "order": lambda kind: pages.number(order(measured, last[kind], "pressure_near")),
               **{f"speed, {n}": lambda kind, n=n: value(kind, n, "speed_near", speed) for n in counts},
               "its order": lambda kind: pages.number(order(measured, last[kind], "speed_near")),
               f"change of ρ, {counts[-1]}": lambda kind: pages.error(last[kind]["density_change"], pressure(last[kind]["density_change"]))}
    return pages.subsection(MOTIONS[motion].about, pages.columns(kinds, columns, "wide", lambda kind: kind[0]))


def terminal(_outcomes: list[Outcome], measured: dict) -> list[str]:
    lines = []
    if runs := finest(measured):
        names = list(dict.fromkeys(one["variant"] for one in runs))
        lines = [f"Error of the pressure at the contact, n = {counts_said(measured)}:", "", f"{'contact':<26}" + "".join(f"{name:>10}" for name in names)]
        for case in dict.fromkeys(one["case"] for one in runs):
            cells = {one["variant"]: pressure(one["pressure_near"]) if one["outcome"] == COMPLETED else one["outcome"]
                     for one in runs if one["case"] == case}
            lines.append(f"{look(case, names[0], '')[0]:<26}" + "".join(f"{cells.get(name, ''):>10}" for name in names))
        lines += ["", *verdict(measured), conclusion(measured)]
    for one in measured["runs"]:
        if one["case"] == SQUARE:
            lines.append(f"square, {one['variant']}: area {percent(one['area_change'])}, corner {said(one['corner_radius'], '{:.2f}')}")
    return lines
