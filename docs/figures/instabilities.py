#!/usr/bin/env python3
"""Waves on a contact by several schemes: their amplitude over time beside linear theory, and the two materials at some times.

    shock inputs/kelvin_helmholtz_earth.nml --set shock.scheme=disph --output DISPH
    instabilities.py FIGURE.png DISPH SSPH REMIX --labels disph ssph remix --at 0.5 1 2

--at: times of the maps, in 2π over the theory's growth rate. A run in three dimensions is shown by a slab in the middle.
"""
import argparse
import csv
import json
import math
from pathlib import Path

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt


def amplitude(run: Path) -> tuple[np.ndarray, np.ndarray]:
    with (run / "history.csv").open() as file:
        header, *rows = csv.reader(file)
    names = [name.split(" ")[0] for name in header]
    t, a = (np.array([float(row[names.index(name)]) for row in rows]) for name in ("time", "wave_amplitude"))
    return t, a / a[0]


def snapshots(run: Path) -> dict[float, Path]:
    found = {}
    for path in sorted(run.glob("snapshot_*.h5")):
        with h5py.File(path) as file:
            found[float(np.ravel(file["Header"].attrs["Time"])[0])] = path
    return found


def show(ax, path: Path, metal: int) -> None:
    with h5py.File(path) as file:
        x, material = file["PartType0/Coordinates"][:], file["PartType0/Material"][:]
    if x.shape[1] == 3 and np.ptp(x[:, 2]) > 0.0:
        slab = abs(x[:, 2] - 0.5 * np.ptp(x[:, 2]) - x[:, 2].min()) < 0.15 * np.ptp(x[:, 2])
        x, material = x[slab], material[slab]
    box = x.max(axis=0) + x.min(axis=0)
    size = 4000.0 / math.sqrt(len(x)) / 12.0
    for number, colour in ((1 - metal, "#c9a66b"), (metal, "#444444")):
        part = material == number
        ax.scatter(x[part, 0] / 1e3, x[part, 1] / 1e3, s=size**2 / 12.0, c=colour, linewidths=0)
    ax.set(aspect="equal", xlim=(0, box[0] / 1e3), ylim=(0, box[1] / 1e3), xticks=[], yticks=[])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("figure", type=Path)
    parser.add_argument("runs", type=Path, nargs="+")
    parser.add_argument("--labels", nargs="+", required=True)
    parser.add_argument("--at", type=float, nargs="+", default=[0.5, 1.0, 2.0])
    a = parser.parse_args()
    known = json.loads((a.runs[0] / "summary.json").read_text())["metrics"]
    rate = known["growth_rate_theory"]
    rows = len(a.at)
    fig = plt.figure(figsize=(2.3 * len(a.runs), 2.6 + 2.5 * rows), constrained_layout=True)
    grid = fig.add_gridspec(1 + rows, len(a.runs))
    ax = fig.add_subplot(grid[0, :])
    longest = 0.0
    for run, label in zip(a.runs, a.labels):
        t, size = amplitude(run)
        ax.semilogy(t * rate / (2 * math.pi), size, label=label, lw=1.2)
        longest = max(longest, t[-1])
    t = np.linspace(0.0, min(longest, 5.0 / rate), 200)
    ax.semilogy(t * rate / (2 * math.pi), np.cosh(rate * t) if known["test"] == "kelvin_helmholtz" else np.exp(rate * t), "k--", lw=0.8, label="linear theory")
    ax.set(xlabel="time, of 2π over the growth rate", ylabel="amplitude, of its first", ylim=(0.1, None))
    ax.legend(frameon=False, fontsize=8, ncols=3)
    for column, (run, label) in enumerate(zip(a.runs, a.labels)):
        at = snapshots(run)
        for row, wanted in enumerate(a.at):
            time = min(at, key=lambda known_time: abs(known_time - wanted * 2 * math.pi / rate))
            one = fig.add_subplot(grid[1 + row, column])
            show(one, at[time], 1)
            one.set_title(f"{label}: {time * rate / (2 * math.pi):.2g}", fontsize=8)
    fig.savefig(a.figure, dpi=90)


if __name__ == "__main__":
    main()
