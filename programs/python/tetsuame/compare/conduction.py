"""The slides' heat conduction: horizontal means of the particles' temperatures over the curves of a half space and a plate that cool."""
import argparse
import math
from pathlib import Path

import numpy as np

from .. import pages, style
from ..runs import Snapshot
from . import orders
from .cases import Run, of_size
from .outcomes import COMPLETED, Outcome
from .parts import error_cell, said, sizes, state_class

NAME = "conduction"
TITLE = "The slides' heat conduction: a half space and a plate that cool"
ABOUT = "Run the slides' cooling by heat conduction; draw horizontal means over the analytical curves of a half space and of a plate."
PROGRAMS = ("conduction", "disph_c")

CASES = {"plate": ("conduction_plate", 1e4), "half space": ("conduction_half_space", 1e3)}  # input, and the end that it has, s
SUM, OWN = "the slides' sum", "as the input has it"
# Beside the input: program and settings. The sum over the quintic kernel is the slides'; C has virtual markers in the place of images.
VARIANTS = {OWN: ("conduction", ()),
            SUM: ("conduction", ("conduction.operator=sum", "kernel.name=quintic")),
            "program C, virtual markers": ("disph_c", ("kernel.name=quintic",)),
            "jitter of 0.1 spacings": ("conduction", ("domain.jitter=0.1",))}
STATES = 40                     # snapshots of a run
SHOWN = (1, 4, 10, 20, STATES)  # of these, in the pictures


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--particles", nargs="+", type=int, metavar="N",
                        help="particles along an edge (default: 25 36 50, of which the last, the slides' 2500 particles, in all runs; with --quick 25)")


def plan(given: argparse.Namespace, root: Path, parser: argparse.ArgumentParser) -> list[Run]:
    runs = []
    numbers = sizes(given, parser, 8, (25, 36, 50), (25,))
    for case, (name, end) in CASES.items():
        for variant, (program, own) in VARIANTS.items():
            for n in numbers if variant == OWN else numbers[-1:]:
                size = (f"domain.particles_x={n}", f"domain.particles_y={n}", f"output.interval={end / STATES}")
                runs.append(of_size(program, root / "inputs" / f"{name}.nml", variant, n, (*size, *own, *given.settings), case=case,
                                    seconds=2.0 * (n / 50) ** 4))
    return runs


# ---- exact solutions [Carslaw & Jaeger, Conduction of Heat in Solids (1959), 2.4 and 3.4], 0 at the surface and 1 at the start ----

def half_space(depth: np.ndarray, time: float, kappa: float) -> np.ndarray:
    """depth: m; time: s; kappa: m2/s"""
    return np.array([math.erf(y / (2.0 * math.sqrt(kappa * time))) for y in np.ravel(depth)]).reshape(np.shape(depth))


def plate(depth: np.ndarray, time: float, kappa: float, thickness: float) -> np.ndarray:
    """By images of the half space where these are few, else by Fourier's sum: either to 1e-12."""
    y, tau = np.asarray(depth) / thickness, kappa * time / thickness**2
    if tau < 0.05:
        cold = sum((1.0 - half_space(2.0 * k + y, tau, 1.0)) - (1.0 - half_space(2.0 * k + 2.0 - y, tau, 1.0)) for k in range(4))
        return 1.0 - cold
    terms = range(1, int(math.sqrt(30.0 / (math.pi**2 * tau))) + 2)
    return y + sum(2.0 / (math.pi * n) * math.exp(-(n * math.pi) ** 2 * tau) * np.sin(n * math.pi * y) for n in terms)


# ---- what a run has ---------------------------------------------------------------------------

class Box:
    """Of a run: its body's numbers, and its exact solution."""

    def __init__(self, outcome: Outcome):
        self.case, self.n = outcome.case.file, outcome.case.n
        self.kappa, self.height = outcome.setting("conduction.diffusivity"), outcome.setting("domain.length_y")
        self.start, self.top = outcome.setting("conduction.temperature"), outcome.setting("walls.temperature_top")

    def exact(self, depth: np.ndarray, time: float, case: str = "") -> np.ndarray:
        if (case or self.case) == "plate":
            return plate(depth, time, self.kappa, self.height)
        return half_space(depth, time, self.kappa)

    def particles(self, state: Snapshot) -> tuple[np.ndarray, np.ndarray]:
        """Depths (m), and temperatures from 0 at the top to 1 at the start."""
        return self.height - state["Coordinates"][:, 1], (state["Temperature"] - self.top) / (self.start - self.top)

    def rows(self, depth: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Means over the particles of each row of the lattice, from the top."""
        row = np.clip((depth / self.height * self.n).astype(int), 0, self.n - 1)
        return np.bincount(row, values, self.n) / np.bincount(row, minlength=self.n)


def errors(box: Box, state: Snapshot) -> tuple[float, float]:
    """The largest of a row's mean, and of a particle."""
    depth, T = box.particles(state)
    off = T - box.exact(depth, state.time)
    return float(np.abs(box.rows(depth, off)).max()), float(np.abs(off).max())


def row(outcome: Outcome, _outcomes: list[Outcome]) -> dict:
    if outcome.kind != COMPLETED:
        return {"times": [], "row_errors": [], "particle_errors": []}
    box = Box(outcome)
    states = [outcome.snapshots[k] for k in SHOWN if k < len(outcome.snapshots)]
    both = [errors(box, state) for state in states]
    return {"times": [state.time for state in states], "row_errors": [mean for mean, _ in both],
            "particle_errors": [largest for _, largest in both]}


def judged(one: dict) -> dict[str, tuple[float, float]]:
    return {"row_mean": (one["row_errors"][-1], 0.0)} if one["row_errors"] and one["variant"] == OWN else {}


# ---- the page ---------------------------------------------------------------------------------

def sections(outcomes: list[Outcome], measured: dict, folder: Path) -> list[str]:
    return [pages.paragraph("As in the slides: circles are temperatures of the particles, averaged horizontally; lines are analytical solutions. "
                            "Neither sizes nor times stand in the slides' text: a box of 20 cm has their limit of the step, 4 s, and the times are "
                            "those printed."),
            *(pages.section(f"The {case}", pages.figure(drawn(outcomes, case), folder / f"{case.replace(' ', '_')}.png", caption(case)))
              for case in CASES),
            pages.section("Errors", table(measured["runs"]), orders.note(measured))]


def caption(case: str) -> str:
    other = "dashed: the half space's, which knows nothing of the bottom" if case == "plate" else "dashed: the plate's"
    return f"Left: horizontal means, at the times printed; full: the {case}'s solution; {other}. Right: means of rows less the exact solution, " \
        "over the difference in temperature, at the end of each run."


def finest(outcomes: list[Outcome], case: str, variant: str) -> Outcome | None:
    found = [one for one in outcomes if one.kind == COMPLETED and one.case.file == case and one.case.variant == variant]
    return max(found, key=lambda one: one.case.n, default=None)


def drawn(outcomes: list[Outcome], case: str):
    shown = finest(outcomes, case, SUM) or finest(outcomes, case, OWN)
    if shown is None:
        return None
    figure, (left, right) = style.panels(2, 2, 4.2)
    box = Box(shown)
    y = np.linspace(0.0, box.height, 401)[1:]
    other = next(name for name in CASES if name != case)
    for index, state in enumerate(shown.snapshots[k] for k in SHOWN if k < len(shown.snapshots)):
        colour = style.numbered(index)["color"]
        depth, T = box.particles(state)
        left.plot(box.exact(y, state.time), 100.0 * y, color=colour, linewidth=1.3, label=f"{state.time:g} s")
        left.plot(box.exact(y, state.time, other), 100.0 * y, color=colour, linewidth=0.9, linestyle=(0, (4, 3)))
        left.plot(box.rows(depth, T), 100.0 * box.rows(depth, depth), "o", color=colour, markersize=3.4, markerfacecolor="white", markeredgewidth=0.9)
    left.set(xlabel="(T − T_top)/(T_start − T_top)", ylabel="depth (cm)", ylim=(100.0 * box.height, 0.0), xlim=(0.0, 1.03),
             title=f"{shown.case.variant}, {box.n} × {box.n} particles")
    left.legend(fontsize=8, loc="lower left")
    for index, variant in enumerate(VARIANTS):
        one = finest(outcomes, case, variant)
        if one is None or one.snapshot is None:
            continue
        box = Box(one)
        depth, T = box.particles(one.snapshot)
        right.plot(box.rows(depth, T - box.exact(depth, one.snapshot.time)), 100.0 * box.rows(depth, depth), label=f"{variant}, n = {box.n}",
                   **style.numbered(index))
    right.set(xlabel="mean of the row − exact", ylim=(100.0 * box.height, 0.0), title=f"t = {shown.snapshot.time:g} s")
    right.ticklabel_format(axis="x", style="sci", scilimits=(-2, 2))
    right.legend(fontsize=8, loc="lower right")
    return figure


def table(runs: list[dict]) -> str:
    columns = {"Case": lambda one: pages.name(one["case"]), "Run": lambda one: pages.cell(one["variant"]), "n": lambda one: pages.number(one["n"]),
               "Outcome": lambda one: pages.cell(one["outcome"], state_class(one["outcome"])),
               "row means, first state": lambda one: error_cell(at(one, "row_errors", 0)),
               "row means, end": lambda one: error_cell(at(one, "row_errors", -1)),
               "a particle, end": lambda one: error_cell(at(one, "particle_errors", -1)),
               "seconds": lambda one: pages.number(said(one["seconds"]))}
    return pages.columns(runs, columns, "wide") + pages.small("Errors: the largest, over the difference in temperature.") + pages.error_key()


def at(one: dict, name: str, which: int) -> float | None:
    return one[name][which] if one[name] else None


def terminal(_outcomes: list[Outcome], measured: dict) -> list[str]:
    lines = [f"{'case':<12}{'run':<28}{'n':>4}  {'outcome':<10}{'rows, first':>12}{'rows, end':>12}{'particle':>12}"]
    for one in measured["runs"]:
        lines.append(f"{one['case']:<12}{one['variant']:<28}{one['n']:>4}  {one['outcome']:<10}"
                     + "".join(f"{said(at(one, name, which), '{:.2e}'):>12}" for name, which in (("row_errors", 0), ("row_errors", -1),
                                                                                                 ("particle_errors", -1))))
    return lines + [f"order of row means, {one['case']}: {orders.said(one)}" for one in measured["orders"]]
