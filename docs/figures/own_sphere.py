"""A sphere of 100 000 particles from Python: core of iron, mantle of basalt (Tillotson), which turns and flies; nothing pulls.

python3 docs/figures/own_sphere.py FOLDER       writes FOLDER/sphere.h5 and FOLDER/sphere.nml, for build/programs/shock
python3 docs/figures/own_sphere.py FOLDER RUN   tells mass, momentum and angular momentum at the start and the end of the run
"""
import pathlib
import re
import subprocess
import sys

import h5py
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "programs/python"))
import tetsuame  # noqa: E402

NUMBER, R, CORE, EDGE, TURN = 100_000, 1e6, 5e5, 3e6, 1e-4  # m, rad/s
INPUT = f"""&domain
  dimension = 3
  length_x = {EDGE}  length_y = {EDGE}  length_z = {EDGE}
  particles_x = 86  particles_y = 86  particles_z = 86
/
&initial
  file = 'sphere.h5'
/
&shock
  scheme = 'disph'  weight = 'volume'  masses = 'equal_spacing'
  eos_l = 'tillotson'  tillotson_l = 'iron'    temperature_l = 300.0  p_l = 1e5
  eos_r = 'tillotson'  tillotson_r = 'basalt'  temperature_r = 300.0  p_r = 1e5
/
&time
  t_end = 60.0
/
"""


def shells(number: int, radius: float) -> np.ndarray:
    """Points of equal share on spirals over spheres: a shell a spacing, each with so many as its area has room for."""
    dx = (4 / 3 * np.pi * radius**3 / number) ** (1 / 3)
    radii = (np.arange(round(radius / dx)) + 0.5) * radius / round(radius / dx)
    share = np.cumsum(radii**2) / (radii**2).sum()
    ends = np.round(share * number).astype(int)
    turn = np.pi * (3 - np.sqrt(5))
    all_points = []
    for r, n, k in zip(radii, np.diff(ends, prepend=0), range(len(radii))):
        z = 1 - (2 * np.arange(n) + 1) / max(n, 1)
        angle = turn * np.arange(n) + k
        flat = np.sqrt(1 - z * z)
        all_points.append(r * np.stack([flat * np.cos(angle), flat * np.sin(angle), z], axis=1))
    return np.concatenate(all_points)


def make(folder: pathlib.Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "sphere.nml").write_text(INPUT)
    # The densities at these pressures and temperatures, of the program's own equations of state.
    bare = re.sub(r"&initial.*?/\n", "", INPUT, flags=re.DOTALL)
    (folder / "densities.nml").write_text(bare)
    said = subprocess.run([ROOT / "build/programs/shock", folder / "densities.nml", "--check"], capture_output=True, text=True, check=True).stdout
    rho_core, rho_mantle = (float(re.search(rf"rho_{side} = (\S+)", said)[1]) for side in "lr")
    x = shells(NUMBER, R)
    core = np.hypot(np.hypot(x[:, 0], x[:, 1]), x[:, 2]) < CORE
    rho = np.where(core, rho_core, rho_mantle)
    turning = TURN * np.stack([-x[:, 1], x[:, 0], 0 * x[:, 0]], axis=1)
    tetsuame.write_snapshot(folder / "sphere.h5", positions=x + EDGE / 2, box=[EDGE] * 3, velocities=turning + [50.0, 0.0, 0.0], densities=rho,
                            masses=rho * 4 / 3 * np.pi * R**3 / NUMBER, materials=np.where(core, 0, 1), temperatures=300.0)


def tell(run: pathlib.Path) -> None:
    for path in [min(run.glob("snapshot_*.h5")), max(run.glob("snapshot_*.h5"))]:
        with h5py.File(path) as file:
            f = file["PartType0"]
            m, x, v, t = f["Masses"][:], f["Coordinates"][:], f["Velocities"][:], file["Header"].attrs["Time"]
        momentum, centre = (m[:, None] * v).sum(axis=0), (m[:, None] * x).sum(axis=0) / m.sum()
        spin = (m[:, None] * np.cross(x - centre, v)).sum(axis=0)
        print(f"t = {float(t):.6g} s: mass {m.sum():.12e} kg, momentum {momentum[0]:.12e} kg m/s along x, angular momentum {spin[2]:.12e} kg m2/s")


if __name__ == "__main__":
    tell(pathlib.Path(sys.argv[2])) if len(sys.argv) > 2 else make(pathlib.Path(sys.argv[1]))
