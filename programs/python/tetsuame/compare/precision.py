"""Each problem of the reports twice, with pairs in double and in single precision: what that changes, beside the method's own error."""
import argparse
import math
from dataclasses import dataclass, fields
from html import escape
from pathlib import Path

from .. import pages, style
from .cases import Run
from .outcomes import COMPLETED, CRASHED, Outcome
from .parts import said, state_class
from .precision_reports import NUDGE, PARTS, SECONDS, Part
from .table import stopped_step, verdict

NAME = "precision"
TITLE = "Pairs in double and in single precision"
ABOUT = "Run the problems of the other reports in double and in single precision; hold what changes against the method's own error."
PROGRAMS = ("conduction", "convection", "disph_c", "disph_d", "disph_e", "disph_f", "disph_n", "disph_y", "drop", "rti", "shock", "ssph")
INTRODUCTION = "What a pair of particles adds to a sum can be computed in numbers of seven digits (<code>&amp;kernel precision = 'single'</code>). " \
               "A program takes them by itself where each figure of its reports has an error ten times as large as the change."
DOUBLE, SINGLE, COARSE, NUDGED = "double", "single", "coarse", "nudged"
ENOUGH = 10.0  # times the change that the method's own error must be
SPEAKERS = tuple(dict.fromkeys(part.speaks_for for part in PARTS))
OF_KEPT = 1e-6  # that a residual of what is kept may change by, where a tenth of it is less


@dataclass(frozen=True)
class Half(Run):
    """One of the two runs of a problem, or the coarse one, or that with another last digit at the start."""
    part: Part | None = None
    kind: str = ""

    @property
    def problem(self) -> tuple:
        return self.part.speaks_for, self.binary, self.file, self.variant, self.program


def add_options(parser: argparse.ArgumentParser) -> None:
    names = ", ".join(dict.fromkeys(part.speaks_for.split(",")[0] for part in PARTS))
    parser.add_argument("--of", default="", metavar="NAME,…", help=f"whose problems: {names} (default: all)")


def plan(given: argparse.Namespace, root: Path, parser: argparse.ArgumentParser) -> list[Run]:
    wanted = set(filter(None, map(str.strip, given.of.split(","))))
    known = {part.speaks_for.split(",")[0] for part in PARTS}
    if wanted - known:
        parser.error(f"--of: no '{sorted(wanted - known)[0]}' (there are {', '.join(sorted(known))})")
    runs = {}
    for part in PARTS:
        if wanted and part.speaks_for.split(",")[0] not in wanted:
            continue
        words, coarse = (part.quick, part.quick_coarse) if given.quick else (part.words, part.coarse)
        halves = [half(part, one, kind) for one in asked(part, words, given, root) for kind in (DOUBLE, SINGLE)]
        halves += [half(part, one, COARSE) for one in asked(part, coarse, given, root)]
        halves += [half(part, one, NUDGED) for one in asked(part, words, given, root) if one.file in NUDGE]
        runs |= {one.folder: one for one in halves if one.folder not in runs}
    return sorted(runs.values(), key=lambda one: SPEAKERS.index(one.part.speaks_for))


def asked(part: Part, words: str, given: argparse.Namespace, root: Path) -> list[Run]:
    """The runs of that report's command line."""
    if not words:
        return []
    parser = argparse.ArgumentParser()
    part.report.add_options(parser)
    of_report = parser.parse_args(words.split())
    of_report.quick, of_report.settings = False, given.settings
    return part.report.plan(of_report, root, parser)


def half(part: Part, run: Run, kind: str) -> Half:
    own = {field.name: getattr(run, field.name) for field in fields(Run)}
    precision, (seconds, n) = SINGLE if kind == SINGLE else DOUBLE, SECONDS.get(run.file, (0, 0))
    own |= {"folder": f"{kind}/{run.binary}/{run.folder}", "label": f"{run.binary} {run.label}, {kind}",
            "settings": (*run.settings, *((NUDGE[run.file],) if kind == NUDGED else ()), f"kernel.precision={precision}"),
            "seconds": seconds * (run.n / n) ** 3 if n else 0.5}
    return Half(**own, part=part, kind=kind)


def twin(outcome: Outcome, outcomes: list[Outcome], kind: str) -> Outcome | None:
    """The other run of the same problem."""
    return next((one for one in outcomes if (one.case.kind, one.case.problem) == (kind, outcome.case.problem)), None)


def row(outcome: Outcome, outcomes: list[Outcome]) -> dict | None:
    """Of each run in single precision, with the others of its problem."""
    if outcome.case.kind != SINGLE:
        return None
    double = twin(outcome, outcomes, DOUBLE)
    numbers = {name: [one.number(name) for one in (double, outcome)] for name in ("steps", "stepping_seconds")}
    ends = [f"{verdict(one)}{f', step {step}' if (step := stopped_step(one)) is not None else ''}" for one in (double, outcome)]
    return {"speaks_for": outcome.case.part.speaks_for, "program": outcome.case.binary, "letter": outcome.case.program, "ends": ends,
            "steps": numbers["steps"], "both_seconds": numbers["stepping_seconds"],
            "figures": compared(outcome, double, outcomes) if {double.kind, outcome.kind} == {COMPLETED} else []}


def compared(single: Outcome, double: Outcome, outcomes: list[Outcome]) -> list[dict]:
    """Each figure of the report in both, what changes, and the method's own error: the distance in double from what is known, else from
    the run at fewer particles."""
    measure = single.case.part.report.figures
    coarse, nudged = twin(single, outcomes, COARSE), twin(single, outcomes, NUDGED)
    a, b = measure(double, outcomes), measure(single, outcomes)
    rough = measure(coarse, outcomes) if coarse and coarse.kind == COMPLETED else {}
    beside = measure(nudged, outcomes) if nudged and nudged.kind == COMPLETED else {}
    found = []
    for name, of_double in a.items():
        value, other, kept = of_double.value, b[name].value if name in b else None, of_double.kept
        right, against = of_double.exact, "known"
        if right is None and name in rough:
            right, against = rough[name].value, f"n = {coarse.case.n}"
        if value is None or other is None or right is None:
            continue
        change, own = other - value, abs(value - right)
        found.append({"figure": name, "double": value, "single": other, "change": change, "own_error": own, "against": against,
                      "ratio": own / abs(change) if change else None, "kept": kept,
                      "enough": abs(change) <= max(own / ENOUGH, OF_KEPT if kept else 0.0),
                      "last_digit": beside[name].value - value if name in beside and beside[name].value is not None else None})
    return found


def judged(_row: dict) -> dict[str, tuple[float, float]]:
    return {}  # there are no orders here


def bears(one: dict) -> bool:
    """Whether both runs of a problem end alike, and each answer's own error is large enough."""
    return CRASHED not in one["ends"] and one["ends"][0] == one["ends"][1] and all(figure["enough"] for figure in answers(one))


def answers(one: dict) -> list[dict]:
    """The figures without residuals of what is kept, which are the check of an answer."""
    return [figure for figure in one["figures"] if not figure["kept"]]


def groups(measured: dict) -> dict[str, list[dict]]:
    found: dict[str, list[dict]] = {}
    for one in measured["runs"]:
        found.setdefault(one["speaks_for"], []).append(one)
    return found


def worst(runs: list[dict]) -> tuple[dict, dict] | None:
    """The run and the figure that changes most against the method's own error; without what is kept."""
    changed = [(one, figure) for one in runs for figure in answers(one) if figure["ratio"] is not None]
    return min(changed, key=lambda each: each[1]["ratio"], default=None)


def counts(runs: list[dict], kept: bool = False) -> tuple[int, int]:
    """Answers (kept: residuals) that bear single precision, of all; that a run ends otherwise counts as an answer that does not."""
    figures = [figure["enough"] for one in runs for figure in one["figures"] if figure["kept"] == kept]
    otherwise = 0 if kept else sum(one["ends"][0] != one["ends"][1] for one in runs)
    return sum(figures), len(figures) + otherwise


def quotient(pair: list[float | None]) -> str:
    return said(pair[0] / pair[1], "{:.2f}") if pair[0] and pair[1] else "–"


def faster(runs: list[dict]) -> str:
    """Seconds in double over those in single, of the runs that take as many steps in both."""
    pairs = [one["both_seconds"] for one in runs if one["steps"][0] == one["steps"][1] and all(one["both_seconds"])]
    return quotient([sum(column) for column in zip(*pairs)]) if pairs else "–"


def problem(one: dict) -> str:
    size = f", n = {one['n']}" if one["n"] else ""
    scheme = f", {one['variant']}" if one["variant"] and one["variant"] != one["program"] else ""
    return f"{one['program']}, {one['case']}{scheme}{size}"


def ratio_text(figure: dict) -> str:
    ratio = figure["ratio"]
    if ratio is None:
        return "no change"
    return f"{ratio:.2g}" if ratio < 10 else f"{ratio:.0f}" if ratio < 1e4 else f"{ratio:.0e}".replace("e+0", "e")


def sections(_outcomes: list[Outcome], measured: dict, folder: Path) -> list[str]:
    by_program = groups(measured)
    return [pages.section("By program", verdicts(by_program), pages.figure(
                ratios(by_program), folder / "ratios.png",
                "Each dot a figure: the method's own error over what single precision changes. Left of the line (10) single is not good enough. "
                "Dots on the right edge: no change; on the left one: below 10⁻³, where nothing should change at all.")),
            *(pages.section(f"Figures: {name}", of_program(runs)) for name, runs in by_program.items()),
            pages.section("Steps and time", steps(measured["runs"]))]


def verdicts(by_program: dict[str, list[dict]]) -> str:
    def least(runs: list[dict]) -> str:
        found = worst(runs)
        return pages.cell(f"{ratio_text(found[1])}: {escape(said_of(found[1]))} of {escape(problem(found[0]))}" if found else "–", "words")

    columns = {"Program": lambda item: pages.name(item[0]),
               "answers that bear it": lambda item: pages.number("{} of {}".format(*counts(item[1]))),
               "residuals": lambda item: pages.number("{} of {}".format(*counts(item[1], kept=True))),
               "ends otherwise": lambda item: pages.number(sum(one["ends"][0] != one["ends"][1] for one in item[1])),
               "least of error over change": lambda item: least(item[1]),
               "time, double/single": lambda item: pages.number(faster(item[1])),
               "single is good enough": lambda item: answer(all(map(bears, item[1])))}
    return pages.columns(list(by_program.items()), columns, "wide")


def answer(good: bool) -> str:
    return pages.cell("yes" if good else "no", "good" if good else "stop")


def said_of(figure: dict) -> str:
    return figure["figure"].replace("_", " ")


def of_program(runs: list[dict]) -> str:
    rows, names = [], []
    nudged = any(figure["last_digit"] is not None for one in runs for figure in one["figures"])
    for one in runs:
        if one["ends"][0] != one["ends"][1] or not one["figures"]:
            same = one["ends"][0] == one["ends"][1]
            text = f"ends: {' and '.join(one['ends'])}" if not same else f"ends in both: {one['ends'][0]}"
            rows.append([pages.name(problem(one)), pages.cell(escape(text), "words", 6 + nudged), answer(same)])
            names.append(problem(one))
        for figure in one["figures"]:
            own = f"{figure['own_error']:.2g}" + (f" ({figure['against']})" if figure["against"] != "known" else "")
            cells = [f"{figure['double']:.8g}", f"{figure['single']:.8g}", f"{figure['change']:.1e}", own, ratio_text(figure)]
            if nudged:
                cells.insert(3, said(figure["last_digit"], "{:.1e}"))
            rows.append([pages.name(problem(one)), pages.cell(escape(said_of(figure))), *map(pages.number, cells), answer(figure["enough"])])
            names.append(problem(one))
    heads = ["Problem", "figure", "double", "single", "change", *(["a last digit changes"] if nudged else []), "own error", "error/change", "enough"]
    remark = "Own error: the distance of the figure in double from the exact, published or theoretical one; with (n = …): from the figure at so " \
             "many particles, where nothing is known. A residual of what is kept (energy, heat, an element) bears a change by a tenth of itself " \
             f"or by {OF_KEPT:g}; it is the check of an answer and not one, and the verdict above is without it."
    if nudged:
        remark += " A last digit: what the figure changes by in double, with another eighth digit of the disturbance at the start, or of gravity."
    return pages.table(heads, rows, "wide", names) + pages.small(remark)


def steps(runs: list[dict]) -> str:
    columns = {"Problem": lambda one: pages.name(problem(one)), "ends": lambda one: pages.cell(escape(one["ends"][1]), state_class(one["outcome"])),
               "steps, double": lambda one: pages.number(said(one["steps"][0], "{:.0f}")),
               "single": lambda one: pages.number(said(one["steps"][1], "{:.0f}")),
               "seconds, double": lambda one: pages.number(said(one["both_seconds"][0])),
               "single ": lambda one: pages.number(said(one["both_seconds"][1])), "ratio": lambda one: pages.number(quotient(one["both_seconds"]))}
    return pages.columns(runs, columns, "wide", lambda one: one["speaks_for"]) + \
        pages.small("Seconds of the steps on one thread, each run once: other work on the machine shows in them.")


def ratios(by_program: dict[str, list[dict]]):
    figures = {name: [figure for one in runs for figure in answers(one)] for name, runs in by_program.items()}
    figures = {name: found for name, found in figures.items() if found}
    if not figures:
        return None
    low, high = 1e-3, 1e9
    drawn, ax = style.across(list(figures), 0.45)
    for index, found in enumerate(figures.values()):
        x = [min(max(high if figure["ratio"] is None else figure["ratio"], low), high) for figure in found]
        # Beside one another where they would hide each other.
        y = [index + 0.3 * math.sin(2.4 * k) for k in range(len(x))]
        colours = [style.BLUE if figure["enough"] else style.VERMILION for figure in found]
        ax.scatter(x, y, s=22, c=colours, alpha=0.75, linewidths=0)
    ax.axvline(ENOUGH, color=style.INK, linestyle=(0, (4, 3)), linewidth=0.9)
    ax.set(xscale="log", xlim=(0.6 * low, 1.7 * high), xlabel="the method's own error/what single precision changes")
    return drawn


def terminal(_outcomes: list[Outcome], measured: dict) -> list[str]:
    lines = [f"{'program':<26}{'bear it':>10}{'time':>7}  least of error over change"]
    for name, runs in groups(measured).items():
        found = worst(runs)
        least = f"{ratio_text(found[1])} ({said_of(found[1])}, {problem(found[0])})" if found else "–"
        lines.append(f"{name:<26}{'{} of {}'.format(*counts(runs)):>10}{faster(runs):>7}  {least}")
        lines += [f"  {problem(one)}: ends {' and '.join(one['ends'])}" for one in runs if one["ends"][0] != one["ends"][1]]
        lines += [f"  {problem(one)}: {said_of(figure)} {figure['double']:.8g}, {figure['single']:.8g}, own error {figure['own_error']:.1g}"
                  for one in runs for figure in one["figures"] if not figure["enough"]]
    return lines
