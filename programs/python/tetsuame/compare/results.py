"""Reads what a program left: fields of summary.json, residuals.csv, the last snapshot."""
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

from ..reading import read_columns, read_keys, real
from ..runs import Snapshot
from .runner import Outcome


def number(summary: dict, *path: str) -> float | None:
    """A number of summary.json, None where it is null or absent."""
    value = summary
    for key in path:
        value = value.get(key) if isinstance(value, dict) else None
    return value if isinstance(value, (int, float)) and not isinstance(value, bool) else None


def cost_per_step(outcome: Outcome) -> float | None:
    """Seconds a step in all stages: the run without its output."""
    steps, seconds = number(outcome.summary, "steps"), sum(stages(outcome).values())
    return seconds / steps if steps and seconds > 0.0 else None


def stages(outcome: Outcome) -> dict[str, float]:
    """Seconds by stage name, without output, which is the disk's time and not the method's."""
    given = outcome.summary.get("stages")
    if not isinstance(given, dict):
        return {}
    return {name: float(value) for name, value in given.items() if name != "output"}


def wall_share(outcome: Outcome) -> float | None:
    """Share of the stages that treat walls (their names begin with 'wall') in the time of all."""
    parts = stages(outcome)
    total = sum(parts.values())
    return sum(value for name, value in parts.items() if name.startswith("wall")) / total if total > 0 else None


@dataclass(frozen=True)
class Residuals:
    """The residual by pass of one evaluation of the Hosono iteration."""
    step: int
    evaluation: int
    iteration: np.ndarray
    residual: np.ndarray


def residuals(folder: Path) -> list[Residuals]:
    """All evaluations recorded in residuals.csv, in order."""
    groups: dict[tuple[int, int], list[tuple[float, float]]] = {}
    columns = history(folder, "residuals.csv")
    for step, evaluation, *row in zip(*(columns.get(name, ()) for name in ("step", "evaluation", "iteration", "residual"))):
        groups.setdefault((int(step), int(evaluation)), []).append(row)
    return [Residuals(step, evaluation, *map(np.array, zip(*rows))) for (step, evaluation), rows in groups.items()]


def fluid(folder: Path, group: str = "PartType0") -> dict[str, np.ndarray] | None:
    """All fields of the fluid in the last state on disk; None if there is none. Lengths in m, pressures in Pa."""
    names = sorted(folder.glob("snapshot_*.h5"))
    if not names:
        return None
    with h5py.File(names[-1]) as file:
        return {name: values[:] for name, values in file[group].items()} if group in file else None


def lattice(folder: Path) -> tuple[tuple[float, float], float]:
    """Edges of the box, and spacing of the start lattice (m)."""
    lengths = tuple(resolved(folder, "domain", key) for key in ("length_x", "length_y"))
    return lengths, lengths[1] / resolved(folder, "domain", "particles_y")


def last_snapshot(folder: Path) -> Snapshot | None:
    """The last state on disk; None if there is none."""
    names = sorted(folder.glob("snapshot_*.h5"))
    return Snapshot(names[-1]) if names else None


def history(folder: Path, name: str = "history.csv") -> dict[str, np.ndarray]:
    """The columns of a table by name, without their units; empty if there is no such file, or no line in it."""
    path = folder / name
    return read_columns(path) if path.is_file() else {}


def resolved(folder: Path, group: str, key: str) -> float:
    """A number of resolved.nml."""
    return real(resolved_text(folder, group, key))


def resolved_text(folder: Path, group: str, key: str) -> str:
    """The first word of a value of resolved.nml."""
    return read_keys(folder / "resolved.nml")[f"{group}.{key}"].split()[0].strip("',/")


def representatives(outcomes: list[Outcome], file: str) -> list[Outcome]:
    """For each program the first completed run on a file: as the input has it, else the first cure
    that worked (the cures agree to their tolerance, so that one stands for all)."""
    chosen: dict[str, Outcome] = {}
    for outcome in outcomes:
        if outcome.case.file == file and outcome.kind == "completed":
            chosen.setdefault(outcome.case.program, outcome)
    return list(chosen.values())


def cost(outcome: Outcome) -> dict[str, float | None]:
    return {"right_hand_sides": number(outcome.summary, "rhs_evaluations"),
            "seconds": number(outcome.summary, "stepping_seconds") or number(outcome.summary, "wall_seconds"),
            "updates_per_second": number(outcome.summary, "particle_updates_per_second")}
