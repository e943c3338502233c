"""Runs the cases, several at a time, and tells a calculation that failed from a program that did."""
import argparse
import functools
import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from pathlib import Path

from .. import writing
from ..reading import beside, last_line
from .cases import Run
from .outcomes import COMPLETED, CRASHED, DOUBTFUL, STOPPED, Outcome

ENDED = (COMPLETED, DOUBTFUL)  # statuses of a summary.json whose run came to its end
CALCULATION_FAILED = 3  # the exit status by which a program says so itself


def run_all(cases: list[tuple[Run, argparse.Namespace]]) -> list[Outcome]:
    """The outcomes in the order of the cases, each with what was given on the command line (of study.options).
    Those that others start from come first; then the long ones, so that none is left alone at the end."""
    work = [expected(case, given) for case, given in cases]
    jobs = cases[0][1].jobs
    progress = Progress(work, jobs)
    starts = {id(case.start) for case, _ in cases}
    with ThreadPoolExecutor(jobs) as pool:
        futures, of_run = {}, {}
        for index in sorted(range(len(cases)), key=lambda i: (id(cases[i][0]) not in starts, -work[i])):
            case, given = cases[index]
            future = of_run[id(case)] = pool.submit(run_one, case, given, progress, of_run.get(id(case.start)))
            futures[future] = index
        for future in as_completed(futures):
            progress.finished(future.result(), futures[future])
    progress.end()
    return [future.result() for future in sorted(futures, key=futures.get)]


def expected(case: Run, given: argparse.Namespace) -> float:
    """Seconds of the last time, else as its subject guesses; next to nothing for what need not run again."""
    record = beside(given.output.resolve() / "runs" / case.folder, ".json")
    try:
        if not given.fresh and recorded_status(record, fingerprint(given.binaries.resolve(), case)) is not None:
            return 1e-3
        return json.loads(record.read_text())["seconds"]
    except (OSError, ValueError, KeyError):
        return case.seconds


def run_one(case: Run, given: argparse.Namespace, progress: "Progress", start: Future | None) -> Outcome:
    """start: of the run whose last snapshot this one starts from."""
    folder = given.output.resolve() / "runs" / case.folder
    begun = start.result() if start else None
    if begun and (begun.kind != COMPLETED or begun.snapshot is None):
        return Outcome(case, CRASHED, f"the run that it starts from, {begun.case.label}, left no end", folder, {}, False)
    program = given.binaries.resolve() / case.binary
    if not program.is_file():
        return Outcome(case, CRASHED, f"the program {program.name} is not there: ./run build", folder, {}, False)

    mark = fingerprint(given.binaries.resolve(), case)
    record = beside(folder, ".json")
    if not given.fresh and (status := recorded_status(record, mark)) is not None:
        outcome = judge(case, folder, status, True)
        if outcome.kind != CRASHED:
            return outcome

    # Files of an earlier run would be taken for this one's, and the programs want an empty folder.
    shutil.rmtree(folder, ignore_errors=True)
    for old in (record, beside(folder, ".log")):  # a link too
        old.unlink(missing_ok=True)
    writing.folder(folder.parent)
    launcher = ["mpirun", "-n", str(case.ranks), "--bind-to", "none"] if case.ranks > 1 else []
    command = [*launcher, str(program), str(case.input), "--output", str(folder)]
    for setting in (*([f"{case.start_key}={begun.snapshot.path}"] if begun else []), *case.settings):
        command += ["--set", setting]
    progress.started(case)
    clock = time.monotonic()
    with open(beside(folder, ".log"), "w") as log:
        try:
            status = subprocess.run(command, stdout=log, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
                                    env=os.environ | {"OMP_NUM_THREADS": "1"},
                                    timeout=given.time_limit).returncode
        except subprocess.TimeoutExpired:
            return Outcome(case, CRASHED, f"did not end within {given.time_limit:g} s", folder, {}, False)
        except OSError as error:
            return Outcome(case, CRASHED, f"cannot be started: {error.strerror}", folder, {}, False)
    writing.text(record, json.dumps({"fingerprint": mark, "status": status, "seconds": round(time.monotonic() - clock, 2)}))
    return judge(case, folder, status, False)


def judge(case: Run, folder: Path, status: int, reused: bool) -> Outcome:
    """What the exit status and summary.json together say."""
    summary, fault = {}, "left an empty summary.json"
    try:
        summary = json.loads((folder / "summary.json").read_text())
    except OSError:
        fault = "left no summary.json"
    except ValueError:
        fault = "left a summary.json that is no JSON"
    said, kind = summary.get("status"), CRASHED
    if status < 0:
        reason = f"killed by {signal.Signals(-status).name if -status in iter(signal.Signals) else f'signal {-status}'}"
    elif status not in (0, CALCULATION_FAILED):
        line = last_line(beside(folder, ".log"))
        reason = f"exit {status}" + (f": {line.strip()[:200]}" if line else "")
    elif not summary:
        reason = f"exit {status}, but {fault}"
    elif (said in ENDED) != (status == 0):
        reason = f"exit {status}, but summary.json says '{said}'"
    elif status == 0:
        kind, reason = COMPLETED, summary.get("message", "") if said == DOUBTFUL else ""
    else:
        kind, reason = STOPPED, summary.get("message") or "the calculation failed"
    return Outcome(case, kind, reason, folder, summary, reused)


def fingerprint(binaries: Path, case: Run) -> str:
    """Changes with everything the result of a run depends on."""
    digest = hashlib.sha256()
    more = [fingerprint(binaries, case.start).encode()] if case.start else []
    more += [str(case.ranks).encode()] if case.ranks > 1 else []
    for part in (*programs(binaries, case.binary), case.input.read_bytes(), "\0".join(case.settings).encode(), *more):
        digest.update(len(part).to_bytes(8, "little"))
        digest.update(part)
    return digest.hexdigest()


def programs(binaries: Path, name: str) -> list[bytes]:
    """Digests of a program: of its launcher, and of what that chooses from, each in a folder for a kind of processor."""
    return [content(path, path.stat().st_mtime_ns) for path in (binaries / name, *sorted(binaries.glob(f"avx*/{name}")))]


@functools.cache
def content(path: Path, _changed: int) -> bytes:
    return hashlib.sha256(path.read_bytes()).digest()


def recorded_status(record: Path, mark: str) -> int | None:
    try:
        content = json.loads(record.read_text())
        return content["status"] if content["fingerprint"] == mark else None
    except (OSError, ValueError, KeyError):
        return None


class Progress:
    """One line, redrawn, on a terminal; a line for each finished run elsewhere."""

    def __init__(self, work: list[float], jobs: int):
        """work: expected seconds of each run, 0 where nothing is known."""
        known = [seconds for seconds in work if seconds > 0.0]
        usual = sum(known) / len(known) if known else 1.0
        self.work, self.jobs = [seconds if seconds > 0.0 else usual for seconds in work], jobs
        self.left = dict(enumerate(self.work))
        self.spent, self.start = 0.0, time.monotonic()  # spent: expected seconds of the finished runs that were not there already
        self.terminal = sys.stderr.isatty()
        self.running: list[str] = []

    def started(self, case: Run) -> None:
        self.running.append(f"{case.label} on {case.file}")
        self.draw()

    def finished(self, outcome: Outcome, index: int) -> None:
        work = self.left.pop(index)
        self.spent += 0.0 if outcome.reused else work
        name = f"{outcome.case.label} on {outcome.case.file}"
        if name in self.running:
            self.running.remove(name)
        if self.terminal:
            self.draw()
        elif not outcome.reused:
            print(f"compare: {self.counts()} {name}: {outcome.kind}{self.remaining()}", file=sys.stderr, flush=True)

    def counts(self) -> str:
        return f"{len(self.work) - len(self.left)}/{len(self.work)}"

    def remaining(self) -> str:
        """By what the finished runs took against what was expected of them."""
        if not self.left or self.spent <= 0.0:
            return ""
        seconds = (time.monotonic() - self.start) * sum(self.left.values()) / self.spent
        return f", about {duration(seconds)} left"

    def draw(self) -> None:
        if self.terminal:
            passed = duration(time.monotonic() - self.start)
            line = f"compare: {self.counts()} runs, {passed}{self.remaining()}; now {', '.join(self.running) or '-'}"
            width = shutil.get_terminal_size().columns - 1
            print(f"\r\033[K{line[:width]}", end="", file=sys.stderr, flush=True)

    def end(self) -> None:
        if self.terminal:
            print("\r\033[K", end="", file=sys.stderr, flush=True)


def duration(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 100 else f"{seconds / 60:.0f} min"
