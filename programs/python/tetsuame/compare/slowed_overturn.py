"""Metal over silicate with slowed sound and inertia: what may be slowed where, and the boxes that the note could not reach."""
import functools
import json
import math
from html import escape
from pathlib import Path

from .. import pages
from . import creeping_overturn
from . import slowed_overturn_figures as figures
from .outcomes import COMPLETED, Outcome
from .parts import count, error_cell, percent, said
from .slowed_overturn_runs import (BOXES, BY_RULE, FALLS, GROWTH, MAP, OVERTURN, POSTER, ROUND, STIFF, STIFFNESS, VISCOSITY, add_options, plan)

NAME = "slowed_overturn"
TITLE = "Metal over silicate with slowed sound and inertia"
ABOUT = ("Run rti with slowed sound and heavier inertia in boxes of 1 to 1500 km: growth against the eigenvalue of the physical liquids, "
         "overturn, and how far each may go.")
PROGRAMS = ("plan", "rti")
__all__ = ["add_options", "plan", "judged", "row", "sections", "terminal"]


# ---- what is measured -------------------------------------------------------------------------------

def settings_of(outcome: Outcome) -> dict[str, float]:
    found = {}
    for setting in outcome.case.settings:
        key, _, value = setting.partition("=")
        try:
            found[key] = float(value)
        except ValueError:
            pass
    return found


def row(outcome: Outcome, _outcomes: list[Outcome]) -> dict:
    given = settings_of(outcome)
    growth, theory, predicted = (outcome.number("metrics", f"growth_rate{end}") for end in ("", "_theory", "_slowed"))
    xi = given.get("rti.xi", 1.0)
    return {"zeta": given.get("rti.zeta", 1.0), "xi_lower": given.get("rti.xi_lower", xi), "xi_upper": given.get("rti.xi_upper", xi),
            "growth_theory": theory, "growth_incompressible": outcome.number("metrics", "growth_rate_incompressible"),
            "growth_error": growth / theory - 1 if growth and theory and outcome.case.file in (GROWTH, MAP, VISCOSITY) else None,
            "predicted": predicted / theory - 1 if predicted and theory else 0.0,
            "falls": [outcome.number("metrics", f"time_of_fall_{fall}") for fall in FALLS], "centroid": outcome.number("metrics", "metal_centroid"),
            "energy_residual": outcome.number("metrics", "energy_residual_max"), "v_rms_max": outcome.number("metrics", "v_rms_max"),
            "density_ratio": [outcome.number("metrics", f"density_ratio_{end}") for end in ("min", "max")],
            "viscosity": given.get("rti.viscosity_lower"), "lost": outcome.number("metrics", "particles_lost"), "steps": outcome.number("steps")}


def judged(_one: dict) -> dict[str, tuple[float, float]]:
    return {}


def gain(answer: dict, one: dict) -> float | None:
    """Of the step, by what is slowed. A stabilised method's is not bound by viscosity."""
    if not answer:
        return None
    sound, viscous = (answer["recommended"][f"step_{key}_as_is_s"] or math.inf for key in ("sound", "viscous"))
    xi = min(one["xi_lower"], one["xi_upper"])
    return (sound**-2 + viscous**-2) ** 0.5 / ((sound * one["zeta"] * xi) ** -2 + (viscous * xi**2) ** -2) ** 0.5


@functools.cache
def creeping_falls() -> tuple[float, ...]:
    """Of half a wave of the box, in units of eta/(Delta_rho g L): from two resolutions to none."""
    coarse, fine = (creeping_overturn.overturn(rows=rows) for rows in (48, 96))
    return tuple((4 * fine.when(float(fall)) - coarse.when(float(fall))) / 3 for fall in FALLS)


def fall_errors(runs: list[dict]):
    """Of the times of fall of a run: against liquids that creep, their density as the growth rate has it; in the note's box against xi to 0."""
    note = BOXES["note's box"]
    falls = {one["variant"]: one["falls"] for one in of(runs, OVERTURN)}
    pair = [falls.get(f"{note.name}{end}", [None] * 3) for end in ("", ", twice ξ")]
    without_inertia = [a and b and a - (b - a) / 3 for a, b in zip(*pair)]

    def errors(one: dict) -> list[float | None]:
        box = BOXES[one["variant"].partition(",")[0]] if one["case"] == OVERTURN else BOXES["1 km"]
        scale = box.unit * (one["growth_incompressible"] or 0.0) / (one["growth_theory"] or 1.0)
        right = without_inertia if box is note else [scale * fall for fall in creeping_falls()]
        return [fall / time - 1 if fall and time else None for fall, time in zip(one["falls"], right)]

    return errors



def of(runs: list[dict], case: str) -> list[dict]:
    return [one for one in runs if one["case"] == case]


# ---- the page ---------------------------------------------------------------------------------------

def sections(outcomes: list[Outcome], measured: dict, folder: Path) -> list[str]:
    runs = measured["runs"]
    plans = json.loads((folder / "plans.json").read_text()) if (folder / "plans.json").is_file() else {"maps": {}}
    maps = {name: answer for name, answer in plans["maps"].items() if answer}
    parts = [pages.paragraph(
        "Sound slowed by ζ: what the pressure departs from that of the column at rest is divided by ζ², so that profile and buoyancy stay. "
        "Inertia is multiplied by ξ². Steps grow by ζξ where sound binds, by ξ² where viscosity does. Two numbers rule how far: the dynamic "
        "pressure over the modulus, Δρ g L/2K, times ζ², and inertia over friction, γρ/(ηk²), times ξ²."),
        pages.section("The boxes", box_table(maps)),
        pages.section("Growth against the physical eigenvalue", growth_table(of(runs, GROWTH), maps))]
    points = of(runs, MAP) + [one for one in of(runs, GROWTH) if one["variant"].endswith("m = 1")]
    parts.append(pages.section(
        "What may be slowed where",
        pages.figure(figures.maps(maps, points), folder / "maps.png",
                     "Error of the growth rate over ζ and ξ, by linear theory: lines of 0.1, 1 (broad) and 10 %, red where growth is too fast, blue and "
                     "broken where it is too slow. Crosses: particles ran there, and were off by so many per cent. Dotted: the notes' rules, 1 % = ζ² Δρ g L/2K and 1 % = ξ² γρ/(ηk²)."),
        map_table(of(runs, MAP))))
    parts.append(pages.section(
        "Too stiff a liquid locks",
        pages.figure(figures.stiffness(of(runs, STIFFNESS), fall_errors(runs)), folder / "stiffness.png",
                     "Times of fall in the box of 1 km against liquids that creep, over the modulus that is left: the arrangement of the particles "
                     "resists in proportion to it."),
        stiffness_table(of(runs, STIFFNESS), fall_errors(runs))))
    parts.append(pages.section("Overturn", overturn_table(of(runs, OVERTURN), fall_errors(runs), maps), pages.small(
        "Reference of the boxes up to 100 km: two liquids that creep, by a stream function and markers, without particles and without inertia, their "
        "density difference scaled by the growth rate; of the note's box: ξ to 0, from the run and one with twice its ξ.")))
    if of(runs, VISCOSITY):
        parts.append(pages.section("Down to what the resolution bears", viscosity_table(of(runs, VISCOSITY))))
    if of(runs, STIFF):
        parts.append(pages.section("Stiff mantles", stiff_table(runs)))
    if of(runs, POSTER):
        parts.append(pages.section("The poster's set-up", poster_table(of(runs, POSTER)), pages.figure(
            figures.poster([o for o in outcomes if o.case.file == POSTER]), folder / "poster.png",
            "Iron bright, silicate dark, at the end; height of the metal's centroid over time.")))
    return parts


def border(answer: dict, axis: str, most: float = 0.01) -> float | None:
    """zeta or xi at which the growth rate is off by so much, the other one 1: errors go as the square."""
    lines = answer["map"]["error"]
    errors = [abs(error) for error in ([line[0] for line in lines] if axis == "zeta" else lines[0])]
    values = answer["map"][axis]
    for k in range(1, len(errors)):
        if errors[k] >= most:
            low, high = values[k - 1] ** 2, values[k] ** 2
            return math.sqrt(low + (high - low) * (most - errors[k - 1]) / (errors[k] - errors[k - 1]))
    return None


def box_table(maps: dict) -> str:
    def recommended(key: str, form: str = "{:.3g}"):
        return lambda name: pages.number(said(maps[name]["recommended"].get(key), form))

    return pages.columns(list(maps), {
        "Box": pages.name, "η, Pa s": lambda name: pages.number(f"{BOXES[name].viscosity:.0e}"),
        "Δρ g L/2K": lambda name: pages.number(f"{maps[name]['numbers']['dynamic_pressure']:.1e}"),
        "γρ/(ηk²), silicate": lambda name: pages.number(f"{maps[name]['numbers']['inertia_share_lower']:.1e}"),
        **{f"{sign} of 1 %": lambda name, axis=axis: pages.number(said(border(maps[name], axis))) for sign, axis in (("ζ", "zeta"), ("ξ", "xi"))},
        "ζ": recommended("zeta"), "ξ": recommended("xi"), "steps cut by": recommended("gain", "{:.0f}")}) + pages.small(
            f"ζ of 1 %, ξ of 1 %: where each by itself puts the growth rate off by 1 %. ζ, ξ: as plan relaxation recommends them for "
            f"{100 * BY_RULE:g} % by both (explicit steps, n = 24, one wave).")


def steps_cut(one: dict, maps: dict) -> str:
    answer = maps.get(one["variant"].partition(",")[0])
    return pages.number(said(gain(answer, one) if answer else None, "{:.0f}"))


def slowing_columns() -> dict:
    return {"ζ": lambda one: pages.number(f"{one['zeta']:.3g}"), "ξ": lambda one: pages.number(f"{one['xi_lower']:.3g}")}


def growth_table(runs: list[dict], maps: dict) -> str:
    return pages.columns(runs, {
        "Box": lambda one: pages.name(one["variant"]), "n": lambda one: pages.number(one["n"]), **slowing_columns(),
        "steps cut by": lambda one: steps_cut(one, maps), "physical γ, 1/s": lambda one: pages.number(said(one["growth_theory"], "{:.4e}")),
        "error by slowing, theory": lambda one: error_cell(one["predicted"]), "error, measured": lambda one: error_cell(one["growth_error"]),
        **cost_columns()}) + pages.error_key()


def map_table(runs: list[dict]) -> str:
    return pages.columns(runs, {
        "Point": lambda one: pages.name(one["variant"]), **slowing_columns(), "theory": lambda one: error_cell(one["predicted"]),
        "particles": lambda one: error_cell(one["growth_error"]),
        "difference": lambda one: error_cell(None if one["growth_error"] is None else one["growth_error"] - one["predicted"])}) if runs else ""


def fall_columns(errors) -> dict:
    return {f"fall of {fall} L": lambda one, k=k: error_cell(errors(one)[k]) for k, fall in enumerate(FALLS)}


def state_columns() -> dict:
    return {"⟨y⟩/L at the end": lambda one: pages.number(said(one["centroid"], "{:.3f}")),
            "ρ/ρ_start": lambda one: pages.number(" to ".join(said(end, "{:.2f}") for end in one["density_ratio"])),
            "energy residual": lambda one: pages.number(said(one["energy_residual"], "{:.0e}")),
            **cost_columns()}


def cost_columns() -> dict:
    return {"right-hand sides": lambda one: pages.number(count(one["right_hand_sides"])), "s": lambda one: pages.number(said(one["seconds"]))}


def fall_times(unit=lambda one: 1.0, mark: str = "") -> dict:
    """unit: s, of a run"""
    return {f"fall of {fall} L{mark}": lambda one, k=k: pages.number(said(one["falls"][k] and one["falls"][k] / unit(one), "{:.4g}"))
            for k, fall in enumerate(FALLS)}


def stiffness_table(runs: list[dict], errors) -> str:
    return pages.columns(runs, {"Kernel, sound": lambda one: pages.name(one["variant"]), **fall_columns(errors), **state_columns()})


def overturn_table(runs: list[dict], errors, maps: dict) -> str:
    return pages.columns(runs, {"Box": lambda one: pages.name(one["variant"]), **slowing_columns(), "steps cut by": lambda one: steps_cut(one, maps),
                                **fall_columns(errors), **state_columns()}) + pages.error_key()


def viscous_length(one: dict) -> float | None:
    """(η/ργ)^½ of the silicate, in spacings."""
    if not one["growth_theory"]:
        return None
    return (one["viscosity"] / (3000.0 * one["growth_theory"])) ** 0.5 / (ROUND.L / one["n"])


def viscosity_table(runs: list[dict]) -> str:
    return pages.columns(runs, {
        "Box of 10 km": lambda one: pages.name(one["variant"]), "n": lambda one: pages.number(one["n"]), **slowing_columns(),
        "(η/ργ)^½/Δx": lambda one: pages.number(said(viscous_length(one), "{:.2g}")),
        "growth, error": lambda one: error_cell(one["growth_error"]), **fall_times(mark=", s"), **state_columns()})


def stiff_table(runs: list[dict]) -> str:
    note = BOXES["note's box"]
    shown = [one for one in runs if one["case"] == STIFF or (one["case"] == OVERTURN and one["variant"] == note.name)]

    return pages.columns(shown, {"Note's box": lambda one: pages.name(one["variant"]), **slowing_columns(),
                                 "ξ, metal": lambda one: pages.number(f"{one['xi_upper']:.3g}"),
                                 **fall_times(lambda one: note.unit * one["viscosity"] / note.viscosity), **state_columns()}) + pages.small(
        "Times in η/(Δρ g L) with the silicate's η: without inertia they are the same for every viscosity.")


def poster_table(runs: list[dict]) -> str:
    return pages.columns(runs, {"Poster": lambda one: pages.name(one["variant"]), **slowing_columns(),
                                **fall_times(mark=", s"), **state_columns(), "lost": lambda one: pages.number(said(one["lost"], "{:.0f}"))})


def terminal(_outcomes: list[Outcome], measured: dict) -> list[str]:
    runs = measured["runs"]
    errors = fall_errors(runs)
    lines = [f"{'case':<10}{'run':<34}{'n':>4}  {'outcome':<10}{'zeta':>7}{'xi':>9}{'theory':>10}{'growth':>10}  "
             "falls of 0.1, 0.2, 0.3 L"]
    for one in runs:
        known = one["case"] in (OVERTURN, STIFFNESS)
        falls = [percent(error) for error in errors(one)] if known else [said(time, "{:.4g} s") for time in one["falls"]]
        falls = "" if one["case"] in (GROWTH, MAP) else ", ".join(falls)
        lines.append(f"{one['case']:<10}{one['variant']:<34}{one['n']:>4}  {one['outcome']:<10}{one['zeta']:>7.3g}{one['xi_lower']:>9.3g}"
                     f"{percent(one['predicted']):>10}{percent(one['growth_error']):>10}  {falls}")
    return lines
