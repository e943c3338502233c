"""What the package's commands do with files that are damaged, missing, or not what they should be, with output that cannot be written,
and in surroundings of every kind: one sentence, exit 2 or 4, nothing written."""
import json
import os
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

import h5py
import numpy as np

import inside
from test_runs import SOURCES, Case, write_run, write_series

REPOSITORY = Path(__file__).resolve().parents[2]
N = 16  # particles of the snapshots


def put(name, values):
    """A data set in the place of another one; None: none."""
    def change(file):
        del file[name]
        if values is not None:
            file[name] = values
    return change


def header(**attributes):
    def change(file):
        for name, value in attributes.items():
            file["Header"].attrs[name] = value
    return change


# Of a snapshot that plot, movie, view, paraview and compare read.
DAMAGED = {
    "empty": b"", "half": lambda whole: whole[:len(whole) // 2], "zeros": lambda whole: bytes(len(whole)),
    "noise": lambda whole: np.random.default_rng(1).bytes(len(whole)), "text": b"&domain\n/\n",
    "no header": lambda file: file.__delitem__("Header"), "no fluid": lambda file: file.__delitem__("PartType0"),
    "fluid is no group": put("PartType0", np.zeros(3)), "time is not finite": header(Time=np.nan), "time is a word": header(Time="soon"),
    "seven dimensions": header(Dimension=7), "no dimension": header(Dimension=0), "box of nothing": header(BoxLengths=[0.0] * 3),
    "box without an end": header(BoxLengths=[np.inf] * 3), "box of two lengths": header(BoxLengths=[1.0], Periodic=[0]),
    "places are not finite": put("PartType0/Coordinates", np.full((N, 3), np.nan)), "places are numbers": put("PartType0/Coordinates", np.ones(N)),
    "places on a line": put("PartType0/Coordinates", np.ones((N, 1))), "places are words": put("PartType0/Coordinates", np.array([b"x"] * N)),
    "IDs are vectors": put("PartType0/ParticleIDs", np.ones((N, 3))), "too few IDs": put("PartType0/ParticleIDs", np.arange(N - 1)),
    "temperatures of others": put("PartType0/Temperature", np.ones(N + 1)), "a temperature": put("PartType0/Temperature", 5.0),
    "no mass": put("PartType0/Masses", np.zeros(N)), "mass is not finite": put("PartType0/Masses", np.full(N, np.inf)),
    "density is not finite": put("PartType0/Density", np.full(N, np.nan)), "more than the box": put("PartType0/Masses", np.full(N, 1e300)),
    "no places": put("PartType0/Coordinates", None), "of another dimension": header(Dimension=3)}
# Of other files: what they hold instead, and which commands then end with 4.
OTHERS = {"history.csv": ("plot", "compare"), "resolved.nml": ("compare",), "summary.json": ("compare",), "series.xdmf": ("paraview",)}
INSTEAD = {"bytes": b"\xff\xfe\x00time\n1\n", "a pipe": os.mkfifo, "a folder": os.mkdir}
WRITE = {"summary.json": {"half": b'{"status": "comp', "a list": b"[1]", "deep": b"[" * 100000},
         "history.csv": {"words": b"time [s],v [m/s]\n1,two\n", "no time": b"step [1],v [m/s]\n1,2\n2,3\n"},
         "series.xdmf": {"empty": b"", "half": b"<Xdmf><Domain>", "other names": b"<Xdmf><DataItem>none.h5:/a</DataItem></Xdmf>"}}


class Damage(Case):
    def setUp(self):
        super().setUp()
        self.run_, self.other = (write_series(write_run(self.here / name, n=4, times=(0, 10))) for name in "ab")
        (self.here / "three.js").write_text("")
        self.commands = {"plot": (self.run_,), "movie": (self.run_, "--gif"), "view": (self.run_, "--three", self.here / "three.js"),
                         "paraview": (self.run_,), "compare": (self.other, self.run_, "--output", self.here / "page")}

    def assert_one_sentence(self, name, *words, status=4, what=""):
        """And nothing is written."""
        before = sorted(self.here.rglob("*"))
        with self.subTest(what, command=name):
            self.assert_refused(inside.call(name, *self.commands[name]), *words, status=status)
            self.assertEqual(sorted(self.here.rglob("*")), before)

    def test_snapshots(self):
        path = self.run_ / "snapshot_0001.h5"
        whole = path.read_bytes()
        for what, change in DAMAGED.items():
            if isinstance(change, bytes):
                path.write_bytes(change)
            elif what in ("half", "zeros", "noise"):
                path.write_bytes(change(whole))
            else:
                with h5py.File(path, "a") as file:
                    change(file)
            for name in self.commands:
                self.assert_one_sentence(name, "snapshot_0001.h5", what=what, status=2 if what == "no places" else 4)
            path.write_bytes(whole)
        path.unlink()
        os.mkfifo(path)
        for name in self.commands:
            self.assert_one_sentence(name, "snapshot_0001.h5", "no regular file")

    def test_other_files(self):
        for file, commands in OTHERS.items():
            path = self.run_ / file
            whole = path.read_bytes()
            for what, instead in (INSTEAD | WRITE.get(file, {})).items():
                path.unlink()
                path.write_bytes(instead) if isinstance(instead, bytes) else instead(path)
                for name in commands:
                    # Without an input as run it is no run's folder.
                    status = 2 if file == "resolved.nml" and not path.is_file() else 4
                    self.assert_one_sentence(name, *([file] if status == 4 else []), status=status, what=f"{file}: {what}")
                path.rmdir() if path.is_dir() else path.unlink()
                path.write_bytes(whole)

    def test_fields_that_are_not_there(self):
        """Of a run with &output fields: what has its fields is drawn, and what has not says so."""
        for path in self.run_.glob("snapshot_*.h5"):
            with h5py.File(path, "a") as file:
                for name in ("Velocities", "Temperature"):
                    del file["PartType0"][name]
        for name in ("plot", "view", "paraview"):
            self.assertEqual(inside.call(name, *self.commands[name]).returncode, 0)
        for name, option in (("plot", "--fields"), ("movie", "--fields"), ("view", "--fields"), ("paraview", "--field"), ("compare", "--fields")):
            self.commands[name] += (option, "Speed")
            self.assert_one_sentence(name, "no field '", status=2)

    def test_vectors_are_not_drawn(self):
        for name, option in (("plot", "--fields"), ("movie", "--fields"), ("view", "--fields"), ("paraview", "--field"), ("compare", "--fields")):
            self.commands[name] += (option, "Velocities")
            self.assert_one_sentence(name, "Velocities is a vector", status=2)

    def test_other_folders(self):
        (self.here / "empty").mkdir()
        for name in self.commands:
            for folder, words in ((self.here / "none", "no such directory"), (self.here / "empty", "no resolved.nml"), (self.here / "three.js", "no such directory")):
                self.commands[name] = (folder, self.run_) if name == "compare" else (folder,)
                self.assert_one_sentence(name, words, status=2)

    def test_numbers_that_make_no_sense(self):
        sweep = ("sweep", self.run_ / "resolved.nml", "--program", "rti", "--set", "a.b=1", "--output", self.here / "sweep")
        for words in (("plot", self.run_, "--time", "nan"), ("compare", self.run_, self.other, "--time", "inf"), ("view", self.run_, "--megabytes", "inf"),
                      ("view", self.run_, "--megabytes", "nan"), ("movie", self.run_, "--rate", "nan"), ("movie", self.run_, "--pixels", "-5"),
                      (*sweep, "--jobs", "-1"), (*sweep, "--ranks", "0"), ("building", self.here / "a.stl", "--opening", "nan"),
                      ("building", self.here / "a.stl", "--clear", "inf"), ("building", self.here / "a.stl", "--bays", "1000000", "2")):
            with self.subTest(words):
                before = sorted(self.here.rglob("*"))
                said = inside.call(*words)
                self.assertEqual((said.returncode, said.stdout), (2, ""), said.stderr)
                self.assertEqual(len([line for line in said.stderr.splitlines() if "error" in line]), 1, said.stderr)
                self.assertEqual(sorted(self.here.rglob("*")), before)


class Written(Case):
    """What is written takes the place of a link, and never that of what is no file."""

    def setUp(self):
        super().setUp()
        self.run_ = write_series(write_run(self.here / "a", n=4, times=(0, 10)))
        (self.here / "three.js").write_text("")

    def writers(self, folder):
        """Each command that writes one file, and its name."""
        view = ("view", self.run_, "--three", self.here / "three.js", "--output")
        return [((*view, folder / "view.html"), "view.html"), (("movie", self.run_, "--gif", "--pixels", "16", "--output", folder / "m.gif"), "m.gif"),
                (("building", folder / "b.stl"), "b.stl"), (("compare", self.run_, self.run_, "--output", folder), "report.html"),
                (("plot", self.run_, "--fields", "Pressure", "--output", folder), "profile.png")]

    def test_links_are_replaced(self):
        folder, kept = self.here / "out", self.here / "kept"
        folder.mkdir()
        kept.write_text("kept")
        for words, name in self.writers(folder):
            with self.subTest(words[0]):
                (folder / name).symlink_to(kept)
                said = inside.call(*words)
                self.assertEqual(said.returncode, 0, said.stderr)
                self.assertEqual(kept.read_text(), "kept")
                self.assertTrue((folder / name).is_file() and not (folder / name).is_symlink())
                self.assertEqual([path.name for path in folder.glob(".*")], [])
        (self.run_ / "series.pvsm").symlink_to(kept)
        self.assertEqual(inside.call("paraview", self.run_).returncode, 0)
        self.assertEqual(kept.read_text(), "kept")

    def test_what_is_no_file_stays(self):
        folder = self.here / "out"
        folder.mkdir()
        for make in (os.mkdir, os.mkfifo, lambda path: os.symlink("/dev/null", path)):
            for words, name in self.writers(folder)[:4]:
                with self.subTest(words[0]):
                    make(folder / name)
                    self.assert_refused(inside.call(*words), name, "no regular file", status=4)
                    self.assertEqual([path.name for path in folder.iterdir()], [name])
                    (folder / name).rmdir() if (folder / name).is_dir() else (folder / name).unlink()

    def test_where_nothing_can_be_written(self):
        (self.here / "file").write_text("")
        for words, _ in self.writers(self.here / "file"):
            self.assert_refused(inside.call(*words), str(self.here / "file"), status=4)
        for words, _ in self.writers(self.here / "none")[:3]:
            self.assert_refused(inside.call(*words), "No such file", status=4)
        with open("/dev/full", "w") as full:
            said = subprocess.run([sys.executable, "-m", "tetsuame", "building", str(self.here / "b.stl")], stdout=full, stderr=subprocess.PIPE, text=True,
                                  env=os.environ | {"PYTHONPATH": str(SOURCES)})
        self.assertEqual((said.returncode, len(said.stderr.splitlines())), (4, 1), said.stderr)


class Surroundings(Case):
    def test_names_and_letters(self):
        """Blanks, other letters, letters that are none, and what TeX would read; without a screen, a known backend, a locale."""
        folder = self.here / "鉄の 雨 $x_{$ é"
        runs_ = [write_run(folder / f"{k} {'a long name that goes on ' * 5}", n=4, times=(0, 10)) for k in (1, 2)]
        runs_.append(runs_[0].rename(folder / os.fsdecode(b"\xff\xfe")))
        broken = {"MPLBACKEND": "xx", "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "PYTHONPATH": str(SOURCES), "HOME": "/none"}
        surroundings = {name: value for name, value in os.environ.items() if name != "DISPLAY"} | broken
        (self.here / "three.js").write_text("")
        for words in (("plot", runs_[2]), ("view", runs_[1], "--three", self.here / "three.js"), ("compare", *runs_[1:], "--output", folder / "page")):
            said = subprocess.run([sys.executable, "-m", "tetsuame", *map(str, words)], capture_output=True, env=surroundings)
            self.assertEqual(said.returncode, 0, said.stderr.decode(errors="replace"))
            self.assertNotIn(b"Traceback", said.stderr)


class PagesOfTools(Case):
    """bench.json and what balance leaves, with each number in turn missing or something else."""
    MEASUREMENT = {"name": "program_c", "precision": "double", "processor": "P", "version": "v", "dimension": 2, "particles": 100, "threads": 1,
                   "neighbours": 39.5, "updates_per_second": 1e6, "updates_per_second_per_core": 1e6, "pairs_per_second_per_core": 4e7, "ns_per_pair": 14.0,
                   "bytes_per_particle": 500.0, "list_bytes_per_particle": 20.0, "simd_lanes": 8, "steps_per_list": 20, "load_average": 0.0,
                   "stages": {"lists": 1.0}, "speedup_over_scalar": 4.0}
    OPTIONAL = {"precision", "speedup_over_scalar"}

    def assert_damaged(self, command, what):
        before = sorted(self.here.iterdir())
        with self.subTest(command, what=what):
            self.assert_refused(inside.call(command, self.here), str(self.here), status=4)
            self.assertEqual(sorted(self.here.iterdir()), before)

    def test_bench(self):
        path = self.here / "bench.json"
        path.write_text(json.dumps([self.MEASUREMENT]))
        self.assertEqual(inside.call("bench", self.here).returncode, 0)
        for text in ("", "{}", "[]", "[1]", "null", "[" * 100000, "\0"):
            path.write_text(text)
            self.assert_damaged("bench", text[:5])
        for name in self.MEASUREMENT.keys() - self.OPTIONAL:
            for value in (None, [1], float("nan"), "", {"a": "b"}):
                if name in ("name", "processor", "version") and value == "":
                    continue
                path.write_text(json.dumps([self.MEASUREMENT | {name: value}]))
                self.assert_damaged("bench", f"{name}: {value}")
            path.write_text(json.dumps([{key: value for key, value in self.MEASUREMENT.items() if key != name}]))
            self.assert_damaged("bench", f"no {name}")

    def test_balance(self):
        files = {"summary.json": json.dumps({"program": "balance", "counts": [2, 1], "steps": 10, "metrics": {"spread_initial": 0.5}}),
                 "history.csv": "step [1],spread [1],slowest_step [s],gain [s],cost [s],moved [1],migrated_fraction [1]\n0,0.5,1,0,0,0,0\n5,0.1,1,1,0.1,1,0.2\n",
                 "times.csv": "decision,rank,particles,computing [s],communication [s]\n" + "".join(f"{d},{r},10,1,0\n" for d in (0, 1) for r in (0, 1)),
                 "cuts.csv": "decision,axis,group,index,position [m]\n" + "".join(
                     f"{d},0,0,{k},{k}\n" for d in (0, 1) for k in (0, 1, 2)) + "".join(f"{d},1,{g},{k},{k}\n" for d in (0, 1) for g in (0, 1) for k in (0, 1))}
        for name, text in files.items():
            (self.here / name).write_text(text)
        said = inside.call("balance", self.here)
        self.assertEqual(said.returncode, 0, said.stderr)
        for name, text in files.items():
            lines = text.splitlines()
            for what in ("", "\0", "null", text[: len(text) // 2].replace("counts", "count"), "\n".join(lines[1:]), text.replace("1", "nan"), text.replace("1", "word"),
                         "\n".join(lines[:-1]) if len(lines) > 2 else "[]", text.replace("[2, 1]", "[0, 1]"), text.replace("[2, 1]", "{}")):
                if what != text:
                    (self.here / name).write_text(what)
                    self.assert_damaged("balance", f"{name}: {what[:40]}")
            (self.here / name).write_text(text)


class Crashing(Case):
    def test_a_library_that_crashes(self):
        """As the HDF5 library does on some damaged files: the process that reads ends, the one that waits says so. A stand-in for h5py."""
        run = write_run(self.here / "a", n=4, times=(0, 10))
        (self.here / "h5py.py").write_text("import os, signal\ndef File(path, mode):\n    if str(path).endswith('1.h5'): os.kill(os.getpid(), signal.SIGSEGV)\n"
                                           "    import sys; sys.path.remove(os.path.dirname(__file__)); sys.modules.pop('h5py'); import h5py; return h5py.File(path, mode)\n")
        said = subprocess.run([sys.executable, "-m", "tetsuame", "paraview", str(run)], capture_output=True, text=True,
                              env=os.environ | {"PYTHONPATH": f"{self.here}:{SOURCES}"})
        self.assert_refused(said, "snapshot_0001.h5", "crashed on it (SIGSEGV)", status=4)


class Run(Case):
    """./run itself, in a copy of the repository with stand-ins for programs and CMake: what is given begins where it is called."""

    def setUp(self):
        super().setUp()
        self.root, self.caller = self.here / "repository", self.here / "the caller"
        for folder in (self.root / "build/programs", self.root / "output", self.here / "bin", self.caller):
            folder.mkdir(parents=True)
        shutil.copy(REPOSITORY / "run", self.root)
        (self.root / "programs").symlink_to(REPOSITORY / "programs")
        for stamp in ("output/.no-install", "build/build.ninja", "build/.configured"):
            (self.root / stamp).touch()
        for program in ("plan", "submit", "balance", "bench"):
            self.stand_in(self.root / "build/programs" / program, f'echo "{program} in $PWD: $*"')
        self.stand_in(self.here / "bin/cmake", "exit 0")
        self.run_ = write_series(write_run(self.caller / "out/a", n=4, times=(0, 10)))

    def stand_in(self, path, text):
        path.write_text(f"#!/bin/sh\n{text}\n")
        path.chmod(0o755)

    def run_in(self, folder, *words):
        return subprocess.run([self.root / "run", *words], cwd=folder, capture_output=True, text=True,
                              env=os.environ | {"PATH": f"{self.here / 'bin'}:{os.environ['PATH']}", "PYTHON": sys.executable})

    def test_paths_are_the_callers(self):
        for words, made in ((("plot", "out/a", "--fields", "Pressure"), "out/a/plots/profile.png"), (("paraview", "out/a"), "out/a/series.pvsm"),
                            (("building", "b.stl"), "b.stl"), (("movie", "out/a", "--gif", "--pixels", "16", "--output", "m.gif"), "m.gif"),
                            (("compare", "out/a", "out/a", "--output", "page"), "page/report.html")):
            said = self.run_in(self.caller, *words)
            self.assertEqual(said.returncode, 0, said.stderr)
            self.assertTrue((self.caller / made).is_file(), made)
        self.assertEqual([path.name for path in (self.root / "output").iterdir()], [".no-install"])

    def test_what_is_given_no_place_goes_into_the_repository(self):
        said = self.run_in(self.caller, "compare", "out/a", "out/a")
        self.assertEqual((said.returncode, said.stdout), (0, f"Report: {self.root}/output/runs/report.html\n"), said.stderr)
        said = self.run_in(self.root, "compare", "../the caller/out/a", "../the caller/out/a")
        self.assertEqual(said.stdout, "Report: output/runs/report.html\n", said.stderr)

    def test_what_is_installed(self):
        """Where nothing is installed: what the command needs, and no more. Stand-ins for Debian's commands."""
        (self.root / "output/.no-install").unlink()
        self.stand_in(self.here / "bin/dpkg-query", "exit 1")
        self.stand_in(self.here / "bin/id", "echo 0")
        self.stand_in(self.here / "bin/apt-get", f'echo "$*" >> "{self.here}/asked"')
        (self.caller / "three.js").write_text("")
        for words, package, wanted in ((("view", "--help"), "libjs-three", False), (("view", "out/a"), "libjs-three", True),
                                       (("view", "out/a", "--three", "three.js"), "libjs-three", False), (("movie", "--help"), "ffmpeg", False),
                                       (("movie", "out/none"), "ffmpeg", True), (("movie", "out/none", "--gif"), "ffmpeg", False),
                                       (("movie", "out/none", "--output", "a.gif"), "ffmpeg", False), (("plot", "out/none"), "python3-h5py", True)):
            (self.here / "asked").write_text("")
            self.run_in(self.caller, *words)
            with self.subTest(words):
                self.assertEqual(package in (self.here / "asked").read_text(), wanted)

    def test_programs_start_where_it_is_called(self):
        for words, said in ((("plan", "a.nml"), "plan in {}: a.nml"), (("submit", "rti", "a.nml"), "submit in {}: rti a.nml"),
                            (("balance", "a.nml"), "balance in {}: a.nml"), (("bench", "--quick"), "bench in {}: --output {root}/output/bench --quick"),
                            (("bench", "--output", "b"), "bench in {}: --output b")):
            self.assertEqual(self.run_in(self.caller, *words).stdout.partition("\n")[0], said.format(self.caller, root=self.root))


if __name__ == "__main__":
    unittest.main()
