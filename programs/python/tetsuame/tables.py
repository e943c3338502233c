"""Tables of numbers that a user gave a program, in the dialect that it reads (docs/user_guide.md, "Tables")."""
import csv
import re
from pathlib import Path

import numpy as np

from .reading import Damaged, read_text

MISSING = ("na", "n/a", "null")


def number(text: str) -> float:
    """As in Fortran; nan where there is none."""
    try:
        return float(re.sub("[dDqQ]", "e", text)) if re.fullmatch(r"[-+0-9.eEdDqQ]+", text) else np.nan
    except ValueError:
        return np.nan


def begins_with_number(line: str) -> bool:
    first = re.split(r"[ \t,;]", line.lstrip("\"'"))[0].rstrip("\"'")
    return np.isfinite(number(first)) or first.lower() in MISSING or first.lower().strip("+-") in ("nan", "inf", "infinity")


def cells(line: str, separator: str) -> list[str]:
    if separator == " ":
        return [a or b or c for a, b, c in re.findall(r"\"([^\"]*)\"|'([^']*)'|([^ \t]+)", line)]
    quote = "'" if line.lstrip().startswith("'") else '"'
    return [cell.strip() for cell in next(csv.reader([line], delimiter=separator, quotechar=quote, skipinitialspace=True))]


def read(path: Path) -> dict[str, np.ndarray]:
    """Columns by name; nan where there is no number."""
    lines = [line.strip(" \t") for line in re.split("\r\n|\r|\n", read_text(path))]
    lines = [line for line in lines if line.strip(" \t,;\"") and line[0] not in "#!%"]
    first = next((k for k, line in enumerate(lines) if begins_with_number(line)), None)
    if first is None:
        raise Damaged(f"{path}: no line in it begins with a number")
    separator = next((mark for mark in ";\t," if mark in lines[first].split("#")[0]), " ")
    names = cells(lines[0], separator)
    rows = []
    for line in lines[first:]:
        line = line.split("#")[0]
        row = cells(line, separator)
        if len(row) < len(names) and not set(",;") & set(line):
            row = cells(line, " ")
        rows.append([number(cell) for cell in (row + [""] * len(names))[:len(names)]])
    return {name: column for name, column in zip(names, np.array(rows).T) if name}
