"""Files that are written here: whole or not at all, under another name first. A link of the file's name is replaced, not followed."""
import contextlib
import csv
import io
import os
import tempfile
from pathlib import Path

from .reading import Damaged

UMASK = os.umask(0)
os.umask(UMASK)


@contextlib.contextmanager
def replacing(target: Path):
    """The name to write to, which ends as `target` does and then takes its place. Problems name `target`."""
    target = Path(target)
    if target.exists() and not target.is_file() or target.is_symlink() and os.readlink(target).startswith("/proc/"):  # as /dev/stdout
        raise Damaged(f"{target}: is no regular file, and is not written over")
    try:
        handle, name = tempfile.mkstemp(suffix=f"_{target.name}", prefix=".", dir=target.parent)
        os.close(handle)
        os.chmod(name, 0o666 & ~UMASK)
    except OSError as problem:
        raise Damaged(f"{target}: {problem.strerror}") from None
    try:
        yield Path(name)
        os.replace(name, target)
    except OSError as problem:
        raise Damaged(f"{target}: {problem.strerror or problem}") from None
    finally:
        with contextlib.suppress(OSError):
            os.unlink(name)


def contents(target: Path, data: bytes) -> None:
    with replacing(target) as path:
        path.write_bytes(data)


def text(target: Path, said: str) -> None:
    """In UTF-8; what a file's name has of other bytes becomes question marks."""
    contents(target, said.encode("utf-8", "replace"))


def table(target: Path, rows: list[dict]) -> None:
    """Columns by the rows' keys; empty where a row has none."""
    said = io.StringIO(newline="")
    writer = csv.DictWriter(said, dict.fromkeys(name for row in rows for name in row))
    writer.writeheader()
    writer.writerows(rows)
    text(target, said.getvalue())


def folder(path: Path) -> Path:
    """Made where it is not there."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        raise Damaged(f"{path}: {problem.strerror}") from None
    return path
