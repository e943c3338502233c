"""Which runs: every number of ranks with every number of threads, at fixed size (strong) and at fixed size a core (weak);
and as many separate runs at once (copies), which exchange nothing: what the machine itself gives. Starts them and reads what they measured."""
import itertools
import json
import os
import shlex
import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from .. import FAILED, writing
from ..reading import Unreadable

SPACING = 5.0e3  # m, that of the input
TIME_LIMIT = 3600  # s, of one run: a program that hangs ends the study, not the day


class Failed(Unreadable):
    """A run that went wrong."""
    status = FAILED


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


def factors(n: int) -> tuple[int, int]:
    """n = a b with a <= b as near to each other as can be."""
    a = max(d for d in range(1, int(n ** 0.5) + 1) if n % d == 0)
    return a, n // a


def planned(ranks: list[int], threads: list[int], side: int, cores: int | None) -> list[Run]:
    """`cores`: combinations that need more are left out (None: nothing is)."""
    wanted: dict[tuple[int, int, tuple[int, int]], list[str]] = {}
    for r, t in itertools.product(ranks, threads):
        if cores is None or r * t <= cores:
            a, b = factors(r * t)
            for kind, counts in (("strong", (side, side)), ("weak", (side * a, side * b))):
                wanted.setdefault((r, t, counts), []).append(kind)
    found = [Run(r, t, counts, tuple(kinds)) for (r, t, counts), kinds in wanted.items()]
    # Copies are bound to this machine's cores, which no launcher does for them.
    if cores is not None and 1 in threads:
        found += [Run(r, 1, (side, side), ("copies",)) for r in ranks if 1 < r <= cores]
    return found


def words(launcher: str, ranks: int, threads: int) -> list[str]:
    """The launcher's command line with its numbers put in."""
    try:
        return [word.format(ranks=ranks, threads=threads) for word in shlex.split(launcher)]
    except (KeyError, IndexError, ValueError) as problem:
        raise Unreadable(f"--launcher '{launcher}': only {{ranks}} and {{threads}} are put in ({problem})") from None


def check(launcher: str, programs: list[Path]) -> None:
    """Before anything is run."""
    first = words(launcher, 1, 1)
    if not first:
        raise Unreadable("--launcher is empty; 'mpirun --bind-to none -n {ranks}' for instance")
    if "{ranks}" not in launcher:
        raise Unreadable(f"--launcher '{launcher}' names no {{ranks}}: every run would have the same number")
    if shutil.which(first[0]) is None:
        raise Unreadable(f"{first[0]} is not on the PATH: load or install MPI, or name the launcher with --launcher")
    for program in programs:
        if not program.is_file():
            raise Unreadable(f"{program} is not there: ./run build")


def start(command: list[str], ranks: int, threads: int, log: Path) -> str:
    """Standard output of a run that succeeded; `log` keeps all it said."""
    environment = os.environ | {"OMP_NUM_THREADS": str(threads)}
    if ranks == 1 and threads > 1:  # as in submit's job scripts; several ranks get their cores from the launcher
        environment = {"OMP_PLACES": "cores", "OMP_PROC_BIND": "close"} | environment
    try:
        done = subprocess.run(command, env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                              errors="replace", timeout=TIME_LIMIT)
    except subprocess.TimeoutExpired:
        raise Failed(f"did not end within {TIME_LIMIT} s: {shlex.join(command)}") from None
    except OSError as problem:
        raise Failed(f"{command[0]}: {problem.strerror}") from None
    writing.text(log, done.stdout + done.stderr)
    if done.returncode != 0:
        said = (done.stderr.strip() or done.stdout.strip()).splitlines()
        raise Failed(f"exit {done.returncode}: {shlex.join(command)}\n  " + "\n  ".join(said[-5:]) + f"\n  all of it: {log}")
    return done.stdout


def measure_copies(run: Run, program: Path, source: Path, steps: int, folder: Path) -> dict:
    """run.ranks separate runs at once, each on a core of its own: the first one's summary.json with all their rates' sum."""
    one = Run(1, 1, run.counts, run.kinds)
    cores = sorted(os.sched_getaffinity(0))[:run.ranks]

    def copy(core: int) -> dict:
        own = folder / f"copy_{core}"
        own.mkdir(exist_ok=True)
        return measure(one, f"taskset --cpu-list {core}", program, source, steps, own)

    with ThreadPoolExecutor(len(cores)) as pool:
        summaries = list(pool.map(copy, cores))
    return summaries[0] | {"particle_updates_per_second": sum(s["particle_updates_per_second"] for s in summaries)}


def measure(run: Run, launcher: str, program: Path, source: Path, steps: int, folder: Path) -> dict:
    """summary.json of one run. Its folder is removed after: the snapshots are large."""
    target = folder / run.name
    shutil.rmtree(target, ignore_errors=True)
    command = words(launcher, run.ranks, run.threads) + [str(program), str(source), "--output", str(target)]
    # The box grows with the counts, the input's spacing stays.
    for axis, n in zip("xy", run.counts):
        command += ["--set", f"domain.particles_{axis}={n}", "--set", f"domain.length_{axis}={n * SPACING!r}"]
    # No output between the steps: it is not timed, but it would leave the caches cold.
    for setting in [f"time.steps={steps}", "output.interval=0", f"output.history_interval={steps}"]:
        command += ["--set", setting]
    start(command, run.ranks, run.threads, folder / f"{run.name}.log")
    try:
        summary = json.loads((target / "summary.json").read_text(encoding="utf-8"))
    except (OSError, ValueError) as problem:
        raise Failed(f"{target}: no summary.json of a completed run ({problem})") from None
    # A launcher that ignores its number would give R separate runs, or one of the wrong size.
    for key, wanted in (("ranks", run.ranks), ("threads", run.threads), ("fluid_particles", run.particles)):
        if summary[key] != wanted:
            raise Failed(f"asked for {key} = {wanted}, but the run says {summary[key]}: is the launcher that of the MPI "
                         f"the programs are built with? {shlex.join(command)}")
    shutil.rmtree(target)
    return summary


def exchange(ranks: int, launcher: str, program: Path, folder: Path) -> dict:
    """What program `exchange` measured on so many ranks."""
    said = start(words(launcher, ranks, 1) + [str(program)], ranks, 1, folder / f"exchange_{ranks}.log")
    try:
        return json.loads(said[said.index("{"):said.rindex("}") + 1])
    except ValueError:
        raise Failed(f"exchange on {ranks} ranks wrote no JSON; it wrote {said[:200]!r}") from None
