"""bench: what it writes has the promised form, is plausible, and makes a page. Never how fast: that is the machine's."""

import json
import math
import pathlib
import subprocess
import sys
import unittest

from running import BAD_INPUT, COMPLETED, LIMIT_S, Case, environment

SOURCES = pathlib.Path(__file__).resolve().parents[2] / "programs/python"
SMALL = ["--particles", "900", "--seconds", "0.01", "--output", "bench"]
POSITIVE = ["particles", "threads", "neighbours", "list_entries", "passes", "updates_per_second",
            "updates_per_second_per_core", "pairs_per_second", "pairs_per_second_per_core", "ns_per_pair",
            "bytes_per_particle", "list_bytes_per_particle", "list_seconds", "steps_per_list", "simd_lanes"]
STAGES = {"lists", "halo", "walls", "volume", "pressure", "gradient", "rates", "integration", "rest"}
SCHEMES = ("ssph", "disph", "gsph", "gdisph", "remix")
GAS_STAGES = {"lists", "halo", "densities", "corrections", "gradients", "forces", "rates", "integration", "rest"}


class Bench(Case):
    @classmethod
    def setUpClass(cls):
        """One run of everything at its smallest, looked at by all tests."""
        cls.runner = cls("measured")
        cls.runner.setUp()
        cls.addClassCleanup(cls.runner.doCleanups)
        cls.said = cls.runner.call("bench", *SMALL, "--threads", "1,2", threads=2)
        file = cls.runner.here / "bench" / "bench.json"
        cls.results = json.loads(file.read_text()) if file.is_file() else []

    def measured(self):
        """Only for setUpClass: a case with a directory."""

    def test_every_case_dimension_and_number_of_threads(self):
        self.assertEqual(self.said.status, COMPLETED, self.said)
        found = [(r["name"], r["dimension"], r["threads"]) for r in self.results]
        wanted = [(name, dimension, threads) for dimension in (2, 3)
                  for name in ("program_c", "program_f", "number_density", "transport", *SCHEMES) for threads in (1, 2)]
        self.assertEqual(found, wanted)

    def test_numbers_are_there_and_agree_with_each_other(self):
        self.assertTrue(self.results, self.said)
        for r in self.results:
            with self.subTest(name=r["name"], dimension=r["dimension"], threads=r["threads"]):
                for key in POSITIVE:
                    self.assertGreater(r[key], 0, key)
                    self.assertTrue(math.isfinite(r[key]), key)
                for key in ("processor", "version"):
                    self.assertTrue(r[key], key)
                self.assertGreaterEqual(r["load_average"], 0)
                self.assertAlmostEqual(r["updates_per_second"], r["threads"] * r["updates_per_second_per_core"],
                                       delta=1e-9 * r["updates_per_second"])
                self.assertAlmostEqual(r["pairs_per_second"] / r["updates_per_second"] / r["neighbours"], 1, delta=1e-9)
                self.assertAlmostEqual(r["ns_per_pair"] * r["pairs_per_second"] / r["threads"] / 1e9, 1, delta=1e-9)

    def test_stages_are_shares_of_the_whole(self):
        self.assertTrue(self.results, self.said)
        for r in self.results:
            gas = r["name"] in SCHEMES
            self.assertLessEqual(set(r["stages"]), GAS_STAGES if gas else STAGES)
            self.assertLessEqual({"densities", "forces"} if gas else {"walls", "gradient"}, set(r["stages"]))
            self.assertLessEqual({"lists", "integration"}, set(r["stages"]))
            self.assertAlmostEqual(sum(r["stages"].values()), 1, delta=1e-9)
            self.assertGreaterEqual(min(r["stages"].values()), 0)

    def test_neighbours_are_those_of_the_lattice(self):
        """Points of a lattice within 3.6 spacings: 36 in the plane and 178 in space without those at 3.606, up to
        44 and 202 with them (the jitter decides), itself not counted; the list holds the skin's too."""
        self.assertTrue(self.results, self.said)
        for r in self.results:
            low, high = (36, 44) if r["dimension"] == 2 else (178, 202)
            self.assertGreaterEqual(r["neighbours"], low)
            self.assertLessEqual(r["neighbours"], high)
            self.assertGreater(r["list_entries"], r["neighbours"])
            # Where each row starts, and eight bytes for a run of up to 32 neighbours.
            self.assertGreaterEqual(r["list_bytes_per_particle"], 8 + 8 * r["list_entries"] / 32)
            self.assertLessEqual(r["list_bytes_per_particle"], 8 + 8.5 * r["list_entries"])

    def test_compared_with_the_scalar_loop(self):
        compared = [r for r in self.results if r["name"] == "program_c"]
        self.assertEqual(len(compared), 4, self.said)
        for r in compared:
            self.assertGreater(r["speedup_over_scalar"], 0)
            self.assertGreater(r["scalar_ns_per_pair"], 0)
            # Summed in another order, so not the same bits in every field; nor more than round-off apart.
            self.assertGreater(r["deviation_from_scalar"], 0)
            self.assertLess(r["deviation_from_scalar"], 1e-11)

    def test_page(self):
        self.assertTrue(self.results, self.said)
        folder = self.runner.here / "bench"
        done = subprocess.run([sys.executable, "-m", "tetsuame", "bench", str(folder)], capture_output=True, text=True,
                              env={**environment(), "PYTHONPATH": str(SOURCES)}, timeout=LIMIT_S)
        self.assertEqual(done.returncode, COMPLETED, done.stderr)
        page = (folder / "report.html").read_text(encoding="utf-8")
        self.assertIn(self.results[0]["processor"], page)
        self.assertGreaterEqual(page.count("data:image/png;base64,"), 4)
        self.assertNotRegex(page, r"(src|href)=\"(?!data:)")  # opens offline, wherever it is


class Refused(Case):
    def test_mistakes_on_the_command_line(self):
        for arguments, says in [(["--cases", "program_z"], "program_z"), (["--threads", "0"], "--threads"),
                                (["--dimensions", "4"], "--dimensions"), (["--seconds", "no"], "--seconds")]:
            with self.subTest(arguments=arguments):
                self.assert_says(self.call("bench", *arguments), BAD_INPUT, "bench", says)
        self.assertEqual(self.listing(), {})

    def test_two_ranks(self):
        self.assert_says(self.call("bench", *SMALL, ranks=2), BAD_INPUT, "mpirun")

    def test_page_without_measurements(self):
        done = subprocess.run([sys.executable, "-m", "tetsuame", "bench", str(self.here)], capture_output=True, text=True,
                              env={**environment(), "PYTHONPATH": str(SOURCES)}, timeout=LIMIT_S)
        self.assertEqual(done.returncode, BAD_INPUT, done.stderr)
        self.assertIn("bench.json", done.stderr)
