"""A reference for the overturn without particles: two incompressible liquids of one viscosity that creep, in half a wave of the box.

With u = dpsi/dy, v = -dpsi/dx the curl of 0 = -grad p + eta lap(u, v) - rho g e_y is

    eta lap lap psi = -g drho/dx,     psi = dpsi/dy = 0 on floor and lid (no slip), psi = d2psi/dx2 = 0 on the sides (free slip)

so psi is a series of sines over x, whose coefficients solve (d2/dy2 - k^2)^2 psi_k = g k rho_k/eta, second order in the spacing of the rows.
The liquids are markers, moved by steps of Runge and Kutta of second order. Lengths are in heights, times in eta/(Delta_rho g L).
"""
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Fall:
    time: np.ndarray    # eta/(Delta_rho g L)
    height: np.ndarray  # of the metal's centroid, over the box's

    def when(self, fall: float) -> float:
        """Time at which the centroid has fallen by so much of the height."""
        return float(np.interp(fall, self.height[0] - self.height, self.time))


class Box:
    """Half a wave: width over height; cells along x and y."""

    def __init__(self, width: float, rows: int):
        self.width, self.rows = width, rows
        self.columns = max(8, round(width * rows))
        self.dx, self.dy = width / self.columns, 1.0 / rows
        self.k = np.pi / width * np.arange(1, self.columns)
        self.solve = np.stack([np.linalg.inv(self.operator(k)) for k in self.k])
        centres, nodes = (np.arange(self.columns) + 0.5) * self.dx, np.arange(self.columns + 1) * self.dx
        self.to_cosines = 2.0 / self.columns * np.cos(np.outer(self.k, centres))
        self.sines, self.cosines = np.sin(np.outer(self.k, nodes)), np.cos(np.outer(self.k, nodes))

    def operator(self, k: float) -> np.ndarray:
        """Of psi_k on the rows' edges between floor and lid: beyond these the mirror image has the same value, for no slip."""
        n = self.rows - 1
        second = (np.diag(np.full(n, -2.0)) + np.diag(np.ones(n - 1), 1) + np.diag(np.ones(n - 1), -1)) / self.dy**2
        fourth = second @ second
        fourth[0, 0] += 2.0 / self.dy**4   # second @ second alone has psi'' = 0 there: (6 - 1) psi_1; no slip: (6 + 1)
        fourth[-1, -1] += 2.0 / self.dy**4
        return fourth - 2.0 * k**2 * second + k**4 * np.eye(n)

    def velocity(self, density: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(u, v) on the corners of the cells, from the share of metal in them (columns, rows)."""
        rho_k = self.to_cosines @ density
        edges = 0.5 * (rho_k[:, 1:] + rho_k[:, :-1])
        psi = np.zeros((len(self.k), self.rows + 1))
        psi[:, 1:-1] = np.einsum("kij,kj->ki", self.solve, self.k[:, None] * edges)
        slope = np.zeros_like(psi)
        slope[:, 1:-1] = (psi[:, 2:] - psi[:, :-2]) / (2.0 * self.dy)
        return self.sines.T @ slope, -(self.cosines * self.k[:, None]).T @ psi

    def at(self, field: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Linear between the corners."""
        i, a = cell(x / self.dx, self.columns)
        j, b = cell(y / self.dy, self.rows)
        return ((1 - a) * ((1 - b) * field[i, j] + b * field[i, j + 1]) + a * ((1 - b) * field[i + 1, j] + b * field[i + 1, j + 1]))

    def share(self, x: np.ndarray, y: np.ndarray, metal: np.ndarray) -> np.ndarray:
        """Of metal, in every cell: its markers over all, each spread over the four nearest cells."""
        sums = np.zeros((2, (self.columns + 2) * (self.rows + 2)))
        i, a = cell(x / self.dx + 0.5, self.columns + 1)
        j, b = cell(y / self.dy + 0.5, self.rows + 1)
        for di, weight_x in ((0, 1 - a), (1, a)):
            for dj, weight_y in ((0, 1 - b), (1, b)):
                index, weight = (i + di) * (self.rows + 2) + j + dj, weight_x * weight_y
                sums[0] += np.bincount(index, weight, minlength=sums.shape[1])
                sums[1] += np.bincount(index, weight * metal, minlength=sums.shape[1])
        all_of, of_metal = (inward(one.reshape(self.columns + 2, self.rows + 2)) for one in sums)
        return of_metal / np.maximum(all_of, 1e-12)


def cell(position: np.ndarray, cells: int) -> tuple[np.ndarray, np.ndarray]:
    index = np.clip(position.astype(int), 0, cells - 1)
    return index, position - index


def inward(sums: np.ndarray) -> np.ndarray:
    """What fell into the row of cells behind each wall, given back to its mirror image."""
    sums = sums.copy()
    sums[1] += sums[0]
    sums[-2] += sums[-1]
    sums[:, 1] += sums[:, 0]
    sums[:, -2] += sums[:, -1]
    return sums[1:-1, 1:-1]


def overturn(width: float = 0.5, interface: float = 0.5, amplitude: float = 0.02, rows: int = 96, markers: int = 3,
             fall: float = 0.32) -> Fall:
    """width: half a wave, over the height. The start is carried along the growing mode, as rti's. markers: along the edge of a cell."""
    box = Box(width, rows)
    x, y = np.meshgrid((np.arange(box.columns * markers) + 0.5) * box.dx / markers, (np.arange(rows * markers) + 0.5) * box.dy / markers,
                       indexing="ij")
    x, y = x.ravel(), y.ravel()
    metal = (y > interface).astype(float)
    u, v = mode(box, interface)
    for _ in range(8):
        x, y = moved(box, x, y, lambda *_: (u, v), amplitude / 8)
    times, heights = [0.0], [y[metal > 0].mean()]
    while heights[0] - heights[-1] < fall:
        flow = lambda x, y: box.velocity(box.share(x, y, metal))
        u, v = flow(x, y)
        step = 0.4 * min(box.dx / np.abs(u).max(), box.dy / np.abs(v).max())
        x, y = moved(box, x, y, flow, step)
        times.append(times[-1] + step)
        heights.append(y[metal > 0].mean())
    return Fall(np.array(times), np.array(heights))


def mode(box: Box, interface: float) -> tuple[np.ndarray, np.ndarray]:
    """Of the wave of the box's width, with unit velocity upward where the interface is highest."""
    lower = np.clip(interface / box.dy - np.arange(box.rows), 0.0, 1.0)
    bump = np.where((lower > 0.0) & (lower < 1.0), 1.0, 0.0)
    if not bump.any():  # on an edge between rows: half into each
        at = round(interface / box.dy)
        bump[at - 1:at + 1] = 0.5
    centres = (np.arange(box.columns) + 0.5) * box.dx
    u, v = box.velocity(-np.outer(np.cos(box.k[0] * centres), bump))
    scale = box.at(v, np.array([0.0]), np.array([interface]))[0]
    return u / scale, v / scale


def moved(box: Box, x, y, flow, step: float):
    u, v = flow(x, y)
    half_x, half_y = x + 0.5 * step * box.at(u, x, y), y + 0.5 * step * box.at(v, x, y)
    u, v = flow(half_x, half_y)
    return (np.clip(x + step * box.at(u, half_x, half_y), 0.0, box.width), np.clip(y + step * box.at(v, half_x, half_y), 0.0, 1.0))
