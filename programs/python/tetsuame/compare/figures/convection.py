"""The figures of the comparison of convection."""
from dataclasses import replace
from pathlib import Path

import numpy as np

from ... import plots, style
from ...rendering import slice_of
from .. import references
from ..results import history, last_snapshot, resolved
from ..runner import COMPLETED, Outcome


def by_case(outcomes: list[Outcome]) -> dict[str, list[Outcome]]:
    cases: dict[str, list[Outcome]] = {}
    for outcome in outcomes:
        if outcome.kind == COMPLETED:
            cases.setdefault(outcome.case.file, []).append(outcome)
    return cases


def state(folder: Path):
    """The last snapshot; rendered, over the box's height: temperature from 0 (top) to 1 (bottom), and the square of the horizontal
    velocity; and the height. None if there is none."""
    snapshot = last_snapshot(folder)
    if snapshot is None or "Temperature" not in snapshot:
        return None
    height = resolved(folder, "domain", "length_y")
    top, bottom = (resolved(folder, "walls", f"temperature_{side}") for side in ("top", "bottom"))
    kelvin, square = snapshot.map("Temperature", 400), slice_of(snapshot, snapshot["Velocities"][:, 0] ** 2, 400, 2, None)
    extent = tuple(edge / height for edge in kelvin.extent)
    return snapshot, replace(kelvin, values=(kelvin.values - top) / (bottom - top), extent=extent), replace(square, extent=extent), height


def fields(outcomes: list[Outcome]):
    finest = (max(runs, key=lambda o: o.case.n) for runs in by_case(outcomes).values())
    states = [(o.case, s) for o in finest if (s := state(o.folder)) is not None]
    if not states:
        return None
    figure, axes = style.map_panels(len(states), max(plots.wide(T) for _, (_, T, _, _) in states), bars=False)
    for ax, (case, (snapshot, T, _, height)) in zip(axes, states):
        image = plots.draw_map(ax, T, "Temperature", "", (0, 1), length="", bar=False)
        plots.isolines(ax, T, np.arange(0.1, 0.95, 0.1))
        draw_arrows(ax, *(snapshot["Coordinates"] / height).T[:2], snapshot["Velocities"][:, :2], plots.wide(T))
        ax.set_title(f"{case.file}, n = {case.n}")
        ax.set(xticks=[0, plots.wide(T)], yticks=[0, 1], xlabel="", ylabel="")
    style.colour_bar(figure, image, axes, "(T − T_top)/(T_bottom − T_top)", shrink=0.7, aspect=30, pad=0.015)
    return figure


def draw_arrows(ax, x, y, v, width, across: int = 11) -> None:
    """The flow at the particles nearest to the points of a coarse lattice."""
    speed = np.hypot(*v.T).max()
    if not speed > 0:
        return
    step = 1 / across
    chosen = [int(np.argmin((x - a) ** 2 + (y - b) ** 2)) for a in np.arange(step / 2, width, step) for b in np.arange(step / 2, 1, step)]
    arrows = v[chosen] / speed * 1.3 * step
    ax.quiver(x[chosen], y[chosen], *arrows.T, angles="xy", scale_units="xy", scale=1, pivot="mid", color="white", edgecolor=style.INK,
              linewidth=0.35, width=0.006, headwidth=4, headlength=4, headaxislength=3.5)


def shade(index: int, count: int) -> tuple:
    """Of one resolution among others: the finer, the darker."""
    return style.plt.get_cmap("viridis_r")(0.15 + 0.8 * (index + 1) / count)


def profiles(outcomes: list[Outcome]):
    cases = by_case(outcomes)
    if not cases:
        return None
    figure, axes = style.panels(2 * len(cases), len(cases), 2.7, sharey=True)
    for column, (name, runs) in enumerate(cases.items()):
        above, below = axes[column], axes[column + len(cases)]
        for index, outcome in enumerate(runs):
            got = state(outcome.folder)
            if got is None:
                continue
            _, T, square, _ = got
            colour = shade(index, len(runs))
            above.plot(np.nanmean(T.values, axis=1), T.y, color=colour, label=f"n = {outcome.case.n}")
            columns = history(outcome.folder)
            unit = columns["v_rms_si"][-1] / columns["v_rms"][-1] if columns and columns["v_rms"][-1] > 0 else 1.0
            below.plot(np.sqrt(np.maximum(np.nanmean(square.values, axis=1), 0)) / unit, square.y, color=colour)
        above.set_title(name)
        above.set_xlim(0, 1)
        above.set_xlabel("mean temperature")
        below.set_xlabel("rms of v_x (κ/L)")
        below.set_xlim(left=0)
        for ax in (above, below):
            ax.set_ylim(0, 1)
            if column == 0:
                ax.set_ylabel("height/L")
        above.legend(fontsize=8, loc="lower left")
    return figure


def course(outcomes: list[Outcome]):
    cases = by_case(outcomes)
    if not cases:
        return None
    figure, axes = style.panels(len(cases), 3, 2.5)
    for ax, (name, runs) in zip(axes, cases.items()):
        highest = 1.0
        for index, outcome in enumerate(runs):
            columns = history(outcome.folder)
            if not columns:
                continue
            height = resolved(outcome.folder, "domain", "length_y")
            unit = columns["v_rms_si"][-1] / columns["v_rms"][-1] / height if columns["v_rms"][-1] > 0 else 1.0
            ax.plot(columns["time"] * unit, columns["nusselt_volume"], color=shade(index, len(runs)), linewidth=1.1,
                    label=f"n = {outcome.case.n}")
            highest = max(highest, np.quantile(columns["nusselt_volume"], 0.98))
        reference = references.of(name, runs[-1].summary.get("metrics") or {})
        if reference:
            ax.axhline(reference.values["nusselt_volume"], color=style.INK, linestyle=(0, (4, 3)), linewidth=0.9)
        ax.set_ylim(0.9, 1.15 * highest)
        ax.set_title(name)
        ax.set_xlabel("time (L²/κ)")
        if ax.get_subplotspec().is_first_col():
            ax.set_ylabel("Nu")
        ax.legend(fontsize=8, loc="lower right")
    return figure
