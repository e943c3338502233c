"""`tetsuame compare DIR1 DIR2 …`: any runs side by side. Histories overlaid, measures in a table, fields subtracted
particle by particle where the runs hold the same particles."""
import argparse
import re
from html import escape
from pathlib import Path

import numpy as np

from . import COMPLETED, OUTPUT, fields, pages, plots, runs, style, writing
from .reading import Unreadable, Keys

SHOWN = 4  # maps of so many runs fit beside each other
LONGEST = 32  # letters of a title
OF_MACHINES = ("balance_", "time_spread", "load_max_over_mean", "waiting_seconds", "halo_", "migration_bytes", "fluid_halo", "wall_halo",
               "collectives_per_step")


def titles(of: list[runs.Run]) -> list[str]:
    """The directories without what all paths share in front; what is still too long without the words that all names begin or end with,
    and else without its middle. All different."""
    parts = [run.directory.resolve().parts for run in of]
    common = 0
    while all(len(part) > common + 1 for part in parts) and len({part[common] for part in parts}) == 1:
        common += 1
    whole = ["/".join(part[common:]) for part in parts]
    if max(map(len, whole)) <= LONGEST:
        return whole
    words = [re.split(r"(?<=[/_ ,])", name) for name in whole]
    first, last = shared(words), shared([each[::-1] for each in words])
    short = [("…" if first else "") + "".join(each[first:len(each) - last]) + ("…" if last else "") for each in words]
    short = [name if len(name) <= LONGEST else f"{name[:LONGEST // 2]}…{name[-LONGEST // 2 + 1:]}" for name in short]
    return short if len(set(short)) == len(set(whole)) else [f"{number}: {name}" for number, name in enumerate(short, 1)]


def shared(words: list[list[str]]) -> int:
    """How many words all lists begin with, of which each keeps one at least."""
    count = 0
    while all(len(each) > count + 1 for each in words) and len({each[count] for each in words}) == 1:
        count += 1
    return count


def that_differ(each: list[dict], *forms: str) -> list[list[str]]:
    """A row for each name whose values are not the same in all, in the first of the forms that shows it."""
    rows = []
    for name in dict.fromkeys(name for found in each for name in found):
        if len({found.get(name) for found in each}) > 1:
            said = [[format(found[name], form) if name in found else "–" for found in each] for form in forms]
            rows.append([name, *next((values for values in said if len(set(values)) > 1), said[-1])])
    return rows


def inputs(of: list[tuple[str, runs.Run]]) -> str:
    """Keys of resolved.nml."""
    rows = that_differ([Keys(run.directory / "resolved.nml") for _, run in of], "")
    return pages.text_table(["key", *(title for title, _ in of)], rows, words=1) if rows else pages.paragraph("None: the inputs are the same.")


def physics(run: runs.Run) -> dict[str, float]:
    """Its measures, but for those that another machine, another number of ranks or another day changes."""
    return {name: value for name, value in run.metrics().items() if not name.startswith(OF_MACHINES)}


def metrics(of: list[tuple[str, runs.Run]]) -> str:
    """Status and numbers of summary.json."""
    rows = [["status", *(str((run.summary or {}).get("status", "not at its end")) for _, run in of)],
            ["steps", *(str((run.summary or {}).get("steps", "–")) for _, run in of)]]
    rows += [[name.replace("_", " "), *values] for name, *values in that_differ([physics(run) for _, run in of], ".6g", ".17g")]
    return pages.text_table(["measure", *(title for title, _ in of)], rows, words=1)


def differences(of: list[tuple[str, runs.Run]], time: float) -> str:
    """Of every run from the first, particle by particle: the root of the mean square and the largest, over the field's range."""
    first_title, first = of[0]
    rows = []
    for title, run in of[1:]:
        a, b = first.snapshot(time), run.snapshot(time)
        for name in a.names:
            if name == "ParticleIDs" or name not in b:
                continue
            here, there = runs.by_id(a, b, name)
            if here.shape != there.shape:
                continue
            if not len(here):
                return pages.paragraph(f"No particle of {escape(title)} is one of {escape(first_title)} by its ID.")
            difference = np.abs(there.astype(float) - here)
            size = np.ptp(here) or np.abs(here).max() or 1.0
            rows.append([pages.name(title), pages.cell(escape(name + fields.bracketed(a.units[name]))), pages.number(len(here)),
                         pages.number(f"{np.sqrt((difference**2).mean()):.3g}"), pages.number(f"{difference.max():.3g}"),
                         pages.error(difference.max() / size, f"{difference.max() / size:.2g}")])
    return pages.table(["run", "field", "particles", "root mean square", "largest", "largest, of the range"], rows,
                       groups=[row[0] for row in rows]) + pages.error_key()


def maps(of: list[tuple[str, runs.Run]], name: str, time: float):
    """One field of all runs, with the same colours."""
    pictures = [run.snapshot(time).map(name) for _, run in of]
    limits = min(np.nanmin(p.values) for p in pictures), max(np.nanmax(p.values) for p in pictures)
    unit = of[0][1].snapshot(time).unit(name)
    figure, panels = style.map_panels(len(of), plots.wide(pictures[0]), 2)
    for ax, (title, run), picture in zip(panels, of, pictures):
        plots.draw_map(ax, picture, name, unit, limits)
        style.entitle(ax, title, plots.when(run.snapshot(time)))
    style.room_for_titles(figure, panels)
    return figure


def page(of: list[tuple[str, runs.Run]], time: float | None, wanted: list[str] | None) -> str:
    dimensions = {run.snapshot().dimension for _, run in of}
    if len(dimensions) > 1:
        raise Unreadable("the runs have different dimensions: " + ", ".join(f"{title} {run.snapshot().dimension}" for title, run in of))
    if time is None:
        time = min(run.snapshot().time for _, run in of)
    common = [name for name in [*of[0][1].snapshot(time).names, "Speed"] if all(name in run.snapshot(time) for _, run in of)]
    names = fields.shown(of[0][1].snapshot(time), wanted or [name for name in fields.shown(of[0][1].snapshot(time)) if name in common] or None)
    for _, run in of:
        fields.shown(run.snapshot(time), names)  # refused by name where one is not there, or no number
    mapped = [] if dimensions == {1} else names
    return pages.document("runs side by side", [
        pages.head("Runs side by side", [], ""),
        pages.listed([f"{escape(title)}: <code>{escape(str(run.directory))}</code>" for title, run in of], "small"),
        pages.section("Inputs that differ", inputs(of)), pages.section("Measures that differ", metrics(of)),
        pages.section("Histories", pages.figure(plots.histories(of), caption="Columns of history.csv that vary.")),
        pages.section("Fields", pages.paragraph(f"Of the first {SHOWN} runs.") if mapped and len(of) > SHOWN else "",
                      *(pages.figure(maps(of[:SHOWN], name, time), caption=escape(f"{fields.look(name).label}, with the same colours"))
                        for name in mapped)),
        pages.section("Profiles", pages.figure(plots.profiles([(title, run.snapshot(time)) for title, run in of], names),
                                               caption="Means over layers.")),
        pages.section(f"Differences from {of[0][0]}, particle by particle", differences(of, time))])


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="tetsuame compare", usage="tetsuame compare DIR1 DIR2 … [options]",
                                     description="Compares runs with each other, particle by particle; the first is what the others differ from.")
    parser.add_argument("directories", metavar="DIR", nargs="+", help="of a run")
    parser.add_argument("--fields", metavar="A,B", type=lambda text: text.split(","), help="to draw (the first few that vary)")
    parser.add_argument("--time", type=float, help="of the snapshots, s (the last that all have)")
    parser.add_argument("--output", metavar="FOLDER", type=Path, default=OUTPUT / "runs", help="for report.html (%(default)s)")
    o = parser.parse_args(arguments)
    if o.time is not None and not np.isfinite(o.time):
        parser.error("--time is a number")
    if len(o.directories) < 2:
        raise Unreadable("one run has nothing to be compared with: give two directories or more")
    of = [runs.Run(directory) for directory in o.directories]
    text = page(list(zip(titles(of), of)), o.time, o.fields)
    print(pages.write(writing.folder(o.output), text))
    return COMPLETED
