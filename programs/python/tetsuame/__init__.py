"""tetsuame: everything around the programs that is written in Python.

    PYTHONPATH=programs/python python3 -m tetsuame COMMAND [--help]

    compare         runs programs on inputs and reports what is seen     bench           the page of `bench`
    balance         the page of a run of `balance`                       scaling         speed over ranks and threads
    reading         files that the programs write                        style, pages    one look for all figures and pages
    gauges          of flow, beside measurements                         scene           water in three dimensions
    starts          particles from arrays as a snapshot to start from
"""
import os
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]  # of the repository
# Where the programs are: built, or installed beside this package.
PROGRAMS = next((folder for folder in (ROOT / "build/programs", Path(__file__).resolve().parents[2]) if (folder / "rti").exists()),
                ROOT / "build/programs")

# Where pages go that are given no place; ./run, which may be called in another folder, says where that is.
OUTPUT = Path(os.environ.get("TETSUAME_OUTPUT", "output"))

# Exit statuses, the same as the programs'.
COMPLETED, BAD_INPUT, FAILED, FILE_FAILED = 0, 2, 3, 4


def load(directory):
    """The run in this directory, with its history and snapshots as numpy arrays (tetsuame.runs)."""
    from . import runs

    return runs.Run(directory)


def write_snapshot(path, **particles):
    """Particles from arrays as a file that `&initial file` takes (tetsuame.starts)."""
    from . import starts

    return starts.write_snapshot(path, **particles)
