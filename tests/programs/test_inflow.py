"""Water that enters and leaves the box: budgets, exact channels, ranks and restarts, what is refused."""

import math

import h5py
import unittest

from running import BAD_INPUT, CALCULATION_FAILED, SLOW, Case

# A channel 0.4 m long with 0.1 m of water that runs at 1.5 m/s, 1.5 times as fast as its waves.
CHANNEL = """&domain length_x = 0.4 length_y = 0.2 particles_x = 40 particles_y = 20 {domain} /
&flow high_y = 0.1 {flow} /
&region velocity_x = '1.5' /
&inflow side = 'left' high_y = 0.1 velocity = {velocity} {inflow} /
&outflow side = 'right' {outflow} /
&gauges interval = 0.005 height_x = 0.2 discharge_x = 0.2 {gauges} /
&walls slip_top = 'free_surface' /
&time t_end = {t_end} {time} /
&output interval = 0 history_interval = 10 /
{more}
"""
PLAIN = {"domain": "", "flow": "", "velocity": 1.5, "inflow": "", "outflow": "", "gauges": "", "t_end": 0.3, "time": "", "more": ""}
DEEP = {"domain": "dimension = 3 length_z = 0.12 particles_z = 12 periodic_z = .true.", "gauges": "height_z = 0.06"}


class InflowOutflow(Case):
    def channel(self, **changes):
        path = self.here / f"channel_{len(list(self.here.iterdir()))}.nml"
        path.write_text(CHANNEL.format(**{**PLAIN, **changes}))
        return path

    def assert_mass_is_known(self, s):
        m = s["metrics"]
        self.assertGreater(m["particles_in"], 0)
        self.assertGreater(m["particles_out"], 0)
        self.assertLess(abs(s["conservation"]["mass"]), 1e-14)
        self.assertAlmostEqual(m["mass"], m["mass_of_start"] + m["mass_in"] - m["mass_out"], delta=1e-12 * m["mass"])

    def readings(self, result, name, after):
        return [line[name] for line in self.table(result, "gauges.csv") if line["time"] > after]

    def table(self, result, name="history.csv"):
        """Lines as numbers by column, whose names are without units."""
        names, rows = result.rows(name)
        return [dict(zip((name.split(" ")[0] for name in names), map(float, row))) for row in rows]

    def test_uniform_channel(self):
        """Faster than its waves, with nothing said of the outflow's level; each row goes on for itself. 1.5 m/s through 0.1 m."""
        result = self.run_program("flow", self.channel())
        s = result.summary
        self.assert_mass_is_known(s)
        for depth in self.readings(result, "height_1", 0.0):
            self.assertLess(abs(depth / 0.1 - 1.0), 0.02)
        flow = self.readings(result, "discharge_1", 0.1)
        self.assertLess(abs(sum(flow) / len(flow) / 0.15 - 1.0), 0.01)
        last = self.table(result)[-1]
        self.assertAlmostEqual(last["momentum_in_x"] / last["mass_in"], 1.5, delta=1e-12)
        self.assertAlmostEqual(last["momentum_out_x"] / last["mass_out"], 1.5, delta=0.03)
        self.assertAlmostEqual(last["mass"], s["metrics"]["mass_of_start"] + last["mass_in"] - last["mass_out"], delta=1e-10)
        # What has come in by the time is discharge times time, but for a layer.
        self.assertLess(abs(last["mass_in"] - 1000 * 0.15 * last["time"]), 1000 * 0.1 * 0.01 * 1.1)
        self.assertEqual(s["metrics"]["particles_put_back"], 0)
        self.assertNotIn("energy_residual", s["metrics"])
        self.assertIsNone(s["conservation"]["energy"])

    def test_film_on_a_slope(self):
        """A parabola of velocities, slower than waves, so that the outflow's level holds the depth: mean errors of the input's gauges."""
        s = self.run_program("flow", "open_channel", {"domain.particles_x": 50, "domain.particles_y": 10, "time.t_end": 1.0, "output.interval": 0}).summary
        self.assert_mass_is_known(s)
        for n in (1, 2, 3):
            self.assertLess(abs(s["metrics"][f"height_{n}_mean_error"]), 0.03 * 0.096)
            self.assertLess(abs(s["metrics"][f"discharge_{n}_mean_error"]), 0.05 * 0.0589824)

    def test_bore(self):
        """What comes in stands up before the wall, as mass and momentum say, on eight rows; bores break."""
        result = self.run_program("flow", "channel_bore", {"domain.particles_x": 120, "domain.particles_y": 32, "output.interval": 0})
        depth = self.readings(result, "height_1", 0.9)
        self.assertLess(abs(sum(depth) / len(depth) / 0.21824 - 1.0), 0.05)
        self.assertEqual(result.summary["metrics"]["mass_out"], 0.0)

    def test_same_on_ranks_and_after_restart(self):
        """From water that enters ever faster, with cuts that follow the load."""
        changing = {"velocity": "'1.5 + 0.3*sin(20*t)'", "outflow": "level = 0.1"}
        s = self.assert_exact("flow", self.channel(**changing), {"domain.balance": "counted"}, 60, [(2, 1), (3, 2)])
        self.assert_mass_is_known(s)

    @unittest.skipUnless(SLOW, "slow")
    def test_same_on_ranks_with_error_control(self):
        s = self.assert_exact("flow", self.channel(time="method = 'adaptive'", t_end=0.15), {}, 20, [(3, 1)])
        self.assertGreater(s["metrics"]["particles_in"], 0)

    @unittest.skipUnless(SLOW, "slow")
    def test_same_on_ranks_in_three_dimensions(self):
        """From the right to the left, and through a part of the side; the box is periodic across."""
        deep = self.channel(**DEEP, velocity="1.0", inflow="low_y = 0.02", t_end=0.06)
        text = deep.read_text().replace("'left'", "'back'").replace("'right'", "'left'").replace("'back'", "'right'").replace("'1.5'", "'-1.5'")
        deep.write_text(text)
        s = self.assert_exact("flow", deep, {}, 20, [(3, 1)])
        self.assert_mass_is_known(s)
        self.assertLess(s["metrics"]["momentum_in_x"], 0.0)

    def test_same_on_ranks_with_bodies(self):
        """Beside a box on the floor whose force is read."""
        body = "&solids body = 'box' shape = 'box' centre_x = 0.2 centre_y = 0.02 length_x = 0.06 length_y = 0.04 /"
        around = self.channel(flow="around_bodies = .true.", gauges="force = 'box'", t_end=0.12, more=body).read_text().replace("height_x = 0.2 ", "")
        path = self.here / "around.nml"
        path.write_text(around)
        s = self.assert_exact("flow", path, {}, 40, [(3, 1)])
        self.assert_mass_is_known(s)
        self.assertGreater(s["metrics"]["force_1_x_impulse"], 0.0)

    def test_same_on_ranks_with_two_inflows(self):
        """Groups that stand twice, one of them in the lid, with pairs in single precision."""
        path = self.channel(t_end=0.1, outflow="level = 0.1", more="&inflow side = 'top' low_x = 0.2 high_x = 0.3 velocity = 0.4 /\n"
                            "&kernel precision = 'single' /")
        s = self.assert_exact("flow", path, {}, 30, [(3, 1)])
        self.assert_mass_is_known(s)

    def test_jet_from_above(self):
        """Water that falls through a hole of the lid from a thin layer: as much as its velocity brings, and as fast as it has fallen."""
        text = CHANNEL.format(**{**PLAIN, "t_end": 0.25}).replace("&outflow side = 'right'  /", "").replace("high_y = 0.1  /", "high_y = 0.03 /", 1)
        text = text.replace("side = 'left' high_y = 0.1", "side = 'top' low_x = 0.15 high_x = 0.25").replace("&region velocity_x = '1.5' /", "")
        path = self.here / "jet.nml"
        path.write_text(text.replace(" slip_top = 'free_surface'", ""))
        s = self.run_program("flow", path).summary
        self.assertLess(abs(s["metrics"]["mass_in"] / (1000 * 1.5 * 0.1 * 0.25) - 1.0), 0.05)
        self.assertEqual(s["metrics"]["particles_out"], 0)
        self.assertLess(abs(s["conservation"]["mass"]), 1e-14)

    def test_snapshots_tell_the_zones(self):
        result = self.run_program("flow", self.channel(t_end=0.1))
        with h5py.File(sorted(result.directory.glob("snapshot_*.h5"))[-1]) as file:
            x, zone = file["PartType0/Coordinates"][:, 0], file["PartType0/Zone"][:]
            ids = file["PartType0/ParticleIDs"][:]
        self.assertEqual(len(set(ids)), len(ids))
        self.assertEqual(set(zone), {0, 1, -2})
        self.assertLess(max(x[zone == 1]), 0.06)
        self.assertGreater(min(x[zone == -2]), 0.34)
        self.assertEqual(len(ids), result.summary["fluid_particles"])

    def test_refuses(self):
        body = "&solids body = 'step' shape = 'box' centre_x = 0.0 centre_y = 0.0 length_x = 0.1 length_y = 0.1 /"
        for changes, says in [
                ({"velocity": -1.5}, ["&inflow velocity", "inwards", "-1.5 m/s"]),
                ({"velocity": "'y - 0.05'"}, ["&inflow velocity", "0 or more"]),
                ({"velocity": "'1.5*T'"}, ["&inflow velocity", "T"]),
                ({"velocity": "''"}, ["&inflow velocity", "must be given"]),
                ({"inflow": "low_y = 0.055"}, ["&inflow low_y", "whole number of particle spacings"]),
                ({"inflow": "low_y = 0.1"}, ["&inflow high_y", "0.1 m"]),
                ({"inflow": "high_y = 0.3"}, ["&inflow high_y", "outside the box"]),
                ({"inflow": "low_x = 0.1"}, ["&inflow low_x", "along the side alone"]),
                ({"inflow": "level = 0.3"}, ["&inflow level", "0.3 m"]),
                ({"outflow": "level = 0.3"}, ["&outflow level", "0.3 m"]),
                ({"outflow": "low_z = 0.1"}, ["&outflow low_z"]),
                ({"domain": "periodic_x = .true."}, ["&inflow side", "periodic"]),
                ({"more": "&outflow side = 'left' low_y = 0.05 /"}, ["&outflow side", "overlap"]),
                ({"more": "&outflow side = 'front' /"}, ["&outflow side", "two dimensions"]),
                ({"more": "&outflow level = 0.1 /"}, ["&outflow side", "must be given"]),
                ({"flow": "around_bodies = .true.", "more": body}, ["&inflow side", "step", "zone"]),
                ({"flow": "surface_tension = 0.07"}, ["&inflow side", "surface_tension"]),
                ({"more": "&initial settle = 1.0 /"}, ["&inflow side", "settle"])]:
            with self.subTest(changes):
                before = len(list(self.here.iterdir()))
                path = self.channel(**changes)
                result = self.call("flow", path, "--check")
                self.assert_says(result, BAD_INPUT, *says)
                self.assertEqual(len(result.stderr.strip().splitlines()), 1, result)
                self.assertEqual(len(list(self.here.iterdir())), before + 1)

    def test_velocity_that_turns(self):
        result = self.call("flow", self.channel(velocity="'1.5*cos(40*t)'"), "--output", self.here / "turns")
        self.assert_says(result, CALCULATION_FAILED, "&inflow velocity = '1.5*cos(40*t)'", "inwards")


if __name__ == "__main__":
    unittest.main()
