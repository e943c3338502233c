"""The figures of states at rest. A figure without data to show is none."""
import numpy as np

from .. import style
from .letters_figures import ROUND_OFF
from .outcomes import COMPLETED, Outcome, passes


def courses(outcomes: list[Outcome], starts: tuple[str, ...], crossing: float):
    """Speed above, error of the pressure below; a column for each start that is no perfect lattice."""
    shown = [start for start in starts if start != "lattice" and any(o.case.file == start and o.history for o in outcomes)]
    if not shown:
        return None
    figure, axes = style.panels(2 * len(shown), len(shown), 2.9, sharex=True, sharey="row")
    for ax, label, limits in ((axes[0], "speed (m/s)", (1e-2, 1e3)), (axes[len(shown)], "mean |p/p_ref − 1|", (1e-4, 1.5))):
        ax.set(ylabel=label, yscale="log", ylim=limits)
    end = max(o.history["time"][-1] for o in outcomes if o.case.file in shown and o.history) / crossing
    axes[0].set_xlim(-0.02 * end, 1.02 * end)
    for k, start in enumerate(shown):
        above, below = axes[k], axes[k + len(shown)]
        for o in outcomes:
            if o.case.file != start or not (columns := o.history):
                continue
            time, mass = columns["time"] / crossing, o.snapshot["Masses"].sum() if o.snapshot else np.nan
            look = {"color": style.COLOUR[o.case.variant], "linewidth": 1.3, "linestyle": (0, (4, 2)) if o.case.variant in style.DASHED else "-"}
            speed = np.sqrt(2 * np.maximum(columns["kinetic_energy"], 0.0) / mass)
            above.plot(time[1:], speed[1:], label=o.case.variant, **look)
            below.plot(time, np.maximum(columns["pressure_error_mean"], ROUND_OFF), **look)
            if o.kind != COMPLETED:
                for ax, value in ((above, speed), (below, columns["pressure_error_mean"])):
                    style.stopped(ax, time[-1], value[-1] if len(time) > 1 else None, style.COLOUR[o.case.variant])
        above.set_title(start)
        below.set_xlabel("crossings of sound")
    style.legend_above(figure, axes[:len(shown)])
    return figure


def chains(outcomes: list[Outcome], case: str):
    """Residuals of the plain iteration, evaluations behind one another."""
    runs = [(o, [value for value in passes(o.folder) if np.isfinite(value)]) for o in outcomes if o.case.file == case]
    runs = [(o, values) for o, values in runs if values]
    if not runs:
        return None
    figure, (ax,) = style.panels(1, 1, 3.2, "largest |ln(Y_new/Y)|")
    for k, (o, values) in enumerate(runs):
        ax.plot(np.arange(1, len(values) + 1), values, marker="o", markersize=3.5, label=o.case.variant, **style.numbered(k))
    ax.set(yscale="log", xlabel="pass", xticks=range(1, 1 + max(len(values) for _, values in runs)))
    style.legend_beside(ax)
    return figure
