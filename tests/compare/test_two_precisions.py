"""compare precision: the plan, the judgement of a figure, and a page from programs that only pretend to calculate."""
import json
import os
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import inside
from tetsuame.compare import precision, study
from tetsuame.compare.outcomes import COMPLETED, STOPPED, Outcome
from test_compare import Balance

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]


def plan(*words):
    parser = study.options("precision", precision)
    return precision.plan(parser.parse_args(words), ROOT, parser)


class Plan(unittest.TestCase):
    def test_each_problem_in_both_precisions(self):
        for words in ((), ("--quick",)):
            runs = plan(*words)
            self.assertEqual(len({one.folder for one in runs}), len(runs))
            single = [one for one in runs if one.kind == precision.SINGLE]
            for one in single:
                twins = [other for other in runs if (other.kind, other.problem) == (precision.DOUBLE, one.problem)]
                self.assertEqual(len(twins), 1, one.label)
                self.assertEqual(twins[0].settings[:-1], one.settings[:-1])
                self.assertEqual((twins[0].settings[-1], one.settings[-1]), ("kernel.precision=double", "kernel.precision=single"))
                coarse = [other for other in runs if (other.kind, other.problem) == (precision.COARSE, one.problem)]
                self.assertTrue(all(other.n < one.n for other in coarse), one.label)
            self.assertLessEqual({one.binary for one in runs}, set(precision.PROGRAMS))
        self.assertEqual({one.binary for one in plan()}, set(precision.PROGRAMS))

    def test_of_one_program(self):
        self.assertEqual({one.binary for one in plan("--of", "drop,conduction")}, {"drop", "conduction"})


class Judgement(unittest.TestCase):
    """A figure of 'growth', of which rti tells the theory, and of an overturn, of which it does not."""
    def outcomes(self, file, metrics, kinds=(COMPLETED, COMPLETED)):
        """metrics: of the runs in double, in single, and of the coarse one."""
        part = next(part for part in precision.PARTS if part.speaks_for == "rti")
        made = []
        for kind, outcome, values in zip((precision.DOUBLE, precision.SINGLE, precision.COARSE), (*kinds, COMPLETED), metrics):
            run = precision.Half("rti", Path("rti.nml"), file, "rti", f"{kind}/{file}", "rti", (), 24 if kind == precision.COARSE else 48,
                                 part=part, kind=kind)
            summary = {"status": "completed" if outcome == COMPLETED else "diverged", "steps": 5, "stepping_seconds": 1.0,
                       "diverged_step": None if outcome == COMPLETED else 5, "metrics": values}
            made.append(Outcome(run, outcome, "", Path("nowhere"), summary, False))
        return made

    def row(self, *arguments, **options):
        made = self.outcomes(*arguments, **options)
        rows = [precision.row(one, made) for one in made]
        self.assertEqual([one is None for one in rows], [one.case.kind != precision.SINGLE for one in made])
        return next(filter(None, rows))

    def growth(self, double, single):
        one = self.row("growth", [{"growth_rate": rate, "growth_rate_theory": 1.0} for rate in (double, single, 0.5)])
        found, = one["figures"]
        return found, precision.bears(one)

    def test_against_theory(self):
        found, bears = self.growth(1.01, 1.0105)
        self.assertEqual((found["against"], found["enough"], bears), ("known", True, True))
        self.assertAlmostEqual(found["ratio"], 20.0)
        self.assertEqual(self.growth(1.01, 1.012)[1], False)  # an error five times the change
        self.assertEqual((self.growth(1.01, 1.01)[0]["ratio"], self.growth(1.01, 1.01)[1]), (None, True))
        self.assertEqual(self.growth(1.0, 1.0 + 1e-12)[1], False)  # exact in double: any change is too large

    def test_against_fewer_particles(self):
        values = [{"metal_centroid": centroid, "energy_residual": residual} for centroid, residual in ((0.3, 1e-5), (0.3001, 1.05e-5), (0.31, 9e-5))]
        centroid, energy = self.row("overturn", values)["figures"]
        self.assertEqual((centroid["figure"], centroid["against"], centroid["enough"]), ("metal_centroid", "n = 24", True))
        self.assertAlmostEqual(centroid["ratio"], 100.0)
        # Of what is kept the demand is one of its own, whatever the residual in double.
        self.assertEqual((energy["kept"], energy["enough"]), (True, True))
        values[1]["energy_residual"] = 1.2e-5
        self.assertFalse(self.row("overturn", values)["figures"][1]["enough"])

    def test_a_run_that_ends_otherwise(self):
        values = [{"metal_centroid": 0.3}] * 3
        one = self.row("overturn", values, kinds=(COMPLETED, STOPPED))
        self.assertEqual((one["figures"], one["ends"], precision.bears(one)), ([], ["completed", "diverged, step 5"], False))
        self.assertEqual(precision.counts([one]), (0, 1))
        self.assertTrue(precision.bears(self.row("overturn", values, kinds=(STOPPED, STOPPED))))


class Page(unittest.TestCase):
    def test_page(self):
        with tempfile.TemporaryDirectory() as scratch:
            output, binaries = Path(scratch) / "compare", Path(scratch) / "programs"
            binaries.mkdir()
            (binaries / "rti").write_bytes((HERE / "fake_study.py").read_bytes())
            (binaries / "rti").chmod(0o755)
            with mock.patch.dict(os.environ, {"FAKE_FAIL": "", "PYTHONPATH": str(ROOT / "programs/python")}):
                done = inside.call("compare", "precision", "--of", "rti", "--quick", "--binaries", binaries, "--output", output)
            self.assertEqual(done.returncode, 0, done.stderr)
            runs = {one["case"]: one for one in json.loads((output / "results.json").read_text())["runs"]}
            self.assertEqual(set(runs), {"growth", "overturn", "pond_on_mantle"})
            growth, = runs["growth"]["figures"]
            self.assertAlmostEqual(growth["change"] / growth["double"], 1e-6, delta=1e-9)
            self.assertAlmostEqual(growth["ratio"], 24**-2 / (1 + 24**-2) / 1e-6, delta=10)
            page = (output / "report.html").read_text()
            balance = Balance()
            balance.feed(page)
            self.assertEqual((balance.open, balance.wrong), ([], []))
            self.assertEqual(page.count("data:image/png;base64,iVBOR"), 1)
            self.assertIn("metal centroid", page)
            self.assertRegex(done.stdout, r"(?m)^rti +\d+ of \d+ ")

    def test_usage(self):
        done = inside.call("compare", "precision", "--of", "gas", "--output", Path("nowhere"))
        self.assertEqual(done.returncode, 2)
        self.assertIn("no 'gas' (there are", done.stderr)


if __name__ == "__main__":
    unittest.main()
