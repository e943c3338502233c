#!/usr/bin/python3
"""The note's air (tables 1 and 2) run on to convection: Nusselt number over time at Ra 1e4, 1e5 and 1e6, by the note's Euler steps and by
those of Adams and Bashforth.

    ./run build && docs/figures/air_to_convection.py

writes docs/figures/air_to_convection.png and prints the table of docs/studies/2026-11-27_air_of_the_notes.md. Runs: output/air_to_convection.
"""
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "programs/python"))
from tetsuame import reading, style  # noqa: E402  (the path is set first)
from tetsuame.compare import references  # noqa: E402

RUNS = ROOT / "output" / "air_to_convection"
CASES = (("1e4", "euler", 24, 400), ("1e5", "euler", 24, 150), ("1e5", "ab2", 24, 150),
         ("1e6", "euler", 24, 60), ("1e6", "ab2", 24, 60), ("1e6", "ab2", 48, 40))
MEASURES = ("nusselt_volume", "nusselt_top", "nusselt_bottom", "v_rms", "u_max", "v_max")
L_OVER_V = {"1e4": 28.81, "1e5": 11.47, "1e6": 4.566}  # s, where the inputs end


def run(rayleigh: str, method: str, n: int, end: float) -> Path:
    folder = RUNS / f"{rayleigh}_{method}_{n}"
    if not (folder / "summary.json").is_file():
        subprocess.run([ROOT / "build/programs/convection", ROOT / f"inputs/note_air_{rayleigh}.nml", "--output", folder, "--set", f"domain.particles_x={n}",
                        "--set", f"domain.particles_y={n}", "--set", f"time.t_end={end}", "--set", f"time.method={method}"], check=False)
    return folder


def main() -> None:
    figure, axes = style.panels(3, 3, 2.8, "Nu")
    for ax, rayleigh in zip(axes, L_OVER_V):
        stops = []
        known = references.STEADY[f"air_{rayleigh}"].values
        print(f"Ra {rayleigh}: known " + ", ".join(f"{name} {known[name]:.4g}" for name in MEASURES))
        for index, (_, method, n, end) in enumerate(case for case in CASES if case[0] == rayleigh):
            history = reading.Columns(run(rayleigh, method, n, end) / "history.csv")
            t, last = history["time"], history["time"][-1]
            ax.plot(t, history["nusselt_volume"], label=f"{'Euler' if method == 'euler' else method}, n = {n}", **style.numbered(index))
            if last < 0.999 * end:
                stops.append((last, style.numbered(index)["color"]))
                print(f"  {method} {n}: blew up at {last:.1f} s")
                continue
            late = t > 0.6 * last
            print(f"  {method} {n}: " + ", ".join(f"{name} {history[name][late].mean():.4g} ± {history[name][late].std():.2g}" for name in MEASURES))
        ax.axhline(known["nusselt_volume"], color=style.INK, linestyle=(0, (4, 3)), linewidth=0.9)
        ax.axvline(L_OVER_V[rayleigh], color=style.GREY, linestyle=":", linewidth=0.9)
        ax.set(title=f"Ra {rayleigh}", xlabel="time (s)", ylim=(0.8, 2.2 * known["nusselt_volume"]), xlim=(0.0, None))
        for time, colour in stops:
            style.stopped(ax, time, None, colour)
        ax.legend(fontsize=8, loc="upper right")
    figure.savefig(ROOT / "docs/figures/air_to_convection.png")


if __name__ == "__main__":
    main()
