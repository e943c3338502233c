"""The cold cloud that collapses (inputs/collapse.nml) beside an independent solution in one dimension.

    python3 docs/figures/collapse.py [output/shock/collapse]

Spherical shells, staggered in space and time, with the artificial viscosity of J. von Neumann and R. D. Richtmyer (J. Appl. Phys. 21,
232 (1950)) and a linear term: kinetic, internal and gravitational energy over time, for 400, 800 and 1600 shells; then those of a run."""

import csv
import pathlib
import sys

import numpy as np

GAMMA, TIMES = 5 / 3, np.array([0.5, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.5, 2.0, 2.5, 3.0])


def shells(number, quadratic=2.0, linear=0.3, courant=0.3):
    """Energies (kinetic, internal, gravitational) at TIMES; G = M = R = 1."""
    inside = np.linspace(0, 1, number + 1)**2  # mass within the edges: M(r) = r²
    r, v, u = np.sqrt(inside), np.zeros(number + 1), np.full(number, 0.05)
    m = np.diff(inside)
    of_edges = np.concatenate([[0.5 * m[0]], 0.5 * (m[1:] + m[:-1]), [0.5 * m[-1]]])

    def volumes():
        return 4 * np.pi / 3 * np.diff(r**3)

    V = volumes()
    rho, q = m / V, np.zeros(number)
    p = (GAMMA - 1) * rho * u
    t, last, found = 0.0, None, []
    while len(found) < len(TIMES):
        c = np.sqrt(GAMMA * p / rho)
        dt = courant * np.min(np.diff(r) / (c + 4 * np.abs(np.minimum(np.diff(v), 0))))
        dt = min(dt, TIMES[len(found)] - t, 1.1 * last if last else dt)
        last = dt if dt > 1e-9 else last
        a = np.zeros(number + 1)
        a[1:-1] = -4 * np.pi * r[1:-1]**2 * np.diff(p + q) / of_edges[1:-1]
        a[-1] = 4 * np.pi * r[-1]**2 * (p + q)[-1] / of_edges[-1]
        a[1:] -= inside[1:] / r[1:]**2
        v[1:] += dt * a[1:]
        r = r + dt * v
        before, V = V, volumes()
        squeezed = np.minimum(np.diff(v), 0)
        q = 0.5 * (rho + m / V) * (quadratic * squeezed**2 + linear * c * np.abs(squeezed))
        rho = m / V
        u = (u - (0.5 * p + q) * (V - before) / m) / (1 + 0.5 * (GAMMA - 1) * rho * (V - before) / m)
        p = (GAMMA - 1) * rho * u
        t += dt
        if t >= TIMES[len(found)] - 1e-12:
            middle = (0.5 * (r[1:]**3 + r[:-1]**3))**(1 / 3)
            found.append((0.5 * (of_edges * v**2).sum(), (m * u).sum(), -(0.5 * (inside[1:] + inside[:-1]) * m / middle).sum()))
    return np.array(found)


def of_run(folder):
    with open(folder / "history.csv", newline="") as file:
        header, *rows = list(csv.reader(file))
    names, values = [name.split(" ")[0] for name in header], np.array(rows, float)
    return np.column_stack([np.interp(TIMES, values[:, names.index("time")], values[:, names.index(name)], right=np.nan)
                            for name in ("kinetic_energy", "internal_energy", "potential_energy")])


def tell(title, energies):
    print(title)
    for t, line in zip(TIMES, energies):
        print(f"{t:4.1f} " + " ".join(f"{value:8.4f}" for value in line))


if __name__ == "__main__":
    for number in (400, 800, 1600):
        tell(f"{number} shells", shells(number))
    for folder in sys.argv[1:]:
        tell(folder, of_run(pathlib.Path(folder)))
