"""Stopped runs go on: signals, the wall-clock limit, kill -9, damaged checkpoints; on other ranks, with the same bits."""

import json
import os
import re
import signal
import subprocess
import time

import unittest

from running import BAD_INPUT, CALCULATION_FAILED, COMPLETED, FILE_FAILED, INTERRUPTED, LIMIT_S, SLOW, Case, Result, command, environment
from test_ranks import case_of

LATEST = ["--restart", "latest"]


def long_case(program, method="euler"):
    """A case that goes on for a second or so after its first lines of history, on a fast machine too."""
    name, settings = case_of(program, **{"time.steps": 1000 if program != "disph_a" else 250, "time.dt": 0.1, "output.history_interval": 1})
    if method == "adaptive":
        settings.update({"time.method": "adaptive", "time.rtol": 1e-5, "time.t_end": 30 if program != "disph_a" else 8})
    return name, settings


class Restart(Case):
    def start(self, program, name, settings, output, ranks=None):
        """The run under way, in a process group of its own."""
        process = subprocess.Popen(
            command(program, *self.arguments(name, settings, self.here / output), ranks=ranks), cwd=self.here,
            env=environment(alone=ranks is None), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, start_new_session=True)
        self.addCleanup(lambda: process.poll() is None and os.killpg(process.pid, signal.SIGKILL))
        return process

    def wait_for(self, process, ready):
        end = time.monotonic() + LIMIT_S
        while not ready():
            self.assertIsNone(process.poll(), "the run ended before it could be stopped")
            self.assertLess(time.monotonic(), end, "the run does not come far enough")
            time.sleep(0.002)

    def lines(self, output):
        path = self.here / output / "history.csv"
        return path.read_text().count("\n") if path.exists() else 0

    def finish(self, process, output):
        _, errors = process.communicate(timeout=LIMIT_S)
        return Result(process.returncode, "", errors, self.here / output)

    def stop(self, program, name, settings, output, number, ranks=None, after=20):
        process = self.start(program, name, settings, output, ranks)
        self.wait_for(process, lambda: self.lines(output) > after)
        process.send_signal(number)
        result = self.finish(process, output)
        self.assertEqual(result.status, INTERRUPTED, result)
        return result

    def assert_interrupted(self, result):
        s = result.summary
        self.assertEqual(s["status"], "interrupted")
        self.assertIn("--restart latest", s["message"])
        self.assertIn("--restart latest", result.stderr)
        self.assertTrue((result.directory / f"checkpoint_{s['steps']:08d}.h5").exists(), "the checkpoint of the last step")

    def assert_same_run(self, whole, continued):
        """State, table and everything measured, as if nothing had happened."""
        a, b = whole.summary, continued.summary
        for name in ["status", "state_hash", "steps", "time", "errors", "conservation", "last_dt", "attempts"]:
            self.assertEqual(b[name], a[name], name)
        for table in ["history.csv"]:
            self.assertEqual((continued.directory / table).read_text(), (whole.directory / table).read_text())
        steps = [int(row[0]) for row in continued.rows()[1]]
        self.assertEqual(steps, sorted(set(steps)), "no step twice")

    def assert_goes_on(self, program, name, settings, output, **how):
        """The run that was stopped, continued for some steps, which make lists anew, is one of so many that was not; to its end
        where what takes long is done too."""
        stopped = json.loads((self.here / output / "summary.json").read_text())["steps"]
        self.assertLess(stopped, settings["time.steps"])
        if not SLOW:
            settings = {**settings, "time.steps": min(settings["time.steps"], stopped + 60)}
        whole = self.run_program(program, name, settings, f"{output}_whole")
        again = self.run_program(program, name, settings, output, options=LATEST, **how)
        self.assert_same_run(whole, again)
        return whole, again

    # ---- signals ----

    def test_signals(self):
        name, settings = long_case("disph_f")
        for number in [signal.SIGTERM, signal.SIGINT, signal.SIGUSR1, signal.SIGHUP, signal.SIGXCPU]:
            with self.subTest(number.name):
                stopped = self.stop("disph_f", name, settings, number.name, number)
                self.assert_interrupted(stopped)
                self.assertIn(f"stopped by {number.name} at step", stopped.summary["message"])
                self.assertIn(f"{number.name}: disph_f stops after this step, with a checkpoint", stopped.stderr)
                self.assert_goes_on("disph_f", name, settings, number.name, ranks=2 if SLOW or number == signal.SIGTERM else None)

    def test_signal_while_a_start_settles(self):
        """It stops at once, and leaves no directory."""
        settings = {"planet.particles": 200, "expert.settle": 1000, "time.t_end": 100}
        for ranks, number in [(None, signal.SIGTERM), (2, signal.SIGUSR1)]:  # which mpirun hands on
            process = self.start("planet", "planet_earth", settings, "out", ranks)
            while "radius" not in (line := process.stderr.readline()):  # told before the start settles
                self.assertNotEqual(line, "", "the run ended before it could be stopped")
            time.sleep(1)
            process.send_signal(number)
            stopped = self.finish(process, "out")
            self.assertEqual(stopped.status, INTERRUPTED, stopped)
            self.assertRegex(stopped.stderr, number.name + r" while the start settled, after \d+ of \d+ steps: nothing was written")
            self.assertFalse((self.here / "out").exists())

    def test_stop_file(self):
        """touch DIR/stop, which works under any launcher."""
        name, settings = long_case("disph_f")
        for ranks in [None, 2]:
            with self.subTest(ranks=ranks):
                output = f"ranks_{ranks}"
                process = self.start("disph_f", name, settings, output, ranks)
                self.wait_for(process, lambda: self.lines(output) > 20)
                (self.here / output / "stop").touch()
                stopped = self.finish(process, output)
                self.assertEqual(stopped.status, INTERRUPTED, stopped)
                self.assert_interrupted(stopped)
                self.assertIn("by the file stop", stopped.summary["message"])
                self.assertFalse((self.here / output / "stop").exists())
                self.assert_goes_on("disph_f", name, settings, output)

    def test_nohup(self):
        """A window that is closed does not stop a run that was told so."""
        name, settings = case_of("disph_f", **{"time.steps": 400})
        process = subprocess.Popen(
            ["nohup", *command("disph_f", *self.arguments(name, settings, self.here / "out"))], cwd=self.here,
            env=environment(), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        self.wait_for(process, lambda: self.lines("out") > 1)
        process.send_signal(signal.SIGHUP)
        self.assertEqual(self.finish(process, "out").status, COMPLETED)

    def test_reader_goes_away(self):
        """`disph_f … 2>&1 | head`: the run goes on without its reader."""
        name, settings = case_of("disph_f", **{"time.steps": 400})
        process = self.start("disph_f", name, settings, "out")
        process.stderr.close()
        self.wait_for(process, lambda: process.poll() is not None or (self.here / "out" / "summary.json").exists())
        self.assertEqual(process.wait(timeout=LIMIT_S), COMPLETED)

    def test_on_other_ranks(self):
        """Stopped on some ranks by the signal that mpirun hands on, continued on others."""
        cases = [("disph_a", "euler", 2, 3), ("disph_c", "euler", 4, 1), ("disph_c", "adaptive", 3, 4), ("disph_f", "adaptive", 2, None)]
        more = [("disph_f", "euler", 1, 4), ("disph_a", "adaptive", 1, 2)]
        for program, method, before, after in cases + more if SLOW else cases:
            with self.subTest(program=program, method=method):
                name, settings = long_case(program, method)
                output = f"{program}_{method}"
                stopped = self.stop(program, name, settings, output, signal.SIGUSR1, ranks=before, after=10)
                self.assert_interrupted(stopped)
                _, again = self.assert_goes_on(program, name, settings, output, ranks=after)
                if program == "disph_a":
                    self.assert_no_pass_twice(again)

    def assert_no_pass_twice(self, result):
        header, rows = result.rows("residuals.csv")
        passes = [(int(float(r[1])), int(float(r[2]))) for r in rows]
        self.assertEqual(len(passes), len(set(passes)))
        self.assertEqual([int(r[0]) for r in rows], sorted(int(r[0]) for r in rows))

    def test_twice(self):
        """Two stops one after the other, with snapshots due between."""
        name, settings = long_case("disph_c")
        settings["output.interval"] = 1.0
        self.stop("disph_c", name, settings, "out", signal.SIGTERM)
        process = subprocess.Popen(command("disph_c", *self.arguments(name, settings, self.here / "out", LATEST)),
                                   env=environment(), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        lines = self.lines("out")
        self.wait_for(process, lambda: self.lines("out") > lines + 10)
        process.send_signal(signal.SIGTERM)
        self.assertEqual(self.finish(process, "out").status, INTERRUPTED)
        whole, again = self.assert_goes_on("disph_c", name, settings, "out")
        snapshots = [sorted(p.name for p in r.directory.glob("snapshot_*.h5")) for r in (whole, again)]
        self.assertEqual(*snapshots)
        self.assertEqual(*((r.directory / "series.xdmf").read_text() for r in (whole, again)))

    # ---- limits and crashes ----

    def test_wall_clock_limit(self):
        name, settings = long_case("disph_c")
        limited = {**settings, "run.wall_clock_limit": 0.15}
        stopped = self.run_program("disph_c", name, limited, "out", expect=INTERRUPTED, ranks=2)
        self.assert_interrupted(stopped)
        self.assert_goes_on("disph_c", name, settings, "out")

    def test_killed(self):
        """kill -9: from the newest of the periodic checkpoints, whatever lies half written beside it."""
        name, settings = long_case("disph_f")
        settings.update({"run.checkpoint_interval": 10, "time.steps": 150})
        whole = self.run_program("disph_f", name, settings, "whole")
        process = self.start("disph_f", name, settings, "out")
        self.wait_for(process, lambda: (self.here / "out" / "checkpoint_00000030.h5").exists())
        os.killpg(process.pid, signal.SIGKILL)
        self.assertEqual(self.finish(process, "out").status, -signal.SIGKILL)
        (self.here / "out" / "checkpoint_00000140.h5.tmp").write_bytes(b"half")
        again = self.run_program("disph_f", name, settings, "out", options=LATEST, ranks=2)
        self.assert_same_run(whole, again)
        left = sorted(p.name for p in again.directory.glob("checkpoint_*"))
        self.assertEqual(left, ["checkpoint_00000140.h5", "checkpoint_00000150.h5"], "the two newest are kept")

    def test_longer(self):
        """A completed run goes on when more steps are asked for, as if it had not ended: also where neither a line nor
        a snapshot was due at its end. Its input stands in its directory."""
        name, settings = long_case("disph_f")
        settings.update({"time.steps": 60, "output.history_interval": 7, "output.interval": 1.5})
        whole = self.run_program("disph_f", name, settings, "whole")
        self.run_program("disph_f", name, {**settings, "time.steps": 40}, "out")
        again = self.call("disph_f", "--restart", "latest", "--output", "out", "--set", "time.steps=60",
                          directory=self.here / "out")
        self.assertEqual(again.status, COMPLETED, again)
        self.assert_same_run(whole, again)
        self.assertEqual(*((r.directory / "series.xdmf").read_text() for r in (whole, again)))
        # Once more with nothing left to do: the same files.
        before = {n: (again.directory / n).read_bytes() for n in ["history.csv", "series.xdmf", "snapshot_0004.h5"]}
        once_more = self.call("disph_f", "--restart", "latest", "--output", "out", directory=again.directory)
        self.assertEqual(once_more.status, COMPLETED, once_more)
        self.assertEqual(once_more.summary["state_hash"], whole.summary["state_hash"])
        self.assertEqual({n: (again.directory / n).read_bytes() for n in before}, before)

    def test_fewer_steps_than_time(self):
        """Which of two limits ended a run is told."""
        name, settings = long_case("disph_f", "adaptive")
        result = self.run_program("disph_f", name, {**settings, "time.steps": 5})
        self.assertEqual(result.summary["steps"], 5)
        self.assertIn("before t_end = 30 s, as time.steps asks for no more", result.summary["message"])
        self.assertIn("time.steps", result.stdout)

    def test_failed_calculation_leaves_the_last_good_state(self):
        """A fluid that falls until its pressure at the top is negative: exit 3 tells where, and the checkpoint is the
        state of the step before, as a run of just so many steps finds it."""
        settings = {"time.dt": 0.1, "time.steps": 200, "initial.profile": "uniform", "initial.pressure": 1e9,
                    "material.viscosity": 1e11, "output.interval": 0}
        failed = self.run_program("disph_c", "hydrostatic_column", settings, "out", expect=CALCULATION_FAILED)
        s = failed.summary
        self.assertEqual(s["status"], "failed")
        self.assertGreater(s["steps"], 10)
        self.assertGreaterEqual(s["metrics"]["collectives_per_step"], 1, "the step that failed is none")
        self.assertGreaterEqual(s["metrics"]["waiting_seconds_per_step"], 0)
        self.assertRegex(s["message"], rf"step {s['steps'] + 1}: .*pressure p = -.* particle \d+ at \(.*\) m")
        shorter = {**settings, "time.steps": s["steps"]}
        last = self.run_program("disph_c", "hydrostatic_column", shorter, "out", options=LATEST)
        self.assertEqual(last.summary["state_hash"], self.run_program("disph_c", "hydrostatic_column", shorter).summary["state_hash"])


class Checkpoints(Case):
    """Which checkpoint is taken, and which is refused."""

    def setUp(self):
        super().setUp()
        self.name, self.settings = case_of("disph_f", **{"time.steps": 30})
        self.saving = {**self.settings, "run.checkpoint_interval": 10}
        self.first = self.run_program("disph_f", self.name, self.saving, "out")
        self.checkpoints = sorted(self.first.directory.glob("checkpoint_*.h5"))
        self.assertEqual([p.name for p in self.checkpoints], ["checkpoint_00000020.h5", "checkpoint_00000030.h5"])

    def damage(self, path, position):
        content = bytearray(path.read_bytes())
        content[int(position * len(content))] ^= 0x40
        path.write_bytes(content)

    def continued(self, options=LATEST, expect=COMPLETED, program="disph_f", settings=None):
        return self.run_program(program, self.name, settings or self.saving, "out", options=options, expect=expect)

    def test_older_one_is_used_when_the_newest_is_damaged(self):
        for position in [0.0001, 0.3, 0.6, 0.95]:
            with self.subTest(position):
                self.damage(self.checkpoints[-1], position)
                again = self.continued()
                self.assertIn("checkpoint_00000030.h5", again.stderr)
                self.assertIn("damaged" if position > 0.1 else "checkpoint", again.stderr)
                self.assertEqual(again.summary["state_hash"], self.first.summary["state_hash"])
                self.assertEqual(len(self.checkpoints), len(list(again.directory.glob("checkpoint_*.h5"))))

    def test_cut_short(self):
        content = self.checkpoints[-1].read_bytes()
        self.checkpoints[-1].write_bytes(content[: len(content) // 2])
        again = self.continued()
        self.assertIn("checkpoint_00000030.h5", again.stderr)
        self.assertEqual(again.summary["state_hash"], self.first.summary["state_hash"])

    def test_all_damaged(self):
        for path in self.checkpoints:
            self.damage(path, 0.6)
        before = self.listing()
        failed = self.continued(expect=FILE_FAILED)
        for path in self.checkpoints:
            self.assertIn(path.name, failed.stderr)
        self.assertEqual(self.listing(), before)

    def test_damaged_by_name(self):
        self.damage(self.checkpoints[0], 0.6)
        before = self.listing()
        self.assertIn("checkpoint_00000020.h5", self.continued(["--restart", self.checkpoints[0]], FILE_FAILED).stderr)
        self.assertEqual(self.listing(), before)

    def test_by_name(self):
        again = self.continued(["--restart", self.checkpoints[0]])
        self.assertEqual(again.summary["state_hash"], self.first.summary["state_hash"])

    def test_into_another_runs_directory(self):
        """Its results would be lost: refused, and replaced only by --force. A directory of its own is made."""
        other = self.run_program("disph_f", self.name, {**self.saving, "time.steps": 7}, "other")
        before = self.listing()
        restart = ["--restart", self.checkpoints[0]]
        refused = self.run_program("disph_f", self.name, self.saving, "other", options=restart, expect=BAD_INPUT)
        self.assertIn("another run", refused.stderr)
        self.assertIn("--force", refused.stderr)
        self.assertEqual(self.listing(), before)
        # A checkpoint of this run among the files of another.
        (other.directory / "checkpoint_00000020.h5").write_bytes(self.checkpoints[0].read_bytes())
        (other.directory / "resolved.nml").write_text(
            re.sub(r"viscosity = \S+", "viscosity = 2.0", (other.directory / "resolved.nml").read_text()))
        before = self.listing()
        inside = ["--restart", other.directory / "checkpoint_00000020.h5"]
        self.run_program("disph_f", self.name, self.saving, "other", options=inside, expect=BAD_INPUT)
        self.assertEqual(self.listing(), before)

        for output, options in [("other", [*restart, "--force"]), ("branch", restart)]:
            again = self.run_program("disph_f", self.name, self.saving, output, options=options)
            self.assertEqual(again.summary["state_hash"], self.first.summary["state_hash"])
            self.assertEqual(sorted(p.name for p in again.directory.glob("checkpoint_*")), ["checkpoint_00000030.h5"])

    def test_without_input(self):
        again = self.call("disph_f", "--restart", self.checkpoints[0], directory=self.first.directory)
        self.assertEqual(again.status, COMPLETED, again)
        self.assertEqual(again.summary["state_hash"], self.first.summary["state_hash"])
        self.assert_says(self.call("disph_f", "--restart", "latest"), BAD_INPUT, "--output DIR")
        (self.here / "pipe").mkdir()
        os.mkfifo(self.here / "pipe" / "resolved.nml")
        self.assert_says(self.call("disph_f", "--restart", "latest", "--output", "pipe"), BAD_INPUT, "not a plain file")

    def test_damaged_tables(self):
        """A history that is not what was written is refused, an empty one is begun anew."""
        table = self.first.directory / "history.csv"
        whole = table.read_bytes()
        self.damage(table, 0.5)
        before = self.listing()
        self.assert_says(self.continued(expect=FILE_FAILED), FILE_FAILED, "history.csv", "Move it away")
        self.assertEqual(self.listing(), before)
        for lose in [lambda: table.write_bytes(b""), table.unlink]:
            lose()
            again = self.continued()
            self.assertEqual(again.summary["state_hash"], self.first.summary["state_hash"])
            self.assertIn("history.csv was lost", again.stderr)
        table.write_bytes(whole)

    def test_links_and_pipes(self):
        """A link leads nowhere, a pipe is not waited for."""
        pipe = self.here / "checkpoint_00000099.h5"
        os.mkfifo(pipe)
        self.assert_says(self.continued(["--restart", pipe], FILE_FAILED), FILE_FAILED, "not a plain file")
        os.mkfifo(self.first.directory / "checkpoint_00000099.h5")
        again = self.continued()
        self.assertIn("checkpoint_00000099.h5", again.stderr)
        self.assertEqual(again.summary["state_hash"], self.first.summary["state_hash"])
        log, elsewhere = self.first.directory / "run.log", self.here / "elsewhere"
        log.unlink()
        elsewhere.write_text("mine")
        log.symlink_to(elsewhere)
        self.assert_says(self.continued(expect=FILE_FAILED), FILE_FAILED, "run.log", "symbolic link")
        log.unlink()
        (self.first.directory / "run.log.tmp").symlink_to(self.here / "nowhere")
        self.run_program("disph_f", self.name, self.saving, "out", options=["--force"])
        self.assertEqual(elsewhere.read_text(), "mine")
        self.assertFalse((self.here / "nowhere").exists())

    def test_on_other_columns_of_ranks(self):
        for ranks, ranks_x in [(4, 1), (4, 4), (6, 3)]:
            with self.subTest(ranks=ranks, ranks_x=ranks_x):
                again = self.run_program("disph_f", self.name, {**self.saving, "domain.ranks_x": ranks_x}, "out",
                                         options=["--restart", self.checkpoints[0]], ranks=ranks)
                self.assertEqual(again.summary["state_hash"], self.first.summary["state_hash"])

    def test_no_checkpoint(self):
        for path in self.checkpoints:
            path.unlink()
        before = self.listing()
        self.assertIn("checkpoint", self.continued(expect=FILE_FAILED).stderr)
        self.continued(["--restart", "no_such.h5"], FILE_FAILED)
        self.assertEqual(self.listing(), before)
        missing = self.run_program("disph_f", self.name, self.saving, "nowhere", options=LATEST, expect=FILE_FAILED)
        self.assertIn("nowhere", missing.stderr)
        self.assertFalse((self.here / "nowhere").exists())

    def test_no_checkpoint_at_all_but_a_snapshot(self):
        """Another HDF5 file is no checkpoint."""
        before = self.listing()
        snapshot = next(self.first.directory.glob("snapshot_*.h5"))
        self.assertIn(snapshot.name, self.continued(["--restart", snapshot], FILE_FAILED).stderr)
        self.assertEqual(self.listing(), before)

    def test_of_another_program(self):
        before = self.listing()
        result = self.continued(expect=BAD_INPUT, program="disph_c")
        self.assertIn("disph_f", result.stderr)
        self.assertEqual(self.listing(), before, "something was written")

    def test_of_another_input(self):
        before = self.listing()
        result = self.continued(expect=BAD_INPUT, settings={**self.saving, "material.viscosity": 1e11})
        self.assertIn("viscosity", result.stderr)
        self.assertEqual(self.listing(), before, "something was written")


if __name__ == "__main__":
    unittest.main()
