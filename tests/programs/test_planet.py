"""Planets under their own gravity: structure, particles that settle, what is conserved, ranks, restarts, wrong input."""

import json
import unittest

from running import BAD_INPUT, Case

SMALL = {"planet.particles": 1000, "expert.settle": 3, "time.t_end": 1000, "output.interval": 500}


class Planet(Case):
    def summary(self, settings=None, **how):
        return self.run_program("planet", "planet_earth", {**SMALL, **(settings or {})}, **how).summary

    def profile(self, settings=None):
        file = self.here / f"profile_{len(list(self.here.iterdir()))}.json"
        self.run_program("planet", "planet_earth", settings, options=["--profile", file])
        return json.loads(file.read_text())

    def test_profile(self):
        """An independent integration of the same planet, converged to 1e-6: its digits."""
        p = self.profile()
        for name, right in [("core_fraction", 0.490244), ("central_pressure", 4.732416e11), ("central_density", 15001.5),
                            ("contact_pressure", 1.09687e11), ("contact_density_below", 10402.0), ("contact_density_above", 4925.8)]:
            self.assertAlmostEqual(p[name] / right, 1.0, delta=1e-5)
        self.assertAlmostEqual(p["core_radius"] / p["radius"], 0.602813, delta=2e-6)
        self.assertEqual(p["r"][0], 0.0)
        self.assertEqual(sorted(p["r"]), p["r"])
        self.assertEqual({len(p[name]) for name in ("density", "pressure", "temperature", "mass_inside", "layer")}, {len(p["r"])})

    def test_settled(self):
        """At rest near the profile, and what is conserved is. A thousand particles are five shells: most are within two smoothing lengths of the contact or
        the surface, where summed densities mean over both sides (ssph)."""
        for scheme, error in (("disph", 0.06), ("ssph", 0.15)):
            with self.subTest(scheme):
                m = self.summary({"planet.scheme": scheme})["metrics"]
                self.assertLess(m["profile_density_error_at_interfaces"], error)
                self.assertLess(m["v_rms_over_v_escape"], 0.02)
                self.assertLess(abs(m["energy_drift"]), 1e-4)
                self.assertLess(m["momentum_drift"], 1e-6)
                self.assertLess(m["angular_momentum_drift"], 1e-5)
                self.assertLess(m["gravity_error_median"], 1e-4)
                self.assertLess(m["gravity_error_99"], 1e-3)

    def test_oscillation_keeps_the_energy(self):
        """A start that is not settled rings: kinetic energy comes from the others. The softening of gravity stays; one that followed the supports did work of
        its own, 2.5e-3 of the energy."""
        result = self.run_program("planet", "planet_earth", {**SMALL, "expert.settle": 0, "time.t_end": 600, "time.rtol": 1e-3, "output.interval": 0})
        header, rows = result.rows()
        at = [k for k, name in enumerate(header) if name.split(" ")[0] in ("kinetic_energy", "internal_energy", "potential_energy")]
        self.assertEqual(len(at), 3)
        energy = [sum(float(row[k]) for k in at) for row in rows]
        self.assertGreater(len(energy), 2)
        self.assertGreater(float(rows[-1][at[0]]), 1e-3 * abs(energy[0]))
        self.assertLess(max(abs(e / energy[0] - 1) for e in energy), 2e-5)

    def test_ranks_and_restart(self):
        short = {**SMALL, "planet.particles": 500, "time.t_end": 100, "expert.settle": 0.5}
        self.assert_exact("planet", "planet_earth", short, 2, layouts=((2, 1), (3, 2)))

    def test_a_snapshot_as_start(self):
        """It goes on without settling, and one that moves is not brought to rest unasked."""
        unsettled = {**SMALL, "planet.particles": 300, "expert.settle": 0, "time.t_end": 100, "output.interval": 0}
        first = self.run_program("planet", "planet_earth", unsettled)
        file = {"initial.file": sorted(first.directory.glob("snapshot_*.h5"))[-1]}
        again = self.run_program("planet", "planet_earth", {**unsettled, **file}).summary
        self.assertEqual(again["fluid_particles"], first.summary["fluid_particles"])
        self.assertLess(abs(again["metrics"]["energy_drift"]), 1e-4)
        self.assertGreater(again["metrics"]["v_rms_over_v_escape"], 0.0)
        moving = self.call("planet", *self.arguments("planet_earth", {**unsettled, **file, "expert.settle": 1}, self.here / "no"))
        self.assert_says(moving, BAD_INPUT, "what is settled starts at rest")

    def test_wrong_input(self):
        for settings, *words in [({"planet.radius": 2e7}, "&planet radius", "alone it would be smaller"),
                                 ({"planet.radius": 3e6}, "&planet radius", "alone it would be larger"),
                                 ({"layer.fraction": 0.3}, "&layer fraction", "follows from &planet radius"),
                                 ({"planet.mass": -1}, "&planet mass", "> 0"),
                                 ({"layer.tillotson": "cheese"}, "cheese"),
                                 ({"planet.temperature_law": "isothermal"}, "&planet temperature_exponent"),
                                 ({"planet.particles": 10}, "&planet particles")]:
            with self.subTest(settings):
                result = self.call("planet", *self.arguments("planet_earth", settings, self.here / "no"))
                self.assert_says(result, BAD_INPUT, *words)


if __name__ == "__main__":
    unittest.main()
