"""From readings to results: medians and spread, efficiency, Amdahl's parallel fraction."""
from dataclasses import dataclass
from pathlib import Path
from statistics import median, quantiles

from ..reading import Unreadable, read_json

QUIET = 0.5  # load average up to which a machine counts as one without other work


def of_the_machine(row: dict, rows: list[dict]) -> float | None:
    """A run's rate over that of as many separate copies as it has cores, in the same rounds: what the program itself loses."""
    same = [r for r in rows if r["kind"] == "copies" and r["ranks"] == row["ranks"] * row["threads"]]
    if not same or row["kind"] == "copies":
        return None
    return median(u / c for u, c in zip(row["updates_per_second_readings"], same[0]["updates_per_second_readings"]))


def result(kind: str, run, readings: list[dict], machine: dict) -> dict:
    """One row of scaling.json from the summaries of a run's repeats."""
    rates = [r["particle_updates_per_second"] for r in readings]
    typical = min(readings, key=lambda r: abs(r["particle_updates_per_second"] - median(rates)))

    def of(name: str) -> float:
        return median(r["metrics"][name] for r in readings)

    def step_seconds(r: dict) -> float:
        return r["stepping_seconds"] / r["steps"]

    return {
        "kind": kind, "ranks": run.ranks, "threads": run.threads, "particles": run.particles,
        "counts": list(run.counts), "steps": readings[0]["steps"], "repeats": len(readings),
        "updates_per_second": median(rates), "updates_per_second_readings": rates,
        "seconds_per_step": median(step_seconds(r) for r in readings),
        # Mean over the ranks; the slowest rank waits least.
        "waiting_fraction": median(r["metrics"]["waiting_seconds_per_step"] / step_seconds(r) for r in readings),
        "bytes_sent_per_step": of("halo_bytes_per_step"), "bytes_sent_per_step_max": of("halo_bytes_per_step_max"),
        "messages_per_step": of("halo_messages_per_step"), "messages_per_step_max": of("halo_messages_per_step_max"),
        "migration_bytes_per_step": of("migration_bytes_per_step"),
        "collectives_per_step": of("collectives_per_step"),
        "fluid_halo_particles": of("fluid_halo_particles"), "wall_halo_particles": of("wall_halo_particles"),
        "stages": typical["stages"], "simd_lanes": typical["simd_lanes"], "version": typical["version"], **machine}


def add_efficiency(rows: list[dict]) -> None:
    """Rate a core over that of the fewest cores of the same kind, and its spread over the rounds: round k's readings of
    both were taken one soon after the other."""
    for kind in ("strong", "weak", "copies"):
        same = [r for r in rows if r["kind"] == kind]
        if not same:
            continue
        # A copy on its own is the strong run on one core.
        base = base_of([r for r in rows if r["kind"] == "strong"] if kind == "copies" else same)
        for r in same:
            c, c0 = r["ranks"] * r["threads"], base["ranks"] * base["threads"]
            pairs = [u * c0 / (u0 * c) for u, u0 in zip(r["updates_per_second_readings"], base["updates_per_second_readings"])]
            r["efficiency"] = median(pairs)
            r["efficiency_least"], r["efficiency_largest"] = min(pairs), max(pairs)


def base_of(rows: list[dict]) -> dict:
    return min(rows, key=lambda r: (r["ranks"] * r["threads"], r["ranks"]))


@dataclass(frozen=True)
class Amdahl:
    over: str  # "threads" or "ranks"
    fraction: float
    low: float      # quartiles over the rounds; the extremes where there are fewer than four
    high: float
    points: int     # ratios that it rests on

    @property
    def text(self) -> str:
        ratios = "one ratio" if self.points == 1 else f"{self.points} ratios"
        return f"{100 * self.fraction:.2f} % ({100 * self.low:.2f} to {100 * self.high:.2f} over the rounds; {ratios})"


def fraction_of(cores: list[int], speedups: list[float]) -> float:
    """p of S = 1/((1 - p) + p/c) [Amdahl 1967] by least squares in 1/S - 1 = p (1/c - 1); one point: exact. More than 1
    where a part runs faster than its share, as with caches."""
    weight = [1.0 / c - 1.0 for c in cores]
    return sum(w * (1.0 / s - 1.0) for w, s in zip(weight, speedups)) / sum(w * w for w in weight)


def amdahl(rows: list[dict]) -> list[Amdahl]:
    """From strong scaling over threads at one rank, and over ranks at one thread, where there is more than one."""
    found = []
    strong = [r for r in rows if r["kind"] == "strong"]
    for over, other in (("threads", "ranks"), ("ranks", "threads")):
        line = sorted((r for r in strong if r[other] == 1), key=lambda r: r[over])
        if len(line) < 2 or line[0][over] != 1:
            continue
        cores = [r[over] for r in line[1:]]
        rounds = [fraction_of(cores, [u / one_u for u in us])
                  for one_u, *us in zip(*(r["updates_per_second_readings"] for r in line))]
        if len(rounds) >= 4:
            low, _, high = quantiles(rounds, n=4)
        else:
            low, high = min(rounds), max(rounds)
        found.append(Amdahl(over, median(rounds), low, high, len(cores)))
    return found


def read(folder: Path) -> tuple[list[dict], list[dict]]:
    """scaling.json and exchange.json of a study."""
    rows, exchanges = (read_json(folder / f"{name}.json", "./run bench --scaling", list) for name in ("scaling", "exchange"))
    if not rows or not all("efficiency" in r for r in rows):
        raise Unreadable(f"{folder}/scaling.json holds no results")
    return rows, exchanges


def ratio(value: float | None) -> str:
    return "" if value is None else f"{value:.3f}"


def columns(rows: list[dict]) -> dict[str, list[str]]:
    """Of the tables on the terminal and on the page."""
    shown = {"Kind": lambda r: r["kind"], "Ranks": lambda r: str(r["ranks"]), "Threads": lambda r: str(r["threads"]),
             "Particles": lambda r: f"{r['particles']:,}", "M updates/s": lambda r: f"{1e-6 * r['updates_per_second']:.3f}",
             "Efficiency": lambda r: f"{r['efficiency']:.3f}", "Of the copies": lambda r: ratio(of_the_machine(r, rows)),
             "Least–largest": lambda r: f"{r['efficiency_least']:.3f}–{r['efficiency_largest']:.3f}",
             "Waiting": lambda r: f"{100 * r['waiting_fraction']:.1f} %",
             "KiB sent a step": lambda r: f"{r['bytes_sent_per_step'] / 1024:.1f}",
             "Messages": lambda r: f"{r['messages_per_step']:.1f}", "Collectives": lambda r: f"{r['collectives_per_step']:.1f}"}
    return {head: [text(r) for r in rows] for head, text in shown.items()}


def as_text(rows: list[dict]) -> str:
    """A table for the terminal."""
    shown = [[head, *texts] for head, texts in columns(rows).items()]
    return "\n".join("  ".join(text.rjust(max(map(len, of))) for text, of in zip(line, shown)) for line in zip(*shown))
