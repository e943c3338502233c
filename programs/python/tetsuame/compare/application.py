"""Plans, runs, reports."""
import sys

from .. import ROOT
from . import cases, options, publish, report, runner, study, table
from .figures import hydrostatic as figures


def main(arguments: list[str]) -> int:
    if arguments and arguments[0] in study.SUBJECTS:
        return study.main(arguments[0], arguments[1:], ROOT)
    chosen = options.parse(arguments, ROOT)
    chosen.output.mkdir(parents=True, exist_ok=True)
    outcomes = runner.run_all(cases.plan(chosen.programs, chosen.inputs, chosen.settings), chosen)

    def write() -> str:
        table.write_csv(outcomes, chosen.output / "table.csv")
        drawn = figures.draw_all(outcomes, chosen.output)
        return report.page(outcomes, drawn, chosen.settings)

    unchanged = publish.page(outcomes, chosen.output, write)
    print(table.terminal(outcomes, sys.stdout.isatty()))
    return publish.close(outcomes, chosen.output, unchanged)
