"""The figures of the report, one file a kind. draw_all writes the PNG files and tells which there are."""
from dataclasses import dataclass
from pathlib import Path

from ..runner import Outcome
from . import cost, displacement, pressure, residual


@dataclass(frozen=True)
class Figure:
    kind: str       # 'pressure', 'displacement', 'residual', 'cost'
    file: str       # the input shown; '' if the figure is about several
    path: Path


def draw_all(outcomes: list[Outcome], output: Path) -> list[Figure]:
    """A figure without data to show is left out, and an older one of its name removed."""
    files = list(dict.fromkeys(outcome.case.file for outcome in outcomes))
    wanted = [("pressure", "", lambda path: pressure.draw(outcomes, files, path))]
    wanted += [("displacement", file, lambda path, file=file: displacement.draw(outcomes, file, path))
               for file in files]
    wanted += [("residual", "", lambda path: residual.draw(outcomes, files, path)),
               ("cost", "", lambda path: cost.draw(outcomes, files, path))]
    drawn = []
    for kind, file, draw in wanted:
        path = output / (f"{kind}_{file}.png" if file else f"{kind}.png")
        path.unlink(missing_ok=True)
        if draw(path):
            drawn.append(Figure(kind, file, path))
    return drawn
