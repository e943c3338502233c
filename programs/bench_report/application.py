"""The command line: a folder with bench.json."""
import argparse
import sys
from pathlib import Path

from . import figures, page, results

BAD_INPUT = 2


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="bench_report", description="Write report.html from bench.json.")
    parser.add_argument("folder", type=Path, help="where bench.json is; report.html goes there too")
    folder = parser.parse_args(arguments).folder
    try:
        measured = results.read(folder / "bench.json")
    except results.Unreadable as problem:
        print(f"bench_report: {problem}", file=sys.stderr)
        return BAD_INPUT
    target = folder / "report.html"
    target.write_text(page.page(measured, figures.draw_all(measured)), encoding="utf-8")
    print(f"Report: {target}")
    return 0
