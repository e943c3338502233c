"""The command line: a command's name, and what that command takes."""
import argparse
import importlib
import os
import signal
import sys
from pathlib import Path

from . import BAD_INPUT, COMPLETED, FAILED, FILE_FAILED, apart
from .reading import Unreadable

# The module of each command: its main takes the rest of the command line and returns the exit status.
MODULES = {"compare": ".compare.study", "bench": ".bench", "balance": ".balance", "scaling": ".scaling.application",
           "plot": ".plots", "movie": ".movie", "view": ".view", "paraview": ".paraview", "sweep": ".sweep",
           "building": ".building", "eos": ".equation"}
CALLED = {"scaling": "bench --scaling"}  # as people start it
OF_SNAPSHOTS = ("plot", "movie", "view", "paraview", "compare")  # which read HDF5
# These take a folder, and make something of it: what they do, and what the folder is.
OF_A_FOLDER = {"bench": ("Write report.html from bench.json.", "where bench.json is; report.html goes there too"),
               "balance": ("Write report.html, cuts.png and course.png.", "output directory of balance; they go there too"),
               "eos": ("Draw an equation of state: eos.png.", "--output of plan eos; the picture goes there too")}


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(
        prog="tetsuame", formatter_class=argparse.RawDescriptionHelpFormatter, usage="tetsuame [-h] COMMAND …",
        description="Runs comparisons of the programs, and makes pages and pictures of what they wrote.",
        epilog="commands (each with --help):\n"
               "  plot      draw a run: its history, maps and profiles of its fields\n"
               "  movie     a run's snapshots as MP4 or GIF\n"
               "  view      one HTML file that plays a run in a browser\n"
               "  paraview  a state for ParaView: its particles with colours, ready to play\n"
               "  compare   DIR DIR …: runs side by side; else: run programs on inputs, and report what is seen\n"
               "  sweep     run a program with many settings of one input; write sweep.csv and report.html\n"
               "  bench     write report.html from the bench.json of a folder\n"
               "  balance   write report.html of a run of balance: its cuts, and their course\n"
               "  scaling   measure program C over ranks and threads; write report.html\n"
               "  building  write a building of columns and floors as an STL surface, for flow\n"
               "  eos       draw an equation of state from what plan eos wrote")
    parser.add_argument("command", metavar="COMMAND", help="one of those below")
    for stream in (sys.stdout, sys.stderr):  # where letters are not those of UTF-8, and for names of files in other letters
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
    command = parser.parse_args(arguments[:1]).command
    try:
        status = run(command, arguments[1:])
        sys.stdout.flush()
        return status
    except Unreadable as problem:
        status, said = problem.status, problem
    except ModuleNotFoundError as problem:
        status, said = BAD_INPUT, f"needs the Python package {problem.name}, which is not here"
    except KeyboardInterrupt:
        status, said = 128 + signal.SIGINT, "interrupted"
    except MemoryError:
        status, said = FAILED, "the memory is not enough"
    except OSError as problem:
        status, said = FILE_FAILED, f"{problem.filename or 'what is said here'}: {problem.strerror}"
        if not problem.filename:  # what is left of it is not to fail once more at the exit
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    print(f"{CALLED.get(command, f'tetsuame {command}')}: {said}", file=sys.stderr)
    return status


def run(command: str, arguments: list[str]) -> int:
    """Imports only the module asked for: matplotlib takes a second."""
    if command not in MODULES:
        print(f"tetsuame: no command '{command}' (there are {', '.join(MODULES)})", file=sys.stderr)
        return BAD_INPUT
    if command not in OF_A_FOLDER:
        of_folders = command == "compare" and is_folder(arguments[:1])
        return importlib.import_module(".across" if of_folders else MODULES[command], __package__).main(arguments)
    about, what = OF_A_FOLDER[command]
    parser = argparse.ArgumentParser(prog=f"tetsuame {command}", description=about)
    parser.add_argument("folder", type=Path, help=what)
    folder = parser.parse_args(arguments).folder
    print(importlib.import_module(MODULES[command], __package__).make(folder))
    return COMPLETED


def is_folder(first: list[str]) -> bool:
    """What `compare` begins with: a run's folder, or a study's name, which a folder may have too."""
    return bool(first) and ("/" in first[0] or first[0].startswith(".") or Path(first[0], "resolved.nml").exists())


def entry() -> int:
    """The command `tetsuame` that pip installs."""
    command, *_ = sys.argv[1:] or [""]
    if command in OF_SNAPSHOTS:
        return apart.run(lambda: main(sys.argv[1:]), command)
    return main(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(entry())
