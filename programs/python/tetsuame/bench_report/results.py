"""What bench measured, by case."""
from pathlib import Path

from ..reading import Unreadable, read_json

CASES = {"program_c": "program C", "program_f": "program F", "number_density": "number density",
         "transport": "C with conduction and own viscosities", "ssph": "gas, SSPH", "disph": "gas, DISPH",
         "gsph": "gas, GSPH", "gdisph": "gas, Godunov DISPH", "remix": "gas, REMIX"}

# In the order of a step; whatever else bench names comes after them.
STAGES = ("lists", "halo", "volume", "walls", "pressure", "densities", "corrections", "gradient",
          "gradients", "forces", "rates", "integration", "rest")


def read(path: Path) -> list[dict]:
    measured = read_json(path, "bench")
    if not isinstance(measured, list) or not measured or not all(isinstance(r, dict) and "name" in r for r in measured):
        raise Unreadable(f"{path}: holds no measurements; run bench again")
    return measured


def label(result: dict) -> str:
    return f"{CASES.get(result['name'], result['name'])}, {result['dimension']}-D"


def kinds(measured: list[dict]) -> list[tuple[str, int]]:
    """Name and dimension of every case, in the order measured."""
    return list(dict.fromkeys((r["name"], r["dimension"]) for r in measured))


def choose(measured: list[dict], kind: tuple[str, int], threads: int | None = None) -> list[dict]:
    """The results of a case by number of particles; all numbers of threads unless one is given."""
    found = [r for r in measured if (r["name"], r["dimension"]) == kind and threads in (None, r["threads"])]
    return sorted(found, key=lambda r: (r["particles"], r["threads"]))


def fewest_threads(measured: list[dict]) -> int:
    return min(r["threads"] for r in measured)


def typical(measured: list[dict], kind: tuple[str, int], threads: int) -> dict | None:
    """The result whose number of particles is nearest to 400²: too large for the caches, as runs are."""
    found = choose(measured, kind, threads)
    return min(found, key=lambda r: abs(r["particles"] - 160_000)) if found else None
