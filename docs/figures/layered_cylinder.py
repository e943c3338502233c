#!/usr/bin/env python3
"""Growth rates of a self-gravitating cylinder of incompressible viscous layers by collocation.

The equations of docs/theory/layered_cylinder.md are solved for velocities and pressure at the Chebyshev points of each
layer as one eigenvalue problem, without the solutions by Bessel functions of modules/theory/layered_cylinder.cpp.

    /usr/bin/python3 docs/figures/layered_cylinder.py          # the rates of tests/theory/layered_cylinder.cpp
"""
import numpy as np
import scipy.linalg

G = 6.67408e-11  # m^3/(kg s^2)


def chebyshev(n, low, high):
    """Points from low to high and the matrix of the first derivative [L. N. Trefethen, Spectral Methods (2000)]."""
    x = np.cos(np.pi * np.arange(n + 1) / n)
    c = np.hstack([2.0, np.ones(n - 1), 2.0]) * (-1.0) ** np.arange(n + 1)
    X = np.tile(x, (n + 1, 1)).T
    D = np.outer(c, 1.0 / c) / (X - X.T + np.eye(n + 1))
    D -= np.diag(D.sum(axis=1))
    half = 0.5 * (high - low)
    return low + half * (1.0 + x[::-1]), D[::-1, ::-1] / half


def growth_rate(radii, densities, viscosities, degree, points=24):
    """The largest growth rate, 1/s. Lengths are scaled by the outer radius R, stresses by the largest viscosity times
    the unit of the rate, g/R at the surface to the power 1/2."""
    radii, densities, viscosities = (np.asarray(a, dtype=float) for a in (radii, densities, viscosities))
    L, m, R = len(radii), degree, radii[-1]
    inner = np.hstack([0.0, radii[:-1]])
    mass = np.cumsum(np.pi * densities * (radii**2 - inner**2))
    g = 2.0 * G * mass / radii
    rate = np.sqrt(g[-1] / R)
    stress = viscosities.max() * rate
    jump = densities - np.hstack([densities[1:], 0.0])
    r, rho, mu = radii / R, densities * R * R * rate / viscosities.max(), viscosities / viscosities.max()
    n = points + 1
    size = 3 * n * L + L  # u, v, p of each layer; then displacements
    A, B = np.zeros((size, size)), np.zeros((size, size))

    def at(layer, field):
        return slice((3 * layer + field) * n, (3 * layer + field + 1) * n)

    grids = []
    for k in range(L):
        # The axis is left out by a thousandth of the radius; there the flow is that of r^(m - 1).
        low = r[k - 1] if k else 1e-3 * r[0]
        grids.append(chebyshev(points, low, r[k]))
    free = []  # rows that boundary conditions take
    for k in range(L):
        x, D = grids[k]
        U, V, P = (at(k, f) for f in range(3))
        I, per = np.eye(n), np.diag(1.0 / x)
        lap = D @ D + per @ D - np.diag((m * m + 1.0) / x**2)
        # u cos, v sin, p cos: rho s u = -p' + mu (lap u - 2 m v/r^2), rho s v = m p/r + mu (lap v - 2 m u/r^2)
        A[U, U], A[U, V], A[U, P] = mu[k] * lap, -2.0 * m * mu[k] * per @ per, -D
        A[V, V], A[V, U], A[V, P] = mu[k] * lap, -2.0 * m * mu[k] * per @ per, m * per
        B[U, U], B[V, V] = rho[k] * I, rho[k] * I
        # The divergence of both: p is harmonic; that of the velocity vanishes within if it does at the ends.
        A[P, P] = D @ D + per @ D - np.diag((m / x) ** 2)
        for j in (0, n - 1):
            A[P.start + j] = 0.0
            A[P.start + j, U], A[P.start + j, V] = (D + per)[j], m * per[j]
        free += [U.start, U.stop - 1, V.start, V.stop - 1]

    def put(row, layer, end, quantity, sign=1.0):
        x, D = grids[layer]
        j = 0 if end == 0 else n - 1
        U, V, P = (at(layer, f) for f in range(3))
        if quantity == "u":
            A[row, U.start + j] += sign
        elif quantity == "v":
            A[row, V.start + j] += sign
        elif quantity == "shear":
            A[row, V] += sign * mu[layer] * D[j]
            A[row, V.start + j] -= sign * mu[layer] / x[j]
            A[row, U.start + j] -= sign * mu[layer] * m / x[j]
        else:  # normal stress
            A[row, U] += sign * 2.0 * mu[layer] * D[j]
            A[row, P.start + j] -= sign

    for row in free:
        A[row] = B[row] = 0.0
    rows = iter(free)
    # Towards the axis u = -v, as r^(m - 1), and p as r^m.
    x, D = grids[0]
    row = next(rows)
    put(row, 0, 0, "u")
    put(row, 0, 0, "v")
    row = next(rows)
    A[row, at(0, 0)] = x[0] * D[0]
    A[row, at(0, 0).start] -= m - 1
    row = at(0, 2).start
    A[row] = 0.0
    A[row, at(0, 2)] = x[0] * D[0]
    A[row, at(0, 2).start] -= m
    for k in range(L):
        last = k + 1 == L
        if not last:
            for quantity in ("u", "v", "shear"):
                row = next(rows)
                put(row, k, 1, quantity)
                put(row, k + 1, 0, quantity, -1.0)
        else:
            put(next(rows), k, 1, "shear")
        row = next(rows)  # normal stress against the weight of the displaced contact
        put(row, k, 1, "normal")
        if not last:
            put(row, k + 1, 0, "normal", -1.0)
        for b in range(L):
            field = -2.0 * np.pi * G / m * radii[b] * jump[b] * (min(r[k], r[b]) / max(r[k], r[b])) ** m
            A[row, 3 * n * L + b] += jump[k] * (field + (g[k] if b == k else 0.0)) * R / stress
        A[3 * n * L + k, at(k, 0).stop - 1] = 1.0
        B[3 * n * L + k, 3 * n * L + k] = 1.0
    values = scipy.linalg.eig(A, B, right=False)
    finite = values[np.isfinite(values) & (np.abs(values) < 1e6)]
    return rate * finite.real.max()


if __name__ == "__main__":
    for viscosity in ((1e11, 1e11, 1e11), (1e12, 1e12, 1e12), (1e13, 1e11, 1e12)):
        rates = [growth_rate([2e5, 3e5, 4.5e5], [3000.0, 7500.0, 2800.0], viscosity, m) for m in (1, 2, 3, 4)]
        print(viscosity, " ".join(f"{value:.8e}" for value in rates))
