"""What the command lines of all comparisons have in common."""
import argparse
import os
from pathlib import Path

from .cases import SHIPPED_INPUTS


def add_common(parser: argparse.ArgumentParser, root: Path, output: str) -> None:
    parser.add_argument("--output", default=output, metavar="DIR", type=Path,
                        help="where report.html goes (default: %(default)s)")
    parser.add_argument("--jobs", default=len(os.sched_getaffinity(0)), type=int, metavar="N",
                        help="programs at a time, one thread each (default: the number of cores, %(default)s)")
    parser.add_argument("--set", dest="settings", action="append", default=[], metavar="GROUP.KEY=VALUE",
                        help="a setting for every run; may be repeated")
    parser.add_argument("--binaries", default=root / "build" / "programs", metavar="DIR", type=Path,
                        help="folder of the programs (default: build/programs)")
    parser.add_argument("--time-limit", default=3600.0, type=float, metavar="S",
                        help="seconds after which a run counts as crashed (default: %(default)g)")
    parser.add_argument("--fresh", action="store_true",
                        help="run again also what has not changed since the last report")


def check_common(given: argparse.Namespace, parser: argparse.ArgumentParser) -> None:
    if given.jobs < 1:
        parser.error("--jobs: needs at least 1")
    for setting in given.settings:
        group, _, rest = setting.partition(".")
        if not group or "=" not in rest:
            parser.error(f"--set: '{setting}' is not of the form group.key=value")


def chosen(option: str, what: str, text: str, between: str, known, parser: argparse.ArgumentParser) -> tuple[str, ...]:
    """Names, each once, of those that are known."""
    names = tuple(dict.fromkeys(name.strip() for name in text.split(between) if name.strip()))
    for name in names:
        if name not in known:
            parser.error(f"{option}: no {what} '{name}' (there are {f'{between} '.join(known)})")
    return names


def find_inputs(names: str | tuple[str, ...], root: Path, parser: argparse.ArgumentParser, prefix: str = "",
                known: tuple[str, ...] = SHIPPED_INPUTS) -> list[Path]:
    """Of names with commas between, or several: files as they are, or of the folder inputs."""
    found = []
    for name in [one.strip() for one in (names.split(",") if isinstance(names, str) else names)]:
        paths = [path for path in (Path(name), root / "inputs" / f"{prefix}{name}.nml") if name and path.is_file()]
        if name and not paths:
            parser.error(f"--inputs: '{name}' is neither a file nor one of {', '.join(known)}")
        found += [path.resolve() for path in paths[:1]]
    if len({path.stem for path in found}) != len(found):
        parser.error("--inputs: two files of the same name would share one output folder")
    return found


def sizes(given: argparse.Namespace, parser: argparse.ArgumentParser, least: int, usual, quick) -> list[int]:
    """Of --particles, or else the default."""
    found = sorted(set(given.particles or (quick if given.quick else usual)))
    if found[0] < least:
        parser.error(f"--particles: at least {least}, for the kernel reaches some spacings")
    return found
