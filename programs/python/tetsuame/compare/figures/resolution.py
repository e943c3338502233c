"""What the comparisons over resolution share: errors over n, with their bars and the fitted order; cost at the largest n."""
import numpy as np
from matplotlib.ticker import FuncFormatter, NullFormatter, NullLocator

from ... import style
from .. import fit
from ..runner import COMPLETED


LINES = "Lines: the fitted order; dotted: too few points for one."  # of captions


def convergence(series: dict, look, ylabel: str):
    """`series`: of fit.series; look(case, variant, quantity): the title of the panel, the label and the colour of the curve."""
    panels: dict[str, list] = {}
    for key, points in series.items():
        title, label, colour = look(*key)
        panels.setdefault(title, []).append((label, colour, points))
    panels = {title: curves for title, curves in panels.items() if any(len(points) > 1 for *_, points in curves)}
    if not panels:
        return None
    columns = min(4, len(panels))
    lines = max(map(len, panels.values()))
    figure, axes = style.panels(len(panels), columns, 2.7 + 0.19 * lines, sharey=len(panels) <= columns)
    figure.set_size_inches(style.WIDTH * min(1.0, 0.45 * columns), figure.get_size_inches()[1])
    for ax, (title, curves) in zip(axes, panels.items()):
        ax.set_xscale("log")
        ax.set_yscale("log")
        for curve in curves:
            draw_curve(ax, *curve)
        every = sorted({n for *_, points in curves for n, *_ in points})
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


def draw_curve(ax, label: str, colour: str, points: list[tuple[int, float, float]]) -> None:
    slope = fit.order(*zip(*points))
    n, error, bar = np.abs(np.array(points, float)).T
    label += f", order {fit.said(slope)}" if slope else ""
    # A bar that reaches below zero has no lower end on this axis.
    low = np.minimum(bar, 0.9 * error)
    inside = error <= bar
    ax.errorbar(n, error, yerr=[low, bar] if bar.any() else None, fmt="none", color=colour, linewidth=1, capsize=2.5)
    ax.plot(n[~inside], error[~inside], "o", color=colour, markersize=5, label=label)
    ax.plot(n[inside], error[inside], "o", color=colour, markersize=5, markerfacecolor="white",
            label=label if inside.all() else None)
    if slope:
        ends = np.array([n.min(), n.max()])
        ax.plot(ends, np.exp(slope.intercept) * ends**-slope.value, color=colour, linewidth=1.3, alpha=0.75)
    elif len(n) > 1:
        ax.plot(n, error, color=colour, linewidth=0.8, linestyle=":")


def cost(runs: list[dict], variants: dict[str, tuple[str, str]], key: str, label: str, unit: float = 1.0):
    """Bars at the largest n of each case; `variants`: label and colour by name, `unit`: of the axis in that of the key."""
    found: dict[str, dict[str, float]] = {}
    for one in runs:
        finest = max(other["n"] for other in runs if other["case"] == one["case"])
        if one["outcome"] == COMPLETED and one[key] and one["n"] == finest:
            found.setdefault(one["case"], {})[one["variant"]] = one[key] / unit
    if not found:
        return None
    figure, ax = style.across(list(found), margin=0.3 if len(variants) > 1 else 0.8)
    width = 0.8 / len(variants)
    for k, (variant, (name, colour)) in enumerate(variants.items()):
        seen = [(row + (k - 0.5 * (len(variants) - 1)) * width, values[variant])
                for row, values in enumerate(found.values()) if variant in values]
        if seen:
            ax.barh(*zip(*seen), height=0.92 * width, color=colour, label=name)
    ax.set_xlabel(label)
    if len(variants) > 1:
        style.legend_beside(ax)
    return figure
