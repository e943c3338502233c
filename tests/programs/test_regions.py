"""Starts by &region: what lies where, at the weight of what lies above it; the same on any ranks and over restarts; settled on request."""

import unittest

import h5py
import numpy as np

from running import BAD_INPUT, Case

L, N = 1.5e6, 24
DOMAIN = f"&domain length_x = {L}  length_y = {L}  particles_x = {N}  particles_y = {N} /\n"
RTI = DOMAIN + """&rti  density_upper = 7000  density_lower = 3000  bulk_modulus = 5e11  viscosity_upper = 1e11  viscosity_lower = 1e11
  gravity = 10  p_top = 1e10  start = 'coloured'  amplitude = 0 /
&time  t_end = 1e4  steps = 4 /
&output  history_interval = 1 /
"""
STAR = """&constants  name = 'a', 'x0', 'y0'  value = 4e5, 7.5e5, 9e5 /
&region  material = 'lower' /
&region  name = 'star'  material = 'upper'
  condition = 'hypot(x - x0, y - y0) < a*(1 + 0.4*cos(5*atan2(x - x0, y - y0)))' /
"""


def particles(run, number=0):
    with h5py.File(run.directory / f"snapshot_{number:04}.h5") as file:
        return {name: values[...] for name, values in file["PartType0"].items()}


class Regions(Case):
    def given(self, text):
        path = self.here / f"input_{len(list(self.here.iterdir()))}.nml"
        path.write_text(text)
        return path

    def test_a_star_of_metal(self):
        """Materials by the expression, pressures by the weight of the rows above: dp/dy = -g times the mean density of a row."""
        given = self.given(RTI + STAR)
        run = self.run_program("rti", given)
        f = particles(run)
        x, y = f["Coordinates"][:, 0] - 7.5e5, f["Coordinates"][:, 1] - 9e5
        star = np.hypot(x, y) < 4e5 * (1 + 0.4 * np.cos(5 * np.arctan2(x, y)))
        np.testing.assert_array_equal(f["Material"] > 0, star)
        dx = L / N
        rho = f["Masses"] / dx**2
        rows = np.round(f["Coordinates"][:, 1] / dx - 0.5).astype(int)
        rho0 = np.where(star, 7000.0, 3000.0)
        pressure = 5e11 * (rho / rho0 - 1)
        mean = np.array([rho[rows == r].mean() for r in range(N)])
        weight = 1e10 + 10 * dx * (np.cumsum(mean[::-1])[::-1] - 0.5 * mean)  # of the rows above and half of its own
        np.testing.assert_allclose(pressure, weight[rows], rtol=1e-9)
        self.assertGreater(run.summary["metrics"]["equilibrium_residual"], 0.1)  # the metal's weight beside silicate's
        self.assert_exact("rti", given, {}, 2, [(3, 1)])

    def test_layers_by_regions_are_those_of_the_input(self):
        """The same layers, cut by a box: the same particles, at rest to what the lattice has. The column is integrated there, and summed
        row by row here: pressures differ in the second order of the spacing, 7e-5 of them."""
        by_input = particles(self.run_program("rti", self.given(RTI)))
        cut = "&region material = 'lower' /\n&region shape = 'box' centre_x = 7.5e5 centre_y = 1.125e6 length_x = 2e6 length_y = 7.5e5 material = 'upper' /\n"
        run = self.run_program("rti", self.given(RTI + cut))
        by_region = particles(run)
        np.testing.assert_array_equal(by_region["Material"], by_input["Material"])
        np.testing.assert_allclose(by_region["Masses"], by_input["Masses"], rtol=1e-4)
        self.assertTrue((by_region["Velocities"] == 0).all())

    def test_temperature_velocity_density(self):
        text = RTI.replace("&rti ", "&rti eos_upper = 'liquid_iron' eos_lower = 'liquid_silicate' temperature = 2600 ").replace(
            "density_upper = 7000  density_lower = 3000  bulk_modulus = 5e11", "")
        warm = """&region  material = 'lower' /
&region  material = 'upper'  condition = 'y > 1.4e6' /
&region  name = 'warm'  condition = 'y > 5e5'  temperature = '2600 + 1000*sin(pi*x/length_x)' /
&region  name = 'disc'  shape = 'sphere'  radius = 2e5  centre_x = 7.5e5  centre_y = 7.5e5  velocity_x = '3e-4*(y - 7.5e5)'  velocity_y = -2 /
"""
        f = particles(self.run_program("rti", self.given(text + warm)))
        x, y = f["Coordinates"][:, 0], f["Coordinates"][:, 1]
        np.testing.assert_allclose(f["Temperature"], np.where(y > 5e5, 2600 + 1000 * np.sin(np.pi * x / L), 2600), rtol=1e-12)
        disc = np.hypot(x - 7.5e5, y - 7.5e5) < 2e5
        np.testing.assert_allclose(f["Velocities"][:, 0], np.where(disc, 3e-4 * (y - 7.5e5), 0), atol=1e-9)
        np.testing.assert_allclose(f["Velocities"][:, 1], np.where(disc, -2, 0))
        row = y == y[np.argmin(abs(y - 1.2e6))]
        self.assertTrue((np.diff(f["Masses"][row][np.argsort(f["Temperature"][row])]) <= 1e-9 * f["Masses"].max()).all())  # warmer is lighter
        heavy = "&region  shape = 'sphere'  radius = 2e5  centre_x = 7.5e5  centre_y = 7.5e5  density = 5000 /\n"
        f = particles(self.run_program("rti", self.given(RTI + heavy), {"time.steps": 0}))
        disc = np.hypot(f["Coordinates"][:, 0] - 7.5e5, f["Coordinates"][:, 1] - 7.5e5) < 2e5
        np.testing.assert_allclose(f["Masses"][disc], 5000 * (L / N) ** 2, rtol=1e-12)

    def test_drop_and_programs(self):
        for program, text in [("drop", RTI.replace("&rti", "&drop").replace("_upper", "_drop").replace("_lower", "_outside").replace(
                "start = 'coloured'  amplitude = 0", "radius = 1.5e5")), ("disph_c", RTI)]:
            with self.subTest(program):
                other, metal = ("outside", "drop") if program == "drop" else ("lower", "upper")
                cut = f"&region material = '{other}' /\n&region shape = 'box' angle_z = 45 length_x = 4e5 length_y = 4e5 centre_x = 7.5e5 centre_y = 8e5 material = '{metal}' /\n"
                f = particles(self.run_program(program, self.given(text + cut)))
                x, y = f["Coordinates"][:, 0] - 7.5e5, f["Coordinates"][:, 1] - 8e5
                np.testing.assert_array_equal(f["Material"] > 0, abs(x) + abs(y) < 2e5 * np.sqrt(2))

    def test_shock(self):
        """A bubble in a gas of one pressure; energies; one dimension by a condition."""
        box = "&domain dimension = 2 length_x = 1 length_y = 1 particles_x = 24 particles_y = 24 periodic_x = .true. periodic_y = .true. /\n"
        shock = "&shock test = 'riemann' rho_l = 1 rho_r = 1 p_l = 1 p_r = 1 masses = 'equal_spacing' /\n&time t_end = 1 steps = 3 /\n"
        bubble = "&region shape = 'sphere' radius = 0.2 centre_x = 0.5 centre_y = 0.5 density = 0.25 velocity_x = 0.1 /\n"
        given = self.given(box + shock + bubble)
        run = self.run_program("shock", given)
        f = particles(run)
        inside = np.hypot(f["Coordinates"][:, 0] - 0.5, f["Coordinates"][:, 1] - 0.5) < 0.2
        np.testing.assert_allclose(f["Masses"], np.where(inside, 0.25, 1.0) / 24**2, rtol=1e-12)
        np.testing.assert_allclose(f["InternalEnergy"], np.where(inside, 4.0, 1.0) / 0.4, rtol=1e-12)
        np.testing.assert_allclose(f["Velocities"][:, 0], np.where(inside, 0.1, 0.0))
        self.assertIsNone(run.summary["errors"])
        self.assertLess(abs(run.summary["conservation"]["momentum"]), 1e-12)
        self.assert_exact("shock", given, {}, 2, [(2, 1)])
        tube = "&domain dimension = 1 length_x = 1 particles_x = 50 /\n" + shock
        f = particles(self.run_program("shock", self.given(tube + "&region condition = 'x < 0.3' energy = 5 /\n")))
        np.testing.assert_allclose(f["InternalEnergy"], np.where(f["Coordinates"][:, 0] < 0.3, 5.0, 2.5))
        self.assert_says(self.call("shock", self.given(tube + "&region shape = 'sphere' radius = 0.1 density = 2 /\n"), "--check"), BAD_INPUT,
                         "&region shape", "two or three dimensions")

    def test_flow_convection_conduction(self):
        water = ("&domain length_x = 1 length_y = 1 particles_x = 20 particles_y = 20 /\n&flow high_y = 0.6 /\n&time t_end = 1 steps = 2 /\n"
                 "&region shape = 'sphere' radius = 0.2 centre_x = 0.5 centre_y = 0.3 material = 'none' /\n"
                 "&region condition = 'y < 0.3' velocity_x = '0.1*sin(2*pi*x)' /\n")
        f = particles(self.run_program("flow", self.given(water)))
        x, y = f["Coordinates"][:, 0], f["Coordinates"][:, 1]
        self.assertGreater(np.hypot(x - 0.5, y - 0.3).min(), 0.2)
        self.assertLess(len(x), 20 * 12)
        np.testing.assert_allclose(f["Velocities"][:, 0], np.where(y < 0.3, 0.1 * np.sin(2 * np.pi * x), 0.0), atol=1e-12)
        warm = "&region temperature = '1000*(1 - y/length_y) + 50*cos(pi*x/length_x)' /\n"
        f = particles(self.run_program("convection", "blankenbach_1a", {"domain.particles_x": 16, "domain.particles_y": 16, "time.steps": 1,
                                                                        "convection.levels": 0, "region.temperature": "T+10"}))
        g = particles(self.run_program("convection", "blankenbach_1a", {"domain.particles_x": 16, "domain.particles_y": 16, "time.steps": 1,
                                                                        "convection.levels": 0}))
        np.testing.assert_allclose(f["Temperature"], g["Temperature"] + 10, rtol=1e-12)
        # A box at rest: what is warmer is lighter, at the same pressure; p = K (rho/rho0 - 1) + alpha K (T - T0) + p0 of the linear equation.
        box = ("&domain length_x = 1 length_y = 1 particles_x = 12 particles_y = 12 /\n&initial temperature = 300 pressure = 1e5 /\n&gravity g = 10 /\n"
               "&material eos = 'linear' reference_density = 1e3 reference_temperature = 300 bulk_modulus = 1e9 thermal_expansivity = 1e-4 "
               "heat_capacity = 1e3 /\n&time steps = 0 /\n&region condition = 'y > 0.5' temperature = 'T + 20*x' velocity_x = 'y' /\n")
        run = self.run_program("disph_n", self.given(box))
        f = particles(run)
        x, y = f["Coordinates"].T[:2]
        p = f["PressureReference"]
        np.testing.assert_allclose(f["Temperature"], np.where(y > 0.5, 300 + 20 * x, 300), rtol=1e-12)
        np.testing.assert_allclose(f["Density"], 1e3 * (1 + (p - 1e5 - 1e5 * (f["Temperature"] - 300)) / 1e9), rtol=1e-12)
        np.testing.assert_allclose(f["Masses"], f["Density"] / 144, rtol=1e-12)
        np.testing.assert_allclose(f["Velocities"][:, 0], np.where(y > 0.5, y, 0), rtol=1e-12)
        self.assertFalse(run.summary["errors"])
        plate = "&domain length_x = 0.2 length_y = 0.2 particles_x = 10 particles_y = 10 periodic_x = .true. /\n&conduction /\n&time steps = 1 /\n"
        f = particles(self.run_program("conduction", self.given(plate + warm)))
        x, y = f["Coordinates"][:, 0], f["Coordinates"][:, 1]
        np.testing.assert_allclose(f["Temperature"], 1000 * (1 - y / 0.2) + 50 * np.cos(np.pi * x / 0.2), rtol=1e-12)

    def test_what_is_refused(self):
        for more, settings, parts in [
                ("&region shape = 'sphere' radius = 200 centre_x = 750 centre_y = 900 material = 'upper' /\n", {},
                 ["&region 'region 1'", "no particle of the start lies in it"]),  # km
                ("&region material = 'lower' /\n", {}, ["&region", "all 576 particles", "material 0"]),
                ("&region material = 'iron' /\n", {}, ["&region material", "'lower'", "'upper'"]),
                ("&region temperature = '1e3*(y - 1e6)' /\n", {}, ["&region 'region 1'", "temperature is", "not above 0"]),
                ("&region energy = 5 /\n", {}, ["unknown key energy"]),
                ("&region density = 5 pressure = 1e10 /\n", {}, ["&region density", "pressure"]),
                (STAR, {"rti.start": "eigenmode"}, ["&rti start", "'coloured'"]),
                (STAR, {"rti.masses": "equal_mass"}, ["&rti masses"]),
                (STAR + "&region velocity_x = 1 /\n", {"initial.settle": 1}, ["&expert settle", "the start moves"])]:
            with self.subTest(more=more, **settings):
                result = self.call("rti", *self.arguments(self.given(RTI + more), settings, self.here / "none"))
                self.assert_says(result, BAD_INPUT, *parts)
                self.assertFalse((self.here / "none").exists())


class Settled(Case):
    """A disturbed start comes nearer to balance: its largest acceleration, in units of gravity, before and after."""

    def residual(self, program, name, settings):
        run = self.run_program(program, name, {**settings, "time.steps": 0})
        log = (run.directory / "run.log").read_text()
        self.assertIn("largest acceleration of the start", log)
        return run, run.summary["metrics"]["equilibrium_residual"]

    def test_a_column(self):
        settings = {"domain.jitter": 0.2, "domain.particles_x": 16, "domain.particles_y": 16, "output.interval": 0}
        before, first = self.residual("disph_n", "hydrostatic_column", settings)
        after, last = self.residual("disph_n", "hydrostatic_column", {**settings, "initial.settle": 4})
        self.assertLess(last, 0.1 * first)
        f, g = particles(before), particles(after)
        self.assertTrue((g["Velocities"] == 0).all())
        np.testing.assert_array_equal(f["Masses"], g["Masses"])
        np.testing.assert_array_equal(f["Temperature"], g["Temperature"])
        self.assertEqual(abs(g["Displacement"]).max(), 0.0)  # counted from where it came to rest
        self.assertIn("settled", (after.directory / "run.log").read_text())

    def test_ranks_and_restarts(self):
        settings = {"domain.jitter": 0.2, "domain.particles_x": 16, "domain.particles_y": 16, "output.interval": 0, "initial.settle": 0.5,
                    "time.steps": 4, "output.history_interval": 1}
        self.assert_exact("disph_c", "hydrostatic_13", settings, 2, [(3, 1)])


if __name__ == "__main__":
    unittest.main()
