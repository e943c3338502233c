"""Jobs that continue themselves on a real Slurm, and end in the same state as a run that was never stopped."""

import json
import pathlib
import re
import subprocess
import tempfile
import time
import unittest

import cluster
from running import PROGRAMS, Case, environment
from test_ranks import case_of

# Each requeue takes some seconds.
LIMIT_S = 150


@unittest.skipIf(cluster.missing(), cluster.missing())
class Slurm(Case):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="tetsuame_slurm_")
        cls.addClassCleanup(cls.folder.cleanup)
        cls.cluster = cluster.Cluster(pathlib.Path(cls.folder.name) / "cluster", environment())
        cls.addClassCleanup(cls.cluster.stop)

    def setUp(self):
        super().setUp()
        self.pending = {}  # since when each job waits

    def case(self, seconds):
        """A run of so long on one rank of this machine."""
        name, settings = case_of("disph_f", **{"time.dt": 2e-3, "output.history_interval": 20})
        tried = self.run_program("disph_f", name, {**settings, "time.steps": 200}).summary
        settings["time.steps"] = max(200, int(200 * seconds / tried["stepping_seconds"]))
        return name, settings

    def submit(self, name, settings, output, *options, ranks=1):
        """Returns the numbers of the jobs."""
        words = [PROGRAMS / "submit", "disph_f", *self.arguments(name, settings, self.here / output), "--scheduler", "slurm",
                 "--ranks", ranks, "--time", "00:05:00", "--submit", *options]
        done = subprocess.run([str(w) for w in words], cwd=self.here, env=self.cluster.environment,
                              capture_output=True, text=True, timeout=LIMIT_S)
        self.assertEqual(done.returncode, 0, done)
        return re.findall(r"Submitted batch job (\d+)", done.stdout)

    def log(self, output):
        path = self.here / output / "job.log"
        return path.read_text() if path.exists() else ""

    def wait(self, output, ready):
        end = time.monotonic() + LIMIT_S
        while not ready():
            self.assertLess(time.monotonic(), end, f"it takes too long\n{self.log(output)}")
            time.sleep(0.1)

    def hurry(self, job):
        """A requeued job would wait two minutes. Not at once: slurmd holds the credential of the ended one as revoked
        for all of that second and a little more."""
        if self.cluster.job_state(job) != "PENDING":
            self.pending.pop(job, None)
        elif time.monotonic() > self.pending.setdefault(job, time.monotonic()) + 3:
            self.cluster.run("scontrol", "update", f"JobId={job}", "StartTime=now", check=False)

    def finish(self, output, job):
        """Until the job is in the queue no more."""
        def over():
            self.hurry(job)
            return self.cluster.job_state(job) not in ("PENDING", "RUNNING", "COMPLETING", "CONFIGURING", "REQUEUED")
        self.wait(output, over)
        return self.cluster.job_state(job)

    def state(self, output):
        """outcome, jobs, began, again"""
        return (self.here / output / "job.state").read_text().split()

    def assert_same(self, output, whole, ranks=1):
        summary = json.loads((self.here / output / "summary.json").read_text())
        for name in ["status", "state_hash", "steps", "time", "errors", "conservation"]:
            self.assertEqual(summary[name], whole.summary[name], f"{name}\n{self.log(output)}")
        self.assertEqual(summary["ranks"], ranks)
        self.assertEqual((self.here / output / "history.csv").read_text(), (whole.directory / "history.csv").read_text())

    def test_time_runs_out(self):
        """Several times, by the limit the script hands to the program."""
        name, settings = self.case(4)
        whole = self.run_program("disph_f", name, settings, "whole")
        job, = self.submit(name, {**settings, "run.wall_clock_limit": 1}, "out")
        self.assertEqual(self.finish("out", job), "COMPLETED", self.log("out"))
        self.assert_same("out", whole)
        outcome, jobs, *_ = self.state("out")
        self.assertEqual(outcome, "completed")
        self.assertGreaterEqual(int(jobs), 3, self.log("out"))

    def test_chain_submitted_ahead(self):
        name, settings = self.case(2)
        whole = self.run_program("disph_f", name, settings, "whole")
        jobs = self.submit(name, {**settings, "run.wall_clock_limit": 1}, "out", "--chain", "ahead", "--max-jobs", 6)
        self.assertEqual(len(jobs), 6)
        self.assertEqual(self.finish("out", jobs[-1]), "COMPLETED", self.log("out"))
        self.assert_same("out", whole)
        outcome, count, *_ = self.state("out")
        self.assertEqual(outcome, "completed")
        self.assertGreaterEqual(int(count), 2)
        self.assertEqual(self.log("out").count("nothing left to do"), 6 - int(count), self.log("out"))

    def test_warned_and_cancelled(self):
        """USR1, as Slurm sends it before the time is up: the job goes on by itself. scancel: it does not, until it is
        submitted again."""
        name, settings = self.case(4)
        whole = self.run_program("disph_f", name, settings, "whole")
        job, = self.submit(name, settings, "out", ranks=2)
        history = self.here / "out" / "history.csv"
        lines = lambda: history.read_text().count("\n") if history.exists() else 0
        self.wait("out", lambda: lines() > 5)
        self.cluster.run("scancel", "--batch", "--signal=USR1", job)
        self.wait("out", lambda: self.state("out")[0] == "interrupted")

        before = lines()
        self.wait("out", lambda: self.hurry(job) or lines() > before + 5)
        self.cluster.run("scancel", job)
        self.assertEqual(self.finish("out", job), "CANCELLED")
        self.wait("out", lambda: self.state("out")[0] == "stopped")
        self.assertIn("ended from outside after a checkpoint", self.log("out"))

        again = re.search(r"\d+", self.cluster.run("sbatch", self.here / "out" / "job.sh")).group()
        self.assertEqual(self.finish("out", again), "COMPLETED", self.log("out"))
        self.assert_same("out", whole, ranks=2)


if __name__ == "__main__":
    unittest.main()
