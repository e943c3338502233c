"""The HTML page."""
import time
from html import escape

from .. import pages
from . import others
from .results import CASES

CAPTIONS = {
    "others": ("Beside other codes", "Program C with wall correction, lists and integration included, beside the rates "
               "in the table below. They are not measured in this run."),
    "rate": ("Rate over size", "A flat line: time per particle does not grow when the arrays no longer fit into caches."),
    "pair": ("Time per pair", "All of a step's time, divided by the pairs within the kernel's support. Cases with two "
             "passes over the lists visit each pair twice; it counts once."),
    "stages": ("Where the time goes", "Shares of a step at the size nearest to 400² particles. Lists: their making, "
               "spread over {steps} steps. Integration: the integrator's own work on the state."),
    "scalar": ("Against a scalar loop", "The same two sums over the same list, in turn in the same run; medians of the "
               "ratios. Both agree to round-off, or bench would have failed."),
    "threads": ("Threads", "At the largest number of particles of each case; dashed: 3-D."),
}


def page(measured: list[dict], drawn: dict[str, bytes]) -> str:
    parts = [head(measured)]
    for name, png in drawn.items():
        title, caption = CAPTIONS[name]
        parts.append(f"<h2>{title}</h2>\n" + pages.figure(png, caption.format(steps=measured[0]["steps_per_list"])))
        if name == "others":
            parts.append(other_codes())
    parts.append(numbers(measured))
    return pages.document("speed", parts)


def head(measured: list[dict]) -> str:
    first = measured[0]
    load = max(r["load_average"] for r in measured)
    facts = [time.strftime("%Y-%m-%d %H:%M"), escape(str(first["processor"])), f"{first['simd_lanes']} lanes of double",
             f"version {escape(str(first['version']))}", f"load average up to {load:.1f}"]
    return ("<h1>Speed of the right-hand side</h1>\n"
            f"<p class=\"facts\">{' · '.join(facts)}</p>\n"
            "<p>A box of liquid iron between two walls, periodic sideways; for the schemes of gas a periodic box, a square of it four "
            "times as dense. Every particle off its lattice place, stepped by the programs' own time loop (Euler). Medians. What bounds the speed: docs/performance.md.</p>")


def other_codes() -> str:
    rows = [[r.name, r.remark, f"{r.low:g}" if r.low == r.high else f"{r.low:g}–{r.high:g}"] for r in others.RATES]
    return (pages.text_table(["Code", "What", "million updates/s per core"], rows, 2)
            + "\n<p class=\"small\">Measured once by the makers of this code on a machine of the same kind: one core, double "
            "precision, 2-D, about 41 neighbours unless it says otherwise. Each solves its own equations, some simpler.</p>")


def numbers(measured: list[dict]) -> str:
    rows = []
    for r in measured:
        walls = 100.0 * r["stages"].get("walls", 0.0)
        speedup = r.get("speedup_over_scalar")
        rows.append([CASES.get(r["name"], r["name"]), f"{r['dimension']}", f"{r['particles']:,}", f"{r['threads']}",
                     f"{r['neighbours']:.1f}", f"{1e-6 * r['updates_per_second_per_core']:.3g}",
                     f"{1e-6 * r['pairs_per_second_per_core']:.4g}", f"{r['ns_per_pair']:.2f}",
                     "" if speedup is None else f"{speedup:.2f}", f"{walls:.1f} %", f"{r['bytes_per_particle']:.0f}",
                     f"{r['list_bytes_per_particle']:.0f}", f"{r['load_average']:.1f}"])
    return ("<h2>All numbers</h2>\n"
            + pages.text_table(["Case", "D", "Particles", "Threads", "Neighbours", "M updates/s per core", "M pairs/s per core",
                     "ns per pair", "Over scalar", "Walls", "Bytes/particle", "List bytes", "Load"], rows, 1, "wide")
            + "\n<p class=\"small\">Neighbours: within the kernel's support, a particle. Bytes: all memory in use but the "
            "lists; ghosts and walls make it large for small boxes. Everything is in bench.json beside this page.</p>")
