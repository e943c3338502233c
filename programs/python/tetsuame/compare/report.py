"""The parts that all comparisons' pages have."""
import platform
from html import escape
from pathlib import Path

from .. import pages, style
from .runner import COMPLETED, CRASHED, Outcome, terminal_of


def drawn(figure, path: Path, text: str) -> str:
    """The figure, which is written to a file, as a block of the page; nothing where there is none."""
    if figure is None:
        return ""
    style.save(figure, path)
    return pages.figure(path.read_bytes(), text)


def state_class(outcome: str) -> str:
    return {COMPLETED: "good", CRASHED: "bad"}.get(outcome, "stop")


def facts(outcomes: list[Outcome], settings: tuple[str, ...]) -> list[str]:
    versions = sorted({str(o.summary["version"]) for o in outcomes if o.summary.get("version")})
    counts = [f"{sum(o.kind == kind for o in outcomes)} {word}" for kind, word in
              ((COMPLETED, "completed"), ("stopped", "stopped by their own checks"), (CRASHED, "crashed"))
              if any(o.kind == kind for o in outcomes)]
    return [f"version {', '.join(versions)}" if versions else "", f"{len(outcomes)} runs: {', '.join(counts)}", platform.machine(),
            f"settings: {escape(', '.join(settings))}" if settings else ""]


def crashes(outcomes: list[Outcome]) -> str:
    return "\n".join(pages.paragraph(f"Crashed: {escape(o.case.label)} on file {escape(o.case.file)}: {escape(o.reason)}. "
                                     "This is a fault of the program, not a result.", "bad") for o in outcomes if o.kind == CRASHED)


def reasons(outcomes: list[Outcome]) -> str:
    """What the runs that stopped said, once for those that said the same."""
    said: dict[str, list[str]] = {}
    for outcome in outcomes:
        if outcome.kind not in (COMPLETED, CRASHED):
            said.setdefault(outcome.reason, []).append(f"{outcome.case.label} on {outcome.case.file}")
    items = [f"{escape('; '.join(names))}: <code>{escape(reason)}</code>" for reason, names in said.items()]
    return pages.section("What the programs said when they stopped", pages.listed(items, "small")) if items else ""


def crash_lines(outcomes: list[Outcome]) -> list[str]:
    """For the terminal."""
    return [line for o in outcomes if o.kind == CRASHED
            for line in (f"CRASHED: {o.case.label} on file {o.case.file}: {o.reason}",
                         f"         what it said: {terminal_of(o.folder)}" if terminal_of(o.folder).is_file() else "") if line]


def error_cell(value: float | None) -> str:
    """A relative error in percent, coloured by its size."""
    return pages.error(value, percent(value))


def said(value: float | None, form: str = "{:.3g}") -> str:
    return "–" if value is None else form.format(value)


def percent(value: float | None) -> str:
    shown = said(value and 100 * value, "{:+.2f} %").replace("-", "−")
    return "0.00 %" if shown[1:] == "0.00 %" else shown


def count(value: float | None) -> str:
    return said(value, "{:,.0f}").replace(",", " ")
