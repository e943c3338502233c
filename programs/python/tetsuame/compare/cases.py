"""Which program runs on which input with which settings."""
import re
from dataclasses import dataclass
from pathlib import Path

LETTERS = ("A", "B", "C", "D", "E", "F")
SHIPPED_INPUTS = ("11", "12", "13", "13_linear", "column")
ITERATING = ("A", "B")  # the programs that find Y by the Hosono iteration

CURES = ("newton", "anderson")  # of the iteration
ADAPTIVE = "adaptive"  # steps from an error estimate in place of the note's


@dataclass(frozen=True)
class Run:
    """A program on an input, in a variant of it."""
    binary: str
    input: Path
    file: str                    # what the runs of one problem share, often the input's short name: '11', 'column', …
    label: str
    folder: str                  # of its results, below that of the runs
    variant: str                 # in words; '' as the input has it
    settings: tuple[str, ...]
    n: int = 0                   # particles along the box, where that is varied
    program: str = ""            # 'A' … 'F'
    seconds: float = 0.0         # that it takes, roughly, for the time that remains; 0: as long as the others
    start: "Run | None" = None   # one of the same comparison, whose last snapshot this one starts from
    start_key: str = "initial.file"  # the setting that takes it
    ranks: int = 1


def of_letter(program: str, path: Path, variant: str, settings: tuple[str, ...]) -> Run:
    """Of programs A to F."""
    binary, file = f"disph_{program.lower()}", short(path)
    folder = f"{file}/{binary}_{variant.replace(', ', '_')}" if variant else f"{file}/{binary}"
    return Run(binary, path, file, f"{program} ({variant})" if variant else program, folder, variant, settings, program=program)


def short(path: Path) -> str:
    return path.stem.removeprefix("hydrostatic_")


def of_size(binary: str, path: Path, variant: str, n: int, settings: tuple[str, ...], case: str = "", seconds: float = 0.0) -> Run:
    """Of the comparisons over resolution. case: '': the input's name"""
    file, name = case or path.stem, re.sub(r"[^A-Za-z0-9]+", "_", variant).strip("_")
    return Run(binary, path, file, f"{variant}, n = {n}" if variant else f"n = {n}", f"{file}/{name}_{n}" if name else f"{file}/{n}",
               variant, settings, n, seconds=seconds)


def plan(programs: tuple[str, ...], inputs: list[Path], settings: list[str]) -> list[Run]:
    """All runs, by input and program. Settings of the command line hold for every run and come
    last: one that chooses the solver leaves nothing for the extra runs to show, so they are dropped."""
    keys = {setting.partition("=")[0].strip().lower() for setting in settings}
    solver_is_given, steps_are_given = "hosono.solver" in keys, "time.method" in keys
    cases = []
    for path in inputs:
        for program in programs:
            variants = {"": ()}
            if program not in ITERATING and not steps_are_given:
                variants[ADAPTIVE] = ("time.method=adaptive",)
            elif program in ITERATING and not solver_is_given:
                variants |= extra(program, short(path))
            cases += [of_letter(program, path, variant, (*own, *settings)) for variant, own in variants.items()]
    return cases


def extra(program: str, file: str) -> dict[str, tuple[str, ...]]:
    """Variants of a program that iterates, and their settings."""
    if file in ("12", "13", "13_linear"):  # at 10 GPa a solution exists, and only the plain iteration misses it
        return {cure: (f"hosono.solver={cure}",) for cure in CURES}
    if file != "11":
        return {}
    # At 1e5 Pa on this lattice no solver can help, since there is nothing to find; dividing by the kernel sum makes a
    # solution exist for A. B misses half a neighbourhood at the walls, which no such division gives back.
    newton = ("hosono.solver=newton",)
    return {"newton": newton} | ({"newton, normalised": (*newton, "smoothing.normalise=.true.")} if program == "A" else {})
