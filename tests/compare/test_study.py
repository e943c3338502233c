"""compare convection, shock, rti: the pure parts, and each once on programs that only pretend to calculate."""
import argparse
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

import inside
from tetsuame.compare import (balance_study, continuity_of_y, convection, hydrostatic, orders, references, rti, runner, shock, study,
                              table, time_stepping)
from tetsuame.compare.cases import Run
from tetsuame.compare.outcomes import Outcome
from test_compare import Balance

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]


class Doubtful(unittest.TestCase):
    """A run that came to its end, but says itself that it means nothing."""

    def test_its_figures_are_taken_and_it_is_shown_as_doubtful(self):
        with tempfile.TemporaryDirectory() as place:
            case = Run("disph_b", Path("rti_note.nml"), "rti_note", "B", "b", "", (), program="B")
            (Path(place) / "summary.json").write_text(json.dumps(
                {"status": "completed_doubtful", "message": "completed 9 steps; doubtful: the energy is off by 24", "errors": {"pressure_mean": 0.5}}))
            outcome = runner.judge(case, Path(place), 0, False)
        self.assertEqual((outcome.kind, outcome.doubtful), ("completed", True))
        self.assertEqual((table.said(outcome), table.cell(outcome), table.verdict(outcome)), ("doubtful", "doubtful", "completed"))
        self.assertEqual(table.error(outcome, "pressure_mean"), 0.5)
        self.assertIn("1 runs: 1 completed, 1 of the completed doubtful", study.facts([outcome], ()))
        self.assertIn("the energy is off by 24", study.reasons([outcome]))

    def test_a_run_without_a_doubt_has_no_reason(self):
        outcome = Outcome(Run("disph_b", Path("a.nml"), "a", "B", "b", "", ()), "completed", "", HERE, {"status": "completed"}, False)
        self.assertFalse(outcome.doubtful)
        self.assertEqual(study.reasons([outcome]), "")


class Orders(unittest.TestCase):
    def order(self, n, errors, uncertainties=None):
        return orders.order(n, errors, uncertainties or [0.0] * len(n))

    def test_order_of_a_power(self):
        n = [16, 24, 32, 48]
        found = self.order(n, [3.0 * k**-2.5 for k in n])
        self.assertAlmostEqual(found.value, 2.5, places=12)
        self.assertAlmostEqual(found.error, 0.0, places=10)
        self.assertAlmostEqual(math.exp(found.intercept), 3.0, places=10)
        # Signs do not matter: |error| is fitted.
        self.assertAlmostEqual(self.order(n, [-3.0 * k**-2.5 for k in n]).value, 2.5, places=12)

    def test_errors_within_their_uncertainty_are_left_out(self):
        n, errors = [10, 20, 40, 80], [1e-2, 1e-3, 1e-4, 5e-6]
        self.assertEqual(self.order(n, errors, [0.0, 0.0, 0.0, 1e-5]).points, 3)
        self.assertAlmostEqual(self.order(n, errors, [0.0, 0.0, 0.0, 1e-5]).value, math.log2(10))
        self.assertEqual(self.order(n, [1e-2, None, 1e-4, 1e-5]).points, 3)

    def test_two_points_have_no_order(self):
        self.assertIsNone(self.order([10, 20], [1e-2, 1e-3]))
        self.assertIsNone(self.order([10, 20, 40], [1e-2, 1e-3, 1e-4], [0.0, 0.0, 1e-3]))
        self.assertIsNone(self.order([10, 20, 20], [1e-2, 1e-3, 1e-3]))  # of one number of particles twice
        runs = [{"case": "a", "variant": "", "n": n, "error": 1.0 / n} for n in (10, 20)]
        found, = orders.entries(runs, lambda one: {"error": (one["error"], 0.0)})
        self.assertEqual((found["order"], found["points"], orders.said(found)), (None, 2, "–"))
        self.assertIn("at least 3", orders.note({"orders": [found]}))
        self.assertEqual(orders.note({"orders": [found | {"order": 1.0}]}), "")

    def test_standard_error(self):
        # By hand: y = 0, 1, 1 over x = 0, 1, 2; slope 1/2, residuals -1/6, 1/3, -1/6, error (1/6/2)^1/2.
        runs = [{"case": "a", "variant": "", "n": math.exp(x), "error": math.exp(-y)} for x, y in ((0, 0), (1, 1), (2, 1))]
        found, = orders.entries(runs, lambda one: {"error": (one["error"], 0.0)})
        self.assertAlmostEqual(found["order"], 0.5)
        self.assertAlmostEqual(found["standard_error"], math.sqrt(1 / 12))
        self.assertEqual(orders.said(found), "0.50 ± 0.29")


class Parts(unittest.TestCase):
    def test_a_reference_holds_at_its_own_numbers_only(self):
        self.assertEqual(references.of("air_1e4", {"rayleigh": 1e4, "prandtl": 0.71}).values["nusselt_volume"], 2.158076)
        self.assertIsNone(references.of("air_1e4", {"rayleigh": 2e4, "prandtl": 0.71}))
        self.assertIsNone(references.of("air_1e4", {"rayleigh": 1e4, "prandtl": 1.0}))
        self.assertIsNotNone(references.of("blankenbach_1a", {"rayleigh": 1e4, "prandtl": 2.5e25}))
        self.assertIsNone(references.of("mine", {"rayleigh": 1e4}))

    def test_the_references_are_those_of_the_inputs(self):
        for name, known in references.STEADY.items():
            text = (ROOT / "inputs" / f"{name}.nml").read_text()
            for key in ("nusselt_volume", "v_rms"):
                said = re.sub(r"0+$", "", f"{known.values[key]:.6f}")
                self.assertIn(said[:6], text, f"{name}: {key}")

    def test_numbers_are_shown_as_far_as_they_are_certain(self):
        def shown(name, value, uncertainty):
            return convection.shown({"values": {name: {"value": value, "uncertainty": uncertainty}}}, name)
        self.assertEqual(shown("v_rms", 42.865432, 0.0031), "42.865 ± 0.003")
        self.assertEqual(shown("nusselt_volume", 2.1639712, 2.4e-5), "2.16397 ± 0.00002")
        self.assertEqual(shown("v_rms", 184.26, 12.0), "184 ± 12")
        self.assertEqual(shown("nusselt_top", 4.88441, None), "4.8844")
        self.assertEqual(convection.percent(-4e-6), "0.00 %")
        self.assertEqual(convection.percent(-0.0121), "−1.21 %")

    def test_width_of_a_box(self):
        self.assertEqual(convection.aspect(ROOT / "inputs" / "blankenbach_2b.nml"), 2.5)
        self.assertEqual(convection.aspect(ROOT / "inputs" / "blankenbach_1a.nml"), 1.0)

    def test_l1_against_another_run(self):
        def run(n, density):
            x = (np.arange(n) + 0.5) / n
            zero = np.zeros(n)
            return {"Coordinates": np.column_stack([x, zero, zero]), "Velocities": np.column_stack([2 * x, zero, zero]),
                    "Density": density(x), "Masses": density(x) / n, "Pressure": np.ones(n)}
        fine, coarse = run(200, lambda x: 1 + x), run(50, lambda x: 1.25 + x)
        errors = shock.l1(coarse, {name: values[::-1] for name, values in fine.items()})  # in any order
        self.assertAlmostEqual(errors["density_l1"], 0.25, places=12)
        self.assertAlmostEqual(errors["velocity_l1"], 0.0, places=12)
        self.assertEqual(errors["pressure_l1"], 0.0)

    def test_names_of_schemes_stand_apart(self):
        one = {"case": "sod", "n": 20, "outcome": "completed", "metrics": {}, "errors": {"density_l1": 0.1}, "sizes": {}}
        head, line = shock.terminal([], {"runs": [one | {"variant": scheme} for scheme in shock.SCHEME]})
        self.assertEqual(re.split(r" {2,}", head)[-5:], ["SSPH", "DISPH", "GSPH", "Godunov DISPH", "REMIX"])
        self.assertEqual(len(head), len(line))

    def test_each_scheme_has_the_support_of_its_own_kernel(self):
        given = argparse.Namespace(p_top=1e10, settings=())
        said = {name: rti.run(ROOT, name, rti.OVERTURN, 24, given).settings for name in ("C", "SSPH", "rti")}
        self.assertIn("kernel.h_over_dx=0", said["C"])
        self.assertIn("kernel.h_over_dx=0", said["SSPH"])
        self.assertNotIn("kernel.h_over_dx=0", said["rti"])  # its kernel is that of the input

    def test_the_slow_form_runs_on_some(self):
        given = {"motions": "rest,gravity", "particles": None, "quick": False, "square": 0, "settings": []}
        some = continuity_of_y.plan(argparse.Namespace(**given, forms=None), ROOT, argparse.ArgumentParser())
        self.assertEqual({(one.file, one.n) for one in some if one.variant == "A"},
                         {(f"rest_{masses}", n) for masses in continuity_of_y.MASSES for n in (32, 64)})
        asked = continuity_of_y.plan(argparse.Namespace(**given, forms="A"), ROOT, argparse.ArgumentParser())
        self.assertEqual(len(asked), 2 * 2 * 3)

    def test_verdict(self):
        def one(form, error):
            return {"case": "rest_equal_mass", "motion": "rest", "masses": "equal_mass", "variant": form, "n": 64, "pressure_near": error}
        measured = {"runs": [one("F", 0.02), one("E", 9e-4), one("C", 0.01), one("SSPH", None)]}
        self.assertEqual(continuity_of_y.verdict(measured), ["at rest, equal masses: held by E; not by C 1 %, F 2 %; stopped: SSPH"])
        measured["runs"] += [one(form, 1e-5) | {"masses": "equal_spacing", "case": "rest_equal_spacing"} for form in ("C", "E")]
        self.assertRegex(continuity_of_y.conclusion(measured), "both kinds of masses are held by E; equal spacing alone by C[.]")

    def test_balance(self):
        def given(**own):
            return argparse.Namespace(**{"cases": None, "partitioners": "rcb", "quick": True, "settings": []} | own)
        runs = balance_study.plan(given(), ROOT, argparse.ArgumentParser())
        self.assertEqual([(one.file, one.variant) for one in runs], [
            ("bowl_2e5", "remap"), ("bowl_2e5", "level_relaxation"), ("blast", "particles"), ("blast", "remap"), ("blast", "level_relaxation")])
        self.assertIs(runs[3].start, runs[2])
        self.assertEqual(runs[3].start_key, "distribution.file")
        self.assertIn("compare.methods='rcb'", runs[0].settings)
        without = balance_study.plan(given(partitioners="none"), ROOT, argparse.ArgumentParser())
        self.assertTrue(all("compare.methods='none'" in one.settings for one in without if one.binary == "balance"))
        # By theory: 1 - omega on every level and |1 - 2 omega| of the saw-tooth; without levels the longest wave stays.
        for count in (2, 8, 22, 64):
            self.assertAlmostEqual(balance_study.factor(count, 2.0 / 3.0), 1.0 / 3.0, places=6)
        self.assertAlmostEqual(balance_study.factor(22, 0.6, 0), 1.0 - 0.6 * (1.0 - math.cos(math.pi / 22)), places=9)

    def test_page_of_balance(self):
        def one(case, spread):
            method = {"start": spread[0], "end": spread[-1], "updates_to_5_percent": None, "moved": 0.5, "run_time": 2.0, "spread": spread}
            return {"case": case, "variant": "level_relaxation", "run_time_equal_counts": 3.0, "methods": {"level_relaxation": method}}
        measured = {"runs": [one("bowl_2e5", [1.8, 0.3, 0.04]), one("blast", [0.5, 0.2, 0.1])]}
        self.assertEqual(balance_study.verdict(measured), "At its default relaxation the quasi-Newton step comes below 5 % in 1 of 2 cases; not in: "
                         "Sedov's blast in 3-D, 4096 particles, 8 ranks.")
        with tempfile.TemporaryDirectory() as folder:
            page = "".join(balance_study.sections([], measured, Path(folder)))
            self.assertTrue((Path(folder) / "spread.png").is_file())
        self.assertIn("180 %", page)

    def test_causes_in_few_words(self):
        self.assertEqual(rti.cause("step 5: the equation of state's pressure p = -2e7 Pa is not positive and finite"), "p ≤ 0")
        self.assertEqual(rti.cause("step 9: the weight Y = -1e18 J is not positive and finite"), "Y ≤ 0")
        self.assertEqual(rti.cause("step 9: the rate of vx is nan, not a finite number: particle 3 at (1, 2) m"), "blew up")
        self.assertEqual(rti.cause("step 1: Hosono's iteration (newton): no state with p > 0 exists: the kernel's sum"), "no solution")
        self.assertEqual(rti.cause("step 1: particles moved 1e4 m within one step, more than half the skin"), "left its lists in a step")

    def test_json_has_no_nan(self):
        self.assertEqual(study.finite({"a": [1.0, math.nan], "b": {"c": math.inf}}), {"a": [1.0, None], "b": {"c": None}})


class Frame(unittest.TestCase):
    def test_programs_that_a_command_line_needs(self):
        self.assertEqual(study.needed(["convection", "--quick"]), ["convection"])
        self.assertEqual(study.needed([]), [f"disph_{letter}" for letter in "abcdef"])
        self.assertEqual(study.needed(["rti", "--help"]), [])
        every = study.needed(["--all"])
        for subject in study.SUBJECTS:
            self.assertLessEqual(set(study.needed([subject])), set(every), subject)

    def test_help_names_every_comparison(self):
        said = inside.call("compare", "--help").stdout
        for subject in study.SUBJECTS:
            self.assertRegex(said, rf"(?m)^  {subject} ")
        self.assertIn("--all", said)

    def test_time_that_remains(self):
        progress = runner.Progress([10.0, 0.0, 20.0, 30.0], 2)
        self.assertEqual(progress.remaining(), "")
        self.assertEqual(progress.work[1], 20.0)  # unknown: as the others
        progress.start -= 6.0
        progress.spent += progress.left.pop(3)
        self.assertEqual(progress.remaining(), ", about 10 s left")  # 6 s for 30 of 80
        progress.left = {0: 3000.0}
        self.assertEqual(progress.remaining(), ", about 10 min left")


class AtRest(unittest.TestCase):
    """Where another program would stop, read off the residuals of the plain iteration."""

    def test_growth_is_seen_in_the_second_pass_of_an_evaluation(self):
        passes = [1e-12 * 10.0**k for k in range(12)]
        self.assertEqual(hydrostatic.dies(passes, 1e-13), (1, 2))
        self.assertEqual(hydrostatic.dies(passes, 5e-12), (2, 2))    # one evaluation was accepted
        self.assertEqual(hydrostatic.dies(passes, 5e-10), (4, 2))
        self.assertIsNone(hydrostatic.dies(passes, 1.0))             # nothing grows above it

    def test_a_start_that_settles_before_it_grows(self):
        self.assertEqual(hydrostatic.dies([1e-4, 1e-14, 1e-13, 1e-12], 5e-14), (2, 2))
        self.assertEqual(hydrostatic.dies([1e-4, 1e-6, 1e-5], 1e-9), (1, 3))

    def test_a_pressure_below_zero_is_seen_one_pass_later(self):
        self.assertEqual(hydrostatic.dies([math.inf], 1e-6), (1, 2))
        self.assertEqual(hydrostatic.dies([1e-10, 1e-4, math.inf], 1e-6), (2, 2))
        self.assertEqual(hydrostatic.dies([1e-10, math.inf], 1e-6), (2, 2))

    def test_a_run_that_starts_from_another_depends_on_it(self):
        given = argparse.Namespace(schemes="C", starts="glass", quick=False, settings=())
        made, run = hydrostatic.plan(given, ROOT, argparse.ArgumentParser())[:2]
        self.assertIs(run.start, made)
        with tempfile.TemporaryDirectory() as folder:
            for name in ("disph_a", "disph_c"):
                (Path(folder) / name).write_text(name)
            before = runner.fingerprint(Path(folder), run)
            (Path(folder) / "disph_a").write_text("another")
            self.assertNotEqual(before, runner.fingerprint(Path(folder), run))


class TimeStepping(unittest.TestCase):
    def test_the_cheapest_has_the_fewest_right_hand_sides(self):
        runs = [{"error": error, "right_hand_sides": sides} for error, sides in ((2e-3, 50), (9e-4, 300), (1e-5, 200), (None, 10))]
        self.assertEqual(time_stepping.cheapest(runs, 1e-2)["right_hand_sides"], 50)
        self.assertEqual(time_stepping.cheapest(runs, 1e-3)["right_hand_sides"], 200)
        self.assertIsNone(time_stepping.cheapest(runs, 1e-6))

    def test_equal_steps_end_at_the_end(self):
        given = argparse.Namespace(quick=False, settings=[], cases=",".join(time_stepping.CASES))
        runs = time_stepping.plan(given, ROOT, argparse.ArgumentParser())
        self.assertEqual(len({run.folder + run.file for run in runs}), len(runs))
        for run in runs:
            settings = dict(setting.split("=", 1) for setting in run.settings)
            if "time.dt" in settings and run.n:
                self.assertAlmostEqual(float(settings["time.dt"]) * run.n, time_stepping.CASES[run.file].t_end, places=9)
                self.assertNotEqual(run.variant, time_stepping.REFERENCE)

    def test_distance_over_the_way(self):
        with tempfile.TemporaryDirectory() as scratch:
            def made(name, *states):
                folder = Path(scratch) / name
                folder.mkdir()
                for k, x in enumerate(states):
                    with h5py.File(folder / f"snapshot_{k:04}.h5", "w") as file:
                        file.create_group("Header").attrs.update(Time=float(k), Step=k, Dimension=2, BoxLengths=[1.0, 1.0, 1.0], Periodic=[1, 0, 0])
                        file["PartType0/ParticleIDs"] = np.arange(2)
                        file["PartType0/Coordinates"] = np.array([[x, 0.5, 0.0], [x + 0.5, 0.5, 0.0]]) % 1.0
                case = Run("rti", Path("none"), "overturn", name, name, name, ())
                return Outcome(case, "completed", "", folder, {}, False)
            reference, other = made("reference", 0.3, 0.4), made("other", 0.3, 0.41)
            self.assertAlmostEqual(time_stepping.distance(other, reference), 0.1, places=12)
            across = made("across", 0.95, 1.05)  # through the periodic side
            self.assertAlmostEqual(time_stepping.distance(across, across), 0.0)
            self.assertAlmostEqual(time_stepping.distance(made("late", 0.95, 1.02), across), 0.3, places=12)


class Pages(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.output = Path(scratch.name) / "compare"
        self.binaries = Path(scratch.name) / "programs"
        self.binaries.mkdir()
        for name in ("convection", "shock", "rti", "disph_n", *hydrostatic.PROGRAMS):
            program = self.binaries / name
            program.write_bytes((HERE / "fake_study.py").read_bytes())
            program.chmod(0o755)

    def compare(self, *arguments, fail=""):
        command = [sys.executable, "-m", "tetsuame", "compare", *arguments, "--binaries", self.binaries, "--output", self.output]
        environment = os.environ | {"PYTHONPATH": str(ROOT / "programs/python"), "FAKE_FAIL": fail}
        return subprocess.run([str(word) for word in command], capture_output=True, text=True, env=environment, cwd=ROOT)

    def results(self):
        return json.loads((self.output / "results.json").read_text())

    def check_page(self, figures):
        page = (self.output / "report.html").read_text()
        self.assertEqual(re.findall(r'(?:src|href)\s*=\s*"(?!data:)[^"]*"|url\(|<script|<link|@import|https?://', page), [])
        self.assertEqual(page.count("data:image/png;base64,iVBOR"), figures)
        balance = Balance()
        balance.feed(page)
        self.assertEqual((balance.open, balance.wrong), ([], []))
        return page

    def test_convection(self):
        done = self.compare("convection", "--inputs", "blankenbach_1a,air_1e4", "--particles", "16", "24", "32", fail="air_1e4:16")
        self.assertEqual(done.returncode, 0, done.stderr)
        found = self.results()
        runs = {(one["case"], one["n"]): one for one in found["runs"]}
        self.assertEqual(len(runs), 6)
        nusselt = runs["blankenbach_1a", 24]["values"]["nusselt_volume"]
        # The pretended error is 1/n², exactly.
        self.assertAlmostEqual(nusselt["error"], 24**-2, places=9)
        fits = {(one["case"], one["quantity"]): one for one in found["orders"]}
        self.assertAlmostEqual(fits["blankenbach_1a", "nusselt_volume"]["order"], 2.0, places=6)
        self.assertEqual((fits["air_1e4", "nusselt_volume"]["points"], fits["air_1e4", "nusselt_volume"]["order"]), (2, None))
        broken = runs["air_1e4", 16]
        self.assertEqual((broken["outcome"], broken["values"]), ("diverged", {}))
        self.assertIn("blown up", broken["reason"])
        page = self.check_page(5)
        self.assertIn("blown up", page)
        self.assertIn('<td class="number e4">+0.17 %</td>', page)
        self.assertIn(orders.WHY_NONE, page)
        self.assertIn("Nothing has changed", self.compare("convection", "--inputs", "blankenbach_1a,air_1e4", "--particles", "16", "24", "32",
                                                          fail="air_1e4:16").stdout)

    def test_another_rayleigh_number_has_no_reference(self):
        done = self.compare("convection", "--inputs", "air_1e4", "--particles", "16", "--set", "convection.rayleigh=2e4")
        self.assertEqual(done.returncode, 0, done.stderr)
        value = self.results()["runs"][0]["values"]["nusselt_volume"]
        self.assertEqual((value["reference"], value["error"]), (None, None))
        self.assertIn("No value known", (self.output / "report.html").read_text())

    def test_shock(self):
        done = self.compare("shock", "--tests", "sod,blasts,square", "--schemes", "disph,gsph", "--particles", "20", "30", "40",
                            fail="sod:disph")
        self.assertEqual(done.returncode, 0, done.stderr)
        found = self.results()
        runs = {(one["case"], one["variant"], one["n"]): one for one in found["runs"]}
        self.assertEqual(len(runs), 3 * 2 * 3)  # the reference run of the blasts is none of them
        self.assertEqual(runs["sod", "disph", 40]["outcome"], "diverged")
        order = next(one for one in found["orders"] if (one["case"], one["variant"]) == ("sod", "gsph"))
        self.assertAlmostEqual(order["order"], 1.0, places=9)
        self.assertIn("80 particles", runs["blasts", "gsph", 40]["errors_against"])
        self.assertAlmostEqual(runs["blasts", "gsph", 40]["errors"]["density_l1"], 0.5, places=6)
        self.assertAlmostEqual(runs["blasts", "gsph", 40]["sizes"]["density_l1"], 2.0, delta=0.02)  # of the reference run, not its own 2.5
        self.assertAlmostEqual(shock.measure(runs["sod", "gsph", 40], "density_l1")[1], 0.025 / 2, delta=2e-4)
        self.check_page(5)  # convergence, three tests, cost
        self.assertRegex(done.stdout, r"sod +40 .*diverged")

    def test_rti(self):
        done = self.compare("rti", "--schemes", "C; N", "--particles", "16", "24", "32", "--overturn", "16", fail="overturn:disph_c")
        self.assertEqual(done.returncode, 0, done.stderr)
        found = self.results()
        runs = {(one["variant"], one["case"], one["n"]): one for one in found["runs"]}
        self.assertEqual(len(runs), 8)
        self.assertEqual(runs["C", "overturn", 16]["outcome"], "diverged")
        self.assertEqual(runs["C", "overturn", 16]["time"], 531.0)
        self.assertAlmostEqual(runs["N", "growth", 32]["growth_error"], 32**-2, places=9)
        self.assertAlmostEqual(next(one for one in found["orders"] if one["variant"] == "N")["order"], 2.0, places=6)
        page = self.check_page(4)
        self.assertIn("smoothed pressure", page)

    def test_hydrostatic(self):
        done = self.compare("hydrostatic", "--schemes", "C; D; E", "--starts", "jitter 10 %; glass", fail="jitter_10:disph_d")
        self.assertEqual(done.returncode, 0, done.stderr)
        runs = {(one["case"], one["variant"]): one for one in self.results()["runs"]}
        self.assertEqual({start for start, _ in runs}, {"jitter 10 %", *(hydrostatic.GLASS, hydrostatic.MAKING, hydrostatic.OPEN, hydrostatic.PLAIN)})
        self.assertEqual((runs["jitter 10 %", "C"]["verdict"], runs["jitter 10 %", "E"]["verdict"]), ("drifts", "holds"))
        self.assertAlmostEqual(runs["glass", "C"]["moved"], 0.2)
        self.assertAlmostEqual(runs["glass", "C"]["moved_late"], 0.1)
        self.assertAlmostEqual(runs["glass", "C"]["crossings_a_spacing"], 5000 / hydrostatic.CROSSING)
        self.assertAlmostEqual(runs["glass", "C"]["pressure_mean"], 0.01)
        self.assertEqual(runs["jitter 10 %", "D"]["stopped_step"], 53)
        self.assertNotIn("verdict", runs["jitter 10 %", "D"])
        page = self.check_page(2)
        self.assertIn("stops, step 53", page)
        # What starts from the glass is not run again, and is when the glass is another.
        arguments = ("hydrostatic", "--schemes", "C; D; E", "--starts", "jitter 10 %; glass")
        self.assertIn("Nothing has changed", self.compare(*arguments, fail="jitter_10:disph_d").stdout)

    def test_nothing_starts_from_a_run_that_left_no_end(self):
        done = self.compare("hydrostatic", "--schemes", "C", "--starts", "glass", fail="making_of_the_glass:disph_a")
        self.assertEqual(done.returncode, 1)
        self.assertIn("left no end", done.stdout)

    def test_continuity_of_y(self):
        done = self.compare("continuity_of_y", "--forms", "C; N", "--motions", "rest,sheared,gravity", "--particles", "32", "64", "128", "--square", "16",
                            "--quick", fail="rest_equal_mass:disph_n")
        self.assertEqual(done.returncode, 0, done.stderr)
        found = self.results()
        runs = {(one["case"], one["variant"], one["n"]): one for one in found["runs"]}
        self.assertEqual(len(runs), 3 * 2 * 2 * 3 + 4)
        for case in ("rest_equal_spacing", "gravity_equal_mass"):  # under gravity the column's own pressure is taken off
            one = runs[case, "C", 128]
            self.assertAlmostEqual(one["pressure_near"], 1 / 32, places=6)
            self.assertLess(one["pressure_elsewhere"], 1e-6)
            self.assertAlmostEqual(one["speed_near"], 5.0)
        self.assertAlmostEqual(runs["sheared_equal_mass", "C", 64]["speed_near"], 4.0)  # across the contact
        self.assertIsNone(runs["rest_equal_mass", "N", 64]["pressure_near"])
        self.assertAlmostEqual(next(one for one in found["orders"] if one["quantity"] == "pressure_near")["order"], 1.0, places=6)
        self.check_page(4)  # over time, across the contact, orders, the square
        self.assertIn("at rest, equal masses: held by none; not by C 3.1 %; stopped: N", done.stdout)

    def test_usage_errors_run_nothing(self):
        for arguments, word in ((("convection", "--particles", "4"), "at least 8"), (("convection", "--inputs", "none"), "'none'"),
                                (("shock", "--tests", "soot"), "no test 'soot'"), (("shock", "--schemes", "sph"), "no scheme 'sph'"),
                                (("continuity_of_y", "--particles", "34"), "multiples of 4"), (("continuity_of_y", "--forms", "Q"), "no form 'Q'"),
                                (("rti", "--schemes", "Z"), "no scheme 'Z'"), (("rti", "--jobs", "0"), "--jobs")):
            with self.subTest(word):
                done = inside.call("compare", *arguments, "--binaries", self.binaries, "--output", self.output)
                self.assertEqual(done.returncode, 2)
                self.assertIn(word, done.stderr)
        self.assertFalse(self.output.exists())


if __name__ == "__main__":
    unittest.main()
