"""What stands in snapshots: the same fields, units and layout in every program; fewer, smaller and exact in time on request."""

import unittest

import h5py
import numpy as np

from running import BAD_INPUT, Case

try:
    import yt
except ImportError:
    yt = None

try:
    import meshio
except ImportError:
    meshio = None

EVERY = ["Coordinates", "Velocities", "Masses", "Density", "Pressure", "Temperature", "SmoothingLength", "ParticleIDs", "Material"]
SQUARE = {"domain.particles_x": 16, "domain.particles_y": 16}
# Program: input, settings.
RUNS = {
    "disph_a": ("hydrostatic_11", {**SQUARE, "smoothing.normalise": "T", "hosono.solver": "newton"}), "disph_c": ("hydrostatic_13", SQUARE), "disph_f": ("rti_linear", SQUARE),
    "rti": ("rti_linear", SQUARE), "drop": ("drop_cylinder", {"domain.particles_x": 30, "domain.particles_y": 30}),
    "conduction": ("conduction_plate", SQUARE), "convection": ("blankenbach_1a", SQUARE), "shock": ("sod", {"domain.particles_x": 100}),
    "flow": ("still_water", {"domain.particles_x": 10, "domain.particles_y": 12, "flow.high_y": 1.2})}


def units_of(dataset):
    value = dataset.attrs["units"]
    return value.decode() if isinstance(value, bytes) else value


class Snapshots(Case):
    def last(self, program, **settings):
        name, own = RUNS[program]
        run = self.run_program(program, name, {**own, "time.steps": 2, "output.interval": 0, **settings})
        return run, sorted(run.directory.glob("snapshot_*.h5"))[-1]

    def test_contract(self):
        for program in RUNS:
            with self.subTest(program):
                _, path = self.last(program)
                with h5py.File(path) as file:
                    fluid, header = file["PartType0"], file["Header"].attrs
                    for name in EVERY:
                        self.assertIn(name, fluid)
                        self.assertNotEqual(units_of(fluid[name]), "")
                    dimension, lengths = int(header["Dimension"]), header["BoxLengths"][:int(header["Dimension"])]
                    self.assertEqual(units_of(fluid["Masses"]), {1: "kg/m^2", 2: "kg/m", 3: "kg"}[dimension])
                    self.assertEqual(units_of(fluid["Density"]), "kg/m^3")
                    self.assertEqual(fluid["Material"].dtype, np.int32)
                    self.assertEqual(fluid["ParticleIDs"].dtype, np.int64)
                    # Masses and densities are those of the box that the header tells.
                    volume = (fluid["Masses"][:] / fluid["Density"][:]).sum()
                    self.assertLess(abs(volume / np.prod(lengths) - 1), 0.03)
                    spacing = (np.prod(lengths) / len(fluid["Masses"])) ** (1 / dimension)
                    self.assertTrue((fluid["SmoothingLength"][:] > 0.5 * spacing).all())
                    self.assertTrue((fluid["SmoothingLength"][:] < 6.0 * spacing).all())

    def test_material_of_layers(self):
        _, path = self.last("rti")
        with h5py.File(path) as file:
            fluid = file["PartType0"]
            heavy = fluid["Material"][:] == 1
            self.assertEqual(set(fluid["Material"][:]), {0, 1})
            self.assertGreater(fluid["Density"][:][heavy].min(), fluid["Density"][:][~heavy].max())

    def test_fields_are_chosen(self):
        _, path = self.last("disph_c", **{"output.fields": "'Pressure', 'Density'"})
        with h5py.File(path) as file:
            self.assertEqual(set(file["PartType0"]), {"Coordinates", "ParticleIDs", "Pressure", "Density"})

    def test_an_unknown_field(self):
        """Every program names the nearest of those that its snapshots have, before it begins and with --check."""
        for program, (name, own) in RUNS.items():
            with self.subTest(program):
                before = self.listing()
                arguments = self.arguments(name, {**own, "output.fields": "'Desity'"}, self.here / "no")
                for more in ([], ["--check"]):
                    result = self.call(program, *arguments, *more)
                    self.assert_says(result, BAD_INPUT, "&output fields", "'Desity'", "nearest is 'Density'")
                    self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
                self.assertEqual(self.listing(), before)

    def test_the_fields_that_are_told_are_those_that_are_there(self):
        for program, settings in [*((program, {}) for program in RUNS), ("rti", {"rti.temperature_law": "enthalpy", "rti.start": "coloured"}),
                                  ("shock", {"shock.scheme": "gsph"})]:
            with self.subTest(program, settings=settings):
                _, path = self.last(program, **settings)
                name, own = RUNS[program]
                said = self.call(program, *self.arguments(name, {**own, **settings, "output.fields": "'x'"}, self.here / "no"))
                told = said.stderr.partition("there are ")[2].strip().split(", ")
                with h5py.File(path) as file:
                    self.assertEqual(sorted(told), sorted(file["PartType0"]), said)

    def test_fields_in_any_case(self):
        _, path = self.last("disph_c", **{"output.fields": "'density'"})
        with h5py.File(path) as file:
            self.assertEqual(set(file["PartType0"]), {"Coordinates", "ParticleIDs", "Density"})

    def test_precision_and_compression(self):
        more = {"domain.particles_x": 64, "domain.particles_y": 64}
        whole, path = self.last("disph_c", **more)
        small, small_path = self.last("disph_c", **more, **{"output.precision": "single", "output.compress": "T"})
        self.assertEqual(small.summary["state_hash"], whole.summary["state_hash"])
        with h5py.File(path) as a, h5py.File(small_path) as b:
            self.assertEqual(int(b["Header"].attrs["Flag_DoublePrecision"]), 0)
            self.assertEqual(set(a["PartType0"]), set(b["PartType0"]))
            self.assertEqual(a["Provenance"].attrs["Version"], b["Provenance"].attrs["Version"])
            for name, values in a["PartType0"].items():
                other = b["PartType0"][name]
                self.assertEqual(other.compression, "gzip")
                self.assertEqual(units_of(other), units_of(values))
                if name in ("Coordinates", "ParticleIDs", "Material"):
                    np.testing.assert_array_equal(other[:], values[:])
                else:
                    self.assertEqual(other.dtype, np.float32)
                    np.testing.assert_array_equal(other[:], values[:].astype(np.float32))
        self.assertLess(small_path.stat().st_size, 0.8 * path.stat().st_size)
        text = (small.directory / "series.xdmf").read_text(encoding="utf-8")
        self.assertIn('Precision="4"', text)

    def test_times_are_exact_with_fixed_steps(self):
        name, own = RUNS["disph_c"]
        run = self.run_program("disph_c", name, {**own, "time.dt": 0.7, "time.steps": 10, "time.t_end": 5.0, "output.interval": 1.0})
        times = []
        for path in sorted(run.directory.glob("snapshot_*.h5")):
            with h5py.File(path) as file:
                times.append(float(file["Header"].attrs["Time"]))
        self.assertLess(max(abs(np.array(times) - np.arange(6.0))), 1e-9)

    @unittest.skipIf(meshio is None, "Debian's python3-meshio is not installed")
    def test_meshio_reads_the_series(self):
        run, path = self.last("disph_c")
        for series, group in (("series.xdmf", "PartType0"), ("walls.xdmf", "PartType1")):
            with h5py.File(path) as file, meshio.xdmf.TimeSeriesReader(run.directory / series) as reader:
                points, cells = reader.read_points_cells()
                time, values, _ = reader.read_data(reader.num_steps - 1)
                self.assertEqual((reader.num_steps, time), (2, float(file["Header"].attrs["Time"])))
                self.assertEqual((points.shape, [block.type for block in cells]), (file[group]["Coordinates"].shape, ["vertex"]))
                self.assertEqual(set(values), set(file[group]))
                for name, field in values.items():
                    np.testing.assert_array_equal(field, file[group][name][:])

    @unittest.skipIf(yt is None, "Debian's python3-yt is not installed")
    def test_yt_reads_si(self):
        _, path = self.last("rti")
        with h5py.File(path) as file:
            wanted = file["PartType0/Density"][:]
            ids = file["PartType0/ParticleIDs"][:]
        yt.set_log_level("error")
        units = {"length": (1.0, "m"), "mass": (1.0, "kg"), "velocity": (1.0, "m/s")}
        data = yt.load(str(path), unit_base=units).all_data()
        seen = data["PartType0", "Density"].to("kg/m**3")
        order = np.argsort(data["PartType0", "ParticleIDs"])
        np.testing.assert_allclose(np.array(seen)[order], wanted[np.argsort(ids)], rtol=1e-12)
        self.assertGreater(float(seen.min()), 1e3)


if __name__ == "__main__":
    unittest.main()
