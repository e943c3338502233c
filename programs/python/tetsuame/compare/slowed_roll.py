"""The way to convection in a square that slips, with slowed sound and heavy inertia, without particles: what errors of slowing are foretold by.

Lengths in L, velocities in kappa/L, theta = T - (1 - y) in DeltaT. With Pr = nu_eff/kappa, c = c_eff L/kappa and p over rho_0 xi^2,

    Dv/Dt = -grad p + Pr (lap v + Ra theta e_y),    dp/dt = -c^2 div v at a place,    Dtheta/Dt = lap theta + v_y

All fields are sums of cos or sin(k pi x) times cos or sin(m pi y), and what is linear couples four amplitudes of the same k and m: it is taken by the
exponential of their matrix, what is not by the fourth-order Runge-Kutta steps of Cox and Matthews (J. Comput. Phys. 176, 430, 2002).
"""
import functools
import math

import numpy as np

WAVES = 16  # along an edge: the time of the first overshoot to 1e-7 at Ra 1e4 and 1e5
RINGING = 0.09  # of Ra^(2/3), the steady flow's v_rms: sound of the start rings below it, the overshoot is twice that
LONGEST = 1000  # steps of 1/Ra
TERMS = 14  # of a power series, for matrices below 1/4


class Waves:
    """Amplitudes to values at points, and back."""

    def __init__(self, count: int):
        points = (np.arange(3 * count // 2) + 0.5) / (3 * count // 2)
        self.k = np.pi * np.arange(count)
        self.cos, self.sin = np.cos(np.outer(points, self.k)), np.sin(np.outer(points, self.k))
        self.to_cos, self.to_sin = (2.0 / len(points) * table.T for table in (self.cos, self.sin))
        self.to_cos[0] *= 0.5


def exponentials(matrix: np.ndarray) -> list[np.ndarray]:
    """phi_0 = exp and phi_n(z) = sum z^j/(j + n)! to n = 3, of each matrix: at a small part of it, which is doubled."""
    doublings = max(0, math.ceil(math.log2(4.0 * float(np.abs(matrix).sum(-1).max()))))
    small, power = matrix / 2.0**doublings, np.broadcast_to(np.eye(matrix.shape[-1]), matrix.shape)
    phi = [np.zeros_like(matrix) for _ in range(4)]
    for j in range(TERMS):
        phi = [sum_ + power / math.factorial(j + n) for n, sum_ in enumerate(phi)]
        power = power @ small
    for _ in range(doublings):
        e, first, second, third = phi
        phi = [e @ e, (e @ first + first) / 2.0, (e @ second + first + second) / 4.0, (e @ third + first / 2.0 + second + third) / 8.0]
    return phi


class Roll:
    """Rates of the amplitudes [k, m, field]: theta, u, v, p/c; of theta alone where the flow follows it at once."""

    def __init__(self, rayleigh: float, prandtl: float, sound: float):
        self.waves = Waves(WAVES)
        self.kx, self.ky = np.meshgrid(self.waves.k, self.waves.k, indexing="ij")
        square = self.kx**2 + self.ky**2
        self.at_once = math.isinf(prandtl)
        if self.at_once:
            per_theta = rayleigh * self.kx / np.where(square > 0.0, square, 1.0)**2
            self.flow = -self.ky * per_theta, self.kx * per_theta
            self.linear = (self.flow[1] - square)[..., None, None]
            return
        self.linear = np.zeros((WAVES, WAVES, 4, 4))
        for field, spread in enumerate((1.0, prandtl, prandtl)):
            self.linear[..., field, field] = -spread * square
        self.linear[..., 0, 2], self.linear[..., 2, 0] = 1.0, prandtl * rayleigh
        for field, k in ((1, self.kx), (2, self.ky)):
            self.linear[..., field, 3], self.linear[..., 3, field] = sound * k, -sound * k

    def velocity(self, state: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Amplitudes of u, sin cos, and v, cos sin."""
        return tuple(part * state[..., 0] for part in self.flow) if self.at_once else (state[..., 1], state[..., 2])

    def carried(self, state: np.ndarray) -> np.ndarray:
        """-v.grad of theta, u and v."""
        cos, sin = self.waves.cos, self.waves.sin
        to_cos, to_sin = self.waves.to_cos, self.waves.to_sin
        a, b = self.velocity(state)
        u, v = sin @ a @ cos.T, cos @ b @ sin.T

        def along(amplitude: np.ndarray, odd_in_x: bool, odd_in_y: bool) -> np.ndarray:
            in_x, in_y = sin if odd_in_x else cos, sin if odd_in_y else cos
            by_x = (cos if odd_in_x else -sin) @ (self.kx * amplitude) @ in_y.T
            by_y = in_x @ (self.ky * amplitude) @ (cos if odd_in_y else -sin).T
            return (to_sin if odd_in_x else to_cos) @ -(u * by_x + v * by_y) @ (to_sin if odd_in_y else to_cos).T

        rate = np.zeros_like(state)
        rate[..., 0] = along(state[..., 0], False, True)
        if not self.at_once:
            rate[..., 1], rate[..., 2] = along(a, True, False), along(b, False, True)
        return rate

    def v_rms(self, state: np.ndarray) -> float:
        mean = np.where(np.arange(WAVES) > 0, 0.5, 1.0)  # of cos²
        u, v = self.velocity(state)
        return math.sqrt(0.5 * float((u**2 * mean[None, :] + v**2 * mean[:, None]).sum()))


@functools.cache
def first_overshoot(rayleigh: float, perturbation: float, prandtl: float = math.inf, sound: float = math.inf) -> tuple[float, float]:
    """From conduction at rest with perturbation cos(pi x) sin(pi y): when v_rms has its first maximum (L²/kappa), and the maximum.
    Both infinite: incompressible, without inertia."""
    roll, dt = Roll(rayleigh, prandtl, sound), 1.0 / rayleigh
    half, whole = exponentials(0.5 * dt * roll.linear), exponentials(dt * roll.linear)
    weights = [dt * weight for weight in (whole[1] - 3.0 * whole[2] + 4.0 * whole[3], 2.0 * whole[2] - 4.0 * whole[3], 4.0 * whole[3] - whole[2])]

    def times(matrix: np.ndarray, state: np.ndarray) -> np.ndarray:
        return (matrix @ state[..., None])[..., 0]

    state = np.zeros((WAVES, WAVES, roll.linear.shape[-1]))
    state[1, 1, 0] = perturbation
    found = [roll.v_rms(state)]
    while found[-1] > 0.985 * (top := max(found)) or top < RINGING * rayleigh**(2.0 / 3.0):
        first = roll.carried(state)
        a = times(half[0], state) + 0.5 * dt * times(half[1], first)
        second = roll.carried(a)
        b = times(half[0], state) + 0.5 * dt * times(half[1], second)
        third = roll.carried(b)
        c = times(half[0], a) + 0.5 * dt * times(half[1], 2.0 * third - first)
        state = times(whole[0], state) + times(weights[0], first) + times(weights[1], second + third) + times(weights[2], roll.carried(c))
        found.append(roll.v_rms(state))
        if not math.isfinite(found[-1]) or len(found) > LONGEST:
            return math.nan, math.nan
    return vertex(dt, np.array(found))


def vertex(dt: float, values: np.ndarray) -> tuple[float, float]:
    """Of the parabola through the largest of equidistant values and those beside it."""
    top = int(np.argmax(values))
    before, here, after = values[top - 1:top + 2]
    slope, bend = 0.5 * (after - before), after - 2.0 * here + before
    return dt * (top - slope / bend), float(here - 0.5 * slope**2 / bend)
