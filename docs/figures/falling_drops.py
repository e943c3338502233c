"""Drops of iron in magma with surface tension: outlines from the snapshots of two runs (docs/studies/2026-11-21_drops_and_surface_tension.md).

    python3 docs/figures/falling_drops.py RUN_SMALL RUN_LARGE     # output directories, radii 5 and 10 mm
"""

import pathlib
import sys

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

figure, axes = plt.subplots(1, 2, figsize=(5.2, 6.2), sharey=True)
for panel, folder, radius in zip(axes, sys.argv[1:], (0.005, 0.010)):
    for k, name in enumerate(sorted(pathlib.Path(folder).glob("snapshot_*.h5"))[::3]):
        with h5py.File(name) as file:
            fluid = file["PartType0"]
            metal = np.array(fluid["Material"]) > 0.5
            x = np.array(fluid["Coordinates"])[metal, :2] / radius
        panel.plot(x[:, 0], x[:, 1], ".", markersize=1.6, color=plt.cm.viridis(k / 6))
    panel.set(aspect="equal", xlim=(0, 8), ylim=(0, 20), xlabel="x/R", title=f"R = {1e3 * radius:g} mm")
axes[0].set_ylabel("y/R")
figure.tight_layout()
figure.savefig(pathlib.Path(__file__).with_suffix(".png"), dpi=110)
