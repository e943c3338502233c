"""The studies of slowed convection: what is foretold, what is counted, and the pages, from made-up histories."""
import argparse
import itertools
import math
import tempfile
import unittest
import unittest.mock
from pathlib import Path

import numpy as np
from tetsuame.compare import gravity_density, relaxation_map, slides_convection, slowed_roll, steady_flow, study
from tetsuame.compare.outcomes import COMPLETED, STOPPED, Outcome

ROOT = Path(__file__).resolve().parents[2]


def given(quick: bool) -> argparse.Namespace:
    return argparse.Namespace(quick=quick, particles=None, settings=())


class Written(unittest.TestCase):
    """Outcomes whose histories are on disk."""

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)

    def outcome(self, run, columns: dict | None, **summary) -> Outcome:
        folder = self.folder / run.folder
        folder.mkdir(parents=True)
        if columns:
            lines = [",".join(f"{name} [1]" for name in columns), *(",".join(f"{value:.12g}" for value in row) for row in zip(*columns.values()))]
            (folder / "history.csv").write_text("\n".join(lines) + "\n")
        kind = COMPLETED if columns else STOPPED
        return Outcome(run, kind, "" if columns else "the flow has blown up", folder, {"status": "completed"} | summary, False)

    def measured(self, subject, outcomes: list[Outcome]) -> dict:
        return {"runs": [study.common(one) | subject.row(one, outcomes) for one in outcomes]}

    def page(self, subject, outcomes: list[Outcome]) -> tuple[str, list[str]]:
        measured = self.measured(subject, outcomes)
        return "\n".join(subject.sections(outcomes, measured, self.folder)), subject.terminal(outcomes, measured)


class SteadyFlow(unittest.TestCase):
    def test_known_steady_states(self):
        mantle = steady_flow.solve(1e4)
        self.assertAlmostEqual(mantle.nusselt / 4.884409, 1.0, delta=3e-4)
        self.assertAlmostEqual(mantle.v_rms / 42.864947, 1.0, delta=1e-5)
        air = steady_flow.solve(1e4, 0.71, True)
        self.assertAlmostEqual(air.nusselt / 2.158076, 1.0, delta=1e-4)

    def test_weighed_pressure_slows_and_at_last_stops_the_flow(self):
        nusselt = [steady_flow.solve(1e4, weight=s).nusselt for s in (0.0, 6.4, 160.0)]
        self.assertAlmostEqual(nusselt[1], 4.534, delta=2e-3)
        self.assertAlmostEqual(nusselt[2], 1.0, delta=1e-6)

    def test_pressure_does_not_matter_where_nothing_weighs_it(self):
        # curl F = 0 of the solution, at places that are none of collocation.
        flow = steady_flow.solve(1e4)
        x = np.array([0.31, 0.62])
        psi = flow.bases["psi"]
        biharmonic = sum(weight * psi(x, i) @ flow.stream @ psi(x, 4 - i).T for i, weight in ((0, 1), (2, 2), (4, 1)))
        heat = flow.bases["even"](x, 1) @ flow.excess @ flow.bases["zero"](x).T
        np.testing.assert_allclose(biharmonic, 1e4 * heat, rtol=0.02, atol=50.0)


class SlowedRoll(unittest.TestCase):
    def test_parabola(self):
        np.testing.assert_allclose(slowed_roll.vertex(0.5, 3.0 - 0.5 * (np.arange(0.0, 5.0, 0.5) - 2.7)**2), (2.7, 3.0))

    def test_exponentials(self):
        matrix = np.array([[[-300.0, 20.0], [0.0, -2.0]], [[1.0, 4.0], [-4.0, 1.0]]])
        phi = slowed_roll.exponentials(matrix)
        np.testing.assert_allclose(phi[0][1], math.e * np.array([[math.cos(4), math.sin(4)], [-math.sin(4), math.cos(4)]]))
        for n in (1, 2, 3):  # z phi_n = phi_(n-1) - 1/(n-1)!
            np.testing.assert_allclose(matrix @ phi[n], phi[n - 1] - np.eye(2) / math.factorial(n - 1), atol=1e-11)

    def test_overshoot_without_inertia(self):
        # By polynomials in the place of waves, and other steps.
        time, height = slowed_roll.first_overshoot(1e4, 0.05)
        self.assertAlmostEqual(time / 0.0129755, 1.0, delta=1e-4)
        self.assertAlmostEqual(height / 83.655, 1.0, delta=1e-4)

    def test_a_small_roll_grows_as_it_should(self):
        # Linear: (s + K)(1 + s/(Pr K)) = Ra pi²/K² (1 + s/(s + c²/Pr)), which the rates of the first wave have as an eigenvalue.
        Pr, sound, K = 700.0, 3000.0, 2.0 * math.pi**2
        s = np.linalg.eigvals(slowed_roll.Roll(1e4, Pr, sound).linear[1, 1]).real.max()
        self.assertAlmostEqual((s + K) * (1 + s / (Pr * K)) / (1e4 * math.pi**2 / K**2 * (1 + s / (s + sound**2 / Pr))), 1.0, delta=0.02)


class GravityDensity(Written):
    def setUp(self):
        super().setUp()
        # What is foretold stands in the page's line at ten places: here at two.
        lines = unittest.mock.patch.object(gravity_density, "PLACES", 2)
        lines.start()
        self.addCleanup(lines.stop)

    def test_steps_of_the_notes_rules(self):
        t = np.linspace(0.0, 20.0, 201)
        columns = {"time": t, "step": 1000.0 * t, "v_rms": np.sin(0.2 * t)}
        air = gravity_density.counted("note_air_1e4", 32, columns)
        self.assertAlmostEqual(air["rule"], 3200.0)
        self.assertAlmostEqual(air["taken"], 1e6 / 7100**0.4)  # steps in L²/κ = 1000 s over V in κ/L
        self.assertAlmostEqual(air["seen"], 7900, delta=100)
        self.assertAlmostEqual(gravity_density.counted("note_mantle_1c", 100, columns)["rule"], 8e5)
        rising = columns | {"v_rms": t}
        self.assertIsNone(gravity_density.counted("note_air_1e4", 32, rising)["seen"])
        self.assertIsNone(gravity_density.counted("note_air_1e4", 32, {})["taken"])

    def test_page(self):
        runs = gravity_density.plan(given(True), ROOT, None)
        self.assertLessEqual(sum(run.seconds for run in runs), 180.0)
        t = np.linspace(0.0, 1.0, 50)
        outcomes = []
        for run in runs:
            conventional = run.variant.startswith("conventional")
            if conventional and run.variant.endswith(("= 5", "4440")):
                outcomes.append(self.outcome(run, None))
            else:
                nusselt = 4.0 * (1.0 - 0.1 * conventional)
                outcomes.append(self.outcome(run, {"time": t, "step": 100 * t, "nusselt_volume": nusselt + 0 * t, "v_rms": 40.0 + np.sin(4 * t)}))
        measured = self.measured(gravity_density, outcomes)
        by = {(one["case"], one["variant"]): found for one, found in gravity_density.densities(measured)}
        self.assertAlmostEqual(by["blankenbach_1a", "conventional, zeta = 3"]["measured"]["nusselt"], -0.1)
        self.assertAlmostEqual(by["blankenbach_1a", "conventional, zeta = 3"]["foretold"]["nusselt"], -0.0261, delta=2e-4)
        self.assertAlmostEqual(by["blankenbach_1a", "separated, zeta = 20"]["measured"]["nusselt"], 0.0)
        self.assertIsNone(by["blankenbach_1a", "conventional, zeta = 5"]["measured"]["nusselt"])
        page, lines = self.page(gravity_density, outcomes)
        self.assertIn("−10.00 %", page)
        self.assertEqual(page.count("data:image/png"), 1)
        self.assertTrue(any("−2.61 %" in line for line in lines))

    def test_inputs_are_those_of_the_note(self):
        for name, zeta in (("air_1e4", 10800), ("air_1e5", 4290), ("air_1e6", 1710), ("mantle_1a", 9.28), ("mantle_1b", 13.6), ("mantle_1c", 20)):
            self.assertIn(f"zeta = {zeta:g} ", (ROOT / f"inputs/note_{name}.nml").read_text())


class RelaxationMap(Written):
    def test_the_notes_factors_give_table_4(self):
        zeta, xi = relaxation_map.slowing("blankenbach_1a", 0.1, 0.5)
        self.assertAlmostEqual(zeta, 9.28, delta=0.01)
        self.assertAlmostEqual(xi / 1.16e11, 1.0, delta=2e-3)
        steps = float(relaxation_map.steps("blankenbach_1a", 100, 0.1, 0.5)) / 1e4**(2 / 3)  # in L/V
        self.assertAlmostEqual(steps, 8e5, delta=1.0)  # (107)

    def test_foretold(self):
        self.assertAlmostEqual(relaxation_map.foretold("blankenbach_1a", relaxation_map.STEADY, 1.0, 4.0)["nusselt"], -0.00199, delta=5e-5)
        time, pressure, height = relaxation_map.law("blankenbach_1a")
        # Both parts of the time by hand: growth at s0, and the start's delay.
        s0, sooner = 1e4 / (4.0 * math.pi**2), 1.0 / 0.012975
        self.assertAlmostEqual(time * 1e4**(2 / 3) / ((s0 + sooner) / (2.0 * math.pi**2)), 1.0, delta=0.1)
        self.assertAlmostEqual(pressure * 1e4**(2 / 3) / (s0 + sooner), 1.0, delta=0.1)
        found = relaxation_map.foretold("blankenbach_1a", relaxation_map.WAY, 0.06, 0.5)
        self.assertLess(abs(found["overshoot"]), 2e-4)  # both cancel
        self.assertAlmostEqual(found["height"], height * 0.12**2, delta=1e-4)

    def test_a_swing_that_dies_is_taken_out(self):
        t = np.linspace(0.0, 1.0, 801)
        swing = 10.0 * np.exp(-3.0 * t) * np.cos(33.0 * t)
        self.assertAlmostEqual(relaxation_map.without_swings(t, 4.0 + swing), 4.0, delta=0.01)

    def test_first_maximum(self):
        t = np.linspace(0.0, 1.0, 400)
        np.testing.assert_allclose(relaxation_map.first_maximum(t, 1.0 - (t - 0.4321)**2), (0.4321, 1.0), rtol=1e-9)
        self.assertEqual(relaxation_map.first_maximum(t, t), (None, None))

    def test_page(self):
        runs = relaxation_map.plan(given(True), ROOT, None)
        self.assertLessEqual(sum(run.seconds for run in runs), 180.0)
        for run in relaxation_map.plan(given(False), ROOT, None):  # the program takes no zeta below 1
            self.assertGreaterEqual(float(next(s for s in run.settings if "zeta" in s).partition("=")[2]), 1.0)
        t = np.linspace(0.0, 2e16, 300)
        late = {0.25: 1.0, 0.5: 1.005, 1.0: 1.1}
        outcomes = []
        for run in runs:
            aim, _, phi_xi = run.variant.split(", ")
            peak = 0.01e18 * late.get(float(phi_xi), 1.0)
            columns = {"time": t, "nusselt_volume": 4.8 + 0 * t, "v_rms": 50.0 * late.get(float(phi_xi), 1.0) - 20.0 * ((t - peak) / 1e16)**2}
            outcomes.append(self.outcome(run, None if run.variant == f"{relaxation_map.WAY}, 0.24, 1" else columns))
        found = {(each.one["aim"], each.one["phi_zeta"], each.one["phi_xi"]): each.measured for each in
                 relaxation_map.compared(self.measured(relaxation_map, outcomes)["runs"])}
        base = relaxation_map.foretold("blankenbach_1a", relaxation_map.WAY, 0.015, 0.25)
        for name in ("overshoot", "height"):
            self.assertAlmostEqual(found[relaxation_map.WAY, 0.1, 0.5][name], 1.005 * (1.0 + base[name]) - 1.0, delta=1e-4)
            self.assertIsNone(found[relaxation_map.WAY, 0.24, 1.0][name])
        with unittest.mock.patch.object(relaxation_map, "border_of_inertia", lambda *_: 4.0):  # eight steady solutions
            page, lines = self.page(relaxation_map, outcomes)
        self.assertEqual(page.count("data:image/png"), 1)
        self.assertEqual(len(lines), 1 + len(runs))


class SlidesConvection(Written):
    def test_measures_by_hand_of_the_exact_flow(self):
        flow = slides_convection.exact(1e4, 1.0)
        found = slides_convection.by_hand(slides_convection.flow_bands(flow, 50), 50)
        right = ("wall to first row, Δx/2", "first to second row, Δx", "1 + ⟨v T⟩, all")
        wrong = ("wall to second row, taken as Δx", "1 + ⟨v T⟩, at mid-height")
        for name in right:
            self.assertAlmostEqual(found[name] / 2.164753, 1.0, delta=1e-3)
        for name in wrong:
            self.assertAlmostEqual(found[name], 3.2, delta=0.1)

    def test_the_prandtl_number_makes_the_speeds(self):
        causes = {name: values for name, *values in itertools.islice(slides_convection.causes(), 2)}
        printed = [tuple(round(speed, 3) for speed in values[1:]) for values in causes.values()]
        self.assertEqual(printed, [(0.018, 0.019), (0.022, 0.022)])
        self.assertEqual(slides_convection.fits(3.24, 0.0182, 0.0190), (True, True))
        self.assertEqual(slides_convection.fits(2.16, 0.0215, 0.0225), (False, False))

    def test_page(self):
        runs = slides_convection.plan(given(True), ROOT, None)
        self.assertLessEqual(sum(run.seconds for run in runs), 180.0)
        t = np.linspace(0.0, 300.0, 50)
        made = [self.outcome(run, {"time": t, "nusselt_volume": 2.16 + 0 * t, "u_max": 21.0 + 0 * t, "v_max": 22.0 + 0 * t}) for run in runs]
        with unittest.mock.patch.object(slides_convection, "causes", lambda: [("one", 2.0, 0.018, 0.019)]):
            page, lines = self.page(slides_convection, made)
        self.assertEqual(page.count("data:image/png"), 1)
        self.assertIn("3.245", page)
        self.assertIn(f"{21.0 * slides_convection.SPEED:.4f}", lines[1])


if __name__ == "__main__":
    unittest.main()
