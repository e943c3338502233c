"""The page of a run of `balance`, and its pictures: the cuts and the ranks' times, and their course. In 3-D the cells are those of the
columns along z: their mean time is shown."""
from dataclasses import dataclass
from html import escape
from pathlib import Path

import numpy as np
from matplotlib.collections import PolyCollection

from . import pages, style
from .reading import Columns, Damaged, first_line, is_number, read_json

# Of each course its name and colour, by what its columns begin with.
COURSES = {"": ("balancer", style.BLUE), "rcb_": ("Zoltan RCB", style.ORANGE), "hsfc_": ("Zoltan HSFC", style.PINK)}

# Of what each balancer made of the first cuts, by head: the metric without the balancer, and its form.
MEASURES = {"spread at first": ("spread_initial", ".1%"), "spread at the end": ("spread_final", ".1%"),
            "mean/slowest at first": ("efficiency_initial", ".3f"), "mean/slowest at the end": ("efficiency_predicted", ".3f"),
            "updates": ("updates", "g"), "until 5 %": ("updates_to_5_percent", "g"),
            "moved an update": ("migrated_fraction_per_update", ".1%"), "run time (s)": ("run_time_balanced", ".4g"),
            "saved": ("run_time_reduction", ".1%")}


NEEDED = ("step", "spread", "slowest_step", "gain", "cost", "moved", "migrated_fraction")  # of history.csv


@dataclass
class Run:
    summary: dict
    history: dict[str, np.ndarray]  # by column, without the unit
    times: dict[int, np.ndarray]  # s of each rank, by decision
    cuts: dict[int, list[np.ndarray]]  # by decision: of each axis, groups x (counts + 1), m


def read(folder: Path) -> Run:
    summary = read_json(folder / "summary.json", "balance")
    history, times, cuts = (Columns(folder / f"{name}.csv") for name in ("history", "times", "cuts"))
    try:
        sizes = [int(n) for n in summary["counts"]]
        if len(history["step"]) <= max(times["decision"]) or min(times["decision"]) != 0 or sizes != summary["counts"] or min(sizes) < 1 or not all(
                is_number(summary.get(name, 0)) for name in ("fluid_particles", "wall_particles", "steps")):
            raise ValueError("decisions or counts are not whole")
        missing = set(NEEDED) - set(history)
        if missing or not all(np.isfinite(column).all() for table in (history, times, cuts) for column in table.values()):
            raise ValueError(f"history.csv has no {', '.join(sorted(missing))}" if missing else "a number is not finite")
        total = times["computing"] + times["communication"]
        decisions = np.unique(times["decision"]).astype(int)
        by_axis = {}
        for d in decisions:
            here = cuts["decision"] == d
            by_axis[d] = [cuts["position"][here & (cuts["axis"] == a)].reshape(-1, n + 1)
                          for a, n in enumerate(summary["counts"])]
        if list(decisions) != list(range(len(decisions))) or any(len(total[times["decision"] == d]) != np.prod(sizes) for d in decisions):
            raise ValueError("times.csv has not all ranks")
        if any(len(groups) != np.prod(sizes[:a]) for axes in by_axis.values() for a, groups in enumerate(axes)):
            raise ValueError("cuts.csv has not all cuts")
        return Run(summary, history, {d: total[times["decision"] == d] for d in decisions}, by_axis)
    except (LookupError, ValueError, TypeError, ArithmeticError) as problem:
        raise Damaged(f"{folder}: not the results of a run of balance ({first_line(problem)})") from None


def courses(run: Run) -> dict[str, tuple[str, str]]:
    return {prefix: about for prefix, about in COURSES.items() if f"{prefix}spread" in run.history}


def cells(run: Run, decision: int) -> tuple[np.ndarray, np.ndarray]:
    """Corners of each cell in the plane of x and y, and its time over the mean."""
    x, y = run.cuts[decision][0][0], run.cuts[decision][1]
    corners = [[(x[i], y[i, j]), (x[i + 1], y[i, j]), (x[i + 1], y[i, j + 1]), (x[i], y[i, j + 1])]
               for i in range(len(x) - 1) for j in range(y.shape[1] - 1)]
    time = run.times[decision].reshape(len(corners), -1).mean(axis=1)
    mean = time.mean()
    return np.array(corners), time / mean if mean > 0 else np.ones(len(time))


def cuts(run: Run):
    """First, second, fourth and last cuts, each cell coloured by its time."""
    last = max(run.times)
    shown = sorted({0, min(1, last), min(3, last), last})
    figure, axes = style.map_panels(len(shown), columns=4, bars=False)
    for ax, decision in zip(axes, shown):
        corners, time = cells(run, decision)
        drawn = PolyCollection(corners, array=time, cmap=style.ABOUT_ONE, edgecolors=style.INK,
                               linewidths=min(0.5, 8.0 / np.sqrt(len(corners))))
        drawn.set_clim(0, 2)
        ax.add_collection(drawn)
        style.as_map(ax, *((corners[..., a].min(), corners[..., a].max()) for a in (0, 1)))
        ax.set(xticks=[], yticks=[])
        spread = 100 * run.history["spread"][decision]
        ax.set_title(f"decision {decision}: spread {spread:.1f} %", fontsize=9)
    style.colour_bar(figure, drawn, axes, "time of a rank / mean", shrink=0.7, extend="max")
    return figure


def course(run: Run):
    """Spread and moved particles over the steps."""
    figure, (left, right) = style.panels(2, 2, 3.2)
    step = run.history["step"]
    for prefix, (label, colour) in courses(run).items():
        left.plot(step, 100 * run.history[f"{prefix}spread"], marker="o", markersize=3, color=colour, label=label)
        right.plot(step, 100 * np.cumsum(run.history[f"{prefix}migrated_fraction"]), color=colour, label=label)
    if max(run.history["spread"]) > 0:
        left.set_yscale("log")
    left.set(xlabel="step", ylabel="(max - min)/mean of time (%)")
    right.set(xlabel="step", ylabel="particles moved so far (% of all)")
    left.legend(fontsize=8)
    return figure


def percent(value: float) -> str:
    return f"{100 * value:.1f} %"


def results(run: Run) -> str:
    """What each balancer made of the first cuts."""
    found = run.summary.get("metrics")

    def cell(name: str, form: str) -> str:
        return pages.number("–" if not isinstance(found, dict) or not is_number(found.get(name)) else format(found[name], form).replace("%", " %"))

    rows = [[pages.name(*about), *(cell(prefix + name, form) for name, form in MEASURES.values())] for prefix, about in courses(run).items()]
    return pages.table(["", *MEASURES], rows, "wide") + pages.small(
        "Spread: (max − min)/mean of the ranks' times. Until 5 %: decisions until the spread was as small; –: it never was. "
        "Saved: of the run time with the first cuts kept.")


def decisions(run: Run) -> str:
    h = run.history
    columns = {"decision": lambda k: f"{k}", "step": lambda k: f"{h['step'][k]:.0f}", "spread": lambda k: percent(h["spread"][k]),
               "slowest rank (s a step)": lambda k: f"{h['slowest_step'][k]:.4g}", "gain expected (s)": lambda k: f"{h['gain'][k]:.3g}",
               "cost expected (s)": lambda k: f"{h['cost'][k]:.3g}", "moved": lambda k: "yes" if h["moved"][k] else "no",
               "particles moved": lambda k: percent(h["migrated_fraction"][k])}
    return pages.text_columns(list(range(len(h["step"]))), columns, 0, "wide")


def page(run: Run, folder: Path) -> str:
    s = run.summary
    counts = " × ".join(str(n) for n in s["counts"])
    particles = s.get("fluid_particles", 0) + s.get("wall_particles", 0)
    facts = [f"version {escape(str(s['version']))}" if s.get("version") else "", f"{particles:,} particles",
             f"{int(np.prod(s['counts']))} virtual ranks, {counts}", f"{s.get('steps', 0):,} steps"]
    return pages.document("load balance", [
        pages.head("Load balance on virtual ranks", facts, "The balancer of the programs, which sees the ranks' times, on times of a cost "
                   "model. What it means: docs/load_balancer.md."),
        pages.section("At a glance", results(run)),
        pages.section("Cuts", pages.figure(cuts(run), folder / "cuts.png", "Cells of the ranks after decisions, coloured by their time over the mean.")),
        pages.section("Course", pages.figure(course(run), folder / "course.png",
                                             "Left: spread of the ranks' times. Right: particles that have changed their rank.")),
        pages.section("Decisions of the balancer", pages.folded("All decisions", decisions(run)))])


def make(folder: Path) -> str:
    """Draws, and writes the page; what is said of it."""
    return pages.write(folder, page(read(folder), folder))
