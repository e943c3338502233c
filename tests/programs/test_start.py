"""How a run starts: jitter of the lattice, a snapshot in its place, and what cannot be one."""

import shutil
import unittest

import h5py
import numpy as np

from running import BAD_INPUT, FILE_FAILED, Case, outcome

SMALL = {"domain.particles_x": 16, "domain.particles_y": 16, "kernel.name": "wendland_c6", "rti.p_top": 1e10, "rti.amplitude": 4e4,
         "output.interval": 0}


def fluid(path):
    with h5py.File(path) as file:
        return {name: values[...] for name, values in file["PartType0"].items()}


class Jitter(Case):
    def test_every_problem(self):
        """Particles start off the lattice, each by its ID: the same on any ranks, with the masses of the lattice."""
        for program, name, settings in [("disph_c", "hydrostatic_13", {}), ("disph_f", "rti_linear", SMALL), ("rti", "rti_linear", SMALL)]:
            with self.subTest(program + name):
                settings = {**settings, "time.steps": 3, "domain.jitter": 0.1, "output.interval": 0}
                alone = self.run_program(program, name, settings)
                shared = self.run_program(program, name, settings, ranks=3)
                self.assertEqual(outcome(alone.summary), outcome(shared.summary))
                regular = self.run_program(program, name, {**settings, "domain.jitter": 0})
                off, on = (fluid(run.directory / "snapshot_0000.h5") for run in (regular, alone))
                spacing = off["Coordinates"][1, 0] - off["Coordinates"][0, 0]
                moved = abs(on["Coordinates"] - off["Coordinates"]).max() / spacing
                self.assertTrue(0.05 < moved < 0.15, moved)  # a wave carries the jitter along
                self.assertTrue((on["Masses"] == off["Masses"]).all())


class Snapshot(Case):
    def setUp(self):
        super().setUp()
        self.first = self.run_program("disph_c", "rti_linear", {**SMALL, "time.steps": 6}, output="first")
        self.file = self.here / "start.h5"
        shutil.copy(sorted(self.first.directory.glob("snapshot_*.h5"))[-1], self.file)
        self.settings = {**SMALL, "initial.file": f"'{self.file}'"}

    def test_another_scheme_goes_on_from_it(self):
        wanted = fluid(self.file)
        for program in ["disph_f", "rti", "disph_y"]:
            with self.subTest(program):
                settings = {**self.settings, "time.steps": 4, "time.dt": 2.0}
                whole = self.run_program(program, "rti_linear", settings)
                start = fluid(whole.directory / "snapshot_0000.h5")
                for field in ["ParticleIDs", "Coordinates", "Velocities", "Masses", "Material"]:
                    self.assertTrue((start[field] == wanted[field]).all(), field)
                self.assertEqual(outcome(self.run_program(program, "rti_linear", settings, ranks=3).summary), outcome(whole.summary))

    def test_concentrations(self):
        """Of &element: those of the file, else the input's by material; none is lost."""
        element = {"element.name": "constant", "element.concentration_silicate": 2, "element.concentration_metal": 1, "time.steps": 2, "time.dt": 2.0}
        start = self.run_program("rti", "rti_linear", {**self.settings, **element})
        f = fluid(start.directory / "snapshot_0000.h5")
        self.assertTrue((f["Concentration"] == np.where(f["Material"] == 1, 1, 2)).all())
        wanted = 1 + np.arange(len(f["Material"])) % 7
        self.change(lambda file: file["PartType0"].create_dataset("Concentration", data=wanted.astype(float)))
        run = self.run_program("rti", "rti_linear", {**self.settings, **element})
        self.assertTrue((fluid(run.directory / "snapshot_0000.h5")["Concentration"] == wanted).all())
        self.assertLess(abs(run.summary["metrics"]["element_mass_error"]), 1e-10)  # of particles that differ sevenfold from one to the next
        self.change(lambda file: file["PartType0/Concentration"].__setitem__(3, -0.5))
        self.refuse(BAD_INPUT, "&initial file", "particle 3: its Concentration is -0.5, and below 0", **{"element.name": "constant"})

    def test_a_restart_needs_it_no_more(self):
        settings = {**self.settings, "time.dt": 2.0}
        whole = self.run_program("disph_f", "rti_linear", {**settings, "time.steps": 5})
        self.run_program("disph_f", "rti_linear", {**settings, "time.steps": 2}, output="part")
        self.file.unlink()
        again = self.run_program("disph_f", "rti_linear", {**settings, "time.steps": 5}, output="part", options=["--restart", "latest"])
        self.assertEqual(again.summary["state_hash"], whole.summary["state_hash"])

    def test_of_a_box_at_rest(self):
        """Where a run ended another begins: what it evolves, place and speed, goes on as if it had not stopped."""
        half = self.run_program("disph_f", "hydrostatic_13", {"time.steps": 5, "output.interval": 0, "domain.jitter": 0.1}, output="half")
        last = sorted(half.directory.glob("snapshot_*.h5"))[-1]
        on = self.run_program("disph_c", "hydrostatic_13", {"time.steps": 5, "output.interval": 0, "initial.file": f"'{last}'"})
        start = fluid(on.directory / "snapshot_0000.h5")
        for field, values in fluid(last).items():
            if field in ("Coordinates", "Velocities", "Masses", "Density", "Temperature"):
                self.assertTrue((start[field] == values).all(), field)

    def refuse(self, status, *parts, program="disph_f", name="rti_linear", **settings):
        before = self.listing()
        result = self.call(program, *self.arguments(name, {**self.settings, **settings}, self.here / "no"))
        self.assert_says(result, status, *parts)
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        self.assertEqual(self.listing(), before)

    def change(self, work):
        with h5py.File(self.file, "r+") as file:
            work(file)

    def test_what_cannot_be_a_start(self):
        self.refuse(BAD_INPUT, "&initial file", "holds 256 particles", "beside 75000 m of &domain", "particles_x = 16", **{"domain.particles_x": 20, "domain.particles_y": 20})
        self.refuse(BAD_INPUT, "&initial file", "has 2 dimensions, and the box 3", **{"domain.dimension": 3, "domain.particles_z": 16})
        self.refuse(BAD_INPUT, "&initial file", "another box", "1000000 x 1000000 m", **{"domain.length_x": 1e6, "domain.length_y": 1e6, "rti.wavelength": 1e6})
        material = fluid(self.file)["Material"][5]
        self.change(lambda file: file["PartType0/Material"].__setitem__(5, 2))
        self.refuse(BAD_INPUT, "&initial file", "particle 5", "Material is 2: expected 0 or 1")
        self.change(lambda file: file["PartType0/Material"].__setitem__(5, material))
        places = fluid(self.file)["Coordinates"]
        for program in ("disph_f", "rti"):
            self.change(lambda file: file["PartType0/Coordinates"].__setitem__(9, places[100]))
            self.refuse(BAD_INPUT, "particles 9 and 100 lie at the same place", program=program)
        self.change(lambda file: file["PartType0/Coordinates"].__setitem__(9, places[9]))
        self.change(lambda file: file["PartType0/Velocities"].__setitem__((7, 0), float("nan")))
        self.refuse(BAD_INPUT, "&initial file", "particle 7: its Velocities along x are nan")
        self.change(lambda file: file["PartType0/ParticleIDs"].__setitem__(3, 4))
        self.refuse(BAD_INPUT, "&initial file", "same ID, 4")
        self.change(lambda file: file.__delitem__("PartType0/Masses"))
        self.refuse(BAD_INPUT, "&initial file", "has no field Masses")
        self.file.write_text("no HDF5")
        self.refuse(FILE_FAILED, "start.h5")
        self.file.unlink()
        self.refuse(BAD_INPUT, "&initial file", "there is no file")


class OlderNames(Case):
    def test_walls_of_layers(self):
        """floor, lid and sides are still read as what they are now."""
        new, old = (self.run_program("rti", "rti_linear", {**SMALL, "time.steps": 2, **walls}) for walls in
                    ({"walls.slip_bottom": "free_slip", "walls.slip_top": "free_slip", "walls.slip": "free_slip"},
                     {"walls.floor": "free_slip", "walls.lid": "free_slip", "walls.sides": "free_slip"}))
        self.assertEqual(new.summary["state_hash"], old.summary["state_hash"])
        as_given = self.run_program("rti", "rti_linear", {**SMALL, "time.steps": 2})
        self.assertNotEqual(as_given.summary["state_hash"], old.summary["state_hash"])

    def test_no_theory_for_sides_that_differ(self):
        """A cylinder's fall is known between walls that are alike, and not guessed between others."""
        said = self.call("drop", *self.arguments("drop_cylinder", {"walls.slip_left": "free_slip"}, self.here / "no", ["--theory"]))
        self.assertEqual(said.status, 0, said)
        self.assertIn("no theory", said.stdout)
        self.assertNotIn("fall velocity", said.stdout)


if __name__ == "__main__":
    unittest.main()
