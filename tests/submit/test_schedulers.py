"""What `submit` refuses, the directives it writes, and chains of jobs under commands that stand in for pjsub, qsub and
sbatch: each keeps a queue of scripts, which the test runs one after the other as a scheduler would."""

import json
import os
import signal
import subprocess
import time
import unittest

from running import BAD_INPUT, CALCULATION_FAILED, COMPLETED, FILE_FAILED, INTERRUPTED, LIMIT_S, MPIEXEC, PROGRAMS, Case, environment
from test_ranks import case_of

# Appends its arguments to ./queue and answers as the command of that name does.
STAND_IN = """#!/bin/bash
printf '%s\\n' "$*" >>"$QUEUE"
n=$(wc -l <"$QUEUE")
case ${0##*/} in
  pjsub) echo "[INFO.] PJM 0000 pjsub Job ${n}_0 submitted." ;;
  qsub) echo "$n.server" ;;
  sbatch) echo "Submitted batch job $n" ;;
  scontrol) [[ $1 == requeue ]] || exit 1 ;;
esac
"""
COMMANDS = {"slurm": "sbatch", "pjm": "pjsub", "pbs": "qsub", "nqsv": "qsub"}
NUMBERS = {"slurm": "SLURM_JOB_ID", "pjm": "PJM_JOBID", "pbs": "PBS_JOBID", "nqsv": "PBS_JOBID"}


class Submit(Case):
    def setUp(self):
        super().setUp()
        self.queue = self.here / "queue"
        self.bin = self.here / "bin"
        self.bin.mkdir()
        for name in ["sbatch", "scontrol", "pjsub", "qsub"]:
            (self.bin / name).write_text(STAND_IN)
            (self.bin / name).chmod(0o755)
        self.out = self.here / "out"
        self.name, self.settings = case_of("disph_f", **{"time.dt": 0.02, "output.history_interval": 5})
        self.patience = "1"  # s that mpirun waits, twice after each job that is to be continued

    def environment(self):
        return {**environment(), "PATH": f"{self.bin}:{os.environ['PATH']}", "QUEUE": str(self.queue),
                "OMPI_MCA_odls_base_sigkill_timeout": self.patience}

    def submit(self, *options, scheduler="slurm", settings=None, program="disph_f", time="00:10:00", ranks=1):
        words = [PROGRAMS / "submit", program, *self.arguments(self.name, settings or self.settings, self.out),
                 "--scheduler", scheduler, "--time", time, "--ranks", ranks, *options]
        return subprocess.run([str(w) for w in words], cwd=self.here, env=self.environment(), stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, timeout=LIMIT_S)

    def accepted(self, *options, **how):
        done = self.submit(*options, **how)
        self.assertEqual(done.returncode, 0, done)
        return done

    def refused(self, *options, says, status=BAD_INPUT, **how):
        before = self.listing()
        done = self.submit(*options, **how)
        self.assertEqual(done.returncode, status, done)
        for part in says:
            self.assertIn(part, done.stderr)
        if status == BAD_INPUT:
            self.assertEqual(self.listing(), before, "something was written")

    def directives(self):
        lines = (self.out / "job.sh").read_text().splitlines()
        first = next(n for n, line in enumerate(lines) if line and not line.startswith("#"))
        found = [line for line in lines if line.startswith(("#SBATCH", "#PJM", "#PBS"))]
        self.assertEqual(found, [line for line in lines[:first] if line.startswith(("#SBATCH", "#PJM", "#PBS"))],
                         "schedulers read directives up to the first command")
        return found

    def queued(self):
        return self.queue.read_text().splitlines() if self.queue.exists() else []

    def state(self):
        return (self.out / "job.state").read_text().split()

    def log(self):
        path = self.out / "job.log"
        return path.read_text() if path.exists() else ""

    def start_job(self, scheduler, number=1):
        return subprocess.Popen(["bash", self.out / "job.sh"], cwd="/", stdin=subprocess.DEVNULL, start_new_session=True,
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                env={**self.environment(), NUMBERS[scheduler]: str(number)})

    def job(self, scheduler, number=1):
        process = self.start_job(scheduler, number)
        self.addCleanup(lambda: process.poll() is None and os.killpg(process.pid, signal.SIGKILL))
        return process.wait(timeout=LIMIT_S)

    def endless_settings(self):
        return {**self.settings, "time.steps": 1_000_000, "time.dt": 2e-3}

    def long_run(self, seconds):
        """Settings of a run that took at least this long, and its summary. A few steps, measured on a busy machine, would
        foretell too long a run."""
        steps = 1000
        while True:
            settings = {**self.settings, "time.steps": steps, "time.dt": 2e-3}
            whole = self.run_program("disph_f", self.name, settings, f"whole_{steps}").summary
            if whole["stepping_seconds"] >= seconds:
                return settings, whole
            steps *= 2


class Refused(Submit):
    def test_usage(self):
        self.refused(scheduler="lsf", says=["--scheduler"])
        self.refused("--queues", "x", says=["--queues"])
        self.refused(ranks=0, says=["--ranks"])
        self.refused(time="24", says=["--time 24", "HH:MM:SS"])
        self.refused(time="00:61:00", says=["HH:MM:SS"])
        self.refused(time="00:00:01", says=["two seconds"])
        self.refused("--nodes", 2, ranks=3, says=["--ranks 3", "--nodes 2"])
        self.refused("--queue", "a b", says=["--queue a b", "' '"])
        self.refused("--before", "true\nfalse", says=["line end"])
        self.refused("--chain", "ahead", says=["--max-jobs"])
        self.refused("--chain", "ahead", "--max-jobs", 3, scheduler="nqsv", says=["nqsv"])

    def test_more_ranks_than_fit(self):
        self.refused(ranks=900, says=["--ranks 900", "at most"])
        self.accepted(ranks=4)

    def test_program_and_input(self):
        self.refused(program="disph_z", says=["disph_z", "disph_a, disph_b"])
        self.refused(program="./disph_f", says=["no program"])
        self.refused(settings={"time.stepz": 1}, says=["disph_f", "stepz", "steps"])
        self.refused(settings={"time.dt": -1}, says=["dt"])
        self.name = self.here / "none.nml"
        self.refused(says=["none.nml"])

    def test_output(self):
        self.out.write_text("")
        self.refused(says=["is a file"])
        self.out.unlink()
        self.out.mkdir()
        (self.out / "summary.json").write_text("{}")
        self.refused(says=["results but no checkpoint", "--force"])
        self.accepted("--force")
        (self.out / "checkpoint_00000010.h5").write_text("")
        self.assertIn("continue from checkpoint_00000010.h5", self.accepted().stdout)
        self.accepted("--force")
        self.assertFalse((self.out / "checkpoint_00000010.h5").exists())
        (self.out / "summary.json").unlink()
        self.accepted()

    def test_scheduler_fails(self):
        (self.bin / "qsub").write_text("#!/bin/bash\necho 'no such queue' >&2\nexit 3\n")
        self.refused("--submit", scheduler="pbs", status=FILE_FAILED, says=["no such queue", "status 3", "script stands"])
        (self.bin / "pjsub").unlink()
        self.refused("--submit", scheduler="pjm", status=FILE_FAILED, says=["cannot run pjsub", "login node"])


class Directives(Submit):
    """Against the manuals: sbatch(1); Fujitsu's Job Operation Software End-user's Guide; PBS Professional's User's Guide;
    NEC's NQSV User's Guide [Operation]."""

    def test_slurm(self):
        self.accepted("--threads", 8, "--nodes", 2, "--partition", "large", "--account", "g7", "--name", "core",
                      "--directive=--mem=8G", ranks=6, time="24:00:00")
        self.assertEqual(self.directives(), [
            "#SBATCH --job-name=core", "#SBATCH --partition=large", "#SBATCH --account=g7", "#SBATCH --nodes=2",
            "#SBATCH --ntasks=6", "#SBATCH --ntasks-per-node=3", "#SBATCH --cpus-per-task=8", "#SBATCH --time=24:00:00",
            "#SBATCH --signal=B:USR1@300", "#SBATCH --requeue", "#SBATCH --open-mode=append",
            f"#SBATCH --output={self.out}/job.log", "#SBATCH --mem=8G"])
        text = (self.out / "job.sh").read_text()
        self.assertIn("\nlaunch=(srun --mpi=pmix --ntasks=6 --cpus-per-task=8 --cpu-bind=cores)\n", text)
        self.assertIn("export OMP_NUM_THREADS=8 OMP_PLACES=cores OMP_PROC_BIND=close\n", text)

    def test_what_is_not_said_is_left_out(self):
        self.accepted()
        words = " ".join(self.directives())
        for name in ["partition", "account", "nodes", "per-node"]:
            self.assertNotIn(name, words)

    def test_pjm(self):
        self.accepted("--threads", 15, "--nodes", 2, "--queue", "a-batch", "--group", "g7", scheduler="pjm", ranks=8, time="12:00:00")
        self.assertEqual(self.directives(), [
            "#PJM -N disph_f", "#PJM -g g7", "#PJM -L rscgrp=a-batch", "#PJM -L node=2", "#PJM -L elapse=12:00:00",
            "#PJM --mpi proc=8,max-proc-per-node=4", "#PJM -j", f"#PJM -o {self.out}/job_%j.out"])
        self.assertIn("mpiexec -n 8 -machinefile \"${PJM_O_NODEINF-}\" --map-by ppr:4:node:PE=15 --bind-to core",
                      (self.out / "job.sh").read_text())

    def test_pbs(self):
        self.accepted("--threads", 4, "--nodes", 2, "--queue", "workq", "--account", "a7", "--group", "g7", scheduler="pbs", ranks=8)
        self.assertEqual(self.directives(), [
            "#PBS -N disph_f", "#PBS -q workq", "#PBS -A a7", "#PBS -W group_list=g7",
            "#PBS -l select=2:ncpus=16:mpiprocs=4:ompthreads=4", "#PBS -l walltime=00:10:00", "#PBS -r y", "#PBS -j oe",
            f"#PBS -o {self.out}/job.out"])
        self.assertIn("mpirun -n 8 --map-by slot:PE=4 --bind-to core", (self.out / "job.sh").read_text())

    def test_nqsv(self):
        self.accepted("--threads", 4, "--nodes", 2, "--queue", "gen_S", "--group", "g7", scheduler="nqsv", ranks=8)
        self.assertEqual(self.directives(), [
            "#PBS -N disph_f", "#PBS -q gen_S", "#PBS --group=g7", "#PBS -T openmpi", "#PBS -b 2", "#PBS -l cpunum_job=16",
            "#PBS -l elapstim_req=00:10:00", "#PBS -j o", f"#PBS -o {self.out}/job.out"])

    def test_margin(self):
        for time_, margin in [("00:01:00", 30), ("01:00:00", 180), ("00:10:00", 60), ("24:00:00", 600)]:
            self.accepted(time=time_)
            self.assertIn(f"\nmargin={margin}\n", (self.out / "job.sh").read_text())
        self.accepted("--margin", 7)
        self.assertIn("\nmargin=7\n", (self.out / "job.sh").read_text())

    def test_odd_words_reach_the_program(self):
        """Quotes, blanks and dollars are data to the script, in the settings and in the name of the input."""
        copy = self.here / "it's $HOME `x`.nml"
        done = subprocess.run([PROGRAMS / "disph_f", "--describe"], env=environment(), capture_output=True, text=True)
        copy.write_text(done.stdout)
        self.name = copy
        self.accepted("--launcher", "env", "--before", f"echo before >{self.here}/mark",
                      settings={"time.steps": 3})
        self.assertEqual(self.job("slurm"), COMPLETED, self.log())
        self.assertEqual((self.here / "mark").read_text(), "before\n")


class Chains(Submit):
    def limit(self, seconds):
        """A limit below the one second that the script can count."""
        script = self.out / "job.sh"
        text = script.read_text()
        self.assertEqual(text.count('"$limit"'), 1)
        script.write_text(text.replace('"$limit"', f'"{seconds}"'))

    def chain(self, scheduler, most=12, after_first=None):
        """Runs what is queued until nothing more is, and calls `after_first` after the first. Returns the exit statuses."""
        statuses = []
        while len(self.queued()) > len(statuses):
            self.assertLess(len(statuses), most, self.log())
            statuses.append(self.job(scheduler, len(statuses) + 1))
            if after_first and len(statuses) == 1:
                after_first()
        return statuses

    def test_until_complete(self):
        """The same state as an uninterrupted run, the ranks started by the script's own command where that needs no
        scheduler. How Slurm goes on: test_slurm.py."""
        settings, whole = self.long_run(1.5)
        for scheduler, ranks, more in [("pjm", 1, ["--launcher", "env"]), ("pbs", 1, []), ("nqsv", 1, [])]:
            with self.subTest(scheduler):
                self.queue.unlink(missing_ok=True)
                self.out = self.here / f"out_{scheduler}"
                self.accepted("--submit", *more, scheduler=scheduler, ranks=ranks, settings=settings)
                self.assertEqual(self.queued(), [str(self.out / "job.sh")])
                script = (self.out / "job.sh").read_text()
                self.limit(0.2 * whole["stepping_seconds"])
                # mpirun waits after each job that is to be continued: with it only the first has a limit.
                after_first = None if more else lambda: (self.out / "job.sh").write_text(script)
                statuses = self.chain(scheduler, most=60, after_first=after_first)
                self.assertEqual(statuses, [INTERRUPTED] * (len(statuses) - 1) + [COMPLETED], self.log())
                self.assertGreaterEqual(len(statuses), 2, self.log())
                self.assertEqual(set(self.queued()), {str(self.out / "job.sh")})
                summary = json.loads((self.out / "summary.json").read_text())
                self.assertEqual(summary["state_hash"], whole["state_hash"])
                self.assertEqual(self.state()[:2], ["completed", str(len(statuses))])

    def test_ahead(self):
        self.accepted("--submit", "--chain", "ahead", "--max-jobs", 3, scheduler="pjm")
        script = self.out / "job.sh"
        self.assertEqual(self.queued(), [f"--step --sparam sn=0 {script}",
                                         f"--step --sparam jid=1,sn=1,sd=ec!=75:all:0 {script}",
                                         f"--step --sparam jid=2,sn=2,sd=ec!=75:all:1 {script}"])
        self.queue.unlink()
        self.accepted("--submit", "--chain", "ahead", "--max-jobs", 3, scheduler="pbs")
        self.assertEqual(self.queued(), [str(script), f"-W depend=afterany:1.server {script}", f"-W depend=afterany:2.server {script}"])

    def test_ahead_stops(self):
        """After the run is complete, or has failed, the jobs that are left do nothing."""
        self.accepted("--chain", "ahead", "--max-jobs", 3, "--launcher", "env", scheduler="pbs", settings={**self.settings, "time.steps": 3})
        self.assertEqual([self.job("pbs", n) for n in (1, 2)], [COMPLETED, COMPLETED])
        self.assertIn("nothing left to do", self.log())
        self.assertEqual(self.state()[0], "completed")
        self.accepted("--force", "--chain", "ahead", "--max-jobs", 3, "--launcher", "false", scheduler="pbs")
        self.assertEqual([self.job("pbs", n) for n in (1, 2)], [1, 1])
        self.assertIn("the job before stopped the chain", self.log())

    def test_failures_stop_it(self):
        for status, says in [(BAD_INPUT, "input was refused"), (CALCULATION_FAILED, "calculation failed"),
                             (FILE_FAILED, "a file could not be"), (139, "ended with status 139")]:
            with self.subTest(status):
                self.accepted("--launcher", f"bash -c 'exit {status}'", scheduler="pbs")
                self.assertEqual(self.job("pbs"), status)
                self.assertIn(says, self.log())
                self.assertEqual(self.queued(), [])
                self.assertEqual(self.state()[0], "stopped")

    def test_no_progress_stops_it(self):
        """No step fits into the limit: the first job gets as far as the start, the second no farther."""
        self.accepted("--submit", "--launcher", "env", scheduler="pbs", settings={**self.settings, "time.steps": 10000000})
        self.limit(1e-9)
        self.assertEqual(self.chain("pbs"), [INTERRUPTED, 1])
        self.assertIn("no step was completed", self.log())

    def test_killed_before_the_first_checkpoint(self):
        """It starts anew; after the second time in a row the chain ends. Submitted by hand it tries again."""
        self.accepted("--launcher", "env", scheduler="pbs", settings={**self.settings, "time.steps": 400})
        for _ in range(2):
            process = self.start_job("pbs")
            end = time.monotonic() + LIMIT_S
            while not (self.out / "snapshot_0000.h5").exists() and time.monotonic() < end:
                time.sleep(0.01)
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            self.assertEqual(self.state()[0], "running")
            (self.out / "snapshot_0000.h5").unlink()
        self.assertEqual(self.job("pbs"), 1)
        self.assertIn("two jobs in a row", self.log())
        self.assertEqual(self.job("pbs"), COMPLETED, self.log())

    def test_too_many_jobs(self):
        self.accepted("--submit", "--max-jobs", 2, "--launcher", "env", scheduler="pbs", settings=self.endless_settings())
        self.limit(0.2)
        self.assertEqual(self.chain("pbs"), [INTERRUPTED, 1])
        self.assertIn("2 jobs were not enough", self.log())

    def start_stepping(self, scheduler):
        """The job, once its run has written a few lines."""
        process = self.start_job(scheduler)
        self.addCleanup(lambda: process.poll() is None and os.killpg(process.pid, signal.SIGKILL))
        history = self.out / "history.csv"
        end = time.monotonic() + LIMIT_S
        while not (history.exists() and history.read_text().count("\n") > 5) and time.monotonic() < end:
            time.sleep(0.01)
        return process

    def test_signals(self):
        """USR1: on with the next job. TERM, and without a scheduler INT and HUP: checkpoint, and no further job."""
        settings = self.endless_settings()
        for number, queued, outcome in [(signal.SIGUSR1, 1, "interrupted"), (signal.SIGTERM, 0, "stopped"),
                                        (signal.SIGINT, 0, "stopped"), (signal.SIGHUP, 0, "stopped")]:
            with self.subTest(number.name):
                self.queue.unlink(missing_ok=True)
                self.out = self.here / number.name
                self.accepted("--launcher", "env", scheduler="pjm", settings=settings)
                process = self.start_stepping("pjm")
                os.kill(process.pid, number)  # the shell alone, as B: in --signal=B:USR1
                self.assertEqual(process.wait(timeout=LIMIT_S), INTERRUPTED, self.log())
                self.assertEqual(len(self.queued()), queued)
                self.assertEqual(self.state()[0], outcome, self.log())

    def test_mpirun_is_ended(self):
        """TERM to shell and mpirun, as a scheduler sends it: the ranks have their time, and the chain knows why it ended,
        whatever mpirun returns."""
        self.accepted("--launcher", f"{MPIEXEC} --bind-to none -n 2", scheduler="pbs", ranks=2, settings=self.endless_settings())
        process = self.start_stepping("pbs")
        os.killpg(process.pid, signal.SIGTERM)  # shell and mpirun; the ranks are in groups of their own
        self.assertEqual(process.wait(timeout=LIMIT_S), INTERRUPTED, self.log())
        self.assertIn("ended from outside after a checkpoint", self.log())
        self.assertEqual((self.queued(), self.state()[0]), ([], "stopped"))
        self.assertEqual(json.loads((self.out / "summary.json").read_text())["status"], "interrupted")

    def test_time_that_mpirun_leaves(self):
        """Between its signals to the ranks, and twice at the end: within the margin."""
        for margin, seconds in [(1, 1), (11, 1), (30, 5), (60, 10), (600, 10)]:
            self.accepted("--launcher", f"bash -c 'echo $OMPI_MCA_odls_base_sigkill_timeout >{self.here}/seconds'", "--force",
                          "--margin", margin, scheduler="pbs", time="01:00:00")
            self.patience = ""
            self.assertEqual(self.job("pbs"), COMPLETED, self.log())
            self.assertEqual((self.here / "seconds").read_text(), f"{seconds}\n")

    def test_next_cannot_be_submitted(self):
        self.accepted("--launcher", "env", scheduler="pjm", settings={**self.endless_settings(), "run.wall_clock_limit": 1})
        (self.bin / "pjsub").unlink()
        self.assertEqual(self.job("pjm"), INTERRUPTED)
        self.assertIn(f"on the login node: pjsub {self.out}/job.sh", self.log())


if __name__ == "__main__":
    unittest.main()
