"""How each field is shown: what it is called on a picture, in which colours, in which unit."""
from dataclasses import dataclass

import numpy as np

from .reading import Unreadable


@dataclass
class Look:
    label: str
    colours: str = "viridis"
    logarithmic: bool = False


# Sequential colours: a diverging map would set a value apart that means nothing.
LOOKS = {
    "Pressure": Look("pressure", "viridis"), "Density": Look("density", "cividis"), "Temperature": Look("temperature", "inferno"),
    "Speed": Look("speed", "magma"), "Material": Look("material", "copper"),
    "Viscosity": Look("viscosity", "cividis", logarithmic=True), "InternalEnergy": Look("internal energy", "inferno"),
    "MeltFraction": Look("melt fraction", "inferno"), "Volume": Look("volume", "cividis")}

# What is shown if nothing is asked for, in this order, where it is there and varies.
FIRST = ["Temperature", "Material", "Density", "Pressure", "Speed"]
OF_WATER = ["Pressure", "Speed"]  # with a free surface: its density says the same as its pressure
NOT_SHOWN = {"Coordinates", "Velocities", "ParticleIDs", "Masses"}

# Powers of ten that a reader knows the name of.
PREFIXES = {"Pa": [(1e9, "GPa"), (1e6, "MPa"), (1e3, "kPa")], "m": [(1e3, "km")],
            "s": [(3.15576e13, "Myr"), (3.15576e7, "yr"), (86400.0, "d"), (3600.0, "h")]}


def look(name: str) -> Look:
    """Of a field without an entry: its name, in words."""
    words = "".join(" " + letter.lower() if letter.isupper() else letter for letter in name).strip()
    return LOOKS.get(name, Look(words))


def scaled(unit: str, largest: float) -> tuple[float, str]:
    """What to divide by, and the unit then, so that the largest number is no less than one."""
    for size, name in PREFIXES.get(unit, []):
        if abs(largest) >= size:
            return size, name
    return 1.0, unit


def label(name: str, unit: str) -> str:
    return (look(name).label + bracketed(unit)).replace("$", r"\$")  # no equation


def bracketed(unit: str) -> str:
    """A unit behind what it is of; nothing for a number without."""
    return f" [{unit.replace('^2', '²').replace('^3', '³')}]" if unit not in ("", "1") else ""


def is_water(snapshot) -> bool:
    return "FreeSurface" in snapshot


def limits(snapshots: list, name: str) -> tuple[float, float]:
    """Of a field over several snapshots, without the outermost thousandth: one particle's excess would hide the rest."""
    finite = [values[np.isfinite(values)] for values in (snapshot[name] for snapshot in snapshots)]
    each = [np.quantile(values, [0.001, 0.999]) for values in finite if len(values)] or [(0.0, 0.0)]
    low, high = min(pair[0] for pair in each), max(pair[1] for pair in each)
    return (low, high) if high > low else (low - 0.5, high + 0.5)


def shown(snapshot, wanted: list[str] | None = None, most: int = 4) -> list[str]:
    """The fields to show: those wanted, or the first few that are not the same everywhere."""
    if wanted:
        for name in wanted:
            if snapshot[name].ndim > 1:  # refused by its name if it is not there
                raise Unreadable(f"{snapshot.path}: {name} is a vector, and what is drawn is a number (Speed is the length of Velocities)")
        return wanted
    others = [name for name in snapshot.names if name not in FIRST and name not in NOT_SHOWN]
    there, found = [name for name in [*FIRST, *others] if name in snapshot and snapshot[name].ndim == 1], []
    for name in [name for name in OF_WATER if name in there] if is_water(snapshot) else there:
        values = snapshot[name][np.isfinite(snapshot[name])]
        if len(found) < most and len(values) and np.ptp(values) > 1e-9 * np.abs(values).max():
            found.append(name)
    return found or [*there, *(name for name in ("Masses", "ParticleIDs") if name in snapshot)][:1]
