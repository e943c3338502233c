"""Programs A to F on the note's hydrostatic states: a table, figures and a page that explains them."""
import argparse
from html import escape
from pathlib import Path

from .. import pages, style, writing
from ..reading import Unreadable
from . import cases, note, prose, table
from . import letters_figures as figures
from .cases import ITERATING, LETTERS, SHIPPED_INPUTS, Run
from .outcomes import COMPLETED, Outcome
from .parts import chosen, find_inputs, state_class
from .table import agreement, agreement_in_place, cell, entry_of, error, files, labels, note_says, place, said

TITLE = "Programs A to F on hydrostatic states"
ABOUT = "Run the programs A to F on the note's inputs; write a table, figures and report.html."
PROGRAMS = tuple(f"disph_{program.lower()}" for program in LETTERS)
terminal = table.terminal
INTRODUCTION = "Six ways to find the volumes and the pressure gradient in DISPH, on states in which nothing should " \
               "move. What moves, or departs from the known pressure, is error."
AGAIN = "\nbuild/programs/disph_a inputs/hydrostatic_13.nml --set hosono.solver=newton --output output/a_newton"


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--programs", default=",".join(LETTERS), metavar="A,C,F", help="programs to run (default: all six)")
    parser.add_argument("--inputs", default=",".join(SHIPPED_INPUTS), metavar="NAME,…",
                        help="11, 12, 13, 13_linear, column, or paths of namelists (default: %(default)s)")


def plan(given: argparse.Namespace, root: Path, parser: argparse.ArgumentParser) -> list[Run]:
    programs = chosen("--programs", "program", given.programs.upper(), ",", LETTERS, parser)
    inputs = find_inputs(given.inputs, root, parser, "hydrostatic_")
    if not programs or not inputs:
        parser.error("nothing to run: --programs and --inputs need at least one name each")
    return cases.plan(programs, inputs, given.settings)


def sections(outcomes: list[Outcome], _measured: None, folder: Path) -> list[str]:
    writing.table(folder / "table.csv", [table.row(outcome) for outcome in outcomes])
    shown = files(outcomes)
    return [overview(outcomes), beside_the_note(outcomes),
            explained("Why the plain iteration diverges", prose.iteration(outcomes)),
            pages.figure(figures.residual(outcomes, shown), folder / "residual.png",
                         "Residual of the iteration by pass. Plain runs are shown in the evaluation that diverged (×: last value), the others "
                         "in the one with most passes. Broad grey: the growth |G| = (κ − 1)(1 − S_min) from the first residual."),
            explained("A limit that no solver removes", prose.limit(outcomes)),
            explained("What the walls do", prose.walls(outcomes)),
            pages.figure(figures.pressure(outcomes, shown), folder / "pressure.png",
                         "Relative pressure error of the last snapshot, mean over each row of particles. Runs that stopped are not shown; A and B "
                         "are shown with the first solver that completes."),
            displacements(outcomes, folder),
            explained("What it costs", prose.cost(outcomes)),
            pages.figure(figures.cost(outcomes, shown), folder / "cost.png",
                         "Time a step by stage; A and B with the first solver that completes."),
            all_runs(outcomes)]


def explained(title: str, paragraphs: list[str]) -> str:
    return pages.section(title, *map(pages.paragraph, paragraphs))


# Displacement maps that show what file 13's show, only smaller or alike: folded when others are there.
FOLDED = {"11", "12", "13_linear"}


def displacements(outcomes: list[Outcome], folder: Path) -> str:
    text = "File {}: displacement from the start, which should be zero. Colour: its size on one scale for all; arrows: its direction, " \
           "the longest of each map drawn equally long, none where it is round-off; grey: wall particles."
    blocks = {file: pages.figure(figures.displacement(outcomes, file), folder / f"displacement_{file}.png", text.format(escape(file)))
              for file in files(outcomes)}
    fold = any(block and file not in FOLDED for file, block in blocks.items())
    return "\n".join(pages.folded(f"Displacement, file {file}", block) if fold and file in FOLDED else block
                     for file, block in blocks.items() if block)


def program_cell(label: str) -> str:
    return pages.name(label, style.COLOUR[label[0]])


def overview(outcomes: list[Outcome]) -> str:
    by_place = {(o.case.label, o.case.file): o for o in outcomes}

    def result(label: str, file: str) -> str:
        outcome = by_place.get((label, file))
        if outcome is None:
            return pages.cell("")
        value = error(outcome, "pressure_mean")
        return pages.cell(escape(cell(outcome)), f"number {state_class(outcome.kind)}") if value is None else \
            pages.error(value, scientific(value))

    columns = {"Program": program_cell, "Method": lambda label: pages.cell(note.TABLE_1.get(label, ""), "words"),
               **{f"File {escape(file)}": lambda label, file=file: result(label, file) for file in files(outcomes)}}
    return pages.section("At a glance", pages.columns(labels(outcomes), columns),
                         pages.error_key("Completed: mean of |p − p_ref|/p_ref at the end. Stopped by the program's own checks: with "
                                         "step/iteration; no solution: the solver saw before its first pass that no state with p &gt; 0 "
                                         "exists. Red: the program crashed."))


def outcome_cell(outcome: Outcome, said: str) -> str:
    return pages.cell(escape(f"{said}, {where}" if (where := place(outcome)) else said), state_class(outcome.kind))


def error_cell(what: str):
    def made(outcome: Outcome) -> str:
        value = error(outcome, what)
        return pages.error(value, scientific(value))
    return made


def beside_the_note(outcomes: list[Outcome]) -> str:
    ours = [outcome for outcome in outcomes if entry_of(outcome) is not None]
    if not ours:
        return ""
    words = {"completed": "completes", "diverged": "diverges"}
    columns = {"Program": lambda o: program_cell(o.case.program), "File": lambda o: pages.cell(escape(o.case.file)),
               "Δt (s)": lambda o: pages.number(entry_of(o).dt), "p (Pa)": lambda o: pages.number(entry_of(o).pressure),
               "Iteration": lambda o: pages.cell(escape(iteration_of(o))), "The note": lambda o: pages.cell(note_says(o)),
               "These runs": lambda o: outcome_cell(o, words.get(said(o), said(o))),
               "same outcome": lambda o: pages.cell(agreement(o)), "same step and iteration": lambda o: pages.cell(agreement_in_place(o) or ""),
               "mean pressure error": error_cell("pressure_mean"), "max displacement/Δx": error_cell("displacement_max_over_dx")}
    return pages.section(
        "Table 2 of the note, beside ours", pages.columns(ours, columns, "wide", lambda o: o.case.file),
        pages.small(f"Source: {note.SOURCE}, table 2, with the note's Δt and p; {note.STEPS} steps, {note.TEMPERATURE} K. "
        "The note gives no figures for the errors but “1 % without boundary correction, 0.1 % or less with it”. The files' "
        "names are the note's. Iteration: the solver and the tolerance of these runs."),
        *map(pages.paragraph, prose.beside_the_note(ours)))


def iteration_of(outcome: Outcome) -> str:
    """'plain, 1e-12' of a program that iterates."""
    if outcome.case.program not in ITERATING:
        return ""
    try:
        return ", ".join(outcome.resolved(f"hosono.{key}") for key in ("solver", "tolerance"))
    except (Unreadable, KeyError):  # a program that crashed may have left nothing
        return ""


def scientific(value: float | None) -> str:
    return "" if value is None else "0" if value == 0 else f"{value:.1e}"


def all_runs(outcomes: list[Outcome]) -> str:
    def of_completed(text):
        """The time of a step and its shares mean something only over many steps."""
        return lambda o: pages.number(text(o) if o.kind == COMPLETED else "")

    columns = {"File": lambda o: pages.cell(escape(o.case.file)), "Program": lambda o: program_cell(o.case.label),
               "Outcome": lambda o: outcome_cell(o, said(o)),
               "p error, mean": error_cell("pressure_mean"), "p error, max": error_cell("pressure_max"),
               "ρ error, max": error_cell("density_max"), "moved/Δx, max": error_cell("displacement_max_over_dx"),
               "ms/step": of_completed(lambda o: f"{1e3 * cost:.2g}" if (cost := o.cost_per_step) else ""),
               "walls": of_completed(lambda o: "" if (share := o.wall_share) is None else f"{100 * share:.0f} %")}
    return pages.section("All runs", pages.columns(outcomes, columns, "wide", lambda o: o.case.file),
                         pages.error_key("Errors are relative; walls: their share of the time. With more columns: table.csv "
                                         "beside this page; every run's output: the folder runs."))
