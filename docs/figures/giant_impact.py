#!/usr/bin/env python3
"""An impact of two planets at six times: iron and rock of either body, in a slab about the plane of the orbit.

    planet inputs/giant_impact.nml --output DIR
    giant_impact.py DIR FIGURE.png
"""
import sys
from pathlib import Path

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

KINDS = [("rock of the target", "#c9a66b"), ("iron of the target", "#444444"), ("rock of the impactor", "#d9633b"),
         ("iron of the impactor", "#7d1d1d")]


def main(run: str, figure: str) -> None:
    snapshots = sorted(Path(run).glob("snapshot_*.h5"))
    times = {}
    for path in snapshots:
        with h5py.File(path) as file:
            times[path] = float(np.ravel(file["Header"].attrs["Time"])[0])
    wanted = [0.0, 3600.0, 7200.0, 14400.0, 28800.0, max(times.values())]
    chosen = [min(times, key=lambda path: abs(times[path] - time)) for time in wanted]
    with h5py.File(chosen[0]) as file:
        x, ids = file["PartType0/Coordinates"][:], file["PartType0/ParticleIDs"][:]
        # The two bodies are apart at the start, and the target's particles are the first ones.
        along = x[np.argsort(ids)]
        steps = np.linalg.norm(np.diff(along, axis=0), axis=1)
        of_target = int(np.argmax(steps[len(steps) // 2:])) + len(steps) // 2 + 1
        centre = x.mean(0)
    fig, panels = plt.subplots(2, 3, figsize=(10, 6.8), sharex=True, sharey=True, layout="constrained")
    for panel, path in zip(panels.flat, chosen):
        with h5py.File(path) as file:
            part = file["PartType0"]
            x, ids, material = (part["Coordinates"][:] - centre) / 1e6, part["ParticleIDs"][:], part["Material"][:]
        near = np.abs(x[:, 2]) < 3.0
        for number, (name, colour) in enumerate(KINDS):
            those = near & ((ids >= of_target) == (number >= 2)) & (material == number % 2)
            panel.plot(x[those, 0], x[those, 1], ".", ms=3.5, color=colour, label=name)
        panel.set_title(f"{times[path] / 3600:.1f} h", fontsize=10)
        panel.set_aspect("equal")
        panel.set_xlim(-40, 40)
        panel.set_ylim(-40, 40)
    for panel in panels[1]:
        panel.set_xlabel("x, 10⁶ m")
    for panel in panels[:, 0]:
        panel.set_ylabel("y, 10⁶ m")
    fig.legend(*panels[0, 0].get_legend_handles_labels(), loc="lower center", bbox_to_anchor=(0.5, -0.06), ncol=4, markerscale=3, frameon=False)
    fig.savefig(figure, dpi=110, bbox_inches="tight")


if __name__ == "__main__":
    main(*sys.argv[1:])
