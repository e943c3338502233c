#!/usr/bin/python3
"""Stands in for disph_a … disph_f: writes what they write, made up but of the right shape and size.

The name it is called by says which program it plays. FAKE_FAULT in the environment,
'NAME:KIND', or several of these behind each other, makes that program misbehave: exit4, abort, no_summary, bad_json, contradiction.
FAKE_PLACE, 'STEP,ITERATION', is where A diverges, else in step 2, iteration 2.
"""
import json
import os
import re
import signal
import sys
from pathlib import Path

import h5py
import numpy as np

ROWS, SPACING = 20, 5e3
GROWTH = {"11": 9e5, "12": 12.0, "13": 12.0, "13_linear": 9.0, "column": 1e6}


def main() -> int:
    letter = Path(sys.argv[0]).name[-1].upper()
    source, folder = Path(sys.argv[1]), Path(sys.argv[sys.argv.index("--output") + 1])
    settings = dict(sys.argv[i + 1].split("=", 1) for i, word in enumerate(sys.argv) if word == "--set")
    file = source.stem.removeprefix("hydrostatic_")
    if folder.exists():
        print(f"output directory {folder} is not empty", file=sys.stderr)
        return 2
    folder.mkdir(parents=True)
    # One mark for each time it ran, so that a test can count.
    with open(folder.parent / f"calls_{folder.name}", "a") as calls:
        calls.write("x")
    fault = dict(word.split(":") for word in os.environ.get("FAKE_FAULT", "").split()).get(Path(sys.argv[0]).name, "")
    if fault == "exit4":
        print("disk full", file=sys.stderr)
        return 4
    if fault == "abort":
        os.kill(os.getpid(), signal.SIGABRT)
    if fault == "no_summary":
        return 0
    if fault == "bad_json":
        (folder / "summary.json").write_text("{")
        return 3

    solver = settings.get("hosono.solver", "plain")
    normalised = settings.get("smoothing.normalise", ".false.") == ".true."
    stopped = letter in "AB" and (solver == "plain" or (file == "11" and not normalised))
    text = re.sub(r"!.*", "", source.read_text())
    for setting, value in settings.items():
        text = re.sub(rf"(?m)^(\s*{setting.partition('.')[2]}\s*=\s*)\S+", rf"\g<1>{value}", text)
    (folder / "resolved.nml").write_text(text)
    if letter in "AB" and (normalised or solver == "plain" or not stopped):
        write_residuals(folder, letter, file, solver, stopped)
    summary = summarise(letter, file, solver, stopped)
    if fault == "contradiction":
        summary["status"] = "diverged"
    if not stopped:
        write_snapshot(folder / "snapshot_0010.h5", letter, file == "column", summary["errors"])
    (folder / "summary.json").write_text(json.dumps(summary))
    return 3 if stopped else 0


def summarise(letter: str, file: str, solver: str, stopped: bool) -> dict:
    pressure = {"A": 4.7e-4, "B": 4.2e-3, "C": 5.6e-5, "D": 4.9e-2, "E": 5.6e-5, "F": 0.0}[letter]
    if file == "column":
        pressure = {"C": 4.4e-5, "D": 6e-2, "E": 4.9e-5, "F": 2.3e-5}.get(letter, pressure)
    moved = {"A": 1.1e-5, "B": 2.1e-2, "C": 1.3e-6, "D": 2.8e-2, "E": 1.3e-6, "F": 1e-13}[letter]
    step, iteration = map(int, os.environ.get("FAKE_PLACE", "2,2").split(",")) if letter == "A" else (1, 2)
    if stopped and solver != "plain":  # as these: seen before the first pass
        step, iteration = 1, 0
    message = "" if not stopped else "step 1: no state with p > 0 exists" if iteration == 0 else \
        f"step {step}, iteration {iteration}: pressure of particle 7 is not positive; try hosono.solver = 'newton'"
    walls = 0.2 if letter in "ACEF" else 0.0
    stages = {"lists": 0.12, "pressure": 0.5 if letter in "AB" else 0.16, "gradient": 0.49, "volume": 0.06, "rates": 0.04,
              "integration": 0.04, "halo": 0.1, "output": 0.05} | ({"walls": walls} if walls else {})
    return {
        "program": f"disph_{letter.lower()}", "status": "diverged" if stopped else "completed", "message": message,
        "steps": step - 1 if stopped else 1000, "time": 1.0, "dimension": 2, "fluid_particles": 400,
        "wall_particles": 160, "ranks": 1, "threads": 1, "wall_seconds": sum(stages.values()) * 1.04,
        "stepping_seconds": sum(stages.values()),
        "rhs_evaluations": 1000, "particle_updates_per_second": 4e5,
        "diverged_step": step if stopped else None, "diverged_iteration": iteration if stopped else None,
        "errors": {"pressure_mean": pressure, "pressure_max": 5 * pressure, "density_max": moved / 2.5,
                   "displacement_max_over_dx": moved},
        "conservation": {"mass": 0.0, "momentum": 1.2e-15, "energy": 3e-13},
        "metrics": {"hosono_kappa": GROWTH[file] + 1, "hosono_growth_predicted": GROWTH[file]} if letter in "AB" else {},
        "stages": stages, "state_hash": "0123456789abcdef", "version": "0000000",
    }


def write_residuals(folder: Path, letter: str, file: str, solver: str, stopped: bool) -> None:
    lines = ["step [1],evaluation [1],iteration [1],residual [1]"]
    if solver == "plain":
        start = 1e-7 if letter == "A" else 0.27
        values = [start * GROWTH[file] ** n for n in range(40) if start * GROWTH[file] ** (n - 1) < 1]
    else:
        rate = {"newton": 1e-3, "anderson": 0.2}[solver]
        values = [0.1 * rate ** n for n in range(40) if 0.1 * rate ** (n - 1) > 1e-10]
    if stopped:
        values.append(float("inf"))
    lines += [f"1,1,{n + 1},{value:.6e}" for n, value in enumerate(values)]
    (folder / "residuals.csv").write_text("\n".join(lines) + "\n")


def write_snapshot(path: Path, letter: str, column: bool, errors: dict) -> None:
    axis = (np.arange(ROWS) + 0.5) * SPACING
    x, y = (a.ravel() for a in np.meshgrid(axis, axis))
    rest = np.column_stack([x, y, np.zeros_like(x)])
    # The error sits in the rows next to the walls where there is no correction.
    near = np.exp(-np.minimum(y, ROWS * SPACING - y) / SPACING) if letter in "BD" else np.ones_like(y)
    reference = 1e11 * np.expm1(3e-7 * (ROWS * SPACING - y)) + 1e5 if column else np.full_like(y, 1e10)
    relative = errors["pressure_mean"] * near / near.mean()
    towards_wall = np.sign(y - ROWS * SPACING / 2)
    moved = np.zeros_like(rest)
    moved[:, 1] = errors["displacement_max_over_dx"] * SPACING * towards_wall * near / near.max()
    outside = (np.arange(-4, ROWS + 4) + 0.5) * SPACING
    wx, wy = (a.ravel() for a in np.meshgrid(axis if not column else outside, outside))
    wall = (wy < 0) | (wy > ROWS * SPACING) | (wx < 0) | (wx > ROWS * SPACING)
    with h5py.File(path, "w") as file:
        file.create_group("Header").attrs.update(Time=1.0, Step=1000, Dimension=2, BoxLengths=[ROWS * SPACING] * 3, Periodic=[0, 0, 0])
        fluid = file.create_group("PartType0")
        for name, values in (("Coordinates", rest + moved), ("Pressure", reference * (1 - relative)),
                             ("PressureReference", reference), ("Displacement", moved),
                             ("ParticleIDs", np.arange(len(y)))):
            fluid[name] = values
        file["PartType1/Coordinates"] = np.column_stack([wx, wy, np.zeros_like(wx)])[wall]


if __name__ == "__main__":
    sys.exit(main())
