"""The same bits on any number of ranks and threads, in cases where particles move across the
ranks' borders, neighbour lists are made anew, and walls push."""

import unittest

from running import ALL, SLOW, Case

# Walls that drag the fluid along in opposite directions: more than a spacing each way in 6 s, with a
# viscous fluid and a step of about the CFL limit. Particles cross the borders between the ranks of the periodic box.
SHEARED = ("hydrostatic_13_linear",
           {"time.dt": 0.2, "time.steps": 30, "expert.velocity_top": 2000, "expert.velocity_bottom": -2000,
            "material.viscosity": 2e11, "output.interval": 0, "hosono.solver": "newton"})

# B and D have no walls that could drag: a box whose fluid falls, and expands where it lacks support. Of 22 columns
# two stand on the borders of four ranks, and are handed over as soon as they move outwards.
FALLING = ("hydrostatic_column",
           {"time.dt": 0.05, "time.steps": 36, "initial.profile": "uniform", "initial.pressure": 1e10,
            "domain.particles_x": 22, "domain.length_x": 110e3, "material.viscosity": 1e11, "output.interval": 0, "hosono.solver": "newton"})

# B falls more slowly than D.
CASES = {program: SHEARED for program in ALL}
CASES["disph_d"] = FALLING
CASES["disph_b"] = (FALLING[0], {**FALLING[1], "time.steps": 70})


def case_of(program, **more):
    name, settings = CASES[program]
    return name, {**settings, **more}


class Same(Case):
    def hashes(self, program, name, settings, layouts):
        found = {}
        for ranks, threads in layouts:
            s = self.run_program(program, name, settings, ranks=ranks, threads=threads).summary
            self.assertEqual((s["ranks"], s["threads"]), (ranks or 1, threads))
            found[ranks, threads] = (s["state_hash"], s["steps"], s["rhs_evaluations"], s["errors"], s["conservation"])
        first = next(iter(found.values()))
        for layout, result in found.items():
            self.assertEqual(result, first, f"{program} on {layout[0]} ranks x {layout[1]} threads")
        return first

    def assert_moved(self, result, program):
        displacement, rebuilds = result[3]["displacement_max_over_dx"], result[2] - result[1]
        # One right-hand side a step of Euler's method, one at the start, and one more whenever lists were made anew.
        self.assertGreater(displacement, 1 if CASES[program] is SHEARED else 0.1)
        self.assertGreater(rebuilds, 1)

    def test_programs_on_ranks(self):
        for program in ALL:
            with self.subTest(program):
                name, settings = case_of(program)
                ranks = (2, 3, 4, 5) if SLOW or program == "disph_c" else (5,) if program in ("disph_b", "disph_d") else (3,)
                result = self.hashes(program, name, settings, [(None, 1), *((n, 1) for n in ranks)])
                self.assert_moved(result, program)

    def test_adaptive_on_ranks(self):
        for program in ["disph_a", "disph_d", "disph_f"]:
            with self.subTest(program):
                name, settings = case_of(program)
                settings = {**settings, "time.method": "adaptive", "time.rtol": 1e-3}
                if program == "disph_a":
                    settings["time.steps"] = 20 if SLOW else 10
                self.hashes(program, name, settings, [(None, 1), (4, 1)])

    def test_threads(self):
        """1600 particles: smaller loops are not worth threads, and run on one."""
        for program in ["disph_a", "disph_d", "disph_f"]:
            with self.subTest(program):
                name, settings = case_of(program)
                settings = {**settings, "domain.particles_x": 40, "domain.particles_y": 40,
                            "domain.length_x": 100e3, "time.steps": 12,
                            "time.dt": settings["time.dt"] / 2, "material.viscosity": 5e10}
                self.hashes(program, name, settings, [(None, 1), (None, 2), (2, 2)])

    def test_in_three_dimensions(self):
        settings = {"domain.dimension": 3, "time.steps": 8, "time.dt": 0.2, "expert.velocity_top": 2000, "material.viscosity": 2e11,
                    "output.interval": 0}
        for axis, n in (("x", 16), ("y", 8), ("z", 10)):
            settings[f"domain.length_{axis}"], settings[f"domain.particles_{axis}"] = n * 5e3, n
        result = self.hashes("disph_c", "hydrostatic_13_linear", settings, [(None, 1), (3, 1), (8, 1), (2, 2)])
        self.assertGreater(result[3]["displacement_max_over_dx"], 0.1)

    def test_more_ranks_than_the_halo_is_wide(self):
        """8 columns of particles and a halo of 3.8 of them: cells narrower than the halo, and of 10 some hold nothing."""
        name, settings = case_of("disph_f", **{"time.steps": 12, "domain.particles_x": 8, "domain.length_x": 40e3})
        first = self.run_program("disph_f", name, settings).summary["state_hash"]
        for ranks, ranks_x in [(5, 5), (6, 1), (8, 2), (10, 10)]:
            with self.subTest(ranks=ranks, ranks_x=ranks_x):
                s = self.run_program("disph_f", name, {**settings, "domain.ranks_x": ranks_x}, ranks=ranks).summary
                self.assertEqual(s["state_hash"], first)


if __name__ == "__main__":
    unittest.main()
