"""compare conduction: the curves of a half space and a plate, means over rows of particles, its page from states that nobody calculated."""
import argparse
import json
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

import inside  # noqa: F401  (finds the package)
from tetsuame.compare import conduction, study
from tetsuame.compare.outcomes import COMPLETED, Outcome

ROOT = Path(__file__).resolve().parents[2]
INPUT = "&domain\n  length_y = 0.2\n/\n&conduction\n  diffusivity = 1e-6\n  temperature = 11.0\n/\n&walls\n  temperature_top = 1.0\n/\n"


def write_state(path: Path, time: float, x: np.ndarray, T: np.ndarray) -> None:
    with h5py.File(path, "w") as file:
        header = file.create_group("Header").attrs
        header["Time"], header["Step"], header["Dimension"] = time, 1, 2
        header["BoxLengths"], header["Periodic"] = [0.2, 0.2, 0.0], [1, 0, 0]
        fluid = file.create_group("PartType0")
        fluid["ParticleIDs"], fluid["Coordinates"], fluid["Temperature"] = np.arange(len(x)), x, T


class Curves(unittest.TestCase):
    def test_half_space(self):
        """erf(1/2) and erf(1), Abramowitz and Stegun, table 7.1: at depths √(κt) and 2√(κt)."""
        found = conduction.half_space(np.array([0.02, 0.04]), 400.0, 1e-6)
        np.testing.assert_allclose(found, [0.5204998778, 0.8427007929], atol=1e-10)

    def test_plate(self):
        """Against the Fourier sum with all its terms, by images and by the sum; steady in the end; as the half space before it meets the bottom."""
        y = np.linspace(0.001, 0.199, 40)
        n = np.arange(1, 400)[:, None]
        for time in (100.0, 1000.0, 1999.0, 2001.0, 10000.0):
            series = y / 0.2 + (2 / (np.pi * n) * np.exp(-1e-6 * n**2 * np.pi**2 * time / 0.04) * np.sin(n * np.pi * y / 0.2)).sum(axis=0)
            np.testing.assert_allclose(conduction.plate(y, time, 1e-6, 0.2), series, atol=1e-12)
        np.testing.assert_allclose(conduction.plate(y, 1e6, 1e-6, 0.2), y / 0.2, atol=1e-10)
        early = y < 0.1
        np.testing.assert_allclose(conduction.plate(y, 100.0, 1e-6, 0.2)[early], conduction.half_space(y, 100.0, 1e-6)[early], atol=1e-12)


class Page(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.here = Path(scratch.name)

    def outcome(self, run, off: float) -> Outcome:
        """The exact temperatures, warmer by `off` in the fourth row from the top, and off their row's mean by 0.01 to either side."""
        folder = self.here / "runs" / run.folder
        folder.mkdir(parents=True)
        (folder / "resolved.nml").write_text(INPUT)
        n, exact = run.n, conduction.plate if run.file == "plate" else lambda y, t, kappa, _: conduction.half_space(y, t, kappa)
        cells = (np.arange(n) + 0.5) * 0.2 / n
        x = np.array([(a, b) for b in cells for a in cells])
        row = ((0.2 - x[:, 1]) / 0.2 * n).astype(int)
        for k in range(41):
            time = (1e4 if run.file == "plate" else 1e3) * k / 40
            T = np.ones(len(x)) if k == 0 else exact(0.2 - x[:, 1], time, 1e-6, 0.2)
            T = T + off * (row == 3) + 0.01 * (-1.0) ** np.arange(len(x))
            write_state(folder / f"snapshot_{k:04}.h5", time, x, 1.0 + 10.0 * T)
        return Outcome(run, COMPLETED, "", folder, {"version": "0", "wall_seconds": 1.0, "rhs_evaluations": 100}, False)

    def test_page(self):
        comparison = study.Comparison("conduction", ["--output", str(self.here / "page"), "--quick", "--particles", "16"])
        self.assertEqual({(run.file, run.variant) for run in comparison.runs},
                         {(case, variant) for case in conduction.CASES for variant in conduction.VARIANTS})
        comparison.report([self.outcome(run, 0.002) for run in comparison.runs])
        page = (self.here / "page" / "report.html").read_text()
        self.assertEqual(page.count("data:image/png"), 2)
        for one in json.loads((self.here / "page" / "results.json").read_text())["runs"]:
            np.testing.assert_allclose(one["row_errors"], 0.002, atol=1e-12)  # what alternates within a row is none of its mean
            np.testing.assert_allclose(one["particle_errors"], 0.012, atol=1e-12)
            self.assertEqual(one["times"][-1], 1e4 if one["case"] == "plate" else 1e3)

    def test_the_slides_particles(self):
        """Unless asked for others, the finest runs have 2500 particles, and all that is run takes less than five minutes on one core."""
        given = argparse.Namespace(particles=None, quick=False, settings=[])
        runs = conduction.plan(given, ROOT, argparse.ArgumentParser())
        self.assertEqual(max(run.n for run in runs) ** 2, 2500)
        self.assertLess(sum(run.seconds for run in runs), 300)


if __name__ == "__main__":
    unittest.main()
