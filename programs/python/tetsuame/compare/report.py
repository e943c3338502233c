"""The HTML page of programs A to F, and the parts that all comparisons' pages have."""
import platform
import time
from html import escape
from pathlib import Path

from .. import pages, style
from . import note, prose
from .cases import ITERATING
from .figures.hydrostatic import Figure
from .results import cost_per_step, resolved_text, wall_share
from .runner import COMPLETED, CRASHED, Outcome
from .table import (agreement, agreement_in_place, cell, entry_of, error, files, labels, note_says, place,
                    verdict)


def page(outcomes: list[Outcome], drawn: list[Figure], settings: tuple[str, ...]) -> str:
    parts = [head(outcomes, settings), crashes(outcomes), overview(outcomes), beside_the_note(outcomes),
             section("Why the plain iteration diverges", prose.iteration(outcomes)),
             images(drawn, "residual", "Residual of the iteration by pass. Plain runs are shown in the evaluation that "
                    "diverged (×: last value), the others in the one with most passes. Broad grey: the growth "
                    "|G| = (κ − 1)(1 − S_min) from the first residual."),
             section("A limit that no solver removes", prose.limit(outcomes)),
             section("What the walls do", prose.walls(outcomes)),
             images(drawn, "pressure", "Relative pressure error of the last snapshot, mean over each row of particles. "
                    "Runs that stopped are not shown; A and B are shown with the first solver that completes."),
             images(drawn, "displacement", "File {file}: displacement from the start, which should be zero. "
                    "Colour: its size on one scale for all; arrows: its direction, the longest of each map drawn "
                    "equally long, none where it is round-off; grey: wall particles."),
             section("What it costs", prose.cost(outcomes)),
             images(drawn, "cost", "Time a step by stage; A and B with the first solver that completes."),
             all_runs(outcomes), how_to(settings)]
    return pages.document("programs A to F compared", parts)


def section(title: str, paragraphs: list[str]) -> str:
    return f"<h2>{title}</h2>\n" + "\n".join(f"<p>{text}</p>" for text in paragraphs)


# Displacement maps that show what file 13's show, only smaller or alike: folded when others are there.
FOLDED = {"11", "12", "13_linear"}


def images(drawn: list[Figure], kind: str, caption: str) -> str:
    chosen = [figure for figure in drawn if figure.kind == kind]
    fold = not all(figure.file in FOLDED for figure in chosen)
    return "\n".join(image(figure, caption, fold and figure.file in FOLDED) for figure in chosen)


def image(figure: Figure, caption: str, folded: bool) -> str:
    block = pages.figure(figure.path.read_bytes(), caption.format(file=escape(figure.file)))
    if not folded:
        return block
    return f"<details><summary>Displacement, file {escape(figure.file)}</summary>\n{block}</details>"


def drawn(figure, path: Path, text: str) -> str:
    """The figure, which is written to a file, as a block of the page; nothing where there is none."""
    if figure is None:
        return ""
    style.save(figure, path)
    return pages.figure(path.read_bytes(), text)


def head(outcomes: list[Outcome], settings: tuple[str, ...]) -> str:
    return ("<h1>Programs A to F on hydrostatic states</h1>\n"
            f"{facts(outcomes, settings)}"
            "<p>Six ways to find the volumes and the pressure gradient in DISPH, on states in which nothing should "
            "move. What moves, or departs from the known pressure, is error.</p>")


def facts(outcomes: list[Outcome], settings: tuple[str, ...]) -> str:
    versions = sorted({str(o.summary["version"]) for o in outcomes if o.summary.get("version")})
    counts = [f"{sum(o.kind == kind for o in outcomes)} {word}" for kind, word in
              ((COMPLETED, "completed"), ("stopped", "stopped by their own checks"), (CRASHED, "crashed"))
              if any(o.kind == kind for o in outcomes)]
    said = [time.strftime("%Y-%m-%d %H:%M"), f"version {', '.join(versions)}" if versions else "",
             f"{len(outcomes)} runs: {', '.join(counts)}", platform.machine(),
             f"settings: {escape(', '.join(settings))}" if settings else ""]
    return f"<p class=\"facts\">{' · '.join(one for one in said if one)}</p>\n"


def crashes(outcomes: list[Outcome]) -> str:
    return "\n".join(f"<p class=\"bad\">Crashed: {escape(o.case.label)} on file {escape(o.case.file)}: {escape(o.reason)}. "
                     f"This is a fault of the program, not a result.</p>" for o in outcomes if o.kind == CRASHED)


def state_class(outcome: Outcome) -> str:
    return {COMPLETED: "good", CRASHED: "bad"}.get(outcome.kind, "stop")


def program_cell(label: str) -> str:
    return f"<td class=\"name\"><span class=\"key\" style=\"background:{style.COLOUR[label[0]]}\"></span>{escape(label)}</td>"


def overview(outcomes: list[Outcome]) -> str:
    by_place = {(o.case.label, o.case.file): o for o in outcomes}
    columns, rows = files(outcomes), []
    for label in labels(outcomes):
        described = note.TABLE_1[label[0]]
        method = "" if "(" in label else ", ".join(
            part for part in (described.volume, f"walls {described.wall}", described.gradient, described.remark) if part)
        row = program_cell(label) + f"<td>{method}</td>"
        for name in columns:
            outcome = by_place.get((label, name))
            kind = f" {state_class(outcome)}" if outcome else ""
            row += f"<td class=\"number{kind}\">{escape(cell(outcome))}</td>"
        rows.append(f"<tr>{row}</tr>")
    return ("<h2>At a glance</h2>\n"
            + pages.table(["Program", "Method", *(f"File {escape(name)}" for name in columns)], rows,
                    numbers=frozenset(range(2, 2 + len(columns))))
            + "\n<p class=\"small\">Green: completed, with the mean of |p − p_ref|/p_ref at the end. Yellow: stopped by the program's "
            "own checks, with step/iteration. Red: the program crashed.</p>")


def beside_the_note(outcomes: list[Outcome]) -> str:
    ours = [outcome for outcome in outcomes if entry_of(outcome) is not None]
    if not ours:
        return ""
    rows, last_file = [], None
    for outcome in ours:
        rows.append(row_beside_the_note(outcome, outcome.case.file != last_file))
        last_file = outcome.case.file
    return ("<h2>Table 2 of the note, beside ours</h2>\n"
            + pages.table(["Program", "File", "Δt (s)", "p (Pa)", "Iteration", "The note", "These runs", "same outcome",
                           "same step and iteration", "mean pressure error", "max displacement/Δx"], rows, "wide",
                          numbers=frozenset({2, 3, 9, 10}))
            + f"\n<p class=\"small\">Source: {note.SOURCE}, table 2, with the note's Δt and p; {note.STEPS} steps, {note.TEMPERATURE} K. "
            "The note gives no figures for the errors but “1 % without boundary correction, 0.1 % or less with it”. The files' "
            "names are the note's. Iteration: the solver and the tolerance of these runs.</p>\n"
            + "\n".join(f"<p>{text}</p>" for text in prose.beside_the_note(ours)))


def row_beside_the_note(outcome: Outcome, first_of_file: bool) -> str:
    entry = entry_of(outcome)
    said = verdict(outcome)
    ours = "completes" if outcome.kind == COMPLETED else \
        f"{'diverges' if said == 'diverged' else said}{', ' + place(outcome) if place(outcome) else ''}"
    return (f"<tr{' class=' + chr(34) + 'first' + chr(34) if first_of_file else ''}>{program_cell(outcome.case.program)}"
            f"<td>{escape(outcome.case.file)}</td>"
            f"<td class=\"number\">{entry.dt}</td><td class=\"number\">{entry.pressure}</td><td>{escape(iteration_of(outcome))}</td>"
            f"<td>{note_says(outcome)}</td><td class=\"{state_class(outcome)}\">{escape(ours)}</td>"
            f"<td>{agreement(outcome)}</td><td>{agreement_in_place(outcome) or ''}</td>"
            f"<td class=\"number\">{scientific(error(outcome, 'pressure_mean'))}</td>"
            f"<td class=\"number\">{scientific(error(outcome, 'displacement_max_over_dx'))}</td></tr>")


def iteration_of(outcome: Outcome) -> str:
    """'plain, 1e-12' of a program that iterates."""
    if outcome.case.program not in ITERATING:
        return ""
    try:
        return ", ".join(resolved_text(outcome.folder, "hosono", key) for key in ("solver", "tolerance"))
    except (OSError, KeyError):  # a program that crashed may have left nothing
        return ""


def scientific(value: float | None) -> str:
    return "" if value is None else "0" if value == 0 else f"{value:.1e}"


def all_runs(outcomes: list[Outcome]) -> str:
    rows, last_file = [], None
    for o in outcomes:
        # The time of a step and its shares mean something only over many steps.
        share, cost = (wall_share(o), cost_per_step(o)) if o.kind == COMPLETED else (None, None)
        values = [*(scientific(error(o, name)) for name in
                    ("pressure_mean", "pressure_max", "density_max", "displacement_max_over_dx")),
                  "" if cost is None else f"{1e3 * cost:.2g}", "" if share is None else f"{100 * share:.0f} %"]
        where = f", {place(o)}" if place(o) else ""
        first = " class=\"first\"" if o.case.file != last_file else ""
        last_file = o.case.file
        rows.append(f"<tr{first}><td>{escape(o.case.file)}</td>{program_cell(o.case.label)}"
                    f"<td class=\"{state_class(o)}\">{escape(verdict(o) + where)}</td>"
                    + "".join(f"<td class=\"number\">{value}</td>" for value in values) + "</tr>")
    return ("<h2>All runs</h2>\n"
            + pages.table(["File", "Program", "Outcome", "p error, mean", "p error, max", "ρ error, max",
                     "moved/Δx, max", "ms/step", "walls"], rows, "wide", frozenset(range(3, 9)))
            + "\n<p class=\"small\">Errors are relative; walls: their share of the time. With more columns: table.csv "
            "beside this page; every run's output: the folder runs.</p>" + reasons(outcomes))


def reasons(outcomes: list[Outcome]) -> str:
    """What the runs that stopped said, once for those that said the same."""
    said: dict[str, list[str]] = {}
    for outcome in outcomes:
        if outcome.kind not in (COMPLETED, CRASHED):
            said.setdefault(outcome.reason, []).append(f"{outcome.case.label} on {outcome.case.file}")
    if not said:
        return ""
    items = "\n".join(f"<li>{escape('; '.join(names))}: <code>{escape(reason)}</code></li>"
                      for reason, names in said.items())
    return f"\n<p>What the programs said when they stopped:</p>\n<ul class=\"small\">\n{items}\n</ul>"


def how_to(settings: tuple[str, ...]) -> str:
    extra = "".join(f" --set {escape(setting)}" for setting in settings)
    return ("<h2>To see it again</h2>\n"
            f"<pre><code>./run compare{extra}\n"
            "build/programs/disph_a inputs/hydrostatic_13.nml --set hosono.solver=newton --output output/a_newton</code></pre>")
