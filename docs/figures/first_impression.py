"""The pictures that README opens with.

    build/programs/rti inputs/rti_note.nml --set domain.particles_x=75 --set domain.particles_y=75 --set output.interval=250 \
      --output output/overturn
    build/programs/convection inputs/blankenbach_1a.nml --set domain.particles_x=48 --set domain.particles_y=48 --output output/b1a
    PYTHONPATH=programs/python python3 docs/figures/first_impression.py output/overturn output/b1a
"""

import pathlib
import sys

import tetsuame
from tetsuame import style
from tetsuame.plots import when

overturn, roll = (tetsuame.load(folder) for folder in sys.argv[1:])
figure, axes = style.plt.subplots(1, 5, figsize=(10.4, 2.4))
for ax, time in zip(axes, (750, 1500, 1750, 2250)):
    snapshot = overturn.snapshot(time)
    picture = snapshot.map("Material")
    ax.imshow(picture.values, origin="lower", cmap="copper", vmin=0, vmax=1, interpolation="bilinear")
    ax.set_title(when(snapshot))
picture = roll.snapshot().map("Temperature")
axes[4].imshow(picture.values, origin="lower", cmap="inferno", interpolation="bilinear")
axes[4].contour(picture.values, levels=[100 * k for k in range(1, 10)], colors="white", linewidths=0.6, alpha=0.8)
axes[4].set_title("Ra = 10⁴")
for ax in axes:
    ax.set(xticks=[], yticks=[])
    ax.grid(False)
    ax.spines[:].set_visible(False)
style.save(figure, pathlib.Path(__file__).with_suffix(".png"))
