"""Which runs: every number of ranks with every number of threads, at fixed size (strong) and at fixed size a core (weak);
and as many separate runs at once (copies), which exchange nothing: what the machine itself gives."""
from dataclasses import dataclass

SPACING = 5.0e3  # m, that of the input


@dataclass(frozen=True)
class Run:
    ranks: int
    threads: int
    counts: tuple[int, int]  # fluid particles along x and y
    kinds: tuple[str, ...]   # "strong", "weak"; or "copies": `ranks` runs of one rank, of `counts` each

    @property
    def cores(self) -> int:
        return self.ranks * self.threads

    @property
    def copies(self) -> bool:
        return "copies" in self.kinds

    @property
    def particles(self) -> int:
        return self.counts[0] * self.counts[1] * (self.ranks if self.copies else 1)

    @property
    def name(self) -> str:
        return f"{self.ranks}x{self.threads}_{self.counts[0]}x{self.counts[1]}"

    @property
    def settings(self) -> list[str]:
        """Over inputs/hydrostatic_13.nml: the box grows with the counts, the spacing stays."""
        x, y = self.counts
        return [f"domain.particles_x={x}", f"domain.particles_y={y}",
                f"domain.length_x={x * SPACING!r}", f"domain.length_y={y * SPACING!r}"]


def factors(n: int) -> tuple[int, int]:
    """n = a b with a <= b as near to each other as can be."""
    a = max(d for d in range(1, int(n ** 0.5) + 1) if n % d == 0)
    return a, n // a


def runs(ranks: list[int], threads: list[int], side: int, cores: int | None) -> list[Run]:
    """`cores`: combinations that need more are left out (None: nothing is)."""
    wanted: dict[tuple[int, int, tuple[int, int]], list[str]] = {}
    for r in ranks:
        for t in threads:
            if cores is not None and r * t > cores:
                continue
            a, b = factors(r * t)
            for kind, counts in (("strong", (side, side)), ("weak", (side * a, side * b))):
                wanted.setdefault((r, t, counts), []).append(kind)
    found = [Run(r, t, counts, tuple(kinds)) for (r, t, counts), kinds in wanted.items()]
    # Copies are bound to this machine's cores, which no launcher does for them.
    if cores is not None and 1 in threads:
        found += [Run(r, 1, (side, side), ("copies",)) for r in ranks if 1 < r <= cores]
    return found
