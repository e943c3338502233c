"""What a run leaves: snapshots, series, tables and summary, read by programs that know nothing of ours."""

import math
import re
import unittest
import xml.etree.ElementTree as ElementTree

import h5py
import numpy as np

from running import CALCULATION_FAILED, Case
from test_ranks import case_of

SUMMARY_FIELDS = {
    "program", "status", "message", "steps", "time", "dimension", "fluid_particles", "wall_particles", "ranks", "threads",
    "wall_seconds", "rhs_evaluations", "particle_updates_per_second", "diverged_step", "diverged_iteration", "errors",
    "conservation", "metrics", "state_hash", "version"}


class Output(Case):
    @classmethod
    def setUpClass(cls):
        """One run of ten steps for all tests here: a shear flow on two ranks, with eleven snapshots."""
        super().setUpClass()
        case = cls()
        cls.case = case
        Case.setUp(case)
        cls.addClassCleanup(case.doCleanups)
        name, settings = case_of("disph_a", **{"time.steps": 10, "output.interval": 0.2, "output.history_interval": 2})
        cls.result = case.run_program("disph_a", name, settings, "out", ranks=2)
        cls.directory = cls.result.directory
        cls.snapshots = sorted(cls.directory.glob("snapshot_*.h5"))

    def runTest(self):  # lets setUpClass have an instance whose assertions it can use
        pass

    # ---- snapshots ----

    def test_names_and_times(self):
        self.assertEqual([p.name for p in self.snapshots], [f"snapshot_{n:04d}.h5" for n in range(11)])
        for n, path in enumerate(self.snapshots):
            with h5py.File(path) as f:
                self.assertAlmostEqual(float(f["Header"].attrs["Time"]), 0.2 * n, delta=1e-9)

    def test_groups_and_shapes(self):
        with h5py.File(self.snapshots[-1]) as f:
            self.assertLessEqual({"Header", "PartType0", "PartType1", "Provenance"}, set(f))
            summary = self.result.summary
            for group, n in (("PartType0", summary["fluid_particles"]), ("PartType1", summary["wall_particles"])):
                part = f[group]
                self.assertLessEqual({"Coordinates", "Velocities", "Masses", "Density", "Pressure", "Temperature", "ParticleIDs",
                                      "SmoothingLength"}, set(part))
                for name, data in part.items():
                    vector = name in ("Coordinates", "Velocities", "Displacement")
                    self.assertEqual(data.shape, (n, 3) if vector else (n,), f"{group}/{name}")
                    self.assertTrue(str(text(data.attrs["description"])), f"{group}/{name}")
                    self.assertTrue(str(text(data.attrs["units"])), f"{group}/{name}")
                    self.assertTrue(np.all(np.isfinite(data[:])), f"{group}/{name}")
                ids = part["ParticleIDs"][:]
                self.assertEqual(ids.dtype.kind in "iu" and len(np.unique(ids)), n)
                self.assertTrue(np.all(part["Coordinates"][:, 2] == 0) and np.all(part["Velocities"][:, 2] == 0))

    def test_header(self):
        with h5py.File(self.snapshots[-1]) as f:
            header, n = f["Header"].attrs, self.result.summary
            self.assertEqual(list(header["NumPart_ThisFile"][:2]), [n["fluid_particles"], n["wall_particles"]])
            self.assertEqual(list(header["NumPart_Total"][:2]), [n["fluid_particles"], n["wall_particles"]])
            self.assertEqual(int(header["NumFilesPerSnapshot"]), 1)
            self.assertGreaterEqual(np.max(header["BoxSize"]), 1e5)

    def test_values(self):
        """Units are SI and say so; what is stored is the state of the case."""
        with h5py.File(self.snapshots[-1]) as f:
            fluid, wall = f["PartType0"], f["PartType1"]
            units = {name: text(fluid[name].attrs["units"]) for name in ("Coordinates", "Velocities", "Density", "Pressure", "Temperature")}
            self.assertEqual(units, {"Coordinates": "m", "Velocities": "m/s", "Density": "kg/m^3", "Pressure": "Pa", "Temperature": "K"})
            x = fluid["Coordinates"][:]
            self.assertTrue(np.all((0 <= x) & (x <= 1e5)))
            y = wall["Coordinates"][:, 1]
            self.assertTrue(np.all((y < 0) | (y > 1e5)))
            self.assertTrue(np.allclose(fluid["Density"][:] * 5e3**2, fluid["Masses"][:], rtol=1e-2))
            self.assertTrue(np.allclose(fluid["SmoothingLength"][:], 1.2 * 5e3))
            self.assertTrue(np.allclose(fluid["Pressure"][:], 1e10, rtol=1e-2))
            # Dragged by the walls: to the right at the top, to the left at the bottom.
            v = fluid["Velocities"][:, 0]
            self.assertGreater(v[x[:, 1] > 95e3].min(), 100)
            self.assertLess(v[x[:, 1] < 5e3].max(), -100)

    def test_provenance(self):
        with h5py.File(self.snapshots[0]) as f:
            kept = {**{k: text(v) for k, v in f["Provenance"].attrs.items()},
                    **{k: text(v[()]) for k, v in f["Provenance"].items()}}
        resolved = (self.directory / "resolved.nml").read_text()
        self.assertIn(resolved.strip(), [str(v).strip() for v in kept.values()])
        self.assertIn("disph_a", kept.values())
        self.assertIn(self.result.summary["version"], kept.values())

    # ---- series.xdmf ----

    def test_series(self):
        root = ElementTree.parse(self.directory / "series.xdmf").getroot()
        steps = [g for g in root.iter("Grid") if g.get("CollectionType") == "Temporal"][0]
        times = [float(t.get("Value")) for t in steps.iter("Time")]
        self.assertTrue(np.allclose(sorted(set(times)), 0.2 * np.arange(11)))
        items = [i for i in root.iter("DataItem") if i.get("Format") == "HDF"]
        self.assertGreater(len(items), 11 * 2 * 5)
        for item in items:
            path, data = item.text.strip().split(":")
            with h5py.File(self.directory / path) as f:
                self.assertEqual(f[data].shape, tuple(map(int, item.get("Dimensions").split())), item.text)
        for topology in root.iter("Topology"):
            if topology.get("TopologyType") == "Polyvertex":
                self.assertIsNotNone(topology.find("DataItem"), "ParaView shows nothing without the connectivity")

    # ---- tables ----

    def table(self, name):
        header, rows = self.result.rows(name)
        for title in header:
            self.assertRegex(title, r"^\w+ \[[^]]+\]$")
        values = np.array(rows, dtype=float)
        self.assertTrue(np.all(np.isfinite(values)))
        return {title.split(" ")[0]: values[:, n] for n, title in enumerate(header)}

    def test_history(self):
        header, _ = self.result.rows()
        self.assertIn("time [s]", header)
        self.assertIn("kinetic_energy [J]", header)
        h = self.table("history.csv")
        self.assertEqual(list(h["step"]), [0, 2, 4, 6, 8, 10])
        self.assertTrue(np.allclose(h["time"], 0.2 * h["step"]))
        self.assertTrue(np.all(np.diff(h["kinetic_energy"]) > 0), "the walls drive the flow")
        errors = self.result.summary["errors"]
        self.assertEqual(h["pressure_error_mean"][-1], errors["pressure_mean"])
        self.assertEqual(h["displacement_max"][-1], errors["displacement_max_over_dx"])

    def test_residuals(self):
        r = self.table("residuals.csv")
        self.assertEqual(set(r["step"]), set(range(11)))
        self.assertEqual(len(r["residual"]), self.result.summary["metrics"]["hosono_passes"])
        for evaluation in set(r["evaluation"]):
            these = r["evaluation"] == evaluation
            self.assertEqual(list(r["iteration"][these]), list(range(1, np.count_nonzero(these) + 1)))
            self.assertLess(r["residual"][these][-1], 1e-10)

    def test_residuals_of_a_divergence(self):
        result = self.run_program("disph_b", "hydrostatic_12", expect=CALCULATION_FAILED)
        header, rows = result.rows("residuals.csv")
        column = header.index("iteration [1]")
        self.assertEqual(int(float(rows[-1][column])), result.summary["diverged_iteration"])
        residual = [float(row[-1]) for row in rows]
        self.assertGreater(max(residual), 1.0)
        self.assertGreaterEqual(len(list(result.directory.glob("snapshot_*.h5"))) + len(list(result.directory.glob("checkpoint_*.h5"))), 1,
                                "the last good state is on disk")

    # ---- summary.json, run.log ----

    def test_summary(self):
        s = self.result.summary
        self.assertLessEqual(SUMMARY_FIELDS, set(s))
        self.assertEqual(set(s["errors"]), {"pressure_mean", "pressure_max", "density_max", "displacement_max_over_dx"})
        self.assertEqual(set(s["conservation"]), {"mass", "momentum", "energy"})
        self.assertEqual((s["program"], s["status"], s["steps"], s["dimension"]), ("disph_a", "completed", 10, 2))
        # 20 x 20, and four rows of walls at the bottom and the top: the support is 3.6 spacings.
        self.assertEqual((s["fluid_particles"], s["wall_particles"]), (400, 160))
        self.assertEqual((s["ranks"], s["threads"]), (2, 1))
        self.assertIsNone(s["diverged_step"])
        self.assertIsNone(s["diverged_iteration"])
        self.assertAlmostEqual(s["time"], 2.0, delta=1e-12)
        self.assertGreaterEqual(s["rhs_evaluations"], 10)
        self.assertGreater(s["particle_updates_per_second"], 0)
        self.assertTrue(math.isfinite(s["wall_seconds"]) and s["wall_seconds"] > 0)
        self.assertRegex(s["state_hash"], r"^[0-9a-f]{16,}$")
        self.assertTrue(s["version"])

    def test_summary_of_a_failure(self):
        s = self.run_program("disph_b", "hydrostatic_12", expect=CALCULATION_FAILED).summary
        self.assertLessEqual(SUMMARY_FIELDS, set(s))
        self.assertEqual((s["status"], s["fluid_particles"], s["dimension"]), ("diverged", 400, 2))

    def test_log(self):
        log = (self.directory / "run.log").read_text()
        self.assertIn("2 ranks", log)
        self.assertIn("completed 10 steps", log)

    def test_progress_without_a_terminal(self):
        """Plain lines, none redrawn."""
        self.assertNotIn("\r", self.result.stderr)
        self.assertNotIn("\x1b", self.result.stderr)
        self.assertRegex(self.result.stderr, r"step 10/10 .* t = .* dt = .* left")
        self.assertTrue(re.search(r"state [0-9a-f]+", self.result.stdout))


def text(value):
    if isinstance(value, np.ndarray):
        value = value.item()
    return value.decode() if isinstance(value, bytes) else value


if __name__ == "__main__":
    unittest.main()
