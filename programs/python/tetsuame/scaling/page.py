"""The HTML page."""
from html import escape

from .. import pages, style
from . import analysis, figures, model

CAPTIONS = {
    "measured": ("Measured", "Rate a core, of that with the fewest cores. Bars: median of the rounds; lines: least and largest."),
    "stages": ("Where the time goes", "Of the first rank, waiting included, and with it the start and what is evaluated for output."),
    "prediction": ("Predicted", "Model with the costs below. Full lines: messages through shared memory, as measured here. Dashed, "
                   f"above {model.HDR.ranks_a_node} ranks: {model.HDR.name}, an assumption."),
}


def page(rows: list[dict], exchanges: list[dict]) -> str:
    first, costs = rows[0], model.costs_of(rows, exchanges)
    facts = [escape(first["processor"]), f"{first['cores_here']} cores where it was started", f"version {escape(first['version'])}",
             f"load average {first['load_average']:.1f} at the start"]
    drawn = style.draw_all({"measured": figures.measured(rows), "stages": figures.stages(rows),
                            "prediction": figures.prediction(costs) if costs else None})
    return pages.document("scaling", [
        pages.head("Scaling", facts, f"Program C, inputs/hydrostatic_13.nml at other sizes, {first['steps']} steps, {first['repeats']} rounds. "
                                     "What it means: docs/scaling.md."),
        pages.section("All numbers", numbers(rows),
                      *(pages.paragraph(f"Amdahl's parallel fraction over {fit.over}: {escape(fit.text)}.") for fit in analysis.amdahl(rows))),
        *(pages.section(CAPTIONS[name][0], pages.figure(png, CAPTIONS[name][1])) for name, png in drawn.items()),
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
