#!/usr/bin/python3
"""The square of equal masses at t = 4, 32 x 32, by scheme and by the terms of varying supports.

    ./run build && docs/figures/square.py

writes docs/figures/square.png. Runs: output/square (half a minute), kept for the next call.
"""
import json
import os
import subprocess
import sys
from pathlib import Path

import h5py

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "programs/python"))
from tetsuame import style  # noqa: E402  (the path is set first)

plt = style.plt
CASES = [("ssph", "number", "SSPH"), ("disph", "weight", "DISPH, f of [S4]"), ("disph", "number", "DISPH"),
         ("gdisph", "weight", "GDISPH, f of [S4]"), ("gdisph", "number", "GDISPH")]


def run(scheme, terms):
    """The folder of the finished run."""
    folder = ROOT / "output" / "square" / f"{scheme}_{terms}"
    if not (folder / "summary.json").exists():
        settings = ["domain.particles_x=32", "shock.masses=equal_mass", "time.t_end=4", f"shock.scheme={scheme}",
                    f"shock.support_terms={terms}"]
        folder.parent.mkdir(parents=True, exist_ok=True)
        program = os.environ.get("TETSUAME_SHOCK", ROOT / "build" / "programs" / "shock")
        subprocess.run([program, ROOT / "inputs" / "square.nml", *sum((["--set", s] for s in settings), []),
                        "--output", folder, "--force"], check=True)
    return folder


figure, axes = plt.subplots(1, len(CASES), figsize=(11.0, 2.6), sharey=True)
for axis, (scheme, terms, title) in zip(axes, CASES, strict=True):
    folder = run(scheme, terms)
    with h5py.File(sorted(folder.glob("snapshot_*.h5"))[-1]) as file:
        gas = file["PartType0"]
        x, rho = gas["Coordinates"][:], gas["Density"][:]
    points = axis.scatter(x[:, 0], x[:, 1], c=rho, s=1.2, marker=".", linewidths=0.4, vmin=0.8, vmax=4.2, rasterized=True)
    change = json.loads((folder / "summary.json").read_text())["metrics"]["square_area_change"]
    axis.set(title=f"{title}\narea {100 * change:+.1f} %", aspect="equal", xlim=(0, 1), ylim=(0, 1), xticks=[], yticks=[])
    axis.title.set_fontsize(8)
figure.colorbar(points, ax=axes, label="density (kg/m$^3$)")
figure.savefig(ROOT / "docs" / "figures" / "square.png", dpi=85, bbox_inches="tight")
