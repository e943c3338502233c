"""The other comparisons: convection, shocks, metal over silicate. Each subject is a module with

    NAME, TITLE, ABOUT
    add_options(parser), plan(given, root, parser) -> [Run]
    measure(outcomes) -> dict            everything the page says, for results.json
    sections(outcomes, measured, folder) -> [HTML]     with the figures, drawn into the folder
    terminal(outcomes, measured) -> str
"""
import argparse
import json
import math
from pathlib import Path

from .. import pages
from . import convection, options, publish, report, rti, runner, shock
from .cases import Run

SUBJECTS = {module.NAME: module for module in (convection, shock, rti)}


def main(name: str, arguments: list[str], root: Path) -> int:
    subject = SUBJECTS[name]
    parser = argparse.ArgumentParser(prog=f"./run compare {name}", description=subject.ABOUT,
                                     epilog="Exit status: 0 when every run ended as a calculation does (a divergence is a result), "
                                            "1 when a program crashed, 2 for a mistake on this command line.")
    subject.add_options(parser)
    parser.add_argument("--quick", action="store_true", help="fewer and smaller runs")
    options.add_common(parser, root, f"output/compare/{name}")
    given = parser.parse_args(arguments)
    options.check_common(given, parser)
    runs: list[Run] = subject.plan(given, root, parser)
    if not runs:
        parser.error("nothing to run")
    chosen = options.Common(**options.common(given))
    chosen.output.mkdir(parents=True, exist_ok=True)
    outcomes = runner.run_all(runs, chosen)
    measured = subject.measure(outcomes)

    def write() -> str:
        (chosen.output / "results.json").write_text(json.dumps(finite(measured), indent=1, ensure_ascii=False) + "\n")
        for old in chosen.output.glob("*.png"):
            old.unlink()
        parts = [f"<h1>{subject.TITLE}</h1>\n{report.facts(outcomes, chosen.settings)}", report.crashes(outcomes),
                 *subject.sections(outcomes, measured, chosen.output), report.reasons(outcomes),
                 f"<h2>To see it again</h2>\n<pre><code>./run compare {name} "
                 f"{report.escape(' '.join(arguments))}</code></pre>"]
        return pages.document(subject.TITLE, parts)

    unchanged = publish.page(outcomes, chosen.output, write)
    print(subject.terminal(outcomes, measured))
    for outcome in outcomes:
        if outcome.kind == runner.CRASHED:
            print(f"CRASHED: {outcome.case.label} on {outcome.case.file}: {outcome.reason}")
    return publish.close(outcomes, chosen.output, unchanged)


def finite(value):
    """JSON has no numbers that are not finite: they become null."""
    if isinstance(value, dict):
        return {key: finite(one) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
