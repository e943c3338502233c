"""balance at its limits: few particles, no cost, and mistakes in the input or on the command line."""

import unittest

from running import BAD_INPUT, COMPLETED, FILE_FAILED, ZOLTAN
from test_balance import BOWL, FEW, Runs


class Usage(Runs):
    def test_extremes(self):
        small = {**FEW, "distribution.particles": 500}
        for ranks in (1, 7, 997):
            with self.subTest(ranks=ranks):
                found = self.balance(settings={**small, "compare.methods": "'rcb','hsfc'" if ZOLTAN else "none"}, ranks=ranks).summary["metrics"]
                self.assertLessEqual(found["run_time_balanced"], 1.02 * found["run_time_equal_counts"])
        zero = {f"cost.{key}": 0 for key in ("fluid", "wall", "marker", "metal", "halo", "latency")}
        found = self.balance(settings={**small, **zero}, ranks=12).summary["metrics"]
        self.assertEqual((found["spread_initial"], found["spread_final"], found["updates"]), (0, 0, 0))

    def test_refused(self):
        for words, says in [(["--ranks", "0"], "ranks"), (["--ranks", "x"], "ranks"),
                            (["--set", "machine.ranks_x=5"], "ranks_x"), (["--set", "compare.methods=metis"], "metis"),
                            (["--set", "distribution.kind=snapshot"], "file"),
                            (["--set", "distribution.bowl_bottom=0.9"], "bowl_bottom")]:
            with self.subTest(words=words):
                self.assert_says(self.call("balance", BOWL, *words, "--output", "out"), BAD_INPUT, "balance", says)
        self.assert_says(self.call("balance", BOWL, "--set", "distribution.kind=snapshot", "--set",
                                   "distribution.file=none.h5", "--output", "out"), FILE_FAILED, "none.h5")
        self.assert_says(self.call("balance", BOWL, "--restart", "latest"), BAD_INPUT, "--restart")
        self.assertEqual(self.listing(), {})

    def test_partitioners_are_those_it_is_built_with(self):
        described, checked = self.call("balance", "--describe"), self.call("balance", BOWL, "--check")
        self.assertEqual("'rcb'" in described.stdout, ZOLTAN)
        if ZOLTAN:
            self.assertEqual(checked.status, COMPLETED, checked)
        else:
            self.assert_says(checked, BAD_INPUT, "balance_bowl.nml:39: &compare methods", "built without Zoltan")
            self.assertEqual(self.call("balance", BOWL, "--check", "--set", "compare.methods=none").status, COMPLETED)

    def test_describe_is_an_input(self):
        described = self.call("balance", "--describe")
        (self.here / "in.nml").write_text(described.stdout)
        self.assertEqual(self.call("balance", "in.nml", "--check").status, 0)


if __name__ == "__main__":
    unittest.main()
