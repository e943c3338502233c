#!/usr/bin/env python3
"""Particles of a settled planet over its profile: density and pressure by radius.

    planet inputs/planet_earth.nml --profile earth.json
    planet inputs/planet_earth.nml --output DIR
    planet_profile.py earth.json DIR FIGURE.png
"""
import json
import sys
from pathlib import Path

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt


def main(profile: str, run: str, figure: str) -> None:
    p = json.loads(Path(profile).read_text())
    with h5py.File(sorted(Path(run).glob("snapshot_*.h5"))[-1]) as file:
        part = file["PartType0"]
        x, m, rho, pressure, material = (part[name][:] for name in ("Coordinates", "Masses", "Density", "Pressure", "Material"))
    r = np.linalg.norm(x - (x * m[:, None]).sum(0) / m.sum(), axis=1) / 1e6
    fig, axes = plt.subplots(1, 2, figsize=(9, 3.6), constrained_layout=True)
    for ax, values, line, unit, label in ((axes[0], rho / 1e3, np.array(p["density"]) / 1e3, "10³ kg/m³", "density"),
                                          (axes[1], pressure / 1e9, np.array(p["pressure"]) / 1e9, "GPa", "pressure")):
        for number, name, colour in ((1, "core", "tab:red"), (0, "mantle", "tab:green")):
            ax.plot(r[material == number], values[material == number], ".", ms=2, color=colour, label=f"{name}, particles")
        ax.plot(np.array(p["r"]) / 1e6, line, "k-", lw=0.8, label="profile")
        ax.set(xlabel="radius [10⁶ m]", ylabel=f"{label} [{unit}]", xlim=(0, None), ylim=(0, None))
    axes[0].legend(markerscale=4, frameon=False)
    fig.savefig(figure, dpi=110)


if __name__ == "__main__":
    main(*sys.argv[1:])
