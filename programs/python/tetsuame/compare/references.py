"""Published and independently calculated values that convection is held against: the one place where they stand."""
from dataclasses import dataclass

BLANKENBACH = "B. Blankenbach et al., Geophys. J. Int. 98, 23 (1989), best estimates"
SQUARE = "Chebyshev–Newton solution of the steady Boussinesq equations"


@dataclass(frozen=True)
class Steady:
    """A steady flow; velocities in κ/L."""
    rayleigh: float
    prandtl: float | None          # None: infinite
    values: dict[str, float]       # by the metrics' names in summary.json
    source: str


def same_heat(nusselt: float) -> dict[str, float]:
    """Where the flow is steady the same heat goes through all heights, and friction takes the work of buoyancy."""
    return {f"nusselt_{where}": nusselt for where in ("volume", "top", "bottom", "dissipation")}


def blankenbach(rayleigh, nusselt, *others) -> Steady:
    return Steady(rayleigh, None, same_heat(nusselt) | dict(zip(("v_rms", "q1", "q2", "q3", "q4"), others)), BLANKENBACH)


def square(rayleigh, prandtl, nusselt, *others) -> Steady:
    return Steady(rayleigh, prandtl, same_heat(nusselt) | dict(zip(("v_rms", "u_max", "v_max"), others)), SQUARE)


STEADY = {
    "blankenbach_1a": blankenbach(1e4, 4.884409, 42.864947, 8.059384, 0.588810, 8.059384, 0.588810),
    "blankenbach_1b": blankenbach(1e5, 10.534095, 193.21454, 19.079440, 0.722751, 19.079440, 0.722751),
    "blankenbach_1c": blankenbach(1e6, 21.972465, 833.98977, 45.96425, 0.877170, 45.96425, 0.877170),
    "blankenbach_2a": blankenbach(1e4, 10.0660, 480.4334, 17.53136, 1.00851, 26.8085, 0.497380),
    "blankenbach_2b": blankenbach(1e4, 6.9299, 171.755, 18.4842, 0.17742, 14.1682, 0.61770),
    "air_1e4": square(1e4, 0.71, 2.158076, 14.21954, 21.2589, 22.2185),
    "air_1e5": square(1e5, 0.71, 3.910513, 59.85592, 91.7633, 100.1170),
    "air_1e6": square(1e6, 0.71, 6.3132, 195.499, 312.735, 342.30),
    "square_pr1": square(1e4, 1.0, 2.164753, 14.24764, 21.3325, 22.3222),
}


def of(file: str, metrics: dict) -> Steady | None:
    """The reference of a run, if it ran at the reference's Rayleigh and Prandtl numbers (settings may have changed them)."""
    found = STEADY.get(file)
    fits = found is not None and near(metrics.get("rayleigh"), found.rayleigh) and \
        (found.prandtl is None or near(metrics.get("prandtl"), found.prandtl))
    return found if fits else None


def near(value, wanted: float) -> bool:
    return isinstance(value, (int, float)) and abs(value / wanted - 1) < 1e-6
