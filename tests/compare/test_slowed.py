"""compare slowed_overturn: what it would run, how it judges, its page from outcomes that nobody calculated, and its reference without particles."""
import json
import math
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

import inside  # noqa: F401  (finds the package)
from tetsuame.compare import creeping_overturn, slowed_overturn as slowed, slowed_overturn_runs as runs, study
from tetsuame.compare.outcomes import COMPLETED, Outcome

ROOT = Path(__file__).resolve().parents[2]

# Stands in for plan: the layers of one box, whatever is asked.
TOOL = f"""#!{sys.executable}
import json, sys
said = {{"numbers": {{"growth_1_s": 1e-4, "dynamic_pressure": 4e-4, "inertia_share_lower": 1e-6, "inertia_share_upper": 2e-6}},
        "recommended": {{"zeta": 4.0, "xi": 50.0, "step_sound_as_is_s": 1.0, "step_viscous_as_is_s": 1e-3, "gain": 2000.0}}}}
if "--map" in sys.argv:
    n = int(sys.argv[sys.argv.index("--map") + 1])
    axis = [100 ** (i / (n - 1)) for i in range(n)]
    said["map"] = {{"zeta": axis, "xi": axis, "error": [[1e-4 * (z * z - 1) - 1e-5 * (x * x - 1) for x in axis] for z in axis]}}
open(sys.argv[sys.argv.index("--json") + 1], "w").write(json.dumps(said))
"""


class Slowed(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.here = Path(scratch.name)
        (self.here / "plan").write_text(TOOL)
        (self.here / "plan").chmod(0o755)

    def comparison(self, *arguments):
        return study.Comparison("slowed_overturn", ["--output", str(self.here / "page"), "--binaries", str(self.here), "--jobs", "2", *arguments])

    def test_plan(self):
        whole, quick = self.comparison().runs, self.comparison("--quick").runs
        self.assertLess(sum(run.seconds for run in whole) / 2, 7 * 60)
        self.assertLess(sum(run.seconds for run in quick) / 2, 3 * 60)
        self.assertEqual(len({run.folder for run in whole}), len(whole))
        self.assertEqual({run.file for run in whole} - {run.file for run in quick},
                         {runs.MAP, runs.VISCOSITY, runs.STIFF, runs.POSTER})
        growth = next(run for run in whole if run.variant == "10 km, m = 2")
        for setting in ("domain.length_x=2500.0", "domain.particles_x=12", "rti.wavelength=5000.0", "rti.zeta=4.0", "rti.xi=50.0", "time.t_end=22000.0"):
            self.assertIn(setting, growth.settings)
        with self.assertRaises(SystemExit):
            self.comparison("--particles", "30")

    def test_steps_cut(self):
        """By zeta xi where sound binds, by xi squared where viscosity does."""
        steps = {"recommended": {"step_sound_as_is_s": 1.0, "step_viscous_as_is_s": None}}
        one = {"zeta": 3.0, "xi_lower": 5.0, "xi_upper": 7.0}
        self.assertAlmostEqual(slowed.gain(steps, one), 15, places=6)
        self.assertAlmostEqual(slowed.gain({"recommended": {"step_sound_as_is_s": 1e9, "step_viscous_as_is_s": 1.0}}, one), 25, places=6)
        self.assertIsNone(slowed.gain({}, one))

    def test_the_notes_box_is_its_own_reference(self):
        """An error in proportion to xi squared, 1 % and 4 %: the smaller is found."""
        note = "note's box"
        both = [{"case": runs.OVERTURN, "variant": note + end, "falls": [100 * by, 200 * by, None], "growth_theory": 1.0, "growth_incompressible": 1.0}
                for end, by in (("", 1.01), (", twice ξ", 1.04))]
        found = slowed.fall_errors(both)(both[0])
        self.assertAlmostEqual(found[0], 0.01, places=12)
        self.assertAlmostEqual(found[1], 0.01, places=12)
        self.assertIsNone(found[2])

    def test_page(self):
        comparison = self.comparison()
        outcomes = []
        for run in comparison.runs:
            metrics = {"growth_rate": 1.004e-4, "growth_rate_theory": 1e-4, "growth_rate_slowed": 0.998e-4, "growth_rate_incompressible": 1e-4,
                       "time_of_fall_0.1": 1e4, "time_of_fall_0.2": 2e4, "time_of_fall_0.3": None, "metal_centroid": 0.4, "energy_residual_max": 1e-4,
                       "density_ratio_min": 0.9, "density_ratio_max": 1.1, "particles_lost": 0, "v_rms_max": 1.0}
            summary = {"metrics": metrics, "steps": 100, "rhs_evaluations": 500, "stepping_seconds": 3.0, "version": "0"}
            outcomes.append(Outcome(run, COMPLETED, "", self.here / "page" / "runs" / run.folder, summary, False))
        comparison.report(outcomes)
        page = (self.here / "page" / "report.html").read_text()
        for words in ("What may be slowed where", "Too stiff a liquid locks", "Stiff mantles", "+0.40 %", "Error of the growth rate over"):
            self.assertIn(words, page)
        measured = json.loads((self.here / "page" / "results.json").read_text())
        one = next(one for one in measured["runs"] if one["case"] == runs.GROWTH)
        self.assertAlmostEqual(one["growth_error"], 0.004, places=6)
        self.assertAlmostEqual(one["predicted"], -0.002, places=6)


class Reference(unittest.TestCase):
    def test_growth(self):
        """A wave of the interface grows as two layers that creep do [Turcotte and Schubert, Geodynamics, sect. 6.12], second order in the rows."""
        b, k = 0.5, 2 * math.pi
        q = 1 / (math.sinh(k * b) * math.cosh(k * b))
        exact = b / 4 * (math.tanh(k * b) / (k * b) ** 2 - q) / (1 / (k * b) + q)
        errors = []
        for rows in (24, 48):
            box = creeping_overturn.Box(0.5, rows)
            bump = np.zeros(rows)
            bump[rows // 2 - 1:rows // 2 + 1] = 0.5
            centres = (np.arange(box.columns) + 0.5) * box.dx
            _, v = box.velocity(-np.outer(np.cos(k * centres), bump))
            errors.append(box.at(v, np.array([0.0]), np.array([0.5]))[0] * rows / exact - 1)
        self.assertLess(abs(errors[1]), 0.01)
        self.assertLess(abs(errors[1]), 0.35 * abs(errors[0]))

    def test_overturn(self):
        """It falls, faster once it has grown, and the liquids stay what they are."""
        found = creeping_overturn.overturn(rows=24, fall=0.21)
        self.assertTrue(np.all(np.diff(found.height) < 0))
        self.assertTrue(80 < found.when(0.1) < 125)
        self.assertLess(found.when(0.2) - found.when(0.1), found.when(0.1))


if __name__ == "__main__":
    unittest.main()
