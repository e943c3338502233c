"""Particles from Python (tetsuame.write_snapshot) as a start of every problem: any number of them, and what is refused."""

import pathlib
import sys
import unittest

import h5py
import numpy as np

from running import BAD_INPUT, Case

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "programs/python"))
import tetsuame  # noqa: E402

L, N = 1.5e6, 20
K = 5e11
RTI = f"""&domain length_x = {L}  length_y = {L}  particles_x = {N}  particles_y = {N} /
&rti  density_upper = 7000  density_lower = 3000  bulk_modulus = {K}  viscosity_upper = 1e11  viscosity_lower = 1e11
  gravity = 10  p_top = 1e10  start = 'coloured'  amplitude = 0 /
&time  t_end = 1e4  steps = 4 /
&output  history_interval = 1 /
"""


def lattice(number, lengths):
    """Cells of so many particles along each axis."""
    axes = [(np.arange(n) + 0.5) * length / n for n, length in zip(number, lengths)]
    return np.stack([a.ravel() for a in np.meshgrid(*axes, indexing="ij")], axis=1)


def metal(x):
    return np.hypot(x[:, 0] - 7.5e5, x[:, 1] - 9e5) < 3e5


def liquids(x, cell):
    """Metal in silicate, of linear equations of state, at the weight of a column of silicate."""
    p = 1e10 + 10 * 3000 * 1.05 * (L - x[:, 1])
    rho = np.where(metal(x), 7000.0, 3000.0) * (1 + p / K)
    return {"densities": rho, "masses": rho * cell, "materials": metal(x).astype(int), "temperatures": 3000.0}


def fluid(run, number=0):
    with h5py.File(run.directory / f"snapshot_{number:04}.h5") as file:
        return {name: values[...] for name, values in file["PartType0"].items()}


class OwnParticles(Case):
    def given(self, text):
        path = self.here / f"input_{len(list(self.here.iterdir()))}.nml"
        path.write_text(text)
        return path

    def start(self, name="start.h5", **particles):
        return {"initial.file": f"'{tetsuame.write_snapshot(self.here / name, **particles)}'"}

    def test_another_number_than_the_lattice(self):
        """23 x 21 particles in the box of a lattice of 20 x 20; on any ranks, over restarts, and without the file then."""
        x = lattice((23, 21), (L, L))
        x += 0.05 * L / N * np.random.default_rng(1).uniform(-1, 1, x.shape)
        of = liquids(x, L * L / len(x))
        settings = self.start(positions=x, box=[L, L], **of)
        given = self.given(RTI)
        run = self.run_program("rti", given, settings)
        f = fluid(run)
        self.assertEqual(run.summary["fluid_particles"], 23 * 21)
        for name, values in {"Coordinates": np.c_[x, 0 * x[:, 0]], "DensityReference": of["densities"], "Masses": of["masses"],
                             "Material": of["materials"]}.items():
            np.testing.assert_allclose(f[name], values, rtol=1e-14, err_msg=name)
        self.assertEqual(run.summary["metrics"]["particles_lost"], 0)
        self.assertLess(abs(run.summary["conservation"]["mass"]), 1e-14)
        self.assert_exact("rti", given, settings, 2, [(3, 1)])
        for program in ("disph_c", "disph_f", "disph_n"):
            self.assertEqual(self.run_program(program, given, settings).summary["fluid_particles"], 23 * 21)
        part = self.run_program("disph_c", given, {**settings, "time.steps": 2}).directory
        (self.here / "start.h5").unlink()
        whole = self.run_program("disph_c", given, settings, part.name, ["--restart", "latest"])
        self.assertEqual(whole.summary["fluid_particles"], 23 * 21)

    def test_units(self):
        """The same particles in km, g/cm^3 and 1e9 kg/m: the same start."""
        x = lattice((N, N), (L, L))
        of = liquids(x, (L / N) ** 2)
        si = self.run_program("rti", self.given(RTI), self.start("si.h5", positions=x, box=[L, L], **of))
        other = {**of, "densities": of["densities"] / 1e3, "masses": of["masses"] / 1e9}
        units = {"positions": "km", "densities": "g/cm^3", "masses": "Gg/km"}
        km = self.run_program("rti", self.given(RTI), self.start("km.h5", positions=x / 1e3, box=[L / 1e3, L / 1e3], units={
            **units, "masses": "1e6 Mg/m"}, **other))
        for name in ("Coordinates", "DensityReference", "Masses", "Temperature"):
            np.testing.assert_allclose(fluid(km)[name], fluid(si)[name], rtol=1e-12, err_msg=name)

    def test_shock(self):
        """A tube's own start, written from Python, gives the same first densities; energies or pressures, 1-D to 3-D."""
        text = ("&domain dimension = 1 length_x = 1 particles_x = 100 /\n&shock scheme = 'ssph' rho_l = 1 p_l = 1 rho_r = 0.125 p_r = 0.1 /\n"
                "&time t_end = 0.05 /\n&output interval = 0 /\n")
        own = self.run_program("shock", self.given(text))
        f = fluid(own)
        x = f["Coordinates"][:, :1]
        with h5py.File(own.directory / "snapshot_0000.h5") as file:
            self.assertEqual(file["Header"].attrs["Dimension"], 1)
        rho = np.where(x[:, 0] < 0.5, 1.0, 0.125)
        p = np.where(x[:, 0] < 0.5, 1.0, 0.1)
        for name, values in {"energies": {"energies": p / 0.4 / rho}, "pressures": {"pressures": p}}.items():
            with self.subTest(name):
                settings = self.start(positions=x, box=1.0, masses=f["Masses"], densities=rho, **values)
                run = self.run_program("shock", self.given(text), settings)
                self.assertIsNone(run.summary["errors"])
                g = fluid(run, 1)
                np.testing.assert_allclose(g["Density"], fluid(own, 1)["Density"], rtol=1e-6)
                self.assertAlmostEqual(run.summary["conservation"]["energy"], own.summary["conservation"]["energy"], delta=1e-7)
        self.assert_exact("shock", self.given(text), {**settings, "time.steps": 6}, 3, [(2, 1)])

    def test_flow(self):
        """A ball of water that turns: places and velocities alone."""
        x = lattice((40, 40), (2.0, 2.0))
        x = x[np.hypot(x[:, 0] - 1, x[:, 1] - 1) < 0.5]
        v = 0.2 * np.c_[-(x[:, 1] - 1), x[:, 0] - 1]
        text = ("&domain length_x = 2 length_y = 2 particles_x = 40 particles_y = 40 /\n&flow gravity = 0 sound_speed = 10 /\n"
                "&time t_end = 0.05 /\n&output history_interval = 5 /\n")
        settings = self.start(positions=x, velocities=v, box=[2.0, 2.0])
        run = self.run_program("flow", self.given(text), settings)
        f = fluid(run)
        self.assertEqual(len(f["Masses"]), len(x))
        np.testing.assert_allclose(f["Velocities"][:, :2], v, rtol=1e-14, atol=1e-14)
        np.testing.assert_allclose(f["Masses"], 1000 * 0.05**2)
        self.assert_exact("flow", self.given(text), {**settings, "time.steps": 6}, 3, [(3, 1)])

    def test_convection_and_conduction(self):
        x = lattice((18, 16), (0.2, 0.2))
        T = 0.5 + 0.1 * np.cos(np.pi * x[:, 0] / 0.2)
        settings = self.start(positions=x, box=[0.2, 0.2], temperatures=T)
        plate = ("&domain length_x = 0.2 length_y = 0.2 particles_x = 16 particles_y = 16 /\n&conduction operator = 'sum' /\n&time steps = 4 t_end = 1e4 /\n"
                 "&output history_interval = 1 /\n")
        run = self.run_program("conduction", self.given(plate), settings)
        np.testing.assert_allclose(fluid(run)["Temperature"], T, rtol=1e-14)
        self.assertAlmostEqual(float(run.rows()[1][0][-1]), T.mean() * 0.04, delta=1e-12)  # K m^2
        self.assert_exact("conduction", self.given(plate), settings, 2, [(3, 1)])
        for name in ("blankenbach_1a",):
            small = {"domain.particles_x": 16, "domain.particles_y": 16, "convection.levels": 0, "time.steps": 4, "output.history_interval": 1}
            y = lattice((17, 17), (1e6, 1e6))
            T = 1000 * (1 - y[:, 1] / 1e6)
            settings = {**small, **self.start("c.h5", positions=y, box=[1e6, 1e6], temperatures=T)}
            np.testing.assert_allclose(fluid(self.run_program("convection", name, settings))["Temperature"], T, atol=1e-9)
            self.assert_exact("convection", name, settings, 2, [(2, 1)])

    def test_what_is_refused(self):
        """With the particle's ID, from 1, and its value; nothing is written."""
        x = lattice((N, N), (L, L))
        cell = (L / N) ** 2
        of = liquids(x, cell)

        def changed(name, row, value):
            values = np.array(np.broadcast_to(of[name], len(x)), dtype=float)
            values[row] = value
            return {**of, name: values}

        alone = x.copy()
        alone[(abs(x[:, 0] - 4e5) < 3.2e5) & (abs(x[:, 1] - 4e5) < 3.2e5)] = 0  # a hole of a fifth of the box …
        hole = (alone != 0).all(axis=1)
        lone = np.r_[x[hole], [[4e5, 4e5]]]  # … and one in it
        twice = np.r_[x, x[metal(x)] + 0.4 * L / N]
        for number, (what, particles, parts) in enumerate([
                ("masses in g", {"positions": x, **{**of, "masses": of["masses"] * 1e3}}, ["particle 1", "volume of", "m^2"]),
                ("lengths in km", {"positions": x / 1e3, **of}, ["particle 1", "another unit"]),
                ("a box in km", {"positions": x, "box": [L / 1e3, L / 1e3], **of}, ["BoxSize", "1500", "1500000"]),
                ("an unknown material", {"positions": x, **changed("materials", 6, 2)}, ["particle 7", "Material is 2"]),
                ("a hot one", {"positions": x, **changed("temperatures", 3, -5.0)}, ["particle 4", "Temperature is -5"]),
                ("no neighbour", {"positions": lone, **liquids(lone, cell)}, ["particle ", "no neighbour within"]),
                ("too few", {"positions": (few := lattice((16, 16), (L, L))), **liquids(few, (L / 16) ** 2)}, ["holds 256 particles", "particles_x = 16"]),
                ("overlap", {"positions": twice, **liquids(twice, cell)}, ["particle ", "they overlap"]),
                ("one material", {"positions": x, **changed("materials", slice(None), 0)}, ["all 400 particles", "material 0"]),
                ("one place", {"positions": np.r_[x[:-1], x[:1]], **of}, [f"particles 1 and {len(x)}", "same place"]),
                ("outside", {"positions": x + 2e5, **of}, ["particle ", "outside the box"])]):
            with self.subTest(what):
                directory = self.here / f"none{number}"
                result = self.call("rti", *self.arguments(self.given(RTI), {**self.start(**{"box": [L, L], **particles}), "kernel.h_over_dx": 1.5}, directory))
                self.assert_says(result, BAD_INPUT, "start.h5", *parts)
                self.assertFalse(directory.exists())

    def test_conventions_of_other_programs(self):
        """SWIFT's plural names are read; its material numbers, and Phantom's dumps, are refused by name."""
        x = lattice((N, N), (L, L))
        settings = self.start(positions=x, box=[L, L], **liquids(x, (L / N) ** 2))
        path = self.here / "start.h5"
        with h5py.File(path, "r+") as file:
            file["PartType0"].move("Density", "Densities")
            file["PartType0"].move("Temperature", "Temperatures")
        run = self.run_program("rti", self.given(RTI), settings)
        np.testing.assert_allclose(fluid(run)["DensityReference"], liquids(x, 1.0)["densities"])
        with h5py.File(path, "r+") as file:
            file["PartType0"].move("Material", "MaterialIDs")
        self.assert_says(self.call("rti", *self.arguments(self.given(RTI), settings, self.here / "none")), BAD_INPUT, "MaterialIDs", "Material, 0 or 1")
        with h5py.File(path, "w") as file:
            file["particles/xyz"] = x
        self.assert_says(self.call("rti", *self.arguments(self.given(RTI), settings, self.here / "none")), BAD_INPUT, "Phantom", "write_snapshot")

    def test_what_python_refuses(self):
        x = lattice((4, 4), (1.0, 1.0))
        for particles, parts in [({"positions": x, "box": [1.0]}, "box is"), ({"positions": x, "box": [1.0, 1.0], "masses": [1.0, 2.0]}, "masses are of shape"),
                                 ({"positions": x, "box": [1.0, 1.0], "densities": np.where(np.arange(16) == 5, np.nan, 1.0)}, "densities: row 5"),
                                 ({"positions": x, "box": [1.0, 1.0], "masses": 0.0}, "masses: row 0"),
                                 ({"positions": x, "box": [1.0, 1.0], "materials": np.full(16, 0.5)}, "materials: row 0"),
                                 ({"positions": x, "box": [1.0, 1.0], "ids": np.zeros(16, int)}, "each once"),
                                 ({"positions": x, "box": [1.0, 1.0], "units": {"mass": "kg"}}, "units of mass")]:
            with self.subTest(parts), self.assertRaises(ValueError) as raised:
                tetsuame.write_snapshot(self.here / "no.h5", **particles)
            self.assertIn(parts, str(raised.exception))
        self.assertFalse((self.here / "no.h5").exists())


if __name__ == "__main__":
    unittest.main()
