"""Metal over silicate by the programs themselves: A to F, Y, number density, standard SPH, and rti."""
import argparse
from html import escape
from pathlib import Path

import numpy as np
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from .. import pages, plots, style
from . import orders, table
from .cases import Run, of_size
from .outcomes import COMPLETED, Outcome
from .parts import chosen, percent, said, sizes, state_class

NAME = "rti"
TITLE = "Metal over silicate: which scheme survives"
ABOUT = "Run the schemes' programs and rti on the same layers of metal over silicate: growth and overturn."

# Name -> its program, and what it is.
SCHEMES = {
    "A": ("disph_a", "Y by Hosono's iteration (newton), smoothed pressure, virtual markers, pattern 1"),
    "B": ("disph_b", "as A, nothing behind the walls"),
    "C": ("disph_c", "our method, smoothed pressure, virtual markers, pattern 1"),
    "D": ("disph_d", "as C, nothing behind the walls"),
    "E": ("disph_e", "as C, pattern 2"),
    "F": ("disph_f", "our method, pressure from the equation of state, virtual markers, pattern 1"),
    "Y": ("disph_y", "Y by its own evolution equation, smoothed pressure, virtual markers, pattern 1"),
    "C-tied": ("disph_c", "as C, density tied to the particles' places, mirrored walls"),
    "E-tied": ("disph_e", "as E, density tied, mirrored walls"),
    "F-tied": ("disph_f", "as F, density tied, mirrored walls"),
    "Y-tied": ("disph_y", "as Y, Y tied, mirrored walls"),
    "N": ("disph_n", "volumes from the number density, pressure from the equation of state, mirrored walls, pattern 1"),
    "SSPH": ("ssph", "density by summation, pressure from the equation of state, mirrored walls, pattern 1"),
    "rti": ("rti", "as N, with a reference pressure, a kernel that resists no shear and a viscous sum of fourth order"),
}
PROGRAMS = tuple(dict.fromkeys(program for program, _ in SCHEMES.values()))
QUICK = ("A", "C", "E", "F", "Y", "C-tied", "F-tied", "N", "SSPH", "rti")
GROWTH, OVERTURN = "growth", "overturn"
VISCOSITY = ("rti.viscosity_upper=6e11", "rti.viscosity_lower=6e11")
# As the notes have them: the quintic spline with its own support, walls with virtual markers, a density that nothing ties.
AS_PUBLISHED = ("kernel.name=quintic", "kernel.h_over_dx=0", "volume.consistency=none")
MARKERS, NOTHING, MIRROR = (f"walls.treatment={name}" for name in ("virtual_marker", "none", "mirror"))
WALLS = dict.fromkeys("ACEFY", MARKERS) | dict.fromkeys("BD", NOTHING) | {"N": MIRROR, "SSPH": MIRROR}
TIED = ("volume.consistency=tied", MIRROR)
DEAR = {"A": 15.0, "B": 30.0}  # so many times the seconds of the others, which do not iterate
TWO_AND_LEGEND = {"width_ratios": (1.0, 1.0, 0.28)}  # panels


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--schemes", metavar="NAME;…", help=f"schemes to run, by semicolons (there are {'; '.join(SCHEMES)})")
    parser.add_argument("--particles", nargs="+", type=int, metavar="N",
                        help="particles along an edge for the growth (default: 24 48; with --quick 24)")
    parser.add_argument("--overturn", type=int, metavar="N", help="particles along an edge for the overturn (default: 40; with --quick 24)")
    parser.add_argument("--p-top", type=float, default=1e10, metavar="PA",
                        help="pressure at the top, of the growth (default: %(default)g: with the inputs' 1e5 that of a swing of sound is not "
                             "positive, and E and Y stop)")


def plan(given: argparse.Namespace, root: Path, parser: argparse.ArgumentParser) -> list[Run]:
    names = chosen("--schemes", "scheme", given.schemes or ";".join(QUICK if given.quick else SCHEMES), ";", SCHEMES, parser)
    counts = sizes(given, parser, 12, (24, 48), (24,))
    overturn = given.overturn or (24 if given.quick else 40)
    if overturn < 12:
        parser.error("--overturn: at least 12")
    return [run(root, name, case, n, given) for name in names
            for case, n in [*((GROWTH, n) for n in counts), (OVERTURN, overturn)]]


def run(root: Path, name: str, case: str, n: int, given: argparse.Namespace) -> Run:
    file = "rti_linear.nml" if case == GROWTH else "rti_note.nml"
    own = [f"rti.p_top={given.p_top:g}"] if case == GROWTH else ["time.t_end=5000", "output.interval=250", *VISCOSITY]
    if name.endswith("-tied"):
        own += TIED
    elif case == OVERTURN and name != "rti":
        own += [*AS_PUBLISHED, WALLS[name]]
    settings = (f"domain.particles_x={n}", f"domain.particles_y={n}", *own, *given.settings)
    seconds = 3.0 * (n / 48)**3 * (1.0 if case == GROWTH else 3.0) * DEAR.get(name, 1.0)
    return of_size(SCHEMES[name][0], root / "inputs" / file, name, n, settings, case, seconds)


def judged(one: dict) -> dict[str, tuple[float, float]]:
    if one["growth_error"] is None:
        return {}
    return {"growth_rate": (one["growth_error"], one["growth_uncertainty"] / one["growth_theory"])}


def row(outcome: Outcome, _outcomes: list[Outcome]) -> dict:
    last = {name: float(values[-1]) for name, values in outcome.history.items()}  # for a run that stopped

    def metric(name: str, column: str = "") -> float | None:
        return outcome.number("metrics", name) or last.get(column or name)

    # Of a run that stopped, what it measured before is no growth rate of the whole window.
    growth = outcome.number("metrics", "growth_rate") if outcome.case.file == GROWTH and outcome.kind == COMPLETED else None
    theory = outcome.number("metrics", "growth_rate_theory")
    return {"stopped_step": table.stopped_step(outcome), "said": table.said(outcome), "time": outcome.number("time") or last.get("time"),
            "growth_rate": growth, "growth_theory": theory,
            "growth_uncertainty": outcome.number("metrics", "growth_rate_uncertainty") or 0.0,
            "growth_error": growth / theory - 1 if growth is not None and theory else None,
            "metal_centroid": metric("metal_centroid", "centroid"),
            "density_ratio": [metric(f"density_ratio_{end}") for end in ("min", "max")],
            "pressure_min": metric("pressure_min"), "energy_residual": metric("energy_residual")}


def sections(outcomes: list[Outcome], measured: dict, folder: Path) -> list[str]:
    names = list(dict.fromkeys(one["variant"] for one in measured["runs"]))
    methods = [f"<b>{escape(name)}</b> ({SCHEMES[name][0]}): {escape(SCHEMES[name][1])}" for name in names]
    return [pages.paragraph("The same input for all: metal over silicate in the note's box, the notes' programs with their own kernel, walls and "
                            "viscous sum, and those that integrate a density or Y once more with it tied to the particles' places "
                            "(docs/theory/consistency.md). A and B have Newton's iteration here: the plain one of the note diverges where p &lt; K/2."),
            pages.listed(methods),
            pages.section("Who survives", outcome_table(measured, names)),
            pages.section(
                "Overturn",
                pages.figure(states(outcomes), folder / "states.png", "The last state on disk: metal bright, silicate dark."),
                pages.figure(courses(outcomes), folder / "courses.png",
                             "Height of the metal's centroid (a complete overturn ends near 0.25 to 0.3), and the densest and thinnest particle "
                             "over their start values. ×: the run stopped; on the edge of a panel where it was outside.")),
            pages.section(
                "Growth",
                pages.figure(growth(outcomes), folder / "growth.png",
                             "Amplitude of the mode over its start, at the largest number of particles; broad grey: linear theory with "
                             "compressibility and walls. Under the notes' quintic a lattice resists shear by 0.0036 p, which slows growth by some "
                             "10 % at any number of particles: <code>--set kernel.name=wendland_c6</code> gives all schemes the kernel of rti. "
                             "×: the run stopped."),
                pages.figure(orders.convergence(orders.series(measured["runs"], judged), lambda _, name, _quantity: (name, name, style.COLOUR[name]),
                                                "|growth rate/theory − 1|"), folder / "convergence.png",
                             f"Distance of the growth rate from linear theory; bars: uncertainty of its fit. {orders.LINES}"),
                growth_table(measured, names))]


def outcome_table(measured: dict, names: list[str]) -> str:
    finest = {one["variant"]: one for one in sorted(measured["runs"], key=lambda one: one["n"]) if one["case"] == GROWTH}
    over = {one["variant"]: one for one in measured["runs"] if one["case"] == OVERTURN}

    def ratio(one: dict) -> str:
        low, high = one["density_ratio"]
        return "–" if low is None or high is None else f"{low:.2f} to {high:.2f}"

    of_overturn = {"overturn": lambda one: pages.cell(escape(one["said"]), state_class(one["outcome"])),
                   "until": lambda one: pages.number(said(one["time"], "{:.0f} s")), "why": lambda one: pages.cell(escape(cause(one["reason"]))),
                   "centroid/L": lambda one: pages.number(said(one["metal_centroid"], "{:.3f}")), "ρ/ρ_start": lambda one: pages.number(ratio(one)),
                   "energy residual": lambda one: pages.error(one["energy_residual"] if one["outcome"] == COMPLETED else None,
                                                              said(one["energy_residual"], "{:.1e}")),
                   "seconds": lambda one: pages.number(said(one["seconds"]))}
    columns = {"Scheme": lambda name: pages.name(name, style.COLOUR[name]),
               "growth rate, error": lambda name: growth_cell(finest.get(name)),
               **{head: lambda name, made=made: made(over[name]) if name in over else pages.cell("") for head, made in of_overturn.items()}}
    return pages.columns(names, columns) + pages.error_key("Of a run that stopped: as on the last line of its history.")


def growth_cell(one: dict | None) -> str:
    return pages.error(one["growth_error"] if one else None, growth_text(one))


def growth_text(one: dict | None) -> str:
    if one is None:
        return "–"
    return percent(one["growth_error"]) if one["growth_error"] is not None else escape(one["said"])


def cause(reason: str | None) -> str:
    """What stopped a run, in a few words: the message itself stands at the end of the page."""
    text = reason or ""
    if "no state with p > 0 exists" in text:
        return "no solution"
    if "not positive" in text and ("weight Y" in text or "pressure" in text):
        return "Y ≤ 0" if "weight Y" in text else "p ≤ 0"
    if "particles moved" in text:
        return "left its lists in a step"
    return "blew up" if "finite" in text else short(text)


def short(reason: str | None) -> str:
    """The first sentence or so: the whole stands at the end of the page."""
    text = reason or ""
    return text if len(text) <= 90 else text[:87].rsplit(" ", 1)[0] + " …"


def growth_table(measured: dict, names: list[str]) -> str:
    runs = {(one["variant"], one["n"]): one for one in measured["runs"] if one["case"] == GROWTH}
    columns = {"Scheme": pages.name,
               **{f"error, n = {n}": lambda name, n=n: growth_cell(runs.get((name, n))) for n in sorted({n for _, n in runs})},
               "order": lambda name: pages.number(orders.of(measured, GROWTH, name))}
    theory = next((one["growth_theory"] for one in measured["runs"] if one["growth_theory"]), None)
    return pages.columns(names, columns) + orders.note(measured) + (pages.small(f"Linear theory: {theory:.6g} 1/s.") if theory else "")


def terminal(_outcomes: list[Outcome], measured: dict) -> list[str]:
    lines = [f"{'scheme':<18}{'case':<10}{'n':>4}  {'outcome':<11}{'until':>8}  {'growth, error':>13}{'centroid':>10}  why"]
    for one in measured["runs"]:
        until = said(one["time"], "{:.0f} s")
        growth = growth_text(one) if one["case"] == GROWTH and one["outcome"] == COMPLETED else ""
        centroid = f"{one['metal_centroid']:.3f}" if one["case"] == OVERTURN and one["metal_centroid"] is not None else ""
        lines.append(f"{one['variant']:<18}{one['case']:<10}{one['n']:>4}  {one['outcome']:<11}{until:>8}  {growth:>13}{centroid:>10}  "
                     f"{short(one['reason'])}")
    return lines


def look(name: str) -> dict:
    return {"color": style.COLOUR[name], "linestyle": (0, (4, 2)) if name in style.DASHED else "-", "linewidth": 1.4}


def legend(axes, title: str) -> None:
    """Of the first panel, in the last."""
    handles, labels = axes[0].get_legend_handles_labels()
    axes[-1].set_axis_off()
    axes[-1].legend(handles, labels, loc="center left", fontsize=8.5, title=title, alignment="left", handlelength=3)


def states(outcomes: list[Outcome]):
    runs = [o for o in outcomes if o.case.file == OVERTURN and o.snapshot and "Material" in o.snapshot]
    if not runs:
        return None
    figure, axes = style.map_panels(len(runs), 1.0, 5, bars=False)
    for ax, o in zip(axes, runs):
        plots.draw_map(ax, o.snapshot.map("Material"), "Material", "", (0, 1), bar=False)
        until = o.number("time")
        said = "complete" if o.kind == COMPLETED else "stopped" if until is None else f"stopped at {until:.0f} s"
        ax.set_title(o.case.variant, pad=15)
        ax.text(0, 1.02, f"t = {o.snapshot.time:.0f} s, {said}", transform=ax.transAxes, fontsize=8,
                color=style.GREY if o.kind == COMPLETED else style.ALARM)
        ax.set(xticks=[], yticks=[], xlabel="", ylabel="")
    return figure


def courses(outcomes: list[Outcome]):
    runs = [(o, columns) for o in outcomes if o.case.file == OVERTURN and (columns := o.history)]
    if not runs:
        return None
    figure, axes = style.panels(3, 3, 3.6, gridspec_kw=TWO_AND_LEGEND)
    for o, columns in runs:
        t = columns["time"]
        axes[0].plot(t, columns["centroid"], label=o.case.variant, **look(o.case.variant))
        axes[1].plot(t, columns["density_ratio_max"], **look(o.case.variant))
        axes[1].plot(t, columns["density_ratio_min"], **look(o.case.variant))
    # A density that has run away would press the others into a line.
    axes[1].set_ylim(max(0.5, axes[1].get_ylim()[0]), min(2.0, axes[1].get_ylim()[1]))
    for ax, label in zip(axes, ("centroid of the metal/L", "ρ/ρ_start, largest and least")):
        ax.set(xlabel="time (s)", ylabel=label)
        ax.set_xlim(left=0)
    for o, columns in runs:
        if o.kind != COMPLETED:  # up to some steps after the last line of its history
            for ax, quantity in ((axes[0], "centroid"), (axes[1], "density_ratio_max")):
                style.stopped(ax, o.number("time") or columns["time"][-1], columns[quantity][-1], style.COLOUR[o.case.variant])
    legend(axes, "Scheme")
    return figure


def growth(outcomes: list[Outcome]):
    finest = max((o.case.n for o in outcomes if o.case.file == GROWTH), default=0)
    runs = [(o, columns) for o in outcomes if o.case.file == GROWTH and o.case.n == finest and (columns := o.history)]
    if not runs:
        return None
    figure, axes = style.panels(3, 3, 3.4, gridspec_kw=TWO_AND_LEGEND)
    rates = [rate for o, _ in runs if (rate := o.number("metrics", "growth_rate_theory"))]
    end = max(columns["time"][-1] for _, columns in runs)
    if rates:
        t = np.array([0.0, end])
        axes[0].plot(t, np.exp(rates[0] * t), color=style.GREY, linewidth=5, alpha=0.35, zorder=1)
    stops, ratios = [], [1.0]
    for o, columns in runs:
        amplitude = columns["mode_amplitude"] / columns["mode_amplitude"][0]
        good = amplitude > 0
        t, amplitude = columns["time"][good], amplitude[good]
        axes[0].plot(t, amplitude, label=o.case.variant, **look(o.case.variant))
        if rates:
            ratio = amplitude / np.exp(rates[0] * t)
            axes[1].plot(t, ratio, **look(o.case.variant))
            ratios.extend(ratio)
        if o.kind != COMPLETED:
            stops.append((o.number("time") or t[-1], amplitude[-1], style.COLOUR[o.case.variant]))
    axes[0].set_yscale("log")
    axes[0].yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes[0].yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes[0].yaxis.set_minor_formatter(NullFormatter())
    axes[1].set_ylim(max(0.3, 0.98 * min(ratios)), min(1.5, 1.02 * max(ratios)))
    for ax, label in zip(axes, ("amplitude/start", "amplitude/theory")):
        ax.set(xlabel="time (s)", ylabel=label, xlim=(0, end))
    for stop in stops:
        style.stopped(axes[0], *stop)
    legend(axes, f"Scheme, n = {finest}")
    return figure
