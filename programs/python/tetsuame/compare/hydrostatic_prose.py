"""What the page of states at rest says. HTML."""


def setting(viscosity: float, step: float, crossing: float, short: int) -> str:
    return (f"Liquid iron at 10 GPa in the note's box of 20 × 20 particles (file 13), with the viscosity that the note's section 2 chooses, "
            f"η = c ρ_min Δx = {viscosity:.2g} Pa s, so that sound dies within some crossings, and with equal steps of {step} s, 98 % of the "
            f"largest that this viscosity allows (sound alone: 0.55 s). A crossing of sound takes {crossing:g} s. A and B with Newton's method. "
            "Starts: the perfect lattice; places off it by up to 5, 10, 20 % of a spacing along each axis, masses and pressure those of the "
            f"lattice; and a glass: the lattice with 20 %, after {short} crossings by A, the one scheme in which ρ, p and Y agree by its own "
            "equations; all take over its masses, densities and places.")


def parting(runs: list[dict], starts: tuple[str, ...]) -> list[str]:
    """Where C and E part, with the numbers of these runs."""
    text = ["The two forms differ by (Y<sub>i</sub> − Y<sub>j</sub>)(V<sub>i</sub> − V<sub>j</sub>)∇W<sub>ij</sub> with V = Y/p: that product is "
            "Y<sub>i</sub>²/p<sub>i</sub> + Y<sub>j</sub>²/p<sub>j</sub> − Y<sub>i</sub>Y<sub>j</sub>(1/p<sub>i</sub> + 1/p<sub>j</sub>). "
            "On a lattice of equal masses and uniform pressure both factors are zero, in the column the second: there the note's runs could "
            "not tell them apart. They part where neighbours differ in Y and in volume. That is so where the density of the continuity equation "
            "has come apart from the places of the particles: κ = K/p times its error goes into Y = m p̂(ρ)/ρ. Once the smoothed pressure is "
            "uniform, E's force is 2Y<sub>i</sub>/p times the gradient of the sum Σ Y<sub>j</sub>W<sub>ij</sub> that is this pressure, so that "
            "E rests; C's is the gradient of Σ (Y<sub>i</sub>² + Y<sub>j</sub>²)W<sub>ij</sub>/p, which is not uniform where Y is not, so that "
            "C creeps on. From the glass of A, in which p̂(ρ) is the smoothed pressure, they move alike."]
    found = {(one["case"], one["variant"]): one for one in runs if "verdict" in one}
    pairs = [(start, found[start, "C"], found[start, "E"]) for start in starts
             if start != "lattice" and {(start, "C"), (start, "E")} <= found.keys()]
    if pairs:
        text.append("At the end of these runs, C and E: " + "; ".join(
            f"{start}: {c['speed']:.2g} and {e['speed']:.2g} m/s, moved {c['moved']:.2g} and {e['moved']:.2g} Δx, "
            f"error of p {100 * c['pressure_mean']:.2g} and {100 * e['pressure_mean']:.2g} %" for start, c, e in pairs) + ".")
    return text


WITHOUT = """Without correction the smoothed pressure is 27 % low in the row beside a wall and 3 % in the next: 0.59/n in the mean of a box of
n rows between two walls, as on file 12, on which nothing moves. After 1 s of files 11 and 13 the outer rows have given way: by 10⁻⁷ of their
density on file 11, where K/p = 5·10⁵, by 10⁻² on file 13, where it is 11. Larger boxes, the other kernel, four walls: the start."""

DYING = """The note: A in step 2, iteration 2, B in step 1, iteration 2, on files 11 and 12. These programs stop elsewhere because they judge
otherwise. Here their residuals are read as another program may: below its tolerance is converged, growing is diverged, and an evaluation counts
to the step that begins with it. Then <b>iteration 2 is the first in which anything can be seen to grow</b>, on any file, and the step tells how
many evaluations lay below the tolerance. Bold: as in the note. “Sum of one”: the smoothed pressure divided by the kernel's sum, as it is in a
program whose masses come from that sum."""
