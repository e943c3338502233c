"""Which program runs on which input with which settings."""
import re
from dataclasses import dataclass
from pathlib import Path

PROGRAMS = ("A", "B", "C", "D", "E", "F")
SHIPPED_INPUTS = ("11", "12", "13", "13_linear", "column")
ITERATING = ("A", "B")  # the programs that find Y by the Hosono iteration

# The cures of the iteration are run where they are of interest: at 10 GPa, where a
# solution exists and only the plain iteration misses it.
CURES = ("newton", "anderson")
CURED_INPUTS = ("12", "13", "13_linear")
# At 1e5 Pa on this lattice no solver can help, since there is nothing to find;
# dividing by the kernel sum makes a solution exist for A. B misses half a neighbourhood
# at the walls, which no such division gives back.
NORMALISED_INPUTS = ("11",)
NORMALISED_PROGRAMS = ("A",)


@dataclass(frozen=True)
class Case:
    program: str                 # 'A' … 'F'
    input: Path
    variant: str = ""            # '' as the input has it, else what differs, in words
    settings: tuple[str, ...] = ()

    @property
    def binary(self) -> str:
        return f"disph_{self.program.lower()}"

    @property
    def file(self) -> str:
        """The input's short name: '11', 'column', …"""
        return self.input.stem.removeprefix("hydrostatic_")

    @property
    def label(self) -> str:
        return f"{self.program} ({self.variant})" if self.variant else self.program

    @property
    def folder(self) -> str:
        name = self.binary
        return f"{self.file}/{name}_{self.variant.replace(', ', '_')}" if self.variant else f"{self.file}/{name}"


@dataclass(frozen=True)
class Run:
    """A run of one of the other comparisons: a program, an input, a variant of it, a resolution."""
    binary: str
    input: Path
    variant: str                 # in words; '' as the input has it
    n: int                       # particles along the box
    settings: tuple[str, ...] = ()
    case: str = ""               # what the runs of one problem share; '': the input's name

    @property
    def file(self) -> str:
        return self.case or self.input.stem

    @property
    def label(self) -> str:
        return f"{self.variant}, n = {self.n}" if self.variant else f"n = {self.n}"

    @property
    def folder(self) -> str:
        name = re.sub(r"[^A-Za-z0-9]+", "_", self.variant.replace("δ", "delta")).strip("_")
        return f"{self.file}/{name}_{self.n}" if name else f"{self.file}/{self.n}"


def plan(programs: tuple[str, ...], inputs: tuple[Path, ...], settings: tuple[str, ...]) -> list[Case]:
    """All runs, by input and program. Settings of the command line hold for every run and come
    last: one that chooses the solver leaves nothing for the extra runs to show, so they are dropped."""
    solver_is_given = any(setting.partition("=")[0].strip().lower() == "hosono.solver" for setting in settings)
    cases = []
    for path in inputs:
        for program in programs:
            base = Case(program, path, "", settings)
            cases.append(base)
            if program not in ITERATING or solver_is_given:
                continue
            if base.file in CURED_INPUTS:
                cases += [Case(program, path, cure, (f"hosono.solver={cure}", *settings)) for cure in CURES]
            if base.file in NORMALISED_INPUTS:
                cases.append(Case(program, path, "newton", ("hosono.solver=newton", *settings)))
                if program in NORMALISED_PROGRAMS:
                    cases.append(Case(program, path, "newton, normalised",
                                      ("hosono.solver=newton", "smoothing.normalise=.true.", *settings)))
    return cases
