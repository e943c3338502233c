#!/usr/bin/env python3
"""The same bed of spheres by `granular` and by LAMMPS (lmp, Debian's package lammps), one thread each, in turn: grain-steps a second.

    grains_beside_lammps.py build/programs/granular --across 26 --steps 2000

A cube of ACROSS^3 spheres of diameter 1 and mass 1, with linear springs (k 2e5, 2/7 of it along the surface, damping 50, friction 0.5), on a slope of 26
degrees, periodic but for floor and top. First it is let down, then STEPS steps are timed: median over the repetitions.
"""
import argparse
import json
import os
import re
import statistics
import subprocess
import tempfile
from pathlib import Path

LAMMPS = """units lj
atom_style sphere
boundary p p f
newton off
comm_modify vel yes
region reg block 0 {width} 0 {width} 0 {height} units box
create_box 1 reg
lattice sc {lattice}
region fill block 0.01 {inside} 0.01 {inside} 0.5 {top} units box
create_atoms 1 region fill
set type 1 diameter 1.0 density 1.90985931710274
displace_atoms all random 0.01 0.01 0.01 4321 units box
velocity all create 0.1 8472
neighbor 0.1 bin
neigh_modify delay 0
pair_style gran/hooke/history 200000.0 NULL 50.0 NULL 0.5 1
pair_coeff * *
timestep 1e-4
fix 1 all nve/sphere
fix 2 all gravity 1.0 chute 26.0
fix 3 all wall/gran hooke/history 200000.0 NULL 50.0 NULL 0.5 1 zplane 0.0 NULL
thermo 1000000
run {settle}
run {steps}
"""
NAMELIST = """&domain dimension = 3  length_x = {width}  length_y = {height}  length_z = {width}  periodic_x = T  periodic_z = T /
&granular contact = 'hooke'  stiffness = 2e5 /
&gravity g = 1  incline = 26 /
&material density = 1.90985931710274  restitution = 0.8839  friction = 0.5 /
&walls top = 'open' /
&packing radius = 0.5  high_y = {top}  spacing = 1.037  jitter = 0.3  random_velocity = 0.3 /
&time dt = 1e-4  t_end = 1e6  steps = {settle} /
&output history_interval = 1000000 /
&run checkpoint_seconds = 0 /
"""


def lammps(program: str, folder: Path, numbers: dict) -> tuple[float, int]:
    (folder / "bed.lmp").write_text(LAMMPS.format(**numbers))
    said = subprocess.run([program, "-in", "bed.lmp"], cwd=folder, capture_output=True, text=True, check=True).stdout
    seconds, steps, atoms = re.findall(r"Loop time of (\S+) on 1 procs for (\d+) steps with (\d+) atoms", said)[-1]
    return int(steps) * int(atoms) / float(seconds), int(atoms)


def granular(program: str, folder: Path, numbers: dict) -> tuple[float, int]:
    (folder / "bed.nml").write_text(NAMELIST.format(**numbers))
    summary = lambda: json.loads((folder / "bed/summary.json").read_text())  # noqa: E731
    call = lambda *words: subprocess.run([program, *words, "--output", "bed"], cwd=folder, capture_output=True, check=True)  # noqa: E731
    call("bed.nml")
    before = summary()
    call("--restart", "latest", "--set", f"time.steps={numbers['settle'] + numbers['steps']}")
    after = summary()
    grains = after["fluid_particles"]
    return grains * numbers["steps"] / (after["stepping_seconds"] - before["stepping_seconds"]), grains


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("granular", help="the program")
    parser.add_argument("--lmp", default="lmp", help="LAMMPS (default: %(default)s)")
    parser.add_argument("--across", type=int, default=26, help="spheres along an edge (default: %(default)s)")
    parser.add_argument("--settle", type=int, default=30000, help="steps before those that are timed (default: %(default)s)")
    parser.add_argument("--steps", type=int, default=2000, help="timed (default: %(default)s)")
    parser.add_argument("--repeat", type=int, default=3, help="pairs of runs (default: %(default)s)")
    given = parser.parse_args()
    os.environ["OMP_NUM_THREADS"] = "1"
    width = given.across * 1.037
    numbers = {"width": width, "inside": width - 0.1, "top": width, "height": 2.2 * width, "lattice": 1.037**-3, "settle": given.settle, "steps": given.steps}
    pairs = []
    for _ in range(given.repeat):
        with tempfile.TemporaryDirectory() as name:
            theirs, atoms = lammps(given.lmp, Path(name), numbers)
            ours, grains = granular(str(Path(given.granular).resolve()), Path(name), numbers)
        pairs.append((ours, theirs))
        print(f"granular {ours / 1e6:.2f} M/s ({grains} grains), LAMMPS {theirs / 1e6:.2f} M/s ({atoms}), ratio {ours / theirs:.2f}", flush=True)
    print(f"median ratio {statistics.median(a / b for a, b in pairs):.2f}")


if __name__ == "__main__":
    main()
