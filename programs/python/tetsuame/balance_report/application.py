"""The command line: the folder of a run of `balance`."""
import argparse
import sys
from pathlib import Path

from .. import BAD_INPUT, COMPLETED
from ..reading import Unreadable
from . import figures, results


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="tetsuame balance", description="Draw cuts.png and course.png.")
    parser.add_argument("folder", type=Path, help="output directory of balance; the pictures go there too")
    folder = parser.parse_args(arguments).folder
    try:
        run = results.read(folder)
    except Unreadable as problem:
        print(f"tetsuame balance: {problem}", file=sys.stderr)
        return BAD_INPUT
    print("Pictures:", *(folder / name for name in figures.draw(run, folder)))
    return COMPLETED
