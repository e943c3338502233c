"""The figures of the comparison of convection."""
from pathlib import Path

import numpy as np
from matplotlib import colormaps

from ... import style
from ...fields import look
from ...rendering import slice_of
from ...runs import Snapshot
from .. import references
from ..results import history, resolved
from ..runner import COMPLETED, Outcome


def by_case(outcomes: list[Outcome]) -> dict[str, list[Outcome]]:
    cases: dict[str, list[Outcome]] = {}
    for outcome in outcomes:
        if outcome.kind == COMPLETED:
            cases.setdefault(outcome.case.file, []).append(outcome)
    return cases


def state(folder: Path):
    """The last snapshot, rendered: temperature from 0 (top) to 1 (bottom), the square of the horizontal velocity, and the height;
    None if there is none."""
    shown = sorted(folder.glob("snapshot_*.h5"))
    if not shown or "Temperature" not in Snapshot(shown[-1]):
        return None
    snapshot, height = Snapshot(shown[-1]), resolved(folder, "domain", "length_y")
    top, bottom = (resolved(folder, "walls", f"temperature_{side}") for side in ("top", "bottom"))
    temperature = slice_of(snapshot, (snapshot["Temperature"] - top) / (bottom - top), 400, 2, None)
    return snapshot, temperature, slice_of(snapshot, snapshot["Velocities"][:, 0] ** 2, 400, 2, None), height


def width_of(outcome: Outcome) -> float:
    """Of the box, over its height."""
    return resolved(outcome.folder, "domain", "length_x") / resolved(outcome.folder, "domain", "length_y")


def fields(outcomes: list[Outcome]):
    finest = (max(runs, key=lambda o: o.case.n) for runs in by_case(outcomes).values())
    states = [(o.case, s, width_of(o)) for o in finest if (s := state(o.folder)) is not None]
    if not states:
        return None
    columns = min(3, len(states))
    widest = max(width for *_, width in states)
    figure, axes = style.panels(len(states), columns, 3.5 / max(1.0, 0.75 * widest))
    image = None
    for ax, (case, (snapshot, T, _, height), width) in zip(axes, states):
        image = ax.imshow(T.values, origin="lower", extent=[edge / height for edge in T.extent], cmap=look("Temperature").colours, vmin=0, vmax=1,
                          interpolation="bilinear")
        ax.contour(T.x / height, T.y / height, T.values, levels=np.arange(0.1, 0.95, 0.1), colors="white", linewidths=0.7, alpha=0.85)
        draw_arrows(ax, *(snapshot["Coordinates"] / height).T[:2], snapshot["Velocities"][:, :2], width)
        ax.set_title(f"{case.file}, n = {case.n}")
        style.as_map(ax, (0, width), (0, 1))
        ax.set_xticks([0, width], ["0", f"{width:g}"])
        ax.set_yticks([0, 1])
        ax.spines[["top", "right"]].set_visible(True)
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
    ax.quiver(x[chosen], y[chosen], *arrows.T, angles="xy", scale_units="xy", scale=1, pivot="mid", color=style.INK, alpha=0.75,
              width=0.0045, headwidth=4, headlength=4, headaxislength=3.5)


def shade(index: int, count: int) -> tuple:
    return colormaps["viridis_r"](0.15 + 0.8 * (index + 1) / count)


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
            _, T, square, height = got
            colour = shade(index, len(runs))
            above.plot(np.nanmean(T.values, axis=1), T.y / height, color=colour, label=f"n = {outcome.case.n}")
            columns = history(outcome.folder)
            unit = columns["v_rms_si"][-1] / columns["v_rms"][-1] if columns and columns["v_rms"][-1] > 0 else 1.0
            below.plot(np.sqrt(np.maximum(np.nanmean(square.values, axis=1), 0)) / unit, square.y / height, color=colour)
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
