#!/usr/bin/python3
"""The state that Hosono's equations have without walls (program B), found twice: by program B with Newton's method and by
a solution row by row that shares no code with it.

    ./run build && docs/figures/rows.py

writes docs/figures/rows.png and prints the mean and the first rows' error. The case is inputs/hydrostatic_13_linear.nml at the
start, where the particles still stand on the lattice. There all particles of a row are equal, and the unknowns
are the densities of 20 rows:
    p^(rho_a) = sum_b (m/rho_b) p^(rho_b) w_(a-b),   w_n = sum over x of W at n rows' distance.
"""
import argparse
import os
import shutil
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "programs/python"))
from tetsuame import style  # noqa: E402  (the path is set first)

plt = style.plt
ROWS, P0, K_T, RHO0, H = 20, 1.0e10, 1.0e11, 7000.0, 1.2   # of the input; H in spacings


def quintic(q):
    """2-D quintic spline, q = r/h, of unit integral when lengths are in h."""
    return 7 / (478 * np.pi) * sum(c * np.maximum(a - q, 0) ** 5 for a, c in ((3, 1), (2, -6), (1, 15)))


def row_weights() -> np.ndarray:
    """w_n in units of 1/spacing^2, n = 0 … ROWS - 1."""
    x = np.arange(-8, 9)
    return np.array([quintic(np.hypot(x, n) / H).sum() / H ** 2 for n in range(ROWS)])


def solve_rows() -> np.ndarray:
    """Pressure by row, Newton's method with the full matrix; unknowns r = rho/rho0."""
    index = np.arange(ROWS)
    w = row_weights()[np.abs(index[:, None] - index)]
    r = np.ones(ROWS)
    for _ in range(100):
        p = P0 + K_T * (r - 1)
        residual = p - w @ (p / r)
        if np.abs(residual).max() < 1e-12 * K_T:
            return p
        slope = K_T / r - p / r ** 2
        r -= np.linalg.solve(K_T * np.eye(ROWS) - w * slope, residual)
    sys.exit("rows.py: Newton's method did not converge")


def program_rows(binary: Path, folder: Path) -> np.ndarray:
    """Pressure by row of program B, its first evaluation."""
    shutil.rmtree(folder, ignore_errors=True)
    command = [str(binary), str(ROOT / "inputs/hydrostatic_13_linear.nml"), "--output", str(folder),
               "--set", "hosono.solver=newton", "--set", "time.steps=1"]
    subprocess.run(command, check=True, capture_output=True, env=os.environ | {"OMP_NUM_THREADS": "1"})
    with h5py.File(sorted(folder.glob("snapshot_*.h5"))[-1]) as file:
        y, p = file["PartType0/Coordinates"][:, 1], file["PartType0/Pressure"][:]
    row = np.floor(y / y.max() * (ROWS - 0.5)).astype(int)
    return np.bincount(row, p) / np.bincount(row)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n\n")[0])
    parser.add_argument("--binaries", default=ROOT / "build/programs", type=Path, help="folder of the programs")
    parser.add_argument("--output", default=ROOT / "output/rows", type=Path, help="folder of the run")
    given = parser.parse_args()
    ours, theirs = solve_rows() / P0 - 1, program_rows(given.binaries / "disph_b", given.output) / P0 - 1
    print(f"mean |p/p0 - 1|: row by row {np.abs(ours).mean():.6f}, program B {np.abs(theirs).mean():.6f}; "
          f"largest difference {np.abs(ours - theirs).max():.1e}")
    print("rows from the wall:", " ".join(f"{value:+.4f}" for value in ours[:10]))
    print("sum of the kernel in them:", " ".join(f"{row_weights()[:n + 1].sum() + row_weights()[1:].sum():.4f}" for n in range(4)))

    distance = np.arange(ROWS) + 0.5
    figure, (ax,) = style.panels(1, 1, 3.0)
    length = np.sqrt((K_T / P0 - 1) * 0.695 / 2)
    ax.plot(distance, ours, color=style.GREY, linewidth=4, alpha=0.4, label="row by row, written independently")
    ax.plot(distance, theirs, linestyle="", marker="D", markersize=4.5, color=style.COLOUR["B"], label="program B, Newton")
    near = distance[:10]
    ax.plot(near, ours[0] * np.exp(-(near - 0.5) / length), color=style.INK, linewidth=1, linestyle="--",
            label=f"first row × exp(−distance/ℓ), ℓ = {length:.2f} Δx")
    ax.axhline(0, color=style.INK, linewidth=0.8)
    ax.set_xlabel("distance from the lower wall (spacings)")
    ax.set_ylabel("p/p₀ − 1")
    ax.legend(fontsize=8.5)
    figure.set_size_inches(7.4, 3.0)
    figure.savefig(Path(__file__).with_suffix(".png"), dpi=110)
    plt.close(figure)


if __name__ == "__main__":
    main()
