"""Errors over resolution, with their bars and the fitted order: one panel a quantity or a case."""
from dataclasses import dataclass

import numpy as np
from matplotlib.ticker import FuncFormatter, NullFormatter, NullLocator

from ... import style
from .. import fit


@dataclass(frozen=True)
class Curve:
    label: str
    colour: str
    n: list[int]
    error: list[float]                 # |error|
    bar: list[float]                   # of each, 0 where there is none


def draw(panels: list[tuple[str, list[Curve]]], ylabel: str):
    panels = [(title, [curve for curve in curves if curve.n]) for title, curves in panels]
    panels = [(title, curves) for title, curves in panels if curves]
    if not panels:
        return None
    columns = min(4, len(panels))
    lines = max(len(curves) for _, curves in panels)
    figure, axes = style.panels(len(panels), columns, 2.7 + 0.19 * lines, sharey=len(panels) <= columns)
    for ax, (title, curves) in zip(axes, panels):
        ax.set_xscale("log")
        ax.set_yscale("log")
        for curve in curves:
            draw_curve(ax, curve)
        every = sorted({n for curve in curves for n in curve.n})
        ax.set_xticks(every, [str(n) for n in every])
        ax.xaxis.set_minor_locator(NullLocator())
        ax.set_xlim(every[0] / 1.15, every[-1] * 1.15)
        ax.set_title(title)
        ax.set_xlabel("n")
        if ax.get_subplotspec().is_first_col():
            ax.set_ylabel(ylabel)
        low, high = ax.get_ylim()
        plain = FuncFormatter(lambda value, _: f"{value:.2g}")
        ax.yaxis.set_major_formatter(plain)
        # Between two powers of ten all labels would touch one another.
        some = FuncFormatter(lambda value, _: f"{value:.2g}" if f"{value:e}"[0] in "25" else "")
        ax.yaxis.set_minor_formatter(plain if high < 4 * low else some if high < 100 * low else NullFormatter())
        ax.tick_params(axis="y", which="minor", labelsize=7.5)
        ax.legend(fontsize=8, loc="upper left", bbox_to_anchor=(-0.02, -0.2), handlelength=1.2, borderaxespad=0)
    return figure


def draw_curve(ax, curve: Curve) -> None:
    n, error, bar = (np.array(values, float) for values in (curve.n, curve.error, curve.bar))
    slope = fit.order(curve.n, curve.error, curve.bar)
    label = curve.label + (f", order {fit.said(slope)}" if slope else "")
    # A bar that reaches below zero has no lower end on this axis.
    low = np.minimum(bar, 0.9 * error)
    inside = error <= bar
    ax.errorbar(n, error, yerr=[low, bar] if bar.any() else None, fmt="none", color=curve.colour, linewidth=1, capsize=2.5)
    ax.plot(n[~inside], error[~inside], "o", color=curve.colour, markersize=5, label=label)
    ax.plot(n[inside], error[inside], "o", color=curve.colour, markersize=5, markerfacecolor="white",
            label=label if inside.all() else None)
    if slope:
        ends = np.array([n.min(), n.max()])
        ax.plot(ends, np.exp(slope.intercept) * ends**-slope.value, color=curve.colour, linewidth=1.3, alpha=0.75)
    elif len(n) > 1:
        ax.plot(n, error, color=curve.colour, linewidth=0.8, linestyle=":")
