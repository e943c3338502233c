"""The command line of compare."""
import argparse
import os
from dataclasses import dataclass
from pathlib import Path

from .cases import PROGRAMS, SHIPPED_INPUTS


@dataclass(frozen=True)
class Common:
    output: Path
    binaries: Path                 # where the programs lie
    jobs: int                      # programs at a time
    settings: tuple[str, ...]      # group.key=value, for every run
    time_limit: float              # s, for one run
    fresh: bool                    # run again what has not changed


@dataclass(frozen=True)
class Options(Common):
    programs: tuple[str, ...]      # 'A' … 'F'
    inputs: tuple[Path, ...]       # namelists


def parse(arguments: list[str], root: Path) -> Options:
    parser = argparse.ArgumentParser(
        prog="./run compare",
        description="Run the programs A to F on the note's inputs; write a table, figures and report.html. "
                    "Other comparisons: ./run compare convection, shock, rti (each with --help).",
        epilog="Exit status: 0 when every run ended as a calculation does (a divergence is a result), "
               "1 when a program crashed, 2 for a mistake on this command line.")
    parser.add_argument("--programs", default=",".join(PROGRAMS), metavar="A,C,F",
                        help="programs to run (default: all six)")
    parser.add_argument("--inputs", default=",".join(SHIPPED_INPUTS), metavar="NAME,…",
                        help="11, 12, 13, 13_linear, column, or paths of namelists (default: %(default)s)")
    add_common(parser, root, "output/compare")
    given = parser.parse_args(arguments)

    programs = tuple(name.strip().upper() for name in given.programs.split(",") if name.strip())
    for name in programs:
        if name not in PROGRAMS:
            parser.error(f"--programs: no program '{name}' (there are {', '.join(PROGRAMS)})")
    inputs = tuple(find_input(name.strip(), root, parser) for name in given.inputs.split(",") if name.strip())
    if not programs or not inputs:
        parser.error("nothing to run: --programs and --inputs need at least one name each")
    if len({path.stem for path in inputs}) != len(inputs):
        parser.error("--inputs: two files of the same name would share one output folder")
    check_common(given, parser)
    # A program named twice is still run once.
    return Options(**common(given), programs=tuple(dict.fromkeys(programs)), inputs=inputs)


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


def common(given: argparse.Namespace) -> dict:
    return {"output": given.output, "binaries": given.binaries, "jobs": given.jobs, "settings": tuple(given.settings),
            "time_limit": given.time_limit, "fresh": given.fresh}


def find_input(name: str, root: Path, parser: argparse.ArgumentParser, prefix: str = "hydrostatic_",
               known: tuple[str, ...] = SHIPPED_INPUTS) -> Path:
    for path in (Path(name), root / "inputs" / f"{prefix}{name}.nml"):
        if path.is_file():
            return path.resolve()
    parser.error(f"--inputs: '{name}' is neither a file nor one of {', '.join(known)}")
