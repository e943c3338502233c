#!/usr/bin/env python3
"""Planets cut through: the particles of a slab about the plane z = 0 of the centre of mass, coloured by material, at some times.

    planet inputs/giant_impact.nml --output DIR
    cuts_of_planets.py DIR FIGURE.png --hours 0 1 2 4 8 15 --half-width 40 --target 8700 \\
        --names 'rock of the target' 'iron of the target' 'rock of the impactor' 'iron of the impactor'

    planet inputs/planet_metal.nml --output DIR
    cuts_of_planets.py DIR FIGURE.png --hours 0 3.5 4.9 8.3 --half-width 4 --slab 0.4 --names ocean metal interior

    planet inputs/planet_layer_2d.nml --set time.t_end=9000 --output DIR
    cuts_of_planets.py DIR FIGURE.png --hours 0 1.0 1.7 2.5 --half-width 0.52 --names mantle metal interior

A cylinder is drawn whole. --names: of the materials by number; with --target, the number of the target's particles, then of the impactor's."""
import argparse
from pathlib import Path

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

COLOURS = {2: ["#c9a66b", "#444444", "#d9633b", "#7d1d1d"], 3: ["#c9a66b", "#444444", "#8fa9b8"]}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", type=Path)
    parser.add_argument("figure", type=Path)
    parser.add_argument("--hours", type=float, nargs="+", required=True)
    parser.add_argument("--names", nargs="+", required=True)
    parser.add_argument("--target", type=int)
    parser.add_argument("--half-width", type=float, default=10.0, help="of a panel, 1e6 m")
    parser.add_argument("--slab", type=float, default=3.0, help="half its thickness, 1e6 m")
    a = parser.parse_args()
    materials = len(a.names) // (1 if a.target is None else 2)
    times = {}
    for path in sorted(a.run.glob("snapshot_*.h5")):
        with h5py.File(path) as file:
            times[path] = float(np.ravel(file["Header"].attrs["Time"])[0])
    chosen = [min(times, key=lambda path: abs(times[path] - 3600 * hours)) for hours in a.hours]
    across = min(len(chosen), 3 if len(chosen) % 3 == 0 else 4)
    down = -(-len(chosen) // across)
    fig, panels = plt.subplots(down, across, figsize=(3.3 * across, 3.4 * down), sharex=True, sharey=True, squeeze=False)
    for panel, path in zip(panels.flat, chosen):
        with h5py.File(path) as file:
            part = file["PartType0"]
            x, m, ids, material = (part[name][:] for name in ("Coordinates", "Masses", "ParticleIDs", "Material"))
        x = (x - (m[:, None] * x).sum(0) / m.sum()) / 1e6
        near = np.abs(x[:, 2]) < a.slab if x.shape[1] == 3 else np.full(len(x), True)
        for number, name in enumerate(a.names):
            of_body = True if a.target is None else (ids >= a.target) == (number >= materials)
            those = near & of_body & (material == number % materials)
            panel.plot(x[those, 0], x[those, 1], ".", ms=3.5, color=COLOURS[materials][number], label=name)
        panel.set_title(f"{times[path] / 3600:.1f} h", fontsize=10)
        panel.set_aspect("equal")
        panel.set_xlim(-a.half_width, a.half_width)
        panel.set_ylim(-a.half_width, a.half_width)
    for panel in panels[-1]:
        panel.set_xlabel("x, 10⁶ m")
    for panel in panels[:, 0]:
        panel.set_ylabel("y, 10⁶ m")
    fig.tight_layout()
    fig.legend(*panels[0, 0].get_legend_handles_labels(), loc="upper center", bbox_to_anchor=(0.5, 0.0), ncol=4, markerscale=3, frameon=False)
    fig.savefig(a.figure, dpi=110, bbox_inches="tight")


if __name__ == "__main__":
    main()
