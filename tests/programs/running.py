"""Runs the six programs the way a user does, each in a directory of its own.

Where the programs and the inputs are comes from the environment, which CMake sets:
TETSUAME_PROGRAMS, TETSUAME_INPUTS and TETSUAME_MPIEXEC. To run one test by hand:

    TETSUAME_PROGRAMS=build/programs TETSUAME_INPUTS=inputs TETSUAME_MPIEXEC=mpirun \\
        python3 -m unittest -v tests/programs/test_usage.py
"""

import atexit
import csv
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

PROGRAMS = pathlib.Path(os.environ["TETSUAME_PROGRAMS"]).resolve()
INPUTS = pathlib.Path(os.environ["TETSUAME_INPUTS"]).resolve()
MPIEXEC = os.environ["TETSUAME_MPIEXEC"]
ZOLTAN = os.environ.get("TETSUAME_ZOLTAN", "yes") == "yes"  # whether `balance` is built with it

COMPLETED, BAD_INPUT, CALCULATION_FAILED, FILE_FAILED, INTERRUPTED = 0, 2, 3, 4, 75
ALL = ["disph_a", "disph_b", "disph_c", "disph_d", "disph_e", "disph_f"]

# Above the longest run of any test here, so that a hanging program fails its test and not all of them.
LIMIT_S = 240
SLOW = bool(os.environ.get("TETSUAME_SLOW"))  # what takes long is done too

ENVIRONMENT = {
    "OMP_WAIT_POLICY": "passive",
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",  # the same, from Open MPI 5 on
    "OMPI_MCA_mpi_yield_when_idle": "1",  # more ranks than cores: who waits lets others work
}
# Of a run without mpirun. Open MPI starts no daemon for it and tries no networks: half a second less a run.
ALONE = {"OMPI_MCA_ess_singleton_isolated": "1", "OMPI_MCA_pml": "ob1"}
# Of one with it, a quarter of a second less. The transport that Open MPI chooses by itself is that of the modules' own tests, of runs
# that are stopped or killed, and of all when what takes long is done too.
RANKS = {} if SLOW else {"OMPI_MCA_pml": "ob1"}


class Result:
    """What a finished run left: its exit status, what it said, and its output directory."""

    def __init__(self, status, stdout, stderr, directory):
        self.status, self.stdout, self.stderr, self.directory = status, stdout, stderr, directory

    def __repr__(self):
        return f"exit {self.status}\n{self.stdout}{self.stderr}"

    @property
    def summary(self):
        return json.loads((self.directory / "summary.json").read_text())

    def rows(self, name="history.csv"):
        """The header and the lines of a table of the run, as texts."""
        with open(self.directory / name, newline="") as file:
            lines = list(csv.reader(file))
        return lines[0], lines[1:]


# Metrics of what a run cost on its ranks: those that another number of ranks, or another day, changes.
OF_RANKS = ("balance_", "time_spread", "load_max_over_mean", "waiting_seconds", "halo_", "migration_bytes", "fluid_halo", "wall_halo",
            "collectives_per_step")


def outcome(summary):
    """State and metrics of the flow: the same on any number of ranks and threads, and over restarts."""
    return summary["state_hash"], {name: value for name, value in summary["metrics"].items() if not name.startswith(OF_RANKS)}


def command(program, *arguments, ranks=None):
    start = [] if ranks is None else [MPIEXEC, "--bind-to", "none", "-n", str(ranks)]
    return [*start, str(PROGRAMS / program), *map(str, arguments)]


# Processes without mpirun that start at the same time fail where they make the one folder of all such: each has its own.
SESSIONS = tempfile.mkdtemp(prefix="tetsuame_mpi_")
atexit.register(shutil.rmtree, SESSIONS, ignore_errors=True)


def environment(threads=1, alone=False):
    by_itself = {**ALONE, "OMPI_MCA_orte_tmpdir_base": tempfile.mkdtemp(dir=SESSIONS)} if alone else {}
    return {**os.environ, **ENVIRONMENT, **by_itself, "OMP_NUM_THREADS": str(threads)}


class Case(unittest.TestCase):
    """A test with an empty directory `self.here`, which is also where its programs run."""

    def setUp(self):
        if os.environ.get("TETSUAME_RANKS") == "elsewhere" and "ranks" in self._testMethodName:
            self.skipTest("run by itself (CMakeLists.txt)")
        self.here = pathlib.Path(tempfile.mkdtemp(prefix="tetsuame_"))
        self.addCleanup(shutil.rmtree, self.here, ignore_errors=True)

    def call(self, program, *arguments, ranks=None, threads=1, directory=None, more=None):
        """Any command line, as it is. more: variables of the environment."""
        done = subprocess.run(
            command(program, *arguments, ranks=ranks), cwd=self.here,
            env=environment(threads, ranks is None) | ({} if ranks is None else RANKS) | (more or {}),
            stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=LIMIT_S)
        return Result(done.returncode, done.stdout, done.stderr, directory)

    def arguments(self, name, settings, directory, options=()):
        source = name if isinstance(name, pathlib.Path) else INPUTS / f"{name}.nml"
        changes = [word for key, value in settings.items() for word in ("--set", f"{key}={value}")]
        return [source, *changes, "--output", directory, *options]

    def run_program(self, program, name, settings=None, output=None, options=(), expect=COMPLETED, **how):
        """`program` on the shipped input `name` (or a path), with `settings` over it: {"time.steps": 10}."""
        directory = self.here / (output or self.fresh_name(program))
        result = self.call(program, *self.arguments(name, settings or {}, directory, options), directory=directory, **how)
        self.assertEqual(result.status, expect, result)
        return result

    def assert_exact(self, program, name, settings, steps, layouts=()):
        """The same outcome, in as many steps, on each of the layouts (ranks, threads), and after a restart at `steps` from two threads on three ranks.
        Of several layouts, the most ranks with the most threads, unless what takes long is done too."""
        if len(layouts) > 1 and not SLOW:
            layouts = [(max(ranks or 1 for ranks, _ in layouts), max(threads for _, threads in layouts))]
        whole = self.run_program(program, name, settings).summary

        def assert_same(s, how):
            for part in ("steps", "conservation", "fluid_particles", "wall_particles"):
                self.assertEqual(s[part], whole[part], f"{part}, {how}")
            self.assertEqual(outcome(s), outcome(whole), how)

        for ranks, threads in layouts:
            assert_same(self.run_program(program, name, settings, ranks=ranks, threads=threads).summary, f"{ranks} ranks, {threads} threads")
        directory = self.fresh_name("part")
        self.run_program(program, name, {**settings, "time.steps": steps, "run.checkpoint_interval": steps}, directory, threads=2)
        assert_same(self.run_program(program, name, settings, directory, ["--restart", "latest"], ranks=3).summary, f"restart at step {steps}")
        return whole

    def fresh_name(self, program):
        return f"{program}_{len(list(self.here.iterdir()))}"

    def assert_says(self, result, status, *parts):
        """The exit status, and every part of the message, in any order."""
        self.assertEqual(result.status, status, result)
        for part in parts:
            self.assertIn(part, result.stderr)

    def listing(self):
        """Every file below `here` with its content, to see that nothing was written."""
        return {path.relative_to(self.here): path.read_bytes() if path.is_file() else None
                for path in sorted(self.here.rglob("*"))}
