"""Godunov DISPH in earnest: the plan, what is measured, and the page, from made-up runs."""
import argparse
import tempfile
import types
import unittest
from pathlib import Path

import numpy as np
from tetsuame.compare import godunov_in_earnest as subject
from tetsuame.compare import godunov_in_earnest_figures as figures

ROOT = Path(__file__).resolve().parents[2]


def plan(quick: bool, parts: str = "tube,square,sedov,overturn,impact"):
    return subject.plan(argparse.Namespace(quick=quick, parts=parts, settings=()), ROOT, argparse.ArgumentParser())


class Plan(unittest.TestCase):
    def test_whole_and_quick(self):
        whole, quick = plan(False), plan(True)
        self.assertEqual(len({run.folder for run in whole}), len(whole))
        self.assertTrue(all(run.input.is_file() for run in whole))
        self.assertLess(sum(run.seconds for run in quick), 0.7 * sum(run.seconds for run in whole))
        # Two cores, seven and three minutes.
        self.assertLess(sum(run.seconds for run in whole), 2 * 420)
        self.assertLess(sum(run.seconds for run in quick), 2 * 180)

    def test_parts(self):
        self.assertEqual({run.file for run in plan(True, "tube,impact")}, {"tube", "impact"})
        with self.assertRaises(SystemExit):
            plan(True, "tub")

    def test_the_tube_and_the_square_have_the_same_terms(self):
        terms = [{run.variant for run in plan(False, part)} for part in ("tube", "square")]
        self.assertEqual(terms[1], terms[0] - {"gsph"})


class Measures(unittest.TestCase):
    def test_asymmetry_of_mirror_images_is_zero(self):
        n, edge, radius = 16, 4.0, 1.0
        at = (np.arange(n) + 0.5) * edge / n - 0.5 * edge
        y, x = (axis.ravel() for axis in np.meshgrid(at, at, indexing="ij"))
        held = np.hypot(np.abs(x) - radius, y) < radius
        places = np.stack([x[held], y[held]], axis=1) * (0.9, 1.1) + 0.5 * edge

        def of(moved):
            fields = {"Coordinates": moved, "ParticleIDs": np.arange(len(moved))}
            snapshot = type("Snapshot", (), {"lengths": np.array([edge, edge]), "__getitem__": lambda _, name: fields[name]})()
            return figures.asymmetry(types.SimpleNamespace(case=types.SimpleNamespace(n=n), setting=lambda _: radius, snapshot=snapshot))

        self.assertLess(of(places), 1e-12)
        places[0, 0] += 0.5 * edge / n  # half a spacing: seen from both of the pair
        self.assertAlmostEqual(of(places), 0.5 * np.sqrt(2 / len(places)), delta=1e-9)

    def test_where_terms_fade(self):
        self.assertEqual([figures.fading_of(name) for name in ("gdisph, number", "gdisph, fading 20", "gdisph, none", "gsph")], [0.0, 20.0, None, None])


class Page(unittest.TestCase):
    def test_tables_and_the_figure_of_the_trade(self):
        common = {"outcome": "completed", "n": 8, "energy": 1e-6, "momentum": 1e-16, "right_hand_sides": 100, "seconds": 1.0, "time": 1.0}
        runs = [common | {"case": "tube", "variant": run.variant, "density_l1": 0.005} for run in plan(True, "tube")]
        runs += [common | {"case": "square", "variant": run.variant, "area_change": -0.002, "corner_radius": 0.05} for run in plan(True, "square")]
        runs += [common | {"case": "impact", "variant": "gsph", "outcome": "stopped"}]
        with tempfile.TemporaryDirectory() as scratch:
            page = "\n".join(subject.sections([], {"runs": runs}, Path(scratch)))
        self.assertIn("−0.20 %", page)
        self.assertIn("0.00500", page)
        lines = subject.terminal([], {"runs": runs})
        self.assertTrue(any("stopped" in line for line in lines))
        self.assertIsNotNone(figures.trade(runs))
        self.assertTrue(all(not subject.judged(one) for one in runs if one["case"] != "tube"))


if __name__ == "__main__":
    unittest.main()
