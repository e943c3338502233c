"""Files that the programs write: JSON, and tables of comma-separated values."""
import csv
import json
from pathlib import Path

import numpy as np


class Unreadable(Exception):
    """Why there is nothing to show, and what to do."""


def read_json(path: Path, writer: str):
    """`writer`: the command that writes the file, for the message."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except OSError as problem:
        raise Unreadable(f"{path}: {problem.strerror}; run {writer} first, it writes this file") from None
    except ValueError as problem:
        raise Unreadable(f"{path}: not the JSON that {writer} writes ({problem}); run it again") from None


def read_columns(path: Path) -> dict[str, np.ndarray]:
    """Columns by name, without their units; empty if there is no whole line. A line that is not whole is left out: a run
    that was killed may end in one."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = csv.reader(file)
        names = [column.partition(" [")[0] for column in next(rows, [])]
        values = [[float(value) for value in row] for row in rows if len(row) == len(names)]
    return dict(zip(names, np.array(values).T)) if values else {}
