"""Plans, runs, reports."""
import hashlib
import sys
from pathlib import Path

from . import cases, figures, options, report, runner, table

ROOT = Path(__file__).resolve().parents[2]


def main(arguments: list[str]) -> int:
    chosen = options.parse(arguments, ROOT)
    chosen.output.mkdir(parents=True, exist_ok=True)
    outcomes = runner.run_all(cases.plan(chosen.programs, chosen.inputs, chosen.settings), chosen)

    mark = fingerprint(outcomes)
    stamp, page = chosen.output / "report.stamp", chosen.output / "report.html"
    unchanged = all(outcome.reused for outcome in outcomes)
    if not (unchanged and page.is_file() and stamp.is_file() and stamp.read_text() == mark):
        stamp.unlink(missing_ok=True)
        table.write_csv(outcomes, chosen.output / "table.csv")
        drawn = figures.draw_all(outcomes, chosen.output)
        page.write_text(report.page(outcomes, drawn, chosen.settings), encoding="utf-8")
        stamp.write_text(mark)

    print(table.terminal(outcomes, sys.stdout.isatty()))
    if unchanged:
        print("Nothing has changed since these runs; --fresh runs them again.")
    print(f"Report: {page}")
    return 1 if any(outcome.kind == runner.CRASHED for outcome in outcomes) else 0


def fingerprint(outcomes: list[runner.Outcome]) -> str:
    """Changes with the runs that the report shows and with what writes it."""
    digest = hashlib.sha256()
    for outcome in outcomes:
        record = runner.record_of(outcome.folder)
        digest.update(f"{outcome.case.folder} {outcome.kind}".encode())
        digest.update(record.read_bytes() if record.is_file() else b"-")
    for source in sorted(Path(__file__).parent.rglob("*")):
        if source.suffix in (".py", ".css"):
            digest.update(source.read_bytes())
    return digest.hexdigest()
