"""The command line: a command's name, and what that command takes."""
import argparse
import importlib
import sys

from . import BAD_INPUT

# The package of each command: its application.main takes the rest of the command line and returns the exit status.
PACKAGES = {"compare": "compare", "bench": "bench_report", "balance": "balance_report", "scaling": "scaling"}


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
    if command not in PACKAGES:
        print(f"tetsuame: no command '{command}' (there are {', '.join(PACKAGES)})", file=sys.stderr)
        return BAD_INPUT
    # Only the one asked for: matplotlib takes a second.
    return importlib.import_module(f".{PACKAGES[command]}.application", __package__).main(arguments[1:])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
