"""What slowed sound and heavy inertia do to convection: a map over the note's two factors, of the steady state and of the way there."""
import argparse
import functools
import math
from html import escape
from pathlib import Path

import numpy as np

from .. import pages, style
from . import steady_flow
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
MAP = {"blankenbach_1a": (16, {STEADY: (0.22, ((1, 2), (2, 4, 6)), ((0.5,), (4,)), ((3,), (6,))),
                               WAY: (0.02, ((0.05,), (0.25,)), ((0.05, 0.1, 0.3), (0.5,)), ((0.1, 0.3, 1), (1, 2)))}),
       "blankenbach_1b": (24, {STEADY: (0.12, ((0.5, 1), (6, 8)), ((0.5,), (4,))),
                               WAY: (1.9e-3, ((0.03,), (0.25,)), ((0.1, 0.35), (0.25,)), ((0.05, 0.1), (0.5,)), ((0.1, 0.3, 1), (1,)))})}
QUICK = {"blankenbach_1a": (16, {STEADY: (0.22, ((0.5, 2), (2, 4, 6))), WAY: (0.02, ((0.1,), (0.25, 0.5, 2)), ((1,), (2,)))})}
VISCOSITY = {"blankenbach_1a": 1e23, "blankenbach_1b": 1e22}  # Pa s, of table 3
FRACTION = 0.1                               # of the note: the Euler step's part of its bounds
ALLOWED = 2e-3
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
    # The smoothing of pressure makes a divergence that goes with 1/ξ²: no more of it than undamped sound needs.
    smoothing = (f"convection.pressure_diffusion={min(0.4, 0.07 * c_eff / (n * Pr_eff)):.3g}",) if aim == STEADY else ()
    steps = evaluations / (20.0 if stabilised else 4.0)
    settings = (f"domain.particles_x={n}", f"domain.particles_y={n}", f"relaxation.zeta={zeta:.6g}", f"relaxation.xi={xi:.6g}",
                "convection.target=transient", "convection.steady_tolerance=0", f"material.viscosity={VISCOSITY[name]:g}",
                f"initial.perturbation={PERTURBATION}",
                f"time.t_end={end * 1e18:g}", f"output.history_interval={max(1, round(steps / 1000))}", *method, *smoothing, *given.settings)
    return of_size("convection", root / "inputs" / f"{name}.nml", f"{aim}, {phi_zeta:g}, {phi_xi:g}", n, settings,
                   seconds=4e-7 * n * n * evaluations + 0.5)


def judged(_one: dict) -> dict[str, tuple[float, float]]:
    return {}


def row(outcome: Outcome, _outcomes: list[Outcome]) -> dict:
    aim, *factors = outcome.case.variant.split(", ")
    found = {"aim": aim, "phi_zeta": float(factors[0]), "phi_xi": float(factors[1]), "nusselt": None, "v_rms": None, "overshoot": None}
    columns = outcome.history
    if outcome.kind != COMPLETED or not len(columns.get("time", ())):
        return found
    if aim == STEADY:
        late = columns["time"] > 0.65 * columns["time"][-1]
        return found | {name: float(np.mean(columns[column][late])) for name, column in (("nusselt", "nusselt_volume"), ("v_rms", "v_rms"))}
    return found | {"overshoot": first_maximum(columns["time"] / 1e18, columns["v_rms"])}


def first_maximum(t: np.ndarray, v: np.ndarray) -> float | None:
    """Of the whole history if it falls by 2 % after it: by a parabola through what lies above 0.99 of it."""
    top = int(np.argmax(v))
    if v[-1] > 0.98 * v[top]:
        return None
    near = v > 0.99 * v[top]
    near &= np.abs(np.arange(len(v)) - top) < 200
    if near.sum() < 4:
        return float(t[top])
    a, b, _ = np.polyfit(t[near] - t[top], v[near], 2)
    return float(t[top] - 0.5 * b / a)


def compared(runs: list[dict]) -> list[tuple[dict, float | None, float | None]]:
    """Each with its error, from the least relaxed run of the same aim and n, and the one foretold."""
    def quantity(one: dict) -> float | None:
        return one["nusselt"] if one["aim"] == STEADY else one["overshoot"]

    found = []
    for one in runs:
        alike = [r for r in runs if (r["case"], r["n"], r["aim"]) == (one["case"], one["n"], one["aim"]) and quantity(r)]
        base = min(alike, key=lambda r: (r["phi_xi"], r["phi_zeta"]), default=None)
        known = foretold(one["case"], one["aim"], one["phi_zeta"], one["phi_xi"])
        if base is None or quantity(one) is None:
            found.append((one, None, known))
            continue
        # The least relaxed one is not unrelaxed.
        offset = foretold(base["case"], base["aim"], base["phi_zeta"], base["phi_xi"])
        found.append((one, quantity(one) / quantity(base) * (1.0 + offset) - 1.0, known))
    return found


@functools.cache
def foretold(name: str, aim: str, phi_zeta: float, phi_xi: float) -> float:
    """Of Nu, by inertia alone: a spectral solution. Of the time to the first overshoot: by the growth of a roll as wide as high,
    (σ + K)(1 + σ/(K Pr_eff)) = σ₀ (1 + σ/(σ + c²/ν)): heavy inertia, and pressure that settles at c_eff²/ν_eff."""
    Ra, (c_eff, Pr_eff) = RAYLEIGH[name], numbers(name, phi_zeta, phi_xi)
    if aim == STEADY:
        return steady_flow.solve(Ra, Pr_eff).nusselt / steady_flow.solve(Ra).nusselt - 1.0
    K = 2.0 * math.pi**2
    driven, settling = Ra * math.pi**2 / K**2, c_eff**2 / Pr_eff
    low, high = 0.0, 2.0 * driven
    for _ in range(60):
        rate = 0.5 * (low + high)
        too_slow = (rate + K) * (1.0 + rate / (K * Pr_eff)) < driven * (1.0 + rate / (rate + settling))
        low, high = (rate, high) if too_slow else (low, rate)
    return (driven - K) / rate - 1.0


@functools.cache
def unrelaxed(name: str) -> float:
    """Time of the first overshoot without inertia, κt/L²."""
    return steady_flow.first_overshoot(RAYLEIGH[name], PERTURBATION)[0]


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
                "Error (%) of the steady Nusselt number (left) and of the time of the first maximum of v_rms (right). Grey: the note's Euler steps "
                "in L²/κ at this n. Blue: the note's φ_ξ = 0.5 and Mach number 0.1. Dashed: foretold (left: 0.2 % by inertia, spectral; right: by "
                "the growth of a roll). Red: φ_ζ = φ_ξ. Green: within 0.2 %; shaded: recommended. ×: blew up.")),
            *(pages.section(f"{case}: {aim}", table(found, case, aim)) for case in RAYLEIGH for aim in (STEADY, WAY)
              if any((one["case"], one["aim"]) == (case, aim) for one, _, _ in found))]


def table(found, case: str, aim: str) -> str:
    own = [each for each in found if (each[0]["case"], each[0]["aim"]) == (case, aim)]
    columns = {"φ_ξ": lambda each: pages.number(f"{each[0]['phi_xi']:g}"), "φ_ζ": lambda each: pages.number(f"{each[0]['phi_zeta']:g}"),
               "Pr_eff": lambda each: pages.number(said(numbers(case, 1, each[0]["phi_xi"])[1])),
               "Outcome": lambda each: pages.cell(escape(each[0]["outcome"]), state_class(each[0]["outcome"])),
               "Nu" if aim == STEADY else "κt/L²": lambda each: pages.number(
                   said(each[0]["nusselt"], "{:.4f}") if aim == STEADY else said(each[0]["overshoot"], "{:.6f}")),
               "error": lambda each: error_cell(each[1]), "foretold": lambda each: pages.number(percent(each[2])),
               "right-hand sides": lambda each: pages.number(count(each[0]["right_hand_sides"])),
               "note's steps in L²/κ": lambda each: pages.number(count(float(
                   steps(case, each[0]["n"], each[0]["phi_zeta"], each[0]["phi_xi"]))))}
    known = pages.small(f"Without inertia, spectral: κt/L² = {unrelaxed(case):.6f}.") if aim == WAY else ""
    return pages.columns(own, columns, "wide", lambda each: each[0]["phi_xi"]) + known


def maps(found):
    panels = [(case, aim) for case in RAYLEIGH for aim in (STEADY, WAY) if any((one["case"], one["aim"]) == (case, aim) for one, _, _ in found)]
    if not panels:
        return None
    figure, axes = style.panels(len(panels), 2, 3.9, "φ_ξ")
    for ax, (case, aim) in zip(axes, panels):
        own = [each for each in found if (each[0]["case"], each[0]["aim"]) == (case, aim)]
        draw_map(ax, case, aim, own)
    return figure


def draw_map(ax, case: str, aim: str, own) -> None:
    zetas, xis = (sorted({one[key] for one, _, _ in own}) for key in ("phi_zeta", "phi_xi"))
    low, high = (zetas[0] / 1.6, zetas[-1] * 1.6), (min(xis[0], 0.5) / 1.5, xis[-1] * 1.5)
    x, y = np.meshgrid(np.geomspace(*low, 80), np.geomspace(*high, 80))
    lines = ax.contour(x, y, np.log10(steps(case, own[0][0]["n"], x, y)), levels=np.arange(3, 9, 0.5), colors=style.FAINT, linewidths=1,
                       linestyles="-")
    ax.clabel(lines, fmt=lambda level: f"$10^{{{level:g}}}$", fontsize=7, colors=style.GREY)
    ax.axhline(0.5, color=style.BLUE, linewidth=1)
    ax.axvline(0.1, color=style.BLUE, linewidth=1)
    if aim == STEADY:
        factors = np.geomspace(*high, 30)
        beyond = [factor for factor in factors if abs(foretold(case, aim, 1.0, float(factor))) > ALLOWED]
        border = beyond[0] if beyond else factors[-1]
        ax.axhline(border, color=style.INK, linestyle="--", linewidth=1)
        zeta = np.geomspace(low[0], border / SETTLED, 20)
        ax.fill_between(zeta, SETTLED * zeta, border, color=style.GREEN, alpha=0.13, linewidth=0)
    else:
        error = np.vectorize(lambda zeta, xi: foretold(case, aim, zeta, xi))(x[::4, ::4], y[::4, ::4])
        marks = ax.contour(x[::4, ::4], y[::4, ::4], 100 * error, levels=(-5, -1, 1, 5), colors=style.INK, linewidths=0.9, linestyles="--")
        ax.clabel(marks, fmt="%g %%", fontsize=7)
        ax.contourf(x[::4, ::4], y[::4, ::4], 100 * error, levels=(-100 * ALLOWED, 100 * ALLOWED), colors=style.GREEN, alpha=0.25)
    ax.plot(low, low, color=style.ALARM, linestyle=":", linewidth=1)
    for one, error, _ in own:
        place = one["phi_zeta"], one["phi_xi"]
        if error is None:
            ax.plot(*place, "x", color=style.ALARM)
            continue
        within = abs(error) <= ALLOWED
        ax.text(*place, f"{100 * error:+.2f}".replace("-", "−"), ha="center", va="center", fontsize=8, color="white" if within else style.INK,
                bbox={"boxstyle": "round,pad=0.25", "facecolor": style.GREEN if within else style.OUTSIDE, "edgecolor": "none"})
    ax.set(xscale="log", yscale="log", xlim=low, ylim=high, xlabel="φ_ζ", title=f"{case}, n = {own[0][0]['n']}: {aim}")
    ax.grid(visible=False)


def terminal(_outcomes: list[Outcome], measured: dict) -> list[str]:
    lines = [f"{'case':<16}{'aim':<17}{'n':>4}{'phi_zeta':>9}{'phi_xi':>8}  {'outcome':<10}{'value':>11}{'error':>10}{'foretold':>10}{'rhs':>11}"]
    for one, error, known in compared(measured["runs"]):
        value = said(one["nusselt"] if one["aim"] == STEADY else one["overshoot"], "{:.6g}")
        lines.append(f"{one['case']:<16}{one['aim']:<17}{one['n']:>4}{one['phi_zeta']:>9g}{one['phi_xi']:>8g}  {one['outcome']:<10}{value:>11}"
                     f"{percent(error):>10}{percent(known):>10}{count(one['right_hand_sides']):>11}")
    return lines
