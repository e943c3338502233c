"""Convection to a steady state at several resolutions, against published and calculated values."""
import argparse
import math
import re
from dataclasses import replace
from html import escape
from pathlib import Path

import numpy as np

from .. import pages, plots, style
from ..reading import real
from ..rendering import slice_of
from . import orders, references
from .cases import Run, of_size
from .outcomes import COMPLETED, Outcome
from .parts import count, error_cell, find_inputs, percent, said, sizes, state_class

NAME = "convection"
TITLE = "Convection against known steady states"
ABOUT = "Run the program convection on steady cases at several resolutions; compare with published values."
PROGRAMS = ("convection",)
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
    inputs = find_inputs(given.inputs or ",".join(QUICK if given.quick else INPUTS), root, parser, known=tuple(references.STEADY))
    return [of_size("convection", path, "", n, (f"domain.particles_x={round(n * aspect(path))}", f"domain.particles_y={n}",
                                            *given.settings), seconds=5.0 * (n / 32)**2) for path in inputs for n in particles]


def aspect(path: Path) -> float:
    """Width over height of the input's box."""
    text = re.sub(r"!.*", "", path.read_text())
    x, y = (re.search(rf"\blength_{axis}\s*=\s*([^\s,/]+)", text, re.IGNORECASE) for axis in "xy")
    return real(x[1]) / real(y[1]) if x and y else 1.0


def judged(one: dict) -> dict[str, tuple[float, float]]:
    return {name: (value["error"], (value["uncertainty"] or 0.0) / value["reference"]) for name in CONVERGENCE
            if (value := one["values"].get(name)) and value["error"] is not None}


def row(outcome: Outcome, _outcomes: list[Outcome]) -> dict:
    metrics = outcome.summary.get("metrics") or {}
    reference = references.of(outcome.case.file, metrics)
    values = {}
    for name in SYMBOL:
        value = outcome.number("metrics", name)
        if value is None or outcome.kind != COMPLETED:
            continue
        right = reference.values.get(name) if reference else None
        values[name] = {"value": value, "uncertainty": outcome.number("metrics", name + "_uncertainty"), "reference": right,
                        "error": value / right - 1 if right else None}
    return {"source": reference.source if reference else None, "steady": metrics.get("steady"),
            "heat_imbalance": outcome.number("metrics", "heat_imbalance"), "values": values}


def sections(outcomes: list[Outcome], measured: dict, folder: Path) -> list[str]:
    cases = list(dict.fromkeys(one["case"] for one in measured["runs"]))
    return [pages.paragraph("The program runs until the flow is steady. What it measures there stands beside the best values known. ± is the "
                            "uncertainty of the average over time, not the error of the method."),
            pages.section("At a glance", glance(measured, cases), pages.figure(
                fields(outcomes), folder / "fields.png",
                "Temperature of the last state at the finest resolution, with isotherms every tenth and the flow's direction and strength.")),
            pages.section("Convergence", pages.figure(
                orders.convergence(orders.series(measured["runs"], judged), lambda case, _, name: (case, *CONVERGENCE[name]),
                                   "|measured/known − 1|"), folder / "convergence.png",
                "Distance from the known value over the number of particles along the height. Bars: uncertainty of the average over time; "
                f"errors within their bar are open and not in the fit. {orders.LINES}"), orders_table(measured)),
            pages.section("Measured, and known", *(case_table(measured, case) for case in cases)),
            pages.section(
                "Profiles and the way to the steady state",
                pages.figure(profiles(outcomes), folder / "profiles.png",
                             "Above: temperature, mean along horizontal lines, 0 at the top and 1 at the bottom. Below: root mean square of the "
                             "horizontal velocity along them."),
                pages.figure(course(outcomes), folder / "course.png",
                             "Nusselt number of the volume over time; dashed: the known value. With target 'steady' the way there is not a "
                             "history.")),
            pages.section("What it costs", pages.figure(
                orders.cost(measured["runs"], {"": ("", style.BLUE)}, "seconds", "seconds, one thread"), folder / "cost.png",
                "To the steady state, at the finest resolution; other work on the machine shows in it."))]


def glance(measured: dict, cases: list[str]) -> str:
    best = {}  # of each case the finest run, if one completed the finest of these
    for one in sorted(measured["runs"], key=lambda one: (one["outcome"] == COMPLETED, one["n"])):
        best[one["case"]] = one
    columns = {"Case": lambda one: pages.name(one["case"]), "n": lambda one: pages.number(one["n"]), "Outcome": state,
               "Nu": lambda one: pages.number(shown(one, "nusselt_volume")), "Nu, error": lambda one: error_cell(error(one, "nusselt_volume")),
               "v_rms (κ/L)": lambda one: pages.number(shown(one, "v_rms")), "v_rms, error": lambda one: error_cell(error(one, "v_rms")),
               "heat in − out": lambda one: error_cell(one["heat_imbalance"]),
               "right-hand sides": lambda one: pages.number(count(one["right_hand_sides"]))}
    return pages.columns([best[case] for case in cases], columns, "wide") + pages.error_key()


def case_table(measured: dict, case: str) -> str:
    """Quantities down, resolutions across, the known value last."""
    runs = [one for one in measured["runs"] if one["case"] == case]
    known = next((one for one in runs if one["source"]), None)
    head = ["", *(text for one in runs for text in (f"n = {one['n']}", "error")), "known"]
    rows = [[pages.cell("outcome"), *(state(one, 2) for one in runs), pages.cell("")]]
    for name in (name for name in SYMBOL if any(name in one["values"] for one in runs)):
        cells = [each for one in runs for each in (pages.number(shown(one, name)), error_cell(error(one, name)))]
        right = known["values"].get(name) if known else None
        text = "" if not known else f"{right['reference']:.6g}" if right and right["reference"] else "–"
        rows.append([pages.name(SYMBOL[name]), *cells, pages.number(f"<b>{text}</b>")])
    for label, made in (("heat in − out", lambda one: error_cell(one["heat_imbalance"])),
                        ("right-hand sides", lambda one: pages.number(count(one["right_hand_sides"]))),
                        ("seconds", lambda one: pages.number(said(one["seconds"])))):
        rows.append([pages.name(label), *(each for one in runs for each in (made(one), pages.cell(""))), pages.cell("")])
    source = f"Known: {escape(known['source'])}." if known else "No value known for this case as run."
    return pages.subsection(case, pages.table(head, rows), pages.small(source))


def orders_table(measured: dict) -> str:
    if not measured["orders"]:
        return ""
    columns = {"Case": lambda one: pages.cell(escape(one["case"])), "Quantity": lambda one: pages.cell(SYMBOL[one["quantity"]]),
               "Order p of |error| ~ n⁻ᵖ": lambda one: pages.number(orders.said(one)), "points": lambda one: pages.number(one["points"])}
    return pages.columns(measured["orders"], columns) + orders.note(measured) + \
        pages.small("± is the standard error of the fit. An order is meaningful only where the error falls steadily: one that "
                    "passes through zero on the way looks small by chance.")


def state(one: dict, columns: int = 1) -> str:
    said = one["outcome"] if one["outcome"] != COMPLETED else "steady" if one["steady"] else "not steady yet"
    return pages.cell(escape(said), state_class(one["outcome"]) if said != "not steady yet" else "stop", columns)


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


def error(one: dict, name: str) -> float | None:
    value = one["values"].get(name)
    return value["error"] if value else None


def terminal(_outcomes: list[Outcome], measured: dict) -> list[str]:
    lines = [f"{'case':<16}{'n':>5}{'Nu':>22}{'error':>10}{'v_rms':>22}{'error':>10}{'rhs':>10}"]
    for one in measured["runs"]:
        if one["outcome"] == COMPLETED:
            mark = "" if one["steady"] else "  not steady yet"
            lines.append(f"{one['case']:<16}{one['n']:>5}" + "".join(f"{shown(one, name):>22}{percent(error(one, name)):>10}" for name in CONVERGENCE)
                         + f"{count(one['right_hand_sides']):>10}{mark}")
        else:
            lines.append(f"{one['case']:<16}{one['n']:>5}  {one['outcome']}: {one['reason']}")
    for one in measured["orders"]:
        lines.append(f"order of {SYMBOL[one['quantity']]} in {one['case']}: {orders.said(one)}")
    return lines


def by_case(outcomes: list[Outcome]) -> dict[str, list[Outcome]]:
    cases: dict[str, list[Outcome]] = {}
    for outcome in outcomes:
        if outcome.kind == COMPLETED:
            cases.setdefault(outcome.case.file, []).append(outcome)
    return cases


def last_state(outcome: Outcome):
    """The last snapshot; rendered, over the box's height: temperature from 0 (top) to 1 (bottom), and the square of the horizontal
    velocity; and the height. None if there is none."""
    snapshot = outcome.snapshot
    if snapshot is None or "Temperature" not in snapshot:
        return None
    height = snapshot.lengths[1]
    top, bottom = (outcome.setting(f"walls.temperature_{side}") for side in ("top", "bottom"))
    kelvin, square = snapshot.map("Temperature", 400), slice_of(snapshot, snapshot["Velocities"][:, 0] ** 2, 400, 2, None)
    extent = tuple(edge / height for edge in kelvin.extent)
    return snapshot, replace(kelvin, values=(kelvin.values - top) / (bottom - top), extent=extent), replace(square, extent=extent), height


def fields(outcomes: list[Outcome]):
    finest = (max(runs, key=lambda o: o.case.n) for runs in by_case(outcomes).values())
    states = [(o.case, s) for o in finest if (s := last_state(o)) is not None]
    if not states:
        return None
    figure, axes = style.map_panels(len(states), max(plots.wide(T) for _, (_, T, _, _) in states), bars=False)
    for ax, (case, (snapshot, T, _, height)) in zip(axes, states):
        image = plots.draw_map(ax, T, "Temperature", "", (0, 1), length="", bar=False)
        plots.isolines(ax, T, np.arange(0.1, 0.95, 0.1))
        draw_arrows(ax, *(snapshot["Coordinates"] / height).T[:2], snapshot["Velocities"][:, :2], plots.wide(T))
        ax.set_title(f"{case.file}, n = {case.n}")
        ax.set(xticks=[0, plots.wide(T)], yticks=[0, 1], xlabel="", ylabel="")
    style.colour_bar(figure, image, axes, "(T − T_top)/(T_bottom − T_top)", shrink=0.7, aspect=30, pad=0.015)
    return figure


def draw_arrows(ax, x, y, v, width, across: int = 11) -> None:
    """The flow at the particles nearest to the points of a coarse lattice."""
    speed = np.hypot(*v.T).max()
    if not speed > 0:
        return
    step = 1 / across
    chosen = [int(np.argmin((x - a) ** 2 + (y - b) ** 2)) for a in np.arange(step / 2, width, step) for b in np.arange(step / 2, 1, step)]
    arrows = v[chosen] / speed * 1.3 * step
    ax.quiver(x[chosen], y[chosen], *arrows.T, angles="xy", scale_units="xy", scale=1, pivot="mid", color="white", edgecolor=style.INK,
              linewidth=0.35, width=0.006, headwidth=4, headlength=4, headaxislength=3.5)


def shade(index: int, count: int) -> tuple:
    """Of one resolution among others: the finer, the darker."""
    return style.plt.get_cmap("viridis_r")(0.15 + 0.8 * (index + 1) / count)


def profiles(outcomes: list[Outcome]):
    cases = by_case(outcomes)
    if not cases:
        return None
    figure, axes = style.panels(2 * len(cases), len(cases), 2.7, "height/L", sharey=True)
    for column, (name, runs) in enumerate(cases.items()):
        above, below = axes[column], axes[column + len(cases)]
        for index, outcome in enumerate(runs):
            got = last_state(outcome)
            if got is None:
                continue
            _, T, square, _ = got
            colour = shade(index, len(runs))
            above.plot(np.nanmean(T.values, axis=1), T.y, color=colour, label=f"n = {outcome.case.n}")
            columns = outcome.history
            unit = columns["v_rms_si"][-1] / columns["v_rms"][-1] if columns and columns["v_rms"][-1] > 0 else 1.0
            below.plot(np.sqrt(np.maximum(np.nanmean(square.values, axis=1), 0)) / unit, square.y, color=colour)
        above.set(title=name, xlim=(0, 1), xlabel="mean temperature")
        below.set_xlim(left=0)
        below.set_xlabel("rms of v_x (κ/L)")
        for ax in (above, below):
            ax.set_ylim(0, 1)
        above.legend(fontsize=8, loc="lower left")
    return figure


def course(outcomes: list[Outcome]):
    cases = by_case(outcomes)
    if not cases:
        return None
    figure, axes = style.panels(len(cases), 3, 2.5, "Nu")
    for ax, (name, runs) in zip(axes, cases.items()):
        highest = 1.0
        for index, outcome in enumerate(runs):
            columns = outcome.history
            if not columns:
                continue
            height = outcome.setting("domain.length_y")
            unit = columns["v_rms_si"][-1] / columns["v_rms"][-1] / height if columns["v_rms"][-1] > 0 else 1.0
            ax.plot(columns["time"] * unit, columns["nusselt_volume"], color=shade(index, len(runs)), linewidth=1.1,
                    label=f"n = {outcome.case.n}")
            highest = max(highest, np.quantile(columns["nusselt_volume"], 0.98))
        reference = references.of(name, runs[-1].summary.get("metrics") or {})
        if reference:
            ax.axhline(reference.values["nusselt_volume"], color=style.INK, linestyle=(0, (4, 3)), linewidth=0.9)
        ax.set(title=name, ylim=(0.9, 1.15 * highest), xlabel="time (L²/κ)")
        ax.legend(fontsize=8, loc="lower right")
    return figure
