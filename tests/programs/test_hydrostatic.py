"""The note's hydrostatic cases and ours: which program holds a fluid at rest, how well, and which fails and why.

The targets are in docs/theory and the inputs. Where fewer steps are taken than the input asks
for, the law does not need them, and the test says why.
"""

import math
import re
import unittest

import h5py
import numpy as np

from running import CALCULATION_FAILED, SLOW, Case

QUIET = {"output.interval": 0}


def steps(n):
    return {**QUIET, "time.steps": n}


class Iteration(Case):
    """Programs A and B: Y by Hosono's iteration."""

    def test_plain_diverges_in_liquid_iron(self):
        """[note, table 2] in step 1 or 2. Theory: a pass multiplies by up to (K_T/p - 1)(1 - S_min), about 9.9 at 10 GPa."""
        for program in ["disph_a", "disph_b"]:
            for name, kappa, growth in [("hydrostatic_11", 5.14e5, 5.14e5), ("hydrostatic_12", 10.9, 9.90)]:
                with self.subTest(program=program, name=name):
                    result = self.run_program(program, name, QUIET, expect=CALCULATION_FAILED)
                    s = result.summary
                    self.assertEqual(s["status"], "diverged")
                    self.assertLessEqual(s["diverged_step"], 2)
                    self.assertGreater(s["diverged_iteration"], 0)
                    self.assertIn(s["message"], result.stderr)
                    said = re.search(r"iteration (\d+): K_T/p = ([\d.]+), predicted growth factor .*\(1 - S_min\) = ([\d.]*\d)", s["message"])
                    self.assertIsNotNone(said, s["message"])
                    self.assertEqual(int(said[1]), s["diverged_iteration"])
                    self.assertAlmostEqual(float(said[2]) / kappa, 1, delta=0.01)
                    self.assertAlmostEqual(float(said[3]) / growth, 1, delta=0.01)
                    self.assertRegex(s["message"], r"particle \d+ at \(")

    def test_plain_diverges_at_the_predicted_rate(self):
        """The last residuals before the end grow by the factor that theory gives, within 10 %: the highest mode alone is left."""
        result = self.run_program("disph_a", "hydrostatic_12", QUIET, expect=CALCULATION_FAILED)
        header, rows = result.rows("residuals.csv")
        evaluation, last = header.index("evaluation [1]"), rows[-1]
        residual = [float(r[-1]) for r in rows if r[evaluation] == last[evaluation]]
        linear = [(a, b) for a, b in zip(residual, residual[1:]) if 1e-8 < a and b < 1e-3]
        self.assertGreaterEqual(len(linear), 3)
        predicted = result.summary["metrics"]["hosono_growth_predicted"]
        for a, b in linear:
            self.assertAlmostEqual(b / a / predicted, 1, delta=0.1)

    def test_cures_converge(self):
        """A hundred steps: the state is at rest (A) or hardly moves (B), so that one step is like another."""
        for name in ["hydrostatic_12", "hydrostatic_13"]:
            for solver in ["newton", "anderson"]:
                for program in ["disph_a", "disph_b"]:
                    with self.subTest(program=program, name=name, solver=solver):
                        s = self.run_program(program, name, {**steps(100), "hosono.solver": solver}).summary
                        self.assertEqual((s["status"], s["steps"]), ("completed", 100))
                        if program == "disph_a":
                            self.assertLessEqual(s["errors"]["pressure_mean"], 1e-3)

    def test_cures_agree(self):
        """They solve the same equations: to the tolerance, 1e-12, times the pressure's K_T/p."""
        errors = [self.run_program("disph_b", "hydrostatic_12", {**steps(1), "hosono.solver": solver}).summary["errors"]
                  for solver in ["under_relaxed", "newton", "anderson"]]
        for e in errors[1:]:
            for name in ["pressure_mean", "pressure_max", "density_max"]:
                self.assertAlmostEqual(e[name] / errors[0][name], 1, delta=1e-9)

    def test_newton_runs_all_steps(self):
        s = self.run_program("disph_a", "hydrostatic_12", {**QUIET, "hosono.solver": "newton"}).summary
        self.assertEqual(s["steps"], 1000)
        # The lattice sum is 1 - 5.62e-5, which lowers the pressure by that of K_T: 10.9 p.
        self.assertAlmostEqual(s["errors"]["pressure_mean"], 5.62e-5 * 10.9, delta=0.1e-4)

    def test_no_state_at_atmospheric_pressure(self):
        """5.6e-5 of K_T is more than 1e5 Pa: no solver can help, but the normalised sum does."""
        for solver in ["newton", "anderson", "under_relaxed"]:
            result = self.run_program("disph_a", "hydrostatic_11", {**QUIET, "hosono.solver": solver}, expect=CALCULATION_FAILED)
            self.assertIn("no state with p > 0 exists", result.summary["message"])
            self.assertIn("normalise", result.summary["message"])
        settings = {**steps(300), "hosono.solver": "newton", "smoothing.normalise": ".true."}
        s = self.run_program("disph_a", "hydrostatic_11", settings).summary
        self.assertEqual(s["status"], "completed")
        # Rounding of p is eps K_T, 1e-10 of p.
        self.assertLess(s["errors"]["pressure_mean"], 1e-8)

    def test_passes_are_limited(self):
        """Newton's line searches count, which took ten times as many as were allowed where no state exists; and the pass before Anderson's."""
        small = {"domain.particles_x": 24, "domain.particles_y": 24}
        for solver, name, allowed, settings in [("newton", "rti_note_100_100km", 50, small), ("anderson", "hydrostatic_12", 2, {})]:
            settings = {**settings, "hosono.solver": solver, "hosono.max_iterations": allowed, "time.steps": 1}
            result = self.run_program("disph_a", name, settings, expect=CALCULATION_FAILED)
            self.assertIn(f"did not converge after {allowed} passes", result.summary["message"])
            self.assertEqual(max(int(row[2]) for row in result.rows("residuals.csv")[1]), allowed)

    def test_threshold_of_plain(self):
        """Converges if (K_T/p - 1)(1 - S_min) < 1, in practice p > K_T/2. Two steps: the
        iteration of the first decides, and is hundreds of passes long where |G| is near 1."""
        for pressure, converges in [(3.0e10, False), (4.0e10, False), (5.5e10, True), (7.0e10, True)]:
            with self.subTest(pressure=pressure):
                result = self.run_program("disph_a", "hydrostatic_column", {**steps(2), "initial.pressure": pressure},
                                          expect=0 if converges else CALCULATION_FAILED)
                s = result.summary
                self.assertEqual(s["status"], "completed" if converges else "diverged")
                self.assertEqual(s["metrics"]["hosono_growth_predicted"] < 1, converges)


class UniformPressure(Case):
    """File 13 with a linear equation of state: after 1000 steps, displacement/dx, density and mean pressure error."""

    def errors(self, program):
        e = self.run_program(program, "hydrostatic_13_linear", QUIET).summary["errors"]
        return e["displacement_max_over_dx"], e["density_max"], e["pressure_mean"]

    def test_without_wall_support(self):
        for found, target in zip(self.errors("disph_d"), (2.8e-2, 1.1e-2, 4.9e-2)):
            self.assertLess(max(found / target, target / found), 1.5)

    def test_with_corrected_walls(self):
        """What is left is the lattice sum, 1 - 5.62e-5, in the smoothed pressure."""
        for program in ["disph_c", "disph_e"]:
            displacement, density, pressure = self.errors(program)
            self.assertAlmostEqual(pressure, 5.6e-5, delta=0.6e-5)
            self.assertLessEqual(displacement, 1.3e-6)
            self.assertLessEqual(density, 1e-6)

    def test_non_smoothed_pressure_is_exact(self):
        self.assertLess(max(self.errors("disph_f")), 1e-12)

    def test_c_to_f_complete_in_liquid_iron(self):
        """[note, table 2]. Two hundred steps suffice: at rest one is like another, and test_with_corrected_walls takes them all."""
        for program in ["disph_c", "disph_d", "disph_e", "disph_f"]:
            for name in ["hydrostatic_11", "hydrostatic_12"]:
                with self.subTest(program=program, name=name):
                    self.assertEqual(self.run_program(program, name, steps(200)).summary["status"], "completed")


class Column(Case):
    """Box with gravity, exact profile at the start."""

    def errors(self, program, settings=None):
        return self.run_program(program, "hydrostatic_column", {**QUIET, **(settings or {})}).summary["errors"]["pressure_mean"]

    def test_order_of_the_programs(self):
        """[note] F is better than C, C than E, E than D."""
        c, d, e, f = (self.errors(p) for p in ["disph_c", "disph_d", "disph_e", "disph_f"])
        self.assertLessEqual(f, 3e-5)
        self.assertLessEqual(c, 6e-5)
        self.assertLessEqual(e, 7e-5)
        self.assertLess(f, c)
        self.assertLess(c, e)
        self.assertLess(e, 1e-2)
        self.assertLess(1e-2, d)

    def test_shepard_at_the_walls(self):
        """Shepard's mean does not reproduce a linear field. 300 steps: the fault is there from the first evaluation."""
        mls, shepard = (self.errors("disph_c", {**steps(300), "walls.interpolation": how}) for how in ["mls", "shepard"])
        self.assertGreater(shepard, 50 * mls)

    def test_second_order_interpolation(self):
        """As good as the first order at least: the profile's curvature is then exact too."""
        mls, mls2 = (self.errors("disph_f", {**steps(300), "walls.interpolation": how}) for how in ["mls", "mls2"])
        self.assertLess(mls2, 1.1 * mls)

    def test_drifts(self):
        """Mass is constant, so its drift is exactly zero. Momentum: relative to sum m c; gravity acts on 0.3 s, and the
        walls must carry it: the acceleration that is left, times t/c, is below 1e-3 g t/c = 5e-7. Energy: relative to sum p dV."""
        for program in ["disph_c", "disph_d", "disph_e", "disph_f"]:
            with self.subTest(program):
                c = self.run_program(program, "hydrostatic_column", steps(300)).summary["conservation"]
                self.assertEqual(set(c), {"mass", "momentum", "energy"})
                self.assertEqual(c["mass"], 0)
                if program != "disph_d":  # without support the fluid falls
                    self.assertLess(abs(c["momentum"]), 5e-7)
                    self.assertLess(abs(c["energy"]), 1e-8)

    @unittest.skipUnless(SLOW, "slow")
    def test_fall_onto_the_floor(self):
        """From uniform pressure the column falls by a spacing. Without a force of the walls themselves 46 particles pass them."""
        settings = {**steps(1200), "initial.profile": "uniform", "initial.pressure": 3e10, "gravity.g": 100, "material.viscosity": 1e10,
                    "time.method": "rk4", "time.dt": 0.1, "run.checkpoint_interval": 800}
        alone = self.run_program("disph_c", "hydrostatic_column", settings)
        s = alone.summary
        self.assertGreater(s["errors"]["displacement_max_over_dx"], 1)
        self.assertEqual(s["metrics"]["particles_put_back"], 0)
        two = self.run_program("disph_c", "hydrostatic_column", settings, options=["--restart", alone.directory / "checkpoint_00000800.h5"], ranks=2)
        self.assertEqual(two.summary["state_hash"], s["state_hash"])


class Disorder(Case):
    @unittest.skipUnless(SLOW, "slow")
    def test_a_settled_column_stays(self):
        """From a lattice displaced by 15 % that settles in 60 crossings of sound, a liquid with next to no viscosity and 1e5 Pa at its top: after 30
        more C and F, tied, stand, and their pressure is that at each particle's place to 1 % of the floor's (root mean square). As the noise of the
        motion that is left, at most K sqrt(2E/KV), E its energy: docs/studies/2026-11-27_disordered_column.md. Unsettled it is 16 to 33 %."""
        how = {**QUIET, "domain.jitter": 0.15, "initial.pressure": 1e5, "volume.consistency": "tied", "initial.settle": 60, "time.method": "order_2",
               "time.dt": 0.2, "time.steps": 2600}
        for program in ("disph_c", "disph_f"):
            with self.subTest(program=program):
                run = self.run_program(program, "hydrostatic_column", how)
                with h5py.File(sorted(run.directory.glob("snapshot_*.h5"))[-1]) as file:
                    y, p = file["PartType0/Coordinates"][:, 1], file["PartType0/Pressure"][...]
                exact = 1e5 + 1e11 * np.expm1(3000 * 10 * (1e5 - y) / 1e11)
                self.assertLess(math.sqrt(((p - exact)**2).mean()), 0.01 * 3e9)


class Plates(Case):
    def test_heat_and_drag_enter_by_the_wall(self):
        """A floor that moves and is hot, under a liquid of Prandtl number 1 (Stokes' first problem): (T - 300)/10 = v/U = erfc(y/(2 sqrt(nu t))).
        Off by what the lattice resolves of a layer of 4.5 spacings; images, and markers, of both transport coefficients."""
        box = self.here / "plate.nml"
        box.write_text("&domain length_x = 0.375 length_y = 1 particles_x = 12 particles_y = 32 /\n&initial temperature = 300 pressure = 0.1 /\n"
                       "&material eos = 'linear' reference_density = 1 reference_temperature = 300 bulk_modulus = 1 thermal_expansivity = 0 "
                       "heat_capacity = 1e3 viscosity = 0.01 conductivity = 10 /\n&time method = 'order_2' dt = 0.01 steps = 50 /\n"
                       "&walls thermal_bottom = 'fixed' temperature_bottom = 310 velocity_bottom = 0.01 /\n")
        for program, treatment, much in [("disph_c", "mirror", 0.02), ("disph_c", "virtual_marker", 0.03), ("disph_f", "mirror", 0.02),
                                         ("ssph", "mirror", 0.02)]:
            with self.subTest(program=program, treatment=treatment):
                run = self.run_program(program, box, {**QUIET, "walls.treatment": f"'{treatment}'"})
                with h5py.File(sorted(run.directory.glob("snapshot_*.h5"))[-1]) as file:
                    x, v, T = (file[f"PartType0/{name}"][...] for name in ("Coordinates", "Velocities", "Temperature"))
                exact = np.array([math.erfc(y / (2 * math.sqrt(0.01 * 0.5))) for y in x[:, 1]])
                self.assertLess(np.abs((T - 300) / 10 - exact).max(), much)
                self.assertLess(np.abs(v[:, 0] / 0.01 - exact).max(), much)


class Integration(Case):
    def test_adaptive_against_a_tenth_of_the_step(self):
        """The same errors with fewer right-hand sides. Over 0.2 s instead of 1 s: the ratio is what counts."""
        for program in ["disph_c", "disph_f"]:
            fine = self.run_program(program, "hydrostatic_column", {**QUIET, "time.dt": 1e-4, "time.steps": 2000}).summary
            adaptive = self.run_program(program, "hydrostatic_column",
                                        {**QUIET, "time.method": "adaptive", "time.rtol": 1e-6, "time.t_end": 0.2}).summary
            self.assertAlmostEqual(adaptive["time"], 0.2, delta=1e-12)
            self.assertAlmostEqual(fine["time"], 0.2, delta=1e-12)
            self.assertAlmostEqual(adaptive["errors"]["pressure_mean"] / fine["errors"]["pressure_mean"], 1, delta=0.01)
            self.assertLess(adaptive["rhs_evaluations"], fine["rhs_evaluations"] / 10)

    SLOSHING = {**QUIET, "initial.profile": "uniform", "initial.pressure": 4e9, "material.viscosity": 1e11, "time.t_end": 2.0}

    def test_fixed_steps_of_every_order(self):
        """A fluid that falls: each order at dt = 0.1 is nearer to the fine solution than the one below."""
        settings = {**self.SLOSHING, "time.dt": 0.1, "time.steps": 20}
        exact = self.kinetic({**settings, "time.method": "order_5", "time.dt": 0.02, "time.steps": 100})
        errors = [abs(self.kinetic({**settings, "time.method": m}) / exact - 1)
                  for m in ["euler", "order_2", "order_3", "order_4", "order_5"]]
        for lower, higher in zip(errors, errors[1:]):
            self.assertLess(higher, lower, errors)

    def kinetic(self, settings):
        header, rows = self.run_program("disph_f", "hydrostatic_column", settings).rows()
        return float(rows[-1][[h.split(" ")[0] for h in header].index("kinetic_energy")])

    def test_moving_fluid_conserves(self):
        """A column that starts with uniform pressure falls, rebounds and is damped. Mass exactly; energy (kinetic, potential
        and internal together) to 1e-4 of what is exchanged between its forms: the wall's force on a moving fluid
        is interpolated, and does work of that order."""
        for program in ["disph_c", "disph_e", "disph_f"]:
            with self.subTest(program):
                settings = {**self.SLOSHING, "time.method": "adaptive", "time.dt": 0.01, "time.t_end": 5.0}
                result = self.run_program(program, "hydrostatic_column", settings)
                self.assertEqual(result.summary["conservation"]["mass"], 0)
                header, rows = result.rows()
                last = dict(zip((h.split(" ")[0] for h in header), map(float, rows[-1])))
                exchanged = last["kinetic_energy"] + last["internal_energy_gained"]
                self.assertGreater(last["displacement_max"], 0.02)
                self.assertLess(abs(last["energy_change"]), 1e-4 * exchanged)


if __name__ == "__main__":
    unittest.main()
