#!/usr/bin/python3
"""Holds the tables of docs/results.md against the programs: runs what each row names and compares at the digits shown.

    docs/check_results.py            prints every figure that differs; exit status 1 if there is one
    docs/check_results.py --write    puts the measured figures into the page, at as many digits as stand there
    docs/check_results.py --short    without the four runs that take as long as the others together

A row's columns `input`, `program` and `settings` say what is run; where the table lacks the column `input`, a line
`<!-- input: NAME -->` above it does. The other columns are measured (MEASURED below). A figure behind ≈ is of rounding: it may
differ by a factor of three. A table whose first column is none of the three is left alone.
"""
import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parents[1]
NAMED = ("input", "program", "settings")
COMPLETED, CALCULATION_FAILED = 0, 3
LONG = {("column", "A", "`hosono.solver=newton`"), ("column", "B", "`hosono.solver=newton`"), ("13", "B", "`hosono.solver=anderson`"),
        ("13_linear", "B", "`hosono.solver=anderson`")}
FIGURE = re.compile(r"-?[\d.]+(e-?\d+)?")


@dataclass
class Row:
    """A line of the page: where it stands, what is run, and the texts of its cells by column."""
    line: int
    command: tuple[str, ...]  # input, program, settings
    cells: dict[str, str]


@dataclass
class Run:
    summary: dict
    p: np.ndarray | None  # Pa, at the end, in the order of the particles' IDs; None if it did not complete
    x: np.ndarray | None  # m
    dx: float             # m, the spacing at the start


def error(name):
    return lambda run, _: run.summary["errors"][name]


def metric(name):
    return lambda run, _: run.summary["metrics"][name]


# What a column shows, from the row's run and the run of the table's first row.
MEASURED = {
    "p error, mean": error("pressure_mean"),
    "p error, max": error("pressure_max"),
    "ρ error, max": error("density_max"),
    "moved/Δx": error("displacement_max_over_dx"),
    "passes": metric("hosono_passes"),
    "ends": lambda run, _: run.summary["status"],
    "in step": lambda run, _: run.summary["diverged_step"],
    "after passes": lambda run, _: run.summary["diverged_iteration"],
    "steps": lambda run, _: run.summary["steps"],
    "evaluations": lambda run, _: run.summary["rhs_evaluations"],
    "p from the first row's, relative": lambda run, first: float(np.abs(run.p / first.p - 1).max()),
    "x from the first row's, over Δx": lambda run, first: float(np.abs(run.x - first.x).max() / run.dx),
}


def tables(page: list[str]) -> list[list[Row]]:
    """The rows of every table that names runs."""
    found: list[list[Row]] = []
    names, given = None, ""
    for number, line in enumerate(page):
        if comment := re.fullmatch(r"<!-- input: (\w+) -->", line):
            given = comment[1]
        if not line.startswith("|"):
            names = None
            continue
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if names is None:
            names = cells
            if names[0] in NAMED:
                found.append([])
        elif names[0] in NAMED and not set(line) <= set("|- "):
            row = dict(zip(names, cells, strict=True))
            command = row.get("input", given), row["program"], row.get("settings", "")
            found[-1].append(Row(number, command, {n: c for n, c in row.items() if n not in NAMED}))
    return found


def perform(command: tuple[str, ...], programs: Path, folder: Path) -> Run:
    name, letter, settings = command
    words = [str(programs / f"disph_{letter.lower()}"), str(ROOT / "inputs" / f"hydrostatic_{name}.nml"), "--output", str(folder)]
    for setting in re.findall(r"`([^`]+)`", settings):
        words += ["--set", setting]
    done = subprocess.run(words, env=os.environ | {"OMP_NUM_THREADS": "1"}, stdin=subprocess.DEVNULL,
                          capture_output=True, text=True)
    if done.returncode not in (COMPLETED, CALCULATION_FAILED):
        raise SystemExit(f"{' '.join(words)}: exit status {done.returncode}\n{done.stderr}")
    p = x = None
    if done.returncode == COMPLETED:
        with h5py.File(sorted(folder.glob("snapshot_*.h5"))[-1]) as file:
            fluid = file["PartType0"]
            order = np.argsort(fluid["ParticleIDs"][:])
            p, x = fluid["Pressure"][:][order], fluid["Coordinates"][:][order]
    return Run(json.loads((folder / "summary.json").read_text()), p, x, spacing(folder))


def spacing(folder: Path) -> float:
    text = (folder / "resolved.nml").read_text()
    length, particles = (float(re.search(rf"^\s*{key}\s*=\s*(\S+)", text, re.MULTILINE)[1].rstrip(",")) for key in
                         ("length_y", "particles_y"))
    return length / particles


def shown(value: float, like: str) -> str:
    """`value` with as many digits as the figure `like`."""
    if value == 0:
        return "0"
    digits = len(Decimal(like).as_tuple().digits)
    rounded = Decimal(f"{value:.{digits - 1}e}")
    if "e" in like or not 0.01 <= abs(rounded) < 10 ** digits:
        mantissa, _, exponent = f"{rounded:.{digits - 1}e}".partition("e")
        return f"{mantissa}e{int(exponent)}"
    return f"{rounded:f}"


def agree(cell: str, value) -> bool:
    """Is `value` what the cell says, to the digits shown?"""
    if value is None or isinstance(value, str):
        return cell == (value or "")
    text = cell.removeprefix("≈ ")
    if not FIGURE.fullmatch(text):
        return False
    number = Decimal(text)
    if number == 0 or isinstance(value, int) and "e" not in text:
        return number == value
    if cell != text:
        return number / 3 <= value <= 3 * number
    # A little more than half the last digit: the last bits of a value differ between kinds of processors.
    return abs(Decimal(value) - number) <= Decimal("0.51") * Decimal(10) ** number.as_tuple().exponent


def rewritten(cell: str, value) -> str:
    if value is None or isinstance(value, str):
        return value or ""
    text = cell.removeprefix("≈ ")
    if isinstance(value, int) and "e" not in text:
        return str(value)
    return cell[:len(cell) - len(text)] + shown(value, text if FIGURE.fullmatch(text) else "1.00")


def compare(page: list[str], programs: Path, write: bool, short: bool = False) -> list[str]:
    """Every figure that differs; with `write` the page's lines change to what was measured; without the LONG runs where it is to be `short`."""
    found = tables(page)
    if short:
        if missing := LONG - {row.command for rows in found for row in rows}:
            raise SystemExit(f"the page has no row for {missing}, which --short leaves out")
        found = [[row for row in rows if row.command not in LONG] for rows in found]
    commands = list(dict.fromkeys(row.command for rows in found for row in rows))
    with tempfile.TemporaryDirectory(prefix="tetsuame_results_") as scratch, ThreadPoolExecutor(os.cpu_count()) as pool:
        folders = [Path(scratch) / str(n) for n in range(len(commands))]
        runs = dict(zip(commands, pool.map(perform, commands, [programs] * len(commands), folders)))
    differ = []
    for rows in found:
        for row in rows:
            measured = {name: MEASURED[name](runs[row.command], runs[rows[0].command])
                        for name in row.cells if not (row is rows[0] and "first row" in name)}
            wrong = {name: value for name, value in measured.items() if not agree(row.cells[name], value)}
            differ += [f"line {row.line + 1}, {' '.join(row.command).strip()}: {name} is {value}, the page says "
                       f"{row.cells[name] or 'nothing'}" for name, value in wrong.items()]
            if write and wrong:
                cells = [cell.strip() for cell in page[row.line].strip().strip("|").split("|")]
                first = len(cells) - len(row.cells)
                cells[first:] = [rewritten(cell, measured[name]) if name in wrong else cell
                                 for name, cell in row.cells.items()]
                page[row.line] = "| " + " | ".join(cells) + " |"
    print(f"{len(commands)} runs, {len(differ)} figures that differ", file=sys.stderr)
    return differ


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", type=Path, default=ROOT / "build" / "programs", help="where the programs are")
    parser.add_argument("--page", type=Path, default=ROOT / "docs" / "results.md")
    parser.add_argument("--write", action="store_true", help="change the page instead of complaining")
    parser.add_argument("--short", action="store_true", help="without the four runs that take longest")
    options = parser.parse_args()
    page = options.page.read_text().splitlines()
    differ = compare(page, options.programs.resolve(), options.write, options.short)
    print(*differ, sep="\n", end="\n" if differ else "")
    if options.write:
        options.page.write_text("\n".join(page) + "\n")
        return 0
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
