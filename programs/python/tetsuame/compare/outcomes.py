"""What a run came to, and what its program left: summary, residuals, history, the last snapshot."""
import functools
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..reading import Columns, Keys, real
from ..runs import Snapshot
from .cases import Run

COMPLETED, STOPPED, CRASHED = "completed", "stopped", "crashed"
DOUBTFUL = "completed_doubtful"  # status of a run that came to its end, but whose own measures say that it means nothing


@dataclass(frozen=True)
class Outcome:
    case: Run
    kind: str        # COMPLETED, STOPPED (exit 3: a result), CRASHED
    reason: str      # in words, unless completed without a doubt
    folder: Path
    summary: dict    # summary.json; empty if there is none
    reused: bool     # the last report's run: nothing it depends on has changed

    @property
    def doubtful(self) -> bool:
        return self.kind == COMPLETED and self.summary.get("status") == DOUBTFUL

    def number(self, *path: str) -> float | None:
        """A number of summary.json, None where it is null or absent."""
        value = self.summary
        for key in path:
            value = value.get(key) if isinstance(value, dict) else None
        return value if isinstance(value, (int, float)) and not isinstance(value, bool) else None

    @property
    def stages(self) -> dict[str, float]:
        """Seconds by stage name, without output, which is the disk's time and not the method's."""
        return {name: float(value) for name, value in (self.summary.get("stages") or {}).items() if name != "output"}

    @property
    def cost_per_step(self) -> float | None:
        """Seconds a step in all stages: the run without its output."""
        steps, seconds = self.number("steps"), sum(self.stages.values())
        return seconds / steps if steps and seconds > 0.0 else None

    @property
    def wall_share(self) -> float | None:
        """Share of the stages that treat walls (their names begin with 'wall') in the time of all."""
        total = sum(self.stages.values())
        return sum(value for name, value in self.stages.items() if name.startswith("wall")) / total if total > 0 else None

    @property
    def history(self) -> dict[str, np.ndarray]:
        return table(self.folder / "history.csv")

    @functools.cached_property
    def snapshots(self) -> list[Snapshot]:
        """The states on disk, by time."""
        return [Snapshot(name) for name in sorted(self.folder.glob("snapshot_*.h5"))]

    @property
    def snapshot(self) -> Snapshot | None:
        """The last state on disk; None if there is none."""
        return self.snapshots[-1] if self.snapshots else None

    def resolved(self, key: str) -> str:
        """The first word of a value of resolved.nml."""
        return Keys(self.folder / "resolved.nml")[key].split()[0].strip("',/")

    def setting(self, key: str) -> float:
        """A number of resolved.nml."""
        return real(self.resolved(key))


def table(path: Path) -> dict[str, np.ndarray]:
    """Empty if there is no such file, or no line in it."""
    return Columns(path) if path.is_file() else {}


@dataclass(frozen=True)
class Residuals:
    """The residual by pass of one evaluation of the Hosono iteration."""
    iteration: np.ndarray
    residual: np.ndarray


def residuals(folder: Path) -> list[Residuals]:
    """All evaluations recorded in residuals.csv, in order."""
    groups: dict[tuple[int, int], list[tuple[float, float]]] = {}
    columns = table(folder / "residuals.csv")
    for step, evaluation, *row in zip(*(columns.get(name, ()) for name in ("step", "evaluation", "iteration", "residual"))):
        groups.setdefault((int(step), int(evaluation)), []).append(row)
    return [Residuals(*map(np.array, zip(*rows))) for rows in groups.values()]


def passes(folder: Path) -> list[float]:
    """Residuals of all passes one after another. A start that has settled is computed once more by the time stepping: that is left out."""
    of_evaluations = residuals(folder)
    if len(of_evaluations) > 1 and list(of_evaluations[0].residual) == list(of_evaluations[1].residual):
        of_evaluations = of_evaluations[1:]
    return [float(value) for one in of_evaluations for value in one.residual]


def representatives(outcomes: list[Outcome], file: str) -> list[Outcome]:
    """For each program the first completed run on a file: as the input has it, else the first cure
    that worked (the cures agree to their tolerance, so that one stands for all)."""
    chosen: dict[str, Outcome] = {}
    for outcome in outcomes:
        if outcome.case.file == file and outcome.kind == COMPLETED:
            chosen.setdefault(outcome.case.program, outcome)
    return list(chosen.values())
