"""Rates of other codes, measured once by the makers of this one on a machine of the same kind.

One core, double precision unless it says otherwise, 2-D with about 41 neighbours unless it says otherwise.
Each solves its own equations, some simpler than program C's: the comparison is of orders, not of percents.
"""
from dataclasses import dataclass


@dataclass(frozen=True)
class Rate:
    name: str
    remark: str
    low: float    # million particle updates a second and core
    high: float


RATES = (
    Rate("Fortran convection code", "of the notes' author; gfortran -O3 -march=native, n = 100², about 66 neighbours",
         0.063, 0.063),
    Rate("sphcode", "DISPH", 0.126, 0.126),
    Rate("SWIFT", "pressure–energy SPH, quintic spline, adaptive h", 0.50, 0.50),
    Rate("LAMMPS", "SPH package, half lists, the simplest physics of these", 2.4, 2.6),
    Rate("plain loops", "full list, density and force, vectorised by the compiler, no walls", 2.2, 2.2),
)
