"""Writes a page only when the runs that it shows, or what writes it, have changed."""
import hashlib
from collections.abc import Callable
from pathlib import Path

from . import runner

PAGE = "report.html"


def page(outcomes: list[runner.Outcome], output: Path, write: Callable[[], str]) -> bool:
    """Whether nothing had to be run. `write` makes the figures and returns the page."""
    mark = fingerprint(outcomes)
    stamp, target = output / "report.stamp", output / PAGE
    unchanged = all(outcome.reused for outcome in outcomes)
    if not (unchanged and target.is_file() and stamp.is_file() and stamp.read_text() == mark):
        stamp.unlink(missing_ok=True)
        target.write_text(write(), encoding="utf-8")
        stamp.write_text(mark)
    return unchanged


def close(outcomes: list[runner.Outcome], output: Path, unchanged: bool) -> int:
    """The last lines on the terminal; the exit status: a crash is none of the results."""
    if unchanged:
        print("Nothing has changed since these runs; --fresh runs them again.")
    print(f"Report: {output / PAGE}")
    return 1 if any(outcome.kind == runner.CRASHED for outcome in outcomes) else 0


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
