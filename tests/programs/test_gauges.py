"""Points that read fields of the fluid, in every problem: against exact values, on any ranks, through a restart, refused where they
cannot be."""

import math
import unittest

from running import BAD_INPUT, INPUTS, Case


def points(fields, **at):
    """The settings of named points {name: place} that read these fields."""
    def listed(texts):
        return ",".join(f"'{text}'" for text in texts)

    settings = {"gauges.point": listed(at), "gauges.point_fields": listed(fields)}
    for axis, values in zip("xyz", zip(*at.values())):
        settings[f"gauges.point_{axis}"] = ",".join(f"{value:.17g}" for value in values)
    return settings


class Gauges(Case):
    def readings(self, result):
        """The columns of the history by their names without units, as numbers."""
        header, lines = result.rows()
        return {name.split(" ")[0]: [float(line[k]) for line in lines] for k, name in enumerate(header)}

    def read(self, program, name, settings, **how):
        return self.readings(self.run_program(program, name, settings, **how))

    def test_box_at_rest(self):
        """Within, on a wall, in a corner: of dp/dy = -rho g with p = p_top + K (rho/rho_top - 1)."""
        p_top, K, weight = 1e5, 100e9, 3000.0 * 10.0
        at = {"within": (43e3, 61e3), "floor": (50e3, 0.0), "corner": (0.0, 0.0), "lid": (77e3, 100e3)}
        for program in ("disph_f", "disph_n"):
            r = self.read(program, "hydrostatic_column", {"time.steps": 20, "output.interval": 0, **points(["Pressure"], **at)})
            for name, (_, y) in at.items():
                exact = p_top + K * math.expm1(weight * (100e3 - y) / K)
                for read in r[f"pressure_{name}"]:  # to 3e-4 of the pressure on the floor: the fit is of first order, and the start has
                    self.assertAlmostEqual(read, exact, delta=1e6, msg=f"{program} {name}")  # the errors of its sums over neighbours

    def test_plate_that_cools(self):
        """Of an infinite half space, as nothing has come to the plate's bottom: T = erf(depth/sqrt(4 kappa t))."""
        at = {"near": (0.013, 0.19), "middle": (0.05, 0.16), "deep": (0.07, 0.0)}
        r = self.read("conduction", "conduction_plate", {"time.t_end": 1000, **points(["temperature"], **at)})
        t = r["time"][-1]
        for name, (_, y) in at.items():
            exact = math.erf((0.2 - y) / math.sqrt(4e-6 * t))
            self.assertAlmostEqual(r[f"temperature_{name}"][-1], exact, delta=2e-3, msg=name)
        self.assertEqual(r["temperature_middle"][0], 1.0)

    def test_sod(self):
        """Between contact and shock, and ahead of that [E. F. Toro, Riemann Solvers and Numerical Methods for Fluid Dynamics, table 4.2]."""
        at = {"behind": (0.77,), "ahead": (0.95,)}
        r = self.read("shock", "sod", points(["Pressure", "Velocities", "Density"], **at))
        for name, exact, near in [("pressure_behind", 0.30313, 0.005), ("velocities_behind_x", 0.92745, 0.01), ("density_behind", 0.26557, 0.005),
                                  ("pressure_ahead", 0.1, 0.005), ("velocities_ahead_x", 0.0, 0.005)]:
            self.assertAlmostEqual(r[name][-1], exact, delta=near * max(exact, 1.0), msg=name)
        self.assertAlmostEqual(r["pressure_behind"][0], 0.1, delta=1e-4)

    def test_convection(self):
        """The temperature of the start. The fit's error is half the Laplacian times the kernel's variance along an axis, (1.4 dx)^2: 1 K."""
        x, y, L = 2.1e5, 3.7e5, 1e6
        r = self.read("convection", "blankenbach_1a", {"convection.levels": 0, "time.steps": 0, **points(["Temperature"], a=(x, y))})
        exact = 1000.0 * (1.0 - y / L + 0.3 * math.cos(math.pi * x / L) * math.sin(math.pi * y / L))
        self.assertAlmostEqual(r["temperature_a"][0], exact, delta=2.0)

    def test_water_at_rest(self):
        """Beside the gauges of flow's own, whose readings stay as they are; above the water there is nothing to read."""
        own = {"time.t_end": 0.1, "gauges.pressure_x": "0.5", "gauges.pressure_y": "0.3"}
        at = {"deep": (0.5, 0.3), "floor": (0.5, 0.0), "dry": (0.5, 1.15)}
        alone = self.run_program("flow", "still_water", own)
        both = self.run_program("flow", "still_water", {**own, **points(["Pressure"], **at)})
        self.assertEqual((alone.directory / "gauges.csv").read_bytes(), (both.directory / "gauges.csv").read_bytes())
        self.assertEqual(alone.summary["state_hash"], both.summary["state_hash"])
        r = self.readings(both)
        for name, depth in [("deep", 0.7), ("floor", 1.0)]:  # water that its own weight compresses by half a percent
            self.assertAlmostEqual(r[f"pressure_{name}"][-1], 9810.0 * depth, delta=0.015 * 9810.0, msg=name)
        self.assertEqual(set(r["pressure_dry"]), {0.0})

    def test_three_dimensions(self):
        """A hydrostatic column again, from the pressure at its lid; and components along z."""
        few = {"domain.particles_x": 12, "domain.particles_y": 12, "domain.particles_z": 12, "time.steps": 1, "time.dt": 1.0}
        at = {"a": (5e5, 8e5, 4e5), "b": (5e5, 6e5, 4e5)}
        r = self.read("drop", "drop_sphere", {**few, **points(["Pressure", "Velocities"], **at)})
        exact = [5e11 * math.expm1(3000.0 * 10.0 * (1.5e6 - y) / 5e11) for _, y, _ in at.values()]
        self.assertAlmostEqual((r["pressure_b"][0] - r["pressure_a"][0]) / (exact[1] - exact[0]), 1.0, delta=0.02)
        self.assertIn("velocities_b_z", r)

    def test_readings_do_not_disturb_ranks_and_restart(self):
        """The lines of the history, bit by bit, and the state as without gauges."""
        few = {"domain.particles_x": 24, "domain.particles_y": 24, "time.t_end": 300, "output.interval": 0}
        with_points = {**few, "output.history_interval": 5}
        whole = self.run_program("rti", "rti_gauges", with_points)
        bare = self.here / "bare.nml"
        before, _, behind = (INPUTS / "rti_gauges.nml").read_text().partition("&gauges")
        bare.write_text(before + behind.partition("/\n")[2])
        self.assertEqual(self.run_program("rti", bare, with_points).summary["state_hash"], whole.summary["state_hash"])
        history = (whole.directory / "history.csv").read_bytes()
        for ranks, threads in ((2, 1), (3, 2), (4, 1)):
            other = self.run_program("rti", "rti_gauges", with_points, ranks=ranks, threads=threads)
            self.assertEqual((other.directory / "history.csv").read_bytes(), history, f"{ranks} ranks")
        part = {**with_points, "time.steps": 20, "run.checkpoint_interval": 10}
        self.run_program("rti", "rti_gauges", part, "part", ranks=2)
        rest = self.run_program("rti", "rti_gauges", with_points, "part", ["--restart", "latest"])
        self.assertEqual(rest.rows(), whole.rows())

    def test_metal_passes(self):
        """It falls past the point below, and silicate rises beside it."""
        r = self.read("rti", "rti_gauges", {"time.t_end": 1200})
        self.assertEqual(r["material_plume"][0], 0.0)
        self.assertAlmostEqual(r["material_plume"][-1], 1.0, delta=0.05)
        self.assertLess(r["velocities_plume_y"][-1], -300.0)
        self.assertGreater(r["velocities_return_y"][-1], 300.0)

    def test_refused(self):
        """With the gauge's name and its value, before anything is written."""
        inside = points(["Pressure"], low=(7.5e5, 2e5), ball=(7.5e5, 6.3e5))
        good = points(["Pressure"], low=(7.5e5, 2e5), high=(1e5, 3e5))
        for name, settings, said in [
                ("rti_note", points(["Pressure"], low=(7.5e5, 2e5), far=(1.6e6, 2e5)), ["gauges point_x", "gauge 'far'", "1600000"]),
                ("rti_note", points(["Pressure"], low=(7.5e5, -10.0)), ["gauges point_y", "gauge 'low'", "-10"]),
                ("rti_note", points(["Presure"], low=(7.5e5, 2e5)), ["gauges point_fields", "'Presure'", "'Pressure'"]),
                ("rti_note", points(["Coordinates"], low=(7.5e5, 2e5)), ["gauges point_fields", "'Coordinates'"]),
                ("rti_note", points(["MeltFraction"], low=(7.5e5, 2e5)), ["gauges point_fields", "'MeltFraction'"]),
                ("rti_note", points(["Pressure", "pressure"], low=(7.5e5, 2e5)), ["gauges point_fields", "'Pressure'", "twice"]),
                ("rti_note", {**good, "gauges.point": "'low','low'"}, ["gauges point", "'low'", "two"]),
                ("rti_note", {**good, "gauges.point": "'low','a b'"}, ["gauges point", "'a b'"]),
                ("rti_note", {**good, "gauges.point": "'low'"}, ["gauges point", "expected 2"]),
                ("rti_note", {**good, "gauges.point_y": "2e5"}, ["gauges point_y", "expected 2"]),
                ("rti_note", {**good, "gauges.point_z": "2e5, 1e5"}, ["gauges point_z", "expected 0"]),
                ("rti_note", {"gauges.point_x": "1e5", "gauges.point_y": "1e5"}, ["gauges point_fields"]),
                ("rti_round_a_sphere", inside, ["gauges point_x", "gauge 'ball'", "'sphere'", "750000, 630000"])]:
            with self.subTest(said):
                before = self.listing()
                for options in ((), ("--check",)):
                    result = self.call("rti", *self.arguments(name, settings, self.here / "no", options))
                    self.assert_says(result, BAD_INPUT, *said)
                self.assertEqual(self.listing(), before)
        wedge = points(["Pressure"], a=(1.0, 0.01))
        self.assert_says(self.call("flow", *self.arguments("still_wedge", wedge, self.here / "no")), BAD_INPUT, "gauge 'a'", "inside of body")

    def test_columns_that_are_there_already(self):
        """Not found by --check, which does not set the problem up; but before anything is written."""
        result = self.call("shock", *self.arguments("sod", points(["Density"], max=(0.5,)), self.here / "no"))
        self.assert_says(result, BAD_INPUT, "density_max", "another name")
        self.assertFalse((self.here / "no").exists())


if __name__ == "__main__":
    unittest.main()
