#!/usr/bin/python3
"""Figures and tables of docs/scaling.md from docs/figures/scaling.json, which holds a study of ./run bench --scaling.

    ./run bench --scaling && docs/figures/scaling.py --measured output/scaling    # takes a new study over
    docs/figures/scaling.py                                                       # draws the present one again

The prediction runs build/programs/balance (./run build) where a machine holds the particles.
"""
import argparse
import csv
import json
import math
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "programs/python"))
from tetsuame.scaling import analysis, model, page  # noqa: E402  (the path is set first)

HERE = Path(__file__).resolve().parent
STUDY, PAGE, SPEED = HERE / "scaling.json", ROOT / "docs/scaling.md", ROOT / "docs/performance.md"
MODELLED = (1e6, 1e7)                         # particles held by `balance`
RANKS = [4 ** k for k in range(8)]
NOTES = 8.9e8                                 # particles of the report whose parallel fraction is 99.96 %


def in_space() -> float:
    """s a particle of program C in 3-D: what docs/performance.md has of a whole step."""
    found = re.search(r"^\| all \| \d+ \| (\d+) \|$", SPEED.read_text(encoding="utf-8"), re.MULTILINE)
    if not found:
        sys.exit(f"scaling.py: {SPEED} has no line of all stages")
    return 1e-9 * float(found[1])


def balance_points(program: Path, particles: float, costs: model.Costs, folder: Path) -> list[tuple[int, float]]:
    """Efficiency of the slowest rank; `balance` has no collectives: they are added as in the model."""
    found = []
    for ranks in RANKS:
        target = folder / f"{particles:.0f}_{ranks}"
        settings = {"distribution.kind": "uniform", "distribution.particles": int(particles), "distribution.length_x": 1,
                    "distribution.length_y": 1, "machine.ranks": ranks, "schedule.updates": 0, "compare.methods": "none",
                    "cost.fluid": costs.particle, "cost.halo": costs.halo, "cost.latency": costs.messages * costs.latency,
                    "cost.halo_width": model.WIDTH}
        command = [str(program), str(ROOT / "inputs/balance_bowl.nml"), "--output", str(target)]
        for key, value in settings.items():
            command += ["--set", f"{key}={value}"]
        subprocess.run(command, check=True, capture_output=True)
        with open(target / "history.csv", newline="", encoding="utf-8") as file:
            step = float(next(csv.DictReader(file))["slowest_step [s]"])
        step += costs.collectives * math.log2(ranks) * costs.collective
        held = json.loads((target / "summary.json").read_text())["fluid_particles"]
        found.append((ranks, held * costs.particle / (ranks * step)))
    return found


def markdown(header: list[str], rows: list[list[str]]) -> str:
    return "\n".join("| " + " | ".join(r) + " |" for r in [header, ["---"] * len(header), *rows])


def measured_table(rows: list[dict]) -> str:
    first = rows[0]
    lines = [[r["kind"], f"{r['ranks']} × {r['threads']}", f"{r['particles']:,}".replace(",", " "), f"{1e-6 * r['updates_per_second']:.2f}",
              f"{r['efficiency']:.3f}", analysis.ratio(analysis.of_the_machine(r, rows)), f"{r['efficiency_least']:.3f}–{r['efficiency_largest']:.3f}",
              f"{100 * r['waiting_fraction']:.1f} %", f"{r['bytes_sent_per_step'] / 1024:.0f}", f"{r['messages_per_step']:.1f}",
              f"{r['collectives_per_step']:.1f}"] for r in rows]
    fits = [f"Parallel fraction over {fit.over}: {fit.text}." for fit in analysis.amdahl(rows)]
    return "\n\n".join([
        f"{first['processor']}, {first['cores_here']} cores, {first['simd_lanes']} lanes; {first['steps']} steps, {first['repeats']} rounds; "
        f"load average at the start {first['load_average']:.1f}{'' if first['load_average'] < analysis.QUIET else ': **busy with other work, which these numbers show**'}"
        f"{'; OMP_WAIT_POLICY=' + first['wait_policy'] if first['wait_policy'] else ''}.",
        markdown(["kind", "ranks × threads", "particles", "million updates/s", "efficiency", "of the copies", "least–largest", "waiting",
                  "KiB sent a step", "messages", "collectives"], lines), *fits])


def costs_table(c: model.Costs) -> str:
    return markdown(["cost", "here"], [
        ["computing, a particle", f"{1e9 * c.particle:.0f} ns"],
        ["halo, a particle of it", f"{1e9 * c.halo:.1f} ns for {c.halo_bytes:.0f} bytes"],
        ["message", f"{1e6 * c.latency:.1f} µs, {c.messages:.1f} to each neighbour"],
        ["collective", f"{1e6 * c.collective:.2f} µs × log₂ P, {c.collectives:.1f} a step"]])


def predicted_table(rows: list[dict], c: model.Costs) -> str:
    solid = model.Costs(in_space(), c.halo * 11 / 9, c.latency, c.messages, c.collective, c.collectives, c.halo_bytes * 11 / 9)
    lines = []
    for name, costs, dimension in (("2-D", c, 2), ("3-D", solid, 3)):
        for ranks in (484, 4096, 16384):
            e = [model.efficiency(NOTES, ranks, costs, net, dimension) for net in (None, model.HDR)]
            p = [analysis.fraction_of([ranks], [ranks * one]) for one in e]
            lines.append([name, str(ranks), *(f"{one:.4f}" for one in e), *(f"{100 * one:.4f} %" for one in p)])
    table = markdown(["8.9e8 particles", "ranks", "efficiency, shared memory", "network", "p, shared memory", "network"], lines)
    one = next(r for r in rows if r["kind"] == "strong" and r["ranks"] == r["threads"] == 1)
    two = next((r for r in rows if r["kind"] == "strong" and r["ranks"] == 2 and r["threads"] == 1), None)
    check = ("" if two is None else f"For {one['particles']:,} particles on 2 ranks the model gives an efficiency of ".replace(",", " ")
             + f"{model.efficiency(one['particles'], 2, c):.3f}; measured: {two['efficiency']:.3f}.")
    return table + "\n\n" + check


def replace(text: str, name: str, content: str) -> str:
    mark = re.compile(rf"(<!-- {name} -->\n).*?(<!-- /{name} -->)", re.DOTALL)
    if not mark.search(text):
        sys.exit(f"scaling.py: {PAGE} has no place marked {name}")
    return mark.sub(lambda m: m[1] + content + "\n" + m[2], text)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n\n")[0])
    parser.add_argument("--measured", type=Path, help="folder of a study to take over; default: the one in docs/figures")
    parser.add_argument("--balance", default=ROOT / "build/programs/balance", type=Path, help="the program")
    given = parser.parse_args()
    try:
        if given.measured:
            rows, exchanges = analysis.read(given.measured)
            STUDY.write_text(json.dumps({"rows": rows, "exchanges": exchanges}, indent=1) + "\n", encoding="utf-8")
    except analysis.Unreadable as problem:
        sys.exit(f"scaling.py: {problem}")
    study = json.loads(STUDY.read_text(encoding="utf-8"))
    rows, costs = study["rows"], model.costs_of(study["rows"], study["exchanges"])
    if costs is None:
        sys.exit("scaling.py: the study needs 1 × 1 and several ranks with one thread")
    with tempfile.TemporaryDirectory() as scratch:
        beside = {n: balance_points(given.balance, n, costs, Path(scratch)) for n in MODELLED}
    for name, figure in (("scaling_measured", page.measured(rows)), ("scaling_prediction", page.prediction(costs, beside=beside))):
        figure.savefig(HERE / f"{name}.png", dpi=110)
    text = PAGE.read_text(encoding="utf-8")
    for name, content in (("measured", measured_table(rows)), ("costs", costs_table(costs)), ("predicted", predicted_table(rows, costs))):
        text = replace(text, name, content)
    PAGE.write_text(text, encoding="utf-8")
    for n, points in beside.items():
        print(f"{n:.0e} particles, efficiency by balance / analytic:",
              *(f"{p}: {e:.3f}/{model.efficiency(n, p, costs):.3f}" for p, e in points))


if __name__ == "__main__":
    main()
