"""Materials beside the two of &rti and &drop: a material counts by what it is and not by its number; layers of three rest, and turn over into
the order of their densities; the same on any ranks and over restarts; what is no material is refused."""

import pathlib
import shutil
import sys
import unittest

import h5py
import numpy as np

from running import BAD_INPUT, COMPLETED, SLOW, Case

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "programs" / "python"))
import tetsuame  # noqa: E402

L, N, G = 1.5e6, 24, 10.0
DX = L / N
BOX = f"&domain  length_x = {L}  length_y = {L}  particles_x = {N}  particles_y = {N} /\n"
LIGHT, HEAVY = (3000.0, 5e11), (7000.0, 5e11)  # density at zero pressure, kg/m3, and bulk modulus, Pa
MEDIUM = (5000.0, 2.5e11)
RTI = BOX + f"""&rti  density_upper = 7000  density_lower = 3000  bulk_modulus = 5e11  viscosity_upper = 1e11  viscosity_lower = 1e11
  gravity = {G}  p_top = 1e9  start = 'coloured'  amplitude = 0 /
&time  t_end = 1e4  steps = 4 /
&output  history_interval = 1 /
"""
SULFIDE = "&material  name = 'sulfide'  metal = 'yes'  density = 5000  bulk_modulus = 2.5e11  viscosity = 1e11 /\n"
# The programs' own box has walls of mirror images and volumes that stay with the particles (docs/theory/consistency.md).
PROGRAMS = "&kernel  name = 'wendland_c6'  h_over_dx = 3.5 /\n&walls  treatment = 'mirror'  slip = 'free_slip' /\n&volume  consistency = 'tied' /\n"


def layers(bottom, middle, top):
    """Flat ones, a third of the height each."""
    return (f"&region  material = '{bottom}' /\n&region  material = '{middle}'  condition = 'y > 5e5' /\n"
            f"&region  material = '{top}'  condition = 'y > 1e6' /\n")


def particles(run, number=0):
    with h5py.File(run.directory / f"snapshot_{number:04}.h5") as file:
        return {name: values[...] for name, values in file["PartType0"].items()}


class Materials(Case):
    def given(self, text):
        path = self.here / f"input_{len(list(self.here.iterdir()))}.nml"
        path.write_text(text)
        return path

    def test_a_twin_of_a_material_is_that_material(self):
        """Where a layer is of a &material with all that the upper one has, in the place of it, every particle moves alike to the last bit."""
        twin = "&material  name = 'twin'  metal = 'yes'  density = 7000  viscosity = 3e11 /\n"
        text = (RTI + PROGRAMS).replace("viscosity_upper = 1e11", "viscosity_upper = 3e11")
        wave = "&region material = 'lower' /\n&region material = 'upper' condition = 'y > 8e5' /\n&region material = '{}' condition = 'y > 1e6 + 1e5*cos(2*pi*x/length_x)' /\n"
        for program in ("rti", "disph_n", "disph_c", "disph_e", "disph_f2", "disph_y"):
            with self.subTest(program):
                two = particles(self.run_program(program, self.given(text + wave.format("upper"))), 1)
                three = particles(self.run_program(program, self.given(text + twin + wave.format("twin"))), 1)
                self.assertEqual(sorted(set(three["Material"])), [0, 1, 2])
                np.testing.assert_array_equal(np.minimum(three["Material"], 1), two["Material"])
                for name in ("Coordinates", "Velocities", "Density", "Pressure"):
                    np.testing.assert_array_equal(three[name], two[name], name)

    def test_layers_at_rest(self):
        """Stable ones: pressures of the exact column, p + K = (p' + K) exp(rho0 g (y' - y)/K) through each layer of p = K(rho/rho0 - 1), of
        which the rows' weights differ in the second order of the spacing; and settled they stay where they are."""
        heavy_below = RTI.replace("density_upper = 7000  density_lower = 3000", "density_upper = 3000  density_lower = 7000")
        text = heavy_below + SULFIDE.replace("  metal = 'yes'", "") + layers("lower", "sulfide", "upper")
        run = self.run_program("rti", self.given(text))
        f = particles(run)
        y = f["Coordinates"][:, 1]
        p, above, exact = 1e9, L, np.zeros_like(y)
        for bottom, (rho0, K) in ((1e6, LIGHT), (5e5, MEDIUM), (0.0, HEAVY)):
            inside = (y > bottom) & (y < above)
            exact[inside] = (p + K) * np.exp(rho0 * G * (above - y[inside]) / K) - K
            p, above = (p + K) * np.exp(rho0 * G * (above - bottom) / K) - K, bottom
        rho0, K = np.select([y > 1e6, y > 5e5], [LIGHT[0], MEDIUM[0]], HEAVY[0]), np.where((y > 5e5) & (y < 1e6), MEDIUM[1], 5e11)
        pressure = K * (f["Masses"] / DX**2 / rho0 - 1)
        np.testing.assert_allclose(pressure, exact, rtol=1e-3)
        metrics = run.summary["metrics"]
        self.assertAlmostEqual(metrics["mass_sulfide"], f["Masses"][f["Material"] == 2].sum(), delta=1e-9 * f["Masses"].sum())
        self.assertLess(abs(metrics["centroid_sulfide"] - 0.5), 0.01)
        self.assertIn("centroid_sulfide [1]", run.rows()[0])
        for program, more in (("rti", ""), ("disph_n", PROGRAMS), ("disph_c", PROGRAMS)):
            with self.subTest(program):
                # Of a contact of 7000 over 3000 kg/m3 the residual is 0.50 g unsettled, an error of the sums (docs/own_start.md): of steps half as
                # large it is half, and 0.3 of that is left by settling. What then rings is damped; overturning layers have 700 m/s.
                settled = self.run_program(program, self.given(text + more), {"initial.settle": 4, "time.steps": 200}).summary["metrics"]
                self.assertLess(settled["equilibrium_residual"], 0.15)
                self.assertLess(settled["v_rms"], 3.0)
                self.assertLess(abs(settled["centroid_sulfide"] - metrics["centroid_sulfide"]), 0.1 / N)  # a tenth of a spacing
        self.assertLess(metrics["equilibrium_residual"], 0.35)

    @unittest.skipUnless(SLOW, "slow")
    def test_they_turn_over_into_the_order_of_their_densities(self):
        """Heavy over light over medium: at the end the heavy one lies lowest, and the light one highest."""
        text = RTI + PROGRAMS + SULFIDE + layers("sulfide", "lower", "upper") + "&region material = 'upper' condition = 'y > 9e5 + 5e4*cos(2*pi*x/length_x)' /\n"
        for program in ("rti", "disph_n", "disph_c"):
            with self.subTest(program):
                run = self.run_program(program, self.given(text), {"time.t_end": 6000, "time.steps": 100000, "output.history_interval": 10})
                f = particles(run, 1)
                light, heavy, medium = (f["Coordinates"][f["Material"] == n, 1].mean() for n in range(3))
                self.assertLess(heavy, medium - 1e5)
                self.assertLess(medium, light - 1e5)
                self.assertLess(run.summary["metrics"]["energy_residual_max"], 0.05)
                self.assertEqual(run.summary["metrics"]["particles_lost"], 0)

    def test_exact_on_ranks_and_over_restarts(self):
        text = RTI + PROGRAMS + SULFIDE.replace("1e11", "3e11") + layers("sulfide", "lower", "upper")
        for program in ("rti", "disph_n", "disph_c"):
            with self.subTest(program):
                self.assert_exact(program, self.given(text), {}, 2, [(2, 1), (3, 1)])
        drop = BOX + ("&drop  density_drop = 7000  density_outside = 3000  bulk_modulus = 5e11  viscosity_drop = 1e11  viscosity_outside = 1e11  p_top = 1e9\n"
                      "  radius = 2e5 /\n&time  steps = 4 /\n&output  history_interval = 1 /\n")
        shell = "&region  material = 'sulfide'  shape = 'sphere'  radius = 3e5  centre_x = 7.5e5  centre_y = 1e6 /\n&region  material = 'drop'  shape = 'sphere'  radius = 2e5  centre_x = 7.5e5  centre_y = 1e6 /\n"
        self.assert_exact("drop", self.given(drop + SULFIDE + shell), {}, 2, [(3, 1)])

    def test_properties_of_each(self):
        """Conductivity, heat capacity, melting and an equation of state of its own: heat goes where there is a conductivity, and what melts
        holds the part (T - T_s)/(T_l - T_s) of melt (docs/theory/core_formation.md)."""
        heat = RTI.replace("start = ", "temperature_law = 'enthalpy'  temperature = 1500  start = ")
        crust = ("&material  name = 'crust'  density = 2700  viscosity = 1e11  heat_capacity = 900  conductivity = 4e12  temperature = 1450\n"
                 "  melts = 'yes'  solidus = 1400  liquidus = 1500  latent_heat = 3e5 /\n&melting  curve = 'constant'  solidus = 1700  liquidus = 2000 /\n")
        f = particles(self.run_program("rti", self.given(heat + crust + layers("upper", "lower", "crust")), {"time.steps": 0}))
        of_crust = f["Material"] == 2
        np.testing.assert_allclose(f["MeltFraction"], np.where(of_crust, 0.5, 0.0), atol=1e-12)
        np.testing.assert_allclose(f["Temperature"], np.where(of_crust, 1450, 1500), rtol=1e-12)
        # Below its solidus a wave of 100 K decays as k/(rho c) k_x^2 says, and no heat leaves the only material that conducts.
        wave = "&region  condition = 'y > 1e6'  temperature = '1200 + 100*cos(2*pi*x/length_x)' /\n"
        run = self.run_program("rti", self.given(heat + crust + layers("upper", "lower", "crust") + wave), {"time.steps": 10})
        before, after = particles(run), particles(run, 1)
        warmed, inside = after["Temperature"] - before["Temperature"], before["Coordinates"][:, 1] > 1.2e6
        rate = 4e12 / (before["Density"] * 900) * (2 * np.pi / L) ** 2
        np.testing.assert_allclose(warmed[inside], (-rate * run.summary["time"] * (before["Temperature"] - 1200))[inside], atol=0.03 * abs(warmed).max())
        self.assertLess(abs(warmed[before["Material"] < 2]).max(), 0.01 * abs(warmed).max())
        granite = "&material  name = 'granite'  eos = 'tillotson'  tillotson = 'granite'  viscosity = 1e12 /\n"
        cold = RTI.replace("start = ", "temperature = 300  start = ")
        f = particles(self.run_program("rti", self.given(cold + granite + layers("lower", "upper", "granite")), {"time.steps": 0}))
        top = f["Coordinates"][:, 1] > L - DX
        rho = f["Masses"][top] / DX**2
        # Tillotson's granite when cold: p = A mu + B mu^2, rho0 2680 kg/m3, A = B = 18 GPa [Melosh 1989]; the energy on the isotherm adds 3 %.
        mu = rho / 2680 - 1
        np.testing.assert_allclose(18e9 * mu * (1 + mu), 1e9 + 0.5 * G * DX * rho, rtol=0.05)

    def test_from_a_file(self):
        text = RTI + SULFIDE
        first = self.run_program("rti", self.given(text + layers("sulfide", "lower", "upper")))
        file = first.directory / "snapshot_0000.h5"
        with h5py.File(file) as snapshot:
            self.assertEqual(snapshot["PartType0/Material"].attrs["names"], b"lower, upper, sulfide")
        picture = tetsuame.load(first.directory).snapshot(time=0.0).map("Material")
        self.assertEqual(picture.names, ("lower", "upper", "sulfide"))
        for y, material in ((2.5e5, 2), (7.5e5, 0), (1.25e6, 1)):  # pixels of one material each, with no other between two
            self.assertTrue((picture.values[abs(picture.y - y) < 2e5] == material).all())
        again = self.run_program("rti", self.given(text), {"initial.file": file, "time.steps": 1})
        np.testing.assert_array_equal(particles(again)["Material"], particles(first)["Material"])
        # Other numbers of the same names: the same start.
        permuted = shutil.copy(file, self.here / "permuted.h5")
        with h5py.File(permuted, "r+") as snapshot:
            material = snapshot["PartType0/Material"]
            material[...] = (material[...] + 1) % 3
            material.attrs["names"] = "sulfide, lower, upper"
        same = self.run_program("rti", self.given(text), {"initial.file": permuted, "time.steps": 1})
        self.assertEqual(same.summary["state_hash"], again.summary["state_hash"])
        other = "&material  name = 'crust'  density = 2700  viscosity = 1e11 /\n"
        renumbered = self.run_program("rti", self.given(RTI + other + SULFIDE), {"initial.file": file, "time.steps": 1}, expect=BAD_INPUT)
        self.assert_says(renumbered, BAD_INPUT, "none of the 576 particles", "material 2 ('crust')")
        self.assert_says(self.call("rti", *self.arguments(self.given(RTI + other), {"initial.file": file}, self.here / "none")), BAD_INPUT,
                         "its Material 2 is 'sulfide'", "'crust'")
        self.assert_says(self.call("rti", *self.arguments(self.given(RTI), {"initial.file": file}, self.here / "none")), BAD_INPUT,
                         "its Material 2 is 'sulfide'", "'lower', 'upper'")
        self.assertFalse((self.here / "none").exists())

    def test_an_input_as_resolved_is_the_same(self):
        """Lists with elements left open: what --check prints means the same."""
        more = "&material  name = 'granite'  eos = 'tillotson'  tillotson = 'granite'  viscosity = 1e12 /\n" + SULFIDE
        text = RTI + more + layers("sulfide", "lower", "granite") + "&region material = 'upper' condition = 'y > 1.3e6' /\n"
        first = self.call("rti", self.given(text), "--check")
        self.assertEqual(first.status, COMPLETED, first)
        self.assertIn("density = 1*, 5000", first.stdout)
        resolved = self.run_program("rti", self.given(text))
        again = self.run_program("rti", resolved.directory / "resolved.nml")
        self.assertEqual(again.summary["state_hash"], resolved.summary["state_hash"])

    def test_what_is_refused(self):
        material = "&material  name = 'crust'  density = 2700  viscosity = 1e12 {} /\n"
        crust = "&region  material = 'crust'  condition = 'y > 1.3e6' /\n&region  material = 'upper'  condition = 'y < 5e5' /\n"
        cases = [
            (material.format("") + crust.replace("'crust'", "'crst'"), ["input", ":7: &region material", "no material 'crst'", "'lower'", "nearest is 'crust'"]),
            (material.format("") + material.format(""), [":7: &material name", "called 'crust'"]),
            (material.format("").replace("'crust'", "'Lower'"), [":6: &material name", "called 'lower'"]),
            (material.format("").replace("'crust'", "'the crust'"), [":6: &material name", "letters", "'the crust'"]),
            ("&material  density = 2700  viscosity = 1e12 /\n", [":6: &material viscosity", "the 1. &material has no name"]),
            (material.format(""), [":6: &material name", "nothing of 'crust' is in the box"]),
            (material.format("") + crust + "&region material = 'lower' condition = 'y > 1.2e6' /\n", ["&region", "none of the 576 particles", "'crust'"]),
            ("&material  name = 'crust'  viscosity = 1e12 /\n" + crust, [":6: &material name", "'crust' has no density"]),
            ("&material  name = 'crust'  density = 2700 /\n" + crust, [":6: &material name", "'crust' has no viscosity"]),
            (SULFIDE + material.format("gruneisen = 1.5") + crust, [":7: &material gruneisen", "of 'crust'", "'linear' has density"]),
            (material.format("eos = 'vinet'") + crust, [":6: &material eos", "'vinet'", "nearest"]),
            (material.format("eos = 'liquid_iron'") + crust, [":6: &material density", "linear"]),
            ("&material  name = 'crust'  eos = 'liquid_iron'  debye_temperature = 300  viscosity = 1e12 /\n" + crust,
             [":6: &material eos", "of 'crust'", "debye_temperature"]),
            ("&material  name = 'crust'  eos = 'tillotson'  tillotson = 'chalk'  viscosity = 1e12 /\n" + crust, [":6: &material eos", "'chalk'"]),
            (material.format("table = 'none.txt'") + crust, ["table"]),
            (material.format("viscosity_upper = 1") + crust, ["unknown key viscosity_upper", "nearest valid key is viscosity"]),
            (material.format("metal = 'perhaps'") + crust, ["&material metal", "'no', 'yes'"]),
            (material.format("melts = 'yes'") + crust, [":6: &material melts", "&melting curve is 'none'"]),
            (material.format("solidus = 1400") + crust, [":6: &material solidus", "melts = 'yes'"]),
            (material.format("temperature = 1400") + crust, [":6: &material temperature", "'enthalpy'"]),
            (SULFIDE + layers('lower', 'sulfide', 'upper') + "&expert zeta = 2 /\n", ["&expert zeta", "&material"]),
            (material.format("conductivity = 4") + crust, [":6: &material conductivity", "one temperature"]),
            (material.format("conductivity = -4") + crust, ["&material conductivity", ">= 0"])]
        for more, parts in cases:
            with self.subTest(more=more):
                result = self.call("rti", *self.arguments(self.given(RTI + more), {}, self.here / "none"))
                self.assert_says(result, BAD_INPUT, *parts)
                self.assertFalse((self.here / "none").exists())
        at_rest = BOX + "&material viscosity = 0 /\n&material eos = 'linear' /\n"
        self.assert_says(self.call("disph_c", self.given(at_rest), "--check"), BAD_INPUT, ":3: group &material was given before, in line 2")


if __name__ == "__main__":
    unittest.main()
