"""The HTML page, and its plots."""
from html import escape

from .. import pages, style
from . import analysis, model

COLOUR = {"strong": style.BLUE, "weak": style.ORANGE}
SIZES = {1e7: style.SKY, 1e8: style.BLUE, 1e9: style.INK}  # particles in all
LOADS = {1e3: style.PINK, 1e4: style.ORANGE, 1e6: style.VERMILION}  # particles a rank
RANKS = [1 << k for k in range(15)]


def page(rows: list[dict], exchanges: list[dict]) -> str:
    first, costs = rows[0], model.costs_of(rows, exchanges)
    facts = [escape(first["processor"]), f"{first['cores_here']} cores where it was started", f"version {escape(first['version'])}",
             f"load average {first['load_average']:.1f} at the start"]
    return pages.document("scaling", [
        pages.head("Scaling", facts, f"Program C, inputs/hydrostatic_13.nml at other sizes, {first['steps']} steps, {first['repeats']} rounds. "
                                     "What it means: docs/scaling.md."),
        pages.section("All numbers", numbers(rows),
                      *(pages.paragraph(f"Amdahl's parallel fraction over {fit.over}: {escape(fit.text)}.") for fit in analysis.amdahl(rows))),
        pages.section("Measured", pages.figure(
            measured(rows), caption="Rate a core, of that with the fewest cores. Bars: median of the rounds; lines: least and largest.")),
        pages.section("Where the time goes", pages.figure(
            stages(rows), caption="Of the first rank, waiting included, and with it the start and what is evaluated for output.")),
        pages.section("Predicted", pages.figure(
            prediction(costs) if costs else None,
            caption="Model with the costs below. Full lines: messages through shared memory, as measured here. Dashed, "
                    f"above {model.HDR.ranks_a_node} ranks: {model.HDR.name}, an assumption.")),
        cost_table(costs) if costs else "", exchange_table(exchanges)])


def numbers(rows: list[dict]) -> str:
    shown = analysis.columns(rows)
    return pages.text_table(list(shown), list(zip(*shown.values())), 1, "wide")


def cost_table(c: model.Costs) -> str:
    lines = [["computing, a particle", f"{1e9 * c.particle:.1f} ns"],
             [f"a particle of the halo ({c.halo_bytes:.0f} bytes a step)", f"{1e9 * c.halo:.2f} ns"],
             [f"a message; {c.messages:.1f} to each neighbour", f"{1e6 * c.latency:.2f} µs"],
             [f"a collective, for each doubling of the ranks; {c.collectives:.1f} a step", f"{1e6 * c.collective:.2f} µs"]]
    return pages.section("Costs of the model", pages.text_table(["What", "Measured"], lines, 1))


def exchange_table(exchanges: list[dict]) -> str:
    lines = [[str(e["ranks"]), f"{x['particles']:,}", f"{1e6 * x['seconds']:.2f}", f"{1e6 * x['seconds_least']:.2f}"]
             for e in exchanges for x in e["exchanges"]]
    made = pages.text_table(["Ranks", "Particles", "Median (µs)", "Least (µs)"], lines, 0)
    return pages.section("Exchange of ghosts without physics", made) if lines else ""


def of_kind(rows: list[dict], kind: str) -> list[dict]:
    """By the number of cores."""
    return sorted((r for r in rows if r["kind"] == kind), key=lambda r: (r["ranks"] * r["threads"], r["ranks"]))


def named(row: dict) -> str:
    return f"{row['ranks']}×{row['threads']}"


def measured(rows: list[dict]):
    """Efficiency with its spread over the rounds, strong and weak."""
    figure, axes = style.panels(2, 2, 3.0, "efficiency")
    for ax, kind in zip(axes, ("strong", "weak")):
        shown = of_kind(rows, kind)
        y = [r["efficiency"] for r in shown]
        ax.bar(range(len(shown)), y, width=0.6, color=COLOUR[kind])
        ax.errorbar(range(len(shown)), y, [[r["efficiency"] - r["efficiency_least"] for r in shown],
                                           [r["efficiency_largest"] - r["efficiency"] for r in shown]],
                    linestyle="", color=style.INK, linewidth=1, capsize=3)
        ax.axhline(1.0, color=style.GREY, linewidth=0.8)
        ax.set_xticks(range(len(shown)), [named(r) for r in shown])
        ax.set(xlabel="ranks × threads",
               title=f"{kind}: {analysis.base_of(shown)['particles']:,} particles {'in all' if kind == 'strong' else 'a core'}")
    return figure


def stages(rows: list[dict]):
    """Core time of the first rank by stage, per particle: what grows with the cores does not scale. Start included."""
    shown = of_kind(rows, "strong")

    def nanoseconds(row: dict, name: str) -> float:
        return 1e9 * row["stages"].get(name, 0.0) * row["ranks"] * row["threads"] / (row["steps"] * row["particles"])

    parts = {name: (colour, [nanoseconds(r, name) for r in shown]) for name, colour in style.STAGE.items()}
    return style.stacked([named(r) for r in shown], parts, "core time per particle and step (ns), lists made once", height=0.5)[0]


def prediction(costs: model.Costs, network: model.Network = model.HDR, beside: dict | None = None):
    """Strong and weak, 1 to 16384 ranks. `beside`: {particles: [(ranks, efficiency)]} of the program `balance`."""
    figure, (strong, weak) = style.panels(2, 2, 3.6, "efficiency")
    for ax, colours, all_of in ((strong, SIZES, lambda n, p: n), (weak, LOADS, lambda n, p: n * p)):
        for n, colour in colours.items():
            for net, dashes in ((None, "-"), (network, (0, (4, 2)))):
                label = f"{n:.0e}".replace("e+0", "e") if net is None else None
                ax.plot(RANKS, [model.efficiency(all_of(n, p), p, costs, net) for p in RANKS], color=colour, linestyle=dashes, label=label)
    for n, points in (beside or {}).items():
        colour = SIZES.get(n, style.GREY)
        strong.plot(*zip(*points), linestyle="", marker="o", markersize=4, color=colour, label=f"{n:.0e}, balance".replace("e+0", "e"))
        if n not in SIZES:
            strong.plot(RANKS, [model.efficiency(n, p, costs) for p in RANKS], color=colour, linewidth=1)
    strong.set_title("strong: particles in all")
    weak.set_title("weak: particles a rank")
    for ax in (strong, weak):
        ax.set_xscale("log", base=2)
        ax.set_xticks([4 ** k for k in range(8)], [str(4 ** k) for k in range(8)])
        ax.set(ylim=(0, 1.05), xlabel="ranks, one thread each")
        ax.legend(fontsize=8, loc="lower left")
    return figure
