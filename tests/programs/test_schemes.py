"""Every scheme on every liquid problem that it can run: growth, fall and conduction against theory, ranks and restarts, and what is
refused."""

import unittest

from running import BAD_INPUT, INPUTS, SLOW, Case, outcome

QUIET = {"output.interval": 0}


def square(n, **more):
    return {"domain.particles_x": n, "domain.particles_y": n, **QUIET, **more}


# Far above what sound does to the pressure, so that no scheme stops, with a kernel whose lattice hardly resists shear under it.
FIRM = {"kernel.name": "wendland_c6"}


class Growth(Case):
    def error(self, program, n):
        """Of the growth rate."""
        m = self.run_program(program, "rti_linear", square(n, **FIRM, **{"rti.p_top": 1e10})).summary["metrics"]
        self.assertEqual(m["particles_put_back"], 0)
        return m["growth_rate"] / m["growth_rate_theory"] - 1

    def test_second_order(self):
        """The notes' viscous sum damps a wave by a part (kh)^2 too little, and walls and the contact add their share: half the spacing
        leaves a quarter of the error or less."""
        for program in ["disph_c", "disph_f", "disph_y", "disph_n", *(["disph_a", "disph_e"] if SLOW else [])]:
            with self.subTest(program):
                coarse, fine = self.error(program, 16), self.error(program, 32)
                self.assertLess(abs(fine), 0.02)
                self.assertGreater(abs(coarse / fine), 3)

    def test_a_smeared_density_holds_the_contact(self):
        """Standard SPH has a surface tension of its own: the wave grows a third more slowly."""
        self.assertLess(self.error("ssph", 32), -0.2)


class Exact(Case):
    def test_ranks_and_restart(self):
        for program, steps in [("disph_a", 24 if SLOW else 8), ("disph_c", 24), ("disph_y", 24), ("ssph", 24)]:
            with self.subTest(program):
                settings = square(16, **FIRM, **{"rti.p_top": 1e10, "rti.amplitude": 4e4, "time.dt": 2.5, "time.steps": steps, "domain.balance": "counted",
                                                 "balancer.interval": 4})
                whole = self.run_program(program, "rti_linear", settings)
                for ranks in (2, 4) if SLOW else (4,):
                    s = self.run_program(program, "rti_linear", settings, ranks=ranks).summary
                    self.assertEqual(outcome(s), outcome(whole.summary))
                self.run_program(program, "rti_linear", {**settings, "time.steps": 5}, output=f"part_{program}", ranks=3)
                again = self.run_program(program, "rti_linear", settings, output=f"part_{program}", options=["--restart", "latest"])
                # The rate where the run stopped is found again, and an iteration for it counted.
                self.assertEqual(again.summary["state_hash"], whole.summary["state_hash"])


class Contact(Case):
    """Iron under silicate without gravity, one pressure everywhere."""

    def moves(self, program, settings):
        """Root mean square of the speed at the end, m/s."""
        return self.run_program(program, "contact", {"time.t_end": 10, **QUIET, **settings}).summary["metrics"]["v_rms"]

    def test_one_lattice_is_at_rest(self):
        """Equal volumes: Y is the same for all, so that either pattern's sum vanishes by symmetry, pair by pair, to rounding."""
        for program in ("disph_c", "disph_e", "disph_f", "disph_f2"):
            with self.subTest(program):
                self.assertLess(self.moves(program, {}), 1e-9)

    def test_equal_masses_and_the_patterns(self):
        """Where Y jumps pattern 1 has the force -p (ΔV_i - ΔV_j)² ∇W that pattern 2 lacks."""
        mass = {"rti.masses": "equal_mass"}
        first, second = self.moves("disph_f", mass), self.moves("disph_f2", mass)
        self.assertGreater(first, 2 * second)
        self.assertGreater(second, 1e-3)

    def test_ranks_and_restart(self):
        settings = {"domain.jitter": 0.1, "rti.masses": "equal_mass", "rti.shear": 200, "rti.gravity": 10, "time.dt": 0.4, "time.steps": 12,
                    "domain.balance": "counted", **QUIET}
        whole = self.run_program("disph_f2", "contact", settings)
        self.assertEqual(outcome(self.run_program("disph_f2", "contact", settings, ranks=4).summary), outcome(whole.summary))
        self.run_program("disph_f2", "contact", {**settings, "time.steps": 5}, output="part", ranks=3)
        again = self.run_program("disph_f2", "contact", settings, output="part", options=["--restart", "latest"])
        self.assertEqual(again.summary["state_hash"], whole.summary["state_hash"])


class Problems(Case):
    def test_drop(self):
        """A cylinder's fall in a box, 4.8 particles across, and 6.4: an eighth too fast at most, as the viscous sum smooths the flow about it."""
        for program in ["disph_f", "disph_n"]:
            with self.subTest(program):
                m = self.run_program(program, "drop_cylinder", square(32 if SLOW else 24, **FIRM, **{"drop.p_top": 1e10})).summary["metrics"]
                self.assertAlmostEqual(m["fall_velocity"] / m["fall_velocity_theory"], 1.06, delta=0.065)

    def test_conduction(self):
        """Virtual markers and mirror images hold the walls' temperatures; what has no walls keeps its heat."""
        errors = {program: self.run_program(program, "conduction_plate", square(25)).summary["errors"]["temperature_l2"]
                  for program in ["disph_c", "disph_n", "disph_d"]}
        self.assertLess(errors["disph_c"], 0.02)
        self.assertLess(errors["disph_n"], 0.02)
        self.assertGreater(errors["disph_d"], 0.2)

    def test_melting_and_an_element(self):
        for program in ["disph_c", "disph_a"]:
            with self.subTest(program):
                pond = self.run_program(program, "pond_on_mantle", square(16, **{"time.steps": 8})).summary
                self.assertEqual(pond["status"], "completed")
                metal = self.run_program(program, "partitioning", square(24, **{"time.steps": 8})).summary
                self.assertLess(abs(metal["metrics"]["element_mass_error"]), 1e-12)

    def test_mirrors_hold_a_column(self):
        errors = {wall: self.run_program("disph_f", "hydrostatic_13", {**QUIET, "walls.treatment": wall}).summary["errors"]["pressure_max"]
                  for wall in ("virtual_marker", "mirror", "none")}
        self.assertLess(errors["mirror"], 2 * errors["virtual_marker"] + 1e-6)
        self.assertGreater(errors["none"], 10 * errors["mirror"])


class Refused(Case):
    def test_what_a_scheme_cannot_run(self):
        for program, name, settings, words in [
                ("disph_c", "blankenbach_1a", {}, ["program convection", "disph_c"]),
                ("disph_c", "sod", {}, ["program shock", "disph_c"]), ("disph_c", "still_water", {}, ["program flow", "disph_c"]),
                ("disph_c", "drop_surface_tension", {}, ["surface_tension", "disph_n", ".nml:"]),
                ("disph_n", "drop_surface_tension", {"walls.treatment": "virtual_marker"}, ["surface_tension", "mirror", ".nml:"]),
                ("disph_y", "pond_on_mantle", {}, ["temperature_law", "density", ".nml:"]),
                ("disph_c", "rti_linear", {"walls.treatment": "frozen"}, ["treatment", "virtual_marker"]),
                ("disph_c", "conduction_plate", {"walls.treatment": "repulsion"}, ["treatment"]),
                ("disph_c", "rti_linear", {"rti.volumes": "our_method"}, ["volumes"])]:
            with self.subTest(program=program, name=name):
                result = self.run_program(program, name, settings, expect=BAD_INPUT)
                for word in words:
                    self.assertIn(word, result.stderr)
                self.assertFalse(result.directory.exists())

    def test_what_belongs_to_program_rti_is_passed_over_and_said(self):
        result = self.run_program("disph_c", "rti_linear", square(12, **{"rti.volume": "our_method", "rti.delta": 0.1, "time.steps": 2}))
        self.assertIn("&rti volume, &rti delta", result.stdout + result.stderr)
        self.assertNotIn("delta", (result.directory / "resolved.nml").read_text())
        result = self.run_program("disph_c", "conduction_plate", square(12, **{"time.steps": 2}))
        self.assertIn("&conduction operator", result.stdout + result.stderr)

    def test_the_problem_decides_what_is_described(self):
        own = self.call("disph_c", "--describe")
        of_rti = self.call("disph_c", INPUTS / "rti_linear.nml", "--describe")
        self.assertIn("&initial", own.stdout)
        self.assertNotIn("&rti", own.stdout)
        self.assertIn("&rti", of_rti.stdout)
        self.assertIn("&hosono", of_rti.stdout)


if __name__ == "__main__":
    unittest.main()
