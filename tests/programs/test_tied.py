"""The notes' programs with density or Y tied to the particles' places [docs/theory/consistency.md]: the overturn to its end, energy, growth."""

import unittest

from running import BAD_INPUT, SLOW, Case

NOTE, LINEAR = "rti_note", "rti_linear"
TIED = {"volume.consistency": "tied", "walls.treatment": "mirror"}


def box(n, viscosity, **others):
    return {"domain.particles_x": n, "domain.particles_y": n, "rti.viscosity_upper": viscosity, "rti.viscosity_lower": viscosity, **others}


class Tied(Case):
    def metrics(self, program, settings, name=NOTE):
        summary = self.run_program(program, name, settings).summary
        self.assertEqual(summary["status"], "completed", summary["message"])
        return summary["metrics"]

    def test_overturn(self):
        """The input as it is, n = 24, to the end: what stops these programs otherwise (p <= 0, Y <= 0, a density that runs away) does not.
        The falls are those of rti in the same box to the resolution's error."""
        settings = box(24, 6e11, **{"time.t_end": 3000})
        falls = [f"time_of_fall_{fall}" for fall in ("0.1", "0.2")]
        expected = self.metrics("rti", settings)
        for program in ("disph_c", "disph_e", "disph_f", "disph_y") if SLOW else ("disph_c", "disph_f"):
            with self.subTest(program):
                m = self.metrics(program, settings)
                self.assertEqual(m["particles_put_back"], 0)
                self.assertGreater(m["density_ratio_min"], 0.85)
                self.assertLess(m["density_ratio_max"], 1.25)
                self.assertLess(m["energy_residual_max"], 0.02)
                for fall in falls:
                    self.assertLess(abs(m[fall] / expected[fall] - 1), 0.03, fall)

    def test_energy_closes(self):
        """Each gradient with the continuity whose work it does: pattern 1 with the particle's own volume, pattern 2 with the neighbour's.
        Without relaxation what is left is what program N has, whose force is the slope of an energy: the walls' weight at n = 24, 1.8e-3."""
        settings = box(24, 6e11, **{"time.t_end": 1800, "volume.rate": 0})
        of_n = self.metrics("disph_n", settings | {"volume.rate": 0.005})["energy_residual_max"]
        self.assertLess(of_n, 2e-3)
        for program in ("disph_e", "disph_f", "disph_f2"):
            with self.subTest(program):
                self.assertLess(self.metrics(program, settings)["energy_residual_max"], 1.05 * of_n)

    def test_f_is_n(self):
        """Program F, tied, is the number density as a differential equation."""
        settings = box(24, 6e11, **{"time.t_end": 2200})
        f, n = self.metrics("disph_f", settings), self.metrics("disph_n", settings)
        for fall in ("time_of_fall_0.1", "time_of_fall_0.2"):
            self.assertLess(abs(f[fall] / n[fall] - 1), 2e-3, fall)

    def test_c_is_y(self):
        """The same density, from Y = m p/rho: the same run but for the error of time integration."""
        settings = box(20, 6e11, **{"time.t_end": 600, "output.interval": 0})
        c, y = self.metrics("disph_c", settings), self.metrics("disph_y", settings)
        self.assertLess(abs(c["metal_centroid"] / y["metal_centroid"] - 1), 1e-6)
        self.assertLess(abs(c["v_rms"] / y["v_rms"] - 1), 1e-4)

    def test_growth(self):
        """n = 48: 0.19 % fast, in proportion to the spacing squared; untied 0.07 (C) and 0.13 (F)."""
        settings = {"domain.particles_x": 48, "domain.particles_y": 48, "kernel.name": "wendland_c6", "rti.p_top": 1e10, "time.t_end": 1400}
        for program in ("disph_c", "disph_f"):
            with self.subTest(program):
                m = self.metrics(program, {**settings, **TIED}, LINEAR)
                self.assertLess(abs(m["growth_rate"] / m["growth_rate_theory"] - 1), 0.003)

    def test_viscosities_that_differ(self):
        """Thin metal over thick silicate, 1 : 100, n = 32: the symmetric stress grows as theory says (measured: 0.6 %), the notes' sum does not
        (23 %)."""
        settings = {**box(32, 2e10), **TIED, "rti.viscosity_lower": 2e12, "kernel.name": "wendland_c6", "rti.p_top": 1e10, "output.interval": 0}
        for program in ("disph_c", "disph_f2", "disph_n", "disph_y") if SLOW else ("disph_f",):
            m = self.metrics(program, settings, LINEAR)
            self.assertAlmostEqual(m["growth_rate"] / m["growth_rate_theory"], 1, delta=0.01)
        m = self.metrics("disph_f", {**settings, "viscosity.stress": "laplacian"}, LINEAR)
        self.assertGreater(m["growth_rate"] / m["growth_rate_theory"], 1.1)

    def test_ranks_and_restart(self):
        for program, treatment in [("disph_y", "virtual_marker"), ("disph_c", "mirror"), ("disph_e", "virtual_marker")]:
            with self.subTest(program, walls=treatment):
                settings = box(20, 1e11, **{"walls.treatment": treatment, "time.steps": 24, "output.interval": 0})
                one = self.run_program(program, NOTE, settings, f"{program}_one").summary["state_hash"]
                self.run_program(program, NOTE, {**settings, "time.steps": 11}, f"{program}_part", ranks=3)
                again = self.run_program(program, NOTE, settings, f"{program}_part", ["--restart", "latest"], ranks=2)
                self.assertEqual(again.summary["state_hash"], one)

    def test_what_there_is_nothing_to_tie_of(self):
        result = self.run_program("disph_n", NOTE, {**box(12, 6e11), "time.steps": 1})
        self.assertIn("there is nothing to tie", (result.directory / "run.log").read_text())
        for program, name in [("disph_c", NOTE), ("disph_f", "hydrostatic_13")]:
            refused = self.call(program, *self.arguments(name, {"volume.consistency": "none", "volume.rate": 0.1}, self.here / "none"))
            self.assert_says(refused, BAD_INPUT, "rate: belongs to consistency = 'tied'")


if __name__ == "__main__":
    unittest.main()
