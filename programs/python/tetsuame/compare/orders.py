"""Orders of convergence: errors over the number of particles, fitted and drawn; and what the finest run costs."""
from dataclasses import dataclass

import numpy as np
from matplotlib.ticker import FuncFormatter, NullFormatter, NullLocator

from .. import pages, style
from .outcomes import COMPLETED

FEWEST = 3  # points of an order: two lie on a line whatever the error does
WHY_NONE = f"–: no order; a fit takes at least {FEWEST} numbers of particles with an error larger than its uncertainty."
LINES = "Lines: the fitted order; dotted: too few points for one."  # of captions


@dataclass(frozen=True)
class Order:
    """p of |error| = C n^-p by least squares in the logarithms."""
    value: float
    error: float        # standard error of the fit
    intercept: float    # ln C
    points: int


def usable(n: list[int], errors: list[float], uncertainties: list[float]) -> list[tuple[float, float]]:
    """Logarithms of n and of |error|. An error within the uncertainty of its measurement says nothing of an order and is left out."""
    return [(np.log(k), np.log(abs(e))) for k, e, u in zip(n, errors, uncertainties) if e is not None and np.isfinite(e) and abs(e) > u]


def order(n: list[int], errors: list[float], uncertainties: list[float]) -> Order | None:
    """None for fewer than FEWEST numbers of particles."""
    used = usable(n, errors, uncertainties)
    if len({k for k, _ in used}) < FEWEST:
        return None
    (slope, intercept), covariance = np.polyfit(*np.array(used).T, 1, cov=True)
    return Order(-float(slope), float(np.sqrt(covariance[0, 0])), float(intercept), len(used))


def series(runs: list[dict], judged) -> dict[tuple[str, str, str], list[tuple[int, float, float]]]:
    """Of each case, variant and quantity: n, error and its uncertainty. judged(row): the latter two by quantity."""
    found: dict[tuple[str, str, str], list[tuple[int, float, float]]] = {}
    for one in runs:
        for quantity, (error, uncertainty) in judged(one).items():
            found.setdefault((one["case"], one["variant"], quantity), []).append((one["n"], error, uncertainty))
    return found


def entries(runs: list[dict], judged) -> list[dict]:
    """Of results.json: of what, the order (None without one), and how many points there are."""
    found = []
    for (case, variant, quantity), points in series(runs, judged).items():
        fit = order(*zip(*points))
        found.append({"case": case, "variant": variant, "quantity": quantity, "order": fit.value if fit else None,
                      "standard_error": fit.error if fit else None, "points": len(usable(*zip(*points)))})
    return found


def of(measured: dict, case: str, variant: str) -> str:
    return next((said(one) for one in measured["orders"] if (one["case"], one["variant"]) == (case, variant)), "–")


def said(entry: dict) -> str:
    """'1.92 ± 0.05', or a dash."""
    return "–" if entry["order"] is None else f"{entry['order']:.2f} ± {entry['standard_error']:.2f}"


def note(measured: dict) -> str:
    """Below a table with orders: why there is none, where that is so."""
    return pages.small(WHY_NONE) if any(one["order"] is None for one in measured["orders"]) else ""


def convergence(points_of: dict, look, ylabel: str):
    """`points_of`: of series(); look(case, variant, quantity): the title of the panel, the label and the colour of the curve."""
    panels: dict[str, list] = {}
    for key, points in points_of.items():
        title, label, colour = look(*key)
        panels.setdefault(title, []).append((label, colour, points))
    panels = {title: curves for title, curves in panels.items() if any(len(points) > 1 for *_, points in curves)}
    if not panels:
        return None
    columns = min(4, len(panels))
    lines = max(map(len, panels.values()))
    figure, axes = style.panels(len(panels), columns, 2.7 + 0.19 * lines, ylabel, sharey=len(panels) <= columns)
    figure.set_size_inches(style.WIDTH * min(1.0, 0.45 * columns), figure.get_size_inches()[1])
    for ax, (title, curves) in zip(axes, panels.items()):
        ax.set(xscale="log", yscale="log")
        for curve in curves:
            draw_curve(ax, *curve)
        every = sorted({n for *_, points in curves for n, *_ in points})
        ax.set_xticks(every, [str(n) for n in every])
        ax.xaxis.set_minor_locator(NullLocator())
        ax.set(title=title, xlabel="n", xlim=(every[0] / 1.15, every[-1] * 1.15))
        low, high = ax.get_ylim()
        if high < 2 * low:  # a change that is none should not fill the panel
            low, high = ax.set_ylim(low / 1.6, high * 1.6)
        plain = FuncFormatter(lambda value, _: f"{value:.2g}")
        ax.yaxis.set_major_formatter(plain)
        # Between two powers of ten all labels would touch one another.
        some = FuncFormatter(lambda value, _: f"{value:.2g}" if f"{value:e}"[0] in "25" else "")
        ax.yaxis.set_minor_formatter(plain if high < 4 * low else some if high < 100 * low else NullFormatter())
        ax.tick_params(axis="y", which="minor", labelsize=7.5)
        ax.legend(fontsize=8, loc="upper left", bbox_to_anchor=(-0.02, -0.2), handlelength=1.2, borderaxespad=0)
    return figure


def draw_curve(ax, label: str, colour: str, points: list[tuple[int, float, float]]) -> None:
    fit = order(*zip(*points))
    n, error, bar = np.abs(np.array(points, float)).T
    label += f", order {fit.value:.2f} ± {fit.error:.2f}" if fit else ""
    # A bar that reaches below zero has no lower end on this axis.
    low = np.minimum(bar, 0.9 * error)
    inside = error <= bar
    ax.errorbar(n, error, yerr=[low, bar] if bar.any() else None, fmt="none", color=colour, linewidth=1, capsize=2.5)
    ax.plot(n[~inside], error[~inside], "o", color=colour, markersize=5, label=label)
    ax.plot(n[inside], error[inside], "o", color=colour, markersize=5, markerfacecolor="white",
            label=label if inside.all() else None)
    if fit:
        ends = np.array([n.min(), n.max()])
        ax.plot(ends, np.exp(fit.intercept) * ends**-fit.value, color=colour, linewidth=1.3, alpha=0.75)
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
