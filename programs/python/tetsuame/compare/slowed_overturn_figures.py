"""The figures of slowed_overturn: maps of the error over zeta and xi, the overturn over the modulus that is left, the poster."""
import re

import numpy as np

from .. import plots, style
from .slowed_overturn_runs import BOXES, DENSITIES, FALLS, GRAVITY

MODULUS = 5e11  # Pa, of rti_linear and rti_note


def maps(answers: dict, points: list[dict]):
    if not answers:
        return None
    figure, axes = style.panels(len(answers), 4, 3.4, "ξ")
    for ax, (name, answer) in zip(axes, answers.items()):
        zeta, xi, error = (np.array(answer["map"][key]) for key in ("zeta", "xi", "error"))
        ax.set(xscale="log", yscale="log", title=name, xlabel="ζ", xlim=(1, zeta[-1]), ylim=(1, xi[-1]))
        levels = [-0.1, -0.01, -0.001, 0.001, 0.01, 0.1]
        broad = [2.6 if abs(level) == 0.01 else 0.9 for level in levels]
        colours = [style.VERMILION if level > 0 else style.BLUE for level in levels]
        ax.contour(zeta, xi, error.T, levels, colors=colours, linewidths=broad,
                   linestyles=["--" if level < 0 else "-" for level in levels])
        numbers = answer["numbers"]
        rules = (0.01 / numbers["dynamic_pressure"], 0.01 / max(numbers["inertia_share_lower"], numbers["inertia_share_upper"]))
        for square, draw in zip(rules, (ax.axvline, ax.axhline)):
            if square > 1:
                draw(square**0.5, color=style.GREY, linestyle=":", linewidth=1.2)
        here = [one for one in points if one["variant"].partition(",")[0] == name and one["growth_error"] is not None]
        ax.plot([one["zeta"] for one in here], [one["xi_lower"] for one in here], "x", color=style.INK, markersize=6, clip_on=False)
        for one in here:
            side, shift = ("right", -5) if one["zeta"] > zeta[-1] ** 0.5 else ("left", 5)
            ax.annotate(f"{100 * one['growth_error']:+.1f}", (one["zeta"], one["xi_lower"]), xytext=(shift, 4), textcoords="offset points",
                        ha=side, fontsize=7.5)
    return figure


def stiffness(runs: list[dict], errors):
    if not runs:
        return None
    box = BOXES["1 km"]
    dynamic = (DENSITIES[0] - DENSITIES[1]) * GRAVITY * box.L
    figure, axes = style.panels(2, 2, 3.0, sharey=True)  # the third fall comes after the end where the liquid is stiff
    kernels = sorted({found[1] for one in runs if (found := re.match(r"h = ([\d.]+)", one["variant"]))})
    for k, (ax, fall) in enumerate(zip(axes, FALLS)):
        for index, width in enumerate(kernels):
            here = [(MODULUS / one["zeta"] ** 2 / dynamic, 100 * error) for one in runs
                    if one["variant"].startswith(f"h = {width}") and (error := errors(one)[k]) is not None]
            if here:
                ax.plot(*zip(*sorted(here)), "o-", color=style.CYCLE[index], label=f"h = {width} Δx")
        ax.axhline(0, color=style.GREY, linewidth=0.8)
        ax.axhspan(-2, 2, color=style.FAINT, alpha=0.6, zorder=0)
        ax.set(xscale="log", title=f"fall of {fall} L", xlabel="K/ζ² over Δρ g L")
    axes[0].set_ylabel("time, error (%)")
    axes[0].legend(fontsize=8)
    return figure


def poster(outcomes: list):
    shown = [o for o in outcomes if o.snapshot and "Material" in o.snapshot]
    if not shown:
        return None
    figure, axes = style.panels(len(shown) + 1, len(shown) + 1, 3.4)
    for ax, o in zip(axes, shown):
        plots.draw_map(ax, o.snapshot.map("Material"), "Material", "", (0, 1), bar=False)
        ax.set(title=f"{o.case.variant}, t = {o.snapshot.time:.3g} s", xticks=[], yticks=[], xlabel="", ylabel="")
    for index, o in enumerate(shown):
        columns = o.history
        if columns:
            axes[-1].plot(columns["time"] / columns["time"][-1], columns["centroid"], color=style.CYCLE[index], label=o.case.variant)
    axes[-1].set(xlabel="t/t_end", ylabel="⟨y⟩/L of the metal", xlim=(0, 1))
    axes[-1].legend(fontsize=8)
    return figure
