"""A program without particles (tests/run/heat_on_a_grid.cpp) has the time loop's command line, files, restarts and reports."""

import unittest

import h5py
import numpy

from running import BAD_INPUT, COMPLETED, PROGRAMS, Case

ROD = PROGRAMS.parent / "tests" / "heat_on_a_grid"
INPUT = "&rod cells = 40 /\n&time t_end = 5.0 /\n&output interval = 2.5 history_interval = 5 /\n"


class OnAGrid(Case):
    def rod(self, output, *words, ranks=1, expect=COMPLETED):
        (self.here / "rod.nml").write_text(INPUT)
        return self.run_program(ROD, self.here / "rod.nml", dict(word.split("=") for word in words), output, ranks=ranks, expect=expect)

    def test_decays_with_second_order(self):
        errors = {n: abs(self.rod(f"n_{n}", f"rod.cells={n}", "time.method=rk4").summary["metrics"]["temperature_error"]) for n in (20, 40)}
        self.assertLess(errors[40], 1e-3)
        self.assertGreater(errors[20] / errors[40], 3.5)

    def test_ranks_and_restarts(self):
        whole = self.rod("whole")
        hashes = {whole.summary["state_hash"]}
        for ranks in (2, 3):
            hashes.add(self.rod(f"ranks_{ranks}", ranks=ranks).summary["state_hash"])
        self.rod("part", "time.steps=11", ranks=2)
        again = self.run_program(ROD, self.here / "rod.nml", {}, "part", ["--restart", "latest"], ranks=3)
        hashes.add(again.summary["state_hash"])
        self.assertEqual(len(hashes), 1, hashes)
        self.assertEqual(again.rows()[1][-1][1:], whole.rows()[1][-1][1:])

    def test_what_others_read(self):
        run = self.rod("out")
        files = sorted(run.directory.glob("snapshot_*.h5"))
        self.assertEqual(len(files), 3)
        with h5py.File(files[0]) as file:
            x, T = file["PartType0/Coordinates"][:, 0], file["PartType0/Temperature"][...]
            numpy.testing.assert_allclose(T[numpy.argsort(x)], numpy.sin(numpy.pi * numpy.sort(x)), atol=1e-12)
        self.rod("bad", "rod.cells=1", expect=BAD_INPUT)
        self.assertIn("steps", self.call(ROD, self.here / "rod.nml", "--plan").stdout)


if __name__ == "__main__":
    unittest.main()
