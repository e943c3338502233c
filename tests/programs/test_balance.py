"""balance: the balancer on virtual ranks, on fewer particles than the shipped inputs have."""

import csv
import pathlib
import subprocess
import sys
import unittest

from running import INPUTS, LIMIT_S, ZOLTAN, Case, environment

SOURCES = pathlib.Path(__file__).resolve().parents[2] / "programs/python"
BOWL = INPUTS / "balance_bowl.nml"
FEW = {"distribution.particles": 300000, "compare.methods": "none"}
PARTITIONER = "rcb" if ZOLTAN else "none"


class Runs(Case):
    def balance(self, name="balance_bowl", settings=None, ranks=None, **how):
        options = [] if ranks is None else ["--ranks", str(ranks)]
        return self.run_program("balance", name, settings or {}, options=options, **how)

    def column(self, result, name):
        header, lines = result.rows()
        place = [text.split(" ")[0] for text in header].index(name)
        return [float(line[place]) for line in lines]


class Balance(Runs):
    def test_bowl(self):
        result = self.balance(settings={**FEW, "compare.methods": PARTITIONER})
        found = result.summary["metrics"]
        # The report's start: a spread of 74 % of the slowest rank.
        self.assertAlmostEqual(found["spread_of_maximum_initial"], 0.74, delta=0.03)
        # 620 particles a rank, 250 where it is water: a row of particles is some per cent of a rank's time.
        self.assertLess(min(self.column(result, "spread")[:11]), 0.08)
        self.assertGreater(found["run_time_reduction"], 0.53)
        self.assertAlmostEqual(found["run_time_reduction"],
                               1 - found["run_time_balanced"] / found["run_time_equal_counts"], places=12)
        if ZOLTAN:
            self.assertLess(found["spread_final"], found["rcb_spread_final"] + 0.02)
            self.assertLess(found["migrated_fraction_per_update"], found["rcb_migrated_fraction_per_update"])
        self.assertEqual(found["updates"], sum(self.column(result, "moved")))
        self.assertAlmostEqual(found["migrated_fraction"], sum(self.column(result, "migrated_fraction")), places=9)

    def test_times_and_cuts_are_written(self):
        result = self.balance(settings={**FEW, "distribution.particles": 20000, "schedule.updates": 3}, ranks=12)
        with open(result.directory / "times.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 12 * 4)
        last = [float(r["computing [s]"]) + float(r["communication [s]"]) for r in rows if r["decision"] == "3"]
        spread = (max(last) - min(last)) / (sum(last) / len(last))
        self.assertAlmostEqual(spread, result.summary["metrics"]["spread_final"], places=4)
        self.assertEqual(sum(int(r["particles"]) for r in rows if r["decision"] == "3"),
                         result.summary["fluid_particles"] + result.summary["wall_particles"])
        with open(result.directory / "cuts.csv", newline="") as file:
            cuts = [float(r["position [m]"]) for r in csv.DictReader(file)
                    if (r["decision"], r["axis"], r["group"]) == ("3", "0", "0")]
        self.assertEqual(cuts, sorted(cuts))
        self.assertEqual((cuts[0], cuts[-1]), (0.0, 1.0))

    def test_same_again(self):
        texts = []
        for _ in range(2):
            result = self.balance(settings={**FEW, "distribution.particles": 20000, "machine.noise": 0.02}, ranks=30)
            texts.append((result.directory / "history.csv").read_text())
        self.assertEqual(*texts)

    def test_slow_half(self):
        result = self.balance("balance_slow_half", {"distribution.particles": 200000, "compare.methods": "none"}, ranks=64)
        found = result.summary["metrics"]
        self.assertGreater(found["spread_initial"], 0.09)
        self.assertLess(found["spread_final"], 0.02)

    def test_blobs_are_followed(self):
        result = self.balance("balance_blobs", {"distribution.particles": 200000, "compare.methods": "none"}, ranks=32)
        found = result.summary["metrics"]
        self.assertLess(max(self.column(result, "spread")[8:]), 0.3 * found["spread_initial"])
        self.assertLess(found["run_time_balanced"], found["run_time_equal_counts"])

    def test_method_of_the_report(self):
        result = self.balance(settings={**FEW, "balancer.method": "level_relaxation", "schedule.move": "always",
                                        "schedule.updates": 20})
        self.assertLess(result.summary["metrics"]["spread_final"], 0.1)  # on 484 ranks, a row is some per cent

    def test_three_dimensions(self):
        settings = {**FEW, "distribution.dimension": 3, "distribution.particles": 200000}
        result = self.balance(settings=settings, ranks=27)
        self.assertEqual(result.summary["dimension"], 3)
        self.assertLess(result.summary["metrics"]["spread_final"], 0.05)

    def test_snapshot_of_ours(self):
        made = self.run_program("disph_c", "hydrostatic_column", {"time.steps": 1, "output.interval": 0})
        snapshot = max(made.directory.glob("snapshot_*.h5"))
        found = self.balance(settings={"distribution.kind": "snapshot", "distribution.file": snapshot,
                                       "compare.methods": "none"}, ranks=4).summary
        self.assertEqual(found["fluid_particles"], made.summary["fluid_particles"])
        self.assertEqual(found["wall_particles"], made.summary["wall_particles"])
        self.assertGreater(found["metrics"]["efficiency_predicted"], 0.5)

    def test_page(self):
        result = self.balance(settings={**FEW, "distribution.particles": 20000, "compare.methods": PARTITIONER}, ranks=12)
        done = subprocess.run([sys.executable, "-m", "tetsuame", "balance", str(result.directory)], capture_output=True,
                              text=True, env={**environment(), "PYTHONPATH": str(SOURCES)}, timeout=LIMIT_S)
        self.assertEqual(done.returncode, 0, done.stderr)
        for name in ("cuts.png", "course.png"):
            self.assertEqual((result.directory / name).read_bytes()[1:4], b"PNG")
        self.assertEqual((result.directory / "report.html").read_text(encoding="utf-8").count("data:image/png;base64,iVBOR"), 2)


if __name__ == "__main__":
    unittest.main()
