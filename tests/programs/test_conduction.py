"""A body that cools from its top, against the exact solutions: errors, order of convergence, methods, ranks, restarts."""

import math
import unittest

from running import BAD_INPUT, INTERRUPTED, Case

PLATE, HALF_SPACE = "conduction_plate", "conduction_half_space"
# At kappa t/L^2 = 0.05 and 0.01 the errors are larger than at the inputs' end, and a run is a fifth as long.
SHORT = {PLATE: {"time.t_end": 2000}, HALF_SPACE: {"time.t_end": 400}}


class Conduction(Case):
    def error(self, name, **settings):
        settings = {**SHORT[name], **settings}
        return self.run_program("conduction", name, settings).summary["errors"]["temperature_l2"]

    def test_lattice_and_disorder(self):
        for name in SHORT:
            for scheme, kernel in [("sum", "quintic"), ("consistent", "wendland_c2"), ("corrected", "wendland_c2")]:
                with self.subTest(name=name, operator=scheme):
                    how = {"conduction.operator": scheme, "kernel.name": kernel}
                    self.assertLess(self.error(name, **how), 1e-3)
                    self.assertLess(self.error(name, **how, **{"domain.jitter": 0.1}), 5e-3)

    def test_order(self):
        """Second order in the spacing, the step going with its square. n = 16, 32."""
        for name in SHORT:
            for scheme in ["consistent", "corrected"]:
                with self.subTest(name=name, operator=scheme):
                    e = [self.error(name, **{"conduction.operator": scheme, "domain.particles_x": n, "domain.particles_y": n})
                         for n in (16, 32)]
                    self.assertGreater(math.log2(e[0] / e[1]), 1.9)

    def test_stabilised_methods_take_fewer_evaluations(self):
        """To the end of the input, where the steps may be long."""
        euler = self.run_program("conduction", PLATE).summary
        for method in ["rkl2", "rkc2"]:
            with self.subTest(method):
                s = self.run_program("conduction", PLATE, {"time.method": method}).summary
                self.assertLess(s["rhs_evaluations"], euler["rhs_evaluations"] / 3)
                self.assertLess(s["errors"]["temperature_l2"], 1e-3)
        s = self.run_program("conduction", PLATE, {**SHORT[PLATE], "time.method": "adaptive"}).summary
        self.assertLess(s["errors"]["temperature_l2"], 1e-3)

    def test_three_dimensions(self):
        three = {"domain.dimension": 3, "domain.particles_x": 12, "domain.particles_y": 12, "domain.particles_z": 12}
        self.assertLess(self.error(PLATE, **three), 2e-3)

    def test_ranks_and_restart(self):
        settings = {"conduction.operator": "corrected", "domain.jitter": 0.1, "time.t_end": 400}
        self.assert_exact("conduction", PLATE, settings, 50, [(2, 1), (None, 2)])

    def test_wrong_input(self):
        for key, value, word in [("time.t_end", 1e5, "t_end"), ("walls.thermal_top", "'adiabatic'", "thermal_top"),
                                 ("domain.particles_x", 40, "particle spacing")]:
            with self.subTest(key):
                result = self.run_program("conduction", HALF_SPACE, {key: value}, expect=BAD_INPUT)
                self.assertIn(word, result.stderr)
                self.assertFalse(result.directory.exists())
        self.run_program("conduction", PLATE, {"run.wall_clock_limit": 1e-9}, expect=INTERRUPTED)


if __name__ == "__main__":
    unittest.main()
