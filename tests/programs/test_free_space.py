"""A run without walls or periodic sides (tests/run/particles_in_free_space.cpp): all particles leave the box that they start in, one is far away."""

import unittest

from running import BAD_INPUT, PROGRAMS, Case

CLOUD = PROGRAMS.parent / "tests" / "particles_in_free_space"
INPUT = """
&domain jitter = 0.2 balance = 'counted' /
&cloud radii = 1e4 rate = 1 drift = 30 /
&kernel skin = 1 /
&expert balancer_interval = 4 /
&time dt = 0.03 steps = 80 /
&output history_interval = 20 /
"""
PARTICLES = 10308


class InFreeSpace(Case):
    def fly(self, output, *words, **how):
        how.setdefault("more", {"MALLOC_MMAP_THRESHOLD_": "131072"})  # resident is what is in use
        (self.here / "cloud.nml").write_text(INPUT)
        return self.run_program(CLOUD, self.here / "cloud.nml", dict(word.split("=") for word in words), output, **how)

    def test_ranks(self):
        runs = {ranks: self.fly(f"on_{ranks}", ranks=ranks) for ranks in (1, 2, 3, 4)}
        for ranks, run in runs.items():
            s = run.summary
            self.assertEqual(s["state_hash"], runs[1].summary["state_hash"], ranks)
            self.assertEqual(run.rows(), runs[1].rows(), ranks)
            self.assertLess(s["errors"]["sum"], 1e-12)
            self.assertEqual(s["metrics"]["particles"], PARTICLES)
            self.assertEqual(s["metrics"]["outside_of_the_box"], PARTICLES)
            self.assertGreater(s["metrics"]["lists_made"], 40)
            # Cuts follow the particles out of the box, and none of them the one that is far away.
            if ranks > 1:
                self.assertLess(s["metrics"]["most_on_a_rank"], 0.7 * PARTICLES)

    def test_restarts(self):
        whole = self.fly("whole")
        self.fly("part", "time.steps=41", ranks=2)
        again = self.fly("part", options=["--restart", "latest"], ranks=3)
        self.assertEqual(again.summary["state_hash"], whole.summary["state_hash"])
        self.assertEqual(again.rows()[1][-1], whole.rows()[1][-1])

    def test_memory_of_one_far_away(self):
        sides = [f"domain.{what}_{axis}=59" for what in ("length", "particles") for axis in "xyz"]
        bytes_of = {radii: self.fly(f"at_{radii:g}", *sides, f"cloud.radii={radii:g}", "cloud.compare=F", "time.steps=3").summary["metrics"]
                    for radii in (0.0, 1e4)}
        near, far = bytes_of.values()
        self.assertLess(far["resident_bytes"], 1.1 * near["resident_bytes"])
        self.assertEqual(far["needed_bytes"], near["needed_bytes"])
        # The libraries of a process take 40 MB beside what is counted.
        self.assertLess(far["resident_bytes"], far["needed_bytes"] + 60e6)
        self.assertGreater(far["resident_bytes"], 0.8 * far["needed_bytes"])

    def test_sides_that_are_one_are_not_open(self):
        run = self.fly("bad", "domain.periodic_x=T", expect=BAD_INPUT)
        self.assertIn("open_x", run.stderr)


if __name__ == "__main__":
    unittest.main()
