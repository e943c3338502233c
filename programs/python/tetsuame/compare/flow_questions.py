"""What is asked of water with a free surface: how large an error may be, what came out, whether that is met."""
from collections.abc import Callable
from html import escape

from .. import pages
from . import flow_bodies as bodies
from .flow_question import Question, against, measured_beside, metric
from .outcomes import COMPLETED
from .parts import percent

SEMI_AXIS = {0.0008: 1.0831, 0.0038: 1.4392, 0.0076: 1.9445}  # m at s, of the drop [Monaghan 1994]
IN_METRES = ("dam_break_box", "bowl", "bowl_ranks")  # cases whose n is particles in a metre


def arrival(case: str, n: int, gauge: int, what: str) -> Question:
    name = f"pressure_{gauge}_arrival"
    return Question(case, n, f"{what}: arrival", 0.03, against(name, "_reference"), measured_beside(name, "s"))


def impulse(case: str, n: int, gauge: int, what: str) -> Question:
    name = f"pressure_{gauge}_impulse"
    return Question(case, n, f"{what}: impulse", 0.15, against(name, "_reference"), measured_beside(name, "Pa s", "{:.0f}"))


def depth(gauge: int, n: int, limit: float, until: float = 0.0) -> Question:
    def error(one: dict) -> float | None:
        mean, largest = metric(one, f"height_{gauge}_mean_error"), metric(one, f"height_{gauge}_largest_reference")
        return mean / largest if mean is not None and largest else None
    end = f" until {until:g} s" if until else ""
    return Question("dam_break_box", n, f"depth H{gauge}{end}: mean error over the largest", limit, error, until=until)


def semi_axis(one: dict) -> float | None:
    found = one["semi_axes"] or {}
    errors = [found[str(t)] / b - 1.0 for t, b in SEMI_AXIS.items() if str(t) in found]
    return max(errors, key=abs) if errors else None


def at_rest(case: str, n: int) -> list[Question]:
    def kinetic(when: str) -> Callable[[dict], float | None]:
        return lambda one: (one["kinetic"] or {}).get(when)
    def question(what: str, limit: float, error, form: str = "number") -> Question:
        return Question(case, n, what, limit, error, until=31.93, shorter=True, form=form)  # 100 √(H/g)
    return [question("kinetic energy over m g H at the end", 1e-6, kinetic("end")),
            question("the same at its largest", 1e-6, kinetic("largest")),
            question("pressure beyond 2h of the surface over ρgH", 0.01, lambda one: metric(one, "hydrostatic_error"), "percent"),
            question("mass lost", 0.0, lambda one: one["mass"]),
            question("particles put back at a wall", 0.0, lambda one: metric(one, "particles_put_back"))]


def closed_tank(case: str, n: int, until: float) -> list[Question]:
    return [Question(case, n, "mass lost", 0.0, lambda one: one["mass"], until=until, shorter=True, form="number"),
            Question(case, n, "largest rise of energy over that at the start", 0.0, lambda one: one["rise"],
                     until=until, shorter=True, form="number")]


QUESTIONS = (
    *at_rest("still_wedge", 50), *at_rest("still_wedge_3d", 20), *closed_tank("tilted_tank", 50, 45.5), *closed_tank("stl_tank", 20, 114.0),
    Question("standing_wave", 50, "period", 0.01, against("period", "_theory"), measured_beside("period", "s", "{:.4f}", "_theory")),
    Question("standing_wave", 50, "decay of energy", 0.1, against("energy_decay", "_theory"),
             measured_beside("energy_decay", "1/s", "{:.4f}", "_theory")),
    Question("elliptical_drop", 50, "longer semi-axis at three times", 0.01, semi_axis,
             lambda one: ", ".join(f"{value:.4f}" for value in (one["semi_axes"] or {}).values()) + " m"),
    Question("elliptical_drop", 50, "energy", 0.02, lambda one: one["energy"]),
    Question("dam_break_front", 60, "front: rms over H until the wall", 0.03, lambda one: metric(one, "front_rms_over_height")),
    *(make("dam_break_2d", 60, k, f"sensor {k}") for make in (arrival, impulse) for k in (1, 2)),
    *(make("dam_break_box", 100, k, f"P{k}") for make in (arrival, impulse) for k in (1, 2)),
    depth(2, 100, 0.06), depth(4, 100, 0.06), *(depth(k, 50, 0.1, 4.0) for k in (1, 2, 3, 4)),
    Question("dam_break_box", 50, "particle updates a second, one core", 0.8e6, lambda one: one["updates_per_second"], at_least=True, form="number"),
    *bodies.QUESTIONS)

# Errors over resolution, of those that are no yes or no.
QUANTITIES = {"standing_wave": ("period", "decay of energy"), "elliptical_drop": ("longer semi-axis", "energy"),
              "dam_break_front": ("front",), "dam_break_martin_moyce": ("front",), "dam_break_square_column": ("front",),
              "dam_break_2d": tuple(f"{what} {k}" for what in ("arrival", "impulse") for k in (1, 2, 3, 4)),
              "dam_break_box": tuple(f"{what} P{k}" for what in ("arrival", "impulse") for k in (1, 2)),  # depths: until other times
              "sloshing": ("period", "weight")}


def errors(one: dict) -> dict[str, float | None]:
    case = one["case"]
    if case == "standing_wave":
        return {"period": against("period", "_theory")(one), "decay of energy": against("energy_decay", "_theory")(one)}
    if case == "elliptical_drop":
        return {"longer semi-axis": semi_axis(one), "energy": one["energy"]}
    if case in ("dam_break_front", "dam_break_martin_moyce", "dam_break_square_column"):
        return {"front": metric(one, "front_rms_over_height")}
    if case == "sloshing":
        return {"period": against("slosh_period", "_theory")(one), "weight": against("weight", "_theory")(one)}
    found = {}
    for what in QUANTITIES.get(case, ()):
        kind, _, gauge = what.partition(" ")
        found[what] = against(f"pressure_{gauge.lstrip('P')}_{kind}", "_reference")(one)
    return found


def answered_by(question: Question, runs: list[dict]) -> dict | None:
    """The run with the n asked for, else the finest below it, that comes to the time asked for; it may have failed."""
    fit = [one for one in runs if one["case"] == question.case and one["n"] <= question.n
           and (one["outcome"] != COMPLETED or question.shorter or ends(question, one))]
    return max(fit, key=lambda one: one["n"], default=None)


def ends(question: Question, one: dict) -> bool:
    return (one["time"] or 0.0) >= question.until * (1.0 - 1e-9)


def verdict(question: Question, one: dict | None) -> tuple[str, str]:
    """In words, and the class of its cell."""
    value = question.error(one) if one and one["outcome"] == COMPLETED else None
    if value is None:
        return ("not run" if one is None else one["outcome"] if one["outcome"] != COMPLETED else "not reached"), "stop"
    met = value >= question.limit if question.at_least else abs(value) <= question.limit
    coarser = "" if one["n"] == question.n else f" at {named(question.case, one['n'])}"
    shorter = "" if ends(question, one) else f" until {one['time']:.3g} s"
    return ("met" if met else "missed") + coarser + shorter, "good" if met else "stop"


def named(case: str, n: int) -> str:
    return f"{1000 / n:g} mm" if case in IN_METRES else f"n = {n}"


def asked(question: Question) -> str:
    limit = percent(question.limit).lstrip("+").replace(".00 %", " %") if question.form == "percent" else f"{question.limit:g}"
    return f"{'≥' if question.at_least else '≤'} {limit}" if question.limit else "0"


def came_out(question: Question, one: dict | None) -> str:
    value = question.error(one) if one and one["outcome"] == COMPLETED else None
    if value is None:
        return "–"
    text = percent(value) if question.form == "percent" else f"{value:.2g}"
    return f"{text} ({question.shown(one)})" if question.shown else text


def rows(runs: list[dict]) -> list[tuple[Question, dict | None]]:
    """Of the cases that were run at all."""
    there = {one["case"] for one in runs}
    return [(question, answered_by(question, runs)) for question in QUESTIONS if question.case in there]


def table(runs: list[dict]) -> str:
    def until(one: dict | None) -> str:
        return "" if one is None or one["time"] is None else f"{named(one['case'], one['n'])}, {one['time']:.4g} s"

    return pages.columns(rows(runs), {
        "Case": lambda each: pages.name(each[0].case.replace("_3d", ", 3-D").replace("_", " ")),
        "what": lambda each: pages.cell(escape(each[0].what)),
        "asked": lambda each: pages.cell(f"{asked(each[0])} at {named(each[0].case, each[0].n)}"),
        "measured": lambda each: pages.cell(escape(came_out(*each))),
        "verdict": lambda each: pages.cell(escape(verdict(*each)[0]), verdict(*each)[1]), "run": lambda each: pages.cell(until(each[1]))},
        "wide", lambda each: each[0].case) + pages.small(
            "A run coarser than what is asked, or shorter, says so beside its verdict. ./run compare flow --long has the tank at 10 mm, and at "
            "20 mm until 4 s.")


def lines(runs: list[dict]) -> list[str]:
    """For the terminal."""
    return [f"{'case':<18}{'what':<50}{'asked':>10}  {'measured':<46}verdict"] + [
        f"{question.case:<18}{question.what:<50}{asked(question):>10}  {came_out(question, one):<46}{verdict(question, one)[0]}"
        for question, one in rows(runs)]
