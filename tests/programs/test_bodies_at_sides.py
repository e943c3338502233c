"""Bodies and gauges at the sides of the box: across periodic ones, above an open top, from beyond a wall."""

import unittest

from running import BAD_INPUT, Case

FLAT = """&domain length_x = 1.0 length_y = 0.6 particles_x = 40 particles_y = 24 periodic_x = {periodic} /
&flow high_y = 0.3 around_bodies = .true. /
&solids body = 'it' shape = {shape} centre_x = {x} centre_y = {y} {size} /
{more}
&walls slip_top = 'free_surface' /
&time t_end = {t} /
&output interval = 0 /
"""
BOX = {"shape": "'box'", "size": "length_x = 0.25 length_y = 0.2", "periodic": ".true."}
FREE = "&motions body = 'it' kind = 'free' density = {} /\n&gauges force = 'it' motion = 'it' /"

DEEP = """&domain dimension = 3 length_x = 0.8 length_y = 0.6 length_z = 0.7 particles_x = 16 particles_y = 12 particles_z = 14
  periodic_x = .true. periodic_z = .true. /
&kernel name = 'wendland_c2' h_over_dx = 1.2 skin = 0.3 /
&flow high_y = 0.4 around_bodies = .true. sound_factor = 15.0 /
&solids body = 'ball', 'ball' shape = 'sphere', 'box' centre_x = {x}, {x} centre_y = 0.4, 0.42 centre_z = {z}, {z}
  radius(1) = 0.16 length_x(2) = 0.25 length_y(2) = 0.2 length_z(2) = 0.25 angle_x(2) = 20 angle_z(2) = 30 /
{more}
&walls slip_top = 'free_surface' /
&time t_end = 1.0 /
&output interval = 0 /
"""
FREE_BALL = "&motions body = 'ball' kind = 'free' density = 500 /\n&gauges force = 'ball' motion = 'ball' /"


class BodiesAtSides(Case):
    def input(self, text, name, **parts):
        path = self.here / f"{name}.nml"
        path.write_text(text.format(**{"more": "", **parts}))
        return path

    def columns(self, result):
        header, rows = result.rows("gauges.csv")
        return {name.split(" ")[0]: [float(row[k]) for row in rows] for k, name in enumerate(header)}

    def test_free_body_across(self):
        """It heaves as in the middle, and does not turn by itself; from one side to the other it goes on."""
        last = {}
        for x in (0.5, 0.9, 1.0):
            path = self.input(FLAT, f"free_{x}", **BOX, x=x, y=0.34, t=0.4, more=FREE.format(600))
            last[x] = {name: values[-1] for name, values in self.columns(self.run_program("flow", path)).items()}
            self.assertLess(abs(last[x]["angle_1"]), 0.5)
        for x in (0.9, 1.0):
            self.assertAlmostEqual(last[x]["motion_1_y"], last[0.5]["motion_1_y"], delta=1e-3)

    def test_fixed_body_across(self):
        """Water about it does what it does about one in the middle."""
        for shape in ({"shape": "'sphere'", "size": "radius = 0.12", "y": 0.22}, {"shape": "'box'", "size": "length_x = 0.3 length_y = 0.4", "y": 0.2}):
            found = []
            for x in (0.5, 0.0, 0.95):
                path = self.input(FLAT, f"fixed_{x}", periodic=".true.", x=x, t=0.2, **shape)
                s = self.run_program("flow", path).summary
                found.append((s["wall_particles"], s["metrics"]["particles_put_back"], s["metrics"]["kinetic_energy_largest"]))
            for across in found[1:]:
                self.assertEqual(across[:2], found[0][:2])
                self.assertAlmostEqual(across[2] / found[0][2], 1, delta=1e-6)

    def test_bar_through(self):
        """In three dimensions what runs through both sides floats as in two, and does not turn about other axes."""
        more = "&motions body = 'it' kind = 'free' density = 400 /\n&gauges force = 'it' motion = 'it' /"
        bar = DEEP.replace("periodic_x = .true.", "periodic_x = .false.").replace("'ball', 'ball'", "'it'").replace("'sphere', 'box'", "'box'")
        bar = bar.replace("{x}, {x}", "{x}").replace("{z}, {z}", "{z}").replace("0.4, 0.42", "0.38")
        bar = bar[:bar.index("  radius(1)")] + "  length_x = 0.3 length_y = 0.2 length_z = 0.8 angle_z = 12 /\n" + bar[bar.index("{more}"):]
        result = self.run_program("flow", self.input(bar, "bar", x=0.41, z=0.3, more=more), {"time.t_end": 0.15, "domain.jitter": 0.1})
        g = self.columns(result)
        self.assertGreater(max(map(abs, g["angle_1_z"])), 0.05)
        for axis in "xy":
            self.assertLess(max(map(abs, g[f"angle_1_{axis}"])), 1e-9)
        self.assert_exact("flow", self.here / "bar.nml", {"time.steps": 10}, 4, [(3, 1)])

    def test_ranks(self):
        """Across a side, in the corner of two, free and fixed: the same state, and as many wall particles, on any ranks."""
        for path in (self.input(FLAT, "free", **BOX, x=0.95, y=0.35, t=0.05, more=FREE.format(400)),
                     self.input(FLAT, "fixed", **BOX, x=0.02, y=0.25, t=0.05)):
            self.assert_exact("flow", path, {}, 20, [(3, 1)])
        self.assert_exact("flow", self.input(DEEP, "corner", x=0.8, z=0.05, more=FREE_BALL), {"time.steps": 16}, 7, [(3, 1), (2, 2)])
        self.assert_exact("flow", self.input(DEEP, "still", x=0.05, z=0.7), {"time.steps": 10}, 4, [(3, 1)])

    def test_weight_above_an_open_top(self):
        """A body falls and is carried as it is where the box holds all of it."""
        found = {}
        for top in (0.8, 0.6, 0.48):
            settings = {"domain.length_x": 1.6, "domain.length_y": top, "domain.particles_x": 40, "domain.particles_y": round(top / 0.04),
                        "flow.high_y": 0.4, "solids.centre_x": 0.8, "solids.centre_y": 0.48, "solids.length_y": 0.24, "solids.angle_z": 20,
                        "output.interval": 0, "time.t_end": 0.2}
            found[top] = self.columns(self.run_program("flow", "floating_box", settings))
        for top in (0.6, 0.48):
            for name, values in found[top].items():
                self.assertEqual(len(values), len(found[0.8][name]))
                size = max(map(abs, found[0.8][name]))
                self.assertLess(max(abs(a - b) for a, b in zip(values, found[0.8][name])), 1e-6 * size, f"{top}: {name}")

    def test_pistons(self):
        """One that comes in from beyond a side pushes as one that stood in the box at rest."""
        table = "0,{0},0,0,0\n0.2,{1},0,0,0\n0.4,{2},0,0,0\n0.6,{2},0,0,0\n"
        force = {}
        for rest in (0.1, -0.05, -0.6):
            (self.here / f"push_{rest}.csv").write_text(table.format(0.1 - rest, 0.15 - rest, 0.2 - rest))
            more = f"&motions body = 'it' kind = 'table' file = 'push_{rest}.csv' /\n&gauges force = 'it' /"
            path = self.input(FLAT, f"piston_{rest}", periodic=".false.", shape="'box'", size="length_x = 0.6 length_y = 1.0", x=rest, y=0.3,
                              t=0.4, more=more)
            result = self.run_program("flow", path)
            self.assertEqual(result.summary["metrics"]["particles_put_back"], 0)
            force[rest] = self.columns(result)["force_1_x"]
        for rest in (-0.05, -0.6):
            self.assertEqual(len(force[rest]), len(force[0.1]))
            self.assertLess(max(abs(a - b) for a, b in zip(force[rest], force[0.1])), 1e-3 * max(map(abs, force[0.1])))

    def test_block_from_the_floor(self):
        """One that stood below it at rest rises as one that stood above it."""
        force = {}
        for rest in (-0.175, 0.075):
            rows = ((0, -0.175), (0.2, -0.135), (0.6, -0.075), (1, -0.075))
            (self.here / f"rise_{rest}.csv").write_text("".join(f"{t},0,{y - rest},0,0\n" for t, y in rows))
            more = f"&motions body = 'it' kind = 'table' file = 'rise_{rest}.csv' /\n&gauges force = 'it' /"
            path = self.input(FLAT, f"block_{rest}", periodic=".false.", shape="'box'", size="length_x = 0.3 length_y = 0.5", x=0.5, y=rest,
                              t=0.3, more=more)
            result = self.run_program("flow", path)
            force[rest] = self.columns(result)["force_1_y"]
            self.assertGreater(result.summary["wall_particles"], 30)
        a, b = force.values()
        self.assertLess(max(abs(p - q) for p, q in zip(a, b)), 1e-3 * max(map(abs, a)))

    def test_gauges(self):
        """Beside periodic sides the depth is that of the water."""
        settings = {"gauges.height_x": "0.1,0.1,0.1", "gauges.height_z": "0.0,0.2,0.4", "time.t_end": 0.005, "output.interval": 0}
        g = self.columns(self.run_program("flow", "still_wedge_3d", settings))
        for n in (1, 2, 3):
            self.assertAlmostEqual(g[f"height_{n}"][0], 1.0, delta=1e-9)

    def test_bad_input(self):
        before = {}
        for name, parts, says in [
                ("slope", {"shape": "'plane'", "size": "angle_z = 5", "x": 0.5, "y": 0.05}, ["&solids shape", "'it' has no end along x"]),
                ("long", {**BOX, "size": "length_x = 1.2 length_y = 0.2 angle_z = 5", "x": 0.5, "y": 0.45, "more": FREE.format(500)},
                 ["&motions body", "'it' is 1.213 m long along x"]),
                ("tank", {"shape": "'box'", "size": "length_x = 0.9 length_y = 2.0 solid = 'outside'", "x": 0.5, "y": 0.5},
                 ["&solids shape", "'it' has no end along x"])]:
            with self.subTest(name):
                path = self.input(FLAT, name, **{"periodic": ".true.", "t": 0.1, **parts})
                before = self.listing()
                self.assert_says(self.run_program("flow", path, {}, "bad", expect=BAD_INPUT), BAD_INPUT, *says)
                self.assertEqual(self.listing(), before)
        for density in ("1e-300", "1e-30", "1e30"):
            self.assert_says(self.run_program("flow", "still_water", {"flow.density": density}, "bad", expect=BAD_INPUT), BAD_INPUT, "&flow density")


if __name__ == "__main__":
    unittest.main()
