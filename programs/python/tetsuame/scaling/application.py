"""The command line of the scaling study."""
import argparse
import json
import os
import platform
import shutil
import sys
import time
from pathlib import Path

from .. import COMPLETED, OUTPUT, ROOT, pages, writing
from ..reading import Unreadable
from . import analysis, runner


def numbers(text: str) -> list[int]:
    try:
        found = sorted({int(word) for word in text.split(",")})
    except ValueError:
        found = []
    if not found or found[0] < 1:
        raise argparse.ArgumentTypeError(f"'{text}': expected whole numbers from 1 on with commas between, as 1,2,4")
    return found


def count(least: int):
    def read(text: str) -> int:
        if not text.isdecimal() or int(text) < least:
            raise argparse.ArgumentTypeError(f"'{text}': expected a whole number, {least} or more")
        return int(text)
    return read


def parser() -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(
        prog="bench --scaling", formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Strong and weak scaling of program C over MPI ranks and threads. Writes scaling.json, exchange.json and report.html.",
        epilog="on a cluster, inside an allocation:\n"
               "  ./run bench --scaling --launcher 'srun -n {ranks} -c {threads}' --ranks 1,2,4,8,16 --threads 1,8")
    p.add_argument("--ranks", type=numbers, metavar="R,…", help="numbers of ranks (default: powers of two up to this machine's cores)")
    p.add_argument("--threads", type=numbers, metavar="T,…", help="numbers of threads a rank (default: likewise)")
    p.add_argument("--size", type=count(20), metavar="N", help="particles along one side: N² in all (strong), a core (weak); default 400")
    p.add_argument("--repeats", type=count(1), metavar="K", help="rounds; every run once in each (default 5)")
    p.add_argument("--steps", type=count(2), default=20, metavar="S", help="time steps of a run (default 20)")
    p.add_argument("--quick", action="store_true", help="under a minute: N = 150, 3 rounds, unless given")
    p.add_argument("--launcher", metavar="WORDS",
                   help="starts MPI programs; {ranks} and {threads} are put in (default: mpirun, each rank bound to its cores "
                        "where there are enough)")
    p.add_argument("--binaries", type=Path, default=ROOT / "build/programs", metavar="DIR", help="folder of the programs")
    p.add_argument("--output", type=Path, default=OUTPUT / "scaling", metavar="DIR", help="default output/scaling")
    return p


def cores_here() -> int:
    return len(os.sched_getaffinity(0))


def powers(limit: int) -> list[int]:
    return [1 << k for k in range(limit.bit_length()) if 1 << k <= limit] + ([limit] if limit & (limit - 1) else [])


def default_launcher(cores: int) -> str:
    """Unbound ranks may share one core while another is idle; bound ones would, where they are too many."""
    return ("mpirun --bind-to none -n {ranks}" if cores > cores_here()
            else "mpirun --map-by slot:PE={threads} --bind-to core -n {ranks}")


def processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        lines = []
    return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), platform.machine())


def machine() -> dict:
    return {"processor": processor(), "cores_here": cores_here(), "load_average": os.getloadavg()[0],
            "wait_policy": os.environ.get("OMP_WAIT_POLICY", "")}


def study(given: argparse.Namespace) -> None:
    cores = cores_here()
    # A named launcher may reach other machines, so that this one's cores say nothing.
    free = given.launcher is not None or (given.ranks is not None and given.threads is not None)
    if given.launcher is not None and given.ranks is None:
        raise Unreadable("--launcher needs --ranks: how many there may be is not known here")
    ranks = given.ranks or powers(cores)
    threads = given.threads or ([1] if given.launcher is not None else powers(cores))
    side = given.size or (150 if given.quick else 400)
    repeats = given.repeats or (3 if given.quick else 5)
    runs = runner.planned(ranks, threads, side, None if free else cores)
    if not runs:
        raise Unreadable(f"every combination needs more than this machine's {cores} cores: name both --ranks and --threads to "
                            "have them run all the same")
    program, exchange = given.binaries / "disph_c", given.binaries / "exchange"
    runner.check(given.launcher or default_launcher(1), [program, exchange])
    work = writing.folder(given.output) / "runs"
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir()

    begin = time.monotonic()
    facts = machine()
    readings: dict[runner.Run, list[dict]] = {run: [] for run in runs}
    source = ROOT / "inputs/hydrostatic_13.nml"
    for n in range(repeats):
        # There and back, so that a slow drift of the machine's speed favours none.
        for run in runs if n % 2 == 0 else runs[::-1]:
            launcher = given.launcher or default_launcher(run.cores)
            readings[run].append(runner.measure_copies(run, program, source, given.steps, work) if run.copies else
                                 runner.measure(run, launcher, program, source, given.steps, work))
        print(f"scaling: round {n + 1} of {repeats}, {len(runs)} runs each, {time.monotonic() - begin:.0f} s", file=sys.stderr, flush=True)
    rows = [analysis.result(kind, run, read, facts) for kind in ("strong", "weak", "copies") for run, read in readings.items() if kind in run.kinds]
    analysis.add_efficiency(rows)
    exchanges = [runner.exchange(r, given.launcher or default_launcher(r), exchange, work) for r in ranks if r > 1]
    for name, content in (("scaling", rows), ("exchange", exchanges)):
        writing.text(given.output / f"{name}.json", json.dumps(content, indent=1) + "\n")
    shutil.rmtree(work)


def report(folder: Path) -> None:
    from . import page  # matplotlib takes a second: not before the study, and not for a refusal

    rows, exchanges = analysis.read(folder)
    print(analysis.as_text(rows))
    if rows[0]["load_average"] >= analysis.QUIET:
        print(f"load average at the start {rows[0]['load_average']:.1f}: other work runs here, and these numbers "
              "show it; OMP_WAIT_POLICY=passive and OMPI_MCA_mpi_yield_when_idle=1 make it less bad")
    for fit in analysis.amdahl(rows):
        print(f"parallel fraction over {fit.over}: {fit.text}")
    print(pages.write(folder, page.page(rows, exchanges)))


def main(arguments: list[str]) -> int:
    given = parser().parse_args(arguments)
    study(given)
    report(given.output)
    return COMPLETED
