#!/usr/bin/python3
"""Stands in for the programs of the subjects: writes what they write, made up but of the right shape, with errors that are powers
of n, so that the orders are known.

FAKE_FAIL in the environment, 'CASE:WORD': runs of that case whose n or settings hold the word stop as diverged.
"""
import json
import os
import re
import sys
from pathlib import Path

import h5py
import numpy as np


def main() -> int:
    program, source, folder = Path(sys.argv[0]).name, Path(sys.argv[1]), Path(sys.argv[sys.argv.index("--output") + 1])
    settings = dict(sys.argv[i + 1].split("=", 1) for i, word in enumerate(sys.argv) if word == "--set")
    folder.mkdir(parents=True)
    if "initial.file" in settings and not Path(settings["initial.file"]).is_file():
        return 2
    n = int(settings.get("domain.particles_x", 20))
    case, _, word = os.environ.get("FAKE_FAIL", "").partition(":")
    stopped = bool(word) and folder.parent.name == case and (word in (str(n), program) or word in settings.values())
    message = "step 53: the smoothed pressure is not positive, or the flow has blown up" if stopped else ""
    made_by = (at_rest if source.stem.startswith("hydrostatic") else contact if source.stem == "contact"
               else {"convection": convection, "shock": shock}.get(program, rti))
    errors, metrics, fields, columns, groups = made_by(n, source, settings, stopped)
    with open(folder / "resolved.nml", "w") as file:
        for name, keys in groups.items():
            file.write(f"&{name}\n" + "".join(f"  {key} = {value}\n" for key, value in keys.items()) + "/\n")
    if made_by is at_rest:  # E holds, the others move by a spacing in 227 crossings
        for k in range(3):
            fields["Displacement"] = np.full((n * n, 3), [0.1 * k * 1e5 / n if program != "disph_e" else 0.0, 0.0, 0.0])
            write_snapshot(folder / f"snapshot_{k:04}.h5", 500.0 * k, fields, groups)
        with open(folder / "residuals.csv", "w") as file:
            file.write("step [1],evaluation [1],iteration [1],residual [1]\n" + "".join(f"1,1,{k + 1},{1e-12 * 10.0**k}\n" for k in range(12)))
    else:
        if made_by is contact:
            write_snapshot(folder / "snapshot_0000.h5", 0.0, fields, groups)
        write_snapshot(folder / "snapshot_0001.h5", 500.0, fields, groups)
    with open(folder / "history.csv", "w") as file:
        file.write(",".join(f"{name} [1]" for name in columns) + "\n")
        for row in zip(*columns.values()):
            file.write(",".join(f"{value:.9g}" for value in row) + "\n")
    (folder / "summary.json").write_text(json.dumps({
        "program": program, "status": "diverged" if stopped else "completed", "message": message, "steps": 53, "time": 531.0 if stopped else 5000.0,
        "rhs_evaluations": 100 * n, "stepping_seconds": 0.01 * n, "particle_updates_per_second": 1e6, "diverged_step": 53 if stopped else None,
        "diverged_iteration": None, "errors": errors, "conservation": {"mass": 0.0, "momentum": 0.0, "energy": 1e-6},
        "metrics": metrics, "version": "0000000"}))
    return 3 if stopped else 0


def write_snapshot(path, time, fields, groups) -> None:
    with h5py.File(path, "w") as file:
        lengths = [float(groups["domain"].get(f"length_{axis}", 1.0)) for axis in "xyz"] if "domain" in groups else [1.0] * 3
        file.create_group("Header").attrs.update(Time=time, Step=53, Dimension=groups.get("domain", {}).get("dimension", 2), BoxLengths=lengths, Periodic=[0, 0, 0])
        count = len(next(iter(fields.values())))
        own = {"ParticleIDs": np.arange(count), "Volume": np.full(count, lengths[0] * lengths[1] / count)}
        for name, values in (own | fields).items():
            file[f"PartType0/{name}"] = values


def square(n: int) -> np.ndarray:
    axis = (np.arange(n) + 0.5) / n
    x, y = (a.ravel() for a in np.meshgrid(axis, axis))
    return np.column_stack([x, y, np.zeros_like(x)])


def convection(n, source, settings, stopped):
    right = {"blankenbach_1a": (4.884409, 42.864947, 1e4, 1e25), "air_1e4": (2.158076, 14.21954, 1e4, 0.71)}[source.stem]
    x = square(n)
    swirl = np.column_stack([-np.cos(np.pi * x[:, 1]) * np.sin(np.pi * x[:, 0]), np.sin(np.pi * x[:, 1]) * np.cos(np.pi * x[:, 0]), 0 * x[:, 0]])
    t = np.linspace(0, 1, 30)
    nusselt = right[0] * (1 + n**-2.0)
    metrics = {"nusselt_volume": nusselt, "nusselt_volume_uncertainty": 1e-5, "nusselt_top": nusselt, "nusselt_bottom": nusselt,
               "v_rms": right[1] * (1 - n**-2.0), "v_rms_uncertainty": 1e-4, "steady": True, "heat_imbalance": 1e-4,
               "rayleigh": float(settings.get("convection.rayleigh", right[2])), "prandtl": right[3]}
    columns = {"time": t, "nusselt_volume": nusselt + 0 * t, "v_rms": right[1] + 0 * t, "v_rms_si": right[1] + 0 * t}
    groups = {"domain": {"length_x": 1.0, "length_y": 1.0, "particles_y": n}, "walls": {"temperature_top": 0.0, "temperature_bottom": 1.0}}
    return None, metrics, {"Coordinates": x, "Velocities": swirl, "Temperature": 1 - x[:, 1]}, columns, groups


def shock(n, source, settings, stopped):
    flat = source.stem == "square"
    x = square(n) if flat else np.column_stack([(np.arange(n) + 0.5) / n, np.zeros(n), np.zeros(n)])
    exact = 1.0 + x[:, 0]
    # The fine run of the blasts has the exact density, the others are half above.
    off = 0.0 if n > 40 else 0.5 if source.stem == "blasts" else 1.0 / n
    fields = {"Coordinates": x, "Velocities": 0.1 * x, "Density": exact + off, "Pressure": np.ones(len(x)), "Masses": (exact + off) / len(x)}
    errors, metrics = None, {"scheme": settings["shock.scheme"]}
    if source.stem == "sod":
        errors = {"density_l1": 1.0 / n, "velocity_l1": 0.5 / n, "pressure_l1": 2.0 / n}
        fields |= {"DensityReference": exact, "PressureReference": np.ones(len(x)), "VelocitiesReference": 0.1 * x}
    if flat:
        metrics |= {"square_area_change": 0.04, "square_corner_radius": 0.3}
    groups = {"domain": {"dimension": 2 if flat else 1, "length_x": 1.0, "length_y": 1.0}}
    return errors, metrics, fields, {"time": [0.0, 1.0]}, groups


def contact(n, source, settings, stopped):
    """n: along x, a quarter of the height's. The pressure is off by 1/n at the contact, and by nothing elsewhere."""
    high, wide, gravity = 4 * n, 2.5e4, float(settings.get("rti.gravity", 0.0))
    x, y = (a.ravel() for a in np.meshgrid((np.arange(n) + 0.5) * wide / n, (np.arange(high) + 0.5) * wide / n))
    density = np.where(y < 2 * wide, 7000.0, 3000.0)
    rest = 1e10 + gravity * (3000.0 * np.minimum(4 * wide - y, 2 * wide) + 7000.0 * np.maximum(2 * wide - y, 0.0))
    near = np.abs(y - 2 * wide) < 4 * wide / n
    fields = {"Coordinates": np.column_stack([x, y, 0 * x]), "Velocities": np.column_stack([0 * x + 3.0, 0 * x + 4.0, 0 * x]),
              "Pressure": rest * (1 + near / n), "DensityReference": density}
    groups = {"domain": {"length_x": wide, "length_y": 4 * wide, "particles_x": n},
              "rti": {"gravity": gravity, "p_top": 1e10}, "expert": {"shear": float(settings.get("rti.shear", 0.0))}}
    return None, {"v_rms": 5.0}, fields, {"time": [0.0, 50.0], "v_rms": [0.0, 5.0]}, groups


def rti(n, source, settings, stopped):
    theory = 2.29e-3
    x = square(n)
    t = np.linspace(0, 1400, 20)
    single = 1e-6 if settings.get("kernel.precision") == "single" else 0.0
    metrics = {"growth_rate": theory * (1 + n**-2.0) * (1 + single), "growth_rate_theory": theory, "growth_rate_uncertainty": 1e-7,
               "metal_centroid": 0.3, "density_ratio_min": 0.9, "density_ratio_max": 1.15, "pressure_min": 1e9, "energy_residual": 1e-4}
    columns = {"time": t, "centroid": 0.75 - 1e-4 * t, "density_ratio_min": 1 - 1e-5 * t, "density_ratio_max": 1 + 1e-5 * t,
               "mode_amplitude": 750 * np.exp(theory * t)}
    fields = {"Coordinates": 1.5e6 * x, "Material": (x[:, 1] > 0.5).astype(float)}
    return None, metrics, fields, columns, {"domain": {"length_x": 1.5e6, "length_y": 1.5e6}}


def at_rest(n, source, settings, stopped):
    x = square(n) * 1e5
    fields = {"Coordinates": x, "Velocities": np.full_like(x, 0.1), "Pressure": np.full(n * n, 1.01e10), "PressureReference": np.full(n * n, 1e10),
              "Masses": np.ones(n * n), "Weight": np.linspace(0.9, 1.1, n * n)}
    t = np.linspace(0, 1000, 20)
    columns = {"time": t, "kinetic_energy": 100 * np.exp(-t / 300), "pressure_error_mean": 0.01 + 0 * t}
    return {"density_max": 0.01, "displacement_max_over_dx": 0.04}, {}, fields, columns, {"domain": {"length_x": 1e5, "length_y": 1e5}}


if __name__ == "__main__":
    sys.exit(main())
