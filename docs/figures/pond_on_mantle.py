"""Figure of the pond on a mantle: python3 docs/figures/pond_on_mantle.py output/rti/pond_on_mantle FIGURE.png"""

import pathlib
import sys

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

run, figure = pathlib.Path(sys.argv[1]), sys.argv[2]
chosen = sorted(run.glob("snapshot_*.h5"))[::2]
fig, axes = plt.subplots(2, len(chosen), figsize=(2.6 * len(chosen), 5.4), sharex=True, sharey=True, squeeze=False)
for column, name in zip(axes.T, chosen):
    with h5py.File(name) as file:
        fluid, t = file["PartType0"], file["Header"].attrs["Time"]
        x, metal, melt = fluid["Coordinates"][:] / 1e3, fluid["Material"][:] > 0, fluid["MeltFraction"][:]
        T, size = fluid["Temperature"][:], 2e4 / len(x)
    column[0].scatter(*x[~metal, :2].T, c=melt[~metal], s=size, cmap="YlOrRd", vmin=0, vmax=1, lw=0)
    column[0].scatter(*x[metal, :2].T, c="0.2", s=size, lw=0)
    last = column[1].scatter(*x[:, :2].T, c=T, s=size, cmap="inferno", vmin=2000, vmax=4000, lw=0)
    column[0].set_title(f"{np.round(t)/1e3:.1f} ks", fontsize=9)
    for axis in column:
        axis.set_aspect("equal")
        axis.tick_params(labelsize=7)
axes[0, 0].set_ylabel("metal dark; melt fraction 0 pale, 1 red\ny, km", fontsize=7)
axes[1, 0].set_ylabel("temperature 2000 to 4000 K\ny, km", fontsize=7)
fig.tight_layout()
fig.savefig(figure, dpi=90)
