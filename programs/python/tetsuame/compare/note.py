"""What the note reports, as data: the one place where its entries stand.

Source: K. Shobuzako, note of 17 May 2022, section 1.1: table 1 (the programs), table 2 (the
results) and the remarks below it. Translated from Japanese.
"""
from dataclasses import dataclass

SOURCE = "K. Shobuzako, note of 17 May 2022, section 1.1"

# Table 1: how Y comes about, walls, gradient. Pattern 1 is the form derived by the note's author, pattern 2 that of the original DISPH papers.
TABLE_1 = {
    "A": "Hosono iteration, walls corrected, pattern 1",
    "B": "Hosono iteration, walls none, pattern 1",
    "C": "our method, walls corrected, pattern 1",
    "D": "our method, walls none, pattern 1",
    "E": "our method, walls corrected, pattern 2",
    "F": "our method, walls corrected, pattern 1, non-smoothed pressure",
}


@dataclass(frozen=True)
class Entry:
    dt: str                      # s
    pressure: str                # Pa, at the start
    diverged: bool
    step: int | None = None      # where it diverged
    iteration: int | None = None


STEPS, TEMPERATURE = "1000", "2500"  # K; of all entries of table 2

# Table 2: (file, program) -> entry; C to F complete.
TABLE_2 = {
    ("11", "A"): Entry("1e-3", "1e5", True, 2, 2),
    ("11", "B"): Entry("1e-3", "1e5", True, 1, 2),
    **{("11", program): Entry("1e-3", "1e5", False) for program in "CDEF"},
    ("12", "A"): Entry("1e-5", "1e10", True, 2, 2),
    ("12", "B"): Entry("1e-5", "1e10", True, 1, 2),
    **{("12", program): Entry("1e-5", "1e10", False) for program in "CDEF"},
}

ACCURACY_ORDER = "F > C > E > D"   # the remark in table 2, best first, for both files
COST_OF_CORRECTION = 2.0           # run time with the boundary correction over that without, in the note
