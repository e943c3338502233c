"""Metal over silicate and drops: linear growth, overturn, formulations; ranks, threads, restarts, input."""

import unittest

from running import BAD_INPUT, CALCULATION_FAILED, INPUTS, SLOW, Case, outcome

LINEAR, NOTE, POSTER, CYLINDER, SPHERE = "rti_linear", "rti_note", "rti_poster", "drop_cylinder", "drop_sphere"
POND, PARTITIONING, TENSION, EMULSION = "pond_on_mantle", "partitioning", "drop_surface_tension", "drop_emulsion"

# Of the notes, in an input that has what suits all programs.
AS_PUBLISHED = {"kernel.name": "quintic", "kernel.h_over_dx": 0, "walls.treatment": "virtual_marker", "volume.consistency": "none"}
MIRRORED = {"kernel.name": "wendland_c6", "kernel.h_over_dx": 3.5, "walls.treatment": "mirror", "volume.consistency": "tied"}
DOUBLE = {"kernel.precision": "double"}  # where nothing but rounding may be left


def size(n, dimension=2):
    return {f"domain.particles_{axis}": n for axis in "xyz"[:dimension]}


def viscosity(upper, lower=None):
    return {"rti.viscosity_upper": upper, "rti.viscosity_lower": lower or upper}


class RayleighTaylor(Case):
    def test_theory(self):
        """Prints the growth rates, compressible and not [docs/theory/rayleigh_taylor.md], and writes nothing."""
        result = self.call("rti", *self.arguments(LINEAR, viscosity(6e12), self.here / "none", ["--theory"]))
        self.assertEqual(result.status, 0, result)
        rates = [float(line.split()[2]) for line in result.stdout.splitlines() if line.startswith("growth rate")]
        self.assertAlmostEqual(rates[0], 0.000389908, delta=1e-9)
        self.assertAlmostEqual(rates[1], 0.000354901085, delta=1e-12)
        self.assertFalse((self.here / "none").exists())

    def test_growth(self):
        """n = 24: the kernel leaves errors of order (k dx)^2, k dx = 0.26; at 48 less than half a per cent, also of unequal viscosities
        (measured: 0.1 to 0.3; at 36 0.4)."""
        for change, delta in [({"time.t_end": 1400}, 0.01),
                              ({**viscosity(1e11), "time.t_end": 950}, 0.01),
                              ({"domain.periodic_x": ".true.", "walls.floor": "free_slip", "time.t_end": 1200}, 0.01),
                              ({"rti.interface": 5e5, **viscosity(6e11, 6e10), **size(48 if SLOW else 36), "time.t_end": 1500}, 0.005),
                              ({"rti.volume": "our_method", "rti.pressure": "smoothed", "time.t_end": 1400}, 0.01)]:
            with self.subTest(**change):
                m = self.run_program("rti", LINEAR, {**size(24), **change}).summary["metrics"]
                self.assertAlmostEqual(m["growth_rate"] / m["growth_rate_theory"], 1, delta=delta)
                # Smoothing takes the force away from its potential.
                self.assertLess(abs(m["energy_residual_max"]), 1e-3 if "rti.pressure" in change else 1e-4)

    def test_small_contrasts(self):
        """Where growth is slow the lattice's elasticity would show: 3.6 % with the whole pressure in the forces, 0.8 % with what is left of it."""
        settings = {**size(24), "rti.density_upper": 3300, "time.t_end": 3000, "time.method": "rkl2", "output.interval": 0}
        errors = {}
        for reference in ("auto", "none"):
            m = self.run_program("rti", LINEAR, {**settings, "rti.reference_pressure": reference}).summary["metrics"]
            errors[reference] = m["growth_rate"] / m["growth_rate_theory"] - 1
        self.assertLess(abs(errors["auto"]), 0.01)
        self.assertLess(errors["none"], -0.03)

    def test_surface_tension(self):
        """Tension takes a third of the wave's weight, and the growth goes to that of theory with it: 6.5 % off at 20, 2.8 % at 30, 0.8 % at 48."""
        errors = []
        for n in (24, 36) if SLOW else (20, 30):
            m = self.run_program("rti", LINEAR, {**size(n), "rti.surface_tension": 8e14, "time.t_end": 1900}).summary["metrics"]
            self.assertLess(m["growth_rate_theory"], 0.0019)
            errors.append(abs(m["growth_rate"] / m["growth_rate_theory"] - 1))
        self.assertLess(errors[1], 0.03)
        self.assertLess(errors[1], 0.6 * errors[0])

    def test_creeping(self):
        """Ten times the viscosity, with the stabilised method: compressibility speeds the growth by a tenth, and the run shows it."""
        settings = {**size(24), **viscosity(6e12), "time.method": "rkl2", "time.t_end": 7900}
        m = self.run_program("rti", LINEAR, settings).summary["metrics"]
        self.assertAlmostEqual(m["growth_rate"] / m["growth_rate_theory"], 1, delta=0.01)
        self.assertGreater(m["growth_rate"] / m["growth_rate_incompressible"], 1.08)

    def test_start_without_a_bang(self):
        """A mode of 0.02 of the height keeps every volume: sound stays far below the flow that comes, 3e-3 (displaced at once: 7e-3)."""
        m = self.run_program("rti", "rti_van_keken", {"domain.particles_x": 32, "domain.particles_y": 35, "time.t_end": 1,
                                                      "output.interval": 0, "output.history_interval": 1}).summary["metrics"]
        self.assertLess(m["v_rms_max"], 1e-3)

    def test_overturn(self):
        """The metal goes down, no particle is lost, energy closes to 1 % of Delta rho g L^3/8 (measured: 0.05 %)."""
        s = self.run_program("rti", NOTE, {**size(24), **viscosity(6e11), "time.t_end": 3500, "output.interval": 0}).summary
        m = s["metrics"]
        self.assertLess(m["metal_centroid"], 0.4)
        self.assertEqual(m["particles_lost"], 0)
        self.assertLess(m["energy_residual_max"], 0.01)
        self.assertGreater(m["density_ratio_min"], 0.8)
        self.assertLess(m["density_ratio_max"], 1.2)
        self.assertLess(m["time_of_fall_0.1"], m["time_of_fall_0.2"])
        self.assertLess(m["v_rms_max_time"], 3000)

    @unittest.skipUnless(SLOW, "slow")
    def test_no_particle_lies_on_a_wall(self):
        """Without a force of the walls themselves the last guard turns particles round at every step, 422 times by then."""
        settings = {**size(32), "time.t_end": 3000, "output.interval": 0}
        s = self.run_program("rti", NOTE, settings).summary
        self.assertEqual(s["metrics"]["particles_put_back"], 0)
        self.assertLess(s["metrics"]["energy_residual_max"], 3e-3)
        self.assertEqual(self.run_program("rti", NOTE, settings, ranks=2).summary["state_hash"], s["state_hash"])

    def test_three_dimensions(self):
        """A roll in a thin periodic box grows as the two-dimensional flow; a square pattern with its own wave number."""
        deep = {**size(16), "domain.dimension": 3, "domain.particles_z": 8, "domain.length_z": 7.5e5, "domain.periodic_z": ".true.",
                "kernel.name": "quintic", "time.t_end": 1300}
        m = self.run_program("rti", LINEAR, deep).summary["metrics"]
        self.assertAlmostEqual(m["growth_rate"] / m["growth_rate_theory"], 1, delta=0.05)

    def test_ranks_threads_restart(self):
        for name, more in [(NOTE, {}), (POSTER, {}), (NOTE, {"rti.supports": "volume"}), (POSTER, {"rti.supports": "fixed"}), (NOTE, {"rti.volume": "our_method", "rti.pressure": "smoothed"}),
                           (NOTE, {"time.method": "rkl2", **viscosity(6e12)})]:
            with self.subTest(name, **more):
                settings = {**size(20), "time.steps": 60, "rti.amplitude": 4e4, "output.interval": 0, **more}
                self.assert_exact("rti", name, settings, 30, [(2, 1), (4, 1), (None, 2)] if SLOW else [(3, 1), (None, 2)] if name == NOTE and not more else [])

    def test_restart_of_a_changed_order(self):
        """A narrow spline brings the particles into disorder; the viscous sum goes over to second order at step 260. A run continued
        from before that or from after it ends as the whole one."""
        settings = {**size(20), **viscosity(6e11), "kernel.name": "cubic", "kernel.h_over_dx": 1.1, "rti.viscous_order": 4,
                    "time.method": "rkl2", "time.steps": 300, "output.interval": 0}
        whole = self.run_program("rti", NOTE, settings)
        self.assertIn("of second order from here on", whole.stdout + whole.stderr)
        self.assertEqual(whole.summary["metrics"]["viscous_order"], 2)
        for step, order in [(255, 4), (275, 2)]:
            with self.subTest(step=step):
                part = {**settings, "time.steps": step, "run.checkpoint_interval": step}
                s = self.run_program("rti", NOTE, part, output=f"part_{step}").summary
                self.assertEqual(s["metrics"]["viscous_order"], order)
                s = self.run_program("rti", NOTE, settings, output=f"part_{step}", options=["--restart", "latest"]).summary
                self.assertEqual(outcome(s), outcome(whole.summary))

    def test_rows_in_balance(self):
        """From rest, sums over the lattice leave a fifth of the weight at contact and surface; balanced rows start without a kick
        (measured: 7.8 and 0.32 m/s after one step), and grow as before."""
        settings = {**size(32), "rti.start": "displaced", "rti.amplitude": 0, "time.steps": 1, "output.interval": 0,
                    "output.history_interval": 1}
        fastest = {}
        for rows in ("lattice", "balanced"):
            s = self.run_program("rti", POSTER, {**settings, "rti.rows": rows}).summary
            fastest[rows] = s["metrics"]["v_rms"]
        self.assertLess(fastest["balanced"], 0.1 * fastest["lattice"])
        growth = [self.run_program("rti", POSTER, {**size(24 if SLOW else 20), "rti.rows": rows, "time.t_end": 1000, "output.interval": 0})
                  .summary["metrics"]["growth_rate"] for rows in fastest]
        self.assertAlmostEqual(growth[1] / growth[0], 1, delta=0.005)

    def test_supports_by_volume(self):
        """Growth is that of theory with either volume; where the silicate expands to half of its density it keeps its neighbours."""
        for change in ({}, {"rti.volume": "our_method"}):
            with self.subTest(**change):
                m = self.run_program("rti", LINEAR, {**size(24), **change, "rti.supports": "volume", "time.t_end": 1400}).summary["metrics"]
                self.assertAlmostEqual(m["growth_rate"] / m["growth_rate_theory"], 1, delta=0.01)
                if not change:  # the diffusion of our method's density takes energy
                    self.assertLess(m["energy_residual_max"], 1e-4)
        neighbours, least = {}, {}
        for supports in ("fixed", "volume"):
            m = self.run_program("rti", POSTER, {**size(20), "rti.supports": supports, "time.t_end": 3500 if SLOW else 2700, "output.interval": 0}).summary["metrics"]
            neighbours[supports], least[supports] = m["neighbours"], m["density_ratio_min"]
        self.assertGreater(neighbours["volume"], 1.08 * neighbours["fixed"])
        self.assertGreater(least["volume"], least["fixed"])

    def test_formulations(self):
        """Each choice changes the run."""
        settings = {**size(20), "time.steps": 20, "rti.p_top": 1e10, "output.interval": 0}
        hashes = {}
        for change in [{}, {"rti.pressure": "smoothed"}, {"rti.viscosity_upper": 2e11}, {"rti.reference_pressure": "none"},
                       {"rti.viscous_order": 2}, {"rti.start": "displaced"}, {"rti.start": "coloured"},
                       {"rti.volume": "our_method"}, {"rti.volume": "our_method", "rti.delta": 0},
                       {"rti.volume": "our_method", "rti.pressure": "smoothed"}]:
            with self.subTest(**change):
                hashes[str(change)] = self.run_program("rti", NOTE, {**settings, **change}).summary["state_hash"]
        self.assertEqual(len(set(hashes.values())), len(hashes), hashes)

    def test_resolved_input_is_an_input(self):
        """What a run says it was made with says the same when it is read back."""
        for program, name, box in [("rti", LINEAR, {}), ("rti", NOTE, size(20)), ("rti", POSTER, size(20)), ("rti", POND, size(20)),
                                   ("drop", PARTITIONING, size(20)), ("drop", TENSION, {"domain.particles_x": 24, "domain.particles_y": 48}),
                                   ("drop", EMULSION, Emulsion.SMALL)]:
            with self.subTest(name):
                first = self.run_program(program, name, {**box, "time.steps": 1, "output.interval": 0})
                resolved = first.directory / "resolved.nml"
                again = self.run_program(program, resolved, {}, output=f"again_{name}")
                self.assertEqual(again.summary["state_hash"], first.summary["state_hash"])
                self.assertEqual((again.directory / "resolved.nml").read_text(), resolved.read_text())

    def test_notes_own_program_fails(self):
        """Program C as in the notes (Y^2/p, no diffusion in the density): the pressure at the top crosses zero, and the run says where."""
        result = self.run_program("disph_c", NOTE, {**size(24), **AS_PUBLISHED}, expect=CALCULATION_FAILED)
        self.assert_says(result, CALCULATION_FAILED, "step", "particle", "is not positive")

    def test_bad_input(self):
        for change, word in [({"rti.wavelength": 4e5}, "wavelength"), ({"walls.sides": "no_slip"}, "start"),
                             ({"rti.volume": "number_densty"}, "number_density"), ({"rti.rows": "balanced"}, "our_method"),
                             ({"rti.rows": "balanced", "rti.volume": "our_method", "rti.start": "coloured"}, "one material each"),
                             ({"rti.supports": "volume", "rti.pressure": "smoothed"}, "non_smoothed"),
                             ({"rti.supports": "volume", "rti.surface_tension": 1e12}, "surface tension")]:
            with self.subTest(**change):
                result = self.call("rti", *self.arguments(LINEAR, change, self.here / "none"))
                self.assert_says(result, BAD_INPUT, word)


class Warms(Case):
    def test_energy_beside_walls_of_no_slip(self):
        """Heat of compression is that of the places of what stands behind walls, which do not slip back (measured: 0.0033; 0.25 with the velocity
        that friction has there, and a density that falls to 0.3)."""
        settings = {**size(24), **viscosity(6e11), "rti.temperature_law": "adiabatic", "rti.eos_upper": "liquid_iron", "rti.eos_lower": "liquid_silicate",
                    "rti.temperature": 3000, "time.t_end": 4000, "output.interval": 0}
        m = self.run_program("rti", NOTE, settings).summary["metrics"]
        self.assertLess(m["energy_residual_max"], 0.01)
        self.assertGreater(m["density_ratio_min"], 0.75)


class Slowed(Case):
    """Slowed sound and inertia [docs/theory/slowed_layers.md]."""

    STIFF = {**size(24), **viscosity(1e11), "time.method": "rkl2", "output.interval": 0, "domain.length_x": 1e4, "domain.length_y": 1e4,
             "rti.wavelength": 1e4, "rti.amplitude": 5, "time.t_end": 15000}

    def growth(self, name, settings):
        """Errors of the growth rate: against the physical one, and against linear theory with what is slowed."""
        m = self.run_program("rti", name, settings).summary["metrics"]
        self.assertLess(abs(m["energy_residual_max"]), 1e-3 if "rti.volume" in settings else 1e-4)  # the density's diffusion takes energy
        return m["growth_rate"] / m["growth_rate_theory"] - 1, m["growth_rate"] / m["growth_rate_slowed"] - 1

    def test_growth(self):
        """A stiff mantle in a box of 10 km, hundreds of times fewer steps than as it is: growth is the physical one where theory says so, and
        off by as much as theory says elsewhere (n = 24: up to 0.7 % by the lattice)."""
        for zeta, xi, least, most in [(3.7, 29, -0.01, 0.01), (30, 29, 0.015, 0.03), (3.7, 90, -0.085, -0.06)]:
            with self.subTest(zeta=zeta, xi=xi):
                physical, slowed = self.growth(LINEAR, {**self.STIFF, "rti.zeta": zeta, "rti.xi": xi})
                self.assertTrue(least < physical < most, physical)
                self.assertLess(abs(slowed), 0.01)

    @unittest.skipUnless(SLOW, "slow")
    def test_other_volumes(self):
        """Density by continuity, and each liquid with its own inertia."""
        for change in [{"rti.volume": "our_method"}, {"rti.xi": 1, "rti.xi_lower": 60, "rti.xi_upper": 40}]:
            with self.subTest(**change):
                _, slowed = self.growth(LINEAR, {**self.STIFF, "rti.zeta": 3.7, "rti.xi": 29, **change})
                self.assertLess(abs(slowed), 0.01)

    @unittest.skipUnless(SLOW, "slow")
    def test_programs(self):
        """The notes' schemes: what inertia takes from growth is what theory says, beside the viscous sum's error on the lattice (a tenth here),
        which either run has."""
        for program in ("disph_c", "disph_f2", "disph_n") if SLOW else ("disph_c",):
            ratios = []
            for xi in (29, 90):
                m = self.run_program(program, LINEAR, {**self.STIFF, **MIRRORED, "rti.zeta": 3.7, "rti.xi": xi}).summary["metrics"]
                self.assertLess(abs(m["energy_residual_max"]), 1e-2)
                ratios.append(m["growth_rate"] / m["growth_rate_slowed"])
            self.assertAlmostEqual(ratios[1] / ratios[0], 1, delta=0.01)

    def test_plain_iteration(self):
        """K_T/p < 2 everywhere is what Hosono's iteration needs: stiffness over zeta^2 can have it."""
        settings = {**size(16), "time.steps": 3, "output.interval": 0, "hosono.solver": "plain", "walls.treatment": "mirror"}
        self.run_program("disph_a", NOTE, settings, expect=CALCULATION_FAILED)
        m = self.run_program("disph_a", NOTE, {**settings, "rti.zeta": 12, "time.cfl": 0.1}).summary["metrics"]
        self.assertLess(m["hosono_kappa"], 2)

    @unittest.skipUnless(SLOW, "slow")
    def test_ranks_threads_restart(self):
        self.assert_exact("disph_c", NOTE, {**size(20), "time.steps": 20, "output.interval": 0, "rti.zeta": 1.5, "rti.xi": 3}, 10, [(3, 1)])
        for name, more in [(NOTE, {}), (POSTER, {"rti.rows": "lattice"})]:
            with self.subTest(name):
                settings = {**size(20), "time.steps": 60, "rti.amplitude": 4e4, "output.interval": 0, "rti.zeta": 1.5, "rti.xi": 3, **more}
                self.assert_exact("rti", name, settings, 30, [(2, 1), (3, 1), (None, 2)] if SLOW else [(3, 1), (None, 2)] if name == NOTE else [])

    def test_refused(self):
        for program, name, change, words in [("rti", POSTER, {"rti.zeta": 2}, "balanced"), ("drop", EMULSION, {"drop.zeta": 2}, "one drop"),
                                             ("rti", NOTE, {"rti.zeta": 0.5}, "zeta"), ("disph_y", NOTE, {"rti.zeta": 2}, "equation of Y")]:
            with self.subTest(name, **change):
                result = self.call(program, *self.arguments(name, change, self.here / "none"))
                self.assertEqual(result.status, BAD_INPUT, result)
                self.assertIn(words, result.stderr)


class Melting(Case):
    def test_stefan(self):
        """A hot layer on a cold one that melts, at rest: the melt is that of conduction between two half spaces, with latent heat."""
        source = self.here / "stefan.nml"
        source.write_text("""
            &domain  length_x = 0.25  length_y = 1.0  periodic_x = .true. /
            &rti  density_upper = 7000.0  density_lower = 3000.0  bulk_modulus = 7e3  viscosity_upper = 1.0  viscosity_lower = 1.0
              heat_capacity_upper = 800.0  heat_capacity_lower = 1200.0  conductivity = 1e4  gravity = 1e-9  p_top = 0.0
              temperature_law = 'enthalpy'  temperature_upper = 4000.0  temperature_lower = 1500.0  start = 'coloured'  amplitude = 0.0 /
            &melting  curve = 'constant'  viscosity_law = 'constant' /
            &time  t_end = 4.0 /""")
        errors = []
        for n in (24, 48):
            run = self.run_program("rti", source, {"domain.particles_x": n // 4, "domain.particles_y": n, **DOUBLE})
            m = run.summary["metrics"]
            errors.append(abs(m["melt_fraction"] / m["melt_fraction_conducted"] - 1))
            self.assertLess(abs(m["heat_residual"]), 1e-12)
        self.assertLess(errors[1], 0.015)
        self.assertLess(errors[1], 0.7 * errors[0])

    def test_pond(self):
        """Liquid metal, liquid and solid silicate: the metal goes down as it melts its floor, and heat and energy are accounted for."""
        settings = {**size(20), "output.interval": 0, "time.t_end": 2500, **DOUBLE}
        m = self.run_program("rti", POND, settings).summary["metrics"]
        cold = self.run_program("rti", POND, {**settings, "rti.conductivity": 0}).summary["metrics"]
        self.assertLess(abs(m["heat_residual"]), 1e-10)
        self.assertLess(m["energy_residual_max"], 1e-3)
        self.assertGreater(m["melt_fraction"], cold["melt_fraction"] + 0.05)
        self.assertGreater(m["metal_depth"], 2 * cold["metal_depth"])

    def test_pond_in_three_dimensions(self):
        """A box of equal edges, periodic along z: heat and energy are accounted for there too, and about as much melts as in two."""
        flat = {**size(10), "kernel.name": "quintic", "output.interval": 0, "time.t_end": 1500 if SLOW else 1000, **DOUBLE}
        deep = {**flat, "domain.dimension": 3, "domain.particles_z": 10, "domain.length_z": 1e6, "domain.periodic_z": ".true."}
        m = self.run_program("rti", POND, deep).summary["metrics"]
        self.assertLess(abs(m["heat_residual"]), 1e-10)
        self.assertLess(m["energy_residual_max"], 5e-3)
        self.assertEqual(m["particles_lost"], 0)
        self.assertAlmostEqual(m["melt_fraction"], self.run_program("rti", POND, flat).summary["metrics"]["melt_fraction"], delta=0.02)

    def test_bad_input(self):
        for change, word in [({"rti.viscous_order": 4}, "viscous_order"), ({"rti.temperature_law": "isothermal"}, "enthalpy"),
                             ({"melting.solidus": 1500}, "mantle"), ({"rti.eos_upper": "liquid_iron"}, "linear"),
                             ({"rti.pond_top": 4e5}, "pond_top")]:
            with self.subTest(**change):
                result = self.call("rti", *self.arguments(POND, change, self.here / "none"))
                self.assert_says(result, BAD_INPUT, word)


class Partitioning(Case):
    def test_drop(self):
        """A drop that sinks and takes up an element: none is lost, and the uptake is that of diffusion along the radius. Measured:
        1.4 % at n = 30, 0.5 % at 60."""
        settings = {**size(30), "output.interval": 0, **DOUBLE}
        m = self.run_program("drop", PARTITIONING, settings).summary["metrics"]
        self.assertLess(m["element_mass_error"], 1e-12)
        self.assertAlmostEqual(m["equilibration_time"] / m["equilibration_time_reference"], 1, delta=0.02)
        self.assertAlmostEqual(m["equilibration"] / m["equilibration_reference"], 1, delta=0.02)
        self.assertGreater(m["equilibration"], 0.7)

    def test_equilibrium_stays(self):
        """Concentrations in equilibrium at the start, with a constant coefficient, stay as they are."""
        settings = {**size(20), "element.name": "constant", "element.partition_coefficient": 5, "element.concentration_metal": 5,
                    "time.t_end": 1000, "output.interval": 0, "drop.radius": 2e5, "drop.y": 1e6, **DOUBLE}
        source = self.here / "constant.nml"
        source.write_text((INPUTS / f"{PARTITIONING}.nml").read_text().replace("iron_ratio = 2.0", ""))
        run = self.run_program("drop", source, settings)
        self.assertAlmostEqual(run.summary["metrics"]["concentration_metal"], 5, delta=1e-12)

    def test_rti_ranks_restart(self):
        settings = {**size(20), "time.steps": 30, "output.interval": 0, "element.name": "nickel"}
        self.assert_exact("rti", POND, settings, 15, [(3, 1)] if SLOW else [])


class Drop(Case):
    def test_cylinder(self):
        """Velocity in a no-slip box against finite differences of creeping flow about a round drop; as shipped to 3 %."""
        m = self.run_program("drop", CYLINDER, {"output.interval": 0, **({} if SLOW else size(24))}).summary["metrics"]
        self.assertAlmostEqual(m["fall_velocity"] / m["fall_velocity_theory"], 1, delta=0.03 if SLOW else 0.05)

    @unittest.skipUnless(SLOW, "slow")
    def test_sphere(self):
        """Four and a half spacings in the radius are too few for better than 6 %; the shipped input has 7.2."""
        settings = {**size(18, 3), "drop.radius": 3.75e5, "drop.y": 9.75e5, "drop.measure_at": 0.6, "time.t_end": 900}
        m = self.run_program("drop", SPHERE, settings).summary["metrics"]
        self.assertAlmostEqual(m["fall_velocity"] / m["fall_velocity_theory"], 1, delta=0.06)


class Emulsion(Case):
    SMALL = {"domain.particles_x": 32, "domain.particles_y": 48, "drop.drops": 3, "drop.radius": 1.6e5, "output.interval": 0}

    def test_fall(self):
        """Of drops as they lie at the start, against the Fourier series: before they have moved by a tenth of a radius."""
        settings = {**self.SMALL, "drop.viscosity_drop": 6e12, "drop.viscosity_outside": 6e12, "time.t_end": 400,
                    "drop.measure_until": 400}
        m = self.run_program("drop", EMULSION, settings).summary["metrics"]
        self.assertAlmostEqual(m["fall_velocity"] / m["fall_velocity_theory"], 1, delta=0.03)
        self.assertAlmostEqual(m["volume_fraction"], 3 * 3.14159 * 1.6e5**2 / (9.6e5 * 1.44e6), delta=0.01)
        self.assertEqual((m["bodies_start"], m["bodies"]), (3, 3))

    def test_ranks_restart(self):
        settings = {**self.SMALL, "time.steps": 40}
        whole = self.assert_exact("drop", EMULSION, settings, 20, [(2, 1), (3, 1)] if SLOW else [])
        other = self.run_program("drop", EMULSION, {**settings, "drop.seed": 2}).summary
        self.assertNotEqual(other["state_hash"], whole["state_hash"])

    @unittest.skipUnless(SLOW, "slow")
    def test_coalescence(self):
        """Two drops side by side, without weight: tension draws them into one, whose circumference is 1/sqrt(2) of both theirs (0.98 of
        it, as the colour finds it); without tension nothing moves."""
        source = self.here / "two.nml"
        source.write_text("""
            &domain  length_x = 1.0  length_y = 1.0  particles_x = 32  particles_y = 32  periodic_x = .true. /
            &drop  places_x = 0.33, 0.67  places_y = 0.5, 0.5  radius = 0.14  density_drop = 1.0  density_outside = 1.0
              bulk_modulus = 1000.0  viscosity_drop = 0.3  viscosity_outside = 0.3  gravity = 1e-9  p_top = 50.0  surface_tension = 1.0 /
            &time  t_end = 1.2 /
            &output  interval = 0.0 /""")
        m = self.run_program("drop", source).summary["metrics"]
        self.assertEqual((m["bodies_start"], m["bodies"], m["largest_body"]), (2, 1, 1))
        self.assertAlmostEqual(m["surface_excess"], 0.98 / 2**0.5, delta=0.03)
        m = self.run_program("drop", source, {"drop.surface_tension": 0, "time.t_end": 0.3}).summary["metrics"]
        self.assertEqual((m["bodies_start"], m["bodies"], m["largest_body"]), (2, 2, 0.5))

    def test_bad_input(self):
        for change, word in [({"drop.drops": 40}, "do not fit"), ({"drop.measure_at": 0.6}, "measure_at"),
                             ({"drop.measure_until": 2e4}, "end of the run")]:
            with self.subTest(**change):
                result = self.call("drop", *self.arguments(EMULSION, change, self.here / "none"))
                self.assert_says(result, BAD_INPUT, word)


class SurfaceTension(Case):
    """A liquid drop in another without weight, radius a quarter of the box, in units of tension and box."""

    def drop(self, n=24, program="drop", **more):
        source = self.here / "weightless.nml"
        source.write_text("""
            &domain  length_x = 1.0  length_y = 1.0  length_z = 1.0 /
            &drop  density_drop = 1.0  density_outside = 1.0  bulk_modulus = 1000.0  viscosity_drop = 0.3  viscosity_outside = 0.3
              gravity = 1e-9  p_top = 50.0  radius = 0.25  y = 0.5  measure_at = 0.4  surface_tension = 1.0 /
            &time  t_end = 0.5 /
            &output  interval = 0.0 /""")
        return self.run_program(program, source, {**size(n, more.get("domain.dimension", 2)), **more}).summary

    def test_laplace(self):
        """Pressure inside: sigma/R in two dimensions, 2 sigma/R in three; the area that the colour finds; what moves at rest."""
        finer = [({"n": 32}, 0.05)] if SLOW else []
        for change, delta in [({}, 0.1), *finer,
                              ({"n": 16, "domain.dimension": 3, "drop.radius": 0.3, "kernel.name": "quintic", "time.t_end": 0.08}, 0.1)]:
            with self.subTest(**change):
                m = self.drop(**change)["metrics"]
                self.assertAlmostEqual(m["laplace_pressure"] / m["laplace_pressure_theory"], 1, delta=delta)
                self.assertAlmostEqual(m["surface_excess"], 1, delta=0.05)
                self.assertLess(m["energy_residual_max"], 0.01)

    def test_square_becomes_round(self):
        """Its circumference is 2/sqrt(pi) of the circle's, less what smoothing takes at the corners; relaxation takes eta R/sigma or so,
        0.075. Then nothing moves: sigma/eta is 3.3."""
        start = self.drop(**{"drop.shape": "square", "time.steps": 1})["metrics"]["surface_excess"]
        m = self.drop(**{"drop.shape": "square", "time.t_end": 1.0})["metrics"]
        self.assertLess(m["surface_excess"], start - 0.03)
        self.assertAlmostEqual(m["laplace_pressure"] / m["laplace_pressure_theory"], 1, delta=0.1)
        self.assertLess(m["v_rms"], 0.005)

    def test_oscillation(self):
        """Period of the viscous mode in a round box of this width, 1.10 (docs/figures/drop_oscillation.py); smoothing costs (h/R)^2: 7 % at 32, 4 %
        at 48."""
        m = self.drop(32, **{"drop.elongation": 1.2, "drop.density_drop": 7, "drop.density_outside": 3, "drop.bulk_modulus": 2000,
                             "drop.p_top": 100, "drop.viscosity_drop": 5e-3, "drop.viscosity_outside": 5e-3, "time.t_end": 2.2,
                             "walls.floor": "free_slip", "walls.lid": "free_slip"})["metrics"]
        self.assertAlmostEqual(m["oscillation_period"] / 1.10, 1, delta=0.09)
        self.assertAlmostEqual(m["oscillation_period_theory"], 1.04, delta=0.01)  # without viscosity and box
        self.assertLess(m["energy_residual_max"], 0.01)

    def test_by_the_number_density_of_a_program(self):
        """disph_n has the same volumes and pressures, and so the same tension: pressure inside a drop at rest, period as above."""
        weightless = {"drop.density_drop": 7, "drop.density_outside": 3, "drop.bulk_modulus": 2000, "drop.p_top": 100, "drop.viscosity_drop": 5e-3,
                      "drop.viscosity_outside": 5e-3, "walls.slip_bottom": "free_slip", "walls.slip_top": "free_slip"}
        m = self.drop(24, "disph_n")["metrics"]
        self.assertAlmostEqual(m["laplace_pressure"] / m["laplace_pressure_theory"], 1, delta=0.1)
        m = self.drop(32, "disph_n", **weightless, **{"drop.elongation": 1.2, "kernel.name": "wendland_c4", "time.t_end": 2.2})["metrics"]
        self.assertAlmostEqual(m["oscillation_period"] / 1.10, 1, delta=0.09)
        self.assertLess(m["energy_residual_max"], 0.01)
        short = {"domain.particles_x": 24, "domain.particles_y": 48, "time.steps": 20, "output.interval": 0}
        self.assert_exact("disph_n", TENSION, short, 10, [(2, 1), (None, 2)])

    def test_iron_in_magma(self):
        """Bond number 9: the drop flattens. Without tension it flattens more. Ranks and a restart change nothing."""
        settings = {"domain.particles_x": 24, "domain.particles_y": 48, "time.t_end": 0.12, "output.interval": 0}
        run = self.run_program("drop", TENSION, settings).summary
        m = run["metrics"]
        self.assertAlmostEqual(m["bond_number"], 9, delta=0.1)
        self.assertLess(m["energy_residual_max"], 0.01)
        self.assertLess(m["mach_max"], 0.1)
        same = {**settings, "drop.surface_tension": 0, "drop.reference_pressure": "none"}
        free = self.run_program("drop", TENSION, same).summary["metrics"]
        self.assertLess(free["stretch"], m["stretch"] - 0.02)
        short = {**settings, "time.steps": 40}
        self.assert_exact("drop", TENSION, short, 20, [(2, 1)] if SLOW else [])

    def test_bad_input(self):
        result = self.call("drop", *self.arguments(TENSION, {"drop.volume": "our_method"}, self.here / "none"))
        self.assert_says(result, BAD_INPUT, "surface_tension")

    def test_tension_in_the_contact_is_told_of(self):
        """Where the pressure does not hold the contact's particles together the run says so, and elsewhere it does not."""
        for pressure, warned in [(0, True), (3e3, False)]:  # 0.2 sigma/dx: 1000 Pa, told of below twice that
            with self.subTest(p_top=pressure):
                run = self.run_program("drop", TENSION, {"drop.p_top": pressure, "drop.surface_tension": 20, "drop.y": 0.22, "time.steps": 1,
                                                         "domain.particles_x": 30, "domain.particles_y": 60, "output.interval": 0})
                self.assertEqual("raise p_top" in (run.directory / "run.log").read_text(), warned)


if __name__ == "__main__":
    unittest.main()
