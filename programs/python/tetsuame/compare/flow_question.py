"""A question to the comparison of water with a free surface, and what errors are made of."""
from collections.abc import Callable
from dataclasses import dataclass

from .parts import said


@dataclass(frozen=True)
class Question:
    case: str
    n: int                                     # asked for
    what: str
    limit: float                               # of what |error| may be; of a speed, what it has to be
    error: Callable[[dict], float | None]
    shown: Callable[[dict], str] | None = None  # beside it
    until: float = 0.0                         # s, that the run has to come to
    shorter: bool = False                      # one that comes less far answers, too, and says so
    at_least: bool = False
    form: str = "percent"


def metric(one: dict, name: str) -> float | None:
    return one["metrics"].get(name)


def against(name: str, reference: str) -> Callable[[dict], float | None]:
    def error(one: dict) -> float | None:
        value, right = metric(one, name), metric(one, name + reference)
        return value / right - 1.0 if value is not None and right else None
    return error


def measured_beside(name: str, unit: str, form: str = "{:.4g}", reference: str = "_reference") -> Callable[[dict], str]:
    return lambda one: f"{said(metric(one, name), form)} for {said(metric(one, name + reference), form)} {unit}"
