"""The page of `./run bench`: reads bench.json, writes report.html beside it."""
from html import escape
from pathlib import Path

from . import pages, style
from .reading import Damaged, is_number, read_json

# Of each case its name and colour; those of gas have the colours of their schemes, and dashed lines.
CASES = {"program_c": ("program C", style.COLOUR["C"]), "program_f": ("program F", style.COLOUR["F"]),
         "number_density": ("number density", style.COLOUR["N"]), "transport": ("C with conduction and own viscosities", style.PINK)} | {
    name: (f"gas, {title}", colour) for name, (title, colour) in style.SCHEME.items()}

# Rates of other codes, million particle updates a second and core, least and largest: see other_codes().
RATES = (
    ("Fortran convection code", "of the notes' author; gfortran -O3 -march=native, n = 100², about 66 neighbours", 0.063, 0.063),
    ("sphcode", "DISPH", 0.126, 0.126),
    ("SWIFT", "pressure–energy SPH, quintic spline, adaptive h", 0.50, 0.50),
    ("LAMMPS", "SPH package, half lists, the simplest physics of these", 2.4, 2.6),
    ("plain loops", "full list, density and force, vectorised by the compiler, no walls", 2.2, 2.2),
)

POSITIVE = ("dimension", "particles", "threads", "neighbours", "updates_per_second", "updates_per_second_per_core", "pairs_per_second_per_core",
            "ns_per_pair", "bytes_per_particle", "list_bytes_per_particle", "simd_lanes", "steps_per_list")


def read(path: Path) -> list[dict]:
    measured = read_json(path, "bench", list)
    if not measured or not all(map(whole, measured)):
        raise Damaged(f"{path}: {'holds measurements that are not whole' if measured else 'holds no measurement'}; run bench again")
    return [r | look(r) for r in measured]


def whole(r) -> bool:
    """Whether a measurement has what the page shows."""
    return (isinstance(r, dict) and all(isinstance(r.get(name), str) for name in ("name", "processor", "version"))
            and all(is_number(r.get(name)) and r[name] > 0 for name in POSITIVE) and is_number(r.get("load_average"))
            and all(isinstance(r[name], int) for name in ("dimension", "particles", "threads"))
            and isinstance(r.get("stages"), dict) and all(map(is_number, r["stages"].values())) and is_number(r.get("speedup_over_scalar", 1.0)))


def look(result: dict) -> dict:
    """What a result is called, and the keyword arguments of plot() for it."""
    title, colour = CASES.get(result["name"], (result["name"], style.INK))
    single, gas = result.get("precision") == "single", result["name"] in style.SCHEME
    return {"title": title + (", single precision" if single else ""),
            "line": {"color": colour, "linestyle": ":" if single else (0, (4, 2)) if gas else "-", "marker": "s" if gas else "o", "markersize": 4}}


def label(result: dict) -> str:
    return f"{result['title']}, {result['dimension']}-D"


def kinds(measured: list[dict]) -> list[tuple[str, int]]:
    """Title and dimension of every case, in the order measured."""
    return list(dict.fromkeys((r["title"], r["dimension"]) for r in measured))


def choose(measured: list[dict], kind: tuple[str, int], threads: int | None = None) -> list[dict]:
    """The results of a case by number of particles; all numbers of threads unless one is given."""
    found = [r for r in measured if (r["title"], r["dimension"]) == kind and threads in (None, r["threads"])]
    return sorted(found, key=lambda r: (r["particles"], r["threads"]))


def fewest_threads(measured: list[dict]) -> int:
    return min(r["threads"] for r in measured)


def typical(measured: list[dict], kind: tuple[str, int], threads: int) -> dict | None:
    """The result whose number of particles is nearest to 400²: too large for the caches, as runs are."""
    found = choose(measured, kind, threads)
    return min(found, key=lambda r: abs(r["particles"] - 160_000)) if found else None


def over_particles(measured: list[dict], value, text: str):
    """One line a case over the number of particles, 2-D left and 3-D right, one thread."""
    few = fewest_threads(measured)
    dimensions = sorted({r["dimension"] for r in measured})
    figure, axes = style.panels(len(dimensions), 2, 3.2, text)
    for ax, dimension in zip(axes, dimensions):
        for kind in kinds(measured):
            if kind[1] == dimension and (found := choose(measured, kind, few)):
                ax.plot([r["particles"] for r in found], [value(r) for r in found], **found[0]["line"], label=kind[0])
        ax.set_xscale("log")
        ax.set_ylim(0, 1.1 * max((value(r) for r in measured if r["dimension"] == dimension and r["threads"] == few), default=1.0))
        ax.set(xlabel="particles", title=f"{dimension}-D, {count(few)}")
    style.legend_above(figure, axes)
    return figure


def count(threads: int) -> str:
    return "1 thread" if threads == 1 else f"{threads} threads"


def stages(measured: list[dict]):
    few = fewest_threads(measured)
    shown = [r for r in (typical(measured, kind, few) for kind in kinds(measured)) if r]
    others = {name for r in shown for name in r["stages"]} - set(style.STAGE)
    parts = {name: (style.STAGE.get(name, style.GREY), [100.0 * r["stages"].get(name, 0.0) for r in shown])
             for name in (*style.STAGE, *sorted(others))}
    figure, ax, _ = style.stacked([f"{label(r)}, {r['particles']:,}" for r in shown], parts, f"share of a step (%), {count(few)}")
    ax.set_xlim(0, 100)
    return figure


def beside_others(measured: list[dict]):
    title, colour = CASES["program_c"]
    ours = typical(measured, (title, 2), fewest_threads(measured))
    if ours is None:
        return None
    names = [name for name, *_ in RATES] + [f"Tetsuame, program C, {ours['particles']:,}"]
    values = [0.5 * (low + high) for *_, low, high in RATES] + [1e-6 * ours["updates_per_second_per_core"]]
    figure, ax = style.across(names)
    ax.barh(range(len(names)), values, height=0.68, color=[style.GREY] * len(RATES) + [colour])
    style.say_at_ends(ax, values, [f"{value:.3g}" for value in values])
    ax.set_xlabel("million particle updates a second and core, 2-D")
    return figure


def scalar(measured: list[dict]):
    compared = [r for r in measured if "speedup_over_scalar" in r]
    if not compared:
        return None
    compared.sort(key=lambda r: (r["dimension"], r["particles"], r["threads"]))
    figure, ax = style.across([f"{r['dimension']}-D, {r['particles']:,}, {count(r['threads'])}{', single' * (r.get('precision') == 'single')}" for r in compared], 0.3)
    ax.barh(range(len(compared)), [r["speedup_over_scalar"] for r in compared], height=0.68, color=CASES["program_c"][1])
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
                [r["updates_per_second"] / one[largest]["updates_per_second"] for r in found],
                **found[0]["line"] | ({} if kind[1] == 2 else {"markerfacecolor": "white"}),
                label=f"{label(found[0])}, {largest:,}")
    ax.plot([few, many], [1, many / few], color=style.GREY, linewidth=0.8, label="ideal")
    ax.set(xticks=sorted({r["threads"] for r in measured}), xlabel="threads", ylabel=f"speed-up over {count(few)}")
    style.legend_beside(ax)
    return figure


def other_codes() -> str:
    rows = [[name, remark, f"{low:g}" if low == high else f"{low:g}–{high:g}"] for name, remark, low, high in RATES]
    return (pages.text_table(["Code", "What", "million updates/s per core"], rows, 2)
            + pages.small("Measured once by the makers of this code on a machine of the same kind: one core, double "
                          "precision, 2-D, about 41 neighbours unless it says otherwise. Each solves its own equations, some simpler."))


def numbers(measured: list[dict]) -> str:
    columns = {"Case": lambda r: r["title"], "D": lambda r: str(r["dimension"]), "Particles": lambda r: f"{r['particles']:,}",
               "Threads": lambda r: str(r["threads"]), "Neighbours": lambda r: f"{r['neighbours']:.1f}",
               "M updates/s per core": lambda r: f"{1e-6 * r['updates_per_second_per_core']:.3g}",
               "M pairs/s per core": lambda r: f"{1e-6 * r['pairs_per_second_per_core']:.4g}",
               "ns per pair": lambda r: f"{r['ns_per_pair']:.2f}", "Over scalar": lambda r: f"{r['speedup_over_scalar']:.2f}" if "speedup_over_scalar" in r else "",
               "Walls": lambda r: f"{100.0 * r['stages'].get('walls', 0.0):.1f} %",
               "Bytes/particle": lambda r: f"{r['bytes_per_particle']:.0f}", "List bytes": lambda r: f"{r['list_bytes_per_particle']:.0f}",
               "Load": lambda r: f"{r['load_average']:.1f}"}
    return pages.section("All numbers", pages.text_columns(measured, columns, 1, "wide"),
                         pages.small("Neighbours: within the kernel's support, a particle. Bytes: all memory in use but the "
                                     "lists; ghosts and walls make it large for small boxes. Everything is in bench.json beside this page."))


def page(measured: list[dict]) -> str:
    first = measured[0]
    load = max(r["load_average"] for r in measured)
    facts = [escape(str(first["processor"])), f"{first['simd_lanes']} lanes of double", f"version {escape(str(first['version']))}",
             f"load average up to {load:.1f}"]
    others = pages.figure(beside_others(measured), caption="Program C with wall correction, lists and integration included, beside the rates "
                          "in the table below. They are not measured in this run.")

    def section(title: str, drawn, caption: str) -> str:
        return pages.section(title, pages.figure(drawn, caption=caption))

    return pages.document("speed", [
        pages.head("Speed of the right-hand side", facts,
                   "A box of liquid iron between two walls, periodic sideways; for the schemes of gas a periodic box, a square of it four "
                   "times as dense. Every particle off its lattice place, stepped by the programs' own time loop (Euler). Medians. What "
                   "bounds the speed: docs/performance.md."),
        pages.section("Beside other codes", others, other_codes() if others else ""),
        section("Rate over size",
                over_particles(measured, lambda r: 1e-6 * r["updates_per_second_per_core"], "million updates a second and core"),
                "A flat line: time per particle does not grow when the arrays no longer fit into caches."),
        section("Time per pair", over_particles(measured, lambda r: r["ns_per_pair"], "core time per pair (ns)"),
                "All of a step's time, divided by the pairs within the kernel's support. Cases with two "
                "passes over the lists visit each pair twice; it counts once."),
        section("Where the time goes", stages(measured),
                "Shares of a step at the size nearest to 400² particles. Lists: their making, "
                f"spread over {first['steps_per_list']} steps. Integration: the integrator's own work on the state."),
        section("Against a scalar loop", scalar(measured),
                "The same two sums over the same list, in turn in the same run; medians of the "
                "ratios. Both agree to round-off, or bench would have failed."),
        section("Threads", threads(measured), "At the largest number of particles of each case; open marks: 3-D."),
        numbers(measured)])


def make(folder: Path) -> str:
    """Writes report.html; what is said of it."""
    return pages.write(folder, page(read(folder / "bench.json")))
