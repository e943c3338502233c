"""What can happen to a long run: killed at any moment, the disk full, other ranks each time, a directory that cannot be
written. Whatever it is, the run says so and the next one goes on to the same bits."""

import os
import pathlib
import random
import resource
import shutil
import signal
import subprocess
import time
import unittest

from running import BAD_INPUT, COMPLETED, FILE_FAILED, INTERRUPTED, LIMIT_S, SLOW, Case, Result, command, environment
from test_ranks import case_of

LATEST = ["--restart", "latest"]


def mounted(test, directory, options):
    """A small file system of its own at `directory`, where this user may mount one."""
    directory.mkdir()
    if not shutil.which("mount"):
        test.skipTest("there is no mount to make a small file system with")
    done = subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", directory], capture_output=True, text=True)
    if done.returncode != 0:
        test.skipTest(f"no file system can be mounted here: {done.stderr.strip()}")
    test.addCleanup(subprocess.run, ["umount", directory], check=True)


def descendants(pid):
    """The processes that this one has started, and those of theirs."""
    try:
        own = [int(word) for path in pathlib.Path(f"/proc/{pid}/task").glob("*/children") for word in path.read_text().split()]
    except (FileNotFoundError, ProcessLookupError):
        return []
    return own + [below for child in own for below in descendants(child)]


def kill_all(pid):
    """kill -9 of a run with all its ranks, which mpirun puts into process groups of their own."""
    for each in [pid, *descendants(pid)]:
        try:
            os.kill(each, signal.SIGKILL)
        except ProcessLookupError:
            pass


class Robust(Case):
    def start(self, program, name, settings, output, options=(), ranks=None, threads=1, **how):
        process = subprocess.Popen(
            command(program, *self.arguments(name, settings, self.here / output, options), ranks=ranks), cwd=self.here,
            # What killed ranks leave of the memory that they share goes with the test's directory.
            env={**environment(threads), "OMPI_MCA_btl_vader_backing_directory": str(self.here)},
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, start_new_session=True, **how)
        self.addCleanup(lambda: process.poll() is None and kill_all(process.pid))
        return process

    def finish(self, process, output):
        _, errors = process.communicate(timeout=LIMIT_S)
        return Result(process.returncode, "", errors, self.here / output)

    def wait_for(self, ready):
        end = time.monotonic() + LIMIT_S
        while not ready():
            self.assertLess(time.monotonic(), end)
            time.sleep(0.002)

    def checkpoints(self, output):
        return sorted(p.name for p in (self.here / output).glob("checkpoint_*.h5"))

    def assert_same(self, whole, again):
        for name in ["status", "state_hash", "steps", "time", "errors", "conservation", "attempts"]:
            self.assertEqual(again.summary[name], whole.summary[name], name)
        self.assertEqual((again.directory / "history.csv").read_text(), (whole.directory / "history.csv").read_text())


    def kill_again_and_again(self, whole, program, name, settings, output, times, draw, layouts=((None, 1),)):
        """kill -9 at moments drawn at random, each time on one of the layouts (ranks, threads); each time the run goes on
        from what is there, and it ends as the whole one did."""
        duration = whole.summary["wall_seconds"]
        first, kills, tries = output, 0, 0
        while kills < times:
            tries += 1
            self.assertLess(tries, 5 * times, "it completes before it is killed")
            ranks, threads = draw.choice(layouts)
            options = LATEST if self.checkpoints(output) else ["--force"]
            process = self.start(program, name, settings, output, options, ranks, threads)
            # Some at the start, while it reads and clears up; most while it steps.
            time.sleep(draw.uniform(0.0, 0.5 + duration / times))
            kill_all(process.pid)
            result = self.finish(process, output)
            self.assertIn(result.status, [-signal.SIGKILL, COMPLETED], result)
            self.assertNotIn("damaged", result.stderr, "a file of the final name is always whole")
            kills += result.status != COMPLETED
            if result.status == COMPLETED:  # and the same again from the start
                self.assert_same(whole, result)
                output = f"{first}_{tries}"
        options = LATEST if self.checkpoints(output) else ["--force"]
        again = self.run_program(program, name, settings, output, options=options)
        self.assert_same(whole, again)
        self.assertEqual([p.name for p in again.directory.glob("*.tmp")], [])
        snapshots = [sorted(p.name for p in r.directory.glob("snapshot_*.h5")) for r in (whole, again)]
        self.assertEqual(*snapshots)


class Killed(Robust):
    def killed(self, method, times):
        """With a checkpoint every few steps, so that many kills fall into the writing of one."""
        seed = random.randrange(1 << 30)
        name, settings = case_of("disph_f", **{"time.dt": 0.02, "time.steps": 30 * times + 60, "output.history_interval": 1,
                                               "output.interval": 1.0, "run.checkpoint_interval": 2})
        if method == "adaptive":
            settings.update({"time.method": "adaptive", "time.rtol": 1e-5, "time.t_end": 0.6 * times})
        whole = self.run_program("disph_f", name, settings, f"{method}_whole")
        with self.subTest(seed=seed):
            self.kill_again_and_again(whole, "disph_f", name, settings, method, times, random.Random(seed))

    def test_a_few_times(self):
        self.killed("euler", 2)

    @unittest.skipUnless(SLOW, "slow")
    def test_twenty_times(self):
        for method in ["euler", "adaptive"]:
            with self.subTest(method):
                self.killed(method, 20)

    def test_while_it_writes(self):
        """Stopped as soon as the temporary name stands, then killed: the checkpoint before is taken."""
        name, settings = case_of("disph_f", **{"time.dt": 0.02, "time.steps": 400, "run.checkpoint_interval": 1})
        whole = self.run_program("disph_f", name, {**settings, "run.checkpoint_interval": 0}, "whole")
        process = self.start("disph_f", name, settings, "out")
        directory = self.here / "out"
        half = False
        while not half and process.poll() is None:
            if any(directory.glob("checkpoint_*.h5.tmp")) and len(self.checkpoints("out")) > 1:
                os.kill(process.pid, signal.SIGSTOP)
                half = any(directory.glob("checkpoint_*.h5.tmp"))  # not renamed in the meantime
                if not half:
                    os.kill(process.pid, signal.SIGCONT)
        self.assertTrue(half, "never caught")
        os.killpg(process.pid, signal.SIGKILL)
        self.finish(process, "out")
        self.assertTrue(list(directory.glob("checkpoint_*.h5.tmp")))
        # Without further ones, each of which waits for the disk.
        again = self.run_program("disph_f", name, {**settings, "run.checkpoint_interval": 0}, "out", options=LATEST)
        self.assertEqual(again.summary["state_hash"], whole.summary["state_hash"])


class OtherRanks(Robust):
    def chain(self, layouts, method, program="disph_f"):
        """Some steps on each number of ranks in turn, each from the checkpoint of the one before."""
        # Wide enough for eight slices of twice the support.
        name, settings = case_of(program, **{"domain.particles_x": 80, "domain.length_x": 400e3, "domain.particles_y": 10,
                                             "domain.length_y": 50e3, "output.history_interval": 1})
        total = 5 * len(layouts)
        settings["time.steps"] = total
        if method == "adaptive":
            settings.update({"time.method": "adaptive", "time.rtol": 1e-4, "time.t_end": 3, "run.checkpoint_interval": 1})
        whole = self.run_program(program, name, settings, f"{program}_{method}_whole")
        output = f"{program}_{method}"
        for n, ranks in enumerate(layouts):
            part = dict(settings)
            if method == "adaptive":
                part["time.t_end"] = 3 * (n + 1) / len(layouts)
            else:
                part["time.steps"] = 5 * (n + 1)
                part["run.checkpoint_interval"] = 5
            last = self.run_program(program, name, part, output, options=LATEST if n else [], ranks=ranks)
            self.assertEqual(last.summary["ranks"], ranks)
        if method != "adaptive":  # an adaptive run has to hit the ends of the parts
            self.assert_same(whole, last)
            return last
        alone = f"{output}_one_rank"
        for n in range(len(layouts)):
            one = self.run_program(program, name, {**settings, "time.t_end": 3 * (n + 1) / len(layouts)}, alone,
                                   options=LATEST if n else [])
        self.assert_same(one, last)
        return last

    def test_fixed_steps(self):
        self.chain([3, 5, 1], "euler")

    @unittest.skipUnless(SLOW, "slow")
    def test_every_pair(self):
        """Each of 1, 2, 3, 5, 8 from a checkpoint of each other one."""
        numbers = [1, 2, 3, 5, 8]
        path = [1]
        left = {(a, b) for a in numbers for b in numbers if a != b}
        while left:  # the complete graph has a round trip through every edge
            step = next((b for b in sorted(numbers, key=lambda b: -sum(e[0] == b for e in left)) if (path[-1], b) in left), None)
            if step is None:
                step = min(left)[0]
            left.discard((path[-1], step))
            path.append(step)
        self.chain(path, "euler")

    @unittest.skipUnless(SLOW, "slow")
    def test_adaptive(self):
        self.chain([8, 1, 5, 2, 3], "adaptive")
        self.chain([3, 8, 2], "adaptive", "disph_c")


class FullDisk(Robust):
    """The run says which file, keeps the last good checkpoint, and exits with 4; with room again it goes on."""

    def setUp(self):
        super().setUp()
        self.name, self.settings = case_of("disph_f", **{"time.dt": 0.02, "time.steps": 60, "run.checkpoint_interval": 20})
        self.whole = self.run_program("disph_f", self.name, self.settings, "whole")

    def assert_goes_on(self, output):
        again = self.run_program("disph_f", self.name, self.settings, output, options=LATEST)
        self.assert_same(self.whole, again)

    def test_file_size_limit(self):
        """`ulimit -f`, which needs no rights: half of a checkpoint may be written. Set while the run is under way, for
        MPI's start needs files that are larger."""
        settings = {**self.settings, "time.steps": 900, "run.checkpoint_interval": 300}
        self.whole = self.run_program("disph_f", self.name, settings, "long")
        first = self.run_program("disph_f", self.name, {**settings, "time.steps": 300}, "out")
        size = next(first.directory.glob("checkpoint_*.h5")).stat().st_size // 2
        process = self.start("disph_f", self.name, settings, "out", LATEST)
        history = first.directory / "history.csv"
        self.wait_for(lambda: history.read_text().count("\n") > 33)
        resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (size, size))
        failed = self.finish(process, "out")
        self.assert_says(failed, FILE_FAILED, "checkpoint_00000600.h5", "File too large",
                         "checkpoint_00000300.h5 is good: continue with --restart latest")
        self.assertEqual(self.checkpoints("out"), ["checkpoint_00000300.h5"])
        self.assertEqual(list(failed.directory.glob("*.tmp")), [])
        self.assertEqual(failed.summary["status"], "failed")
        self.assertIn("File too large", failed.summary["message"])
        self.settings = settings
        self.assert_goes_on("out")

    def test_full(self):
        """A small file system, filled up during the run."""
        place = self.here / "small"
        mounted(self, place, "size=8m")
        self.run_program("disph_f", self.name, {**self.settings, "time.steps": 20}, place / "out")
        rest = os.statvfs(place)
        (place / "filler").write_bytes(bytes(max(0, rest.f_bavail * rest.f_frsize - 64 * 1024)))
        for ranks in [None, 2]:
            with self.subTest(ranks=ranks):
                process = self.start("disph_f", self.name, self.settings, place / "out", LATEST, ranks=ranks)
                failed = self.finish(process, place / "out")
                self.assert_says(failed, FILE_FAILED, "No space left on device", str(place),
                                 "checkpoint_00000020.h5 is good")
                self.assertIn("checkpoint_00000020.h5", self.checkpoints(place / "out"))
        (place / "filler").unlink()
        self.assert_goes_on(place / "out")

    def test_no_room_at_all(self):
        """Not even for the messages."""
        place = self.here / "small"
        mounted(self, place, "size=8m")
        self.run_program("disph_f", self.name, {**self.settings, "time.steps": 20}, place / "out")
        rest = os.statvfs(place)
        (place / "filler").write_bytes(bytes(rest.f_bavail * rest.f_frsize))
        failed = self.finish(self.start("disph_f", self.name, self.settings, place / "out", LATEST), place / "out")
        self.assert_says(failed, FILE_FAILED, "No space left on device", str(place))
        self.assertEqual(self.checkpoints(place / "out"), ["checkpoint_00000020.h5"])
        (place / "filler").unlink()
        self.assert_goes_on(place / "out")

    def test_read_only(self):
        place = self.here / "small"
        mounted(self, place, "size=8m")
        self.run_program("disph_f", self.name, {**self.settings, "time.steps": 20}, place / "out")
        subprocess.run(["mount", "-o", "remount,ro", place], check=True)
        for options in [LATEST, ["--force"]]:
            failed = self.run_program("disph_f", self.name, self.settings, place / "out", options=options, expect=FILE_FAILED)
            self.assert_says(failed, FILE_FAILED, "Read-only file system", str(place))
        new = self.run_program("disph_f", self.name, self.settings, place / "new", expect=FILE_FAILED)
        self.assert_says(new, FILE_FAILED, "Read-only file system")
        # The checkpoint can still be read from there, and the run go on elsewhere.
        again = self.run_program("disph_f", self.name, self.settings, "elsewhere",
                                 options=["--restart", place / "out" / "checkpoint_00000020.h5"])
        self.assertEqual(again.summary["state_hash"], self.whole.summary["state_hash"])


class Interrupted(Robust):
    def test_second_interrupt_ends_it_at_once(self):
        """Both within one step: the first Ctrl-C is noted, the second kills. A step that ends between the two writes its
        checkpoint first, so several tries."""
        name, settings = case_of("disph_f", **{"time.dt": 0.01, "time.steps": 100000, "output.history_interval": 1})
        statuses = []
        while -signal.SIGINT not in statuses and len(statuses) < 10:
            output = f"out_{len(statuses)}"
            process = self.start("disph_f", name, settings, output)
            history = self.here / output / "history.csv"
            self.wait_for(lambda: history.exists() and history.read_text().count("\n") > 3)
            process.send_signal(signal.SIGINT)
            # Until the first has been delivered: two that wait together are one.
            self.wait_for(lambda: process.poll() is not None or not self.pending(process.pid))
            process.send_signal(signal.SIGINT)
            statuses.append(self.finish(process, output).status)
        self.assertEqual(statuses[-1], -signal.SIGINT, statuses)
        self.assertLessEqual(set(statuses), {-signal.SIGINT, INTERRUPTED})

    def pending(self, pid):
        """Does SIGINT wait to be delivered?"""
        masks = [line.split()[1] for line in pathlib.Path(f"/proc/{pid}/status").read_text().splitlines()
                 if line.startswith(("SigPnd", "ShdPnd"))]
        return any(int(mask, 16) >> (signal.SIGINT - 1) & 1 for mask in masks)


class WhatMayChange(Robust):
    def test_groups(self):
        """&time, &output and &run may change at a restart, nothing else."""
        name, settings = case_of("disph_f", **{"time.dt": 0.02, "time.steps": 10, "run.checkpoint_interval": 10})
        self.run_program("disph_f", name, settings, "out")
        for change in [{"time.steps": 20}, {"time.steps": 25, "time.dt": 0.01, "time.t_end": 1, "time.method": "order_2"},
                       {"time.steps": 30, "output.history_interval": 3, "output.interval": 0.1},
                       {"time.steps": 40, "run.checkpoint_interval": 5, "run.wall_clock_limit": 1000}]:
            with self.subTest(change):
                again = self.run_program("disph_f", name, {**settings, **change}, "out", options=LATEST)
                self.assertEqual(again.summary["steps"], change["time.steps"])
        before = self.listing()
        for change in [{"initial.temperature": 3000}, {"walls.slip": "'free_slip'"}, {"kernel.name": "'cubic'"},
                       {"domain.particles_x": 30, "domain.length_x": 150e3}]:
            with self.subTest(change):
                refused = self.run_program("disph_f", name, {**settings, **change}, "out", options=LATEST, expect=BAD_INPUT)
                self.assertIn("a restart cannot change it, only &domain ranks_x, balance", refused.stderr)
                self.assertTrue(any(key.partition(".")[2] in refused.stderr for key in change), refused)
        self.assertEqual(self.listing(), before)

    def test_nothing_to_continue(self):
        name, settings = case_of("disph_f", **{"time.steps": 5})
        (self.here / "empty").mkdir()
        result = self.run_program("disph_f", name, settings, "empty", options=LATEST, expect=FILE_FAILED)
        self.assert_says(result, FILE_FAILED, "empty", "no checkpoint", "without --restart")
        self.assertEqual(list((self.here / "empty").iterdir()), [])


if __name__ == "__main__":
    unittest.main()
