"""Period and decay of a viscous drop's oscillation in another liquid, in two dimensions: the figures of docs/studies/2026-11-21_drops_and_surface_tension.md.

    python3 docs/figures/drop_oscillation.py          # needs python3-scipy

Linear mode exp(st + in theta) of a cylinder of radius R, without weight (after Miller & Scriven 1968, here for cylinders and in
a round box): in each liquid the stream function is a harmonic part, r^n or r^-n, and one of vorticity, I_n(r sqrt(s rho/eta)) or
K_n. On r = R velocity and shear stress are continuous and the normal stress jumps by sigma (n^2 - 1)/R^2 per displacement; on
r = b, if there is a box, nothing passes and no shear stress acts. s is where the determinant of these conditions vanishes.
"""

import math

import numpy as np
from scipy.optimize import root
from scipy.special import iv, ivp, kv, kvp


def determinant(s, n, sigma, R, inner, outer, b):
    """`inner`, `outer`: density and viscosity; `b`: radius of the box, or None."""

    def part(kind, r, l):
        """A stream function and two derivatives; Bessel functions over their value where they are largest."""
        if kind == "r^n":
            return r**n, n * r ** (n - 1), n * (n - 1) * r ** (n - 2)
        if kind == "r^-n":
            return r**-n, -n * r ** (-n - 1), n * (n + 1) * r ** (-n - 2)
        f, df, at = (kv, kvp, R) if kind == "K" else (iv, ivp, b if b and l == l_outer else R)
        scale = f(n, l * at)
        return f(n, l * r) / scale, l * df(n, l * r) / scale, l * l * df(n, l * r, 2) / scale

    def on_surface(kind, l, density, viscosity):
        """Radial and tangential velocity, shear and normal stress."""
        f, f1, f2 = part(kind, R, l)
        pressure = {"r^n": -1j * density * s * R**n, "r^-n": 1j * density * s * R**-n}.get(kind, 0)
        shear = viscosity * (-n * n * f / R**2 - f2 + f1 / R)
        return 1j * n * f / R, -f1, shear, -pressure + 2 * viscosity * 1j * n * (f1 / R - f / R**2)

    l_inner, l_outer = (np.sqrt(s * density / viscosity) for density, viscosity in (inner, outer))
    inside = [("r^n", l_inner), ("I", l_inner)]
    outside = [("r^-n", l_outer), ("K", l_outer)] + ([("r^n", l_outer), ("I", l_outer)] if b else [])
    M = np.zeros((2 + len(outside),) * 2, complex)
    for column, (kind, l) in enumerate(inside):
        radial, tangential, shear, normal = on_surface(kind, l, *inner)
        M[:4, column] = radial, tangential, shear, -normal - sigma * (n * n - 1) / R**2 * radial / s
    for column, (kind, l) in enumerate(outside, 2):
        radial, tangential, shear, normal = on_surface(kind, l, *outer)
        M[:4, column] = -radial, -tangential, -shear, normal
        if b:
            f, f1, f2 = part(kind, b, l)
            M[4:, column] = f, -f2 + f1 / b
    M /= np.abs(M).max(axis=0)
    M /= np.abs(M).max(axis=1)[:, None]
    return np.linalg.det(M)


def mode(n, sigma, R, inner, outer, b=None):
    """Rayleigh's angular frequency without viscosity and box; decay rate and frequency with them."""
    rayleigh = math.sqrt(sigma * n * (n * n - 1) / ((inner[0] + outer[0]) * R**3))

    def equation(z):
        d = determinant(complex(*z), n, sigma, R, inner, outer, b)
        return d.real, d.imag

    found = []
    for decay in (0.02, 0.1, 0.3, 0.5):
        for part in (1.0, 0.9, 0.8):
            r = root(equation, [-decay * rayleigh, part * rayleigh], tol=1e-13)
            if r.success and r.x[0] < 0.0 and r.x[1] > 0.2 * rayleigh:
                found.append(r.x)
    nearest = min(found, key=lambda z: abs(z[1] - rayleigh))
    return rayleigh, -nearest[0], nearest[1]


if __name__ == "__main__":
    print("sigma = 1, R = 1/4, densities 7 and 3, n = 2; box: a circle as wide as the square of side 1, and of its area")
    print(f"{'eta':>7}{'under p':>9}{'box':>8}{'period':>9}{'over 1st':>10}{'decay':>8}")
    for viscosity in (2e-4, 5e-3, 2e-2):
        for squeeze in (1.0, 1.05):  # p_top over K of the runs: 100/2000
            for b in (None, 0.5, 1 / math.sqrt(math.pi)):
                if b and viscosity < 1e-3:
                    continue
                rayleigh, decay, frequency = mode(2, 1.0, 0.25, (7.0 * squeeze, viscosity), (3.0 * squeeze, viscosity), b)
                print(f"{viscosity:7.0e}{squeeze:9.2f}{b or math.inf:8.4f}{2 * math.pi / frequency:9.4f}{rayleigh / frequency:10.4f}{decay:8.3f}")
