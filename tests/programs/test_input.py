"""What an input may say in each program, and how the rest is refused: before anything is written, at the key, and soon."""

import time
import unittest

from running import BAD_INPUT, CALCULATION_FAILED, COMPLETED, INPUTS, Case

MARCHES = {"rti": "rti_note", "drop": "drop_cylinder", "conduction": "conduction_plate", "convection": "air_1e4", "shock": "sod",
           "flow": "dam_break_front"}
PERIODIC_COLUMN = {"domain.periodic_x": ".true.", "domain.length_x": 3e4, "domain.particles_x": 6}


class Refusals(Case):
    def refuse(self, program, name, settings, *says, ranks=None):
        """Refused at the setting, by --check and by a run, which leaves nothing behind."""
        source = name if name.endswith(".nml") else INPUTS / f"{name}.nml"
        changes = [word for key, value in settings.items() for word in ("--set", f"{key}={value}")]
        for more in [["--check"], []] if ranks is None else [[]]:
            result = self.call(program, source, *changes, "--output", "out", *more, ranks=ranks)
            self.assert_says(result, BAD_INPUT, *says)
            self.assertFalse((self.here / "out").exists(), result)

    # ---- choices ----

    def test_methods_of_each_program(self):
        """Only convection keeps the rate of the step before, which 'ab2' needs."""
        for program, name in MARCHES.items():
            with self.subTest(program):
                offered = "'ab2'" in self.call(program, "--describe").stdout
                self.assertEqual(offered, program == "convection")
                if not offered:
                    self.refuse(program, name, {"time.method": "ab2"}, "--set time.method=ab2: &time method", "'rk4'")
        self.refuse("disph_c", "hydrostatic_11", {"time.method": "ab2"}, "&time method")

    def test_methods_for_diffusion(self):
        """A gas has none that could bound their stages."""
        self.refuse("shock", "sod", {"time.method": "rkl2"}, "--set time.method=rkl2: &time method", "'adaptive'")

    def test_kernels_of_shock(self):
        described = self.call("shock", "--describe").stdout
        self.assertNotIn("wendland_c2", described)
        self.refuse("shock", "sod", {"kernel.name": "wendland_c2"}, "&kernel name", "'quintic', 'wendland_c4'")

    # ---- no input ----

    def test_a_file_without_a_group(self):
        for text in [" \n\t\n", "! dt = 3\n", "steps = 3\n"]:
            (self.here / "in.nml").write_text(text)
            self.refuse("rti", "in.nml", {"time.steps": 3}, "in.nml:", "the input has no group")
        for program in [*MARCHES, "disph_c", "balance"]:
            with self.subTest(program=program):
                self.refuse(program, "in.nml", {}, "in.nml:", "the input has no group")
        self.assert_says(self.call("plan", "relaxation", "in.nml"), BAD_INPUT, "in.nml:", "the input has no group")

    # ---- boxes ----

    def test_more_particles_than_any_machine_holds(self):
        for program, name, settings in [
                ("disph_c", "hydrostatic_11", {"domain.particles_x": 10**9, "domain.particles_y": 10**9}),
                ("convection", "air_1e4", {"domain.particles_x": 10**9, "domain.particles_y": 10**9}),
                ("rti", "rti_note", {"domain.dimension": 3, **{f"domain.particles_{axis}": 10**6 for axis in "xyz"}}),
                ("conduction", "conduction_plate", {"domain.dimension": 3, **{f"domain.particles_{axis}": 10**6 for axis in "xyz"}}),
                ("shock", "square", {"shock.rho_l": 1e13, "shock.masses": "equal_mass"})]:
            with self.subTest(program):
                self.refuse(program, name, settings, "&domain particles_x: expected at most 1e12 particles")

    def test_an_axis_of_shock(self):
        self.refuse("shock", "square", {"domain.particles_y": 0, "domain.length_y": 0.7}, "--set domain.length_y=0.7: &domain length_y",
                    "a whole number of spacings")
        self.refuse("shock", "square", {"domain.particles_y": 0, "domain.length_y": 1e300}, "&domain length_y", "6.4e+301 particles")
        self.refuse("shock", "square", {"domain.particles_y": 0, "domain.length_y": 1e-9}, "&domain length_y", "less than the spacing")
        self.refuse("shock", "square", {"domain.particles_y": 7}, "--set domain.particles_y=7: &domain particles_y", "spacing")

    def test_boxes_narrower_than_the_kernel(self):
        three = {"domain.particles_x": 3, "domain.particles_y": 3}
        for n in (1, 3):
            self.refuse("convection", "air_1e4", {"domain.particles_x": n, "domain.particles_y": n}, f"--set domain.particles_x={n}: &domain particles_x",
                        "narrower along x")
        self.refuse("disph_c", "hydrostatic_13", {"domain.particles_y": 3, "domain.length_y": 15e3}, "&domain particles_y", "narrower along y")
        self.refuse("rti", "rti_note", {"domain.particles_x": 4, "domain.particles_y": 4}, "&domain particles_x", "narrower along x")
        self.refuse("conduction", "conduction_plate", {"domain.particles_x": 4, "domain.particles_y": 4, "kernel.name": "wendland_c6", "domain.periodic_x": ".false."},
                    "&domain particles_x", "narrower along x")
        self.refuse("convection", "rayleigh_benard", {"kernel.skin": 2.0, "kernel.h_over_dx": 4.9, **three}, "&domain particles_")
        self.refuse("disph_c", "hydrostatic_13", {**PERIODIC_COLUMN, "domain.particles_y": 20, "kernel.h_over_dx": 0.9, "kernel.skin": 2.0, "walls.marker_radius": 2.5},
                    "--set domain.particles_x=6: &domain particles_x", "too narrow along x", "halo")

    def test_the_smallest_lattices_that_are_taken_measure(self):
        for name, n in [("air_1e4", 4), ("blankenbach_1a", 4), ("air_1e4", 5)]:
            with self.subTest(name, n=n):
                result = self.run_program("convection", name, {"domain.particles_x": n, "domain.particles_y": n, "time.steps": 3})
                metrics = result.summary["metrics"]
                for key in ["nusselt_top", "nusselt_bottom", "nusselt_volume", "q1", "heat_imbalance"]:
                    self.assertIsInstance(metrics[key], float, key)
                self.assertNotIn("nan", (result.directory / "history.csv").read_text())

    def test_columns_of_ranks(self):
        for program, name in [*MARCHES.items(), ("disph_f", "hydrostatic_13")]:
            with self.subTest(program):
                self.refuse(program, name, {"domain.ranks_x": 2}, "--set domain.ranks_x=2: &domain ranks_x: 2 does not divide", "MPI ranks, 3", ranks=3)

    # ---- numbers ----

    def test_an_absurd_number_of_snapshots(self):
        for program, name in [*MARCHES.items(), ("disph_c", "hydrostatic_13")]:
            with self.subTest(program):
                self.refuse(program, name, {"output.interval": 1e-300}, "--set output.interval=1e-300: &output interval: would write")

    def test_slowing_below_one(self):
        self.refuse("convection", "air_1e4", {"expert.zeta": 0.5}, "--set expert.zeta=0.5: &expert zeta", "in [1, 1e+30]")
        self.refuse("convection", "air_1e4", {"expert.xi": "1e308"}, "--set expert.xi=1e308: &expert xi", "in [1, 1e+30]")

    def test_steps_that_no_limit_gives(self):
        """Known to a run only, whose lists say what a step may be."""
        for program, name, settings in [("rti", "rti_note", {"domain.particles_x": 12, "domain.particles_y": 12, "kernel.h_over_dx": 0.5}),
                                        ("flow", "still_water", {"expert.sound_speed": "1e308"})]:
            with self.subTest(program):
                changes = [word for key, value in settings.items() for word in ("--set", f"{key}={value}")]
                result = self.call(program, INPUTS / f"{name}.nml", *changes, "--output", "out")
                self.assert_says(result, BAD_INPUT, "default value: &time dt", "must be given")
                self.assertFalse((self.here / "out").exists(), result)

    def test_a_drop_below_the_spacing(self):
        """The theory's grid goes with the radius: it must neither hang nor fill the memory."""
        self.refuse("drop", "drop_cylinder", {"drop.radius": "1e3"}, "--set drop.radius=1e3: &drop radius", "spacing")
        for radius in (2.6e4, 5e4):
            began = time.monotonic()
            result = self.call("drop", INPUTS / "drop_cylinder.nml", "--set", f"drop.radius={radius}", "--theory")
            self.assertEqual(result.status, COMPLETED, result)
            self.assertLess(time.monotonic() - began, 10)  # a minute and gigabytes before
        self.assertIn("finite differences)", result.stdout)

    def test_drops_wider_than_a_periodic_box(self):
        self.refuse("drop", "drop_emulsion", {"drop.radius": 1e6}, "--set drop.radius=1000000.0: &drop radius", "inside the box")

    def test_pressures_beyond_the_fits_of_melting(self):
        self.refuse("rti", "pond_on_mantle", {"rti.p_top": 1e12}, "&melting curve", "the fits for the mantle are none at")

    def test_keys_of_the_own_sums_of_rti(self):
        """Schemes pass over those of earlier versions too; rti itself has them no more."""
        text = (INPUTS / "rti_linear.nml").read_text().replace("&rti", "&rti\n  gradient = 'pattern_1'  stress = 'auto'", 1)
        (self.here / "older.nml").write_text(text)
        self.assert_says(self.call("disph_c", "older.nml", "--check"), COMPLETED)
        self.refuse("rti", "older.nml", {"time.steps": 3}, "older.nml:", "gradient")

    def test_kernels_that_reach_no_neighbour(self):
        for program, name in (("rti", "rti_linear"), ("disph_c", "hydrostatic_13"), ("conduction", "conduction_plate")):
            self.refuse(program, name, {"kernel.h_over_dx": "1e-3"}, "--set kernel.h_over_dx=1e-3: &kernel h_over_dx", "nearest neighbours")

    def test_fractions_of_a_step_that_leave_none(self):
        self.refuse("conduction", "conduction_plate", {"time.diffusive": "5e-324"}, "--set time.diffusive=5e-324: &time diffusive")

    def test_a_wave_that_the_lattice_cannot_hold(self):
        self.refuse("rti", "rti_poster", {"rti.wavelength": 10}, "--set rti.wavelength=10: &rti wavelength", "spacings")

    def test_a_wave_higher_than_its_layer(self):
        self.refuse("rti", "rti_linear", {"rti.amplitude": "8e5"}, "--set rti.amplitude=8e5: &rti amplitude", "thinner layer")

    def test_columns_too_heavy_for_their_modulus(self):
        """A column that the integration would carry to pressures beyond all numbers, or to some that mean nothing."""
        says = "the bulk modulus is too small for the column's weight"
        for K in (5, 500, 5e8, 5e9):
            with self.subTest(K):
                self.refuse("rti", "rti_note", {"rti.bulk_modulus": K}, "&rti p_top", says)
                self.refuse("disph_c", "rti_note", {"rti.bulk_modulus": K}, "&rti p_top", says)
                self.refuse("drop", "drop_cylinder", {"drop.bulk_modulus": K}, "&drop p_top", says)
        for K in (500, 1e8, 5e8):
            self.refuse("disph_n", "hydrostatic_column", {"material.bulk_modulus": K}, "&material bulk_modulus", says)

    def test_waves_that_the_theory_cannot_resolve(self):
        thin = {"rti.viscosity_lower": 1e3, "rti.viscosity_upper": 1e3}
        self.refuse("rti", "rti_linear", thin, "rti_linear.nml:", "&rti start", "'coloured' starts without a mode")
        result = self.call("rti", *self.arguments("rti_linear", {**thin, "rti.start": "coloured"}, "none", ["--theory"]))
        self.assertEqual(result.status, COMPLETED, result)
        self.assertIn("no growth rate to compare with", result.stdout)

    # ---- plan ----

    def test_plan_takes_finite_numbers(self):
        for question, options in [("relaxation", ["--L", "--dT", "--rho", "--nu", "--fraction", "--steps", "--run-time", "--rate"]),
                                  ("timestep", ["--L", "--c", "--eta", "--k", "--steps"])]:
            for option in options:
                for value in ["nan", "inf"]:
                    with self.subTest(question, option=option, value=value):
                        self.assert_says(self.call("plan", question, option, value), BAD_INPUT, option, value)
        self.assert_says(self.call("plan", "timestep", "--c", "1e100", "--g", "1e-100", "--delta-rho", "1e-100", "--n", 10**6), CALCULATION_FAILED, "not a finite number")


if __name__ == "__main__":
    unittest.main()
