"""The comparisons: programs A to F, convection, shocks, metal over silicate. Each subject is a module with

    NAME, TITLE, ABOUT                   of the command line and the page's head
    add_options(parser), plan(given, root, parser) -> [Run]
    row(outcome, outcomes) -> dict or None, judged(row) -> {quantity: (error, uncertainty)}      for results.json, and the orders fitted
    sections(outcomes, measured, folder) -> [HTML]     with the figures, drawn into the folder
    terminal(outcomes, measured) -> [lines]
"""
import argparse
import hashlib
import json
import math
from pathlib import Path

from .. import ROOT, pages
from . import convection, fit, hydrostatic, options, report, results, rti, runner, shock, table

SUBJECTS = {module.NAME: module for module in (convection, shock, rti)}


def main(arguments: list[str]) -> int:
    name, arguments = (arguments[0], arguments[1:]) if arguments and arguments[0] in SUBJECTS else ("", arguments)
    subject = SUBJECTS.get(name, hydrostatic)
    command = f"./run compare {name}".strip()
    parser = argparse.ArgumentParser(prog=command, description=subject.ABOUT,
                                     epilog="Exit status: 0 when every run ended as a calculation does (a divergence is a result), "
                                            "1 when a program crashed, 2 for a mistake on this command line.")
    subject.add_options(parser)
    if name:
        parser.add_argument("--quick", action="store_true", help="fewer and smaller runs")
    options.add_common(parser, ROOT, f"output/compare/{name}".rstrip("/"))
    given = parser.parse_args(arguments)
    options.check_common(given, parser)
    runs = subject.plan(given, ROOT, parser)
    if not runs:
        parser.error("nothing to run")
    given.output.mkdir(parents=True, exist_ok=True)
    outcomes = runner.run_all(runs, given)
    measured = None
    if name:
        runs = [common(one) | own for one in outcomes if (own := subject.row(one, outcomes)) is not None]
        measured = {"study": name, "runs": runs, "orders": fit.orders(runs, subject.judged)}

    # The page is written only when the runs that it shows, or what writes it, have changed.
    mark, stamp, target = fingerprint(outcomes), given.output / "report.stamp", given.output / "report.html"
    unchanged = all(outcome.reused for outcome in outcomes)
    if not (unchanged and target.is_file() and stamp.is_file() and stamp.read_text() == mark):
        stamp.unlink(missing_ok=True)
        again = arguments if name else [word for setting in given.settings for word in ("--set", setting)]
        target.write_text(page(subject, outcomes, measured, given, " ".join([command, *again])), encoding="utf-8")
        stamp.write_text(mark)
    print("\n".join(subject.terminal(outcomes, measured) + report.crash_lines(outcomes)))
    if unchanged:
        print("Nothing has changed since these runs; --fresh runs them again.")
    print(f"Report: {target}")
    return 1 if any(outcome.kind == runner.CRASHED for outcome in outcomes) else 0  # a crash is none of the results


def common(outcome: runner.Outcome) -> dict:
    """What results.json has of every run."""
    return {"case": outcome.case.file, "variant": outcome.case.variant, "n": outcome.case.n, "outcome": table.verdict(outcome),
            "reason": outcome.reason or None, **results.cost(outcome)}


def page(subject, outcomes: list[runner.Outcome], measured: dict | None, given: argparse.Namespace, again: str) -> str:
    if measured is not None:
        (given.output / "results.json").write_text(json.dumps(finite(measured), indent=1, ensure_ascii=False) + "\n")
    for old in given.output.glob("*.png"):
        old.unlink()
    parts = [pages.head(subject.TITLE, report.facts(outcomes, given.settings), getattr(subject, "INTRODUCTION", "")), report.crashes(outcomes),
             *subject.sections(outcomes, measured, given.output), report.reasons(outcomes),
             pages.section("To see it again", pages.commands(again + getattr(subject, "AGAIN", "")))]
    return pages.document(subject.TITLE, parts)


def fingerprint(outcomes: list[runner.Outcome]) -> str:
    """Changes with the runs that the report shows and with what writes it."""
    digest = hashlib.sha256()
    for outcome in outcomes:
        record = runner.record_of(outcome.folder)
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
