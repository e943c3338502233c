"""The explanation in the report, with the numbers of these runs. Derivations: docs/theory."""
import math
from html import escape

from . import note
from .cases import CURES
from .outcomes import COMPLETED, Outcome, representatives, residuals
from .table import accuracy_order, agreement_in_place, error, files, note_says, place, set_otherwise

# Properties of the quintic kernel at h = 1.2 spacings on the square lattice, derived in
# docs/theory/lattice_sum.md and docs/theory/hosono_iteration.md.
LATTICE_SUM_DEFICIT = 5.622e-5
FIRST_ROW_SUM = 0.733   # of the kernel sum, with nothing behind the wall


def beside_the_note(outcomes: list[Outcome]) -> list[str]:
    """What of these runs is not as in the note's table 2: settings, and step and iteration of those that diverge."""
    text = []
    if others := list(dict.fromkeys(f"{o.case.label} on file {o.case.file}: {'; '.join(differ)}"
                                    for o in outcomes if (differ := set_otherwise(o)))):
        text.append(f"<b>Not the note's settings.</b> {escape('. '.join(others))}.")
    moved = [where_it_stopped(o) for o in outcomes if agreement_in_place(o) == "no"]
    if moved:
        text.append(f"<b>Not the note's step and iteration.</b> {escape(' '.join(moved))}")
        text.append(
            "That the plain iteration diverges follows from |G| > 1 (below) and from no time step; when, from the size of "
            "the first disturbance, and from what a program takes for the end of an iteration and of a step. These programs "
            "count as converged a residual below the tolerance that did not grow in the last pass, stop in the pass in which a pressure is "
            "not positive, and count the forces at the end of a step to that step, where others have them at the beginning of "
            "the next. The note tells neither its tolerance nor how it counts; <code>./run compare hydrostatic</code> shows with which of these its "
            "step and iteration come out.")
    return text


def where_it_stopped(outcome: Outcome) -> str:
    """'A on file 12: step 1, iteration 16; the note: ….' with what residuals.csv has of the evaluations before."""
    said = f"{outcome.case.label} on file {outcome.case.file}: {place(outcome)}; the note: {note_says(outcome)}"
    course = residuals(outcome.folder)
    if not course:
        return f"{said}."
    *settled, last = course
    if settled:
        said += (f". {len(settled)} evaluation{'s' if len(settled) > 1 else ''} before it settled, in at most "
                 f"{max(len(one.iteration) for one in settled)} passes")
    if len(last.residual) > 1:
        said += f"; the residual of the last one grew from {min(last.residual):.1e} in {len(last.residual)} passes"
    elif not math.isfinite(last.residual[0]):
        said += "; its first pass leaves a pressure that is not positive"
    return f"{said}."


def iteration(outcomes: list[Outcome]) -> list[str]:
    """Why the plain iteration diverges, and what cures it."""
    text = [
        "The iteration of A and B keeps positions, masses and temperatures and repeats "
        "<code>p_i = Σ_j Y_j W_ij</code>, <code>ρ_i = m_i p_i / Y_i</code>, "
        "<code>Y_i ← m_i p̂(ρ_i, T_i) / ρ_i</code>. One pass multiplies a perturbation of ln Y with wave number k by "
        "<b>G = −(κ − 1)(1 − S(k))</b>, where κ = K_T/p is the equation of state's stiffness and S(k) what the smoothing "
        "lets through. Perturbations from particle to particle are smoothed away almost wholly (S ≈ 0), so for them "
        "|G| ≈ κ − 1: the iteration converges only if p &gt; K_T/2. An ideal gas at fixed energy has κ = 1 and "
        "converges at once; for a liquid at the pressures of planetary interiors κ is well above 2, and no time step helps."]
    rows = []
    for outcome in outcomes:
        kappa = outcome.number("metrics", "hosono_kappa")
        growth = outcome.number("metrics", "hosono_growth_predicted")
        if outcome.case.program == "A" and not outcome.case.variant and kappa is not None and growth and growth > 1:
            passes = math.ceil(-math.log(2.2e-16) / math.log(growth))
            rows.append(f"file {outcome.case.file}: κ = {kappa:.3g}, |G| = {growth:.3g}, so that even round-off "
                        f"reaches order one in {passes} passes")
    if rows:
        text.append("In these runs: " + "; ".join(rows) + ". A run that stops sooner began with a larger disturbance than round-off.")
    cured = [o for o in outcomes if o.case.variant in CURES and o.kind == COMPLETED]
    if cured:
        most: dict[str, int] = {}
        for outcome in cured:
            passes = [len(one.iteration) for one in residuals(outcome.folder)]
            most[outcome.case.variant] = max([most.get(outcome.case.variant, 0), *passes])
        counts = ", ".join(f"{name} {passes}" for name, passes in sorted(most.items()) if passes)
        text.append("The solution is there, only the way to it was wrong: with another solver of the same equations "
                    + " and ".join(sorted({o.case.program for o in cured}))
                    + (" complete" if len({o.case.program for o in cured}) > 1 else " completes")
                    + (f" (most passes in one evaluation: {counts})." if counts else "."))
    return text


def limit(outcomes: list[Outcome]) -> list[str]:
    """The limit that no solver removes: the lattice sum."""
    text = [
        f"On the square lattice the quintic kernel at h = 1.2 spacings sums to 1 − {LATTICE_SUM_DEFICIT:g}, not 1. "
        "Where the iteration has converged, the density is low by that factor and the pressure by "
        f"{LATTICE_SUM_DEFICIT:.1e} K_T, a few MPa. Against 10 GPa that is little; "
        "at 10⁵ Pa (file 11) it means that no consistent state with p &gt; 0 exists, "
        "and a solver can only say so. C, D and E take the density from the continuity equation, so that only "
        f"their smoothed pressure is low, by {LATTICE_SUM_DEFICIT:.1e} of itself. F does not smooth and has no such error."]
    normalised = [o for o in outcomes if "normalised" in o.case.variant and o.kind == COMPLETED]
    if normalised:
        names = " and ".join(sorted({o.case.program for o in normalised}))
        text.append(f"Dividing the smoothed pressure by the kernel sum (<code>smoothing.normalise</code>) restores the "
                    f"solution: {names} with Newton's method then completes file 11.")
    return text


def walls(outcomes: list[Outcome]) -> list[str]:
    """What a missing half of the kernel does."""
    text = [
        f"Without boundary correction nothing stands behind a wall. In the row next to it the kernel sums to {FIRST_ROW_SUM}, "
        f"so that the smoothed pressure is {100 * (1 - FIRST_ROW_SUM):.0f} % low there. In B the first pass takes that for a density "
        "27 % low, which a liquid answers with a negative pressure: it stops in the first step. In D the density is "
        "integrated and survives, but the pressure drops towards the wall and drives the outermost rows towards it: "
        "these are the displacements near the walls. With virtual markers (A, C, E, F) the wall particles carry "
        "on the pressure field, with its gradient when there is gravity."]
    b = [error(o, "pressure_mean") for o in outcomes
         if o.case.program == "B" and o.case.variant in CURES and o.kind == COMPLETED]
    if b := [value for value in b if value is not None]:
        text.append(f"The cured B reaches the solution of its equations, but that is not the physical state: its mean pressure error is "
                    f"{span([100 * value for value in b], '.0f')} %. The density that is missing at the wall must be made up by "
                    "neighbours, and the stiffer the liquid, the further in this is felt: it falls by a factor of e over about "
                    "0.6 √κ spacings.")
    orders = [f"file {file}: {order}" for file in files(outcomes) if (order := accuracy_order(outcomes, file))]
    if orders:
        text.append(f"The note finds {note.ACCURACY_ORDER.replace('>', '&gt;')}, best first. By the mean pressure error "
                    f"of these runs: {'; '.join(orders).replace('>', '&gt;')} (“=”: within 1 %).")
    return text


def cost(outcomes: list[Outcome]) -> list[str]:
    """The price of the wall correction."""
    text = []
    ratios, shares = [], []
    for file in files(outcomes):
        runs = {o.case.program: o for o in representatives(outcomes, file) if not o.case.variant}
        if "C" in runs and "D" in runs and runs["C"].cost_per_step and runs["D"].cost_per_step:
            ratios.append(runs["C"].cost_per_step / runs["D"].cost_per_step)
        shares += [share for name in ("C", "E", "F") if name in runs
                   and (share := runs[name].wall_share) is not None]
    if ratios:
        text.append(f"The note's correction doubled the run time (× {note.COST_OF_CORRECTION:g}). Here a step of C takes "
                    f"{span(ratios, '.2f')} times as long as one of D, which differ in the correction alone.")
    if shares:
        text.append(f"The stages that treat walls take {span([100 * share for share in shares], '.0f')} % of the time of "
                    "C, E and F. This box has few particles and many of them near a wall, so that in larger boxes it is less.")
    text.append("The times are of runs side by side, the evaluations for history.csv included: other work on the machine shows in them. "
                "<code>./run compare --jobs 1 --fresh</code> on an idle machine compares the programs best.")
    return text


def span(values: list[float], form: str) -> str:
    """The range of the values, or the one value if they print alike."""
    low, high = format(min(values), form), format(max(values), form)
    return low if low == high else f"{low} to {high}"
