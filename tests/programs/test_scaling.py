"""bench --scaling: runs what was asked, counts the traffic that the geometry asks for, fits what was put in, refuses
what cannot be. Never how fast: that is the machine's."""

import json
import math
import os
import pathlib
import subprocess
import sys
import unittest

from running import BAD_INPUT, CALCULATION_FAILED, COMPLETED, LIMIT_S, MPIEXEC, PROGRAMS, RANKS, Case, environment

SOURCES = pathlib.Path(__file__).resolve().parents[2] / "programs/python"
sys.path.insert(0, str(SOURCES))
from tetsuame.scaling import analysis, model, runner  # noqa: E402  (the path is set first)

LAUNCHER = f"{MPIEXEC} --bind-to none -n {{ranks}}"
SIDE, STEPS = 24, 3


def study(where, *options, **changes):
    """The driver as ./run starts it."""
    command = [sys.executable, "-m", "tetsuame", "scaling", "--binaries", PROGRAMS, "--output", where / "scaling", *options]
    return subprocess.run(list(map(str, command)), env={**environment(), **RANKS, "PYTHONPATH": str(SOURCES), "MPLBACKEND": "Agg", **changes},
                          cwd=where, capture_output=True, text=True, timeout=LIMIT_S)


class Driver(Case):
    @classmethod
    def setUpClass(cls):
        """One study, looked at by all tests."""
        cls.runner = cls("measured")
        cls.runner.setUp()
        cls.addClassCleanup(cls.runner.doCleanups)
        cls.said = study(cls.runner.here, "--launcher", LAUNCHER, "--ranks", "1,2", "--size", SIDE, "--repeats", "2",
                         "--steps", STEPS)
        cls.folder = cls.runner.here / "scaling"
        file = cls.folder / "scaling.json"
        cls.rows = json.loads(file.read_text()) if file.is_file() else []

    def measured(self):
        """Only for setUpClass: a case with a directory."""

    def row(self, kind, ranks, threads):
        return next(r for r in self.rows if (r["kind"], r["ranks"], r["threads"]) == (kind, ranks, threads))

    def test_runs_every_combination_at_both_sizes(self):
        self.assertEqual(self.said.returncode, COMPLETED, self.said.stderr)
        found = {(r["kind"], r["ranks"], r["threads"]): r["particles"] for r in self.rows}
        self.assertEqual(found, {("strong", 1, 1): SIDE ** 2, ("strong", 2, 1): SIDE ** 2,
                                 ("weak", 1, 1): SIDE ** 2, ("weak", 2, 1): 2 * SIDE ** 2})

    @unittest.skipIf(len(os.sched_getaffinity(0)) < 2, "two copies need two cores")
    def test_copies_run_beside_each_other(self):
        """What the machine gives: as many separate runs, each with all the particles; the others are compared with them."""
        folder = self.here / "copies"
        folder.mkdir()
        said = study(folder, "--ranks", "1,2", "--size", SIDE, "--repeats", "1", "--steps", STEPS)
        self.assertEqual(said.returncode, COMPLETED, said.stderr)
        rows = json.loads((folder / "scaling/scaling.json").read_text())
        copies = [r for r in rows if r["kind"] == "copies"]
        self.assertEqual([(r["ranks"], r["threads"], r["particles"]) for r in copies], [(2, 1, 2 * SIDE ** 2)])
        two = next(r for r in rows if (r["kind"], r["ranks"], r["threads"]) == ("strong", 2, 1))
        self.assertAlmostEqual(analysis.of_the_machine(two, rows), two["updates_per_second"] / copies[0]["updates_per_second"])
        self.assertIsNone(analysis.of_the_machine(copies[0], rows))

    def test_threads_alone(self):
        """No ranks to exchange anything: no costs of it, and so no prediction; the base is what there is."""
        with_threads = self.here / "threads"
        with_threads.mkdir()
        said = study(with_threads, "--launcher", LAUNCHER, "--ranks", "1", "--threads", "2", "--size", SIDE, "--repeats", "1",
                     "--steps", STEPS)
        self.assertEqual(said.returncode, COMPLETED, said.stderr)
        rows = json.loads((with_threads / "scaling/scaling.json").read_text())
        self.assertEqual([(r["kind"], r["threads"], r["particles"], r["efficiency"]) for r in rows],
                         [("strong", 2, SIDE ** 2, 1), ("weak", 2, 2 * SIDE ** 2, 1)])
        self.assertEqual((with_threads / "scaling/report.html").read_text().count("<img "), 2)

    def test_numbers_agree_with_each_other(self):
        for r in self.rows:
            with self.subTest(kind=r["kind"], ranks=r["ranks"], threads=r["threads"]):
                self.assertEqual(len(r["updates_per_second_readings"]), 2)
                self.assertEqual(r["steps"], STEPS)
                self.assertLessEqual(r["efficiency_least"], r["efficiency"])
                self.assertLessEqual(r["efficiency"], r["efficiency_largest"])
                base = self.row(r["kind"], 1, 1)
                pairs = [u / (r["ranks"] * r["threads"] * v) for u, v in
                         zip(r["updates_per_second_readings"], base["updates_per_second_readings"])]
                self.assertAlmostEqual(r["efficiency"], sum(pairs) / 2, places=12)  # the median of two
                self.assertTrue(0 <= r["waiting_fraction"] < 1)
                self.assertLessEqual({"gradient", "pressure", "walls", "halo"}, set(r["stages"]))
                self.assertGreater(r["collectives_per_step"], 0)

    def test_traffic_is_that_of_the_geometry(self):
        """Two rows of one cell each: the border between them is shorter than two across the periodic box. Within 3.6 + 0.2
        spacings of it stand 4 rows of SIDE particles, and 4 columns of images at either side; walls are far from it."""
        alone, two = self.row("strong", 1, 1), self.row("strong", 2, 1)
        self.assertEqual((alone["bytes_sent_per_step"], alone["messages_per_step"], alone["fluid_halo_particles"]), (0, 0, 0))
        halo = 4 * (SIDE + 2 * 4)
        self.assertEqual(two["fluid_halo_particles"], halo)
        self.assertEqual(two["wall_halo_particles"], 0)
        self.assertEqual(two["bytes_sent_per_step"], two["bytes_sent_per_step_max"])
        # Of the fluid at least x, y, v, T, rho and p go out, once for each evaluation: as many as steps, and one to start.
        self.assertGreaterEqual(two["bytes_sent_per_step"], 8 * 7 * halo * (STEPS + 1) / STEPS)

    def test_exchange_without_physics(self):
        measured = json.loads((self.folder / "exchange.json").read_text())
        self.assertEqual([e["ranks"] for e in measured], [2])
        for x in measured[0]["exchanges"]:
            self.assertTrue(0 < x["seconds_least"] <= x["seconds"])
        self.assertGreater(measured[0]["collective"]["seconds_least"], 0)

    def test_page_and_nothing_left_behind(self):
        page = (self.folder / "report.html").read_text()
        self.assertEqual(page.count("<img "), 3)
        self.assertIn("parallel fraction over ranks", page)
        self.assertEqual({p.name for p in self.folder.iterdir()}, {"scaling.json", "exchange.json", "report.html"})


class Refusals(Case):
    def refused(self, says, *options, status=BAD_INPUT, **changes):
        said = study(self.here, *options, **changes)
        self.assertEqual(said.returncode, status, said.stderr)
        self.assertIn(says, said.stderr)
        self.assertNotIn("Traceback", said.stderr)
        self.assertFalse((self.here / "scaling" / "scaling.json").exists())

    def test_bad_options(self):
        self.refused("expected whole numbers", "--ranks", "1,two")
        self.refused("expected whole numbers", "--threads", "0")
        self.refused("20 or more", "--size", "3")
        self.refused("unrecognized", "--fast")
        self.refused("names no {ranks}", "--ranks", "1,2", "--launcher", f"{MPIEXEC} -n 2")
        self.refused("only {ranks} and {threads}", "--ranks", "1", "--launcher", f"{MPIEXEC} -n {{ranks}} {{cores}}")
        self.refused("--launcher needs --ranks", "--launcher", LAUNCHER)
        self.refused("more than this machine's", "--ranks", "1000000")

    def test_missing_mpirun_and_programs(self):
        self.refused("mpirun is not on the PATH", PATH="/nonexistent")
        self.refused("no-such-launcher is not on the PATH", "--ranks", "1", "--launcher", "no-such-launcher -n {ranks}")
        self.refused("./run build", "--binaries", self.here)

    def test_launcher_that_starts_the_wrong_number(self):
        self.refused("the run says 1", "--ranks", "2", "--launcher", "env N={ranks}", "--size", SIDE, "--repeats", "1",
                     status=CALCULATION_FAILED)

    def test_run_that_fails(self):
        """Its reason is passed on."""
        broken = self.here / "programs"
        broken.mkdir()
        for name in ("disph_c", "exchange"):
            (broken / name).write_text("#!/bin/sh\necho no memory >&2\nexit 9\n")
            os.chmod(broken / name, 0o755)
        self.refused("no memory", "--ranks", "1", "--launcher", "env N={ranks}", "--binaries", broken, status=CALCULATION_FAILED)


class Numbers(unittest.TestCase):
    def rows(self, p, over):
        return [{"kind": "strong", "ranks": 1, "threads": 1, over: c,
                 "updates_per_second_readings": [u / (1 - p + p / c) for u in (1e6, 2e6, 3e6)]} for c in (1, 2, 8, 64)]

    def test_amdahl_finds_the_fraction_put_in(self):
        for over in ("ranks", "threads"):
            fit, = analysis.amdahl(self.rows(0.9996, over))
            self.assertEqual((fit.over, fit.points), (over, 3))
            for value in (fit.fraction, fit.low, fit.high):
                self.assertAlmostEqual(value, 0.9996, places=12)

    def test_weak_boxes_are_of_squares(self):
        for run in runner.planned([1, 2, 6], [1, 2], 50, None):
            if "weak" in run.kinds:
                self.assertEqual(run.particles, 2500 * run.cores)
                self.assertEqual([n % 50 for n in run.counts], [0, 0])

    def test_plan_keeps_to_the_cores(self):
        self.assertEqual({(r.ranks, r.threads) for r in runner.planned([1, 2, 4], [1, 2], 50, 4)},
                         {(1, 1), (1, 2), (2, 1), (2, 2), (4, 1)})

    def test_halo_is_the_shell_counted_on_a_lattice(self):
        """Particles of a lattice of half-integers within WIDTH of a block of 100 x 100 of them, less the block."""
        side, ranks = 1600, 256
        a, b = 100, 200
        near = sum(1 for i in range(side) if a - model.WIDTH <= i + 0.5 <= b + model.WIDTH)
        halo, neighbours = model.cell(side ** 2, ranks)
        self.assertEqual(neighbours, 8)
        self.assertAlmostEqual(halo / (near ** 2 - 100 ** 2), 1, delta=0.06)  # 2 x 3.8 rows in the model, 8 on this lattice
        self.assertEqual(model.cell(side ** 2, 1), (0, 0))
        # Blocks of one spacing: all that is within 3.8, nine by nine.
        self.assertEqual(model.cell(128 ** 2, 128 ** 2)[1], 80)

    def test_line_through_exact_points(self):
        for latency, slope in ((1e-6, 1e-8), (5e-6, 3e-9)):
            points = [(n, latency + slope * n) for n in (1, 16, 1024, 65536)]
            found = model.line(points)
            self.assertTrue(math.isclose(found[0], latency, rel_tol=1e-9) and math.isclose(found[1], slope, rel_tol=1e-9), found)

    def test_efficiency_without_communication_is_one(self):
        free = model.Costs(1e-7, 0, 0, 9, 0, 8, 72)
        self.assertAlmostEqual(model.efficiency(1e8, 4096, free), 1, places=12)
        # A network can only cost.
        dear = model.Costs(1e-7, 1e-8, 1e-6, 9, 1e-6, 8, 72)
        self.assertLess(model.efficiency(1e8, 4096, dear, model.HDR), model.efficiency(1e8, 4096, dear))
        self.assertEqual(model.efficiency(1e8, 64, dear, model.HDR), model.efficiency(1e8, 64, dear))


if __name__ == "__main__":
    unittest.main()
