"""What slowed sound and heavy inertia do to convection: a map over the note's two factors, of the steady state and of the way there."""
import argparse
import functools
import math
from dataclasses import dataclass
from html import escape
from pathlib import Path

import numpy as np

from .. import pages, style
from . import slowed_roll, steady_flow
from .cases import Run, of_size
from .outcomes import COMPLETED, Outcome
from .parts import count, error_cell, percent, said, sizes, state_class

NAME = "relaxation_map"
TITLE = "How far sound and inertia may be slowed"
ABOUT = "Cases 1a and 1b with the note's equations over (phi_zeta, phi_xi): error of the steady state and of the first overshoot, cost."
PROGRAMS = ("convection",)

STEADY, WAY = "steady state", "first overshoot"
RAYLEIGH = {"blankenbach_1a": 1e4, "blankenbach_1b": 1e5}
INVERSE_SOUND = 2e-16                        # M_th of table 3
PERTURBATION = 0.05
# Input -> n, and of either aim: t_end (κt/L²), and blocks of phi_zeta, phi_xi.
MAP = {"blankenbach_1a": (16, {STEADY: (0.22, ((1, 2), (2, 4, 6)), ((0.5, 1.5), (3,)), ((0.5,), (4,)), ((3,), (6,))),
                               WAY: (0.0165, ((0.004,), (0.125,)), ((0.015, 0.05), (0.25,)), ((0.06, 0.1, 0.3), (0.5,)),
                                     ((0.1, 0.24, 1), (1,)), ((0.3, 1), (2,)))}),
       "blankenbach_1b": (24, {STEADY: (0.12, ((1,), (2,)), ((1, 1.5), (3,)), ((0.5, 1, 2), (4,)), ((1,), (6,))),
                               WAY: (1.6e-3, ((0.015, 0.1), (0.25,)), ((0.035,), (0.375,)), ((0.06, 0.1), (0.5,)), ((0.1, 0.24), (1,)))})}
QUICK = {"blankenbach_1a": (16, {STEADY: (0.22, ((0.5, 2), (2, 4, 6))), WAY: (0.0165, ((0.015,), (0.25,)), ((0.06, 0.1), (0.5,)), ((0.24,), (1,)))})}
VISCOSITY = {"blankenbach_1a": 1e23, "blankenbach_1b": 1e22}  # Pa s, of table 3
FRACTION = 0.1                               # of the note: the Euler step's part of its bounds
ALLOWED = 2e-3
STEADIEST = 3.0                              # φ_ξ, at most, for a steady state: recommended
SETTLED = 2.0                                # φ_ξ over φ_ζ, at least, for a steady state


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--particles", nargs="+", type=int, metavar="N", help="particles along an edge (default: 16 for 1a, 24 for 1b)")


def plan(given: argparse.Namespace, root: Path, parser: argparse.ArgumentParser) -> list[Run]:
    return [run(root, name, n, aim, phi_zeta, phi_xi, end, given)
            for name, (usual, aims) in (QUICK if given.quick else MAP).items() for n in sizes(given, parser, 8, (usual,), (usual,))
            for aim, (end, *blocks) in aims.items() for zetas, xis in blocks for phi_xi in xis for phi_zeta in zetas
            if slowing(name, phi_zeta, phi_xi)[0] >= 1.0]


def numbers(name: str, phi_zeta: float, phi_xi: float) -> tuple[float, float]:
    """c_eff (κ/L) and Pr_eff."""
    return RAYLEIGH[name]**(2 / 3) / phi_zeta, RAYLEIGH[name]**(2 / 3) / phi_xi**2


def slowing(name: str, phi_zeta: float, phi_xi: float) -> tuple[float, float]:
    """ζ and ξ."""
    c_eff, Pr_eff = numbers(name, phi_zeta, phi_xi)
    xi = math.sqrt(2.5e29 / RAYLEIGH[name] / Pr_eff)
    return 1.0 / (INVERSE_SOUND * c_eff * xi), xi


def run(root: Path, name: str, n: int, aim: str, phi_zeta: float, phi_xi: float, end: float, given) -> Run:
    c_eff, Pr_eff = numbers(name, phi_zeta, phi_xi)
    zeta, xi = slowing(name, phi_zeta, phi_xi)
    # Where viscosity binds much more than sound a stabilised method pays.
    viscous, sonic = 0.35 / (n * n * Pr_eff), (0.5 if aim == WAY else 1.0) / (n * c_eff)
    stabilised = viscous < 0.5 * sonic
    evaluations = end * ((10.0 + 2.2 * math.sqrt(sonic / viscous)) / sonic if stabilised else 4.0 / min(viscous, sonic))
    method = ("time.method=rkc2", "time.rtol=1e-3", "time.cfl=0.5") if stabilised else ("time.method=rk4", f"time.cfl={0.5 if aim == WAY else 1.0}")
    # The smoothing of pressure makes a divergence that goes with φ_ζ/φ_ξ²: no more of it than undamped sound needs.
    smoothing = f"convection.pressure_diffusion={min(0.4, 0.07 * c_eff / (n * Pr_eff)):.3g}"
    steps = evaluations / (20.0 if stabilised else 4.0)
    settings = (f"domain.particles_x={n}", f"domain.particles_y={n}", f"relaxation.zeta={zeta:.6g}", f"relaxation.xi={xi:.6g}",
                "convection.target=transient", "convection.steady_tolerance=0", f"material.viscosity={VISCOSITY[name]:g}",
                f"initial.perturbation={PERTURBATION}",
                f"time.t_end={end * 1e18:g}", f"output.history_interval={max(1, round(steps / 1000))}", *method, smoothing, *given.settings)
    return of_size("convection", root / "inputs" / f"{name}.nml", f"{aim}, {phi_zeta:g}, {phi_xi:g}", n, settings,
                   seconds=2.5e-7 * n * n * evaluations + 0.5)


def judged(_one: dict) -> dict[str, tuple[float, float]]:
    return {}


def row(outcome: Outcome, _outcomes: list[Outcome]) -> dict:
    aim, *factors = outcome.case.variant.split(", ")
    found = {"aim": aim, "phi_zeta": float(factors[0]), "phi_xi": float(factors[1]), "nusselt": None, "v_rms": None, "overshoot": None,
             "height": None}
    columns = outcome.history
    if outcome.kind != COMPLETED or not len(columns.get("time", ())):
        return found
    if aim == STEADY:
        return found | {name: without_swings(columns["time"], columns[column])
                        for name, column in (("nusselt", "nusselt_volume"), ("v_rms", "v_rms"))}
    return found | dict(zip(("overshoot", "height"), first_maximum(columns["time"] / 1e18, columns["v_rms"])))


def without_swings(t: np.ndarray, y: np.ndarray) -> float:
    """Mean over the last 0.6 of the time by Hann's window: three swings of a roll or more, which die slowly."""
    part = np.clip((t / t[-1] - 0.4) / 0.6, 0.0, 1.0)
    weight = (1.0 - np.cos(2.0 * math.pi * part)) * np.gradient(t)
    return float(weight @ y / weight.sum())


def first_maximum(t: np.ndarray, v: np.ndarray) -> tuple[float | None, float | None]:
    """When, and how high: of a history that falls by 2 % after it, by a parabola through what lies above 0.99 of it. Sound of the start rings
    within the first tenth."""
    begin = len(t) // 10
    top = begin + int(np.argmax(v[begin:]))
    if v[-1] > 0.98 * v[top]:
        return None, None
    near = (v > 0.99 * v[top]) & (np.abs(np.arange(len(v)) - top) < 200)
    if near.sum() < 5:
        return float(t[top]), float(v[top])
    unit = t[near][-1] - t[near][0]
    curve = np.polynomial.Polynomial.fit((t[near] - t[top]) / unit, v[near], 4)
    peaks = [float(root.real) for root in curve.deriv().roots() if abs(root.imag) < 1e-9]
    peak = min(peaks, key=abs)
    return float(t[top] + unit * peak), float(curve(peak))


@dataclass(frozen=True)
class Found:
    """A run, and the errors of its quantities: 'nusselt', or 'overshoot' and 'height'. Measured: from the least relaxed run."""
    one: dict
    measured: dict[str, float | None]
    foretold: dict[str, float]

    @property
    def worst(self) -> float | None:
        return None if None in self.measured.values() else max(map(abs, self.measured.values()))


def compared(runs: list[dict]) -> list[Found]:
    found = []
    for one in runs:
        known = foretold(one["case"], one["aim"], one["phi_zeta"], one["phi_xi"])
        alike = [r for r in runs if (r["case"], r["n"], r["aim"]) == (one["case"], one["n"], one["aim"]) and r[next(iter(known))]]
        base = min(alike, key=lambda r: (r["phi_xi"], r["phi_zeta"]), default=None)
        if base is None or one[next(iter(known))] is None:
            found.append(Found(one, dict.fromkeys(known), known))
            continue
        # The least relaxed one is not unrelaxed.
        offset = foretold(base["case"], base["aim"], base["phi_zeta"], base["phi_xi"])
        found.append(Found(one, {name: one[name] / base[name] * (1.0 + offset[name]) - 1.0 for name in known}, known))
    return found


@functools.cache
def foretold(name: str, aim: str, phi_zeta: float, phi_xi: float) -> dict[str, float]:
    """Of Nu, by inertia alone, and of the first overshoot's time and height: spectral solutions."""
    Ra, (c_eff, Pr_eff) = RAYLEIGH[name], numbers(name, phi_zeta, phi_xi)
    if aim == STEADY:
        return {"nusselt": steady_flow.solve(Ra, Pr_eff).nusselt / steady_flow.solve(Ra).nusselt - 1.0}
    slowed = slowed_roll.first_overshoot(Ra, PERTURBATION, Pr_eff, c_eff)
    return {key: of / by - 1.0 for key, of, by in zip(("overshoot", "height"), slowed, unrelaxed(name))}


@functools.cache
def law(name: str) -> tuple[float, float, float]:
    """a, b, c of what small factors do: to the time a φ_ξ² − b (φ_ζ/φ_ξ)², to the height c (φ_ζ/φ_ξ)²."""
    phi_xi, ratios = 0.125, (0.04, 0.08)
    first, second = (foretold(name, WAY, phi_xi * ratio, phi_xi) for ratio in ratios)
    squares = [ratio**2 for ratio in ratios]
    b, c = ((second[key] - first[key]) / (squares[1] - squares[0]) for key in ("overshoot", "height"))
    return (first["overshoot"] - b * squares[0]) / phi_xi**2, -b, c


@functools.cache
def unrelaxed(name: str) -> tuple[float, float]:
    """Time (κt/L²) and height (v_rms L/κ) of the first overshoot without inertia, incompressible."""
    return slowed_roll.first_overshoot(RAYLEIGH[name], PERTURBATION)


def steps(name: str, n: int, phi_zeta, phi_xi):
    """The note's Euler steps in L²/κ."""
    c_eff, Pr_eff = numbers(name, phi_zeta, phi_xi)
    return 1.0 / (FRACTION * np.minimum(np.minimum(1.0 / (n * c_eff), 0.5 / (n * n * Pr_eff)), 0.5 / n**2))


def sections(_outcomes: list[Outcome], measured: dict, folder: Path) -> list[str]:
    found = compared(measured["runs"])
    return [pages.paragraph("The note's equations (60) to (64) with inertia on Dv/Dt: ζξ = φ_ζ/(Ra<sup>⅔</sup> M_th), "
                            "ξ = φ_ξ Pr<sup>½</sup>/Ra<sup>⅓</sup>, so that c_eff = Ra<sup>⅔</sup>κ/(L φ_ζ) and Pr_eff = Ra<sup>⅔</sup>/φ_ξ². "
                            "Errors: from the least relaxed run at the same n."),
            pages.section("The map", pages.figure(
                maps(found), folder / "map.png",
                "Error (%) of the steady Nusselt number (left); of time and height of the first maximum of v_rms (right). Grey: the note's Euler "
                "steps in L²/κ at this n. Blue: the note's φ_ξ = 0.5 and Mach number 0.1. Dashed: foretold (left: 0.2 % by inertia; right: of the time, by "
                "the law of small factors). Red: φ_ζ = φ_ξ. Green: within 0.2 %; shaded: recommended. ×: blew up.")),
            *(pages.section(f"{case}: {aim}", table(found, case, aim)) for case in RAYLEIGH for aim in (STEADY, WAY)
              if any((each.one["case"], each.one["aim"]) == (case, aim) for each in found))]


def table(found: list[Found], case: str, aim: str) -> str:
    own = [each for each in found if (each.one["case"], each.one["aim"]) == (case, aim)]
    columns = {"φ_ξ": lambda each: pages.number(f"{each.one['phi_xi']:g}"), "φ_ζ": lambda each: pages.number(f"{each.one['phi_zeta']:g}"),
               "Pr_eff": lambda each: pages.number(said(numbers(case, 1, each.one["phi_xi"])[1])),
               "Outcome": lambda each: pages.cell(escape(each.one["outcome"]), state_class(each.one["outcome"]))}
    for name, (word, form) in ({"nusselt": ("Nu", "{:.4f}")} if aim == STEADY else
                               {"overshoot": ("κt/L²", "{:.7f}"), "height": ("v_rms", "{:.3f}")}).items():
        columns |= {word: lambda each, name=name, form=form: pages.number(said(each.one[name], form)),
                    f"{word}: error": lambda each, name=name: error_cell(each.measured[name]),
                    f"{word}: foretold": lambda each, name=name: pages.number(percent(each.foretold[name]))}
    columns |= {"right-hand sides": lambda each: pages.number(count(each.one["right_hand_sides"])),
                "note's steps in L²/κ": lambda each: pages.number(count(float(
                    steps(case, each.one["n"], each.one["phi_zeta"], each.one["phi_xi"]))))}
    return pages.columns(own, columns, "wide", lambda each: each.one["phi_xi"]) + (explained(case) if aim == WAY else "")


def explained(case: str) -> str:
    time, height = unrelaxed(case)
    a, b, c = law(case)
    return pages.small(f"Without inertia, incompressible: κt/L² = {time:.6f}, v_rms {height:.2f} κ/L. Small factors: time {100 * a:.2f} % φ_ξ² − "
                       f"{100 * b:.1f} % (φ_ζ/φ_ξ)², height {100 * c:.1f} % (φ_ζ/φ_ξ)²; the time is right where φ_ζ = {math.sqrt(a / b):.3f} φ_ξ².")


def maps(found: list[Found]):
    panels = [(case, aim) for case in RAYLEIGH for aim in (STEADY, WAY) if any((each.one["case"], each.one["aim"]) == (case, aim) for each in found)]
    if not panels:
        return None
    figure, axes = style.panels(len(panels), 2, 3.9, "φ_ξ")
    for ax, (case, aim) in zip(axes, panels):
        draw_map(ax, case, aim, [each for each in found if (each.one["case"], each.one["aim"]) == (case, aim)])
    return figure


def border_of_inertia(case: str, low: float, high: float) -> float:
    """φ_ξ at which the error foretold of Nu leaves what is allowed."""
    factors = np.geomspace(low, high, 8)
    errors = [abs(foretold(case, STEADY, 1.0, float(factor))["nusselt"]) for factor in factors]
    beyond = next((i for i, error in enumerate(errors) if error > ALLOWED), 0)
    return float(np.interp(ALLOWED, errors[beyond - 1:beyond + 1], factors[beyond - 1:beyond + 1])) if beyond else high


def draw_map(ax, case: str, aim: str, own: list[Found]) -> None:
    zetas, xis = (sorted({each.one[key] for each in own}) for key in ("phi_zeta", "phi_xi"))
    low, high = (zetas[0] / 1.6, zetas[-1] * 1.6), (min(xis[0], 0.5) / 1.5, xis[-1] * 1.5)
    x, y = np.meshgrid(np.geomspace(*low, 160), np.geomspace(*high, 160))
    lines = ax.contour(x, y, np.log10(steps(case, own[0].one["n"], x, y)), levels=np.arange(3, 10, 0.5), colors=style.FAINT, linewidths=1,
                       linestyles="-")
    ax.clabel(lines, fmt=lambda level: f"$10^{{{level:g}}}$", fontsize=7, colors=style.GREY)
    ax.axhline(0.5, color=style.BLUE, linewidth=1)
    ax.axvline(0.1, color=style.BLUE, linewidth=1)
    if aim == STEADY:
        border = border_of_inertia(case, *high)
        ax.axhline(border, color=style.INK, linestyle="--", linewidth=1)
        top = min(border, STEADIEST)
        zeta = np.geomspace(low[0], top / SETTLED, 20)
        ax.fill_between(zeta, SETTLED * zeta, top, color=style.GREEN, alpha=0.13, linewidth=0)
    else:
        a, b, c = law(case)
        time, height = a * y**2 - b * (x / y)**2, c * (x / y)**2
        marks = ax.contour(x, y, 100 * time, levels=(-5, -1, 1, 5), colors=style.INK, linewidths=0.9, linestyles="--")
        ax.clabel(marks, fmt="%g %%", fontsize=7)
        ax.contourf(x, y, np.maximum(np.abs(time), height), levels=(0.0, ALLOWED), colors=style.GREEN, alpha=0.25)
    ax.plot(low, low, color=style.ALARM, linestyle=":", linewidth=1)
    for each in own:
        place = each.one["phi_zeta"], each.one["phi_xi"]
        if each.worst is None:
            ax.plot(*place, "x", color=style.ALARM)
            continue
        text = "\n".join(f"{100 * error:+.2f}".replace("-", "−") for error in each.measured.values())
        ax.text(*place, text, ha="center", va="center", fontsize=7, color="white" if each.worst <= ALLOWED else style.INK,
                bbox={"boxstyle": "round,pad=0.2", "facecolor": style.GREEN if each.worst <= ALLOWED else style.OUTSIDE, "edgecolor": "none"})
    ax.set(xscale="log", yscale="log", xlim=low, ylim=high, xlabel="φ_ζ", title=f"{case}, n = {own[0].one['n']}: {aim}")
    ax.grid(visible=False)


def terminal(_outcomes: list[Outcome], measured: dict) -> list[str]:
    lines = [f"{'case':<16}{'aim':<17}{'n':>4}{'phi_zeta':>9}{'phi_xi':>8}  {'outcome':<10}{'rhs':>11}  value, error (foretold)"]
    for each in compared(measured["runs"]):
        one = each.one
        values = ", ".join(f"{said(one[name], '{:.6g}'):>11}{percent(each.measured[name]):>10} ({percent(known)})"
                           for name, known in each.foretold.items())
        lines.append(f"{one['case']:<16}{one['aim']:<17}{one['n']:>4}{one['phi_zeta']:>9g}{one['phi_xi']:>8g}  {one['outcome']:<10}"
                     f"{count(one['right_hand_sides']):>11}{values}")
    return lines
