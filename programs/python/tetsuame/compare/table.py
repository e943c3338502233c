"""The tables: what each run gave, for the terminal and as CSV."""
import re
import sys

from ..reading import Unreadable
from . import note
from .outcomes import COMPLETED, CRASHED, STOPPED, Outcome


def row(outcome: Outcome) -> dict:
    """Of table.csv; None where there is no value."""
    case = outcome.case
    return {"file": case.file, "program": case.program, "variant": case.variant, "outcome": verdict(outcome),
            "step": stopped_step(outcome), "iteration": outcome.number("diverged_iteration"), "reason": outcome.reason or None,
            "note": note_says(outcome), "agrees": agreement(outcome), "agrees_in_place": agreement_in_place(outcome),
            "pressure_error_mean": error(outcome, "pressure_mean"), "pressure_error_max": error(outcome, "pressure_max"),
            "density_error_max": error(outcome, "density_max"),
            "displacement_max_over_dx": error(outcome, "displacement_max_over_dx"), "steps": outcome.number("steps"),
            "seconds_per_step": outcome.cost_per_step, "wall_correction_share": outcome.wall_share,
            **{f"{name}_drift": outcome.number("conservation", name) for name in ("mass", "momentum", "energy")},
            "state_hash": outcome.summary.get("state_hash")}


def error(outcome: Outcome, name: str) -> float | None:
    """An error of a completed run; those of a run that stopped are of a state on its way out."""
    return outcome.number("errors", name) if outcome.kind == COMPLETED else None


def verdict(outcome: Outcome) -> str:
    """'completed', 'diverged', 'failed' (the programs' own words) or 'crashed'."""
    return outcome.kind if outcome.kind in (COMPLETED, CRASHED) else outcome.summary.get("status", "failed")


def said(outcome: Outcome) -> str:
    """As verdict(), for people: a solver that saw before its first pass that there is nothing to find has not diverged."""
    none = outcome.kind == STOPPED and outcome.number("diverged_iteration") == 0
    return "no solution" if none else "doubtful" if outcome.doubtful else verdict(outcome)


def stopped_step(outcome: Outcome) -> int | None:
    """The step in which a calculation stopped; a failure that is no divergence has it in its message."""
    if (step := outcome.number("diverged_step")) is not None:
        return int(step)
    said = re.match(r"step (\d+):", outcome.reason)
    return int(said[1]) if outcome.kind == STOPPED and said else None


def place(outcome: Outcome) -> str:
    """Where a calculation stopped: 'step 1, iteration 2'."""
    # Iteration 0: before the first pass.
    parts = ("step", stopped_step(outcome)), ("iteration", outcome.number("diverged_iteration"))
    return ", ".join(f"{word} {value:g}" for word, value in parts if value)


def entry_of(outcome: Outcome) -> note.Entry | None:
    """What the note's table 2 has for a run with the input as it is."""
    return note.TABLE_2.get((outcome.case.file, outcome.case.program)) if not outcome.case.variant else None


def note_says(outcome: Outcome) -> str | None:
    entry = entry_of(outcome)
    if entry is None:
        return None
    return f"diverges, step {entry.step}, iteration {entry.iteration}" if entry.diverged else "completes"


def agreement(outcome: Outcome) -> str | None:
    """'yes' or 'no' where the note has an entry: whether the run completes as it does there."""
    entry = entry_of(outcome)
    if entry is None:
        return None
    return "yes" if outcome.kind != CRASHED and entry.diverged == (outcome.kind != COMPLETED) else "no"


def agreement_in_place(outcome: Outcome) -> str | None:
    """'yes' or 'no' where the run stopped and the note has it diverge: whether step and iteration are the note's."""
    entry = entry_of(outcome)
    if entry is None or not entry.diverged or outcome.kind != STOPPED:
        return None
    ours = stopped_step(outcome), outcome.number("diverged_iteration")
    return "yes" if ours == (entry.step, entry.iteration) else "no"


def set_otherwise(outcome: Outcome) -> list[str]:
    """What of a run's input is not as in the note's table 2: '&time dt = 0.0001, the note: 1e-3'."""
    entry = entry_of(outcome)
    if entry is None:
        return []
    wanted = (("time", "dt", entry.dt), ("time", "steps", note.STEPS), ("initial", "pressure", entry.pressure),
              ("initial", "temperature", note.TEMPERATURE))
    try:
        return [f"&{group} {key} = {value:g}, the note: {noted}" for group, key, noted in wanted
                if (value := outcome.setting(f"{group}.{key}")) != float(noted)]
    except (Unreadable, KeyError):  # a program that crashed may have left nothing
        return []


def files(outcomes: list[Outcome]) -> list[str]:
    return list(dict.fromkeys(outcome.case.file for outcome in outcomes))


def labels(outcomes: list[Outcome]) -> list[str]:
    """Programs and variants, by program."""
    return sorted(dict.fromkeys(outcome.case.label for outcome in outcomes), key=lambda label: label[0])


def accuracy_order(outcomes: list[Outcome], file: str) -> str | None:
    """C to F by mean pressure error, best first, '=' where two agree to 1 %."""
    errors = sorted((value, outcome.case.program) for outcome in outcomes
                    if outcome.case.file == file and outcome.case.program in "CDEF" and not outcome.case.variant
                    and (value := error(outcome, "pressure_mean")) is not None)
    if len(errors) < 2:
        return None
    text = errors[0][1]
    for (better, _), (worse, program) in zip(errors, errors[1:]):
        text += f" {'=' if worse <= 1.01 * better else '>'} {program}"
    return text


def cell(outcome: Outcome | None) -> str:
    """A run in a few characters: the mean pressure error, or where it stopped."""
    if outcome is None:
        return ""
    if outcome.kind == CRASHED:
        return "CRASHED"
    if outcome.kind != COMPLETED:
        step, iteration = stopped_step(outcome), outcome.number("diverged_iteration")
        where = f" {step}" if step is not None and iteration != 0 else ""
        return said(outcome) + where + (f"/{iteration:g}" if iteration else "")
    if outcome.doubtful:
        return "doubtful"
    value = error(outcome, "pressure_mean")
    return "completed" if value is None else f"{value:.1e}"


def terminal(outcomes: list[Outcome], _measured: None) -> list[str]:
    """Programs down, files across."""
    by_place = {(outcome.case.label, outcome.case.file): outcome for outcome in outcomes}
    columns = files(outcomes)
    lines = ["Mean pressure error |p - p_ref|/p_ref, or where it stopped (step/iteration):", ""]
    lines.append(f"{'program':<23}" + "".join(f"{'file ' + name:>16}" for name in columns))
    for label in labels(outcomes):
        line = f"{label:<23}"
        for name in columns:
            outcome = by_place.get((label, name))
            text = f"{cell(outcome):>16}"
            red = sys.stdout.isatty() and outcome is not None and outcome.kind == CRASHED
            line += f"\033[31m{text}\033[0m" if red else text
        lines.append(line)
    lines.append("")
    for outcome in outcomes:
        if agreement(outcome) == "no" and outcome.kind != CRASHED:
            lines.append(f"Not as in the note: {outcome.case.label} on file {outcome.case.file}: "
                         f"{said(outcome)}; the note: {note_says(outcome)}")
        elif agreement_in_place(outcome) == "no":
            lines.append(f"Not where the note has it: {outcome.case.label} on file {outcome.case.file}: "
                         f"{said(outcome)}, {place(outcome)}; the note: {note_says(outcome)}")
    return lines
