"""The command line: a folder with bench.json."""
import argparse
import sys
from pathlib import Path

from .. import BAD_INPUT, COMPLETED
from ..reading import Unreadable
from . import figures, page, results


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="tetsuame bench", description="Write report.html from bench.json.")
    parser.add_argument("folder", type=Path, help="where bench.json is; report.html goes there too")
    folder = parser.parse_args(arguments).folder
    try:
        measured = results.read(folder / "bench.json")
    except Unreadable as problem:
        print(f"tetsuame bench: {problem}", file=sys.stderr)
        return BAD_INPUT
    target = folder / "report.html"
    target.write_text(page.page(measured, figures.draw_all(measured)), encoding="utf-8")
    print(f"Report: {target}")
    return COMPLETED
