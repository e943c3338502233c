"""The figures of the comparison of schemes on metal over silicate."""
import numpy as np
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from ... import plots, style
from ..results import history, last_snapshot, number
from ..runner import COMPLETED, Outcome

TWO_AND_LEGEND = {"width_ratios": (1.0, 1.0, 0.28)}


def colour(name: str) -> str:
    return style.COLOUR[name]


def look(name: str) -> dict:
    return {"color": colour(name), "linestyle": (0, (4, 2)) if name in style.DASHED else "-", "linewidth": 1.4}


def stop_of(outcome: Outcome, last_line: float) -> float:
    """The time at which a run stopped (s), up to some steps after the last line of its history."""
    until = number(outcome.summary, "time")
    return last_line if until is None else until


def legend(axes, title: str) -> None:
    """Of the first panel, in the last."""
    handles, labels = axes[0].get_legend_handles_labels()
    axes[-1].set_axis_off()
    axes[-1].legend(handles, labels, loc="center left", fontsize=8.5, title=title, alignment="left", handlelength=3)


def states(outcomes: list[Outcome]):
    runs = [(o, snapshot) for o in outcomes if o.case.file == "overturn" and (snapshot := last_snapshot(o.folder)) and "Material" in snapshot]
    if not runs:
        return None
    figure, axes = style.map_panels(len(runs), 1.0, 5, bars=False)
    for ax, (o, snapshot) in zip(axes, runs):
        plots.draw_map(ax, snapshot.map("Material"), "Material", "", (0, 1), bar=False)
        until = number(o.summary, "time")
        said = "complete" if o.kind == COMPLETED else "stopped" if until is None else f"stopped at {until:.0f} s"
        ax.set_title(o.case.variant, pad=15)
        ax.text(0, 1.02, f"t = {snapshot.time:.0f} s, {said}", transform=ax.transAxes, fontsize=8,
                color=style.GREY if o.kind == COMPLETED else style.ALARM)
        ax.set(xticks=[], yticks=[], xlabel="", ylabel="")
    return figure


def courses(outcomes: list[Outcome]):
    runs = [(o, columns) for o in outcomes if o.case.file == "overturn" and (columns := history(o.folder))]
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
        ax.set_xlabel("time (s)")
        ax.set_ylabel(label)
        ax.set_xlim(left=0)
    for o, columns in runs:
        if o.kind != COMPLETED:
            for ax, quantity in ((axes[0], "centroid"), (axes[1], "density_ratio_max")):
                style.stopped(ax, stop_of(o, columns["time"][-1]), columns[quantity][-1], colour(o.case.variant))
    legend(axes, "Scheme")
    return figure


def growth(outcomes: list[Outcome]):
    finest = max((o.case.n for o in outcomes if o.case.file == "growth"), default=0)
    runs = [(o, columns) for o in outcomes if o.case.file == "growth" and o.case.n == finest and (columns := history(o.folder))]
    if not runs:
        return None
    figure, axes = style.panels(3, 3, 3.4, gridspec_kw=TWO_AND_LEGEND)
    rates = [rate for o, _ in runs if (rate := number(o.summary, "metrics", "growth_rate_theory"))]
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
            stops.append((stop_of(o, t[-1]), amplitude[-1], colour(o.case.variant)))
    axes[0].set_yscale("log")
    axes[0].yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes[0].yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes[0].yaxis.set_minor_formatter(NullFormatter())
    axes[0].set_ylabel("amplitude/start")
    axes[1].set_ylabel("amplitude/theory")
    axes[1].set_ylim(max(0.3, 0.98 * min(ratios)), min(1.5, 1.02 * max(ratios)))
    for ax in axes[:2]:
        ax.set_xlabel("time (s)")
        ax.set_xlim(0, end)
    for stop in stops:
        style.stopped(axes[0], *stop)
    legend(axes, f"Scheme, n = {finest}")
    return figure
