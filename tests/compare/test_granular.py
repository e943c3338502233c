"""compare granular: what formulas say of impacts, its runs, its page from summaries that nobody calculated."""
import argparse
import json
import tempfile
import unittest
from pathlib import Path

import inside  # noqa: F401  (finds the package)
from tetsuame.compare import granular, study
from tetsuame.compare.outcomes import COMPLETED, Outcome

ROOT = Path(__file__).resolve().parents[2]


class Page(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.here = Path(scratch.name)

    def outcome(self, run, metrics: dict) -> Outcome:
        folder = self.here / "runs" / run.folder
        folder.mkdir(parents=True)
        return Outcome(run, COMPLETED, "", folder, {"version": "0", "wall_seconds": 1.0, "rhs_evaluations": 100, "metrics": metrics}, False)

    def runs(self, **options):
        given = argparse.Namespace(**{"seeds": 0, "large": False, "quick": False, "settings": [], **options})
        return granular.plan(given, ROOT, argparse.ArgumentParser())

    def test_formulas(self):
        """Chung and Ooi 4 at 50 and 60 degrees; where the sphere sticks for a part of the time there is no formula."""
        said = {}
        for run in self.runs():
            said[run.file, run.variant] = {one.quantity: one.value for one in granular.expected(self.outcome(run, {}))}
        self.assertAlmostEqual(said["test 4", "50 degrees"]["restitution_tangential"], 0.84715, 5)
        self.assertAlmostEqual(said["test 4", "60 degrees"]["spin"], 355.21, 2)
        self.assertEqual(said["test 4", "20 degrees"], {})
        self.assertEqual(said["test 6", "22 1/s"], {"spin_z": 19.0})
        self.assertEqual(said["test 6", "4 1/s"], {})
        self.assertEqual(said["test 3", "e = 0.4"], {"restitution_normal": 0.4})

    def test_page(self):
        """Every run has a folder of its own; the columns' spread is that over the seeds."""
        comparison = study.Comparison("granular", ["--output", str(self.here / "page"), "--quick"])
        self.assertEqual(len({run.folder for run in comparison.runs}), len(comparison.runs))
        outcomes = []
        for n, run in enumerate(comparison.runs):
            metrics = {one.quantity: 1.01 * one.value for one in granular.expected(Outcome(run, COMPLETED, "", self.here, {}, False))}
            if run.file == "column":
                metrics = {"run_out": 0.03 + 0.002 * (n % 2), "repose_angle": 20.0, "particles_lost": 0}
            outcomes.append(self.outcome(run, {"spin_z": 1.0, "restitution_tangential": 0.9, "velocity_x": 1.0, **metrics}))
        comparison.report(outcomes)
        page = (self.here / "page" / "report.html").read_text()
        self.assertEqual(page.count("data:image/png"), 2)
        self.assertIn("31.00 ± 1.00", page)
        self.assertIn("+1.00 %", page)
        for one in json.loads((self.here / "page" / "results.json").read_text())["runs"]:
            for name, value in one["expected"].items():
                self.assertAlmostEqual(one["measured"][name] / value, 1.01, 12)

    def test_time(self):
        """Unless asked for large columns, all that is run takes less than ten minutes on one core."""
        self.assertLess(sum(run.seconds for run in self.runs()), 600)


if __name__ == "__main__":
    unittest.main()
