"""Water with a free surface: gauges beside measurements, spheres, the plan, what is judged, and the page, from made-up runs."""
import argparse
import re
import tempfile
import unittest
from pathlib import Path

import numpy as np
from tetsuame import gauges, plots, runs, spheres
from tetsuame.compare import flow as subject
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


def plan(quick=False, long=False, parts="rest,waves,columns,box"):
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


class Spheres(unittest.TestCase):
    def test_the_nearer_one_hides_the_other(self):
        eye = spheres.Eye((0, 0, 0), (1, 1, 1), 100, aside=0.0, above=0.0)
        red, blue = (1.0, 0, 0), (0, 0, 1.0)
        for order in (1, -1):
            picture = spheres.draw(eye, np.array([(0.5, 0.5, 0.2), (0.5, 0.5, 0.8)])[::order], 0.2, np.array([blue, red])[::order])
            middle = picture[50, 50]
            self.assertGreater(middle[0], 0.5)
            self.assertEqual((middle[2], middle[3]), (0.0, 1.0))
        self.assertEqual(picture[5, 5, 3], 0.0)
        self.assertAlmostEqual(picture[..., 3].sum(), np.pi * 10**2, delta=15)

    def test_lines_behind_the_box_come_first(self):
        eye = spheres.Eye((0, 0, 0), (1, 1, 1), 100)
        lines = spheres.edges(eye, (0, 0, 0), (1, 1, 1))
        farthest = eye.turned(np.zeros((1, 3)))[0, :2]
        self.assertEqual(len(lines), 12)
        self.assertEqual([bool((np.abs(line - farthest).sum(axis=1) < 1e-12).any()) for line in lines], [True] * 3 + [False] * 9)


class Plan(unittest.TestCase):
    def test_whole_and_quick(self):
        whole, quick, long = plan(), plan(quick=True), plan(long=True)
        for runs_ in (whole, quick, long):
            self.assertEqual(len({run.folder for run in runs_}), len(runs_))
            self.assertTrue(all(run.input.is_file() for run in runs_))
        self.assertLess(sum(run.seconds for run in quick), 2 * 150)
        self.assertLess(sum(run.seconds for run in whole), 2 * 720)
        tank = {(run.n, setting(run, "time.t_end")) for run in long if run.file == "dam_break_box"}
        self.assertEqual(tank, {(25, "4"), (50, "4"), (100, "1")})

    def test_parts(self):
        self.assertEqual({run.file for run in plan(parts="box")}, {"dam_break_box"})
        with self.assertRaises(SystemExit):
            plan(parts="bowl")

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
    metrics = {"hydrostatic_error": 0.005, "wall_crossings": 0, "period": 1.001, "period_theory": 1.0, "energy_decay": 0.21,
               "energy_decay_theory": 0.2,
               "front_rms_over_height": 0.02}
    for k in (1, 2, 3, 4):
        metrics |= {f"pressure_{k}_arrival": 0.41, f"pressure_{k}_arrival_reference": 0.4, f"pressure_{k}_impulse": 1100.0,
                    f"pressure_{k}_impulse_reference": 1000.0, f"height_{k}_mean_error": 0.01, f"height_{k}_largest_reference": 0.5}
    row = {"case": run.file, "variant": "", "n": run.n, "outcome": COMPLETED, "reason": None, "right_hand_sides": 100, "seconds": 1.0,
           "updates_per_second": 1e6, "time": float(setting(run, "time.t_end")), "particles": 100, "dimension": 2, "mass": 0.0, "energy": 0.001,
           "metrics": metrics, "kinetic": {"end": 1e-9, "largest": 1e-7, "late": 1e-8},
           "semi_axes": {str(t): b for t, b in questions.SEMI_AXIS.items()}}
    return row | more


class Questions(unittest.TestCase):
    def verdicts(self, rows):
        return {(question.case, question.what): questions.verdict(question, one)[0] for question, one in questions.rows(rows)}

    def test_met_at_what_is_asked(self):
        found = self.verdicts([made_up(run) for run in plan(long=True)])
        self.assertEqual(set(found.values()), {"met"})

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
            one["metrics"]["wall_crossings"] = 1
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
