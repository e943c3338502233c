"""Attacks on stopped and continued runs of every program: killed at any moment and continued on other ranks and threads,
their directories damaged, the disk full at each of their files, ten thousand snapshots.

TETSUAME_ATTACKS: how many kills, damages and full disks (20; a campaign has 200). TETSUAME_SEED: repeats a draw.
"""

import os
import pathlib
import random
import shutil
import signal
import subprocess
import time
import unittest

import h5py

from running import BAD_INPUT, COMPLETED, FILE_FAILED, LIMIT_S, Result, command, environment
from test_ranks import case_of
from test_restart import long_case
from test_robust import LATEST, Robust, descendants, kill_all, mounted

ATTACKS = int(os.environ.get("TETSUAME_ATTACKS", 20))
SEED = int(os.environ.get("TETSUAME_SEED", random.randrange(1 << 30)))

# A program that refuses a directory says so at once.
REFUSAL_S = 5

OFTEN = {"run.checkpoint_interval": 4, "output.history_interval": 3}
SMALL = {"domain.particles_x": 16, "domain.particles_y": 16}


def hydrostatic(program):
    return program, *case_of(program, **{**OFTEN, "output.interval": 1.0})


# Runs of a second or two: program, input, settings.
CASES = {
    **{program[-1]: hydrostatic(program) for program in ["disph_a", "disph_b", "disph_c", "disph_d", "disph_e", "disph_f"]},
    "f_adaptive": ("disph_f", *case_of("disph_f", **{**OFTEN, "time.method": "adaptive", "time.rtol": 1e-5, "time.t_end": 6,
                                                     "time.steps": 1000})),
    "rti": ("rti", "rti_note", {**SMALL, **OFTEN, "time.t_end": 2000, "output.interval": 500}),
    "drop": ("drop", "drop_emulsion", {**OFTEN, "domain.particles_x": 32, "domain.particles_y": 48, "time.steps": 60,
                                       "output.interval": 300}),
    "conduction": ("conduction", "conduction_plate", {**OFTEN, "conduction.operator": "corrected", "domain.jitter": 0.1,
                                                      "time.t_end": 400, "output.interval": 100}),
    "mantle": ("convection", "blankenbach_1a", {**SMALL, **OFTEN, "time.steps": 80, "output.interval": 1e16}),
    "air": ("convection", "air_1e4", {**SMALL, **OFTEN, "time.steps": 80, "output.interval": 10}),
    "shock": ("shock", "sod", {**OFTEN, "domain.particles_x": 100, "output.interval": 0.05}),
}
LAYOUTS = [(None, 1), (None, 2), (2, 1), (3, 1), (2, 2)]


def command_line(pid):
    """Empty of a process that has ended."""
    try:
        return pathlib.Path(f"/proc/{pid}/cmdline").read_text()
    except (FileNotFoundError, ProcessLookupError):
        return ""


class Attack(Robust):
    def draw(self):
        """Numbers of this test's own, told when it fails."""
        return random.Random(f"{SEED} {self.id()}")


class Killed(Attack):
    def test_every_program(self):
        draw = self.draw()
        share = [ATTACKS // len(CASES) + (n < ATTACKS % len(CASES)) for n in range(len(CASES))]
        for (label, (program, name, settings)), times in zip(CASES.items(), share):
            with self.subTest(label, seed=SEED):
                whole = self.run_program(program, name, settings, f"{label}_whole")
                self.kill_again_and_again(whole, program, name, settings, label, times, draw, LAYOUTS)

    def test_one_of_many(self):
        """A rank dies, or mpirun alone, and the others with it: two runs never write into one directory."""
        draw = self.draw()
        name, settings = long_case("disph_c")
        settings["run.checkpoint_interval"] = 20
        whole = self.run_program("disph_c", name, settings, "whole")
        for number in range(max(2, ATTACKS // 10)):
            whom = ["a rank", "mpirun"][number % 2]
            with self.subTest(whom, seed=SEED):
                output = f"out_{number}"
                process = self.start("disph_c", name, settings, output, ranks=3)
                self.wait_for(lambda: len(self.checkpoints(output)) > 1)
                time.sleep(draw.uniform(0.0, 0.2))
                ranks = [pid for pid in descendants(process.pid) if "disph_c" in command_line(pid)]
                self.assertEqual(len(ranks), 3)
                os.kill(draw.choice(ranks) if whom == "a rank" else process.pid, signal.SIGKILL)
                self.assertNotEqual(self.finish(process, output).status, COMPLETED)
                self.wait_for(lambda: not any("disph_c" in command_line(pid) for pid in ranks))
                self.assert_same(whole, self.run_program("disph_c", name, settings, output, options=LATEST))


# ---- damaged directories ----

def flip(path, draw, outside):
    content = bytearray(path.read_bytes())
    for _ in range(draw.choice([1, 1, 1, 100])):
        content[draw.randrange(len(content))] ^= 1 << draw.randrange(8)
    path.write_bytes(content)


def blank(path, draw, outside):
    """A block of a file that the disk has lost."""
    content = bytearray(path.read_bytes())
    at = draw.randrange(len(content))
    content[at:at + 4096] = bytes(len(content[at:at + 4096]))
    path.write_bytes(content)


def cut(path, draw, outside):
    os.truncate(path, draw.randrange(path.stat().st_size))


def lengthen(path, draw, outside):
    with open(path, "ab") as file:
        file.write(draw.randbytes(draw.choice([1, 4096])))


def empty(path, draw, outside):
    os.truncate(path, 0)


def delete(path, draw, outside):
    path.unlink()


def link_out(path, draw, outside):
    """The file stands elsewhere, where nothing may be written."""
    target = outside / path.name
    shutil.move(path, target)
    path.symlink_to(target)


def link_nowhere(path, draw, outside):
    path.unlink()
    path.symlink_to(outside / "nowhere")


def link_circle(path, draw, outside):
    path.unlink()
    path.symlink_to(path)


def pipe(path, draw, outside):
    path.unlink()
    os.mkfifo(path)


def folder(path, draw, outside):
    path.unlink()
    path.mkdir()


def exchange(path, draw, outside):
    """With another file of the directory."""
    others = sorted(p for p in path.parent.iterdir() if p != path)
    if others:
        other = draw.choice(others)
        path.rename(path.parent / "between")
        other.rename(path)
        (path.parent / "between").rename(other)


def temporary(path, draw, outside):
    """What the next writing of the file meets."""
    name = path.with_name(path.name + ".tmp")
    draw.choice([lambda: name.symlink_to(outside / "nowhere"), lambda: os.mkfifo(name), lambda: name.write_bytes(b"half")])()


DAMAGES = [flip, flip, blank, cut, lengthen, empty, delete, link_out, link_nowhere, link_circle, pipe, folder, exchange, temporary]


class Damaged(Attack):
    """Continued all the same to the same bits, or refused at once; nothing outside of the directory changes."""

    def half_way(self, label):
        """A run that was stopped, and the one that was not."""
        program, name, settings = CASES[label]
        if label not in self.made:
            whole = self.run_program(program, name, settings, f"{label}_whole")
            steps = max(1, whole.summary["steps"] // 2)
            self.run_program(program, name, {**settings, "time.steps": steps, "run.checkpoint_interval": max(1, steps // 2)}, f"{label}_half")
            self.made[label] = whole
        return program, name, settings, self.made[label]

    def attempt(self, words, directory):
        """A run that may not hang."""
        process = subprocess.Popen(words, cwd=self.here, env=environment(), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.PIPE, text=True, start_new_session=True)
        began = time.monotonic()
        try:
            _, errors = process.communicate(timeout=LIMIT_S / 8)
        except subprocess.TimeoutExpired:
            kill_all(process.pid)
            self.fail(f"it hangs: {process.communicate()[1]}")
        return Result(process.returncode, "", errors, directory), time.monotonic() - began

    def states(self, place):
        """What stands there, without following links: kind, content."""
        return {path.relative_to(place): os.readlink(path) if path.is_symlink() else path.read_bytes() if path.is_file() else path.is_dir()
                for path in sorted(place.rglob("*"))}

    def once(self, label, draw, damages):
        program, name, settings, whole = self.half_way(label)
        place = self.here / "place"
        shutil.rmtree(place, ignore_errors=True)
        out, outside = place / "out", place / "outside"
        shutil.copytree(self.here / f"{label}_half", out)
        outside.mkdir()
        told = []
        for damage in damages:
            files = sorted(p for p in out.iterdir() if p.is_file() and not p.is_symlink() and p.stat().st_size)
            path = draw.choice(files)
            damage(path, draw, outside)
            told.append(f"{damage.__name__} {path.name}")
        before = self.states(outside)
        # With its input, or by what the directory says of it; the time's settings go beyond where it stopped.
        by_input = draw.random() < 0.5
        arguments = self.arguments(name, settings, out, LATEST)
        if not by_input:
            arguments = ["--restart", "latest", "--output", out]
            arguments += [word for key, value in settings.items() if key.startswith("time.") for word in ("--set", f"{key}={value}")]
            arguments += [] if "time.steps" in settings else ["--set", "time.steps=100000000"]
        result, seconds = self.attempt(command(program, *arguments), out)
        told = f"{label}, {'by the input' if by_input else 'without input'}: {', '.join(told)}: {result}"
        self.assertIn(result.status, [COMPLETED, BAD_INPUT, FILE_FAILED], told)
        self.assertEqual(self.states(outside), before, f"something outside has changed; {told}")
        if result.status != COMPLETED:
            self.assertLess(seconds, REFUSAL_S, told)
            self.assertTrue(result.stderr.strip(), "refused without a word")
            return "refused"
        self.assertEqual(result.summary["state_hash"], whole.summary["state_hash"], told)
        # A table is what was measured, or said to be lost.
        if (out / "history.csv").read_text() != (whole.directory / "history.csv").read_text():
            self.assertIn("history.csv", result.stderr, told)
        return "exact"

    def setUp(self):
        super().setUp()
        self.made = {}

    def test_at_random(self):
        draw = self.draw()
        ended = []
        for number in range(ATTACKS):
            label = draw.choice(list(CASES))
            damages = [draw.choice(DAMAGES) for _ in range(draw.choice([1, 1, 1, 2, 3]))]
            with self.subTest(number=number, seed=SEED):
                ended.append(self.once(label, draw, damages))
        print(f"{ended.count('exact')} exact, {ended.count('refused')} refused of {ATTACKS}")


# ---- no room ----

class NoRoom(Attack):
    """The disk full at every file in turn: status 4, the file is named, what is good is good, and with room the run goes on."""

    def setUp(self):
        super().setUp()
        self.place = self.here / "small"
        mounted(self, self.place, "size=64m")

    def limit(self, options):
        subprocess.run(["mount", "-o", f"remount,{options}", self.place], check=True, capture_output=True)

    def fill(self, pages):
        """So many pages of 4 KiB are left."""
        (self.place / "filler").unlink(missing_ok=True)
        rest = os.statvfs(self.place)
        (self.place / "filler").write_bytes(bytes(max(0, rest.f_bavail - pages) * rest.f_frsize))

    def fails_and_goes_on(self, program, name, settings, whole, options=()):
        """One run without room, and its continuation once there is some; None if there was room."""
        out = self.place / "out"
        tried = self.finish(self.start(program, name, settings, out, options), out)
        if tried.status == COMPLETED:
            self.assert_same(whole, tried)
            return None
        self.assert_says(tried, FILE_FAILED, "No space left on device", str(self.place))
        for checkpoint in self.checkpoints(out) if out.exists() else []:
            with h5py.File(out / checkpoint):
                pass  # what has its final name is whole
        (self.place / "filler").unlink(missing_ok=True)
        self.limit("size=64m,nr_inodes=100000")
        again = self.run_program(program, name, settings, out, options=LATEST if out.exists() and self.checkpoints(out) else ["--force"])
        self.assert_same(whole, again)
        line = next(line for line in tried.stderr.splitlines() if "No space left" in line)
        return line.partition(str(out))[2].lstrip("/").partition(":")[0]

    def test_no_new_file(self):
        """Every file that a run makes is in turn the one that cannot be made."""
        for label in ["a", "f", "shock"]:
            program, name, settings = CASES[label]
            whole = self.run_program(program, name, settings, f"{label}_whole")
            met = []
            for inodes in range(2, 40):
                with self.subTest(label, inodes=inodes):
                    shutil.rmtree(self.place / "out", ignore_errors=True)
                    self.limit(f"nr_inodes={inodes}")
                    file = self.fails_and_goes_on(program, name, settings, whole)
                    if file is None:
                        break
                    met.append(file)
            self.assertGreater(len(set(met)), 4, met)

    def test_no_block(self):
        """The room ends at a moment drawn at random, of a run that begins and of one that goes on."""
        draw = self.draw()
        met = []
        for number in range(ATTACKS):
            label = draw.choice(["a", "f", "rti", "conduction"])
            with self.subTest(label, number=number, seed=SEED):
                program, name, settings = CASES[label]
                if not (self.here / f"{label}_whole").exists():
                    self.run_program(program, name, settings, f"{label}_whole")
                whole = Result(COMPLETED, "", "", self.here / f"{label}_whole")
                shutil.rmtree(self.place / "out", ignore_errors=True)
                self.limit("size=64m")
                options = []
                if draw.random() < 0.5:
                    steps = whole.summary["steps"] // 2
                    self.run_program(program, name, {**settings, "time.steps": steps, "run.checkpoint_interval": steps}, self.place / "out")
                    options = LATEST
                whole_size = sum(p.stat().st_size for p in whole.directory.iterdir()) // 4096
                self.fill(draw.randrange(whole_size))
                met.append(self.fails_and_goes_on(program, name, settings, whole, options))
        files = sorted({file for file in met if file})
        self.assertGreater(len(files), 1, met)
        print(f"{sum(file is not None for file in met)} of {ATTACKS} runs met a full disk, at {', '.join(files)}")


    def test_no_room_for_tables(self):
        """Lines are all that a run writes between two checkpoints far apart."""
        program, name, settings = CASES["a"]
        settings = {**settings, "time.steps": 300, "time.dt": 0.02, "output.interval": 0, "output.history_interval": 1,
                    "run.checkpoint_interval": 299}
        whole = self.run_program(program, name, settings, "whole")
        met = []
        for pages in range(8):
            with self.subTest(pages=pages):
                shutil.rmtree(self.place / "out", ignore_errors=True)
                self.run_program(program, name, {**settings, "time.steps": 5, "run.checkpoint_interval": 5}, self.place / "out")
                self.fill(pages)
                met.append(self.fails_and_goes_on(program, name, settings, whole, LATEST))
        self.assertLessEqual({"history.csv", "residuals.csv"}, set(met))


# ---- many snapshots ----

class Snapshots(Attack):
    NUMBER = 10000

    def used(self, process):
        """CPU seconds and resident bytes of a process."""
        fields = pathlib.Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK"), int(fields[21]) * os.sysconf("SC_PAGE_SIZE")

    def test_ten_thousand(self):
        """The last thousand cost no more than the first; nothing is kept in memory for them."""
        name, settings = case_of("disph_f", **{"domain.particles_x": 8, "domain.length_x": 40e3, "domain.particles_y": 8, "domain.length_y": 40e3,
                                               "time.dt": 1e-3, "time.steps": self.NUMBER, "output.interval": 1e-3})
        process = self.start("disph_f", name, settings, "out")
        marks = []
        for number in [1000, 2000, self.NUMBER - 1000, self.NUMBER - 1]:
            while not (self.here / "out" / f"snapshot_{number:04d}.h5").exists():
                self.assertIsNone(process.poll(), "it ended early")
                time.sleep(0.001)
            marks.append(self.used(process))
        result = self.finish(process, "out")
        self.assertEqual(result.status, COMPLETED)
        self.assertEqual(len(list(result.directory.glob("snapshot_*.h5"))), self.NUMBER + 1)
        (t1, rss1), (t2, _), (t3, _), (t4, rss4) = marks
        print(f"CPU seconds a thousand: {t2 - t1:.2f} the second, {t4 - t3:.2f} the last; resident {rss1 / 1e6:.1f} MB and {rss4 / 1e6:.1f} MB")
        self.assertLess(t4 - t3, 1.2 * (t2 - t1))
        self.assertLess(rss4, rss1 + 2e6)


if __name__ == "__main__":
    unittest.main()
