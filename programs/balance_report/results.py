"""What a run of `balance` left in its folder."""
import csv
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np


class Unreadable(Exception):
    """A file is missing or not what it should be: which, and why."""


@dataclass
class Run:
    summary: dict
    history: dict[str, np.ndarray]  # by column, without the unit
    times: dict[int, np.ndarray]  # s of each rank, by decision
    cuts: dict[int, list[np.ndarray]]  # by decision: of each axis, groups x (counts + 1), m

    @property
    def counts(self) -> list[int]:
        return self.summary["counts"]


def table(path: Path) -> dict[str, np.ndarray]:
    with open(path, newline="", encoding="utf-8") as file:
        lines = list(csv.reader(file))
    values = np.array(lines[1:], dtype=float)
    return {name.split(" [")[0]: values[:, k] for k, name in enumerate(lines[0])}


def read(folder: Path) -> Run:
    try:
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
        history, times, cuts = (table(folder / f"{name}.csv") for name in ("history", "times", "cuts"))
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
