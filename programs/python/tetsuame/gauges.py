"""Gauges of a run of `flow`: what they read (gauges.csv), and the measurements that its input names beside them."""
from pathlib import Path

import numpy as np

from . import fields, style, tables
from .reading import Columns, Keys, as_table

KINDS = {"front": ("front_column", "length_unit"), "height": ("height_columns", "length_unit"), "pressure": ("pressure_columns", "stress_unit")}
ROOM = 1.6   # of the largest value measured: no panel is higher
LEAST = 0.2  # of the largest value that any gauge of the kind measured: no panel is lower


def read(folder: Path) -> Columns | dict:
    """Columns by name, with time, s; empty without gauges."""
    path = folder / "gauges.csv"
    return Columns(path) if path.is_file() else {}


@as_table("the measurements beside a run, which its input names")
def measured(folder: Path) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Times, s, and values in SI units by column of gauges.csv: of the file that the run was held against, as far as it is there, and
    where it has numbers."""
    keys = Keys(folder / "resolved.nml")
    path = folder / keys.get("gauges.file", "")  # which may be absolute
    if not path.is_file():
        return {}
    table, found = tables.read(path), {}
    times = next(iter(table.values())) * unit(keys, "time_unit")
    for kind, (key, its_unit) in KINDS.items():
        for number, name in enumerate(listed(keys.get(f"gauges.{key}", "")), 1):
            if name in table:
                there = np.isfinite(table[name])
                if there.any():
                    found[kind if kind == "front" else f"{kind}_{number}"] = times[there], table[name][there] * unit(keys, its_unit)
    return found


def unit(keys: dict[str, str], name: str) -> float:
    """What is 1 in the file, in SI units; an expert's key."""
    return keys.real(f"expert.{name}")


def listed(text: str) -> list[str]:
    """The words of a list of resolved.nml, with quotes or without."""
    return [word.strip().strip("'\"") for word in text.split(",")] if text.strip() else []


def until(curve: tuple[np.ndarray, np.ndarray], last: float) -> tuple[np.ndarray, np.ndarray]:
    """What there is of a curve up to a time."""
    return curve[0][curve[0] <= last], curve[1][curve[0] <= last]


def largest_measured(known: dict, kind: str) -> float:
    """Of all gauges of a kind."""
    return max((float(values.max()) for name, (_, values) in known.items() if name.startswith(kind)), default=0.0)


def panel(ax, curves: list[tuple[dict, np.ndarray, np.ndarray]], of_measurement: tuple[np.ndarray, np.ndarray] | None,
          largest: float = 0.0) -> None:
    """Runs' curves (how they are drawn, times, values) below the measured one, whose height gives the panel's: an impact's spike, shorter
    than a reading of the experiment, would press all else flat. A spike that leaves the panel is named. largest: that any gauge measured."""
    last = max(time[-1] for _, time, _ in curves)
    for look, time, values in curves:
        ax.plot(time, values, **look)
    if 0 < last < np.inf:
        ax.set_xlim(0, last)
    if of_measurement is None:
        return
    time, values = until(of_measurement, last)
    if not len(time):
        return
    ax.plot(time, values, color=style.INK, linewidth=1.0 if len(time) > 30 else 0, marker=None if len(time) > 30 else "o", markersize=3.5,
            label="measured", zorder=4)
    low, high = min(0.0, float(values.min())), max(float(values.max()), LEAST * largest, 1e-300)
    of_runs = np.concatenate([[low], *(v[np.isfinite(v)] for *_, v in curves)])
    runs_high, runs_low = of_runs.max(), of_runs.min()
    ax.set_ylim(max(1.05 * runs_low, low - 0.3 * high) if runs_low < 0 else low - 0.02 * high, min(max(1.05 * runs_high, 1.1 * high), ROOM * high))
    if runs_high > ROOM * high:
        ax.text(0.98, 0.97, f"to {runs_high:.3g}", transform=ax.transAxes, ha="right", va="top", fontsize=7.5, color=style.GREY,
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5, "alpha": 0.8})


def draw(of: list[tuple[str, Path]], columns: list[str] | None = None):
    """A panel for each gauge of the runs (title, folder), with the measured curve where there is one; None without gauges."""
    each = [(title, found) for title, folder in of if len((found := read(folder)).get("time", ())) > 1]
    if not each:
        return None
    known = measured(of[0][1])
    names = columns or [name for name in each[0][1] if name not in ("step", "time")]
    figure, panels = style.panels(len(names), 4 if len(names) % 4 == 0 else 3, 2.2)
    for ax, name in zip(panels, names):
        peak = largest_measured(known, name.partition("_")[0])
        size, unit = fields.scaled(each[0][1].units[name], peak)
        panel(ax, [(style.numbered(index) | {"label": title or "run", "linewidth": 1.0}, found["time"], found[name] / size)
                   for index, (title, found) in enumerate(each) if name in found],
              (known[name][0], known[name][1] / size) if name in known else None, peak / size)
        style.entitle(ax, name.replace("_", " ") + fields.bracketed(unit))
    for ax in panels[-(4 if len(names) % 4 == 0 else 3):]:
        ax.set_xlabel("time [s]")
    if len(of) > 1 or known:
        style.legend_above(figure, panels)
    return figure
