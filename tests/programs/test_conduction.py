"""A body that cools from its top, against the exact solutions: errors, order of convergence, methods, ranks, restarts."""

import math
import unittest

import h5py
import numpy as np

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

    def test_disorder_converges(self):
        """A lattice displaced by 15 %: with second moments that know how a neighbourhood is skewed errors fall with the spacing as on the
        lattice, at least with its power 1.5, and stay within three times those of the lattice. n = 16, 32, 64."""
        def error(n, jitter):
            return self.error(PLATE, **{"domain.jitter": jitter, "domain.particles_x": n, "domain.particles_y": n})
        e = [error(n, 0.15) for n in (16, 32, 64)]
        self.assertGreater(math.log2(e[0] / e[2]), 2 * 1.5, e)
        self.assertLess(e[2], 3 * error(64, 0))

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

    def test_a_contact_of_two_conductivities(self):
        """Hot metal under silicate that conducts a tenth as well, in `rti`: at the contact (e1 T1 + e2 T2)/(e1 + e2), e = (k rho c)^1/2, and error
        functions on both sides [Carslaw & Jaeger (1959), 2.8]. Root mean square 0.35 % of the step at n = 48, 0.14 at 96."""
        given = self.here / "contact.nml"
        given.write_text("&domain length_x = 0.5 length_y = 1 particles_x = 24 particles_y = 48 /\n&rti density_upper = 3000 density_lower = 7000 "
                         "bulk_modulus = 5e11 start = 'coloured' amplitude = 0 viscosity_upper = 1e3 viscosity_lower = 1e3 gravity = 10 p_top = 1e9 "
                         "temperature_law = 'adiabatic' conductivity_upper = 3e7 conductivity_lower = 3e8 /\n"
                         "&region condition = 'y > 0.5' temperature = 2600 /\n&time t_end = 2e-4 /\n")
        run = self.run_program("rti", given)
        with h5py.File(sorted(run.directory.glob("snapshot_*.h5"))[-1]) as file:
            f = {name: file[f"PartType0/{name}"][...] for name in ("Coordinates", "Temperature", "Material", "Density")}
        y, metal = f["Coordinates"][:, 1] - 0.5, f["Material"] == 0
        rho, k = np.where(metal, f["Density"][metal].mean(), f["Density"][~metal].mean()), np.where(metal, 3e8, 3e7)
        effusivity = np.sqrt(k * rho * 1000)
        e1, e2 = effusivity[metal][0], effusivity[~metal][0]
        contact = (3000 * e1 + 2600 * e2) / (e1 + e2)
        way = np.array([math.erf(abs(a) / (2 * math.sqrt(b * 2e-4))) for a, b in zip(y, k / (rho * 1000))])
        exact = contact + (np.where(metal, 3000, 2600) - contact) * way
        self.assertLess(np.sqrt(((f["Temperature"] - exact)**2).mean()), 0.005 * 400)

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
