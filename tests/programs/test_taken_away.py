"""What somebody does to a run's folder while it goes on, to its terminal, and to it in its first moments."""

import os
import pathlib
import re
import signal
import subprocess
import time
import unittest

from running import BAD_INPUT, COMPLETED, FILE_FAILED, INPUTS, INTERRUPTED, LIMIT_S, PROGRAMS, Case, Result, command, environment
from test_restart import long_case


class UnderWay(Case):
    def start(self, output, more=None):
        name, settings = long_case("disph_f")
        self.settings = {**settings, "output.history_interval": 1, **(more or {})}
        process = subprocess.Popen(command("disph_f", *self.arguments(name, self.settings, self.here / output)), cwd=self.here, env=environment(alone=True),
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)
        self.addCleanup(lambda: process.poll() is None and os.killpg(process.pid, signal.SIGKILL))
        table = self.here / output / "history.csv"
        end = time.monotonic() + LIMIT_S
        while not (table.exists() and table.read_text().count("\n") > 20):
            self.assertIsNone(process.poll(), "it ended too early")
            self.assertLess(time.monotonic(), end)
            time.sleep(0.002)
        return process

    def finish(self, process, output):
        said, errors = process.communicate(timeout=LIMIT_S)
        return Result(process.returncode, said, errors, self.here / output)

    def assert_whole(self, result):
        """A line for each step, and a restart takes the tables for what it knows."""
        steps = [int(row[0]) for row in result.rows()[1]]
        self.assertEqual(steps, list(range(len(steps))))
        again = self.call("disph_f", "--restart", "latest", "--output", result.directory, directory=result.directory)
        self.assertEqual(again.status, COMPLETED, again)

    def test_tables_and_log_are_deleted_or_replaced(self):
        process = self.start("out")
        table, log = self.here / "out" / "history.csv", self.here / "out" / "run.log"
        table.unlink()
        log.rename(self.here / "run.log")
        done = self.finish(process, "out")
        self.assertEqual(done.status, COMPLETED, done)
        for name in ("history.csv", "run.log"):
            told = [text for text in done.summary["warnings"] if name in text]
            self.assertEqual(len(told), 1, done.summary["warnings"])
            self.assertIn("with all its lines", told[0])
            self.assertIn(told[0], done.stderr)
            self.assertIn(told[0], log.read_text())
            self.assertIn(told[0], done.stdout)
        self.assertIn("results go to", done.stderr)
        self.assertIn("disph_f", log.read_text().splitlines()[1], "its first lines are there again")
        self.assertEqual(len(done.rows()[1]), done.summary["steps"] + 1)
        self.assert_whole(done)

    def test_a_table_is_cut_short(self):
        process = self.start("out")
        os.truncate(self.here / "out" / "history.csv", 200)
        done = self.finish(process, "out")
        self.assertEqual(done.status, COMPLETED, done)
        self.assertRegex(done.summary["warnings"][0], r"history.csv was changed by another program, and had 200 bytes instead of \d+: lines may be lost")
        header, rows = done.rows()
        self.assertTrue(all(len(row) == len(header) for row in rows))
        self.assertEqual(int(rows[-1][0]), done.summary["steps"])
        again = self.call("disph_f", "--restart", "latest", "--output", "out", directory=done.directory)
        self.assertEqual(again.status, COMPLETED, again)

    def test_the_folder_is_moved(self):
        """Nothing is told to be good where it is not."""
        process = self.start("out", {"run.checkpoint_interval": 10})
        (self.here / "out").rename(self.here / "elsewhere")
        done = self.finish(process, "elsewhere")
        self.assertEqual(done.status, FILE_FAILED, done)
        self.assertRegex(done.stderr, rf"the directory was moved, and {self.here}/elsewhere/checkpoint_\d+.h5 is good: continue with --restart latest "
                                      rf"--output {self.here}/elsewhere")
        again = self.call("disph_f", "--restart", "latest", "--output", self.here / "elsewhere", "--set", f"time.steps={self.settings['time.steps']}")
        self.assertEqual(again.status, COMPLETED, again)


class FirstMoments(Case):
    def test_signals_before_the_first_step(self):
        """As soon as the program, or its launcher, is there: the run ends with a checkpoint, and goes on from it."""
        name, settings = long_case("disph_f")
        for number in (signal.SIGTERM, signal.SIGUSR1):
            with self.subTest(number.name):
                output = self.here / number.name
                process = subprocess.Popen(command("disph_f", *self.arguments(name, settings, output)), env=environment(alone=True), cwd=self.here,
                                           stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
                status = pathlib.Path(f"/proc/{process.pid}/status")
                while not any(int(mask, 16) >> (number - 1) & 1 for mask in re.findall(r"Sig(?:Blk|Cgt):\s*(\w+)", status.read_text())):
                    pass
                process.send_signal(number)
                _, errors = process.communicate(timeout=LIMIT_S)
                self.assertEqual(process.returncode, INTERRUPTED, errors)
                self.assertIn("at step 0", errors)
                words = ["--restart", "latest", "--output", output, "--set", "time.steps=3"]
                self.assertEqual(self.call("disph_f", *words).status, COMPLETED)

    def test_what_only_reads_ends_at_once(self):
        """Tools and questions are no runs: a signal ends them."""
        for words in (["plan", "relaxation"], ["bench", "--help"]):
            if not (PROGRAMS / words[0]).exists():
                continue
            process = subprocess.Popen(["timeout", "-s", "TERM", "0.001", *command(*words)], env=environment(alone=True),
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            self.assertIn(process.wait(timeout=LIMIT_S), (0, 124))


class Terminal(Case):
    def test_what_was_asked_for_and_cannot_be_written(self):
        """A full disk is told, and no half of an answer passes for one."""
        questions = [["flow", INPUTS / "still_water.nml", "--check"], ["flow", "--describe"], ["disph_c", "--help"], ["rti", "--version"],
                     ["rti", INPUTS / "rti_linear.nml", "--theory"], ["conduction", INPUTS / "conduction_plate.nml", "--set", "time.steps=3", "--plan"],
                     ["plan", "relaxation"], ["plan", "timestep", "--help"], ["balance", "--describe"]]
        for program, *words in questions:
            if not (PROGRAMS / program).exists():
                continue
            with self.subTest(program, words=words), open("/dev/full", "w") as full:
                done = subprocess.run(command(program, *words), cwd=self.here, env=environment(alone=True), stdin=subprocess.DEVNULL, stdout=full,
                                      stderr=subprocess.PIPE, text=True, timeout=LIMIT_S)
                self.assertEqual(done.returncode, FILE_FAILED, done.stderr)
                self.assertIn("cannot write to the standard output: No space left on device", done.stderr)

    def test_a_restart_of_what_is_no_checkpoint(self):
        (self.here / "folder").mkdir()
        before = self.listing()
        for more in ([], [INPUTS / "still_water.nml", "--output", "out"]):
            self.assert_says(self.call("flow", *more, "--restart", "folder"), BAD_INPUT, "--restart folder: is a directory", "--restart latest --output folder")
            self.assert_says(self.call("flow", *more, "--restart", "missing.h5"), FILE_FAILED, "cannot read checkpoint missing.h5: there is no such file")
        self.assertEqual(self.listing(), before)


class Processors(Case):
    def plan(self, ranks=None, **variables):
        """Threads of each rank, and what is said of them."""
        name = INPUTS / "hydrostatic_12.nml"
        env = {key: value for key, value in environment().items() if key not in ("OMP_NUM_THREADS", "OMP_WAIT_POLICY")}
        done = subprocess.run(command("disph_f", name, "--set", "time.steps=2", "--output", self.fresh_name("out"), ranks=ranks), cwd=self.here,
                              env=env | variables, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=LIMIT_S)
        self.assertEqual(done.returncode, COMPLETED, done.stderr)
        threads = int(re.search(r"on \d+ ranks x (\d+) threads", (sorted(self.here.iterdir())[-1] / "run.log").read_text())[1])
        return threads, done.stderr

    def test_ranks_share_the_processors(self):
        available = len(os.sched_getaffinity(0))
        self.assertEqual(self.plan()[0], available)
        threads, said = self.plan(ranks=2)
        self.assertEqual(threads, max(1, available // 2))
        if available >= 2:
            self.assertNotIn("processor", said)
        threads, said = self.plan(ranks=2, OMP_NUM_THREADS=str(available))
        self.assertEqual(threads, available)
        self.assertIn(f"warning: {2 * available} threads of 2 ranks on {available} processor", said)
        if available >= 2:
            self.assertIn(f"set OMP_NUM_THREADS={available // 2}", said)


if __name__ == "__main__":
    unittest.main()
