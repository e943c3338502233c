"""Cuts between ranks that follow the cost: it evens out, every decision is told, and nobody's result changes."""

import csv
import shutil
import unittest

import running
from running import Case

# Walls below and above, whose markers make the outer two of four ranks dearer; they drag the fluid, so that lists
# are made anew.
SHEARED = ("hydrostatic_13_linear",
           {"domain.particles_x": 16, "domain.length_x": 80e3, "domain.particles_y": 96, "domain.length_y": 480e3,
            "time.dt": 0.2, "time.steps": 36, "expert.velocity_top": 2000, "expert.velocity_bottom": -2000,
            "material.viscosity": 2e11, "output.interval": 0, "domain.ranks_x": 1, "walls.marker_radius": 3.0, "balancer.interval": 6})

# Slow enough for the first lists to last: cuts move under lists that stay.
SLOW = (SHEARED[0], {**SHEARED[1], "expert.velocity_top": 15, "expert.velocity_bottom": -15, "time.steps": 130, "domain.particles_y": 72, "domain.length_y": 360e3,
                     "balancer.interval": 15, "hosono.solver": "newton"})


class LoadBalance(Case):
    def run_case(self, case, balance, ranks, program="disph_c", settings=None, **how):
        name, common = case
        return self.run_program(program, name, {**common, "domain.balance": f"'{balance}'", **(settings or {})}, ranks=ranks, **how)

    def decisions(self, result):
        with open(result.directory / "balance.csv", newline="") as file:
            return list(csv.DictReader(file))

    def assert_told(self, result):
        """What the table, the summary and the log say is the same."""
        rows, metrics = self.decisions(result), result.summary["metrics"]
        self.assertEqual(metrics["balance_decisions"], len(rows))
        moved = [row for row in rows if row["moved [1]"] == "1"]
        self.assertEqual(metrics["balance_moves"], len(moved))
        self.assertAlmostEqual(metrics["balance_gain_predicted"] / sum(float(row["gain [s or pairs]"]) for row in moved), 1)
        log = (result.directory / "run.log").read_text()
        for row in rows:
            self.assertIn(f"step {row['step [1]']}: spread", log)
            self.assertIn(row["reason [text]"], log)
            self.assertEqual(row["reason [text]"].endswith(": move"), row["moved [1]"] == "1")
            self.assertEqual(float(row["migrated [1]"]) > 0, row["moved [1]"] == "1")
            if row["moved [1]"] == "1":
                self.assertGreater(float(row["gain [s or pairs]"]), float(row["cost [s or pairs]"]))

    def spreads(self, result):
        return [float(row["spread [1]"]) for row in self.decisions(result)]

    def test_counted_evens_out(self):
        alone = self.run_case(SHEARED, "off", None)
        fixed = self.run_case(SHEARED, "off", 4)
        self.assertEqual(fixed.summary["state_hash"], alone.summary["state_hash"])
        self.assertFalse((fixed.directory / "balance.csv").exists())
        moved = self.run_case(SHEARED, "counted", 4)
        self.assertEqual(moved.summary["state_hash"], alone.summary["state_hash"])
        self.assert_told(moved)
        spreads = self.spreads(moved)
        self.assertGreater(spreads[0], 0.2)
        self.assertLess(spreads[-1], 0.5 * spreads[0])  # a row of the lattice is 0.04 of a rank, 0.08 of the spread
        # Counted, not measured: the same decisions in every run.
        again = self.run_case(SHEARED, "counted", 4)
        self.assertEqual((again.directory / "balance.csv").read_text(), (moved.directory / "balance.csv").read_text())

    def test_cuts_move_under_lists_that_stay(self):
        for program in ["disph_c", "disph_a"] if running.SLOW else ["disph_c"]:
            with self.subTest(program):
                alone, fixed = (self.run_case(SLOW, "off", ranks, program) for ranks in (None, 3))
                self.assertEqual(fixed.summary["rhs_evaluations"], 131, "new lists: the case is not what it should be")
                moved = self.run_case(SLOW, "counted", 3, program)
                self.assert_told(moved)
                self.assertEqual(moved.summary["state_hash"], alone.summary["state_hash"])
                self.assertEqual(moved.summary["errors"], alone.summary["errors"])
                self.assertLess(self.spreads(moved)[-1], 0.5 * self.spreads(moved)[0])
                # The rate of a state that changes hands is found again, with the same bits.
                self.assertEqual(moved.summary["rhs_evaluations"] - fixed.summary["rhs_evaluations"],
                                 moved.summary["metrics"]["balance_moves"])

    def test_adaptive(self):
        settings = {"time.method": "'adaptive'", "time.rtol": 1e-3, "time.steps": 24}
        hashes = [self.run_case(SHEARED, balance, ranks, settings=settings).summary for balance, ranks in [("off", None), ("counted", 4)]]
        self.assertEqual(hashes[1]["state_hash"], hashes[0]["state_hash"])
        self.assertGreater(hashes[1]["metrics"]["balance_moves"], 0)

    def test_restart(self):
        """Cuts begin anew; other ranks, another mode: the same bits."""
        whole = self.run_case(SHEARED, "counted", 4)
        # 17: between two new lists
        part = self.run_case(SHEARED, "counted", 4, settings={"time.steps": 17, "run.checkpoint_interval": 17}, output="part")
        for n, (balance, ranks) in enumerate([("counted", 4), ("counted", 2), ("off", 3), ("measured", 3)]):
            with self.subTest(balance=balance, ranks=ranks):
                shutil.copytree(part.directory, self.here / f"part_{n}")
                again = self.run_case(SHEARED, balance, ranks, settings={"balancer.relaxation": 0.9}, output=f"part_{n}",
                                      options=["--restart", "latest"])
                self.assertEqual(again.summary["state_hash"], whole.summary["state_hash"])
                steps = [int(row["step [1]"]) for row in self.decisions(again)]
                self.assertEqual(steps, sorted(set(steps)))


if __name__ == "__main__":
    unittest.main()
