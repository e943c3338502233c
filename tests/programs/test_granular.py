"""Grains: impacts beside Hertz, Coulomb and an integration of their own, energy, sizes, ranks, restarts, gates, wrong input."""

import math
import unittest

from running import BAD_INPUT, INPUTS, SLOW, Case, outcome

BED = """&domain dimension = 3  length_x = 0.012  length_y = 0.02  length_z = 0.012  periodic_x = T  periodic_z = T /
&granular rolling = 'spring' /
&gravity incline = 24 /
&material name = 'a'  density = 2500  young_modulus = 1e7  restitution = 0.6  friction = 0.5  rolling_friction = 0.1 /
&material name = 'b'  density = 3500  young_modulus = 3e7  restitution = 0.8  friction = 0.3  rolling_friction = 0.2 /
&walls top = 'open' /
&packing radius = 0.0003  radius_max = 0.0005  high_y = 0.005  jitter = 1  random_velocity = 0.3 /
&packing radius = 0.0005  low_y = 0.005  high_y = 0.008  jitter = 1  material = 'b'  random_velocity = 0.3 /
&time t_end = 1 /
"""


def oblique(E, nu, rho, R, e, mu, v_t, v_n, spin, rigid, steps=40000):
    """(v_t, spin) of a sphere after it has met a plane, by small steps of semi-implicit Euler: Hertz's spring with Tsuji's dashpot, Mindlin's spring whose
    force shrinks with the radius of the contact. The plane is rigid, or of the same material."""
    m, G = 4.0 / 3.0 * math.pi * R**3 * rho, E / (2.0 * (1.0 + nu))
    E_star, G_star = E / (1.0 - nu * nu), G / (2.0 - nu)
    if not rigid:
        E_star, G_star = 0.5 * E_star, 0.5 * G_star
    k = 4.0 / 3.0 * E_star * math.sqrt(R)
    # Damping by bisection of the restitution that comes out, with the force cut at 0.
    def rebound(alpha):
        y, v, dt = 0.0, 1.0, 1e-3
        while True:
            F = y**1.5 + alpha * y**0.25 * v if y > 0 else 0.0
            if y > 0.0 and F <= 0.0:
                return -v
            v -= dt * F
            y += dt * v
            if y < 0.0:
                return -v
    low, high = 0.0, 10.0
    for _ in range(40 if e < 1.0 else 0):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if rebound(middle) > e else (low, middle)
    alpha = 0.0 if e >= 1.0 else 0.5 * (low + high)
    delta_max = (1.25 * m * v_n * v_n / k) ** 0.4
    dt = 6.0 * delta_max / v_n / steps
    x, v, u, w, Q, a_before, I = 0.0, v_n, v_t, spin, 0.0, 0.0, 0.4 * m * R * R  # overlap, its rate; along the plane, counterclockwise
    for _ in range(steps):
        x += dt * v
        if x <= 0.0:
            break
        F = max(0.0, k * x**1.5 + alpha * math.sqrt(m * k) * x**0.25 * v)
        a = math.sqrt(R * x)
        slip = u + (R - x) * w
        if a < a_before:
            Q *= a / a_before
        a_before = a
        Q -= 8.0 * G_star * a * dt * slip
        if abs(Q) > mu * F:
            Q = math.copysign(mu * F, Q)
            T = Q
        else:
            T = Q - alpha * math.sqrt(m * 8.0 * G_star * a) * slip
            T = math.copysign(min(abs(T), mu * F), T)
        v -= dt * F / m
        u += dt * T / m
        w += dt * (R - x) * T / I
        if F == 0.0 and v < 0.0:
            break
    return u, w


class Granular(Case):
    def metrics(self, name, settings=None, label=None):
        return self.run_program("granular", name, {"output.history_interval": 1000, **(settings or {})}, label or name).summary["metrics"]

    def near(self, value, expected, part):
        self.assertLessEqual(abs(value - expected), part * abs(expected), f"{value} for {expected}")

    def test_shipped_inputs(self):
        """All that are this program's begin."""
        own = [path for path in sorted(INPUTS.glob("*.nml")) if "&grain" in path.read_text() or "&packing" in path.read_text()]
        self.assertGreater(len(own), 11)
        for path in own:
            self.run_program("granular", path, {"time.steps": 2, "output.interval": 0}, path.stem)

    def test_head_on(self):
        """Chung & Ooi 1 and 2: Hertz's overlap, force and time."""
        limestone = {"material.young_modulus": 2e10, "material.poisson_ratio": 0.25, "material.density": 2500}
        magnesium = {"material.young_modulus": "4e10,1e30", "material.poisson_ratio": "0.35,0.3", "material.density": "1800,1"}
        for name, settings, values in [("collision_1", {}, (274.113e-6, 10696.9, 40.339e-6)), ("collision_1", limestone, (368.304e-6, 7108.24, 54.201e-6)),
                                       ("collision_2", {}, (49.7172e-6, 11369.9, 731.657e-6)), ("collision_2", magnesium, (52.1233e-6, 7232.68, 767.066e-6))]:
            with self.subTest(name, **settings):
                m = self.metrics(name, settings, f"{name}_{len(settings)}")
                for key, expected in zip(("delta_max", "force_max", "contact_time"), values):
                    self.near(m[key], expected, 1e-4)
                self.near(m["restitution_normal"], 1.0, 1e-5)

    def test_restitution(self):
        """What comes out is what goes in, at any speed, for both kinds of contact."""
        for e in (0.1, 0.4, 0.75, 0.95):
            for v in (0.039, 3.9):
                m = self.metrics("collision_3", {"material.restitution": e, "grain.velocity_y": -v, "time.t_end": 2e-5 if v > 1 else 6e-5}, f"hertz_{e}_{v}")
                self.near(m["restitution_normal"], e, 1e-3)
            path = self.here / "hooke.nml"
            path.write_text(f"""&domain length_x = 0.02  length_y = 0.02 /
&gravity g = 0 /
&granular contact = 'hooke'  stiffness = 1e4 /
&material density = 2500  restitution = {e} /
&grain radius = 0.001  x = 0.01  y = 0.001  velocity_y = -0.5 /
&time cfl = 0.002  t_end = 1e-3 /
""")
            m = self.run_program("granular", path, {}, f"hooke_{e}").summary["metrics"]
            # A dashpot that acts from the first touch on is caught in the middle of a step: of first order.
            self.near(m["restitution_normal"], e, 1e-3 if e > 0.1 else 4e-3)

    def test_sliding(self):
        """Chung & Ooi 4 and 6: a sphere that slides to the end."""
        for angle, e_t, spin in [(50, 0.84715, 456.65), (60, 0.89483, 355.21)]:
            m = self.metrics("collision_4", {"grain.velocity_x": 3.9 * math.sin(math.radians(angle)), "grain.velocity_y": -3.9 * math.cos(math.radians(angle))},
                             f"angle_{angle}")
            self.near(m["restitution_tangential"], e_t, 1e-3)
            self.near(m["spin"], spin, 5e-3)
        m = self.metrics("collision_6", {"grain.spin_z": 22}, "spin")
        self.near(22 - m["spin_z"], 3.0, 1e-3)

    def test_sticking(self):
        """Chung & Ooi 5 and 6, where the contact sticks for a part of the time, beside an integration of their own."""
        for v_t in (0.3, 1.0, 5.0, 15.0):
            m = self.metrics("collision_5", {"grain.velocity_x": v_t}, f"steel_{v_t}")
            u, w = oblique(2.08e11, 0.3, 7850, 1e-5, 1.0, 0.3, v_t, 5.0, 0.0, rigid=False)
            self.assertLess(abs(m["velocity_x"] - u), 3e-3 * v_t)
            self.near(m["spin_z"], w, 1e-2)
        for spin in (0.5, 2.0, 7.0):
            m = self.metrics("collision_6", {"grain.spin_z": spin}, f"turning_{spin}")
            u, w = oblique(7e10, 0.33, 2700, 0.1, 0.5, 0.4, 0.0, 0.2, spin, rigid=True)
            self.near(m["velocity_x"], u, 1e-2)
            self.assertLess(abs(m["spin_z"] - w), 5e-3 * spin)

    def test_two_spheres(self):
        """Chung & Ooi 7 and 8: momentum is kept, and what the spins lose is the angular momentum that the centres gain."""
        result = self.run_program("granular", "collision_8", {"time.t_end": 1.5e-3, "output.history_interval": 50})
        self.near(result.summary["metrics"]["restitution_normal"], 0.5, 1e-3)
        _, rows = result.rows()
        for column in (13, 14):  # momentum_x, momentum_y
            p = [float(row[column]) for row in rows]
            self.assertLess(max(p) - min(p), 1e-12 * abs(float(rows[0][13])))
        slides = self.metrics("collision_7", {"grain.spin_z": "22,22"}, "slides")
        # Each loses 5/2 mu (1 + e) v/R.
        self.near(22 - slides["spin_z"], 2.5 * 0.4 * 1.5 * 0.2 / 0.1, 1e-3)
        self.near(abs(slides["velocity_y"]), 0.4 * 1.5 * 0.2, 1e-3)

    def test_adhesion(self):
        """JKR: an elastic sphere on a plane sticks below the speed of Thornton and Ning (1998), and loses a fixed energy above it; it is held by 3/2 pi w R."""
        R, rho, E, nu, w = 1e-5, 2500.0, 1e9, 0.25, 0.2
        E_star, m = E / (1.0 - nu * nu) / 2.0, 4.0 / 3.0 * math.pi * R**3 * rho
        sticks = math.sqrt(14.18 / m) * (w**5 * R**4 / E_star**2) ** (1.0 / 6.0)
        path = self.here / "sticky.nml"
        for part in (0.8, 1.2, 3.0):
            path.write_text(f"""&domain length_x = 1e-3  length_y = 1e-3 /
&gravity g = 0 /
&material density = {rho}  young_modulus = {E}  poisson_ratio = {nu}  restitution = 1  friction = 0.3  adhesion = {w} /
&grain radius = {R}  x = 5e-4  y = {R}  velocity_y = {-part * sticks} /
&time cfl = 0.002  t_end = {30 * R / sticks * 0.03} /
&output history_interval = 10 /
""")
            result = self.run_program("granular", path, {}, f"part_{part}")
            m_ = result.summary["metrics"]
            if part < 1.0:
                self.assertEqual(m_["contacts"], 1.0)
                self.assertIsNone(m_["restitution_normal"])
            else:
                self.near(m_["restitution_normal"], math.sqrt(1.0 - 1.0 / part**2), 1e-2)

    def test_sizes(self):
        """Spheres of sizes 1 : 10 in a periodic plane, elastic but for friction: momentum stays to rounding, and energy never rises."""
        path = self.here / "sizes.nml"
        path.write_text("""&domain length_x = 0.06  length_y = 0.06  periodic_x = T  periodic_y = T /
&gravity g = 0 /
&material density = 2500  young_modulus = 1e7  restitution = 1  friction = 0.5 /
&packing radius = 0.005  high_x = 0.06  high_y = 0.03  spacing = 1.2  random_velocity = 0.3 /
&packing radius = 0.0005  low_y = 0.031  high_y = 0.06  spacing = 1.5  jitter = 1  random_velocity = 0.5 /
&time t_end = 0.05 /
&output history_interval = 50 /
""")
        names, rows = self.run_program("granular", path, {}, "sizes").rows()
        names = [name.split(" ")[0] for name in names]
        column = lambda name: [float(row[names.index(name)]) for row in rows]  # noqa: E731
        scale = 4.0 / 3.0 * math.pi * 0.005**3 * 2500.0 * 0.3
        for axis in "xy":
            p = column(f"momentum_{axis}")
            self.assertLess(max(p) - min(p), 1e-12 * scale)
        energy = [sum(parts) for parts in zip(*(column(f"{kind}_energy") for kind in ("kinetic", "rotational", "elastic")))]
        self.assertLess(energy[-1], 0.95 * energy[0])
        self.assertLess(max(b - a for a, b in zip(energy, energy[1:])), 2e-5 * energy[0])
        self.assertGreater(max(column("contacts")), 5)

    def test_ranks_and_restart(self):
        """Sizes, two materials, a periodic slope: the same bits on any ranks and threads, over an interruption that other ranks go on from."""
        path = self.here / "bed.nml"
        path.write_text(BED)
        whole = self.assert_exact("granular", path, {"time.steps": 2500}, 1300, [(2, 1), (3, 2)])
        self.assertGreater(whole["metrics"]["contacts"], 50)
        moved = self.run_program("granular", path, {"time.steps": 2500, "domain.balance": "counted"}, "moved", ranks=3).summary
        self.assertGreater(moved["metrics"]["balance_moves"], 0)
        self.assertEqual(moved["state_hash"], whole["state_hash"])

    def test_energy_is_not_created(self):
        """Grains that fall into a box: the sum of all energies never rises by more than the steps' error, and the bed comes to rest."""
        path = self.here / "fall.nml"
        path.write_text("""&domain length_x = 0.02  length_y = 0.02 /
&material name = 'a'  density = 2500  young_modulus = 1e6  restitution = 0.5  friction = 0.4  rolling_friction = 0.05 /
&granular rolling = 'spring' /
&packing radius = 0.0005  high_y = 0.01  spacing = 1.1  jitter = 1  random_velocity = 0.1 /
&time t_end = 1 /
&output history_interval = 50 /
""")
        result = self.run_program("granular", path, {"time.t_end": 25, "output.history_interval": 10000} if SLOW else {}, "fall")
        names, rows = result.rows()
        names = [name.split(" ")[0] for name in names]
        energy = [sum(float(row[names.index(f"{kind}_energy")]) for kind in ("kinetic", "rotational", "potential", "elastic")) for row in rows]
        lost = energy[0] - energy[-1]
        self.assertGreater(lost, 0.0)
        self.assertLess(max(b - a for a, b in zip(energy, energy[1:])), 1e-4 * lost)
        kinetic = [float(row[names.index("kinetic_energy")]) for row in rows]
        self.assertLess(kinetic[-2], 1e-18 * max(kinetic))  # the last step is shorter than the others
        potential = [float(row[names.index("potential_energy")]) for row in rows]
        self.assertLess(abs(potential[-1] - potential[-len(potential) // 8]), 1e-10 * lost)

    def test_column(self):
        """A small column: it is let down, the gate opens, all comes to rest; nothing is lost, and rough grains stay nearer."""
        small = {"packing.high_x": 0.01, "packing.high_y": 0.015, "solids.centre_x": 0.0105, "domain.length_x": 0.04, "domain.length_y": 0.02, "gate.velocity_y": 0.3,
                 "granular.stiffness": 20, "granular.rest_speed": 5e-3, "output.interval": 0}
        ends = []
        for mu in (0.05, 0.5):
            m = self.metrics("column_2d", {**small, "material.friction": f"{mu},{mu}", "pair.friction": mu, "material.rolling_friction": f"{mu},{mu}",
                                           "output.history_interval": 100}, f"mu_{mu}")
            self.assertEqual(m["particles_lost"], 0)
            self.assertGreater(m["gate_opened"], 0.0)
            ends.append(m)
        slippery, rough = ends
        self.assertGreater(slippery["run_out"], rough["run_out"] + 0.002)
        self.assertGreater(rough["repose_angle"], max(5.0, slippery["repose_angle"] or 0.0))

    def test_grains_leave(self):
        """Through an open floor all grains leave, at any number of ranks; the rate of discharge counts them."""
        path = self.here / "hole.nml"
        path.write_text("""&domain length_x = 0.02  length_y = 0.03 /
&granular flux_height = 0.005 /
&material density = 2500  young_modulus = 1e6  restitution = 0.5  friction = 0.3 /
&walls bottom = 'open' /
&packing radius = 0.0005  low_y = 0.01  high_y = 0.02  spacing = 1.05 /
&time t_end = 0.2 /
&output history_interval = 20 /
""")
        whole = self.run_program("granular", path, {}, "whole")
        m = whole.summary["metrics"]
        self.assertEqual((m["particles_left"], m["particles_lost"]), (171, 0))
        fallen = float(whole.rows()[1][-1][12])
        self.near(fallen, 171 * 4.0 / 3.0 * math.pi * 0.0005**3 * 2500, 1e-12)
        half = {"time.t_end": 0.055}
        alone = self.run_program("granular", path, half, "alone").summary
        self.assertGreater(alone["metrics"]["particles_left"], 20)
        self.assertLess(alone["metrics"]["particles_left"], 171)
        self.assertEqual(outcome(self.run_program("granular", path, half, "three", ranks=3).summary), outcome(alone))

    def test_refusals(self):
        grain = "&domain length_x = 1 length_y = 1 /\n&material density = 2500 young_modulus = 1e7 /\n"
        for text, said in [("&grain radius = 0.1 x = 0.5 y = 0.05 /", "grain 0 overlaps a wall"),
                           ("&grain radius = 2*0.1 x = 0.5, 0.55 y = 2*0.5 /", "grain 0 overlaps grain 1"),
                           ("&grain radius = 0.1 x = 1.5 y = 0.5 /", "grain 0 overlaps a wall"),
                           ("&grain radius = 0.1 x = 0.5 y = 0.5 /\n&time dt = 1 /", "expected at most"),
                           ("&grain radius = 0.1 x = 0.5 y = 0.5 /\n&granular contact = 'hooke' /", "needs the stiffness"),
                           ("&grain radius = 0.1 x = 0.5 y = 0.5 material = 'tin' /", "there is no material 'tin'"),
                           ("&grain x = 0.5 y = 0.5 /", "must be given of grain 1"),
                           ("&grain radius = 0.1 x = 0.5 y = 0.5 /\n&solids body = 'ball' shape = 'sphere' radius = 0.3 centre_x = 0.5 centre_y = 0.5 /",
                            "is inside of body 'ball'"),
                           ("&grain radius = 0.1 x = 0.5 y = 0.5 /\n&gate body = 'door' /", "there is no body 'door'"),
                           ("&grain radius = 0.1 x = 0.5 y = 0.5 spin_x = 1 /", "belongs to dimension = 3"),
                           ("&packing radius = 2 /", "there are no grains")]:
            with self.subTest(said):
                path = self.here / "wrong.nml"
                path.write_text(grain + text + "\n")
                result = self.call("granular", path, "--output", self.here / "wrong")
                self.assertEqual(result.status, BAD_INPUT, result)
                self.assertIn(said, result.stderr)
                self.assertFalse((self.here / "wrong").exists())


if __name__ == "__main__":
    unittest.main()
