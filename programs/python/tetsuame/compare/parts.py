"""What the comparisons' command lines and pages have in common."""
import argparse
from pathlib import Path

from .. import pages
from .cases import SHIPPED_INPUTS
from .outcomes import COMPLETED, CRASHED


def chosen(option: str, what: str, text: str, between: str, known, parser: argparse.ArgumentParser) -> tuple[str, ...]:
    """Names, each once, of those that are known."""
    names = tuple(dict.fromkeys(name.strip() for name in text.split(between) if name.strip()))
    for name in names:
        if name not in known:
            parser.error(f"{option}: no {what} '{name}' (there are {f'{between} '.join(known)})")
    return names


def find_inputs(names: str, root: Path, parser: argparse.ArgumentParser, prefix: str = "",
                known: tuple[str, ...] = SHIPPED_INPUTS) -> list[Path]:
    """Of names with commas between: files as they are, or of the folder inputs."""
    found = []
    for name in filter(None, map(str.strip, names.split(","))):
        paths = [path for path in (Path(name), root / "inputs" / f"{prefix}{name}.nml") if path.is_file()]
        if not paths:
            parser.error(f"--inputs: '{name}' is neither a file nor one of {', '.join(known)}")
        found.append(paths[0].resolve())
    if len({path.stem for path in found}) != len(found):
        parser.error("--inputs: two files of the same name would share one output folder")
    return found


def sizes(given: argparse.Namespace, parser: argparse.ArgumentParser, least: int, usual, quick) -> list[int]:
    """Of --particles, or else the default."""
    found = sorted(set(given.particles or (quick if given.quick else usual)))
    if found[0] < least:
        parser.error(f"--particles: at least {least}, for the kernel reaches some spacings")
    return found


def state_class(outcome: str) -> str:
    return {COMPLETED: "good", CRASHED: "bad"}.get(outcome, "stop")


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
