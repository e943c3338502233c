"""Grains: the impacts of Chung and Ooi (2011) beside their formulas, and columns that collapse, over seeds and friction."""
import argparse
import math
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .. import pages, style
from .cases import Run
from .outcomes import COMPLETED, Outcome
from .parts import error_cell, said, state_class

NAME = "granular"
TITLE = "Grains: impacts of one or two spheres, columns that collapse"
ABOUT = "Run the eight impacts of Chung and Ooi (2011) and a column that collapses, over seeds and friction; draw them beside formulas."
PROGRAMS = ("granular",)

# The other material of a test, in the place of the input's.
LIMESTONE = {"material.young_modulus": 2e10, "material.poisson_ratio": 0.25, "material.density": 2500}
MAGNESIUM = {"material.young_modulus": "4e10,1e30", "material.poisson_ratio": "0.35,0.3", "material.density": "1800,1"}
# Test, material, settings, what is expected of delta_max (m), force_max (N), contact_time (s).
HEAD_ON = [(1, "glass", {}, (274.113e-6, 10696.9, 40.339e-6)), (1, "limestone", LIMESTONE, (368.304e-6, 7108.24, 54.201e-6)),
           (2, "aluminium", {}, (49.7172e-6, 11369.9, 731.657e-6)), (2, "magnesium alloy", MAGNESIUM, (52.1233e-6, 7232.68, 767.066e-6))]
QUANTITIES = ("delta_max", "force_max", "contact_time")
RESTITUTIONS = (0.2, 0.4, 0.6, 0.8, 1.0)
ANGLES = (10, 20, 30, 40, 50, 60, 70, 80)  # degrees from the normal
SPEEDS = (0.3, 1.0, 2.0, 5.0, 10.0, 15.0, 20.0, 30.0, 50.0, 70.0)  # m/s, along the plane
SPINS = (0.5, 1.0, 2.0, 4.0, 7.0, 10.0, 15.0, 22.0)  # 1/s
# Sliding and rolling friction of the columns.
FRICTIONS = ((0.1, 0.26), (0.26, 0.05), (0.26, 0.26), (0.5, 0.26), (0.26, 0.6))
SMALL = {"packing.high_x": 0.01, "packing.high_y": 0.015, "solids.centre_x": 0.0105, "domain.length_x": 0.08, "domain.length_y": 0.02,
         "gate.velocity_y": 0.3, "granular.stiffness": 20, "granular.rest_speed": 5e-3}


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--seeds", type=int, default=0, metavar="N", help="columns of each kind (default: 10; with --quick 2)")
    parser.add_argument("--large", action="store_true", help="columns of 4656 grains, minutes each, in the place of 551")


def plan(given: argparse.Namespace, root: Path, parser: argparse.ArgumentParser) -> list[Run]:
    runs: list[Run] = []

    def add(stem: str, file: str, variant: str, settings: dict, seconds: float) -> None:
        words = tuple(f"{key}={value}" for key, value in settings.items()) + tuple(given.settings)
        folder = f"{file}/{re.sub(r'[^A-Za-z0-9.]+', '_', variant)}".replace(" ", "_")
        runs.append(Run("granular", root / "inputs" / f"{stem}.nml", file, f"{file}, {variant}", folder, variant, words, seconds=seconds))

    impact = {"output.history_interval": 1000}
    for test, name, settings, _ in HEAD_ON:
        add(f"collision_{test}", f"test {test}", name, {**impact, **settings}, 0.3)
    for e in RESTITUTIONS:
        add("collision_3", "test 3", f"e = {e:g}", {**impact, "material.restitution": e}, 0.3)
    for angle in ANGLES:
        v = 3.9 * np.array([math.sin(math.radians(angle)), -math.cos(math.radians(angle))])
        add("collision_4", "test 4", f"{angle} degrees", {**impact, "grain.velocity_x": v[0], "grain.velocity_y": v[1]}, 0.3)
    for speed in SPEEDS:
        add("collision_5", "test 5", f"{speed:g} m/s", {**impact, "grain.velocity_x": speed}, 0.3)
    for spin in SPINS:
        add("collision_6", "test 6", f"{spin:g} 1/s", {**impact, "grain.spin_z": spin}, 0.3)
        add("collision_7", "test 7", f"{spin:g} 1/s", {**impact, "grain.spin_z": f"{spin},{spin}"}, 0.3)
        add("collision_8", "test 8", f"{spin:g} 1/s", {**impact, "grain.spin_z": f"{spin},0"}, 0.3)
    seeds = given.seeds or (2 if given.quick else 10)
    if seeds < 0:
        parser.error("--seeds: expected 1 or more")
    small = {} if given.large else SMALL
    for sliding, rolling in FRICTIONS:
        for seed in range(1, seeds + 1):
            add("column_2d", "column", f"friction {sliding:g}, rolling {rolling:g}, seed {seed}",
                {**small, "granular.seed": seed, "material.friction": f"{sliding},{sliding}", "pair.friction": sliding,
                 "material.rolling_friction": f"{rolling},{rolling}", "output.interval": 0}, 11.0 if small else 500.0)
    return runs


@dataclass(frozen=True)
class Expected:
    quantity: str
    value: float


def expected(outcome: Outcome) -> list[Expected]:
    """What formulas say of an impact; nothing where none does."""
    for test, name, _, values in HEAD_ON:
        if outcome.case.file == f"test {test}" and outcome.case.variant == name:
            return [Expected(*pair) for pair in zip(QUANTITIES, values)]
    number = float(re.search(r"[\d.]+", outcome.case.variant)[0]) if outcome.case.file.startswith("test") else 0.0
    if outcome.case.file == "test 3":
        return [Expected("restitution_normal", number)]
    if outcome.case.file == "test 4":  # it slides to the end at a flat angle: mu (1 + e) (1 + 5/2) < tan
        mu, e, R, angle = 0.092, 0.98, 0.0025, math.radians(number)
        if 3.5 * mu * (1.0 + e) < math.tan(angle):
            return [Expected("restitution_tangential", 1.0 - mu * (1.0 + e) / math.tan(angle)),
                    Expected("spin", 2.5 * mu * (1.0 + e) * 3.9 * math.cos(angle) / R)]
    if outcome.case.file in ("test 6", "test 7") and number >= 12.0:
        return [Expected("spin_z", number - 2.5 * 0.4 * 1.5 * 0.2 / 0.1)]
    return []


def row(outcome: Outcome, _outcomes: list[Outcome]) -> dict:
    metrics = outcome.summary.get("metrics", {}) if outcome.kind == COMPLETED else {}
    names = (*QUANTITIES, "restitution_normal", "restitution_tangential", "spin", "spin_z", "velocity_x", "velocity_y", "run_out", "repose_angle",
             "repose_angle_error", "particles_lost")
    return {"measured": {name: metrics[name] for name in names if metrics.get(name) is not None},
            "expected": {one.quantity: one.value for one in expected(outcome)}}


def judged(_one: dict) -> dict[str, tuple[float, float]]:
    return {}  # there are no resolutions


# ---- the page ---------------------------------------------------------------------------------

def sections(outcomes: list[Outcome], measured: dict, folder: Path) -> list[str]:
    runs = measured["runs"]
    return [pages.section("Impacts beside formulas", impacts(runs), pages.error_key()),
            pages.section("Impacts at an angle, and with spin", pages.figure(angles(runs), folder / "impacts.png", "Points: runs. Lines: a sphere that "
                                                                              "slides to the end, which it does at flat angles and fast spins.")),
            pages.section("Columns", pages.figure(columns(runs), folder / "columns.png", "Each point is a column with another seed; bars: their mean."),
                          columns_table(runs))]


def impacts(runs: list[dict]) -> str:
    lines = [{**one, "quantity": name, "value": value, "got": one["measured"].get(name)} for one in runs for name, value in one["expected"].items()]
    shown = {"Impact": lambda one: pages.name(one["case"]), "Run": lambda one: pages.cell(one["variant"]),
             "Outcome": lambda one: pages.cell(one["outcome"], state_class(one["outcome"])), "Quantity": lambda one: pages.cell(one["quantity"]),
             "expected": lambda one: pages.number(said(one["value"], "{:.6g}")), "here": lambda one: pages.number(said(one["got"], "{:.6g}")),
             "difference": lambda one: error_cell(None if one["got"] is None else one["got"] / one["value"] - 1.0)}
    return pages.columns(lines, shown, "wide")


def of(runs: list[dict], case: str, name: str) -> tuple[np.ndarray, np.ndarray]:
    pairs = [(float(re.search(r"[\d.]+", one["variant"])[0]), one["measured"][name]) for one in runs if one["case"] == case and name in one["measured"]]
    return np.array([x for x, _ in pairs]), np.array([y for _, y in pairs])


def angles(runs: list[dict]):
    figure, axes = style.panels(3, 3, 3.2)
    x, y = of(runs, "test 4", "restitution_tangential")
    axes[0].plot(x, y, "o", color=style.BLUE)
    theta = np.linspace(35.0, 85.0, 60)
    axes[0].plot(theta, 1.0 - 0.092 * 1.98 / np.tan(np.radians(theta)), color=style.INK, linewidth=1.0)
    axes[0].set(xlabel="angle (degrees)", ylabel="tangential restitution", title="test 4")
    x, y = of(runs, "test 5", "velocity_x")
    axes[1].plot(x / 1.5, y / 1.5, "o", color=style.BLUE)
    line = np.linspace(7.0, 47.0, 20)
    axes[1].plot(line, line - 2.0, color=style.INK, linewidth=1.0)
    axes[1].set(xlabel="v_t/(μ v_n) before", ylabel="v_t/(μ v_n) after", title="test 5")
    for case, colour in (("test 6", style.BLUE), ("test 7", style.VERMILION), ("test 8", style.GREEN)):
        x, y = of(runs, case, "spin_z")
        axes[2].plot(x, y, "o", color=colour, label=case)
    line = np.linspace(11.0, 22.0, 20)
    axes[2].plot(line, line - 3.0, color=style.INK, linewidth=1.0)
    axes[2].set(xlabel="spin before (1/s)", ylabel="spin after (1/s)", title="tests 6 to 8")
    axes[2].legend(fontsize=8)
    return figure


def kinds(runs: list[dict]) -> dict[str, list[dict]]:
    found: dict[str, list[dict]] = {}
    for one in runs:
        if one["case"] == "column" and "run_out" in one["measured"]:
            found.setdefault(one["variant"].rpartition(", seed")[0], []).append(one["measured"])
    return found


def columns(runs: list[dict]):
    found = kinds(runs)
    if not found:
        return None
    figure, axes = style.panels(2, 2, 3.6)
    for axis, name, label, scale in ((axes[0], "run_out", "run-out (mm)", 1e3), (axes[1], "repose_angle", "slope (degrees)", 1.0)):
        for k, all_of_kind in enumerate(found.values()):
            values = scale * np.array([one[name] for one in all_of_kind if name in one])
            axis.plot(np.full(values.size, k), values, "o", color=style.BLUE, markersize=4)
            if values.size:
                axis.plot([k - 0.25, k + 0.25], [values.mean()] * 2, color=style.INK, linewidth=1.4)
        axis.set(ylabel=label, title=label)
        axis.set_xticks(range(len(found)), [name.replace("friction ", "μ ").replace("rolling", "μ_r").replace(", ", "\n") for name in found])
    return figure


def columns_table(runs: list[dict]) -> str:
    lines = []
    for name, all_of_kind in kinds(runs).items():
        far, steep = (np.array([one[key] for one in all_of_kind if key in one]) for key in ("run_out", "repose_angle"))
        lines.append({"kind": name, "number": len(all_of_kind), "far": far, "steep": steep, "lost": sum(one["particles_lost"] for one in all_of_kind)})
    spread = lambda a, scale: "–" if not a.size else f"{scale * a.mean():.2f} ± {scale * a.std():.2f}"  # noqa: E731
    shown = {"Column": lambda one: pages.name(one["kind"]), "seeds": lambda one: pages.number(one["number"]),
             "run-out (mm)": lambda one: pages.number(spread(one["far"], 1e3)), "slope (degrees)": lambda one: pages.number(spread(one["steep"], 1.0)),
             "grains lost": lambda one: pages.number(one["lost"])}
    return pages.columns(lines, shown, "wide") if lines else ""


def terminal(_outcomes: list[Outcome], measured: dict) -> list[str]:
    lines = [f"{'impact':<10}{'run':<20}{'quantity':<24}{'expected':>14}{'here':>14}{'difference':>12}"]
    for one in measured["runs"]:
        for name, value in one["expected"].items():
            got = one["measured"].get(name)
            off = None if got is None else got / value - 1.0
            lines.append(f"{one['case']:<10}{one['variant']:<20}{name:<24}{value:>14.6g}{said(got, '{:.6g}'):>14}{said(off, '{:+.2e}'):>12}")
    for name, all_of_kind in kinds(measured["runs"]).items():
        far, steep = (np.array([one[key] for one in all_of_kind if key in one]) for key in ("run_out", "repose_angle"))
        slope = f"{steep.mean():.1f} ± {steep.std():.1f} degrees" if steep.size else "no slope"
        lines.append(f"column, {name}: {len(all_of_kind)} seeds, run-out {1e3 * far.mean():.1f} ± {1e3 * far.std():.1f} mm, {slope}")
    return lines
