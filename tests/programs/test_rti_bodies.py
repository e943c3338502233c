"""Bodies that stand still between metal and silicate: rest, symmetry, ranks and restarts, heat and elements, what is refused."""

import math
import unittest

import h5py
import numpy

from running import BAD_INPUT, SLOW, Case

BOX = """&domain length_x = 1.5e6 length_y = 1.5e6 particles_x = {n} particles_y = {n} /
&rti density_upper = {metal} density_lower = 3000.0 bulk_modulus = 5e11 viscosity_upper = 6e11 viscosity_lower = 6e11
  gravity = 10.0 p_top = 1e5 start = 'coloured' interface = 1.125e6 amplitude = {amplitude} {more} /
&walls slip = 'no_slip' slip_bottom = 'no_slip' slip_top = 'no_slip' /
&time t_end = {t} /
&output interval = 0 /
"""
BALL = "&solids body = 'ball' shape = 'sphere' centre_x = 7.5e5 centre_y = 6.25e5 radius = 2e5 /\n"
# A ball and a bar at 30 degrees to the lattice.
TWO = """&solids body = 'ball', 'bar' shape = 'sphere', 'box' centre_x = 3.75e5, 1.05e6 centre_y = 6.25e5, 7e5
  radius(1) = 1.5e5 length_x(2) = 3.5e5 length_y(2) = 3e5 angle_z(2) = 30 /
"""


class BodiesInTwoFluids(Case):
    def input(self, name, solids, **parts):
        path = self.here / f"{name}.nml"
        path.write_text(solids + BOX.format(**{"n": 40, "metal": 7000.0, "amplitude": 6e4, "more": "", "t": 300.0, **parts}))
        return path

    def last_snapshot(self, result):
        with h5py.File(sorted(result.directory.glob("snapshot_*.h5"))[-1]) as file:
            return {name: values[:] for name, values in file["PartType0"].items()}

    @unittest.skipUnless(SLOW, "slow")
    def test_rest(self):
        """One liquid at rest stays so about bodies. The weight carried from a marker to its wall particle takes the liquid for
        incompressible, and so is off by (rho g d)^2/(2 K) over d of up to two kernel supports, 5e-4 of rho g L here; the lattice
        that settles on it has errors of its own of 2e-4 without bodies. Speeds are those of the sound that this makes: 1e-5 c."""
        for volume in ("number_density", "our_method"):
            for pressure in ("non_smoothed", "smoothed"):
                with self.subTest(volume=volume, pressure=pressure):
                    path = self.input("rest", TWO, metal=3000.0, amplitude=0.0, t=3000.0, more=f"volume = '{volume}' pressure = '{pressure}'")
                    result = self.run_program("rti", path)
                    m = result.summary["metrics"]
                    self.assertEqual((m["particles_put_back"], m["particles_lost"]), (0, 0))
                    self.assertLess(m["v_rms_max"], 1e-5 * math.sqrt(5e11 / 3000.0))
                    p = self.last_snapshot(result)
                    # dp/dy = -rho g with rho = rho0 (1 + p/K)
                    column = 5e11 * numpy.expm1(3000.0 * 10.0 * (1.5e6 - p["Coordinates"][:, 1]) / 5e11)
                    self.assertLess(numpy.abs(p["Pressure"] - column).max(), 1.5e-3 * 3000.0 * 10.0 * 1.5e6)

    def test_mirror_symmetry(self):
        """About a cylinder in the middle each particle stays the mirror image of another: to rounding, that grows with the flow."""
        result = self.run_program("rti", self.input("symmetric", BALL, t=600.0), {"kernel.precision": "double"})
        p = self.last_snapshot(result)
        x, y = p["Coordinates"][:, 0], p["Coordinates"][:, 1]
        partner = p["ParticleIDs"] // 40 * 40 + 39 - p["ParticleIDs"] % 40
        row = {number: i for i, number in enumerate(p["ParticleIDs"])}
        other = numpy.array([row[number] for number in partner])
        self.assertGreater(numpy.abs(p["Velocities"]).max(), 50.0)
        self.assertLess(numpy.abs(x + x[other] - 1.5e6).max(), 1e-9 * 1.5e6)
        self.assertLess(numpy.abs(y - y[other]).max(), 1e-9 * 1.5e6)

    def test_flows_round(self):
        """The metal is deflected: later than without a body it arrives below, none of it having been in the body."""
        fallen = {}
        for name, solids in (("round", BALL), ("free", "")):
            result = self.run_program("rti", self.input(name, solids, t=2500.0))
            fallen[name] = result.summary["metrics"]["metal_centroid"]
            x = self.last_snapshot(result)["Coordinates"]
            self.assertEqual(result.summary["metrics"]["particles_lost"], 0)
            if solids:
                # A particle that presses with g on the spring of (c/4 dx)^2 is in it by 0.03 spacings.
                self.assertGreater(numpy.hypot(x[:, 0] - 7.5e5, x[:, 1] - 6.25e5).min(), 2e5 - 0.1 * 1.5e6 / 40)
                self.assertEqual(result.summary["metrics"]["particles_put_back"], 0)
        self.assertGreater(fallen["round"], fallen["free"] + 0.02)

    def test_ranks_restart(self):
        """The same bits on other ranks and after a restart, whatever stands in bodies; with pairs in either precision."""
        for name, more, settings in (
            ("plain", "", {}),
            ("carried", "volume = 'our_method' pressure = 'smoothed' temperature_law = 'adiabatic' conductivity = 1e13", {"kernel.precision": "double"}),
            ("dissolved", "", {"element.name": "nickel"}),
        ):
            with self.subTest(name):
                path = self.input(name, TWO, t=1e9, more=more)
                self.assert_exact("rti", path, {**settings, "time.steps": 40}, 17, [(2, 1), (3, 1)])

    def test_adiabatic_and_closed(self):
        """No heat and nothing dissolved goes into bodies: the energy and the element of the fluid stay."""
        path = self.input("element", BALL, t=600.0)
        m = self.run_program("rti", path, {"element.name": "nickel", "kernel.precision": "double"}).summary["metrics"]
        self.assertLess(abs(m["element_mass_error"]), 1e-12)
        path = self.input("heat", BALL, t=600.0, more="temperature_law = 'enthalpy' temperature_upper = 4000 conductivity = 1e13")
        self.assertLess(abs(self.run_program("rti", path, {"kernel.precision": "double"}).summary["metrics"]["heat_residual"]), 1e-12)

    def test_drop(self):
        """A drop that sinks towards a bar is held up by it."""
        text = """&domain length_x = 1.5e6 length_y = 1.5e6 particles_x = 40 particles_y = 40 /
&drop x = 7.5e5 y = 1.1e6 radius = 1.5e5 viscosity_outside = 6e11 viscosity_drop = 6e11 /
&walls slip = 'free_slip' /
&time t_end = 600 /
&output interval = 0 /
"""
        bar = "&solids body = 'bar' shape = 'box' centre_x = 7.5e5 centre_y = 4e5 length_x = 6e5 length_y = 3e5 /\n"
        height = []
        for name, solids in (("free", ""), ("held", bar)):
            path = self.here / f"{name}.nml"
            path.write_text(solids + text)
            height.append(self.run_program("drop", path).summary["metrics"]["metal_centroid"])
        self.assertGreater(height[1], height[0])

    def test_refused(self):
        """Each in a sentence at its key."""
        eigenmode = {"rti.start": "eigenmode"}
        for solids, settings, words in (
            (BALL.replace("centre_x = 7.5e5", "centre_x = 4.5e6"), {}, "&solids shape: "),
            (BALL.replace("radius = 2e5", "radius = 2e6"), {}, "&solids shape: "),
            (BALL.replace("radius = 2e5", "radius = 5e4"), {}, "&solids shape: "),
            (TWO.replace("3.75e5", "6e5"), {}, "the gap between body 'ball' and body 'bar'"),
            (BALL, eigenmode, "bodies stand in the box"),
            (BALL, {"rti.masses": "equal_mass", "rti.amplitude": 0}, "wall particles of bodies stand on one lattice"),
            (BALL, {"rti.supports": "volume"}, "wall particles of bodies have the one support"),
            (BALL, {"rti.surface_tension": 1e9}, "to a body is not calculated"),
            (BALL, {"rti.volume": "our_method", "walls.slip_top": "free_surface"}, "with bodies the box is closed"),
        ):
            with self.subTest(words, **settings):
                result = self.run_program("rti", self.input("refused", solids), settings, expect=BAD_INPUT)
                self.assertIn(words, result.stderr)
        result = self.run_program("disph_c", self.input("refused", BALL), expect=BAD_INPUT)
        self.assertIn("run that", result.stderr)


if __name__ == "__main__":
    unittest.main()
