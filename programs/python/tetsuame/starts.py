"""Snapshots to start from: particles from arrays, as the programs read them with `&initial file` (docs/start_files.md)."""
from pathlib import Path

import h5py
import numpy as np

from . import writing

# Of each argument: the dataset, its unit in two dimensions of SI where none is said, and whether values must be above 0.
FIELDS = {
    "velocities": ("Velocities", "m/s", False),
    "temperatures": ("Temperature", "K", False),
    "densities": ("Density", "kg/m^3", True),
    "masses": ("Masses", {1: "kg/m^2", 2: "kg/m", 3: "kg"}, True),
    "energies": ("InternalEnergy", "J/kg", False),
    "pressures": ("Pressure", "Pa", False),
}


def write_snapshot(path, *, positions, box, velocities=None, materials=None, temperatures=None, densities=None, masses=None,
                   energies=None, pressures=None, ids=None, units=None, names=()) -> Path:
    """Writes particles to an HDF5 file that `&initial file` takes, and returns its path.

    positions     N x 2 or N x 3 (N, or N x 1, in one dimension)
    box           lengths of the box's edges, those of `&domain`, in the unit of the positions
    velocities    of the positions' shape; not given: at rest
    materials     whole numbers, 0 (lower, outside), 1 (upper, drop), and from 2 on those of `&material`
    names         of the materials, by number: ["lower", "upper", "crust"]. The program then knows them by name; not given: by number
    temperatures, densities, masses, energies (internal), pressures
                  a number for each particle, or one for all. In two dimensions masses are of a metre of depth
    ids           whole numbers, each once; not given: from 1
    units         of arguments that are not in SI units: {"positions": "km", "densities": "g/cm^3"}

    Which of these a problem needs, and what its program refuses: docs/start_files.md. Raises ValueError where arrays do not
    belong together or hold what no particle has, with the first such row.
    """
    units = dict(units or {})
    x = np.asarray(positions, dtype=float)
    x = x[:, None] if x.ndim == 1 else x
    if x.ndim != 2 or x.shape[1] not in (1, 2, 3) or len(x) == 0:
        raise ValueError(f"positions are of shape {np.shape(positions)}: expected N x 1, 2 or 3 of at least one particle")
    number, dimension = x.shape
    edges = np.atleast_1d(np.asarray(box, dtype=float))
    if edges.shape != (dimension,) or not (np.isfinite(edges) & (edges > 0)).all():
        raise ValueError(f"box is {box}: expected {dimension} lengths above 0, as positions have {dimension} components")
    given = {"velocities": np.zeros_like(x) if velocities is None else velocities, "temperatures": temperatures,
             "densities": densities, "masses": masses, "energies": energies, "pressures": pressures}
    known = {"positions", *given}
    if unknown := set(units) - known:
        raise ValueError(f"units of {', '.join(sorted(unknown))}: expected some of {', '.join(sorted(known))}")
    datasets = {"Coordinates": (finite("positions", x), units.get("positions", "m"))}
    for name, values in given.items():
        if values is None:
            continue
        dataset, unit, above_0 = FIELDS[name]
        unit = units.get(name, unit[dimension] if isinstance(unit, dict) else unit)
        shape = (number, dimension) if name == "velocities" else (number,)
        datasets[dataset] = (finite(name, values, shape, above_0), unit)
    whole = {"ParticleIDs": whole_numbers("ids", np.arange(1, number + 1) if ids is None else ids, number)}
    if materials is not None:
        whole["Material"] = whole_numbers("materials", materials, number)
    with writing.replacing(Path(path)) as target, h5py.File(target, "w") as file:
        write_header(file, number, edges, dimension)
        particles = file.create_group("PartType0")
        for name, values in whole.items():
            particles[name] = values
        for name, (values, unit) in datasets.items():
            particles[name] = values
            particles[name].attrs["units"] = unit
        if "Material" in whole and names:
            particles["Material"].attrs["names"] = ", ".join(names)
    return Path(path)


def finite(name: str, values, shape=None, above_0=False) -> np.ndarray:
    """As an array of this shape, one number standing for all; finite, and above 0 if asked."""
    array = np.asarray(values, dtype=float)
    if shape is not None:
        if name == "velocities" and array.ndim == 1:
            array = array[:, None]
        if array.ndim > 0 and array.shape != shape:
            raise ValueError(f"{name} are of shape {array.shape}: expected {shape}, or one number")
        array = np.array(np.broadcast_to(array, shape))
    bad = ~np.isfinite(array) if not above_0 else ~(np.isfinite(array) & (array > 0))
    if bad.any():
        row = int(np.argwhere(bad)[0][0])
        raise ValueError(f"{name}: row {row} is {array[row]}: expected finite numbers{' above 0' if above_0 else ''}")
    return array


def whole_numbers(name: str, values, number: int) -> np.ndarray:
    array = np.broadcast_to(np.asarray(values), (number,)) if np.ndim(values) == 0 else np.asarray(values)
    if array.shape != (number,):
        raise ValueError(f"{name} are of shape {array.shape}: expected ({number},)")
    if not np.issubdtype(array.dtype, np.integer):
        bad = array != np.floor(array)
        if not np.issubdtype(array.dtype, np.floating) or bad.any():
            raise ValueError(f"{name}: row {int(np.argmax(bad)) if bad.ndim else 0} is no whole number")
        array = array.astype(np.int64)
    if (array < 0).any():
        row = int(np.argmax(array < 0))
        raise ValueError(f"{name}: row {row} is {array[row]}: expected 0 or more")
    if name == "ids" and len(np.unique(array)) != number:
        raise ValueError("ids: expected each once")
    return np.array(array)


def write_header(file, number: int, edges: np.ndarray, dimension: int) -> None:
    """GADGET's, with BoxSize in the unit of the places."""
    attributes = file.create_group("Header").attrs
    counts = np.array([number, 0, 0, 0, 0, 0], dtype=np.uint64)
    for name, value in {"NumPart_ThisFile": counts, "NumPart_Total": counts, "NumPart_Total_HighWord": 0 * counts,
                        "MassTable": np.zeros(6), "Time": 0.0, "Redshift": 0.0, "NumFilesPerSnapshot": 1, "HubbleParam": 1.0,
                        "BoxSize": edges if dimension > 1 else float(edges[0]), "Dimension": dimension}.items():
        attributes[name] = value
