"""Files that the programs write: JSON, inputs as run, tables of numbers. What cannot be read is Unreadable, with one sentence."""
import contextlib
import csv
import json
import math
import os
import re
import stat
from pathlib import Path

import numpy as np

from . import BAD_INPUT, FILE_FAILED


last_opened = None  # memory shared with the process that waits for this one (apart.py): the HDF5 file that was read last


class Unreadable(Exception):
    """Why there is nothing to show, and what to do; and with which status the command ends."""
    status = BAD_INPUT


class Damaged(Unreadable):
    """A file that is there, but cannot be read or written, or does not hold what it should."""
    status = FILE_FAILED


def regular(path: Path) -> Path:
    """The same, if it is a file with an end: a pipe would be waited for."""
    try:
        mode = os.stat(path).st_mode
    except OSError as problem:
        raise Damaged(f"{path}: {problem.strerror}") from None
    if not stat.S_ISREG(mode):
        raise Damaged(f"{path}: is {'a directory' if stat.S_ISDIR(mode) else 'no regular file'}")
    return Path(path)


@contextlib.contextmanager
def as_hdf5(path: Path, what: str):
    """Whatever h5py makes of a damaged file, as Damaged: `what` is wrong with it."""
    if last_opened is not None:
        name = os.fsencode(path)[-len(last_opened) + 1:]
        last_opened[:len(name) + 1] = name + b"\0"
    try:
        yield
    except (OSError, LookupError, ValueError, TypeError, AttributeError, RuntimeError, ArithmeticError, MemoryError) as problem:
        raise Damaged(f"{path}: {what} ({first_line(problem)})") from None


@contextlib.contextmanager
def as_table(what: str):
    """Whatever a damaged table makes of those who read it, as Damaged."""
    try:
        yield
    except (LookupError, ValueError, StopIteration, csv.Error) as problem:
        raise Damaged(f"{what}: not a table of names and numbers ({first_line(problem)})") from None


def first_line(problem: Exception) -> str:
    return (str(problem).strip("'\"").splitlines() or [type(problem).__name__])[0]


def read_text(path: Path) -> str:
    """In UTF-8, with or without a mark of the order of its bytes."""
    try:
        return regular(path).read_text(encoding="utf-8-sig")
    except OSError as problem:
        raise Damaged(f"{path}: {problem.strerror}") from None
    except UnicodeDecodeError as problem:
        raise Damaged(f"{path}: is no text in UTF-8 (byte {problem.start})") from None


def read_json(path: Path, writer: str, kind: type = dict):
    """`writer`: the command that writes the file, for the message; `kind`: of what the file holds."""
    if not Path(path).exists():
        raise Unreadable(f"{path}: No such file or directory; run {writer} first, it writes this file")
    try:
        content = json.loads(read_text(path))
    except (ValueError, RecursionError) as problem:
        raise Damaged(f"{path}: not the JSON that {writer} writes ({problem}); run it again") from None
    if not isinstance(content, kind):
        raise Damaged(f"{path}: not the JSON that {writer} writes; run it again")
    return content


def is_number(value) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


class Keys(dict):
    """group.key and its value as text, without quotes, of a resolved.nml, which holds every key as run, one to a line."""

    def __init__(self, path: Path):
        super().__init__()
        self.path, group = path, ""
        for line in read_text(path).splitlines():
            line = line.strip()
            if line.startswith("&"):
                group = line[1:].split()[0].lower() if line[1:].split() else ""
            elif match := re.match(r"""(\w+)\s*=\s*((?:'[^']*'|"[^"]*"|[^!'"])*)""", line):
                value = match[2].strip()
                self[f"{group}.{match[1].lower()}"] = value[1:-1] if re.fullmatch(r"""'[^']*'|"[^"]*\"""", value) else value

    def real(self, name: str) -> float:
        """A finite number."""
        try:
            value = real(self[name])
            if math.isfinite(value):
                return value
        except (KeyError, ValueError):
            pass
        raise Damaged(f"{self.path}: {name} = {self.get(name, '')} is no number")


def real(text: str) -> float:
    """A number as Fortran writes it."""
    return float(text.lower().replace("d", "e"))


class Columns(dict):
    """A table's columns by name, without their units, which are beside; empty if there is no whole line. A line that is not
    whole is left out: a run that was killed may end in one."""

    def __init__(self, path: Path):
        try:
            rows = csv.reader(read_text(path).splitlines())
            heads = [head.rstrip("]").partition(" [") for head in next(rows, [])]
            values = [[float(value) for value in row] for row in rows if len(row) == len(heads)]
        except (ValueError, csv.Error) as problem:
            raise Damaged(f"{path}: not a table that a program writes ({problem})") from None
        super().__init__(zip((name for name, *_ in heads), np.array(values).T) if values else {})
        self.units = {name: unit for name, _, unit in heads}


def beside(folder: Path, ending: str) -> Path:
    """A run's folder is its program's; what we know of it lies beside."""
    return folder.with_name(folder.name + ending)


def last_line(path: Path) -> str:
    """What a program said last; nothing where there is no such file."""
    lines = path.read_text(encoding="utf-8", errors="replace").strip().splitlines() if path.is_file() else []
    return lines[-1] if lines else ""
