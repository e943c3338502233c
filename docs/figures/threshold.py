#!/usr/bin/python3
"""Where Hosono's plain iteration begins to converge: program A on the column over a range of pressures, the
factor by which a pass multiplies the residual, and the passes that the other solvers need.

    ./run build && docs/figures/threshold.py

writes docs/figures/threshold.png and prints the table of docs/studies/2026-11-21_threshold_of_the_plain_iteration.md. Runs: output/threshold.

The factor is fitted to the residuals r_n of the first evaluation, which starts from the exact profile. Left out are
residuals above 0.1, where the equation of state is no longer a straight line in ln rho, those below 1e-13, where
the rounding of p shows, and of what remains the first half, in which all kinds of waves still take part. What is
left is the band of waves about the one with the largest |G|. The start disturbs them all alike (it is concentrated at the walls
and corners), and |G|^n narrows the band as n^(-1/2) in each of two directions: r_n ~ |G|^n/n. So ln(n r_n) is what is
fitted for the plain iteration. Under-relaxed with the optimal exponent, one long wave rules, and ln r_n is fitted.
"""
import argparse
import json
import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "programs/python"))
from tetsuame import style  # noqa: E402  (the path is set first)
from tetsuame.compare.outcomes import residuals  # noqa: E402

plt = style.plt
K_T = 100.0e9          # Pa, bulk modulus of the input at the top
S_MIN = 1.49e-4        # least of the quintic kernel's transfer function at h = 1.2 spacings
RATIOS = (0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.48, 0.49, 0.5, 0.51, 0.52, 0.55, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2)
LINEAR, ROUNDING = 0.1, 1e-13


def plain_theory(ratio):
    """|G| of one pass; ratio = p/K_T."""
    return np.abs(1.0 / ratio - 1.0) * (1.0 - S_MIN)


def optimal_exponent(ratio: float) -> float:
    """The multipliers lie between 1 - w and 1 - w kappa: equal and opposite at w = 2/(1 + kappa)."""
    return min(1.0, 2.0 / (1.0 + 1.0 / ratio))


@dataclass(frozen=True)
class Run:
    converged: bool
    passes: int            # of the first evaluation
    factor: float | None   # a pass; None where too few passes follow one law


def fitted_factor(residual: np.ndarray, band: bool) -> float | None:
    passes = np.flatnonzero(np.isfinite(residual) & (residual < LINEAR) & (residual > ROUNDING)) + 1
    passes = passes[len(passes) // 2:]
    if len(passes) < 3:
        return None
    logarithms = np.log(residual[passes - 1] * (passes if band else 1))
    return float(np.exp(np.polyfit(passes, logarithms, 1)[0]))


def run(binary: Path, folder: Path, ratio: float, settings: tuple[str, ...], band: bool) -> Run:
    settings = (f"initial.pressure={ratio * K_T:.6e}", "time.steps=1", "output.interval=0",
                "hosono.max_iterations=20000", *settings)
    command = [str(binary), str(ROOT / "inputs/hydrostatic_column.nml"), "--output", str(folder)]
    shutil.rmtree(folder, ignore_errors=True)
    for setting in settings:
        command += ["--set", setting]
    done = subprocess.run(command, capture_output=True, text=True, env=os.environ | {"OMP_NUM_THREADS": "1"})
    if done.returncode not in (0, 3):  # 3: diverged, which is a result
        sys.exit(f"{' '.join(command)}: exit status {done.returncode}\n{done.stderr}")
    status = json.loads((folder / "summary.json").read_text())["status"]
    first = residuals(folder)[0].residual
    return Run(status == "completed", len(first), fitted_factor(first, band))


def scan(binary: Path, output: Path) -> dict[str, list[Run]]:
    def series(name, settings):
        return [run(binary, output / f"{name}_{ratio:g}", ratio, settings(ratio),
                    name in ("plain", "uniform")) for ratio in RATIOS]

    return {
        "plain": series("plain", lambda _: ()),
        # A hundredth of the gravity: K_T/p is the same to 0.2 % from top to bottom.
        "uniform": series("uniform", lambda _: ("gravity.g=0.1",)),
        "under_relaxed": series("under_relaxed", lambda ratio: ("hosono.solver=under_relaxed",
                                                                f"hosono.relaxation={optimal_exponent(ratio):.6f}")),
        "default": series("default", lambda _: ("hosono.solver=under_relaxed",)),
        "anderson": series("anderson", lambda _: ("hosono.solver=anderson",)),
        "newton": series("newton", lambda _: ("hosono.solver=newton",)),
    }


def draw_factors(ax, runs: dict[str, list[Run]]) -> None:
    fine = np.linspace(RATIOS[0], RATIOS[-1], 1001)
    ax.plot(fine, plain_theory(fine), color=style.GREY, linewidth=4, alpha=0.4,
            label="theory, plain: |K_T/p − 1| (1 − S_min)")
    relaxed = fine[fine <= 1]  # beyond, the best exponent is above 1: no relaxation any more
    ax.plot(relaxed, (1 - relaxed) / (1 + relaxed), color=style.GREY, linewidth=1.2, linestyle="--",
            label="theory, exponent 2/(1 + K_T/p)")
    ax.axhline(1.0, color=style.INK, linewidth=0.9)
    ax.annotate("|G| = 1", (RATIOS[-1], 1.0), xytext=(0, 4), textcoords="offset points", ha="right", fontsize=8.5)
    for name, colour, filled, label in (
            ("plain", style.COLOUR["D"], False, "column"), ("uniform", style.COLOUR["C"], True, "column, g/100")):
        for converged, marker, words in ((False, "X", "diverged"), (True, "o", "converged")):
            points = [(ratio, one.factor) for ratio, one in zip(RATIOS, runs[name])
                      if one.converged == converged and one.factor is not None]
            if points:
                ax.plot(*zip(*points), linestyle="", marker=marker, markersize=7 if not filled else 4.5, color=colour,
                        markerfacecolor=colour if filled else "none", label=f"plain, {label}: {words}", zorder=4)
    points = [(ratio, one.factor) for ratio, one in zip(RATIOS, runs["under_relaxed"])
              if one.factor is not None and ratio <= 1]
    ax.plot(*zip(*points), linestyle="", marker="d", markersize=4.5, color=style.COLOUR["F"],
            label="under-relaxed, that exponent")
    ax.set_yscale("log")
    ax.set_ylim(0.008, 6)
    ax.set_yticks([0.01, 0.1, 1], ["0.01", "0.1", "1"])
    ax.set_ylabel("factor on the residual in a pass")


def draw_passes(ax, runs: dict[str, list[Run]]) -> None:
    for name, colour, marker, label in (
            ("plain", style.COLOUR["D"], "o", "plain, as far as it converges"),
            ("default", style.COLOUR["A"], "s", "under-relaxed, ω = p/K_T (default)"),
            ("under_relaxed", style.COLOUR["F"], "d", "under-relaxed, ω = 2/(1 + K_T/p)"),
            ("anderson", style.COLOUR["C"], "^", "Anderson"), ("newton", style.COLOUR["B"], "v", "Newton")):
        points = [(ratio, one.passes) for ratio, one in zip(RATIOS, runs[name])
                  if one.converged and (ratio <= 1 or name in ("plain", "anderson", "newton"))]
        if points:
            ax.plot(*zip(*points), color=colour, marker=marker, markersize=4.5, linewidth=1.2, label=label)
    ax.set_yscale("log")
    ax.set_yticks([1, 10, 100, 1000], ["1", "10", "100", "1000"])
    ax.set_ylabel("passes until converged")


def draw(runs: dict[str, list[Run]], path: Path) -> None:
    figure, axes = style.panels(2, 2, 4.6)
    draw_factors(axes[0], runs)
    draw_passes(axes[1], runs)
    for ax in axes:
        ax.axvline(0.5, color=style.GREY, linewidth=0.9, linestyle=":")
        ax.set_xlabel("p/K_T at the top of the column")
        ax.legend(fontsize=7.5, loc="lower left" if ax is axes[0] else "upper right")
    figure.savefig(path, dpi=110)
    plt.close(figure)


def table(runs: dict[str, list[Run]]) -> str:
    def factor(one):
        return "–" if one.factor is None else f"{one.factor:.3f}"

    lines = ["| p/K_T | theory | measured, g/100 | measured, column | plain: passes | under_relaxed, optimal | "
             "its theory | default | optimal | anderson | newton |", "|" + "---|" * 11]
    for index, ratio in enumerate(RATIOS):
        at = {name: series[index] for name, series in runs.items()}
        plain = at["plain"]
        lines.append("| " + " | ".join((
            f"{ratio:g}", f"{plain_theory(ratio):.3f}", factor(at["uniform"]), factor(plain),
            f"{'converged' if plain.converged else 'diverged'}, {plain.passes}", factor(at["under_relaxed"]),
            f"{(1 - ratio) / (1 + ratio):.3f}" if ratio <= 1 else "–",
            *(f"{at[name].passes}" if at[name].converged else "no" for name in
              ("default", "under_relaxed", "anderson", "newton")))) + " |")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n\n")[0])
    parser.add_argument("--binaries", default=ROOT / "build/programs", type=Path, help="folder of the programs")
    parser.add_argument("--output", default=ROOT / "output/threshold", type=Path, help="folder of the runs")
    given = parser.parse_args()
    runs = scan(given.binaries / "disph_a", given.output)
    draw(runs, Path(__file__).with_suffix(".png"))
    print(table(runs))


if __name__ == "__main__":
    main()
