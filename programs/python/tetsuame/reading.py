"""Files that the programs write, JSON and tables of comma-separated values; and tables that are written here."""
import csv
import json
import re
from pathlib import Path

import numpy as np

from . import BAD_INPUT


class Unreadable(Exception):
    """Why there is nothing to show, and what to do; and with which status the command ends."""
    status = BAD_INPUT


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


class Columns(dict):
    """A table's columns by name, without their units, which are beside; empty if there is no whole line. A line that is not
    whole is left out: a run that was killed may end in one."""

    def __init__(self, path: Path):
        with open(path, newline="", encoding="utf-8") as file:
            rows = csv.reader(file)
            heads = [head.rstrip("]").partition(" [") for head in next(rows, [])]
            values = [[float(value) for value in row] for row in rows if len(row) == len(heads)]
        super().__init__(zip((name for name, *_ in heads), np.array(values).T) if values else {})
        self.units = {name: unit for name, _, unit in heads}


def write_csv(path: Path, rows: list[dict]) -> None:
    """Columns by the rows' keys; empty where a row has none."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, dict.fromkeys(name for row in rows for name in row))
        writer.writeheader()
        writer.writerows(rows)


def beside(folder: Path, ending: str) -> Path:
    """A run's folder is its program's; what we know of it lies beside."""
    return folder.with_name(folder.name + ending)


def last_line(path: Path) -> str:
    """What a program said last; nothing where there is no such file."""
    lines = path.read_text(encoding="utf-8", errors="replace").strip().splitlines() if path.is_file() else []
    return lines[-1] if lines else ""
