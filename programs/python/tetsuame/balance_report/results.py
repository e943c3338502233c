"""What a run of `balance` left in its folder."""
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..reading import Unreadable, read_columns, read_json


@dataclass
class Run:
    summary: dict
    history: dict[str, np.ndarray]  # by column, without the unit
    times: dict[int, np.ndarray]  # s of each rank, by decision
    cuts: dict[int, list[np.ndarray]]  # by decision: of each axis, groups x (counts + 1), m

    @property
    def counts(self) -> list[int]:
        return self.summary["counts"]


def read(folder: Path) -> Run:
    try:
        summary = read_json(folder / "summary.json", "balance")
        history, times, cuts = (read_columns(folder / f"{name}.csv") for name in ("history", "times", "cuts"))
        total = times["computing"] + times["communication"]
        decisions = np.unique(times["decision"]).astype(int)
        by_axis = {}
        for d in decisions:
            here = cuts["decision"] == d
            by_axis[d] = [cuts["position"][here & (cuts["axis"] == a)].reshape(-1, n + 1)
                          for a, n in enumerate(summary["counts"])]
        return Run(summary, history, {d: total[times["decision"] == d] for d in decisions}, by_axis)
    except (OSError, ValueError, KeyError, IndexError) as problem:
        raise Unreadable(f"{folder}: not the results of a run of balance: {problem}") from problem
