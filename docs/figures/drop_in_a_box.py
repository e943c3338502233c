#!/usr/bin/env python3
"""Creeping velocity of a drop of another viscosity in a cube with free-slip walls, by Fourier series: an independent reference for `drop`.

Stokes' equations with a viscosity that varies, ∇·(2 η e) - ∇p + f = 0, solved on N³ cells, mirrored to a period of two edges, as a fixed point about a
uniform viscosity [H. Moulinec, P. Suquet, Comput. Methods Appl. Mech. Eng. 157, 69 (1998)]. Cells that the surface cuts take the harmonic or the
arithmetic mean of both viscosities: both errors are of first order in the cell, of opposite sign, and vanish together. Printed: V η/(Δρ g a²).

    drop_in_a_box.py RADIUS HEIGHT RATIO N …     (lengths over the edge, viscosity of the drop over the other's)
"""
import sys
from itertools import combinations_with_replacement

import numpy as np


def share_of_the_drop(n: int, radius: float, height: float, parts: int = 6) -> np.ndarray:
    """Volume fraction of the drop in each cell of the mirrored box, from parts³ points a cell."""
    inside = np.zeros((2 * n,) * 3)
    folded = [np.minimum(x, 2 - x) for x in ((np.arange(2 * n) + (k + 0.5) / parts) / n for k in range(parts))]
    for x in folded:
        for y in folded:
            for z in folded:
                inside += ((x - 0.5)[:, None, None]**2 + (y - height)[None, :, None]**2 + (z - 0.5)[None, None, :]**2) < radius**2
    return inside / parts**3


def velocity(n: int, radius: float, height: float, ratio: float, mean: str, tolerance: float = 1e-5) -> float:
    drop = share_of_the_drop(n, radius, height)
    eta = 1.0 / (drop / ratio + 1.0 - drop) if mean == "harmonic" else drop * ratio + 1.0 - drop
    uniform = 0.5 * (eta.max() + eta.min())
    along = 2 * np.pi * np.fft.fftfreq(2 * n, 1 / n)
    k = [along[:, None, None], along[None, :, None], 2 * np.pi * np.fft.rfftfreq(2 * n, 1 / n)[None, None, :]]
    k2 = k[0]**2 + k[1]**2 + k[2]**2
    k2[0, 0, 0] = 1.0
    weight = np.fft.rfftn(-drop * np.where(np.arange(2 * n) < n, 1.0, -1.0)[None, :, None])
    stress, before = None, np.inf
    while True:
        force = [np.zeros_like(weight), weight, np.zeros_like(weight)]
        for (a, b), part in (stress or {}).items():
            force[a] = force[a] + 1j * k[b] * part
            if a != b:
                force[b] = force[b] + 1j * k[a] * part
        pressure = sum(k[a] * force[a] for a in range(3)) / k2
        u = [np.where(k2 > 0, (force[a] - k[a] * pressure) / (uniform * k2), 0.0) for a in range(3)]
        fall = -(np.fft.irfftn(u[1], drop.shape)[:, :n] * drop[:, :n]).sum() / drop[:, :n].sum() / radius**2
        if abs(fall - before) < tolerance * abs(fall):
            return fall
        before = fall
        stress = {(a, b): np.fft.rfftn(2 * (eta - uniform) * np.fft.irfftn(0.5j * (k[a] * u[b] + k[b] * u[a]), drop.shape))
                  for a, b in combinations_with_replacement(range(3), 2)}


def main() -> None:
    radius, height, ratio = (float(word) for word in sys.argv[1:4])
    for n in map(int, sys.argv[4:]):
        print(n, *(f"{mean} {velocity(n, radius, height, ratio, mean):.5f}" for mean in ("harmonic", "arithmetic")), flush=True)


if __name__ == "__main__":
    main()
