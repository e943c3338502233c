"""The command line: a command's name, and what that command takes."""
import argparse
import importlib
import sys
from pathlib import Path

from . import BAD_INPUT, COMPLETED
from .reading import Unreadable

# The module of each command: its main takes the rest of the command line and returns the exit status.
MODULES = {"compare": ".compare.study", "bench": ".bench", "balance": ".balance", "scaling": ".scaling.application"}
# These take a folder, and make something of it: what they do, and what the folder is.
OF_A_FOLDER = {"bench": ("Write report.html from bench.json.", "where bench.json is; report.html goes there too"),
               "balance": ("Draw cuts.png and course.png.", "output directory of balance; the pictures go there too")}


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(
        prog="tetsuame", formatter_class=argparse.RawDescriptionHelpFormatter, usage="tetsuame [-h] COMMAND …",
        description="Runs comparisons of the programs, and makes pages and pictures of what they wrote.",
        epilog="commands (each with --help):\n"
               "  compare   run programs on inputs; write a table, figures and report.html\n"
               "  bench     write report.html from the bench.json of a folder\n"
               "  balance   draw the cuts of a run of balance, and their course\n"
               "  scaling   measure program C over ranks and threads; write report.html")
    parser.add_argument("command", metavar="COMMAND", help="one of those below")
    command = parser.parse_args(arguments[:1]).command
    if command not in MODULES:
        print(f"tetsuame: no command '{command}' (there are {', '.join(MODULES)})", file=sys.stderr)
        return BAD_INPUT
    def module():
        """Only the one asked for: matplotlib takes a second."""
        return importlib.import_module(MODULES[command], __package__)

    if command not in OF_A_FOLDER:
        return module().main(arguments[1:])
    about, what = OF_A_FOLDER[command]
    parser = argparse.ArgumentParser(prog=f"tetsuame {command}", description=about)
    parser.add_argument("folder", type=Path, help=what)
    folder = parser.parse_args(arguments[1:]).folder
    try:
        print(module().make(folder))
    except Unreadable as problem:
        print(f"tetsuame {command}: {problem}", file=sys.stderr)
        return BAD_INPUT
    return COMPLETED


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
