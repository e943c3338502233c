"""The comparisons: programs A to F, and the subjects below. Each subject is a module with

    NAME, TITLE, ABOUT                   of the command line and the page's head
    PROGRAMS                             that it runs
    add_options(parser), plan(given, root, parser) -> [Run]
    row(outcome, outcomes) -> dict or None, judged(row) -> {quantity: (error, uncertainty)}      for results.json, and the orders fitted
    sections(outcomes, measured, folder) -> [HTML]     with the figures, drawn into the folder
    terminal(outcomes, measured) -> [lines]
"""
import argparse
import hashlib
import json
import math
import os
import platform
from html import escape
from pathlib import Path

from .. import OUTPUT, ROOT, pages, writing
from ..reading import beside
from . import (balance_study, conduction, continuity_of_y, convection, flow, godunov_in_earnest, granular, gravity_density, hydrostatic, letters, orders,
               precision, relaxation_map, rti, runner, shock, slides_convection, slowed_overturn, table, time_stepping)
from .outcomes import COMPLETED, CRASHED, Outcome

SUBJECTS = {module.NAME: module for module in (
    hydrostatic, conduction, convection, shock, rti, continuity_of_y, slowed_overturn, gravity_density, relaxation_map, slides_convection,
    time_stepping, balance_study, godunov_in_earnest, flow, precision, granular)}


def options(name: str, subject) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog=f"./run compare {name}".strip(), description=subject.ABOUT if name else about_all(subject),
                                     formatter_class=argparse.HelpFormatter if name else argparse.RawDescriptionHelpFormatter,
                                     epilog="Exit status: 0 when every run ended as a calculation does (a divergence is a result),\n"
                                            "1 when a program crashed, 2 for a mistake on this command line.")
    subject.add_options(parser)
    if name:
        parser.add_argument("--quick", action="store_true", help="fewer and smaller runs")
    else:
        parser.add_argument("--all", action="store_true", help="this and all other comparisons, their runs in one queue (with --quick: smaller)")
    common_options(parser, str(OUTPUT / "compare" / name))
    return parser


def about_all(subject) -> str:
    """Of programs A to F, and the names of the other comparisons."""
    width = max(map(len, SUBJECTS)) + 2
    others = [f"  {name:<{width}}{module.TITLE}" for name, module in SUBJECTS.items()]
    return "\n".join([subject.ABOUT, "", "Other comparisons, ./run compare NAME (each with --help); all of them: ./run compare --all", *others])


def common_options(parser: argparse.ArgumentParser, output: str) -> None:
    parser.add_argument("--output", default=output, metavar="DIR", type=Path, help="where report.html goes (default: %(default)s)")
    parser.add_argument("--jobs", default=len(os.sched_getaffinity(0)), type=int, metavar="N",
                        help="programs at a time, one thread each (default: the number of cores, %(default)s)")
    parser.add_argument("--set", dest="settings", action="append", default=[], metavar="GROUP.KEY=VALUE",
                        help="a setting for every run; may be repeated")
    parser.add_argument("--binaries", default=ROOT / "build" / "programs", metavar="DIR", type=Path,
                        help="folder of the programs (default: build/programs)")
    parser.add_argument("--time-limit", default=3600.0, type=float, metavar="S",
                        help="seconds after which a run counts as crashed (default: %(default)g)")
    parser.add_argument("--fresh", action="store_true",
                        help="run again also what has not changed since the last report")


def main(arguments: list[str]) -> int:
    if arguments[:1] == ["--needs"]:  # for ./run, before it builds
        print(*needed(arguments[1:]))
        return 0
    if "--all" in arguments:
        return everything([word for word in arguments if word != "--all"])
    name, arguments = (arguments[0], arguments[1:]) if arguments and arguments[0] in SUBJECTS else ("", arguments)
    one = Comparison(name, arguments)
    outcomes = runner.run_all([(run, one.given) for run in one.runs])
    one.report(outcomes)
    return status(outcomes)


def everything(arguments: list[str]) -> int:
    """All subjects, their runs in one queue: each gets the options of this command line, and a folder of its own."""
    parser = argparse.ArgumentParser(prog="./run compare --all", description="All comparisons, each into a folder of its own, its page last.")
    parser.add_argument("--quick", action="store_true", help="fewer and smaller runs")
    common_options(parser, str(OUTPUT / "compare"))
    output = parser.parse_args(arguments).output
    comparisons = []
    for name in ("", *SUBJECTS):
        own = [word for word in arguments if name or word != "--quick"]
        comparisons.append(Comparison(name, [*own, "--output", str(output / name if name else output)]))
    outcomes = runner.run_all([(run, one.given) for one in comparisons for run in one.runs])
    first = 0
    for one in comparisons:
        one.report(outcomes[first:first + len(one.runs)])
        first += len(one.runs)
    return status(outcomes)


def needed(arguments: list[str]) -> list[str]:
    """The programs that a command line runs; none if it only asks for help."""
    if {"-h", "--help"} & set(arguments):
        return []
    names = SUBJECTS if "--all" in arguments else [name for name in arguments[:1] if name in SUBJECTS]
    modules = [SUBJECTS[name] for name in names]
    if "--all" in arguments or not modules:
        modules.append(letters)
    return sorted({program for module in modules for program in module.PROGRAMS})


def status(outcomes: list[Outcome]) -> int:
    return 1 if any(outcome.kind == CRASHED for outcome in outcomes) else 0  # a crash is none of the results


class Comparison:
    """A subject with what was given on its command line: its runs, and its page."""

    def __init__(self, name: str, arguments: list[str]):
        """name: '': programs A to F on the note's inputs"""
        self.name, self.arguments, self.subject = name, arguments, SUBJECTS.get(name, letters)
        self.parser = parser = options(name, self.subject)
        self.given = given = parser.parse_args(arguments)
        if given.jobs < 1:
            parser.error("--jobs: needs at least 1")
        for setting in given.settings:
            group, _, rest = setting.partition(".")
            if not group or "=" not in rest:
                parser.error(f"--set: '{setting}' is not of the form group.key=value")
        self.runs = self.subject.plan(given, ROOT, parser)
        if not self.runs:
            parser.error("nothing to run")
        writing.folder(given.output)

    def report(self, outcomes: list[Outcome]) -> None:
        """Writes the page only when the runs that it shows, or what writes it, have changed."""
        subject, given = self.subject, self.given
        measured = None
        if self.name:
            runs = [common(one) | own for one in outcomes if (own := subject.row(one, outcomes)) is not None]
            measured = {"study": self.name, "runs": runs, "orders": orders.entries(runs, subject.judged)}
        mark, stamp, target = fingerprint(outcomes), given.output / "report.stamp", given.output / "report.html"
        unchanged = all(outcome.reused for outcome in outcomes)
        if not (unchanged and target.is_file() and stamp.is_file() and stamp.read_text() == mark):
            stamp.unlink(missing_ok=True)
            again = self.arguments if self.name else [word for setting in given.settings for word in ("--set", setting)]
            writing.text(target, page(subject, outcomes, measured, given, " ".join([self.parser.prog, *again])))
            writing.text(stamp, mark)
        print("\n".join(subject.terminal(outcomes, measured) + crash_lines(outcomes)))
        if unchanged:
            print("Nothing has changed since these runs; --fresh runs them again.")
        print(f"Report: {target}")


def common(outcome: Outcome) -> dict:
    """What results.json has of every run."""
    return {"case": outcome.case.file, "variant": outcome.case.variant, "n": outcome.case.n, "outcome": table.verdict(outcome),
            "reason": outcome.reason or None, "right_hand_sides": outcome.number("rhs_evaluations"),
            "seconds": outcome.number("stepping_seconds") or outcome.number("wall_seconds"),
            "updates_per_second": outcome.number("particle_updates_per_second")}


def page(subject, outcomes: list[Outcome], measured: dict | None, given: argparse.Namespace, again: str) -> str:
    if measured is not None:
        writing.text(given.output / "results.json", json.dumps(finite(measured), indent=1, ensure_ascii=False) + "\n")
    for old in given.output.glob("*.png"):
        old.unlink()
    parts = [pages.head(subject.TITLE, facts(outcomes, given.settings), getattr(subject, "INTRODUCTION", "")), crashes(outcomes),
             *subject.sections(outcomes, measured, given.output), reasons(outcomes),
             pages.section("To see it again", pages.commands(again + getattr(subject, "AGAIN", "")))]
    return pages.document(subject.TITLE, parts)


def facts(outcomes: list[Outcome], settings: tuple[str, ...]) -> list[str]:
    versions = sorted({str(o.summary["version"]) for o in outcomes if o.summary.get("version")})
    counts = [f"{sum(o.kind == kind for o in outcomes)} {word}" for kind, word in
              ((COMPLETED, "completed"), ("stopped", "stopped by their own checks"), (CRASHED, "crashed"))
              if any(o.kind == kind for o in outcomes)]
    if doubtful := sum(o.doubtful for o in outcomes):
        counts.append(f"{doubtful} of the completed doubtful")
    return [f"version {', '.join(versions)}" if versions else "", f"{len(outcomes)} runs: {', '.join(counts)}", platform.machine(),
            f"settings: {escape(', '.join(settings))}" if settings else ""]


def crashes(outcomes: list[Outcome]) -> str:
    return "\n".join(pages.paragraph(f"Crashed: {escape(o.case.label)} on file {escape(o.case.file)}: {escape(o.reason)}. "
                                     "This is a fault of the program, not a result.", "bad") for o in outcomes if o.kind == CRASHED)


def crash_lines(outcomes: list[Outcome]) -> list[str]:
    """For the terminal."""
    lines = []
    for o in outcomes:
        if o.kind == CRASHED:
            lines.append(f"CRASHED: {o.case.label} on file {o.case.file}: {o.reason}")
            if (said := beside(o.folder, ".log")).is_file():
                lines.append(f"         what it said: {said}")
    return lines


def reasons(outcomes: list[Outcome]) -> str:
    """What the runs that stopped, or are doubtful, said, once for those that said the same."""
    said: dict[str, list[str]] = {}
    for outcome in outcomes:
        if outcome.doubtful or outcome.kind not in (COMPLETED, CRASHED):
            said.setdefault(outcome.reason, []).append(f"{outcome.case.label} on {outcome.case.file}")
    items = [f"{escape('; '.join(names))}: <code>{escape(reason)}</code>" for reason, names in said.items()]
    return pages.section("What the programs said when they stopped", pages.listed(items, "small")) if items else ""


def fingerprint(outcomes: list[Outcome]) -> str:
    """Changes with the runs that the report shows and with what writes it."""
    digest = hashlib.sha256()
    for outcome in outcomes:
        record = beside(outcome.folder, ".json")
        digest.update(f"{outcome.case.folder} {outcome.kind}".encode())
        digest.update(record.read_bytes() if record.is_file() else b"-")
    for source in sorted(Path(__file__).parents[1].rglob("*")):
        if source.suffix in (".py", ".css"):
            digest.update(source.read_bytes())
    return digest.hexdigest()


def finite(value):
    """JSON has no numbers that are not finite: they become null."""
    if isinstance(value, dict):
        return {key: finite(one) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
