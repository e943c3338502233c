"""Figure of the worked starts: python3 docs/figures/own_starts.py STAR LAYERS FIGURE.png, of two runs of rti (docs/own_start.md)

The maps are those of `tetsuame plot`, put side by side.
"""
import pathlib
import subprocess
import sys
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

ROOT = pathlib.Path(__file__).resolve().parents[2]
star, layers, figure = sys.argv[1:4]
wanted = [(star, "Density", 0), (star, "Density", 500), (star, "Density", 1000),
          (layers, "Temperature", 0), (layers, "Temperature", 2000), (layers, "Density", 2000)]
fig, axes = plt.subplots(2, 3, figsize=(12, 7.2))
with tempfile.TemporaryDirectory() as folder:
    for axis, (run, field, time) in zip(axes.flat, wanted):
        subprocess.run([sys.executable, "-m", "tetsuame", "plot", run, "--fields", field, "--time", str(time), "--output", folder], check=True,
                       env={"PYTHONPATH": str(ROOT / "programs/python"), "PATH": "/usr/bin"}, stdout=subprocess.DEVNULL)
        axis.imshow(plt.imread(f"{folder}/map.png"))
        axis.axis("off")
fig.tight_layout(pad=0.3)
fig.savefig(figure, dpi=80)
