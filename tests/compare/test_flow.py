"""Water with a free surface: gauges beside measurements, views, the plan, what is judged, and the page, from made-up runs."""
import argparse
import re
import tempfile
import unittest
import unittest.mock
from pathlib import Path

import numpy as np
from tetsuame import gauges, movie, plots, runs, scene
from tetsuame.compare import flow as subject
from tetsuame.compare import flow_bodies as bodies
from tetsuame.compare import flow_bodies_figures as body_figures
from tetsuame.compare import flow_figures as figures
from tetsuame.compare import flow_questions as questions
from tetsuame.compare.cases import Run
from tetsuame.compare.outcomes import COMPLETED, Outcome
from test_runs import write_snapshot

ROOT = Path(__file__).resolve().parents[2]
RESOLVED = """! flow, every key as run
&gauges
  file = '{file}'
  front_column = ''
  height_columns =
  pressure_columns = 'b', ''
  pressure_y = 0.003, 0.015
/
&flow
  gravity = 9.81
  density = 1000
  high_y = 0.5
/
&expert
  time_unit = 0.5
  length_unit = 1
  stress_unit = 1000
  impulse_from = !
  impulse_until = 1
/
"""


def plan(quick=False, long=False, parts=",".join(subject.PARTS)):
    return subject.plan(argparse.Namespace(quick=quick, long=long, parts=parts, settings=()), ROOT, argparse.ArgumentParser())


def setting(run, key):
    return next(word.partition("=")[2] for word in reversed(run.settings) if word.startswith(key + "="))


def write_run(folder: Path, times=(0.0, 0.5, 1.0)) -> Path:
    """A run of water: states of a lattice, two gauges of pressure, and a file that the first is held against."""
    folder.mkdir(parents=True)
    (folder / "measured.csv").write_text("# of nobody\nt,a,b\n0,1,0\n1,1,2\n2,1,3\n3,1,9\n")
    (folder / "resolved.nml").write_text(RESOLVED.format(file=folder / "measured.csv"))
    (folder / "history.csv").write_text("step [1],time [s],kinetic_energy [J]\n" + "".join(f"{k},{0.1 * k},{k}\n" for k in range(11)))
    (folder / "gauges.csv").write_text("step [1],time [s],pressure_1 [Pa],pressure_2 [Pa]\n"
                                       + "".join(f"{k},{0.1 * k},{200 * k if k != 5 else 1e6},0\n" for k in range(11)))
    places = (np.stack(np.meshgrid(*[np.arange(8) + 0.5] * 2), 2).reshape(-1, 2)) / 8
    for number, time in enumerate(times):
        write_snapshot(folder / f"snapshot_{number:04d}.h5", time, places, length=1.0, Pressure=9810 * (0.5 - places[:, 1]),
                       FreeSurface=(places[:, 1] > 0.9).astype(float))
    return folder


class Gauges(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = write_run(Path(scratch.name, "run"))

    def test_measured_curves_are_in_the_units_of_the_run(self):
        known = gauges.measured(self.folder)
        self.assertEqual(list(known), ["pressure_1"])  # no column is named for the second
        np.testing.assert_allclose(known["pressure_1"], [[0, 0.5, 1, 1.5], [0, 2000, 3000, 9000]])
        resolved = self.folder / "resolved.nml"
        resolved.write_text(resolved.read_text().replace(str(self.folder / "measured.csv"), "measured.csv"))  # beside it
        self.assertEqual(list(gauges.measured(self.folder)), ["pressure_1"])
        (self.folder / "measured.csv").unlink()
        self.assertEqual(gauges.measured(self.folder), {})

    def test_a_spike_does_not_press_the_rest_flat(self):
        figure = gauges.draw([("", self.folder)])
        first, second = figure.axes
        self.assertLessEqual(first.get_ylim()[1], 1.61 * 3.0)  # kPa, of what was measured until the run's end
        self.assertEqual([text.get_text() for text in first.texts], ["to 1e+03"])
        self.assertEqual(first.get_title(loc="left"), "pressure 1 [kPa]")
        self.assertEqual({line.get_label() for line in first.lines}, {"run", "measured"})
        self.assertEqual({line.get_label() for line in second.lines}, {"run"})
        plots.plt.close(figure)
        (self.folder / "gauges.csv").unlink()
        self.assertIsNone(gauges.draw([("", self.folder)]))

    def test_plot_shows_water_by_its_pressure_and_its_gauges(self):
        written = plots.make(runs.Run(self.folder), self.folder / "plots")
        self.assertEqual([path.stem for path in written], ["history", "gauges", "map", "profile"])
        snapshot = runs.Run(self.folder).snapshot()
        self.assertEqual(plots.fields.shown(snapshot), ["Pressure"])  # it stands still

    def test_impulses(self):
        t = np.array([0.0, 1.0, 2.0, 3.0])
        np.testing.assert_allclose(figures.integral(t, t, 1.0), [0, 0, 1.5, 4.0])


class Scene(unittest.TestCase):
    def test_the_nearer_one_hides_the_other(self):
        eye = scene.Eye((0, 0, 0), (1, 1, 1), 100, aside=0.0, above=0.0)
        for order in (1, -1):
            depth, which = scene.nearest(eye, np.array([(0.5, 0.5, 0.2), (0.5, 0.5, 0.8)])[::order], 0.1)
            self.assertEqual(which[50, 50], (1, 0)[order < 0])
            self.assertAlmostEqual(depth[50, 50], 80 + 10, delta=0.1)
        self.assertEqual((depth[5, 5], which[5, 5]), (scene.NOTHING, -1))
        self.assertAlmostEqual((which >= 0).sum(), np.pi * 10**2, delta=15)

    def test_cubes_fill_a_block(self):
        """Seen from its front, a block of cubes is a plane without gaps; seen from anywhere its outline is that of one cube."""
        places = (np.stack(np.meshgrid(*[np.arange(4) + 0.5] * 3), 3).reshape(-1, 3)) / 4
        eye = scene.Eye((-1, -1, -1), (2, 2, 2), 90, aside=0.0, above=0.0)
        depth, which = scene.nearest(eye, places, 0.125, scene.cube)
        self.assertEqual((which >= 0).sum(), 30 * 30)
        self.assertLess(np.ptp(depth[which >= 0]), 1e-9)
        eye = scene.Eye((-1, -1, -1), (2, 2, 2), 90)
        many, one = (scene.nearest(eye, *given, scene.cube)[0] for given in ((places, 0.125), (np.full((1, 3), 0.5), 0.5)))
        np.testing.assert_array_equal(many > scene.NOTHING, one > scene.NOTHING)
        seen = one > scene.NOTHING
        np.testing.assert_allclose(many[seen], one[seen], atol=1e-9)

    def test_water_is_smoothed_but_not_over_its_edges(self):
        depth = np.full((20, 40), scene.NOTHING)
        depth[:, 10:20], depth[:, 20:30] = 5.0 + 0.5 * (np.arange(10) % 2), 30.0
        smooth, values = scene.smoothed(depth, np.where(depth > scene.NOTHING, 2.0, np.nan), 2.0, 10.0)
        np.testing.assert_array_equal(smooth > scene.NOTHING, depth > scene.NOTHING)
        np.testing.assert_allclose(smooth[:, 12:18], 5.25, atol=0.02)
        np.testing.assert_allclose(smooth[:, 20:30], 30.0)
        np.testing.assert_allclose(values[:, 10:30], 2.0)
        slopes = scene.slope(smooth, 1)
        self.assertLess(np.abs(slopes[:, 10:30]).max(), 0.2)

    def test_views_of_a_run(self):
        """plot and movie: a block of water in the box's lower half, and one cut open."""
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        folder = write_run(Path(scratch.name, "run"))
        places = (np.stack(np.meshgrid(*[np.arange(6) + 0.5] * 3), 3).reshape(-1, 3)) / 6
        for number, time in enumerate((0.0, 0.5, 1.0)):
            write_snapshot(folder / f"snapshot_{number:04d}.h5", time, places[places[:, 1] < 0.5], length=1.0,
                           Pressure=np.arange(108.0), FreeSurface=np.zeros(108), Volume=np.full(108, 1 / 216))
        snapshots = runs.Run(folder).snapshots
        whole, cut = (scene.picture(snapshots[0], 60, 1.0, z)[0][..., 3].sum() for z in (None, 0.5))
        self.assertGreater(whole, 1.2 * cut)
        self.assertGreater(cut, 0.3 * whole)
        frames = list(movie.views(snapshots, 100, 1.0))
        self.assertEqual([frame.shape for frame in frames], [frames[0].shape] * 3)
        self.assertIn("view", [path.stem for path in plots.make(runs.Run(folder), folder / "plots")])

    def test_lines_behind_the_box_come_first(self):
        eye = scene.Eye((0, 0, 0), (1, 1, 1), 100)
        lines = scene.edges(eye, (0, 0, 0), (1, 1, 1))
        farthest = eye.turned(np.zeros((1, 3)))[0, :2]
        self.assertEqual(len(lines), 12)
        self.assertEqual([bool((np.abs(line - farthest).sum(axis=1) < 1e-12).any()) for line in lines], [True] * 3 + [False] * 9)


class Plan(unittest.TestCase):
    def test_whole_and_quick(self):
        whole, quick, long = plan(), plan(quick=True), plan(long=True)
        for runs_ in (whole, quick, long):
            self.assertEqual(len({run.folder for run in runs_}), len(runs_))
            self.assertTrue(all(run.input.is_file() for run in runs_))
        self.assertLess(sum(run.seconds for run in quick), 2 * 120)
        self.assertLess(sum(run.seconds for run in whole), 2 * 900)
        tank = {(run.n, setting(run, "time.t_end")) for run in long if run.file == "dam_break_box"}
        self.assertEqual(tank, {(25, "4"), (50, "4"), (100, "1")})

    def test_parts(self):
        self.assertEqual({run.file for run in plan(parts="box")}, {"dam_break_box"})
        with self.assertRaises(SystemExit):
            plan(parts="bowls")

    def test_ranks(self):
        """Of what there is mpirun for."""
        with unittest.mock.patch("shutil.which", lambda name: f"/usr/bin/{name}"):
            found = {run.variant: run for run in plan(parts="bowl") if run.file == "bowl_ranks"}
        self.assertEqual({name: run.ranks for name, run in found.items()}, {"1 rank": 1, "4 ranks": 4})
        self.assertEqual(len({run.folder for run in found.values()}), 2)
        self.assertEqual(len({run.settings for run in found.values()}), 1)
        with unittest.mock.patch("shutil.which", lambda name: None):
            self.assertEqual([run.file for run in plan(parts="bowl")], ["bowl"])

    def test_the_box_has_whole_spacings(self):
        for run in plan(long=True):
            case = subject.CASES[run.file]
            for axis, length in zip("xyz", case.along):
                particles = int(setting(run, f"domain.particles_{axis}"))
                self.assertLess(abs(particles - length * run.n), 0.51, (run.folder, axis))
                if abs(particles - length * run.n) > 1e-6:
                    self.assertAlmostEqual(float(setting(run, f"domain.length_{axis}")), particles * case.unit / run.n)


def made_up(run, **more):
    """A row of a run that has met everything."""
    metrics = {"hydrostatic_error": 0.005, "particles_put_back": 0, "period": 1.001, "period_theory": 1.0, "energy_decay": 0.21,
               "energy_decay_theory": 0.2,
               "front_rms_over_height": 0.02, "slosh_period": 1.39, "slosh_period_theory": 1.4, "weight": 4700.0, "weight_theory": 4709.0,
               "half_period": 0.5, "heave_place": -0.0355, "heave_place_theory": -0.036, "draught": 0.1, "carried": 314.0,
               "carried_theory": 313.9, "energy_above_start": 0.0, "load_max_over_mean": 1.08, "other_bits": 0.0}
    for k in (1, 2, 3, 4):
        metrics |= {f"pressure_{k}_arrival": 0.41, f"pressure_{k}_arrival_reference": 0.4, f"pressure_{k}_impulse": 1100.0,
                    f"pressure_{k}_impulse_reference": 1000.0, f"height_{k}_mean_error": 0.01, f"height_{k}_largest_reference": 0.5}
    row = {"case": run.file, "variant": "", "n": run.n, "outcome": COMPLETED, "reason": None, "right_hand_sides": 100, "seconds": 1.0,
           "updates_per_second": 1e6, "time": float(setting(run, "time.t_end")), "particles": 100, "dimension": 2, "mass": 0.0, "energy": 0.001,
           "metrics": metrics, "kinetic": {"end": 1e-9, "largest": 1e-7, "late": 1e-8}, "rise": 0.0,
           "semi_axes": {str(t): b for t, b in questions.SEMI_AXIS.items()}}
    return row | more


def resolved(**groups):
    return "".join(f"&{group}\n" + "".join(f"  {key} = {value}\n" for key, value in keys.items()) + "/\n" for group, keys in groups.items())


COARSER = ("sloshing", "bowl", "bowl_ranks", "dam_break_building")  # than what is asked for, also in the whole


class Questions(unittest.TestCase):
    def test_rise_of_energy(self):
        """Above an earlier value, not above the first."""
        energies = {"kinetic_energy": [2, 1, 1, 2, 0], "potential_energy": [7, 5, 6, 6, 5], "elastic_energy": [1, 1, 1, 1, 1]}
        history = {"time": np.arange(5)} | {name: np.array(values, dtype=float) for name, values in energies.items()}
        self.assertAlmostEqual(subject.rise(unittest.mock.Mock(history=history)), 0.2)  # 10, 7, 8, 9, 6
        self.assertIsNone(subject.rise(unittest.mock.Mock(history={})))

    def verdicts(self, rows):
        return {(question.case, question.what): questions.verdict(question, one)[0] for question, one in questions.rows(rows)}

    def test_met_at_what_is_asked(self):
        found = self.verdicts([made_up(run) for run in plan(long=True)])
        self.assertEqual({name: what for name, what in found.items() if what != "met" and name[0] not in COARSER}, {})
        self.assertEqual(set(found.values()), {"met", "met at n = 20", "met at 40 mm", "met at n = 3"})

    def test_coarser_or_shorter_runs_say_so(self):
        found = self.verdicts([made_up(run) for run in plan(quick=True)])
        self.assertEqual(found["still_wedge", "kinetic energy over m g H at the end"], "met at n = 25")
        self.assertEqual(found["still_wedge_3d", "mass lost"], "met until 3.19 s")
        self.assertEqual(found["dam_break_box", "P1: arrival"], "met at 40 mm")
        self.assertEqual(found["dam_break_box", "depth H1 until 4 s: mean error over the largest"], "not run")

    def test_missed_and_failed(self):
        whole = plan(parts="columns,rest")
        rows = [made_up(run) for run in whole]
        for one in rows:
            one["metrics"]["pressure_1_impulse"] = 1240.0
            one["metrics"]["particles_put_back"] = 1
            if one["case"] == "dam_break_front":
                one["outcome"] = "stopped"
        found = self.verdicts(rows)
        self.assertEqual(found["dam_break_2d", "sensor 1: impulse"], "missed")
        self.assertEqual(found["dam_break_2d", "sensor 2: impulse"], "met")
        self.assertEqual(found["still_wedge", "particles put back at a wall"], "missed")
        self.assertEqual(found["dam_break_front", "front: rms over H until the wall"], "stopped")
        page = questions.table(rows)
        self.assertIn("+24.00 % (1240 for 1000 Pa s)", page)
        self.assertIn("≤ 15 % at n = 60", page)

    def test_errors_over_resolution(self):
        for run in plan():
            one = made_up(run)
            found = questions.errors(one)
            self.assertEqual(tuple(found), questions.QUANTITIES.get(run.file, ()))
            self.assertTrue(all(value is not None for value in found.values()))
            self.assertTrue(all(subject.look(run.file, "", what) for what in found))


class Bodies(unittest.TestCase):
    """What is measured of runs whose readings are known."""

    def outcome(self, case, resolved="", columns=None, history=None, variant="", **summary):
        run = Run("flow", ROOT / f"inputs/{case}.nml", case, case, f"{case}/{variant}", variant, (), 20)
        folder = self.here / run.folder
        folder.mkdir(parents=True)
        (folder / "resolved.nml").write_text(resolved)
        for name, table in (("gauges", columns), ("history", history)):
            if table:
                heads, rows = ",".join(f"{head} [1]" for head in table), zip(*table.values())
                (folder / f"{name}.csv").write_text("\n".join([heads, *(",".join(map(repr, map(float, row))) for row in rows)]) + "\n")
        return Outcome(run, COMPLETED, "", folder, summary, False)

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.here = Path(scratch.name)

    def test_sloshing(self):
        t = np.arange(0, 6.0, 0.01)
        turn = bodies.frequency(1.2, 0.4, 9.81)
        self.assertAlmostEqual(2 * np.pi / turn, 1.403, delta=1e-3)
        one = self.outcome("sloshing", resolved(domain={"length_x": 1.6, "particles_x": 80}, flow={"gravity": 9.81, "density": 1000},
                                                solids={"length_x": 1.2}),
                           {"time": t, "height_1": 0.4 - 0.01 * np.cos(turn * t), "height_2": 0.4 + 0.01 * np.cos(turn * t),
                            "force_1_y": np.full(len(t), -4700.0)}, fluid_particles=1200)
        write_snapshot(one.folder / "snapshot_0000.h5", 0.0, np.random.default_rng(1).random((1200, 2)))
        found = bodies.measured(one, [])
        self.assertAlmostEqual(found["slosh_period"], found["slosh_period_theory"], delta=1e-4)
        self.assertAlmostEqual(found["weight_theory"] / (9.81 * one.snapshot["Masses"].sum()), 1.0)
        self.assertEqual(found["weight"], 4700.0)

    def test_floating_box(self):
        t = np.arange(0, 4.0, 0.005)
        keys = resolved(domain={"length_x": 3.2}, flow={"gravity": 9.81, "density": 1000, "high_y": 0.6},
                        solids={"centre_y": 0.64, "length_x": 0.32, "length_y": 0.2}, motions={"density": 500})
        readings = {"time": t, "motion_1_y": -0.036 * (1 - np.cos(2 * np.pi * t)), "force_1_y": np.full(len(t), 314.0)}
        found = bodies.measured(self.outcome("floating_box", keys, readings), [])
        self.assertAlmostEqual(found["heave_place_theory"], -0.036, delta=1e-12)
        self.assertAlmostEqual(found["carried_theory"], 313.92, delta=1e-9)
        self.assertAlmostEqual(found["half_period"], 0.5, delta=1e-9)
        self.assertAlmostEqual(found["heave_place"], -0.036, delta=1e-4)
        short = {name: values[:201] for name, values in readings.items()}
        found = bodies.measured(self.outcome("floating_box", keys, short, variant="short"), [])
        self.assertIn("half_period", found)
        self.assertNotIn("heave_place", found)

    def test_energy_and_ranks(self):
        history = {"time": [0, 1, 2], "kinetic_energy": [0, 4.0, 2.0], "potential_energy": [9.0, 5.5, 6.0], "energy_of_bodies": [1.0, 1.0, 1.0]}
        self.assertEqual(bodies.measured(self.outcome("bowl", history=history), []), {"energy_above_start": 0.5 / 4.0})
        alone, many = (self.outcome("bowl_ranks", variant=name, state_hash=bits, metrics={"load_max_over_mean": 1.07})
                       for name, bits in (("1 rank", "a"), ("4 ranks", "b")))
        self.assertEqual(bodies.measured(many, [alone, many]), {"load_max_over_mean": 1.07, "other_bits": 1.0})
        self.assertEqual(bodies.measured(many, [many]), {"load_max_over_mean": 1.07})
        self.assertIsNone(subject.row(alone, [alone, many]))

    def test_decisions_of_the_balancer(self):
        path = self.here / "balance.csv"
        self.assertEqual([len(column) for column in body_figures.decisions(path, ("step", "max_over_mean"))], [0, 0])
        path.write_text('step [1],max_over_mean [1],reason [text]\n20,1.2,"gain 1 pairs, moving costs 2: stay"\n25,1.1,\n')
        np.testing.assert_allclose(body_figures.decisions(path, ("step", "max_over_mean")), [[20, 25], [1.2, 1.1]])

    def test_forces_are_averaged(self):
        t = np.arange(0, 1, 0.01)
        np.testing.assert_allclose(body_figures.averaged(t, 2 * t, 0.05)[2:-2], 2 * t[2:-2])
        spike = np.where(np.arange(100) == 50, 5.0, 0.0)
        np.testing.assert_allclose(body_figures.averaged(t, spike, 0.05)[48:53], 1.0)


class Page(unittest.TestCase):
    def test_all_parts(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        here = Path(scratch.name)
        of = plan(quick=True, parts="columns")
        outcomes = [Outcome(run, COMPLETED, "", write_run(here / run.folder), {"metrics": {}}, False) for run in of]
        page = "\n".join(subject.sections(outcomes, {"runs": [made_up(run) for run in of], "orders": []}, here))
        self.assertEqual({path.name for path in here.glob("*.*")}, {"impact.png", "impact_course.png", "dam_break_2d.gif",
                                                                   "resolution.png"})
        self.assertIn("data:image/gif", page)
        self.assertTrue(all(f"<h2>{title}</h2>" in page for title in ("What was asked", "Columns of water that fall", "Runs")))
        self.assertNotIn("Water at rest", re.findall("<h2>(.*)</h2>", page))
        self.assertTrue(any("sensor 1: arrival" in line and line.endswith("met") for line in
                            subject.terminal(outcomes, {"runs": [made_up(run) for run in of]})))

    def test_the_drop_becomes_an_ellipse(self):
        t, a, b = figures.exact_axes(100.0, 0.0076)
        for time, published in questions.SEMI_AXIS.items():
            self.assertAlmostEqual(float(np.interp(time, t, b)), published, delta=2e-3)
        np.testing.assert_allclose(a * b, 1.0, rtol=1e-6)


if __name__ == "__main__":
    unittest.main()
