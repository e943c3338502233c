"""Thermal convection against published numbers, at few particles; ranks, threads, restarts, input."""

import cmath
import math
import shutil
import unittest

import h5py
import numpy as np

from running import BAD_INPUT, CALCULATION_FAILED, INPUTS, SLOW, Case, outcome

MANTLE, AIR, SIDE = "blankenbach_1a", "air_1e4", "air_from_the_side"
SHORT = {"time.steps": 60, "output.history_interval": 20}


def size(n):
    return {"domain.particles_x": n, "domain.particles_y": n}


class Convection(Case):
    runs = {}

    def steady(self):
        """The summary of case 1a at n = 16, run once for the tests that look at it."""
        if not self.runs:
            self.runs["1a"] = self.run_program("convection", MANTLE, {**size(16), "convection.steady_tolerance": 1e-3}).summary
        return self.runs["1a"]

    def test_eulers_steps_that_make_sound_grow(self):
        """note_air_1e6 past its t_end: with 24 a side it blows up at 17.5 s, after 12 e-foldings."""
        for end, more, warned in ((4.566, {}, False), (20, {}, True), (20, {"time.method": "ab2"}, False), (20, {"time.cfl": 0.05}, False)):
            with self.subTest(end=end, **more):
                said = self.run_program("convection", "note_air_1e6", {**size(24), "time.t_end": end, "time.steps": 1, **more}).stderr
                self.assertEqual("warning: with Euler's steps of 0.0019 s sound grows by a factor of e in 1.49 s" in said, warned, said)

    def test_blankenbach_1a(self):
        """Blankenbach et al. (1989): Nu 4.884409, v_rms 42.864947. At n = 16 within 1 %; at 24, 0.1 %."""
        s = self.steady()
        m = s["metrics"]
        self.assertTrue(m["steady"])
        self.assertAlmostEqual(m["nusselt_volume"] / 4.884409, 1, delta=0.01)
        self.assertAlmostEqual(m["v_rms"] / 42.864947, 1, delta=0.01)
        for measured in ["nusselt_top", "nusselt_bottom", "nusselt_dissipation"]:
            self.assertAlmostEqual(m[measured] / 4.884409, 1, delta=0.03)
        # Above the upwelling on the left the heat flux is large; where the downwelling leaves the top it is small.
        self.assertAlmostEqual(m["q1"] / 8.059384, 1, delta=0.04)
        self.assertAlmostEqual(m["q3"] / m["q1"], 1, delta=0.01)
        self.assertAlmostEqual(m["q4"] / m["q2"], 1, delta=0.05)
        for name in ["mass", "momentum", "energy"]:
            self.assertLess(abs(s["conservation"][name]), 3e-3, name)

    def test_onset(self):
        """Free slip, a cell as wide as high: disturbances grow as (s/Pr + K)(s + K) = Ra pi^2/K, K = 2 pi^2, in kappa/L^2; none below
        Ra = 8 pi^4 = 779.3 [Chandrasekhar, Hydrodynamic and Hydromagnetic Stability (1961), ch. II]."""
        K = 2 * math.pi**2
        settings = {**size(16 if SLOW else 12), "time.t_end": 1.5e17 if SLOW else 1e17, "convection.steady_tolerance": 0, "expert.xi": 4e12, "expert.zeta": 5,
                    "initial.perturbation": 1e-3}
        for Ra in [600, 1000]:
            result = self.run_program("convection", MANTLE, {**settings, "convection.rayleigh": Ra,
                                                             "convection.prandtl": 2.5e25 * 1e4 / Ra})
            header, rows = result.rows()
            t, v = header.index("time [s]"), header.index("v_rms [kappa/L]")
            rows = [(float(row[t]) * 1e-18, float(row[v])) for row in rows if float(row[t]) > 5e16]
            rate = math.log(rows[-1][1] / rows[0][1]) / (rows[-1][0] - rows[0][0])
            a = 1 / result.summary["metrics"]["prandtl_effective"]
            b, c = K * (1 + a), K * K - Ra * math.pi**2 / K
            with self.subTest(rayleigh=Ra):
                self.assertAlmostEqual(rate, (-b + math.sqrt(b * b - 4 * a * c)) / (2 * a), delta=0.3)

    def test_onset_between_plates(self):
        """Periodic sides, no slip: critical Ra 1707.76 at wave number 3.117/L [Chandrasekhar (1961), ch. II], where growth changes sign;
        here the box makes it pi, 1707.9 or so."""
        rates = []
        for Ra in [1600, 1800]:
            result = self.run_program("convection", "rayleigh_benard", {"domain.particles_x": 24, "domain.particles_y": 12, "convection.rayleigh": Ra,
                                                                        "convection.steady_tolerance": 0, "time.t_end": 300})
            header, rows = result.rows()
            t, v = header.index("time [s]"), header.index("v_rms [kappa/L]")
            rows = [(float(row[t]), float(row[v])) for row in rows if float(row[t]) > 150]
            rates.append(math.log(rows[-1][1] / rows[0][1]) / (rows[-1][0] - rows[0][0]))
        self.assertLess(rates[0], 0)
        self.assertGreater(rates[1], 0)
        self.assertAlmostEqual((1600 - 200 * rates[0] / (rates[1] - rates[0])) / 1707.8, 1, delta=0.02)

    @unittest.skipUnless(SLOW, "slow")
    def test_onset_between_plates_that_slip(self):
        """Periodic sides, free slip: with Pr = 1 disturbances grow as s = k (Ra/K)^(1/2) - K, K = pi^2 + k^2 [Chandrasekhar (1961), ch. II],
        once the other mode, exp(-2 K t), is gone: 657.54 for this box, 27 pi^4/4 = 657.51 at best."""
        k = 2 * math.pi / 2.8125
        K = math.pi**2 + k * k
        settings = {"domain.length_x": 0.28125, "domain.particles_x": 45, "domain.particles_y": 16, "walls.slip": "free_slip",
                    "convection.steady_tolerance": 0, "time.t_end": 600}
        for Ra in [624, 690]:
            result = self.run_program("convection", "rayleigh_benard", {**settings, "convection.rayleigh": Ra})
            header, rows = result.rows()
            t, v = header.index("time [s]"), header.index("v_rms [kappa/L]")
            rows = [(float(row[t]) * 1e-3, float(row[v])) for row in rows if float(row[t]) > 400]
            rate = math.log(rows[-1][1] / rows[0][1]) / (rows[-1][0] - rows[0][0])
            with self.subTest(rayleigh=Ra):
                critical = Ra * (K / (K + rate))**2
                self.assertAlmostEqual(critical / (K**3 / k**2), 1, delta=0.002)

    def test_nested_start(self):
        """Coarser lattices first: the same steady state as from the lattice itself, for fewer updates; levels are told apart in the history."""
        n = 24 if SLOW else 16
        settings = {**size(n), "convection.steady_tolerance": 2e-4}
        alone = self.run_program("convection", MANTLE, {**settings, "expert.levels": 0}).summary
        result = self.run_program("convection", MANTLE, {**settings, "expert.levels": 1})
        s = result.summary
        self.assertTrue(s["metrics"]["steady"])
        self.assertEqual((s["fluid_particles"], s["metrics"]["levels_left"]), (n * n, 0))
        for name, delta in [("nusselt_volume", 1e-3), ("nusselt_top", 1e-3), ("v_rms", 1e-3)]:
            self.assertAlmostEqual(s["metrics"][name] / alone["metrics"][name], 1, delta=delta)
        self.assertLess(s["particle_updates"], 0.8 * alone["particle_updates"])
        self.assertLess(abs(s["metrics"]["mean_density_drift"]), 1e-9)  # in a closed box, on a new lattice too
        header, rows = result.rows()
        times = [float(row[header.index("time [s]")]) for row in rows]
        self.assertEqual(times, sorted(times))

    def test_relaxed_viscous_response(self):
        """The steady state is that of a viscosity that answers at once, which zeta and xi given have; it is reached in fewer steps."""
        n, Ra = 16, 1e4
        c = Ra**(2 / 3) / 1.5  # kappa/L
        settings = {**size(n), "convection.steady_tolerance": 1e-3}
        relaxed = self.steady()
        xi = math.sqrt(relaxed["metrics"]["prandtl"] / (0.35 * c / n))
        zeta = relaxed["metrics"]["zeta"] * relaxed["metrics"]["xi"] / xi
        instant = self.run_program("convection", MANTLE, {**settings, "expert.xi": xi, "expert.zeta": zeta}).summary
        for s, response in [(relaxed, "relaxed"), (instant, "instant")]:
            self.assertTrue(s["metrics"]["steady"])
            self.assertEqual(s["metrics"]["viscous_response"], response)
        self.assertAlmostEqual(instant["metrics"]["sound_speed_effective"] / relaxed["metrics"]["sound_speed_effective"], 1, delta=1e-9)
        for name, delta in [("nusselt_volume", 5e-3), ("v_rms", 5e-3)]:
            self.assertAlmostEqual(relaxed["metrics"][name] / instant["metrics"][name], 1, delta=delta)
        self.assertGreater(relaxed["metrics"]["prandtl_effective"], 5 * instant["metrics"]["prandtl_effective"])
        self.assertLess(relaxed["rhs_evaluations"], instant["rhs_evaluations"])

    def test_heat_in_and_out(self):
        """Not compared where &sources heats: what it supplies need not leave. From inside, it is counted."""
        short = {**size(12), "time.steps": 2, "output.interval": 0}
        balance = lambda **more: self.run_program("convection", MANTLE, {**short, **more}).summary["metrics"]["heat_imbalance"]
        self.assertIsNone(balance(**{"sources.heating": "'1e-15'"}))
        without, inside = balance(), balance(**{"convection.heating": 1e-15})
        # H L^2/(kappa c_p dT) = 8e-4 of what goes through, 1: kappa 1e-6 m2/s, c_p 1250, L 1e6 m, dT 1000 K
        self.assertAlmostEqual(inside - without, 1e-15 * 1e12 / (1e-6 * 1250 * 1000), delta=1e-4)

    def test_heated_from_a_side(self):
        """Air in a square, hot at one side and cold at the other: Nu 1.118 at Ra 1e3, 4.519 at 1e5 [de Vahl Davis, Int. J. Numer. Methods Fluids
        3, 249 (1983)]; at infinite Prandtl number and Ra 1e4 2.27484, v_rms 11.676 (Chebyshev-Newton solution, orders 16 and 22 alike), here hot
        at the right. Errors fall with the spacing squared: 1.1 % at 16 and Ra 1e4."""
        mantle = {**size(16), "walls.slip": "no_slip", "walls.thermal_bottom": "adiabatic", "walls.thermal_top": "adiabatic",
                  "walls.thermal_left": "fixed", "walls.temperature_left": 0, "walls.thermal_right": "fixed", "walls.temperature_right": 1000,
                  "convection.steady_tolerance": 1e-3}
        cases = [(SIDE, {**size(16), "convection.rayleigh": 1e3, "time.t_end": 5000}, 1.118, 2.4164, 0.01), (MANTLE, mantle, 2.27484, 11.676, 0.02)]
        if SLOW:
            cases.append((SIDE, {**size(32), "convection.rayleigh": 1e5}, 4.519, 29.44, 0.01))
        for name, settings, nusselt, v_rms, delta in cases:
            with self.subTest(name, nusselt=nusselt):
                m = self.run_program("convection", name, settings).summary["metrics"]
                self.assertTrue(m["steady"])
                for measured in ("nusselt_left", "nusselt_right", "nusselt_volume"):
                    self.assertAlmostEqual(m[measured] / nusselt, 1, delta=delta, msg=measured)
                self.assertAlmostEqual(m["v_rms"] / v_rms, 1, delta=delta)
                self.assertAlmostEqual(m["nusselt_left"] / m["nusselt_right"], 1, delta=2e-3)
                self.assertLess(abs(m["heat_imbalance"]), 2e-3)
                self.assertEqual((m["nusselt_top"], m["nusselt_bottom"]), (0, 0))
                self.assertNotIn("nusselt_dissipation", m)

    def test_conduction_from_side_to_side(self):
        """Almost no flow: Nu 1 in boxes of any shape, in three dimensions too; heat is over the width, Ra over the height."""
        settings = {"convection.rayleigh": 0.01, "domain.length_x": 0.2, "initial.perturbation": 0, "time.steps": 10, "output.interval": 0}
        for more in ({**size(12), "domain.particles_x": 24}, {**size(8), "domain.particles_x": 16, "domain.dimension": 3, "domain.length_z": 0.15,
                                                              "domain.particles_z": 12}):
            m = self.run_program("convection", SIDE, {**settings, **more}).summary["metrics"]
            self.assertAlmostEqual(m["rayleigh"], 0.01, delta=1e-12)
            for measured in ("nusselt_left", "nusselt_right", "nusselt_volume"):
                self.assertAlmostEqual(m[measured], 1, delta=1e-5)

    def test_heat_through_sides_too(self):
        """Conduction from the bottom, and W/m^2 into the left and out of the right, over k DeltaT/L = 1e-3 W/m^2; of a box twice as wide as high
        these have half the area of the bottom."""
        settings = {**size(12), "domain.length_x": 0.2, "domain.particles_x": 24, "initial.perturbation": 0, "walls.thermal_left": "flux", "expert.flux_left": 2e-4, "walls.thermal_right": "flux",
                    "expert.flux_right": -5e-4, "time.steps": 2}
        m = self.run_program("convection", AIR, settings).summary["metrics"]
        self.assertAlmostEqual(m["nusselt_left"], 0.2, delta=1e-12)
        self.assertAlmostEqual(m["nusselt_right"], 0.5, delta=1e-12)
        bottom, top = m["nusselt_bottom"], m["nusselt_top"]
        left = bottom - top + 0.5 * (0.2 - 0.5)
        self.assertAlmostEqual(m["heat_imbalance"], left / (0.5 * (bottom + top + 0.5 * (0.2 + 0.5))), delta=1e-9)

    def test_heated_from_a_side_ranks_restart(self):
        self.assert_exact("convection", SIDE, {**size(16), "time.steps": 60}, 25, [(3, 1)])

    def test_heated_from_a_side_refusals(self):
        for settings, says in [({"walls.temperature_right": 1e-2}, ("temperature_left", "left and right hold 0.01 K both")),
                               ({"convection.gravity_density": "equation_of_state"}, ("gravity_density", "from side to side"))]:
            with self.subTest(**settings):
                result = self.run_program("convection", SIDE, settings, expect=BAD_INPUT)
                self.assert_says(result, BAD_INPUT, *says)
                self.assertFalse(result.directory.exists())

    def test_lid_in_convection(self):
        """A wall that moves faster than buoyancy makes the flow: slowed sound is faster than it, and the first step, of a layer at rest, is not too
        long for it."""
        settings = {**size(16), "expert.slip_top": "no_slip", "expert.velocity_top": 1e-9, "time.steps": 400, "output.interval": 0}
        m = self.run_program("convection", MANTLE, settings).summary["metrics"]
        self.assertLess(m["mach"], 0.5)
        self.assertGreater(m["v_rms"], 100)  # kappa/L; 43 without the lid

    def test_waves_of_shear(self):
        """A plate that slides above a layer at rest. What lacks to the linear profile, sines sin(n pi y/L), obeys v' = -nu k^2 z,
        z' = theta v' + (v - z)/lambda: waves of speed (nu (1 - theta)/lambda)^(1/2), where an instant response would diffuse."""
        Ra, n, U = 600, 24, 1.0  # kappa/L; no convection: below 1708
        c = Ra**(2 / 3) / 1.5
        shear = 0.7 * c
        relaxation, at_once = 1 / (math.sqrt(2) * math.pi * shear), max(0.35 * c / n, 1)
        nu = relaxation * shear**2 + at_once
        theta = at_once / nu
        settings = {**size(n), "domain.periodic_x": ".true.", "walls.slip": "no_slip", "expert.velocity_top": U * 1e-12, "initial.perturbation": 0,
                    "convection.rayleigh": Ra, "convection.steady_tolerance": 0, "time.t_end": 8e16, "output.history_interval": 2}
        result = self.run_program("convection", MANTLE, settings)
        self.assertAlmostEqual(result.summary["metrics"]["prandtl_effective"] / nu, 1, delta=1e-9)
        header, rows = result.rows()
        t_at, v_at = header.index("time [s]"), header.index("v_rms [kappa/L]")

        def rms(t):
            square = U * U / 3
            for m in range(1, 200):
                k = m * math.pi
                b = 2 * U / k * (-1)**m  # of -U y/L
                # v' = -nu k^2 z, z' = v/relaxation - (1/relaxation + theta nu k^2) z
                p, q = 1 / relaxation + theta * nu * k * k, nu * k * k / relaxation
                root = cmath.sqrt(p * p / 4 - q)
                s1, s2 = -p / 2 + root, -p / 2 - root
                slope = -nu * k * k * b
                A = (slope - s2 * b) / (s1 - s2)
                a = (A * cmath.exp(s1 * t) + (b - A) * cmath.exp(s2 * t)).real
                square += a * a / 2 - 2 * a * U * (-1)**m / k  # with U y/L, whose sines are -b
            return math.sqrt(square)

        compared = [(float(row[v_at]), rms(float(row[t_at]) * 1e-18)) for row in rows if float(row[t_at]) > 1e16]
        self.assertGreater(len(compared), 10)
        self.assertGreater(max(exact for _, exact in compared), 1.02 * U / math.sqrt(3))  # it swings past the profile at rest
        for found, exact in compared:
            self.assertAlmostEqual(found / exact, 1, delta=0.02)

    def test_levels_are_chosen(self):
        """As many as resolve the flow, where the steady state is the aim."""
        for settings, levels in [(size(24), 1), (size(22), 0), (size(48), 2), (size(100), 2), (size(46), 1), (size(49), 0),
                                 ({**size(48), "convection.steady_tolerance": 0}, 0), ({**size(48), "expert.levels": 0}, 0),
                                 ({**size(48), "convection.target": "'transient'"}, 0),
                                 ({**size(100), "convection.rayleigh": 1e6}, 1)]:
            with self.subTest(settings):
                s = self.run_program("convection", MANTLE, {**settings, "time.steps": 1}).summary
                self.assertEqual(s["metrics"]["levels_left"], levels)

    def test_nested_start_ranks_restart(self):
        """Restarts before a level has gone over to the next, and after. Any flow is known to such a tolerance, once there is a swing, 1.75 turnovers."""
        loose = {"convection.steady_tolerance": 1, "run.checkpoint_interval": 100}
        walls = ("walls", {**size(40 if SLOW else 20), "expert.levels": 2 if SLOW else 1, "time.steps": 1800 if SLOW else 1200}, [200, 900 if SLOW else 400])
        periodic = ("periodic", {**size(20), "expert.levels": 1, "convection.rayleigh": 1e5, "convection.viscosity_ramp": 2e16, "domain.periodic_x": ".true.",
                                 "walls.slip": "no_slip", "time.method": "ab2", "time.steps": 9400}, [2000, 5000])
        for name, settings, parts in [walls, periodic] if SLOW else [walls]:
            with self.subTest(name):
                settings = {**settings, **loose}
                whole = self.run_program("convection", MANTLE, settings).summary
                self.assertEqual((whole["fluid_particles"], whole["metrics"]["levels_left"]), (settings["domain.particles_x"]**2, 0))
                if SLOW:
                    s = self.run_program("convection", MANTLE, settings, ranks=3).summary
                    self.assertEqual(outcome(s), outcome(whole))
                left = []
                for steps, ranks in zip(parts, (3, 2)):
                    part = self.run_program("convection", MANTLE, {**settings, "time.steps": steps}, output=f"part_{name}_{steps}").summary
                    left.append(part["metrics"]["levels_left"])
                    s = self.run_program("convection", MANTLE, settings, output=f"part_{name}_{steps}", options=["--restart", "latest"], ranks=ranks).summary
                    self.assertEqual(outcome(s), outcome(whole))
                self.assertEqual(left, [settings["expert.levels"], 0])

    def test_contrast_of_viscosity(self):
        """Case 2a's law at full contrast from the start: the first plume reaches the lid, and temperatures stay between those of the walls
        (nearly: nothing cuts them off)."""
        result = self.run_program("convection", "blankenbach_2a", {**size(24), "convection.viscosity_ramp": 0, "time.t_end": 2e15})
        self.assertEqual(result.summary["metrics"]["viscous_response"], "instant")  # without inertia it blows up within 30 steps
        self.assertGreater(result.summary["metrics"]["v_rms"], 50)
        self.assertGreater(result.summary["metrics"]["nusselt_bottom"], 5)
        with h5py.File(sorted(result.directory.glob("snapshot_*.h5"))[-1]) as file:
            T = file["PartType0/Temperature"][:]
        self.assertLess(T.max(), 1050)
        self.assertGreater(T.min(), -50)

    def test_viscosity_by_a_table(self):
        """A table of case 2a's exponential, in which ln nu is linear, is that law."""
        table = self.here / "viscosity.txt"
        table.write_text("temperature depth viscosity\n" + "".join(
            f"{T} {depth} {1e23 * 1000 ** (-T / 1000)!r}\n" for T in [-1000, 200, 600, 2000] for depth in [-1e6, 3e5, 2e6]))
        settings = {**SHORT, **size(16)}
        law = self.run_program("convection", "blankenbach_2a", settings)
        other = self.run_program("convection", "blankenbach_2a", {**settings, "convection.viscosity_law": "table", "convection.viscosity_file": f"'{table}'"})
        self.assertGreater(law.summary["metrics"]["v_rms"], 1)
        self.assertEqual(other.summary["metrics"]["outside_viscosity_table"], 0)
        for a, b in zip(law.rows()[1][-1], other.rows()[1][-1]):
            self.assertAlmostEqual(float(a), float(b), delta=1e-8 * abs(float(a)) + 1e-9)
        table.write_text(table.read_text().replace("2000 2000000.0", "2000 1000000.0"))
        wrong = self.run_program("convection", "blankenbach_2a", {"convection.viscosity_law": "table", "convection.viscosity_file": f"'{table}'"}, expect=BAD_INPUT)
        self.assertIn(":13: the table is not rectangular", wrong.stderr)
        table.write_text("0 0 1e23\n900 0 1e20\n")
        wrong = self.run_program("convection", "blankenbach_2a", {"convection.viscosity_law": "table", "convection.viscosity_file": f"'{table}'"}, expect=BAD_INPUT)
        self.assertIn("the layer has 1000 K", wrong.stderr)

    def test_viscosity_by_melt_fraction(self):
        """Between its limits, low where it is hot, and felt by the flow."""
        result = self.run_program("convection", "melting_layer", {**SHORT, **size(16), "convection.viscosity_ramp": 0})
        self.assertGreater(result.summary["metrics"]["v_rms"], 0.1)
        with h5py.File(sorted(result.directory.glob("snapshot_*.h5"))[-1]) as file:
            eta, T = file["PartType0/Viscosity"][:], file["PartType0/Temperature"][:]
        self.assertAlmostEqual(eta.min() / 3e18, 1, delta=1e-6)
        self.assertLess(eta.max(), 2.5e20)  # 3.8e9 exp(3.5e5/(R T)) at 1700 K: 2.2e20
        self.assertGreater(eta[T < 1720].min(), 1e20)
        self.assertLess(eta[T > 2070].max(), 4e18)
        wrong = self.run_program("convection", "melting_layer", {"convection.viscosity_max": 1e18}, expect=BAD_INPUT)
        self.assertIn("is below viscosity_min", wrong.stderr)

    @unittest.skipUnless(SLOW, "slow")
    def test_contrast_with_depth(self):
        """Case 2b's law: on this coarse lattice ν changes thirtyfold from one particle to the next. The flow lasts until the contrast is full and
        longer, with temperatures nearly between those of the walls (with ν_ij = (ν_i ν_j)^½ it blows up on the way)."""
        result = self.run_program("convection", "blankenbach_2b", {"domain.particles_x": 60, "domain.particles_y": 24, "expert.levels": 0,
                                                                   "convection.viscosity_ramp": 2e16, "time.t_end": 2.2e16})
        self.assertGreater(result.summary["metrics"]["v_rms"], 50)
        self.assertLess(result.summary["metrics"]["v_rms"], 300)
        with h5py.File(sorted(result.directory.glob("snapshot_*.h5"))[-1]) as file:
            T = file["PartType0/Temperature"][:]
        self.assertLess(T.max(), 1050)
        self.assertGreater(T.min(), -50)

    @unittest.skipUnless(SLOW, "slow")
    def test_contrast_that_lasts(self):
        """A law that is steep within a spacing, at walls too, long past the time when the contrast is full: no particle is thrown about."""
        result = self.run_program("convection", "melting_layer", {"time.t_end": 1.5e15})
        header, rows = result.rows()
        t, v, heat = (header.index(name) for name in ["time [s]", "v_rms [kappa/L]", "nusselt_top [1]"])
        late = [row for row in rows if float(row[t]) > 1.2e15]
        self.assertGreater(len(late), 10)
        for row in late:
            self.assertAlmostEqual(float(row[v]), 88, delta=5)
            self.assertAlmostEqual(float(row[heat]), 5.2, delta=0.8)

    def test_heat_of_friction(self):
        """Buoyancy's work, Di (Nu - 1) in units of conducted heat, ends as friction [Jarvis & McKenzie, J. Fluid Mech. 96, 515 (1980)]: so much
        more heat leaves at the top than enters at the bottom."""
        Di = 2.5e-5 * 10 * 1e6 / 1250
        settings = {**size(16), "convection.steady_tolerance": 1e-3, "convection.viscous_heating": ".true."}
        m = self.run_program("convection", MANTLE, settings).summary["metrics"]
        self.assertAlmostEqual(m["nusselt_top"] - m["nusselt_bottom"], Di * (m["nusselt_dissipation"] - 1), delta=0.1)
        self.assertGreater(m["nusselt_top"], m["nusselt_bottom"] + 0.3)

    def test_ranks_threads_restart(self):
        contrast = {"convection.viscosity_ramp": 1e16, "convection.viscosity_law": "blankenbach_2a"}
        deep = {**size(10), "domain.dimension": 3, "domain.length_z": 1e6, "domain.particles_z": 10}
        cases = [(MANTLE, {}), (MANTLE, {"convection.gravity_density": "separated"}), (MANTLE, contrast), (MANTLE, {"time.method": "ab2", **contrast}),
                 (MANTLE, {"time.method": "rkl2", **contrast}), (MANTLE, {**contrast, **deep}), (AIR, {}), (AIR, {"domain.periodic_x": ".true."})]
        for case, (name, more) in enumerate(cases):
            with self.subTest(name, **more):
                settings = {**SHORT, **size(20), "initial.perturbation": 0.2, **more}
                whole = self.assert_exact("convection", name, settings, 40, [(2, 1), (3, 1), (None, 2)] if SLOW else [(3, 1), (None, 2)] if case == 0 else [])
                self.assertGreater(whole["metrics"]["v_rms"], 1)

    def test_random_temperatures_of_the_start(self):
        """T = T_conductive + b DeltaT r: r between -1 and 1 with the mean 0 and the square's 1/3, each its particle's; the same on any ranks,
        others with another seed. The means of 576 numbers are within four of their deviations."""
        start = {**size(24), "initial.perturbation": 0, "initial.temperature_noise": 0.1, "time.steps": 0, "convection.levels": 0}
        found = []
        for how in ({}, {"ranks": 3}, {"seed": 2}):
            seed = {"initial.noise_seed": how.pop("seed")} if "seed" in how else {}
            run = self.run_program("convection", "blankenbach_1a", {**start, **seed}, **how)
            with h5py.File(run.directory / "snapshot_0000.h5") as file:
                order = np.argsort(file["PartType0/ParticleIDs"][:])
                y, T = file["PartType0/Coordinates"][:][order, 1], file["PartType0/Temperature"][:][order]
            found.append((T - 1000 * (1 - y / 1e6)) / 100)
        np.testing.assert_array_equal(found[0], found[1])
        self.assertGreater(np.abs(found[0] - found[2]).max(), 0.5)
        for r in found:
            self.assertLess(np.abs(r).max(), 1)
            self.assertLess(abs(r.mean()), 4 * math.sqrt(1 / 3 / 576))
            self.assertLess(abs((r**2).mean() - 1 / 3), 4 * math.sqrt(4 / 45 / 576))
        self.assert_exact("convection", "blankenbach_1a", {**SHORT, **size(12), "initial.temperature_noise": 0.1}, 25, [(2, 1)])

    def test_restart_with_another_method(self):
        """&time may change: what lags goes with the method, and 'ab2' begins with a step of order 2."""
        methods = ["rk4", "ab2", "rkl2", "adaptive", "euler"]
        settings = {**size(10), "initial.perturbation": 0.2, "time.dt": 1e12, "output.history_interval": 10}
        for first in methods:
            part = {**settings, "time.method": first, "time.steps": 20, "run.checkpoint_interval": 20}
            self.run_program("convection", MANTLE, part, output=first)
            for second in methods:
                with self.subTest(f"{first}, then {second}"):
                    directory = self.here / f"{first}_{second}"
                    shutil.copytree(self.here / first, directory)
                    then = {**settings, "time.method": second, "time.steps": 40}
                    s = self.run_program("convection", MANTLE, then, output=directory.name, options=["--restart", "latest"]).summary
                    self.assertEqual((s["status"], s["steps"]), ("completed", 40))
                    if first == second:
                        whole = self.run_program("convection", MANTLE, then).summary
                        self.assertEqual(outcome(s), outcome(whole))

    def test_restart_with_other_keys_of_time_in_expert(self):
        settings = {**size(10), "time.method": "rkl2", "time.t_end": 1e17, "time.steps": 4, "run.checkpoint_interval": 4}
        self.run_program("convection", MANTLE, settings, output="part")
        changed = {**settings, "time.steps": 8, "time.error_control": ".false.", "time.diffusive": 1e5, "expert.time_order": 4}
        s = self.run_program("convection", MANTLE, changed, output="part", options=["--restart", "latest"]).summary
        self.assertEqual(s["steps"], 8)

    def test_restart_over_a_method_that_keeps_less(self):
        """What the first run kept of the step before was given up by the second: the third starts from nothing, not from zeros."""
        settings = {**size(10), "initial.perturbation": 0.2, "time.dt": 1e12, "time.error_control": ".false.", "output.history_interval": 1, "run.checkpoint_interval": 1}
        for method in ["ab2", "rkl2"]:
            with self.subTest(method):
                for steps, now, options in [(20, method, []), (21, "rk4", ["--restart", "latest"]), (22, method, ["--restart", "latest"])]:
                    s = self.run_program("convection", MANTLE, {**settings, "time.method": now, "time.steps": steps}, output=f"over_{method}", options=options).summary
                small = self.run_program("convection", MANTLE, {**settings, "time.method": "rk4", "time.steps": 22}).summary
                self.assertAlmostEqual(s["metrics"]["v_rms"] / small["metrics"]["v_rms"], 1, delta=1e-3)

    def test_numbers_keep_each_other(self):
        for given, kept in [("rayleigh", "prandtl"), ("prandtl", "rayleigh")]:
            for name in (AIR, MANTLE):
                with self.subTest(name, given=given):
                    settings = {**size(12), "time.steps": 1}
                    before = self.run_program("convection", name, {**settings, "convection.steady_tolerance": 0}).summary["metrics"]
                    after = self.run_program("convection", name, {**settings, "convection.steady_tolerance": 0,
                                                                  f"convection.{given}": 3 * before[given]}).summary["metrics"]
                    self.assertAlmostEqual(after[given] / before[given], 3, delta=1e-9)
                    self.assertAlmostEqual(after[kept] / before[kept], 1, delta=1e-9)

    def test_heat_through_a_wall_of_given_flux(self):
        """It is what was given: 0.01 W/m2 beside k DeltaT/L = 0.005 W/m2 of conduction."""
        s = self.run_program("convection", MANTLE, {**size(12), "time.steps": 3, "walls.thermal_bottom": "flux", "expert.flux_bottom": 0.01})
        self.assertAlmostEqual(s.summary["metrics"]["nusselt_bottom"], 2, delta=1e-9)
        self.assertNotIn("nan", (s.directory / "history.csv").read_text())

    def test_three_dimensions(self):
        """A roll in a thin periodic box is the two-dimensional flow."""
        settings = {**SHORT, **size(10), "initial.perturbation": 0.2}
        flat = self.run_program("convection", MANTLE, settings).summary["metrics"]
        deep = self.run_program("convection", MANTLE, {**settings, "domain.dimension": 3, "domain.length_z": 1e6,
                                                       "domain.particles_z": 10, "domain.periodic_z": ".true."}).summary["metrics"]
        for name in ["nusselt_volume", "v_rms", "nusselt_top"]:
            self.assertAlmostEqual(deep[name] / flat[name], 1, delta=0.03)

    def test_choices(self):
        """Each choice changes the run, and runs."""
        settings = {**SHORT, **size(12), "initial.perturbation": 0.2}
        hashes = {"as it is": self.run_program("convection", MANTLE, settings).summary["state_hash"]}
        law = {"convection.viscosity_law": "exponential", "expert.temperature_exponent": 1.0}
        for change in [{"expert.shifting": 0.5}, {"expert.pressure_diffusion": 0.1}, {"expert.remap_diffusion": 0.1}, {"expert.steady_mach": 0.5},
                       {"convection.gravity_density": "separated"}, {"convection.gravity_density": "conventional", "expert.steady_mach": 0.3},
                       {"convection.heating": 1e-11}, {"convection.viscous_heating": ".true."}, {"convection.adiabatic_heating": ".true."},
                       law, {**law, "expert.depth_exponent": 1.0}, {"convection.viscosity_ramp": 1e18}, {"convection.target": "transient"},
                       {"expert.slip_top": "no_slip"}, {"expert.thermal_right": "flux", "expert.flux_right": 0.01}, {"expert.slip_top": "no_slip", "expert.velocity_top": 1e-11},
                       {"domain.periodic_x": ".true."}, {"time.method": "ssp_rk3"}, {"time.method": "rkc2"}]:
            with self.subTest(**change):
                s = self.run_program("convection", MANTLE, {**settings, **change}).summary
                hashes[str(change)] = s["state_hash"]
        self.assertEqual(len(set(hashes.values())), len(hashes))

    def test_wrong_input(self):
        for key, value, word in [("domain.periodic_y", ".true.", "periodic_y"), ("walls.temperature_bottom", -1, "temperature_bottom"),
                                 ("convection.rayleigh", -1, "rayleigh"), ("expert.temperature_exponent", 1, "viscosity_law"),
                                 ("expert.levels", 7, "levels")]:
            with self.subTest(key):
                result = self.run_program("convection", MANTLE, {key: value}, expect=BAD_INPUT)
                self.assertIn(word, result.stderr)
                self.assertFalse(result.directory.exists())

    def test_keys_that_have_moved_or_gone(self):
        """A key of &expert is taken in its own group too; what is settled is no key."""
        for key in ("convection.levels=1", "walls.velocity_top=1e-9"):
            self.assertEqual(self.call("convection", INPUTS / f"{MANTLE}.nml", "--set", key, "--check").status, 0)
        for key, says in [("convection.zeta=3", "unknown key zeta"), ("convection.zeta=3", "&expert has a key of this name"), ("convection.lagging=step", "unknown key lagging")]:
            with self.subTest(key):
                self.assert_says(self.call("convection", INPUTS / f"{MANTLE}.nml", "--set", key, "--check"), BAD_INPUT, f"--set {key}: ", says)

    def test_what_is_shown(self):
        """&expert stands last and says where its keys belong."""
        expert = self.call("convection", "--describe").stdout.split("&expert\n")[1]
        self.assertNotIn("\n&", expert)
        self.assertIn("! of &walls: ", expert)

    def test_viscosity_that_falls(self):
        """A tenth of the Rayleigh number at first: the roll is slower; once the viscosity is there, the steady state is that of the input."""
        settings = {**size(16), "convection.steady_tolerance": 1e-3, "convection.viscosity_ramp": 1e17}
        result = self.run_program("convection", MANTLE, settings)
        header, rows = result.rows()
        t, v = header.index("time [s]"), header.index("v_rms [kappa/L]")
        self.assertLess(max(float(row[v]) for row in rows if float(row[t]) < 2e16), 20)
        m = result.summary["metrics"]
        self.assertTrue(m["steady"])
        self.assertAlmostEqual(m["nusselt_volume"] / 4.884409, 1, delta=0.01)
        self.assertAlmostEqual(m["v_rms"] / 42.864947, 1, delta=0.01)

    def test_levels_need_a_steady_aim(self):
        result = self.run_program("convection", MANTLE, {"expert.levels": 1, "convection.steady_tolerance": 0}, expect=BAD_INPUT)
        self.assertIn("levels", result.stderr)

    def test_too_large_a_step_is_told(self):
        result = self.run_program("convection", MANTLE, {**size(12), "time.dt": 1e16}, expect=CALCULATION_FAILED)
        self.assertIn("above the", result.stderr)


class EquationOfState(Case):
    """Gravity feels the density of an equation of state; what rises cools."""

    def test_linear_is_the_separated_density(self):
        same = {**size(12), **SHORT, "convection.eos": "linear", "convection.p_top": 0, "expert.eos_dynamic_pressure": "T"}
        one = self.run_program("convection", "super_earth", same).rows()[1][-1]
        boussinesq = (self.here / "separated.nml")
        boussinesq.write_text("".join(line for line in (INPUTS / "super_earth.nml").read_text().splitlines(True) if "eos" not in line))
        other = self.run_program("convection", boussinesq, {**size(12), **SHORT, "convection.gravity_density": "separated"}).rows()[1][-1]
        self.assertGreater(float(one[6]), 1)  # it flows
        for a, b in zip(map(float, one[:10]), map(float, other[:10])):
            self.assertAlmostEqual(a, b, delta=1e-6 * abs(b) + 1e-12)

    def test_conduction_stays_at_rest(self):
        s = self.run_program("convection", "super_earth", {**size(12), **SHORT, "initial.perturbation": 0}).summary
        self.assertLess(s["metrics"]["v_rms"], 1e-6)
        self.assertAlmostEqual(s["metrics"]["nusselt_top"], 1, delta=1e-6)

    @unittest.skipUnless(SLOW, "slow")
    def test_compression_weakens_convection(self):
        nusselt = {}
        for heated, n in [("F", 16), ("T", 16)]:
            m = self.run_program("convection", "super_earth", {**size(n), "convection.adiabatic_heating": heated,
                                                               "convection.viscous_heating": heated}).summary["metrics"]
            nusselt[heated] = 0.5 * (m["nusselt_top"] + m["nusselt_bottom"])
            self.assertTrue(m["steady"])
        # Friction takes the work of buoyancy, and what comes in goes out: the budgets close as n grows.
        self.assertLess(abs(m["work_imbalance"]), 0.03)
        self.assertLess(abs(m["heat_imbalance"]), 0.03)
        self.assertLess(nusselt["T"], 0.5 * nusselt["F"])

    def test_refusals(self):
        cold = self.call("convection", *self.arguments("super_earth", {"walls.temperature_top": 0}, "cold"))
        self.assert_says(cold, BAD_INPUT, "0 K")
        self.assert_says(self.call("convection", *self.arguments(MANTLE, {"convection.eos": "liquid_iron"}, "eos")), BAD_INPUT,
                         "equation_of_state")


if __name__ == "__main__":
    unittest.main()
