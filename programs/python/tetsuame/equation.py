"""The picture of an equation of state, from what `plan eos --output` wrote: `tetsuame eos DIR`."""
from pathlib import Path

import numpy as np

from . import style, tables, writing
from .reading import Damaged

KINDS = ("isotherm", "isentrope", "hugoniot")
COLUMNS = ("start [K]", "rho [kg/m^3]", "p [Pa]", "T [K]", "c [m/s]", "shock velocity [m/s]", "particle velocity [m/s]")
DASHES = {"isotherm": (0, (4, 2)), "isentrope": "-", "hugoniot": (0, (1, 1))}


def read(folder: Path) -> dict[str, list[dict[str, np.ndarray]]]:
    """The curves of each kind, by their starts."""
    curves = {}
    for kind in KINDS:
        path = folder / f"{kind}.csv"
        try:
            table = tables.read(path)
        except Damaged:
            if kind == "isotherm" or "start" not in path.read_text(encoding="utf-8", errors="replace"):
                raise
            table = {name: np.array([]) for name in COLUMNS}  # of a material that has no such curve
        missing = [name for name in COLUMNS if name not in table]
        if missing:
            raise Damaged(f"{path}: has no column {missing[0]}: is it of plan eos?")
        starts = table["start [K]"]
        curves[kind] = [{name: table[name][starts == start] for name in COLUMNS} for start in dict.fromkeys(starts)]
    return curves


def draw(curves: dict):
    """Density, temperature and sound by pressure, shock by particle velocity."""
    figure, (density, temperature, sound, shock) = style.panels(4, 2, 2.8)
    starts = list(dict.fromkeys(float(line["start [K]"][0]) for kind in KINDS for line in curves[kind]))
    for kind in KINDS:
        for line in curves[kind]:
            start = float(line["start [K]"][0])
            look = {"color": style.INK if kind == "hugoniot" else style.numbered(starts.index(start))["color"],
                    "linestyle": DASHES[kind], "linewidth": 1.3, "label": f"{kind} from {start:g} K"}
            p = line["p [Pa]"] / 1e9
            density.plot(p, line["rho [kg/m^3]"], **look)
            sound.plot(p, line["c [m/s]"] / 1e3, **look)
            if kind != "isotherm":
                temperature.plot(p, line["T [K]"], **look)
            if kind == "hugoniot":
                shock.plot(line["particle velocity [m/s]"][1:] / 1e3, line["shock velocity [m/s]"][1:] / 1e3, **look)
    for ax, title in ((density, "density [kg/m³]"), (temperature, "temperature [K]"), (sound, "sound [km/s]")):
        style.entitle(ax, title)
        ax.set_xlabel("p [GPa]")
    style.entitle(shock, "shock velocity [km/s]")
    shock.set_xlabel("particle velocity [km/s]")
    temperature.set_yscale("log")
    style.legend_above(figure, [density, temperature, sound, shock])
    return figure


def make(folder: Path) -> Path:
    figure = draw(read(folder))
    target = folder / "eos.png"
    writing.contents(target, style.png(figure))
    return target
