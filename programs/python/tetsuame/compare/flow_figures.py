"""The figures of the comparison of water with a free surface, and its movies."""
import math
from pathlib import Path

import numpy as np

from .. import fields, gauges, movie, pages, plots, style
from ..reading import Keys, real
from ..runs import Snapshot
from .flow_questions import named
from .outcomes import Outcome

TIMES_2D = (0.15, 0.3, 0.425, 0.5, 0.65, 0.875)  # s
RATE = 10.0  # pictures a second


def of_case(done: list[Outcome], *names: str) -> list[Outcome]:
    return sorted((o for o in done if o.case.file in names), key=lambda o: (names.index(o.case.file), o.case.n))


def finest(runs: list[Outcome]) -> Outcome | None:
    return max((o for o in runs if o.snapshots), key=lambda o: o.case.n, default=None)


def by_n(runs: list[Outcome]) -> list[tuple[dict, str, Outcome]]:
    """Each run's look and label: the finest is blue, coarser ones are other colours."""
    cases = {o.case.file for o in runs}
    colours = (style.BLUE, style.ORANGE, style.GREEN, style.PINK)
    found = []
    for o in runs:
        order = sorted((other.case.n for other in runs if other.case.file == o.case.file), reverse=True).index(o.case.n)
        label = named(o.case.file, o.case.n)
        look = {"color": colours[order % len(colours)], "linewidth": 1.1 if order == 0 else 0.8, "zorder": 3 - 0.1 * order}
        found.append((look, f"{o.case.file.replace('_', ' ')}, {label}" if len(cases) > 1 else label, o))
    return found


def curve(outcome: Outcome, name: str) -> tuple[np.ndarray, np.ndarray]:
    readings = gauges.read(outcome.folder)
    return (readings["time"], readings[name]) if name in readings else (np.empty(0), np.empty(0))


def integral(times: np.ndarray, values: np.ndarray, start: float) -> np.ndarray:
    """Of a curve from a time on, by trapezia."""
    steps = np.where(times[1:] > start, 0.5 * (values[1:] + values[:-1]) * np.diff(times), 0.0)
    return np.concatenate([[0.0], np.cumsum(steps)])


# ---- at rest, waves -------------------------------------------------------------------------------------


def kinetic(runs: list[Outcome]):
    runs = [o for o in runs if len(o.history.get("time", ())) > 1 and o.number("metrics", "kinetic_energy_over_mgh")]
    if not runs:
        return None
    figure, (ax,) = style.panels(1, 1, 2.8, "kinetic energy over m g H")
    for look, label, o in by_n(runs):
        energy = o.history["kinetic_energy"] * o.number("metrics", "kinetic_energy_over_mgh") / o.history["kinetic_energy"][-1]
        three = o.case.file.endswith("3d")
        ax.plot(o.history["time"][1:] * math.sqrt(9.81), energy[1:], **look | {"linestyle": "--" if three else "-"},
                label=label.replace(" 3d", ", 3-D"))
    ax.axhline(1e-6, color=style.GREY, linestyle=":")
    ax.set(yscale="log", xlabel="t √(g/H)", xlim=(0, None), ylim=(None, 3e-5))
    ax.legend(fontsize=8, ncol=3, loc="upper right")
    return figure


def water(ax, snapshot: Snapshot, name: str, low: float, high: float, unit: float = 1.0):
    """Each particle as a square of its spacing, and those of bodies; what was drawn of the water."""
    drawn = style.tiles(ax, snapshot["Coordinates"], 1.15 * float(np.median(snapshot.spacing)), array=snapshot[name] / unit, snap=False,
                        cmap=fields.look(name).colours, norm=style.plt.Normalize(low, high))
    if len(wall := snapshot.wall("Coordinates")):
        style.tiles(ax, wall, 1.02 * float(np.median(snapshot.spacing)), color=style.GREY)
    style.as_map(ax, (0, snapshot.lengths[0]), (0, snapshot.lengths[1]))
    return drawn


def state(outcome: Outcome | None, name: str):
    """The last state."""
    if outcome is None or outcome.snapshot is None or outcome.snapshot.dimension != 2:
        return None
    snapshot = outcome.snapshot
    figure, (ax,) = style.map_panels(1, float(snapshot.lengths[0] / snapshot.lengths[1]))
    size, unit = fields.scaled(snapshot.unit(name), float(np.abs(snapshot[name]).max()))
    low, high = fields.limits([snapshot], name)
    style.colour_bar(figure, water(ax, snapshot, name, low / size, high / size, size), ax, fields.label(name, unit), shrink=0.85)
    ax.set_title(plots.when(snapshot))
    return figure


def waves(wave: list[Outcome], drop: list[Outcome]):
    if not wave and not drop:
        return None
    figure, (left, right) = style.panels(2, 2, 3.0)
    for look, label, o in by_n(wave):
        left.plot(*curve(o, "wave"), **look, label=label)
    if wave:
        period, decay = (wave[0].number("metrics", name) for name in ("period_theory", "energy_decay_theory"))
        t = np.linspace(0, wave[0].setting("time.t_end"), 400)
        left.plot(t, np.cos(2 * np.pi * t / period) * np.exp(-0.5 * decay * t), color=style.INK, linewidth=0.9, linestyle="--", zorder=4,
                  label="exact")
    left.set(title="standing wave", xlabel="time [s]", ylabel="velocity over the start's")
    for look, label, o in by_n(drop):
        for axis in "xy":
            right.plot(*curve(o, f"semi_axis_{axis}"), **look, label=label if axis == "x" else None)
    if drop:
        t, a, b = exact_axes(drop[0].setting("expert.strain_rate"), drop[0].setting("time.t_end"))
        for axis in (a, b):
            right.plot(t, axis, color=style.INK, linewidth=0.9, linestyle="--", zorder=4, label="exact" if axis is a else None)
    right.set(title="drop", xlabel="time [s]", ylabel="semi-axes [m]")
    for ax, of in ((left, wave), (right, drop)):
        if of:
            ax.legend(fontsize=8)
    return figure


def exact_axes(rate: float, end: float, steps: int = 400) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times and the semi-axes, from a circle of radius 1 (docs/theory/free_surface.md), by Runge and Kutta."""
    def slope(y):
        a, b, A = y
        return np.array([-A * a, A * b, A * A * (a * a - b * b) / (a * a + b * b)])

    y, dt = np.array([1.0, 1.0, rate]), end / steps
    found = [y]
    for _ in range(steps):
        k1 = slope(y)
        k2 = slope(y + 0.5 * dt * k1)
        k3 = slope(y + 0.5 * dt * k2)
        y = y + dt / 6 * (k1 + 2 * k2 + 2 * k3 + slope(y + dt * k3))
        found.append(y)
    return np.linspace(0, end, steps + 1), *np.array(found).T[:2]


def drop(outcome: Outcome | None, times=(0.0019, 0.0038, 0.0076)):
    if outcome is None:
        return None
    states = at_times(outcome, times)
    t, a, b = exact_axes(outcome.setting("expert.strain_rate"), outcome.setting("time.t_end"))
    figure, axes = style.map_panels(len(states), 0.62, 3, bars=False)
    high = max(fields.limits([snapshot], "Pressure")[1] for snapshot in states) / 1e6
    for ax, snapshot in zip(axes, states):
        drawn = water(ax, snapshot, "Pressure", 0, high, 1e6)
        middle, around = snapshot.lengths / 2, np.linspace(0, 2 * np.pi, 200)
        ax.plot(middle[0] + np.interp(snapshot.time, t, a) * np.cos(around), middle[1] + np.interp(snapshot.time, t, b) * np.sin(around),
                color=style.INK, linewidth=0.9)
        ax.set(title=f"t = {1e3 * snapshot.time:.1f} ms", xlim=middle[0] + (-1.25, 1.25), ylim=middle[1] + (-2.05, 2.05))
    style.colour_bar(figure, drawn, axes, "pressure [MPa]", shrink=0.85)
    return figure


# ---- dam breaks -----------------------------------------------------------------------------------------


def at_times(outcome: Outcome, times) -> list[Snapshot]:
    """Those nearest, each once."""
    found = [min(outcome.snapshots, key=lambda s: abs(s.time - t)) for t in times if t <= outcome.snapshots[-1].time * 1.01]
    return list(dict.fromkeys(found))


def pressures(runs: list[Outcome], number: int):
    """Gauges 1 to `number`: pressures, and their integrals."""
    runs = [o for o in runs if len(curve(o, "pressure_1")[0]) > 1]
    if not runs:
        return None
    known, looks = gauges.measured(runs[-1].folder), by_n(runs)
    start, until = impulse_span(runs[-1])
    places = gauges.listed(Keys(runs[-1].folder / "resolved.nml")["gauges.pressure_y"])
    number = min(number, sum(name.startswith("pressure_") for name in gauges.read(runs[-1].folder)))
    figure, axes = style.panels(2 * number, number, 2.5)
    for k in range(number):
        name = f"pressure_{k + 1}"
        curves = [(look | {"label": label}, *gauges.until(curve(o, name), until)) for look, label, o in looks]
        right = gauges.until(known[name], until) if name in known else None
        gauges.panel(axes[k], [(look, t, p / 1e3) for look, t, p in curves], right and (right[0], right[1] / 1e3))
        sums = [(look, t, integral(t, p, start)) for look, t, p in curves]
        gauges.panel(axes[number + k], sums, right and (right[0], integral(*right, start)))
        axes[k].set_title(f"gauge {k + 1}, y = {1e3 * real(places[k]):.0f} mm")
        axes[number + k].set_xlabel("time [s]")
    axes[0].set_ylabel("pressure [kPa]")
    axes[number].set_ylabel("impulse [Pa s]")
    style.legend_above(figure, axes)
    return figure


def impulse_span(outcome: Outcome) -> tuple[float, float]:
    """s: from and until; from 0 where it is from arrival on, before which there is no pressure."""
    keys = Keys(outcome.folder / "resolved.nml")
    start, end = (keys[f"expert.impulse_{name}"].strip() for name in ("from", "until"))
    return real(start) if start else 0.0, real(end) if end else math.inf


def heights(runs: list[Outcome]):
    runs = [o for o in runs if len(curve(o, "height_1")[0]) > 1]
    if not runs:
        return None
    known = gauges.measured(runs[-1].folder)
    figure, axes = style.panels(4, 4, 2.6, "depth [m]")
    for k, ax in enumerate(axes):
        name = f"height_{k + 1}"
        gauges.panel(ax, [(look | {"label": label}, *curve(o, name)) for look, label, o in by_n(runs)], known.get(name))
        ax.set(title=f"H{k + 1}", xlabel="time [s]")
    style.legend_above(figure, axes)
    return figure


def fronts(runs: list[Outcome]):
    runs = [o for o in runs if len(curve(o, "front")[0]) > 1]
    cases = list(dict.fromkeys(o.case.file for o in runs))
    if not cases:
        return None
    figure, axes = style.panels(len(cases), 2, 3.2, "front [m]")
    for ax, case in zip(axes, cases):
        own = of_case(runs, case)
        known = gauges.measured(own[-1].folder)
        gauges.panel(ax, [(look | {"label": label}, *curve(o, "front")) for look, label, o in by_n(own)], known.get("front"))
        ax.set(title=case.replace("_", " "), xlabel="time [s]")
        ax.legend(fontsize=8)
    return figure


def over_depth(outcome: Outcome) -> float:
    """ρ g H, Pa."""
    return outcome.setting("flow.density") * outcome.setting("flow.gravity") * outcome.setting("flow.high_y")


def course(outcome: Outcome | None, times):
    if outcome is None:
        return None
    states = at_times(outcome, times)
    figure, axes = style.map_panels(len(states), float(states[0].lengths[0] / states[0].lengths[1]), 3, bars=False)
    for ax, snapshot in zip(axes, states):
        drawn = water(ax, snapshot, "Pressure", 0.0, 1.0, over_depth(outcome))
        ax.set_title(plots.when(snapshot))
    style.colour_bar(figure, drawn, axes, "pressure / ρgH", shrink=0.7)
    return figure


def movie_2d(outcome: Outcome | None, target: Path) -> str:
    """As a GIF, which is in the page and beside it."""
    if outcome is None:
        return ""

    def frames():
        first = outcome.snapshots[0]
        figure, ax = style.plt.subplots(figsize=(6.4, 6.4 * first.lengths[1] / first.lengths[0] + 0.55), dpi=100)
        bar = True
        for snapshot in outcome.snapshots:
            ax.clear()
            drawn = water(ax, snapshot, "Pressure", 0.0, 1.0, over_depth(outcome))
            if bar:
                style.colour_bar(figure, drawn, ax, "pressure / ρgH", shrink=0.9)
                bar = False
            ax.set_title(plots.when(snapshot))
            figure.canvas.draw()
            yield np.asarray(figure.canvas.buffer_rgba())[..., :3]
        style.plt.close(figure)

    movie.write_gif(frames(), target, RATE)
    return pages.movie(target, f"The same, {len(outcome.snapshots)} states (<code>{target.name}</code>).")
