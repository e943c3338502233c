"""The plots, each as PNG bytes. A plot without data is left out."""
from .. import style
from . import others
from .results import STAGES, choose, fewest_threads, kinds, label, typical

COLOUR = {"program_c": "#0072B2", "program_f": "#009E73", "number_density": "#E69F00", "transport": "#CC79A7",
          "ssph": "#8C8C6E", "disph": "#56B4E9", "gsph": "#A0522D", "gdisph": "#D55E00", "remix": "#6A3D9A"}


def draw_all(measured: list[dict]) -> dict[str, bytes]:
    drawn = {}
    for name, draw in (("others", beside_others), ("rate", rate), ("pair", pair), ("stages", stages),
                       ("scalar", scalar), ("threads", threads)):
        figure = draw(measured)
        if figure is not None:
            drawn[name] = style.png(figure)
    return drawn


def over_particles(measured: list[dict], value, text: str):
    """One line a case over the number of particles, 2-D left and 3-D right, one thread."""
    few = fewest_threads(measured)
    dimensions = sorted({r["dimension"] for r in measured})
    figure, axes = style.panels(len(dimensions), 2, 3.2)
    for ax, dimension in zip(axes, dimensions):
        for kind in kinds(measured):
            if kind[1] != dimension:
                continue
            found = choose(measured, kind, few)
            ax.plot([r["particles"] for r in found], [value(r) for r in found], marker="o", markersize=4,
                    color=COLOUR.get(kind[0], style.INK), label=label(found[0]))
        ax.set_xscale("log")
        ax.set_ylim(0, 1.1 * max(value(r) for r in measured if r["dimension"] == dimension and r["threads"] == few))
        ax.set_xlabel("particles")
        ax.set_title(f"{dimension}-D, {count(few)}")
        ax.legend(fontsize=8, loc="lower right")
    axes[0].set_ylabel(text)
    return figure


def count(threads: int) -> str:
    return "1 thread" if threads == 1 else f"{threads} threads"


def rate(measured: list[dict]):
    return over_particles(measured, lambda r: 1e-6 * r["updates_per_second_per_core"],
                          "million updates a second and core")


def pair(measured: list[dict]):
    return over_particles(measured, lambda r: r["ns_per_pair"], "core time per pair (ns)")


def bars(names: list[str], height: float = 0.42):
    figure, (ax,) = style.panels(1, 1, height * len(names) + 1.2)
    ax.set_yticks(range(len(names)), names)
    ax.invert_yaxis()
    ax.grid(axis="y", visible=False)
    ax.set_axisbelow(True)
    return figure, ax


def stages(measured: list[dict]):
    few = fewest_threads(measured)
    shown = [r for r in (typical(measured, kind, few) for kind in kinds(measured)) if r]
    names = [*STAGES, *sorted({name for r in shown for name in r["stages"]} - set(STAGES))]
    figure, ax = bars([f"{label(r)}, {r['particles']:,}" for r in shown])
    left = [0.0] * len(shown)
    for name in names:
        shares = [100.0 * r["stages"].get(name, 0.0) for r in shown]
        if not any(shares):
            continue
        ax.barh(range(len(shown)), shares, left=left, height=0.68, edgecolor="white", linewidth=0.6, label=name,
                color=style.STAGE.get(name, style.GREY))
        left = [a + b for a, b in zip(left, shares)]
    ax.set_xlabel(f"share of a step (%), {count(few)}")
    ax.set_xlim(0, 100)
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize=8)
    return figure


def beside_others(measured: list[dict]):
    ours = typical(measured, ("program_c", 2), fewest_threads(measured))
    if ours is None:
        return None
    names = [rate.name for rate in others.RATES] + [f"Tetsuame, program C, {ours['particles']:,}"]
    values = [0.5 * (rate.low + rate.high) for rate in others.RATES] + [1e-6 * ours["updates_per_second_per_core"]]
    figure, ax = bars(names)
    ax.barh(range(len(names)), values, height=0.68, color=[style.GREY] * len(others.RATES) + [COLOUR["program_c"]])
    for index, value in enumerate(values):
        ax.annotate(f"{value:.3g}", (value, index), xytext=(4, 0), textcoords="offset points", va="center", fontsize=8)
    ax.set_xlabel("million particle updates a second and core, 2-D")
    ax.margins(x=0.08)
    return figure


def scalar(measured: list[dict]):
    compared = [r for r in measured if "speedup_over_scalar" in r]
    if not compared:
        return None
    compared.sort(key=lambda r: (r["dimension"], r["particles"], r["threads"]))
    figure, ax = bars([f"{r['dimension']}-D, {r['particles']:,}, {count(r['threads'])}" for r in compared], 0.3)
    ax.barh(range(len(compared)), [r["speedup_over_scalar"] for r in compared], height=0.68, color=COLOUR["program_c"])
    ax.axvline(1.0, color=style.INK, linewidth=0.8)
    ax.set_xlabel("program C's two sums: time of the scalar loop / time of the pair engine")
    return figure


def threads(measured: list[dict]):
    few, many = fewest_threads(measured), max(r["threads"] for r in measured)
    if few == many:
        return None
    figure, (ax,) = style.panels(1, 1, 3.4)
    for kind in kinds(measured):
        one = {r["particles"]: r for r in choose(measured, kind, few)}
        largest = max(one, default=None)
        found = [r for r in choose(measured, kind) if r["particles"] == largest]
        if len(found) < 2:
            continue
        ax.plot([r["threads"] for r in found],
                [r["updates_per_second"] / one[largest]["updates_per_second"] for r in found], marker="o", markersize=4,
                color=COLOUR.get(kind[0], style.INK), linestyle="-" if kind[1] == 2 else (0, (4, 2)),
                label=f"{label(found[0])}, {largest:,}")
    ax.plot([few, many], [1, many / few], color=style.GREY, linewidth=0.8, label="ideal")
    ax.set_xticks(sorted({r["threads"] for r in measured}))
    ax.set_xlabel("threads")
    ax.set_ylabel(f"speed-up over {count(few)}")
    ax.legend(fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return figure
