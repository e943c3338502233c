"""Time a step by stage, for the runs of one input; what treats walls stands out."""
from pathlib import Path

from ... import style
from ..results import cost_per_step, representatives, stages
from ..runner import COMPLETED, Outcome

WALL = "#CC3311"
OTHERS = ("#4477AA", "#66A5CC", "#99C7DB", "#8C8C6E", "#B8B38F", "#DDD8B8")
REST = "#e4e4e4"
SMALL = 0.01  # of the time of all runs: stages below are not told apart


def input_shown(outcomes: list[Outcome], files: list[str]) -> str | None:
    """The input with most completed runs, the last of equals: cost depends little on the input."""
    timed = [o.case.file for o in outcomes if o.kind == COMPLETED and cost_per_step(o)]
    return max(reversed(files), key=timed.count) if timed else None


def draw(outcomes: list[Outcome], files: list[str], path: Path) -> bool:
    file = input_shown(outcomes, files)
    if file is None:
        return False
    runs = [o for o in representatives(outcomes, file) if cost_per_step(o)]
    total: dict[str, float] = {}
    for outcome in runs:
        for name, seconds in stages(outcome).items():
            total[name] = total.get(name, 0.0) + seconds
    walls = [name for name in total if name.startswith("wall")]
    seen = [name for name in total if name not in walls and total[name] > SMALL * sum(total.values())]
    others = sorted(seen, key=total.get, reverse=True)[:len(OTHERS)]

    figure, (ax,) = style.panels(1, 1, 0.42 * len(runs) + 1.3)
    left = [0.0] * len(runs)

    def segment(name, colour, seconds):
        """Milliseconds a step, stacked on what stands there."""
        widths = [1e3 * value / o.summary["steps"] for value, o in zip(seconds, runs)]
        ax.barh(range(len(runs)), widths, left=left, color=colour, label=name, height=0.68, edgecolor="white",
                linewidth=0.6)
        left[:] = [start + width for start, width in zip(left, widths)]

    if walls:
        segment("wall correction", WALL, [sum(stages(o).get(name, 0.0) for name in walls) for o in runs])
    for name, colour in zip(others, OTHERS):
        segment(name.replace("_", " "), colour, [stages(o).get(name, 0.0) for o in runs])
    shown = {*walls, *others}
    segment("everything else", REST, [sum(value for name, value in stages(o).items() if name not in shown) for o in runs])

    for index, outcome in enumerate(runs):
        ax.annotate(f"{left[index]:.2g} ms", (left[index], index), xytext=(4, 0),
                    textcoords="offset points", va="center", fontsize=8)
    ax.set_yticks(range(len(runs)), [outcome.case.label for outcome in runs])
    ax.invert_yaxis()
    ax.grid(axis="y", visible=False)
    ax.set_axisbelow(True)
    ax.set_xlabel("time a step without output (ms), one thread")
    ax.set_title(f"File {file}")
    ax.margins(x=0.08)
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize=8)
    style.save(figure, path)
    return True
