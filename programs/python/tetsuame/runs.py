"""What a run left, as numpy arrays in SI units.

    run = tetsuame.load("output/rti")
    run.history["time"], run.history.units["v_rms"]
    last = run.snapshot()                      # or run.snapshot(time=500.0), run.snapshots[3]
    last["Temperature"], last.units["Temperature"]
    picture = last.map("Pressure")             # rendered by the kernel: rendering.Map

A run is the directory that a program's --output names. Damaged or absent files raise Unreadable, with one sentence.
"""
import bisect
import dataclasses
import functools
from pathlib import Path

import h5py
import numpy as np

from . import rendering
from .reading import Columns, Damaged, Keys, Unreadable, as_hdf5, read_json, read_text, regular

FLUID, WALL = "PartType0", "PartType1"
LAYERS = 10_000  # of a profile
VECTORS = {"Coordinates", "Velocities"}
NUMBERS = {"ParticleIDs", "Masses", "Density", "Volume", "SmoothingLength"}  # that more is made of than pictures
SIDES = (("left", "right"), ("bottom", "top"), ("back", "front"))  # of each axis: at its low end, at its high end


class Snapshot:
    """The particles at one time. Fields are read when they are asked for: (n) or (n, dimension), in SI units."""

    def __init__(self, path: Path):
        self.path = path
        with self._open() as file, as_hdf5(path, "not a snapshot of these programs"):
            header = dict(file["Header"].attrs)
            self.time, self.step = float(header["Time"]), int(header["Step"])
            self.dimension = int(header["Dimension"])
            self.lengths = np.array(header["BoxLengths"], float)[: self.dimension]  # of the box, m
            self.periodic = np.array(header["Periodic"], bool)[: self.dimension]
            fluid = file[FLUID]
            self.names = sorted(fluid)
            units = {name: fluid[name].attrs.get("units", "") for name in self.names}
            self.units = {name: unit.decode() if isinstance(unit, bytes) else str(unit) for name, unit in units.items()}
            materials = fluid["Material"].attrs.get("names", "") if "Material" in fluid else ""
            self.materials = (materials.decode() if isinstance(materials, bytes) else str(materials)).split(", ") if materials else []
            (self.particles,) = fluid["ParticleIDs"].shape
            if not (1 <= self.dimension == len(self.lengths) == len(self.periodic) <= 3 and np.isfinite(self.time)
                    and np.isfinite(self.lengths).all() and (self.lengths > 0).all()):
                raise ValueError(f"Time {self.time:g}, Dimension {self.dimension}, BoxLengths {self.lengths}")

    def __repr__(self):
        return f"<snapshot {self.path.name}: t = {self.time:g} s, {self.particles} particles>"

    def __contains__(self, name):
        return ("Velocities" if name == "Speed" else name) in self.names

    def __getitem__(self, name: str) -> np.ndarray:
        """A field of the fluid; "Speed" is the length of Velocities."""
        if name not in self:
            raise Unreadable(f"{self.path}: no field '{name}' (there are {', '.join(self.names)})")
        return np.linalg.norm(self["Velocities"], axis=1) if name == "Speed" else self._read(FLUID, name)

    def wall(self, name: str) -> np.ndarray:
        """A field of the markers that stand in the walls; empty where there are none."""
        return self._read(WALL, name)

    def unit(self, name: str) -> str:
        return self.units["Velocities" if name == "Speed" else name]

    @functools.cached_property
    def spacing(self) -> np.ndarray:
        """Of each particle's neighbours, m: from its volume, or, in a file of few fields (&output fields), that of the start lattice."""
        if not self.particles:
            raise Damaged(f"{self.path}: holds no particle")
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            if "Radius" in self.names:
                spacing = 2 * self["Radius"]
            elif "Volume" in self.names:
                spacing = np.abs(self["Volume"]) ** (1 / self.dimension)
            elif "Masses" in self.names and "Density" in self.names:
                spacing = np.abs(self["Masses"] / self["Density"]) ** (1 / self.dimension)
            else:
                spacing = np.full(self.particles, self._lattice_spacing())
        if not ((spacing > 0) & (spacing < 4 * self.lengths.max())).all():
            raise Damaged(f"{self.path}: a particle's volume is none in a box of {' x '.join(f'{length:g}' for length in self.lengths)} m")
        return spacing

    def map(self, name: str, pixels: int = 300, axis: int = 2, at: float | None = None) -> rendering.Map:
        """The field over the box, `pixels` along its longer side. In 3-D a slice normal to `axis` through `at` (the middle)."""
        def rendered(values):
            if "Radius" in self:
                return rendering.grains_of(self, values, pixels, axis, at)
            return rendering.slice_of(self, values, pixels, axis, at, self.mirrors if name == "Temperature" else ())

        if name != "Material":
            return rendered(self[name])
        names = tuple(self.materials)
        if len(names) < 3:
            return dataclasses.replace(rendered(self[name]), names=names)
        # Between the first and the third there is no second: that which has the largest share.
        shares = [rendered((self[name] == n).astype(float)) for n in range(len(names))]
        values = np.stack([share.values for share in shares])
        largest = np.where(np.isnan(values[0]), np.nan, np.argmax(values, axis=0))
        return dataclasses.replace(shares[0], values=largest, names=names)

    @functools.cached_property
    def mirrors(self) -> tuple[rendering.Mirror, ...]:
        """What the temperature does at the walls, from the resolved.nml beside: none where no heat is conducted, nor at sides that
        give a flux."""
        path = self.path.parent / "resolved.nml"
        keys = Keys(path) if path.is_file() else {}
        if "walls.thermal" not in keys:
            return ()
        if not any(key.endswith((".conductivity", ".diffusivity")) and keys.real(key) > 0 for key in keys):
            return ()
        found = []
        for axis, sides in enumerate(SIDES[: self.dimension]):
            for side, place, inward in zip(sides, (0.0, float(self.lengths[axis])), (1.0, -1.0)):
                own = keys.get(f"walls.thermal_{side}", "inherit")
                thermal = keys["walls.thermal"] if own == "inherit" else own
                known = thermal == "adiabatic" or (thermal == "fixed" and f"walls.temperature_{side}" in keys)
                if known and not self.periodic[axis] and keys.get(f"walls.slip_{side}") != "free_surface":
                    value = keys.real(f"walls.temperature_{side}") if thermal == "fixed" else None
                    found.append(rendering.Mirror(axis, place, inward, value))
        return tuple(found)

    def column(self, name: str, pixels: int = 300, axis: int = 2) -> rendering.Map:
        """In 3-D, the integral of the field along `axis`: its unit times m."""
        if self.dimension != 3:
            raise Unreadable(f"{self.path}: has {self.dimension} dimensions; a column needs three")
        return rendering.column_of(self, self[name], pixels, axis)

    def profile(self, name: str, axis: int | None = None, bins: int = 0) -> tuple[np.ndarray, np.ndarray]:
        """Means over layers normal to `axis` (y, along which gravity points; in 1-D x), weighted with volume: places, m, and values (nan in an empty layer)."""
        axis = min(1, self.dimension - 1) if axis is None else axis
        bins = bins or max(int(min(self.lengths[axis] / np.median(self.spacing), LAYERS)), 1)
        place = np.clip(self["Coordinates"][:, axis] / self.lengths[axis] * bins, 0, bins - 1).astype(int)
        volume = self.spacing**self.dimension
        weight = np.bincount(place, volume, bins)
        with np.errstate(invalid="ignore"):
            values = np.bincount(place, volume * self[name], bins) / weight
        return (np.arange(bins) + 0.5) * self.lengths[axis] / bins, values

    def _lattice_spacing(self) -> float:
        """By the resolved.nml beside; without one as if the particles filled the box."""
        path = self.path.parent / "resolved.nml"
        keys = Keys(path) if path.is_file() else {}
        if {"domain.length_x", "domain.particles_x"} <= keys.keys():
            return keys.real("domain.length_x") / max(keys.real("domain.particles_x"), 1.0)
        return float((np.prod(self.lengths) / max(self.particles, 1)) ** (1 / self.dimension))

    def _read(self, group: str, name: str) -> np.ndarray:
        with self._open() as file, as_hdf5(self.path, f"{name} is damaged"):
            values = file[group][name][:] if group in file and name in file[group] else np.empty(0)
            if group == FLUID and len(values) != self.particles:
                raise ValueError(f"{len(values)} values for {self.particles} particles")
            columns = values.shape[1:]
            if values.dtype.kind not in "iuf" or name in NUMBERS and columns or len(columns) > 1 or columns and columns[0] < self.dimension:
                raise ValueError(f"{values.dtype} of shape {values.shape}")
            if name in VECTORS and len(values) and not columns:
                raise ValueError("no vector")
            if name == "Coordinates" and not np.isfinite(values[..., : self.dimension]).all():
                raise ValueError("a place is not finite")
        return values[:, : self.dimension] if values.ndim == 2 else values

    def _open(self):
        with as_hdf5(self.path, "cannot be read as HDF5"):
            return h5py.File(regular(self.path), "r")


class Run:
    """A run's directory: `summary` (summary.json; None while the run goes on), `history`, `snapshots` in order of time."""

    def __init__(self, directory: str | Path):
        self.directory = Path(directory)
        if not self.directory.is_dir():
            raise Unreadable(f"{directory}: no such directory")
        if not (self.directory / "resolved.nml").is_file():
            raise Unreadable(f"{directory}: not a run's directory (no resolved.nml in it)")

    def __repr__(self):
        return f"<run {self.directory}: {self.program}, {len(self.snapshots)} snapshots>"

    @functools.cached_property
    def summary(self) -> dict | None:
        path = self.directory / "summary.json"
        return read_json(path, "the program") if path.exists() else None

    @functools.cached_property
    def program(self) -> str:
        """From the first line of resolved.nml: `! rti, every key as run`."""
        return read_text(self.directory / "resolved.nml").partition("\n")[0].lstrip("! ").partition(",")[0].strip() or "unknown"

    @functools.cached_property
    def history(self) -> Columns:
        return Columns(self.directory / "history.csv")

    @functools.cached_property
    def snapshots(self) -> list[Snapshot]:
        found = sorted((Snapshot(path) for path in self.directory.glob("snapshot_[0-9]*.h5")), key=lambda s: (s.time, s.step))
        for other in found[1:]:
            if other.dimension != found[0].dimension:
                raise Damaged(f"{other.path}: has {other.dimension} dimensions, {found[0].path.name} {found[0].dimension}: not of one run")
        return found

    def snapshot(self, time: float | None = None) -> Snapshot:
        """The one nearest in time; the last without a time."""
        if not self.snapshots:
            raise Unreadable(f"{self.directory}: no snapshot in it")
        if time is None:
            return self.snapshots[-1]
        times = [snapshot.time for snapshot in self.snapshots]
        after = bisect.bisect(times, time)
        return min(self.snapshots[max(after - 1, 0): after + 1], key=lambda s: abs(s.time - time))

    def metrics(self) -> dict[str, float]:
        """Numbers of summary.json by name: errors, conservation and metrics."""
        found = {}
        for group in ("errors", "conservation", "metrics"):
            values = (self.summary or {}).get(group)
            for name, value in (values.items() if isinstance(values, dict) else ()):
                if isinstance(value, (int, float)) and not isinstance(value, bool):
                    found[name] = value
        return found


def by_id(first: Snapshot, second: Snapshot, name: str) -> tuple[np.ndarray, np.ndarray]:
    """A field of both, for the particles that both hold, in the order of their IDs."""
    if first.dimension != second.dimension:
        raise Unreadable(f"{first.path} has {first.dimension} dimensions, {second.path} {second.dimension}: no particle is the same")
    _, here, there = np.intersect1d(*(snapshot["ParticleIDs"].astype(np.int64) for snapshot in (first, second)), return_indices=True)
    return first[name][here], second[name][there]

