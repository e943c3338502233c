"""Planets whose rock melts and whose metal takes up an element: states, budgets, uptake beside diffusion along the radius, ranks, restarts, wrong input."""

import json
import unittest

import h5py
import numpy as np
from running import BAD_INPUT, INPUTS, Case

SMALL = {"planet.particles": 500, "output.interval": 0}
COLDER = {**SMALL, "planet.surface_temperature": 2250}  # the ocean liquid, the interior solid
IRON = 1  # of a core and a mantle; of planet_metal: 0 the ocean, 1 the metal, 2 the interior


def solidus(p):
    return np.where(p <= 20e9, 1661.2 * (p / 1.336e9 + 1.0) ** (1.0 / 7.437), 2081.8 * (p / 101.69e9 + 1.0) ** (1.0 / 1.226))


def liquidus(p):
    return np.where(p <= 20e9, 1982.1 * (p / 6.594e9 + 1.0) ** (1.0 / 5.374), 78.74 * (p / 4.054e6 + 1.0) ** (1.0 / 2.44))


def blended(T, f):
    solid, liquid = 3.8e9 * np.exp(3.5e5 / (8.31446261815324 * T)), 2.4e-4 * np.exp(4600.0 / (T - 1000.0))
    s = 0.5 * (1.0 + np.tanh((f - 0.4) / 0.15))
    return np.exp((1.0 - s) * np.log(solid) + s * np.log(liquid))


def uptake(r, rho, D, P, in_core, times):
    """Mean concentration of the core, by mass, where c is 1 outside of it at the start: m dc/dt = flux, with u = c in rock and c/P in metal continuous, in
    shells between the radii r of densities rho; implicit steps."""
    c = np.where(in_core, 0.0, 1.0)
    to_u = np.where(in_core, 1.0 / P, 1.0)
    mass = rho * (r[1:] ** 3 - r[:-1] ** 3) / 3.0
    middle = 0.5 * (r[1:] + r[:-1])
    k = rho * D / to_u
    resistance = (r[1:-1] - middle[:-1]) / k[:-1] + (middle[1:] - r[1:-1]) / k[1:]
    flow = r[1:-1] ** 2 / resistance
    A = np.zeros((c.size, c.size))
    n = np.arange(flow.size)
    A[n, n] -= flow * to_u[:-1]
    A[n, n + 1] += flow * to_u[1:]
    A[n + 1, n + 1] -= flow * to_u[1:]
    A[n + 1, n] += flow * to_u[:-1]
    A /= mass[:, None]
    means, t = [], 0.0
    for end in times:
        steps = 40
        half = 0.5 * (end - t) / steps * A
        advance = np.linalg.solve(np.eye(c.size) - half, np.eye(c.size) + half)
        for _ in range(steps):
            c = advance @ c
        t = end
        means.append((mass * c)[in_core].sum() / mass[in_core].sum())
    return np.array(means)


class Melting(Case):
    def last(self, result):
        with h5py.File(sorted(result.directory.glob("snapshot_*.h5"))[-1]) as file:
            return {name: values[:] for name, values in file["PartType0"].items()}

    def first_line(self, result):
        header, rows = result.rows()
        return dict(zip([name.split(" ")[0] for name in header], map(float, rows[0])))

    def test_state(self):
        """Melt fraction and viscosity follow from pressure and temperature, latent heat is in the internal energy, and metal does not melt."""
        for temperature in (2250, 2400):
            run = self.run_program("planet", "planet_metal", {**SMALL, "planet.surface_temperature": temperature, "time.t_end": 500})
            now = self.last(run)
            T, p, f, rock = now["Temperature"], now["Pressure"], now["MeltFraction"], now["Material"] != 1
            right = np.clip((T - solidus(p)) / (liquidus(p) - solidus(p)), 0.0, 1.0)
            self.assertLess(np.abs(f - right)[rock].max(), 1e-8)
            self.assertTrue((f[~rock] == 0.0).all())
            present = {"solid" if value == 0.0 else "liquid" if value == 1.0 else "mush" for value in f[rock]}
            self.assertTrue(present >= ({"solid", "liquid"} if temperature == 2250 else {"mush", "liquid"}), present)
            self.assertTrue(np.allclose(now["Viscosity"][rock], np.clip(blended(T[rock], f[rock]), 1e12, 1e13), rtol=1e-6))
            self.assertTrue((now["Viscosity"][~rock] == 1e12).all())
        # The start has the profile's temperature, and what latent heat adds to its energy is that of its melt.
        with_heat, without = (self.run_program("planet", "planet_metal", {**COLDER, "time.steps": 1, "melting.latent_heat": L}) for L in (4e5, 0.0))
        first, other = self.first_line(with_heat), self.first_line(without)
        self.assertAlmostEqual(first["melt_fraction"], other["melt_fraction"], delta=0.02)
        added = 4e5 * first["melt_fraction"] * now["Masses"][rock].sum()
        self.assertAlmostEqual((first["internal_energy"] - other["internal_energy"]) / added, 1.0, delta=1e-6)

    def test_metal_sinks_through_rock_that_melts(self):
        """Budgets: what gravity releases is heat, latent heat and motion; nothing of the element is lost; and a stiff interior holds the metal up."""
        of_interior = {}
        for most, inertia in ((1e12, 0.0), (1e14, 2e13)):
            run = self.run_program("planet", "planet_metal", {**COLDER, "time.t_end": 2500, "expert.viscosity_max": most, "expert.inertia_viscosity": inertia})
            m = run.summary["metrics"]
            first = self.first_line(run)
            released = -m["gravitational_energy_change"]
            self.assertGreater(released, 1e28)
            self.assertAlmostEqual((m["internal_energy_change"] + m["kinetic_energy_change"]) / released, 1.0, delta=0.002)
            self.assertLess(abs(m["element_mass_drift"]), 1e-14)
            self.assertGreater(m["melt_fraction"], first["melt_fraction"])
            self.assertEqual(first["concentration_metal"], 0.0)
            self.assertTrue(0.02 < m["equilibration"] < 1.0, m["equilibration"])
            now = self.last(run)
            mass, c, metal = now["Masses"], now["Concentration"], now["Material"] == 1
            self.assertAlmostEqual((mass * c)[metal].sum() / mass[metal].sum() / m["concentration_metal"], 1.0, delta=1e-12)
            self.assertAlmostEqual((mass * c).sum() / first["element"], 1.0, delta=1e-13)
            self.assertTrue(c.min() > -1e-12)
            header, rows = run.rows()
            of_interior[most] = float(rows[-1][[name.split(" ")[0] for name in header].index("radius_interior")]) / first["radius_interior"]
            if inertia == 0.0:  # then the forces of pairs are equal, opposite and central
                self.assertLess(m["momentum_drift"], 1e-6)
                self.assertLess(m["angular_momentum_drift"], 1e-5)
        self.assertGreater(of_interior[1e12] - 1.0, 1.5 * (of_interior[1e14] - 1.0))

    def test_raised_inertia_takes_gravity_in_each_step(self):
        """It divides gravity too: impulses over several steps would not be those of the energy. Asked for, that is refused."""
        settings = {**COLDER, "time.t_end": 100, "expert.viscosity_max": 1e14, "expert.inertia_viscosity": 2e13}
        s = self.run_program("planet", "planet_metal", settings).summary
        self.assertEqual(s["rhs_evaluations"], s["steps"] + 1)
        refused = self.run_program("planet", "planet_metal", {**settings, "expert.substeps": 2}, expect=BAD_INPUT)
        self.assertIn("inertia_viscosity", refused.stderr)

    def test_uptake_of_a_core(self):
        """A settled core takes up an element beside diffusion along the radius, solved independently: the contact is as sharp as a spacing, and the error falls
        with it. In equilibrium nothing changes."""
        text = (INPUTS / "planet_earth.nml").read_text() + "\n&element name='constant' /\n"
        path = self.here / "dissolved.nml"
        path.write_text(text)
        P, D = 3.0, 4e9
        common = {"expert.settle": 2, "time.t_end": 1200, "output.interval": 0, "element.partition_coefficient": P,
                  "element.diffusivity_silicate": D, "element.diffusivity_metal": D}
        profile = self.here / "profile.json"
        self.run_program("planet", path, common, options=["--profile", profile])
        p = json.loads(profile.read_text())
        contact, R = p["core_radius"], p["radius"]
        r = np.concatenate([np.linspace(0.0, contact, 100), np.linspace(contact, R, 100)[1:]])
        middle = 0.5 * (r[1:] + r[:-1])
        in_core = middle < contact
        known, density = np.array(p["r"]), np.array(p["density"])
        core = np.array(p["layer"]) == "core"
        rho = np.where(in_core, np.interp(middle, known[core], density[core]), np.interp(middle, known[~core], density[~core]))
        errors = []
        for particles in (500, 2000):
            m = self.run_program("planet", path, {**common, "planet.particles": particles}).summary["metrics"]
            [right] = uptake(r, rho, D, P, in_core, [1200.0])
            self.assertGreater(right, 0.5)
            errors.append(abs(m["concentration_metal"] / right - 1.0))
        self.assertLess(errors[1], 0.06)
        self.assertLess(errors[1], 0.5 * errors[0])
        still = self.run_program("planet", path, {**common, "planet.particles": 300, "element.concentration_silicate": 2.0, "element.concentration_metal": 2.0 * P,
                                                  "expert.settle": 0, "time.t_end": 400})
        c, material = self.last(still)["Concentration"], self.last(still)["Material"]
        self.assertLess(np.abs(c / np.where(material == IRON, 2.0 * P, 2.0) - 1.0).max(), 1e-12)
        self.assertEqual(still.summary["metrics"]["equilibration"], 1.0)

    def with_regions(self, *groups):
        path = self.here / "regions.nml"
        path.write_text((INPUTS / "planet_metal.nml").read_text() + "".join(f"&region {group} /\n" for group in groups))
        return path

    def test_regions(self):
        """A drop of metal in the ocean, a cold interior, a wind: each particle keeps its volume and pressure. The drop sinks."""
        within = "sqrt(x*x + y*y + z*z)"
        path = self.with_regions("material='metal' shape='sphere' radius=9e5 centre_x=3.0e6", f"temperature=1700 condition='{within} < 1.5e6'", f"velocity_y=100 condition='{within} > 3.2e6'")
        run = self.run_program("planet", path, {**SMALL, "time.t_end": 2500})
        plain = self.run_program("planet", "planet_metal", {**SMALL, "time.steps": 1})
        snapshots = []
        for result, place in ((run, 0), (run, -1), (plain, 0)):
            with h5py.File(sorted(result.directory.glob("snapshot_*.h5"))[place]) as file:
                part = {name: values[:] for name, values in file["PartType0"].items()}
            order = np.argsort(part["ParticleIDs"])
            snapshots.append({name: values[order] for name, values in part.items()})
        first, last, before = snapshots
        x = before["Coordinates"] - 0.5 * (before["Coordinates"].max(0) + before["Coordinates"].min(0))
        drop = (first["Material"] == 1) & (before["Material"] != 1)
        self.assertGreater(drop.sum(), 2)
        self.assertLess(np.abs(np.linalg.norm(x[drop] - [3.0e6, 0, 0], axis=1)).max(), 1.0e6)
        self.assertTrue(np.allclose(first["Masses"] / first["Density"], before["Masses"] / before["Density"], rtol=1e-9))
        self.assertTrue(np.allclose(first["Pressure"], before["Pressure"], rtol=1e-6, atol=1e3))
        r = np.linalg.norm(x, axis=1)
        self.assertTrue(np.allclose(first["Temperature"][r < 1.4e6], 1700.0, rtol=1e-9) and np.allclose(first["Temperature"][r > 1.7e6], 2400.0, rtol=1e-9))
        self.assertTrue((first["Velocities"][r > 3.3e6] == [0, 100, 0]).all() and (first["Velocities"][r < 3.1e6] == 0).all())
        depth = lambda now: np.linalg.norm((now["Coordinates"][drop] - (now["Masses"][:, None] * now["Coordinates"]).sum(0) / now["Masses"].sum()).mean(0))
        self.assertLess(depth(last), depth(first) - 2e5)

    def test_ranks_and_restart(self):
        self.assert_exact("planet", "planet_metal", {**SMALL, "planet.particles": 300, "time.t_end": 250, "kernel.skin": 0.1}, 7, layouts=((3, 2),))

    def test_settling(self):
        """A start that settles takes steps that what is stiffest allows, in no more of them than its sound does."""
        run = self.run_program("planet", "planet_metal", {"planet.particles": 300, "expert.settle": 0.5, "time.t_end": 100, "output.interval": 0})
        log = (run.directory / "run.log").read_text()
        self.assertLess(int(log.split("settled: ")[1].split()[0]), 500)
        self.assertLess(abs(run.summary["metrics"]["energy_drift"]), 1e-4)

    def test_a_snapshot_goes_on(self):
        """Its concentrations and its melt, in another run."""
        first = self.run_program("planet", "planet_metal", {**SMALL, "planet.particles": 300, "time.t_end": 200})
        file = sorted(first.directory.glob("snapshot_*.h5"))[-1]
        again = self.run_program("planet", "planet_metal", {**SMALL, "planet.particles": 300, "initial.file": file, "time.steps": 1})
        now, then = self.first_line(again), first.summary["metrics"]
        self.assertAlmostEqual(now["concentration_metal"] / then["concentration_metal"], 1.0, delta=1e-12)
        self.assertAlmostEqual(now["melt_fraction"] / then["melt_fraction"], 1.0, delta=0.02)

    def test_wrong_input(self):
        no_iron = self.here / "no_iron.nml"
        no_iron.write_text((INPUTS / "planet_metal.nml").read_text().replace("'iron'", "'granite'"))
        all_iron = self.here / "all_iron.nml"
        all_iron.write_text((INPUTS / "planet_metal.nml").read_text().replace("'basalt'", "'iron'"))
        for name, settings, *words in [("planet_metal", {"planet.degree": 2}, "&planet degree", "&melting"),
                                       ("planet_metal", {"layer.viscosity": 1e13}, "&layer viscosity", "'interior'", "viscosity_law"),
                                       ("planet_metal", {"planet.spin_period": 1e5}, "inertia_viscosity", "spin_period"),
                                       ("planet_metal", {"melting.curve": "none"}, "nothing melts"),
                                       ("planet_metal", {"kernel.precision": "single"}, "&kernel precision", "'double'"),
                                       ("planet_metal", {"planet.mass": 6e25}, "&melting curve", "'interior'", "solidus"),
                                       ("planet_metal", {"element.name": "constant", "element.iron_ratio": 2.0}, "iron_ratio"),
                                       ("planet_metal", {"element.concentration_silicate": 0.0}, "there is nothing of the element"),
                                       ("planet_metal", {"melting.curve": "constant", "melting.liquidus": 1600.0}, "liquidus", "above the solidus"),
                                       (no_iron, {}, "&element name", "no layer is metal"),
                                       (all_iron, {"element.name": "none"}, "&melting curve", "all layers are metal")]:
            with self.subTest(settings):
                self.assert_says(self.call("planet", *self.arguments(name, settings, self.here / "no")), BAD_INPUT, *words)
        for group, settings, *words in [("material='cheese'", {}, "&region material", "cheese", "'ocean'", "&layer"),
                                        ("velocity_x=1", {"expert.settle": 1}, "settle", "&region gives velocities"),
                                        ("temperature=2000 condition='x > 1e9'", {}, "region", "region 1"),
                                        ("temperature=2000", {"initial.file": no_iron}, "&initial file", "&region")]:
            with self.subTest(group):
                refused = self.call("planet", *self.arguments(self.with_regions(group), settings, self.here / "no"))
                self.assert_says(refused, BAD_INPUT, *words)


if __name__ == "__main__":
    unittest.main()
