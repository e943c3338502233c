"""Gas with contacts and shocks: errors against exact solutions, conservation, ranks, restarts."""

import math
import unittest

import h5py
from running import BAD_INPUT, INPUTS, INTERRUPTED, SLOW, Case

SCHEMES = ["ssph", "disph", "gsph", "gdisph", "remix"]
DOUBLE = {"kernel.precision": "double"}  # where nothing but its rounding may be left
# Other gradients, forces and dissipation of the schemes of summed densities.
PRICE, INTEGRAL = {"shock.conductivity": 1}, {"shock.gradients": "integral"}
FORMS = {"ssph, conductivity": {"shock.scheme": "ssph", **PRICE}, "ssph, integral": {"shock.scheme": "ssph", **INTEGRAL},
         "gdf": {"shock.scheme": "gdf"}, "gdf, integral, conductivity": {"shock.scheme": "gdf", **INTEGRAL, **PRICE}}


PROFILE = {"domain.particles_x": 100, "output.interval": 0, "output.history_interval": 1}


class Shock(Case):
    def summary(self, name, settings=None, **how):
        return self.run_program("shock", name, settings or {}, **how).summary

    def test_star_states(self):
        """Toro (2009), tables 4.1 and 4.2, in the digits printed there."""
        for settings, p, u in [({}, 0.30313, 0.92745),
                               ({"shock.rho_r": 1, "shock.u_l": -2, "shock.u_r": 2, "shock.p_l": 0.4, "shock.p_r": 0.4}, 0.00189, 0.0),
                               ({"shock.rho_r": 1, "shock.p_l": 1000, "shock.p_r": 0.01}, 460.894, 19.5975)]:
            m = self.summary("sod", {**settings, "time.steps": 0})["metrics"]
            for got, want in [(m["p_star"], p), (m["u_star"], u)]:
                self.assertAlmostEqual(got, want, delta=0.5 * 10 ** -len(f"{want}".split(".")[1]))

    def test_sod(self):
        """A wave that is a spacing or two wrong: errors are of the order of the support, 2 % of the box, times the jumps."""
        for scheme in SCHEMES:
            with self.subTest(scheme):
                s = self.summary("sod", {"shock.scheme": scheme, "domain.particles_x": 200})
                self.assertLess(s["errors"]["density_l1"], 0.02)
                self.assertLess(s["errors"]["pressure_l1"], 0.02)
                self.assertLess(abs(s["conservation"]["energy"]), 1e-4)

    def test_thin_and_dense_gas(self):
        """What single precision does not hold is computed in double by itself: the same errors, whatever the unit of mass."""
        few = {"domain.particles_x": 48, "output.interval": 0}
        for scheme in ["ssph", "disph", "gsph", "gdisph"]:
            right = self.summary("sod", {**few, "shock.scheme": scheme})["errors"]
            for unit in (1e-22, 1e-8, 1e8, 1e25):
                with self.subTest(scheme, unit=unit):
                    gas = {f"shock.{name}": value * unit for name, value in (("rho_l", 1.0), ("rho_r", 0.125), ("p_l", 1.0), ("p_r", 0.1))}
                    errors = self.summary("sod", {**few, "shock.scheme": scheme, **gas})["errors"]
                    self.assertAlmostEqual(errors["velocity_l1"] / right["velocity_l1"], 1.0, delta=1e-3)
                    self.assertAlmostEqual(errors["density_l1"] / unit / right["density_l1"], 1.0, delta=1e-3)
        thin = {**few, **gas, "kernel.precision": "single"}
        result = self.call("shock", *self.arguments("sod", thin, self.here / "no"))
        self.assert_says(result, BAD_INPUT, "&kernel precision", "expected 'double'")

    def test_gas_that_cannot_carry_what_lies_above(self):
        result = self.call("shock", *self.arguments("rayleigh_taylor", {"domain.particles_x": 16, "shock.gravity": 1e3}, self.here / "no"))
        self.assert_says(result, BAD_INPUT, "&shock test", "the gas would start with p = -", "both must be above 0")

    def test_momentum(self):
        """Round-off, where no walls are."""
        for scheme in SCHEMES:
            with self.subTest(scheme):
                s = self.summary("sod", {"shock.scheme": scheme, "domain.particles_x": 100, "domain.periodic_x": "T", **DOUBLE})
                self.assertLess(s["conservation"]["momentum"], 1e-13)

    def test_two_dimensions(self):
        flat = {"domain.dimension": 2, "domain.particles_x": 120, "domain.particles_y": 12, "domain.periodic_y": "T",
                "kernel.skin": 0.5, "time.t_end": 0.1}
        for scheme in ["disph", "gdisph"]:
            with self.subTest(scheme):
                self.assertLess(self.summary("sod", {**flat, "shock.scheme": scheme})["errors"]["density_l1"], 0.03)

    def test_square(self):
        """Pressure is continuous across a contact: DISPH, GDISPH and REMIX hold it, SSPH and GSPH pull it round."""
        settings = {"domain.particles_x": 16, "time.t_end": 1}
        for scheme in SCHEMES:
            with self.subTest(scheme):
                m = self.summary("square", {**settings, "shock.scheme": scheme})["metrics"]
                if scheme in ("disph", "gdisph", "remix"):
                    self.assertLess(abs(m["square_area_change"]), 1e-12)
                    self.assertLess(abs(m["square_corner_radius"]), 1e-12)
                else:
                    self.assertGreater(m["square_area_change"], 0.05)

    def test_other_forms_in_the_tube(self):
        """As test_sod and test_momentum; geometric densities are better than the standard form at the same particles."""
        density = {}
        for name, form in {"ssph": {"shock.scheme": "ssph"}, **FORMS}.items():
            with self.subTest(name):
                s = self.summary("sod", {**form, "domain.particles_x": 200})
                density[name] = s["errors"]["density_l1"]
                self.assertLess(density[name], 0.02)
                self.assertLess(s["errors"]["pressure_l1"], 0.02)
                self.assertLess(abs(s["conservation"]["energy"]), 1e-4)
                s = self.summary("sod", {**form, "domain.particles_x": 100, "domain.periodic_x": "T", **DOUBLE})
                self.assertLess(s["conservation"]["momentum"], 1e-13)
        self.assertLess(density["gdf"], 0.8 * density["ssph"])

    def test_blip_at_the_contact(self):
        """The step of u is sharp where that of the density is smooth, so that p and u overshoot between 0.6 and 0.78 at the
        end, where p is exactly constant: by a fifth from lowest to highest p and 4 % in u. Conductivity takes it away to
        a third at least; kernels and forces do not."""
        def blip(form):
            run = self.run_program("shock", "sod", form)
            m = run.summary["metrics"]
            with h5py.File(sorted(run.directory.glob("snapshot_*.h5"))[-1]) as file:
                gas = file["PartType0"]
                x, p, u = (gas[name][:] for name in ("Coordinates", "Pressure", "InternalEnergy"))
            x = x.reshape(len(x), -1)[:, 0]
            near = (x > 0.6) & (x < 0.78)
            hot = m["p_star"] / (0.4 * 0.125 * (m["p_star"] / 0.1 + 1 / 6) / (m["p_star"] / 0.1 / 6 + 1))  # behind the shock
            return (p[near].max() - p[near].min()) / m["p_star"], u[near].max() / hot - 1
        for scheme in ["ssph", "gdf"]:
            with self.subTest(scheme):
                without, with_it = (blip({"shock.scheme": scheme, **more}) for more in ({}, PRICE))
                self.assertGreater(without[0], 0.15)
                self.assertLess(with_it[0], without[0] / 3)
                self.assertLess(with_it[1], without[1] / 3)
        self.assertGreater(blip(FORMS["ssph, integral"])[0], 0.15)

    def test_other_forms_and_the_square(self):
        """None of them holds it: the pressure of summed densities steps at a contact, whatever the gradient and the mean of the
        densities, and pulls corners in; conductivity heats the gas inside."""
        settings = {"domain.particles_x": 16, "time.t_end": 1}
        for name, form in FORMS.items():
            with self.subTest(name):
                s = self.summary("square", {**settings, **form})
                m = s["metrics"]
                self.assertLess(s["conservation"]["momentum"], 1e-13)
                self.assertLess(abs(s["conservation"]["energy"]), 1e-3)
                if "conductivity" in name:
                    self.assertGreater(m["square_area_change"], 0.1)
                else:
                    self.assertGreater(m["square_corner_radius"], 0.1)

    @unittest.skipUnless(SLOW, "slow")
    def test_square_of_equal_masses(self):
        """Two lattices that do not fit: held where the forces know that supports follow the number density. A corner may
        be off by a spacing of the thin gas, 1/32."""
        settings = {"domain.particles_x": 32, "shock.masses": "equal_mass", "time.t_end": 2}
        for scheme in ["disph", "gdisph"]:
            with self.subTest(scheme):
                m = self.summary("square", {**settings, "shock.scheme": scheme})["metrics"]
                self.assertLess(abs(m["square_area_change"]), 0.05)
                self.assertLess(abs(m["square_corner_radius"]), 1 / 32 / (2**0.5 - 1) / 0.5)
        m = self.summary("square", {**settings, "shock.scheme": "disph", "shock.support_terms": "weight"})["metrics"]
        self.assertGreater(m["square_area_change"], 0.1)

    def test_iron_in_silicate(self):
        """As the square of equal masses; SSPH pulls it round."""
        settings = {"domain.particles_x": 32, "time.t_end": 50 if SLOW else 30}
        for scheme in ["ssph", "disph", "gdisph"]:
            with self.subTest(scheme):
                m = self.summary("iron_silicate", {**settings, "shock.scheme": scheme})["metrics"]
                limit = 1 / 32 / (2**0.5 - 1) / 0.5
                if scheme == "ssph":
                    self.assertGreater(m["square_corner_radius"], limit)
                    continue
                self.assertLess(abs(m["square_area_change"]), 0.05)
                self.assertLess(abs(m["square_corner_radius"]), limit)

    def test_shock_from_iron_into_silicate(self):
        """An error of first order; the star state by bisection of the two wave curves, written here once more."""
        def curve(p, rho, p0, gamma, p_inf):
            P, P0 = p + p_inf, p0 + p_inf
            if p > p0:
                return (p - p0) * (2 / (rho * ((gamma + 1) * P + (gamma - 1) * P0))) ** 0.5
            return 2 * (gamma * P0 / rho) ** 0.5 / (gamma - 1) * ((P / P0) ** ((gamma - 1) / (2 * gamma)) - 1)
        low, high = 1e10, 6e10
        while high - low > 1e-3:
            p = 0.5 * (low + high)
            both = curve(p, 7000, 6e10, 5.0, 1.24e10) + curve(p, 3000, 1e10, 4.0, 4.5e9)
            low, high = (p, high) if both < 0 else (low, p)
        errors = []
        for particles in [100, 200]:
            s = self.summary("iron_silicate_shock", {"domain.particles_x": particles})
            self.assertAlmostEqual(s["metrics"]["p_star"] / low, 1, delta=1e-12)
            errors.append(s["errors"]["density_l1"])
        self.assertGreater(errors[0] / errors[1], 1.7)
        self.assertLess(errors[1], 0.02 * (7000 - 6111.9))

    def test_liquids(self):
        """Iron and silicate by their equations of state: first order against the exact waves of both (whose shock and fan
        tests/riemann checks), the sharp contact kept by the Godunov form, and the square at rest to a spacing."""
        errors = {}
        for scheme in SCHEMES:
            for particles in [100, 200]:
                s = self.summary("melts_shock", {"domain.particles_x": particles, "shock.scheme": scheme})
                errors[scheme, particles] = s["errors"]["density_l1"]
                self.assertLess(abs(s["conservation"]["energy"]), 1e-4)
        self.assertGreater(errors["gdisph", 100] / errors["gdisph", 200], 1.7)
        self.assertEqual(min(errors, key=errors.get), ("gdisph", 200))
        m = self.summary("melts_square", {"domain.particles_x": 32, "time.t_end": 25})["metrics"]
        self.assertLess(abs(m["square_area_change"]), 0.05)
        self.assertLess(abs(m["square_corner_radius"]), 1 / 32 / (2**0.5 - 1) / 0.5)
        # The resolved input is an input: densities follow from temperatures again.
        first = self.run_program("shock", "melts_square", {"domain.particles_x": 16, "time.steps": 1}, output="melts")
        again = self.summary(first.directory / "resolved.nml", {"time.steps": 1})
        self.assertEqual(again["state_hash"], first.summary["state_hash"])

    def test_strong_shock(self):
        """A pressure ratio of 3e4 over one density. With a tenth of the power of the pressure in the weight DISPH and GDISPH
        have at most 1.2 of GSPH's errors; with the energy as weight cold gas beside hot is ten times too dense or more."""
        tube = {"shock.rho_r": 1, "shock.p_l": 300, "shock.p_r": 0.01, "shock.gamma": 1.6667, "time.t_end": 0.015,
                "domain.particles_x": 120, "output.interval": 0}
        least = self.summary("sod", {**tube, "shock.scheme": "gsph"})["errors"]
        for scheme in ["disph", "gdisph"]:
            with self.subTest(scheme):
                s = self.summary("sod", {**tube, "shock.scheme": scheme, "shock.weight": "power"})
                for norm in ("density_l1", "velocity_l1", "pressure_l1"):
                    self.assertLess(s["errors"][norm], 1.2 * least[norm], norm)
                self.assertLess(abs(s["conservation"]["energy"]), 1e-4)
        s = self.summary("sod", {**tube, "shock.scheme": "disph"})
        self.assertGreater(s["errors"]["density_l1"], 3 * least["density_l1"])

    def test_remix_beside_a_vacuum(self):
        """Pressures 1 and 1e-5, particles of equal mass: slopes that made an energy below zero took the step to 1e-20 s."""
        coarse, fine = (self.summary("sod", {"shock.scheme": "remix", "shock.p_r": 1e-5, "domain.particles_x": n}) for n in (100, 200))
        self.assertLess(fine["steps"], 400)
        self.assertLess(abs(fine["conservation"]["energy"]), 1e-4)
        for norm in ("density_l1", "velocity_l1", "pressure_l1"):
            self.assertLess(fine["errors"][norm], 0.7 * coarse["errors"][norm], norm)

    def test_power_of_the_pressure(self):
        """In Sod's tube, whose halves meet elsewhere, better than with the energy; the contact of equal masses is held."""
        tube = {"domain.particles_x": 100, "shock.middle": 0.4, "time.t_end": 0.15}
        energy, power = (self.summary("sod", {**tube, "shock.weight": weight})["errors"]["density_l1"] for weight in ("energy", "power"))
        self.assertLess(power, 0.8 * energy)
        m = self.summary("square", {"domain.particles_x": 16, "shock.masses": "equal_mass", "time.t_end": 1, "shock.weight": "power"})["metrics"]
        self.assertLess(abs(m["square_area_change"]), 0.03)
        self.assertLess(abs(m["square_corner_radius"]), 1 / 16 / (2**0.5 - 1) / 0.5)  # a spacing of the thin gas
        self.assert_exact("shock", "sod", {"domain.dimension": 2, "domain.particles_x": 64, "domain.particles_y": 16, "domain.periodic_y": "T",
                                           "kernel.skin": 0.5, "time.t_end": 0.04, "shock.weight": "power"}, 10, [(2, 1)])

    def test_vortex(self):
        """Fields linear in x are what kernels that reproduce them do not damp: less than half of the others' error."""
        errors = {scheme: self.summary("gresho", {"domain.particles_x": 24, "time.t_end": 0.5 if SLOW else 0.3, "shock.scheme": scheme})
                  ["errors"]["velocity_l1"] for scheme in SCHEMES}
        self.assertLess(errors["remix"], 0.5 * min(e for scheme, e in errors.items() if scheme != "remix"))

    def test_growth(self):
        """Instabilities grow as linear theory says, to a tenth."""
        for name, particles in [("rayleigh_taylor", 32), ("kelvin_helmholtz", 48)] if SLOW else [("rayleigh_taylor", 24)]:
            for scheme in ["disph", "gdisph"] if SLOW else ["gdisph"]:
                with self.subTest(name, scheme=scheme):
                    m = self.summary(name, {"domain.particles_x": particles, "shock.scheme": scheme})["metrics"]
                    self.assertAlmostEqual(m["growth_rate"] / m["growth_rate_theory"], 1, delta=0.1)

    def test_symmetry(self):
        """A quarter between walls is a quarter of the whole, to rounding, which chaos has no time to magnify."""
        settings = {"domain.dimension": 2, "time.t_end": 0.02, "shock.p_l": 1e-3, **DOUBLE}
        whole = self.summary("sedov", {**settings, "domain.particles_x": 32})
        part = self.summary("sedov_octant", {**settings, "domain.particles_x": 16})
        self.assertEqual(part["steps"], whole["steps"])
        for name, value in whole["errors"].items():
            self.assertAlmostEqual(part["errors"][name] / value, 1, delta=1e-9)
        radius = "shock_radius"
        self.assertAlmostEqual(part["metrics"][radius] / whole["metrics"][radius], 1, delta=1e-9)
        # Tensors in the mirror.
        settings.update(FORMS["gdf, integral, conductivity"])
        whole = self.summary("sedov", {**settings, "domain.particles_x": 32}, output="whole_by_an_integral")
        part = self.summary("sedov_octant", {**settings, "domain.particles_x": 16}, output="part_by_an_integral")
        for name, value in whole["errors"].items():
            self.assertAlmostEqual(part["errors"][name] / value, 1, delta=1e-9)

    def test_explosion(self):
        """The shock's radius to a quarter of a spacing, which is 2.1 % of it; energy as the steps' errors."""
        settings = {"domain.dimension": 2, "domain.particles_x": 32, "time.t_end": 0.1, "shock.p_l": 1e-3,
                    "shock.support_terms": "number", **DOUBLE}
        for scheme in SCHEMES if SLOW else ["disph", "gdisph", "remix"]:
            with self.subTest(scheme):
                s = self.summary("sedov", {**settings, "shock.scheme": scheme})
                m = s["metrics"]
                if scheme != "remix":  # ahead by 3.6 %, at twice the resolution by 2.6: docs/studies/2026-11-21_explosions.md
                    self.assertLess(abs(m["shock_radius"] / m["shock_radius_exact"] - 1), 0.021)
                self.assertLess(abs(s["conservation"]["energy"]), 1e-3)
                self.assertLess(s["conservation"]["momentum"], 1e-12)

    def test_order_of_convergence(self):
        """With `coarser` the errors are those of the runs by themselves, and the order their least squares' slope."""
        flat = {"domain.particles_x": 48, "time.t_end": 0.05}
        for name, settings, scheme in [("sod", {"domain.particles_x": 200}, "gsph"), ("gresho", flat, "gdisph")]:
            with self.subTest(name):
                settings = {**settings, "shock.scheme": scheme}
                s = self.summary(name, {**settings, "shock.coarser": 2}, output="orders_" + name)
                n = settings["domain.particles_x"]
                c = s["errors"]["convergence"]
                self.assertEqual(c["particles_x"], [n // 4, n // 2, n])
                self.assertEqual(c["left_out"], [])
                alone = [self.summary(name, {**settings, "domain.particles_x": k}, output=f"alone_{name}_{k}")
                         for k in c["particles_x"]]
                self.assertEqual(s["state_hash"], alone[-1]["state_hash"])
                for error in ("density_l1", "velocity_l1", "pressure_l1"):
                    self.assertEqual(c[error], [one["errors"][error] for one in alone])
                    # Three points a factor of two apart: the middle one has no weight.
                    slope = math.log(c[error][0] / c[error][2]) / math.log(4)
                    self.assertAlmostEqual(c["order"][error], slope, delta=1e-12)

    def test_order_after_a_restart(self):
        """Stopped in the coarser run or in the last one: the same orders to the last bit; and what is not there is named."""
        settings = {"domain.particles_x": 200, "shock.coarser": 1, "run.checkpoint_interval": 20}
        whole = self.summary("sod", settings, output="whole")
        # The limit of the wall clock stops the coarser run at once, and the restarted one's successor again.
        result = self.run_program("shock", "sod", {**settings, "run.wall_clock_limit": 1e-3}, output="stopped", expect=INTERRUPTED)
        self.assertIn("with 100 particles along x", result.stderr)
        s = self.summary("sod", settings, output="stopped", options=["--restart", "latest"])
        self.assertEqual(s["errors"], whole["errors"])
        # Ended early by its number of steps, so that it can go on: the coarser run is then at another time.
        part = self.summary("sod", {**settings, "time.steps": 40}, output="part")
        left_out = part["errors"]["convergence"]["left_out"]
        self.assertEqual([one["particles_x"] for one in left_out], [100])
        self.assertIn("t = ", left_out[0]["why"])
        self.assertIsNone(part["errors"]["convergence"]["order"]["density_l1"])
        s = self.summary("sod", settings, output="part", options=["--restart", "latest"], ranks=2)
        self.assertEqual((s["state_hash"], s["errors"]), (whole["state_hash"], whole["errors"]))

    def test_forces_without_terms_of_supports(self):
        """Where all supports are the same there are none to leave out; at a contact of two lattices they hold the square."""
        even = {"shock.rho_r": 1, "shock.u_l": 0.1, "shock.u_r": 0.1, "shock.p_r": 1, "domain.particles_x": 50,
                "domain.periodic_x": "T", "time.steps": 5, **DOUBLE}
        for scheme in ["ssph", "disph", "gdisph"]:
            one, other = (self.summary("sod", {**even, "shock.scheme": scheme, "shock.support_terms": terms})["errors"]
                          for terms in ("none", "number"))
            self.assertAlmostEqual(one["velocity_l1"], other["velocity_l1"], delta=1e-12)
        settings = {"domain.particles_x": 32, "shock.masses": "equal_mass", "time.t_end": 1.5, "shock.scheme": "disph"}
        m = self.summary("square", {**settings, "shock.support_terms": "none"})["metrics"]
        self.assertGreater(m["square_area_change"], 0.1)
        # Sod's tube: the terms double the pulse at the head of the rarefaction.
        for scheme in ["ssph", "disph", "gdisph"]:
            none, number = (self.summary("sod", {"domain.particles_x": 200, "shock.scheme": scheme,
                                                 "shock.support_terms": terms})["errors"]["density_l1"]
                            for terms in ("none", "number"))
            self.assertLess(none, number)

    def test_terms_that_fade(self):
        """Terms that fade where pressures jump: Sod's tube better than by Godunov SPH, and the square of equal masses holds."""
        tube = {"domain.particles_x": 200}
        gsph, fading = (self.summary("sod", {**tube, **own})["errors"]["density_l1"]
                        for own in ({"shock.scheme": "gsph"}, {"shock.support_terms": "fading"}))
        self.assertLess(fading, gsph)
        # Nothing fades: the terms throughout. And forces between two particles are opposite whatever fades.
        tube = {"domain.particles_x": 100, "domain.periodic_x": "T", "shock.support_terms": "fading", **DOUBLE}
        whole = self.summary("sod", {**tube, "shock.fading": 0})
        number = self.summary("sod", {**tube, "shock.support_terms": "number"})
        self.assertAlmostEqual(whole["errors"]["density_l1"] / number["errors"]["density_l1"], 1, delta=1e-6)
        self.assertLess(self.summary("sod", tube)["conservation"]["momentum"], 1e-13)
        m = self.summary("square", {"domain.particles_x": 24, "shock.masses": "equal_mass", "time.t_end": 1,
                                    "shock.support_terms": "fading"})["metrics"]
        self.assertLess(abs(m["square_area_change"]), 0.01)

    def test_iron_over_silicate(self):
        """Liquids with equations of state under gravity: the contact grows as the linear theory of these compressible layers says."""
        s = self.summary("iron_over_silicate", {"domain.particles_x": 24, "domain.particles_y": 24, "time.t_end": 140})
        m = s["metrics"]
        self.assertAlmostEqual(m["growth_rate_theory"] / m["growth_rate_sharp"], 1, delta=0.1)
        self.assertAlmostEqual(m["growth_rate"] / m["growth_rate_theory"], 1, delta=0.2)
        self.assertLess(abs(s["conservation"]["energy"]), 1e-4)

    def test_sharp_contacts_of_equal_masses(self):
        """Of two materials that flow past each other or lie one on the other; the theory is that of sharp contacts, nearly incompressible."""
        small = {"domain.dimension": 2, "domain.particles_x": 32, "time.steps": 1}
        # Under gravity masses are equal at the contact; above it the weight is less, below it more.
        for name, unequal in (("kelvin_helmholtz_earth", 0.05), ("rayleigh_taylor_earth", 0.1)):
            with self.subTest(name):
                result = self.run_program("shock", name, small)
                m = result.summary["metrics"]
                self.assertAlmostEqual(m["growth_rate_theory"] / m["growth_rate_sharp"], 1, delta=0.01)
                with h5py.File(result.directory / "snapshot_0000.h5") as f:
                    p = f["PartType0"]
                    material, mass, rho = (p[key][:] for key in ("Material", "Masses", "Density"))
                metal = rho > 1e4
                self.assertEqual(set(material[metal]) & set(material[~metal]), set())
                self.assertAlmostEqual(mass[metal].mean() / mass[~metal].mean(), 1, delta=unequal)
                self.assertTrue(1.9 < rho[metal].mean() / rho[~metal].mean() < 2.3)
                self.assertGreater(metal.sum(), 1.9 * (~metal).sum())
        for name in ("kelvin_helmholtz", "rayleigh_taylor"):  # smooth layers
            self.assertIn("equal_spacing", self.run_program("shock", name, {"shock.masses": "equal_mass"}, expect=BAD_INPUT).stderr)

    def test_kelvin_helmholtz_of_iron_and_rock(self):
        """A wave of the contact grows, by half of the theory's rate at least: the lattice resists (docs/studies)."""
        s = self.summary("kelvin_helmholtz_earth", {"domain.dimension": 2, "kernel.h_over_dx": 2.4, "time.t_end": 5400})
        self.assertGreater(s["metrics"]["growth_rate"], 0.45 * s["metrics"]["growth_rate_theory"])
        self.assertLess(abs(s["conservation"]["energy"]), 1e-3)

    def test_impact(self):
        """Two bodies in empty space: momentum to rounding, and in the middle the pressure of mantles that meet in one dimension."""
        s = self.summary("impact_2d", {"domain.particles_x": 40, "domain.particles_y": 40, "time.t_end": 2, **DOUBLE})
        self.assertLess(s["conservation"]["momentum"], 1e-13)
        # Granite's Hugoniot, p = rho0 U u with U = 3.68 km/s + 1.24 u [Melosh (1989), table AII.2], at u = 5 km/s, to a tenth.
        self.assertAlmostEqual(s["metrics"]["p_star"] / (2680 * (3.68e3 + 1.24 * 5e3) * 5e3), 1, delta=0.1)

    def test_ranks_and_restart(self):
        settings = {"domain.dimension": 2, "domain.particles_x": 64, "domain.particles_y": 16, "domain.periodic_y": "T",
                    "kernel.skin": 0.5, "time.t_end": 0.04}
        for scheme in ["disph", "gdisph", "remix"]:
            with self.subTest(scheme):
                layouts = [(2, 1), (4, 1), (None, 2)] if SLOW else [(4, 1), (None, 2)] if scheme == "gdisph" else []
                self.assert_exact("shock", "sod", {**settings, "shock.scheme": scheme}, 10, layouts)
        for name in ("gdf", "gdf, integral, conductivity"):
            with self.subTest(name):
                self.assert_exact("shock", "sod", {**settings, **FORMS[name]}, 10, [(2, 1)])

    def test_kick_drift_kick(self):
        """Errors of the shock tube are those of Runge-Kutta's method with twice as many evaluations; the same bits on ranks and over a
        restart; a checkpoint of another method goes on."""
        for scheme in ("disph", "gsph", "remix") if SLOW else ("disph", "remix"):
            with self.subTest(scheme):
                by_error, kdk = (self.summary("sod", {"domain.particles_x": 200, "shock.scheme": scheme, "time.method": method}) for method in ("adaptive", "kdk"))
                self.assertLess(kdk["errors"]["density_l1"], 1.05 * by_error["errors"]["density_l1"])
                self.assertLess(abs(kdk["conservation"]["energy"]), 2e-3)
                self.assertLess(kdk["rhs_evaluations"], 0.6 * by_error["rhs_evaluations"])
                settings = {"domain.dimension": 2, "domain.particles_x": 64, "domain.particles_y": 16, "domain.periodic_y": "T",
                            "kernel.skin": 0.5, "time.t_end": 0.04, "time.method": "kdk", "shock.scheme": scheme}
                self.assert_exact("shock", "sod", settings, 10, [(3, 2)])
        self.run_program("shock", "sod", {**settings, "time.method": "adaptive", "time.steps": 10}, "changes")
        changed = self.run_program("shock", "sod", settings, "changes", ["--restart", "latest"]).summary
        self.assertGreater(changed["steps"], 10)
        refused = self.call("shock", *self.arguments("sod", {"shock.scheme": "disph", "shock.weight": "power", "time.method": "kdk"}, self.here / "no"))
        self.assert_says(refused, BAD_INPUT, "&time method", "kdk")

    def decay(self, result):
        """Of the velocity, 1/s: half of that of the kinetic energy."""
        header, rows = result.rows()
        t, kinetic = (header.index(name) for name in ("time [s]", "kinetic_energy [J]"))
        first, last = rows[0], rows[-1]
        return -0.5 * math.log(float(last[kinetic]) / float(first[kinetic])) / (float(last[t]) - float(first[t]))

    def test_shear_wave(self):
        """v_y sin kx dies as exp(-nu k^2 t). The sums are 1.1 % slow on the lattice (1/6 of the stress is central: its waves along axes are
        slower), 2 % at 32 particles a wave; with density 2 nu is half."""
        for scheme, density in [("ssph", 1), ("disph", 2), ("gdf", 1)] if SLOW else [("ssph", 2)]:
            with self.subTest(scheme):
                settings = {"domain.particles_x": 32, "shock.scheme": scheme, "shock.viscosity": 0.02, "time.t_end": 0.5,
                            **{f"shock.rho_{end}": density for end in "lr"}, **{f"shock.p_{end}": 2 for end in "lr"},
                            "region.velocity_y": "'0.3*sin(2*pi*x)'"}
                result = self.run_program("shock", "shear_wave", settings)
                self.assertAlmostEqual(self.decay(result) / (0.02 / density * (2 * math.pi)**2), 1, delta=0.02)
                c = result.summary["conservation"]
                self.assertLess(abs(c["energy"]), 1e-6)
                self.assertLess(c["momentum"], 1e-6)  # single precision

    def test_sound_wave_in_a_gas_that_rubs_and_conducts(self):
        """A standing wave decays as the linear theory of friction and conduction has it: s of d(rho, u, T)/dt, complex; after one period its
        kinetic energy is exp(2 Re s T) of the start's, where the start has the velocity alone."""
        import numpy as np
        gamma, mu, bulk, conductivity, c_v, rho, p = 1.4, 0.003, 0.002, 0.01, 2.0, 1.0, 1.0
        k, T = 2 * math.pi, p / rho / ((gamma - 1) * c_v)
        R = (gamma - 1) * c_v
        # of density sines, velocity cosines: drho = -rho k v, rho dv = k R (T drho + rho dT) - mu_L k^2 v, rho c_v dT' = -p k v - k_T k^2 T
        A = np.array([[0, -rho * k, 0], [k * R * T / rho, -(4 / 3 * mu + bulk) * k * k / rho, k * R],
                      [0, -p * k / (rho * c_v), -conductivity * k * k / (rho * c_v)]])
        values, vectors = np.linalg.eig(A)
        at = np.linalg.solve(vectors, np.array([0, 1, 0]))
        speed = lambda t: float((vectors[1] * at * np.exp(values * t)).sum().real)
        end = 2 * math.pi / abs(values.imag).max()
        settings = {"domain.dimension": 1, "domain.length_x": 1, "domain.particles_x": 100, "time.t_end": end, "shock.viscosity": mu, "shock.bulk_viscosity": bulk,
                    "shock.heat_conductivity": conductivity, "shock.heat_capacity": c_v, "time.rtol": 1e-5, "kernel.precision": "double"}
        text = (INPUTS / "shear_wave.nml").read_text().replace("velocity_y = '0.2*sin(2*pi*x)'", "velocity_x = '0.001*cos(2*pi*x)'")
        text = text.replace("length_y = 0.5", "").replace("periodic_y = .true.", "")
        wave = self.here / "sound.nml"
        wave.write_text(text)
        result = self.run_program("shock", wave, settings)
        left = math.exp(-self.decay(result) * end)
        self.assertLess(left, 0.9)
        self.assertAlmostEqual(math.log(left) / math.log(speed(end)), 1, delta=0.01)

    def test_viscous_shock(self):
        """Becker's profile for another gas and strength, with bulk viscosity: errors fall with the spacing squared, whatever the scheme."""
        along = 4 / 3 * 0.01 + 0.01
        settings = {"shock.gamma": 5 / 3, "shock.p_l": 3, "shock.rho_r": 2, "shock.viscosity": 0.01, "shock.bulk_viscosity": 0.01, "shock.heat_capacity": 0.5,
                    "shock.heat_conductivity": along * 5 / 3 * 0.5, "shock.coarser": 1, "domain.particles_x": 400, "time.t_end": 0.1, "output.interval": 0}
        for scheme in ("ssph", "disph") if SLOW else ("ssph",):
            with self.subTest(scheme):
                s = self.summary("viscous_shock", {**settings, "shock.scheme": scheme}, output="profile_" + scheme)
                self.assertAlmostEqual(s["metrics"]["density_behind"], 2 * (4 * 3 + 1) / (3 + 4), delta=1e-9)  # Rankine-Hugoniot, gamma 5/3
                self.assertLess(s["errors"]["density_l1"], 0.003 * (s["metrics"]["density_behind"] - 2))
                self.assertLess(s["errors"]["velocity_l1"], 0.003 * s["metrics"]["velocity_behind"])
                for error in ("density_l1", "velocity_l1", "pressure_l1"):
                    self.assertGreater(s["errors"]["convergence"]["order"][error], 1.6, error)

    def test_friction_limits_steps(self):
        fast, slow = ({**PROFILE, "shock.viscosity": mu, "shock.heat_conductivity": mu * 4 / 3 * 1.4} for mu in (1e-4, 0.2))
        dt = [self.run_program("shock", "viscous_shock", {**s, "time.method": "ssp_rk3", "time.steps": 2, "time.t_end": 1}).rows()[1][-1][2] for s in (fast, slow)]
        # 0.25 dx^2 rho/max(mu + (d + 1) mu/6, k/c_v), dx = 1/100 m: 1.867 mu is the larger; of so wide a shock the density is up to 1.03 ahead
        self.assertLess(float(dt[1]), 0.25 * 1e-4 / (0.2 * 4 / 3 * 1.4) * 1.03)
        self.assertGreater(float(dt[0]), 10 * float(dt[1]))

    def test_friction_on_ranks_and_after_restarts(self):
        settings = {"domain.dimension": 2, "domain.particles_x": 48, "domain.particles_y": 12, "domain.periodic_y": "T", "kernel.skin": 0.5,
                    "time.t_end": 0.02, "shock.viscosity": 0.001, "shock.heat_conductivity": 0.002, "shock.heat_capacity": 1}
        for scheme in ("ssph", "gdisph") if SLOW else ("ssph",):
            s = self.assert_exact("shock", "sod", {**settings, "shock.scheme": scheme}, 10, [(3, 1), (None, 2)] if SLOW else [(3, 1)])
            self.assertIsNone(s["errors"])  # the tube's exact solution has no friction
            self.assertLess(abs(s["conservation"]["energy"]), 1e-4)

    def test_friction_refusals(self):
        for name, settings, says in [
                ("sod", {"shock.bulk_viscosity": 1}, ("bulk_viscosity", "5/3 of the viscosity")),
                ("sod", {"shock.viscosity": -1}, ("viscosity",)),
                ("sod", {"shock.heat_conductivity": 1}, ("heat_conductivity", "need a heat_capacity")),
                ("sod", {"shock.heat_capacity": 1}, ("heat_capacity", "belongs to heat_conductivity")),
                ("sod", {"shock.viscosity": 1, "shock.coarser": 1}, ("coarser", "no exact solution")),
                ("iron_silicate", {"shock.heat_conductivity": 1, "shock.heat_capacity": 1}, ("heat_conductivity", "one gas")),
                ("melts_shock", {"shock.heat_conductivity": 1, "shock.heat_capacity": 1}, ("heat_conductivity", "one gas")),
                ("viscous_shock", {"shock.heat_conductivity": 0.03}, ("heat_conductivity", "0.03733333333 W/(m K)")),
                ("viscous_shock", {"shock.viscosity": 0, "shock.heat_conductivity": 0}, ("viscosity", "has a width")),
                ("viscous_shock", {"shock.p_l": 0.5}, ("p_l", "larger pressure")),
                ("viscous_shock", {"shock.u_l": 1}, ("u_l", "follows"))]:
            with self.subTest(name, **settings):
                result = self.run_program("shock", name, settings, expect=BAD_INPUT)
                self.assert_says(result, BAD_INPUT, *says)
                self.assertFalse(result.directory.exists())

    def test_wrong_input(self):
        for key, value, word in [("shock.scheme", "'sph'", "gdisph"), ("kernel.name", "'cubic'", "quintic"),
                                 ("shock.p_r", -1, "p_r"), ("shock.p_infinity_l", 1, "weight"),
                                 ("shock.gravity", 1, "rayleigh_taylor"), ("shock.middle", 1, "[0.05, 0.95]"), ("shock.exponent", 0.2, "weight = 'power'"), ("shock.eos_l", "'liquid_iron'", "temperature_l"),
                                 ("shock.temperature_r", 300, "equation of state"), ("shock.corner", "T", "sedov"),
                                 ("shock.test", "'impact'", "equations of state"), ("expert.tillotson_l", "'iron'", "tillotson"),
                                 ("shock.coarser", 5, "400 particles"), ("shock.coarser", 6, "halved")]:
            with self.subTest(key):
                result = self.run_program("shock", "sod", {key: value}, expect=BAD_INPUT)
                self.assertIn(word, result.stderr)
                self.assertFalse(result.directory.exists())
        for name, settings, word in [("sod", {"shock.scheme": "'disph'", "shock.support_terms": "'fading'"}, "gdisph"),
                                     ("sod", {"shock.scheme": "'disph'", **INTEGRAL}, "'ssph' and 'gdf'"),
                                     ("sod", {"shock.scheme": "'gdisph'", **PRICE}, "'ssph' and 'gdf'"),
                                     ("melts_shock", {"shock.scheme": "'ssph'", **PRICE}, "one ideal gas"),
                                     ("iron_over_silicate", {"shock.p_r": 2e10}, "p_l"), ("impact_2d", {"expert.radius": 3e5}, "hold"),
                                     ("impact_2d", {"expert.radius": 1e3}, "two spacings")]:
            self.assertIn(word, self.run_program("shock", name, settings, expect=BAD_INPUT).stderr)
        result = self.run_program("shock", "square", {"shock.coarser": 1}, expect=BAD_INPUT)
        self.assertIn("no exact solution", result.stderr)


if __name__ == "__main__":
    unittest.main()
