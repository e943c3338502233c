"""Bodies in water, for the comparison of water with a free surface: what is measured of the runs, and what is asked."""
import math
from collections.abc import Callable

import numpy as np

from .. import gauges
from ..reading import Keys, real
from .flow_question import Question, against, measured_beside, metric
from .outcomes import COMPLETED, Outcome

FREE = 0.8             # s, from when on the pushed tank stands still
HEAVES = (0.45, 0.53)  # s: the first half period of the floating box, with water that is dragged along or none
SETTLED, FIRST = 1.0, 0.75  # s: from when on the box's place is averaged; before which it is lowest first
ONE, RANKS = "1 rank", 4


def on_ranks(count: int) -> str:
    return ONE if count == 1 else f"{count} ranks"


def first(keys: dict[str, str], name: str) -> float:
    """The first number of a list of resolved.nml."""
    return real(gauges.listed(keys[name])[0])


def mean_from(times: np.ndarray, values: np.ndarray, start: float) -> float:
    return float(values[times > start].mean())


def period(times: np.ndarray, values: np.ndarray) -> float | None:
    """By the first and the last zero, between which straight lines go through the readings; None with less than one period."""
    at = np.flatnonzero(values[:-1] * values[1:] < 0.0)
    if len(at) < 3:
        return None
    zeros = times[at] + (times[at + 1] - times[at]) * values[at] / (values[at] - values[at + 1])
    return float(2.0 * (zeros[-1] - zeros[0]) / (len(zeros) - 1))


def tank(outcome: Outcome) -> tuple[float, float]:
    """Length and depth of the water when it was at rest, m."""
    keys = Keys(outcome.folder / "resolved.nml")
    length, spacing = first(keys, "solids.length_x"), outcome.setting("domain.length_x") / outcome.setting("domain.particles_x")
    return length, outcome.number("fluid_particles") * spacing**2 / length


def weight(outcome: Outcome) -> float:
    """Of the water, N for each metre: its masses are those of water that is pressed together by its own weight."""
    return float(outcome.snapshot["Masses"].sum()) * outcome.setting("flow.gravity")


def frequency(length: float, depth: float, gravity: float) -> float:
    """rad/s, of the slowest wave from wall to wall: ω² = g k tanh kd."""
    k = math.pi / length
    return math.sqrt(gravity * k * math.tanh(k * depth))


def sloshing(outcome: Outcome, _outcomes: list[Outcome]) -> dict[str, float | None]:
    readings, (length, depth) = gauges.read(outcome.folder), tank(outcome)
    gravity, free = outcome.setting("flow.gravity"), readings["time"] > FREE
    return {"slosh_period": period(readings["time"][free], (readings["height_2"] - readings["height_1"])[free]),
            "slosh_period_theory": 2.0 * math.pi / frequency(length, depth, gravity),
            "weight": -mean_from(readings["time"], readings["force_1_y"], FREE),
            "weight_theory": weight(outcome)}


def floating(outcome: Outcome, _outcomes: list[Outcome]) -> dict[str, float | None]:
    readings, keys = gauges.read(outcome.folder), Keys(outcome.folder / "resolved.nml")
    times, heave = readings["time"], readings["motion_1_y"]
    wide, high = (first(keys, f"solids.length_{axis}") for axis in "xy")
    lightness, gravity = first(keys, "motions.density") / outcome.setting("flow.density"), outcome.setting("flow.gravity")
    # The water's level rises as the box sinks: by what it displaces, over what the box leaves of the tank.
    lacks = lightness * high - (outcome.setting("flow.high_y") - first(keys, "solids.centre_y") + 0.5 * high)
    found = {"draught": lightness * high, "heave_place_theory": -lacks * (1.0 - wide / outcome.setting("domain.length_x")),
             "carried_theory": first(keys, "motions.density") * wide * high * gravity}
    if times[-1] > FIRST:
        found["half_period"] = float(times[np.argmin(np.where(times < FIRST, heave, np.inf))])
    if times[-1] > 2.0 * SETTLED:
        found |= {"heave_place": mean_from(times, heave, SETTLED), "carried": mean_from(times, readings["force_1_y"], SETTLED)}
    return found


def mechanical(history: dict[str, np.ndarray]) -> np.ndarray:
    """Energy of water and bodies, J."""
    return sum(history[name] for name in history if "energy" in name)


def energy(outcome: Outcome, _outcomes: list[Outcome]) -> dict[str, float | None]:
    history = outcome.history
    total, largest = mechanical(history), float(history["kinetic_energy"].max())
    return {"energy_above_start": float((total - total[0]).max()) / largest if largest > 0.0 else None}


def ranks(outcome: Outcome, outcomes: list[Outcome]) -> dict[str, float | None]:
    alone = next((o for o in outcomes if o.case.file == outcome.case.file and o.case.variant == ONE and o.kind == COMPLETED), None)
    return {"load_max_over_mean": outcome.number("metrics", "load_max_over_mean"),
            "other_bits": None if alone is None else float(alone.summary.get("state_hash") != outcome.summary.get("state_hash"))}


MEASURES: dict[str, Callable[[Outcome, list[Outcome]], dict[str, float | None]]] = {
    "sloshing": sloshing, "floating_box": floating, "bowl": energy, "bowl_ranks": ranks, "dam_break_building": energy}


def measured(outcome: Outcome, outcomes: list[Outcome]) -> dict[str, float]:
    """What its metrics do not have already."""
    measure = MEASURES.get(outcome.case.file)
    return {name: value for name, value in measure(outcome, outcomes).items() if value is not None} if measure else {}


def off_its_place(one: dict) -> float | None:
    place, right, draught = (metric(one, name) for name in ("heave_place", "heave_place_theory", "draught"))
    return None if place is None else (place - right) / draught


def millimetres(one: dict) -> str:
    place, right = (metric(one, name) for name in ("heave_place", "heave_place_theory"))
    return f"{1e3 * place:.1f} for {1e3 * right:.1f} mm".replace("-", "−")


def half_period(one: dict) -> float | None:
    value, middle = metric(one, "half_period"), 0.5 * sum(HEAVES)
    return None if value is None else value / middle - 1.0


def conserved(case: str, n: int) -> list[Question]:
    return [Question(case, n, "energy gained, over the largest kinetic energy", 0.0,
                     lambda one: metric(one, "energy_above_start")),
            Question(case, n, "mass lost", 0.0, lambda one: one["mass"], form="number")]


QUESTIONS = (
    Question("sloshing", 50, "period", 0.01, against("slosh_period", "_theory"), measured_beside("slosh_period", "s", "{:.3f}", "_theory"),
             until=5.0, shorter=True),
    Question("sloshing", 20, "weight of the water on the tank", 0.01, against("weight", "_theory"),
             measured_beside("weight", "N/m", "{:.0f}", "_theory"), until=5.0, shorter=True),
    Question("floating_box", 5, "first half period, off the middle of its bounds", 0.5 * (HEAVES[1] - HEAVES[0]) / (0.5 * sum(HEAVES)),
             half_period, lambda one: f"{metric(one, 'half_period'):.3f} for {HEAVES[0]:g} to {HEAVES[1]:g} s"),
    Question("floating_box", 5, "place about which it heaves, over the draught", 0.01, off_its_place, millimetres, until=5.0),
    Question("floating_box", 5, "weight carried", 0.01, against("carried", "_theory"), measured_beside("carried", "N/m", "{:.1f}", "_theory"),
             until=5.0),
    *conserved("bowl", 50),
    Question("bowl_ranks", 50, f"load of {RANKS} ranks, largest over mean, beyond 1", 0.1,
             lambda one: None if metric(one, "load_max_over_mean") is None else metric(one, "load_max_over_mean") - 1.0),
    Question("bowl_ranks", 50, f"other bits on {RANKS} ranks than on one", 0.0, lambda one: metric(one, "other_bits"), form="number"),
    *conserved("dam_break_building", 4))
