"""Files that the programs write: JSON, and tables of comma-separated values."""
import csv
import json
import re
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


def read_keys(path: Path) -> dict[str, str]:
    """group.key and its value as text, without quotes, of a resolved.nml, which holds every key as run, one to a line."""
    found, group = {}, ""
    for line in path.read_text(encoding="utf-8").splitlines():
        line = line.strip()
        if line.startswith("&"):
            group = line[1:].split()[0].lower() if line[1:].split() else ""
        elif match := re.match(r"""(\w+)\s*=\s*((?:'[^']*'|"[^"]*"|[^!'"])*)""", line):
            value = match[2].strip()
            found[f"{group}.{match[1].lower()}"] = value[1:-1] if re.fullmatch(r"""'[^']*'|"[^"]*\"""", value) else value
    return found


def real(text: str) -> float:
    """A number as Fortran writes it."""
    return float(text.lower().replace("d", "e"))


def read_columns(path: Path) -> dict[str, np.ndarray]:
    """Columns by name, without their units; empty if there is no whole line. A line that is not whole is left out: a run
    that was killed may end in one."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = csv.reader(file)
        names = [column.partition(" [")[0] for column in next(rows, [])]
        values = [[float(value) for value in row] for row in rows if len(row) == len(names)]
    return dict(zip(names, np.array(values).T)) if values else {}
