"""Convection to a steady state at several resolutions, against published and calculated values."""
import argparse
import math
import re
from html import escape
from pathlib import Path

from .. import pages, style
from . import fit, references, report
from .cases import Run, of_size
from .figures import convection as figures
from .figures import resolution
from .options import find_inputs, sizes
from .report import count, percent, said
from .results import number
from .runner import COMPLETED, Outcome

NAME = "convection"
TITLE = "Convection against known steady states"
ABOUT = "Run the program convection on steady cases at several resolutions; compare with published values."
INPUTS = ("blankenbach_1a", "blankenbach_1b", "air_1e4", "air_1e5", "square_pr1")
QUICK = ("blankenbach_1a", "air_1e4", "square_pr1")

SYMBOL = {"nusselt_volume": "Nu", "nusselt_top": "Nu, top", "nusselt_bottom": "Nu, bottom",
          "nusselt_dissipation": "Nu by friction", "v_rms": "v_rms", "u_max": "u_max", "v_max": "v_max",
          "q1": "q₁", "q2": "q₂", "q3": "q₃", "q4": "q₄"}
CONVERGENCE = {"nusselt_volume": ("Nu", style.VERMILION), "v_rms": ("v_rms", style.BLUE)}


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--particles", nargs="+", type=int, metavar="N",
                        help="particles along the height, one run each (default: 16 24 32; with --quick 16 20 24)")
    parser.add_argument("--inputs", metavar="NAME,…",
                        help=f"names in inputs/, or paths of namelists (default: {','.join(INPUTS)}; with --quick {','.join(QUICK)})")


def plan(given: argparse.Namespace, root: Path, parser: argparse.ArgumentParser) -> list[Run]:
    particles = sizes(given, parser, 8, (16, 24, 32), (16, 20, 24))
    inputs = find_inputs(given.inputs or (QUICK if given.quick else INPUTS), root, parser, known=tuple(references.STEADY))
    return [of_size("convection", path, "", n, (f"domain.particles_x={round(n * aspect(path))}", f"domain.particles_y={n}",
                                            *given.settings)) for path in inputs for n in particles]


def aspect(path: Path) -> float:
    """Width over height of the input's box."""
    text = re.sub(r"!.*", "", path.read_text())
    x, y = (re.search(rf"\blength_{axis}\s*=\s*([^\s,/]+)", text, re.IGNORECASE) for axis in "xy")
    return float(x[1].lower().replace("d", "e")) / float(y[1].lower().replace("d", "e")) if x and y else 1.0


def judged(one: dict) -> dict[str, tuple[float, float]]:
    return {name: (value["error"], (value["uncertainty"] or 0.0) / value["reference"]) for name in CONVERGENCE
            if (value := one["values"].get(name)) and value["error"] is not None}


def row(outcome: Outcome, _outcomes: list[Outcome]) -> dict:
    metrics = outcome.summary.get("metrics") or {}
    reference = references.of(outcome.case.file, metrics)
    values = {}
    for name in SYMBOL:
        value = number(metrics, name)
        if value is None or outcome.kind != COMPLETED:
            continue
        right = reference.values.get(name) if reference else None
        values[name] = {"value": value, "uncertainty": number(metrics, name + "_uncertainty"), "reference": right,
                        "error": value / right - 1 if right else None}
    return {"source": reference.source if reference else None, "steady": metrics.get("steady"),
            "heat_imbalance": number(metrics, "heat_imbalance"), "values": values}


def sections(outcomes: list[Outcome], measured: dict, folder: Path) -> list[str]:
    cases = list(dict.fromkeys(one["case"] for one in measured["runs"]))
    return [pages.paragraph("The program runs until the flow is steady. What it measures there stands beside the best values known. ± is the "
                            "uncertainty of the average over time, not the error of the method."),
            pages.section("At a glance", glance(measured, cases), report.drawn(
                figures.fields(outcomes), folder / "fields.png",
                "Temperature of the last state at the finest resolution, with isotherms every tenth and the flow's direction and strength.")),
            pages.section("Convergence", report.drawn(
                resolution.convergence(fit.series(measured["runs"], judged), lambda case, _, name: (case, *CONVERGENCE[name]),
                                       "|measured/known − 1|"), folder / "convergence.png",
                "Distance from the known value over the number of particles along the height. Bars: uncertainty of the average over time; "
                f"errors within their bar are open and not in the fit. {resolution.LINES}"), orders_table(measured)),
            pages.section("Measured, and known", *(case_table(measured, case) for case in cases)),
            pages.section(
                "Profiles and the way to the steady state",
                report.drawn(figures.profiles(outcomes), folder / "profiles.png",
                             "Above: temperature, mean along horizontal lines, 0 at the top and 1 at the bottom. Below: root mean square of the "
                             "horizontal velocity along them."),
                report.drawn(figures.course(outcomes), folder / "course.png",
                             "Nusselt number of the volume over time; dashed: the known value. With target 'steady' the way there is not a "
                             "history.")),
            pages.section("What it costs", report.drawn(
                resolution.cost(measured["runs"], {"": ("", style.BLUE)}, "seconds", "seconds, one thread"), folder / "cost.png",
                "To the steady state, at the finest resolution; other work on the machine shows in it."))]


def glance(measured: dict, cases: list[str]) -> str:
    best = {}  # of each case the finest run, if one completed the finest of these
    for one in sorted(measured["runs"], key=lambda one: (one["outcome"] == COMPLETED, one["n"])):
        best[one["case"]] = one
    columns = {"Case": lambda one: pages.name(one["case"]), "n": lambda one: pages.number(one["n"]), "Outcome": state,
               "Nu": lambda one: pages.number(shown(one, "nusselt_volume")), "Nu, error": lambda one: error_cell(one, "nusselt_volume"),
               "v_rms (κ/L)": lambda one: pages.number(shown(one, "v_rms")), "v_rms, error": lambda one: error_cell(one, "v_rms"),
               "heat in − out": lambda one: report.error_cell(one["heat_imbalance"]),
               "right-hand sides": lambda one: pages.number(count(one["right_hand_sides"]))}
    return pages.columns([best[case] for case in cases], columns, "wide") + pages.error_key()


def case_table(measured: dict, case: str) -> str:
    """Quantities down, resolutions across, the known value last."""
    runs = [one for one in measured["runs"] if one["case"] == case]
    known = next((one for one in runs if one["source"]), None)
    head = ["", *(text for one in runs for text in (f"n = {one['n']}", "error")), "known"]
    rows = [[pages.cell("outcome"), *(state(one, 2) for one in runs), pages.cell("")]]
    for name in (name for name in SYMBOL if any(name in one["values"] for one in runs)):
        cells = [each for one in runs for each in (pages.number(shown(one, name)), error_cell(one, name))]
        rows.append([pages.name(SYMBOL[name]), *cells, pages.number(f"<b>{right(known, name) if known else ''}</b>")])
    for label, made in (("heat in − out", lambda one: report.error_cell(one["heat_imbalance"])),
                        ("right-hand sides", lambda one: pages.number(count(one["right_hand_sides"]))),
                        ("seconds", lambda one: pages.number(said(one["seconds"])))):
        rows.append([pages.name(label), *(each for one in runs for each in (made(one), pages.cell(""))), pages.cell("")])
    source = f"Known: {escape(known['source'])}." if known else "No value known for this case as run."
    return pages.subsection(case, pages.table(head, rows), pages.small(source))


def orders_table(measured: dict) -> str:
    if not measured["orders"]:
        return ""
    columns = {"Case": lambda one: pages.cell(escape(one["case"])), "Quantity": lambda one: pages.cell(SYMBOL[one["quantity"]]),
               "Order p of |error| ~ n⁻ᵖ": lambda one: pages.number(fit.of_entry(one)), "points": lambda one: pages.number(one["points"])}
    return pages.columns(measured["orders"], columns) + fit.note(measured) + \
        pages.small("± is the standard error of the fit. An order is meaningful only where the error falls steadily: one that "
                    "passes through zero on the way looks small by chance.")


def state(one: dict, columns: int = 1) -> str:
    said = one["outcome"] if one["outcome"] != COMPLETED else "steady" if one["steady"] else "not steady yet"
    return pages.cell(escape(said), report.state_class(one["outcome"]) if said != "not steady yet" else "stop", columns)


def shown(one: dict, name: str) -> str:
    value = one["values"].get(name)
    if value is None:
        return "–"
    digits = 4 if name.startswith("nusselt") else 3 if abs(value["value"]) < 10 else 2
    if not value["uncertainty"]:
        return f"{value['value']:.{digits}f}"
    # As many as the uncertainty has meaning for.
    digits = max(0, -math.floor(math.log10(value["uncertainty"])))
    return f"{value['value']:.{digits}f} ± {value['uncertainty']:.{digits}f}"


def right(one: dict, name: str) -> str:
    value = one["values"].get(name)
    return f"{value['reference']:.6g}" if value and value["reference"] else "–"


def error(one: dict, name: str) -> str:
    value = one["values"].get(name)
    return percent(value["error"] if value else None)


def error_cell(one: dict, name: str) -> str:
    value = one["values"].get(name)
    return report.error_cell(value["error"] if value else None)


def terminal(_outcomes: list[Outcome], measured: dict) -> list[str]:
    lines = [f"{'case':<16}{'n':>5}{'Nu':>22}{'error':>10}{'v_rms':>22}{'error':>10}{'rhs':>10}"]
    for one in measured["runs"]:
        if one["outcome"] == COMPLETED:
            mark = "" if one["steady"] else "  not steady yet"
            lines.append(f"{one['case']:<16}{one['n']:>5}" + "".join(f"{shown(one, name):>22}{error(one, name):>10}" for name in CONVERGENCE)
                         + f"{count(one['right_hand_sides']):>10}{mark}")
        else:
            lines.append(f"{one['case']:<16}{one['n']:>5}  {one['outcome']}: {one['reason']}")
    for one in measured["orders"]:
        lines.append(f"order of {SYMBOL[one['quantity']]} in {one['case']}: {fit.of_entry(one)}")
    return lines
