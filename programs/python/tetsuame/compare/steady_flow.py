"""Steady convection in a square, heated from below, by collocation with polynomials: what particles are judged by where nothing is published.

Lengths in L, velocities in kappa/L, temperatures in DeltaT above the top's. With F = lap v + Ra (T - T_ref) e_y - v.grad v/Pr the momentum equation
is F = grad p + s p e_y, s = q rho_0 g L/K_0: gravity weighs the pressure as the density q p/c_0^2. As e^(sy) F = grad(e^(sy) p), p drops out:

    dF_y/dx - dF_x/dy - s F_x = 0,    v.grad T = lap T
"""
import functools
import math
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev


class Basis:
    """Polynomials on [0, 1] that fulfil two conditions at either end, at the points of collocation."""

    def __init__(self, order: int, conditions: tuple[int, ...], points: np.ndarray):
        """conditions: the derivatives that vanish at both ends"""
        self.degree = order - 1 + 2 * len(conditions)
        ends = np.array([0.0, 1.0])
        rows = np.vstack([self.chebyshev(ends, k) / (4.0 * self.degree**2)**k for k in conditions])
        self.combine = np.linalg.svd(rows)[2][len(rows):].T
        self.at = [self(points, k) for k in range(5)]

    def chebyshev(self, x: np.ndarray, derivative: int) -> np.ndarray:
        all_of_them = np.eye(self.degree + 1)
        return 2.0**derivative * chebyshev.chebval(2.0 * np.asarray(x) - 1.0, chebyshev.chebder(all_of_them, derivative)).T

    def __call__(self, x: np.ndarray, derivative: int = 0) -> np.ndarray:
        return self.chebyshev(x, derivative) @ self.combine


@dataclass(frozen=True)
class Flow:
    rayleigh: float
    stream: np.ndarray     # coefficients: u = d stream/dy, v = -d stream/dx
    excess: np.ndarray     # of T - (1 - y)
    bases: dict
    residual: float        # of the last Newton step, relative

    def temperature(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """On the grid of x and y, [x, y]."""
        return self.bases["even"](x) @ self.excess @ self.bases["zero"](y).T + 1.0 - np.asarray(y)

    def gradient(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """-dT/dy."""
        return 1.0 - self.bases["even"](x) @ self.excess @ self.bases["zero"](y, 1).T

    def velocity(self, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        psi = self.bases["psi"]
        return psi(x) @ self.stream @ psi(y, 1).T, -psi(x, 1) @ self.stream @ psi(y).T

    @property
    def nusselt(self) -> float:
        nodes, weights = quadrature()
        return float(weights @ self.gradient(nodes, np.array([0.0]))[:, 0])

    @property
    def v_rms(self) -> float:
        nodes, weights = quadrature()
        u, v = self.velocity(nodes, nodes)
        return math.sqrt(float(weights @ (u**2 + v**2) @ weights))

    def largest(self) -> tuple[float, float]:
        """Of the horizontal and the vertical velocity, along the middle lines."""
        line, middle = np.linspace(0.0, 1.0, 2001), np.array([0.5])
        return float(np.abs(self.velocity(middle, line)[0]).max()), float(np.abs(self.velocity(line, middle)[1]).max())


def quadrature(points: int = 48) -> tuple[np.ndarray, np.ndarray]:
    nodes, weights = np.polynomial.legendre.leggauss(points)
    return 0.5 * (nodes + 1.0), 0.5 * weights


class Equations:
    """Matrices at the points of collocation, for one kind of wall."""

    def __init__(self, no_slip: bool, order: int):
        points = 0.5 - 0.5 * np.cos(np.pi * (np.arange(order) + 0.5) / order)
        self.order = order
        self.bases = {"psi": Basis(order, (0, 1) if no_slip else (0, 2), points), "even": Basis(order, (1,), points),
                      "zero": Basis(order, (0,), points)}

        def stream(i: int, j: int) -> np.ndarray:
            return np.kron(self.bases["psi"].at[i], self.bases["psi"].at[j])

        def heat(i: int, j: int) -> np.ndarray:
            return np.kron(self.bases["even"].at[i], self.bases["zero"].at[j])

        self.heat, self.T_x, self.T_y, self.T_lap = heat(0, 0), heat(1, 0), heat(0, 1), heat(2, 0) + heat(0, 2)
        self.u, self.v, self.u_x, self.u_y = stream(0, 1), -stream(1, 0), stream(1, 1), stream(0, 2)
        self.w, self.w_x, self.w_y = (-stream(2, 0) - stream(0, 2), -stream(3, 0) - stream(1, 2), -stream(2, 1) - stream(0, 3))
        self.curl = -stream(4, 0) - 2.0 * stream(2, 2) - stream(0, 4)  # lap w
        self.along = stream(2, 1) + stream(0, 3)                       # lap u

    def slaved(self, rayleigh: float, weight: float) -> np.ndarray:
        """Takes the excess of temperature to the stream function of a flow without inertia."""
        return np.linalg.solve(self.curl - weight * self.along, -rayleigh * self.T_x)

    def residual(self, a: np.ndarray, b: np.ndarray, rayleigh: float, per_prandtl: float, weight: float, jacobian: bool = True):
        """Of momentum and heat, and the Jacobian."""
        u, v, u_x, u_y, w_x, w_y = (m @ a for m in (self.u, self.v, self.u_x, self.u_y, self.w_x, self.w_y))
        T_x, T_y = self.T_x @ b, self.T_y @ b - 1.0
        momentum = (self.curl - weight * self.along) @ a + rayleigh * T_x - per_prandtl * (u * w_x + v * w_y - weight * (u * u_x + v * u_y))
        heat = self.T_lap @ b - u * T_x - v * T_y
        if not jacobian:
            return momentum, heat

        def times(values: np.ndarray, matrix: np.ndarray) -> np.ndarray:
            return values[:, None] * matrix

        inertia = times(u, self.w_x) + times(w_x - weight * u_x, self.u) + times(v, self.w_y) + times(w_y - weight * u_y, self.v) \
            - weight * (times(u, self.u_x) + times(v, self.u_y))
        of_momentum = np.hstack([self.curl - weight * self.along - per_prandtl * inertia, rayleigh * self.T_x])
        of_heat = np.hstack([-times(T_x, self.u) - times(T_y, self.v), self.T_lap - times(u, self.T_x) - times(v, self.T_y)])
        return momentum, heat, np.vstack([of_momentum, of_heat])


@functools.cache
def equations(no_slip: bool, order: int = 14) -> Equations:
    """At order 14 Nu of case 1a is right to 2e-4, its changes by weight to 1e-4 of themselves."""
    return Equations(no_slip, order)


def solve(rayleigh: float, prandtl: float = math.inf, no_slip: bool = False, weight: float = 0.0) -> Flow:
    """One roll, or conduction where it dies. weight: s."""
    eq = equations(no_slip)
    count = eq.order**2
    a, b = towards(eq, rayleigh, weight)
    change = math.inf
    for _ in range(20):
        momentum, heat, jacobian = eq.residual(a, b, rayleigh, 1.0 / prandtl, weight)
        step = np.linalg.solve(jacobian, -np.concatenate([momentum, heat]))
        a, b = a + step[:count], b + step[count:]
        change = float(np.abs(step[count:]).max() / max(np.abs(b).max(), 1e-12))
        if np.abs(b).max() < 1e-6:  # conduction
            change = 0.0
        if change < 1e-9:
            break
    shape = (eq.order, eq.order)
    return Flow(rayleigh, a.reshape(shape), b.reshape(shape), eq.bases, change)


def towards(eq: Equations, rayleigh: float, weight: float) -> tuple[np.ndarray, np.ndarray]:
    """Steps in time, implicit in T, from a roll to near the steady state without inertia; from there Newton's method converges."""
    points = 0.5 - 0.5 * np.cos(np.pi * (np.arange(eq.order) + 0.5) / eq.order)
    b = np.linalg.solve(eq.heat, 0.3 * np.outer(np.cos(np.pi * points), np.sin(np.pi * points)).ravel())
    slaved = eq.slaved(rayleigh, weight)
    dt = 0.02
    for _ in range(60):
        a = slaved @ b
        u, v = eq.u @ a, eq.v @ a
        flow = eq.T_lap - u[:, None] * eq.T_x - v[:, None] * eq.T_y
        # What the flow does with a change of T is in the matrix too: else the steps would be bound by the swing of a roll.
        T_x, T_y = eq.T_x @ b, eq.T_y @ b - 1.0
        rates = eq.T_lap @ b - u * T_x - v * T_y
        jacobian = flow - T_x[:, None] * (eq.u @ slaved) - T_y[:, None] * (eq.v @ slaved)
        step = np.linalg.solve(eq.heat / dt - jacobian, rates)
        b = b + step
        if np.abs(step).max() < 1e-4 * np.abs(b).max():
            break
    return slaved @ b, b
