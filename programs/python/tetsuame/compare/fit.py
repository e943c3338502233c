"""Least squares of powers and exponentials."""
from dataclasses import dataclass

import numpy as np

from .. import pages


@dataclass(frozen=True)
class Slope:
    value: float
    error: float | None          # standard error of the fit, None for two points
    intercept: float
    points: int


def line(x: np.ndarray, y: np.ndarray) -> Slope | None:
    """y = intercept + value x; None for fewer than two different x."""
    x, y = np.asarray(x, float), np.asarray(y, float)
    good = np.isfinite(x) & np.isfinite(y)
    x, y = x[good], y[good]
    if len(set(x.tolist())) < 2:
        return None
    slope, intercept = np.polyfit(x, y, 1)
    error = float(np.sqrt(np.polyfit(x, y, 1, cov=True)[1][0, 0])) if len(x) > 2 else None
    return Slope(float(slope), error, float(intercept), len(x))


FEWEST = 3  # points of an order: two lie on a line whatever the error does
WHY_NONE = f"–: no order; a fit takes at least {FEWEST} numbers of particles with an error larger than its uncertainty."


def usable(n: list[int], errors: list[float], uncertainties: list[float] | None = None) -> list[tuple[float, float]]:
    """Logarithms of n and of |error|. An error within the uncertainty of its measurement says nothing of an order and is left out."""
    within = uncertainties or [0.0] * len(n)
    return [(np.log(k), np.log(abs(e))) for k, e, u in zip(n, errors, within) if e is not None and np.isfinite(e) and abs(e) > (u or 0.0)]


def order(n: list[int], errors: list[float], uncertainties: list[float] | None = None) -> Slope | None:
    """p of |error| = C n^-p; None for fewer than FEWEST numbers of particles."""
    used = usable(n, errors, uncertainties)
    found = line(*zip(*used)) if len({k for k, _ in used}) >= FEWEST else None
    return Slope(-found.value, found.error, found.intercept, found.points) if found else None


def series(runs: list[dict], judged) -> dict[tuple[str, str, str], list[tuple[int, float, float]]]:
    """Of each case, variant and quantity: n, error and its uncertainty. judged(row): the latter two by quantity."""
    found: dict[tuple[str, str, str], list[tuple[int, float, float]]] = {}
    for one in runs:
        for quantity, (error, uncertainty) in judged(one).items():
            found.setdefault((one["case"], one["variant"], quantity), []).append((one["n"], error, uncertainty))
    return found


def orders(runs: list[dict], judged) -> list[dict]:
    """Of results.json: of what, the order (None without one), and how many points there are."""
    found = []
    for (case, variant, quantity), points in series(runs, judged).items():
        slope = order(*zip(*points))
        found.append({"case": case, "variant": variant, "quantity": quantity, "order": slope.value if slope else None,
                      "standard_error": slope.error if slope else None, "points": len(usable(*zip(*points)))})
    return found


def order_of(measured: dict, case: str, variant: str) -> str:
    found = [one for one in measured["orders"] if (one["case"], one["variant"]) == (case, variant)]
    return of_entry(found[0]) if found else said(None)


def of_entry(found: dict) -> str:
    return said(None if found["order"] is None else Slope(found["order"], found["standard_error"], 0.0, found["points"]))


def note(measured: dict) -> str:
    """Below a table with orders: why there is none, where that is so."""
    return pages.small(WHY_NONE) if any(one["order"] is None for one in measured["orders"]) else ""


def said(slope: Slope | None) -> str:
    """'1.92 ± 0.05', or a dash."""
    if slope is None:
        return "–"
    return f"{slope.value:.2f}" if slope.error is None else f"{slope.value:.2f} ± {slope.error:.2f}"
