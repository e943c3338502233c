"""One program for two generations of processors: the launcher's choice, and that both compute the same."""

import os
import pathlib
import unittest

from running import FILE_FAILED, PROGRAMS, Case

BUILT = {kind: PROGRAMS / kind / "disph_c" for kind in ("avx2", "avx512") if (PROGRAMS / kind / "disph_c").exists()}
CPU = pathlib.Path("/proc/cpuinfo").read_text()
HAS_AVX512 = all(f" {flag}" in CPU for flag in ("avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"))

# Iron, so that the equation of state's exponentials and logarithms are in it too.
CASE = ("hydrostatic_13", {"time.steps": 40, "time.dt": 0.05, "output.interval": 0})


@unittest.skipUnless(BUILT, "built for one processor alone")
class Simd(Case):
    def lanes(self, wanted):
        if wanted:
            os.environ["TETSUAME_SIMD"] = wanted
            self.addCleanup(os.environ.pop, "TETSUAME_SIMD", None)
        summary = self.run_program(self.launcher_with(*BUILT), *CASE, output=f"run_{wanted}").summary
        os.environ.pop("TETSUAME_SIMD", None)
        return summary

    @unittest.skipUnless(len(BUILT) == 2, "one kind built: ./run build --portable makes both")
    def test_the_launcher_takes_what_the_processor_has(self):
        self.assertEqual(self.lanes(None)["simd_lanes"], 8 if HAS_AVX512 else 4)
        self.assertEqual(self.lanes("avx2")["simd_lanes"], 4)

    @unittest.skipUnless(HAS_AVX512 and len(BUILT) == 2, "not both kinds built, or no AVX-512 here")
    def test_both_compute_the_same(self):
        wide, narrow = self.lanes(None), self.lanes("avx2")
        self.assertEqual(wide["rhs_evaluations"], narrow["rhs_evaluations"])
        for name, value in narrow["errors"].items():
            # Sums rounded in another order: 1e-14 in a force, which 40 steps of a quiet column do not blow up.
            self.assertAlmostEqual(wide["errors"][name], value, delta=1e-9 * max(abs(value), 1e-3), msg=name)

    def launcher_with(self, *kinds):
        """A copy of the launcher with the programs of these kinds alone."""
        here = self.here / "_".join(("with", *kinds))
        for kind in ("", *kinds):
            (here / kind).mkdir(parents=True, exist_ok=True)
            copy = here / kind / "disph_c"
            # For AVX-512 where the processor lacks it: any, as it does not start.
            copy.write_bytes((BUILT.get(kind, next(iter(BUILT.values()))) if kind else PROGRAMS / "disph_c").read_bytes())
            copy.chmod(0o755)
        return here / "disph_c"

    def test_the_launcher_takes_what_was_built(self):
        if "avx2" in BUILT:
            self.assertEqual(self.call(self.launcher_with("avx2"), "--version").status, 0)
        if HAS_AVX512 and "avx512" in BUILT:
            self.assertEqual(self.call(self.launcher_with("avx512"), "--version").status, 0)

    def test_what_is_missing_is_named_with_the_command_that_builds_it(self):
        self.assert_says(self.call(self.launcher_with(), "--version"), FILE_FAILED, "disph_c", "./run build")
        if HAS_AVX512:
            os.environ["TETSUAME_SIMD"] = "avx2"
            self.addCleanup(os.environ.pop, "TETSUAME_SIMD", None)
        self.assert_says(self.call(self.launcher_with("avx512"), "--version"), FILE_FAILED, "disph_c", "./run build --portable")


if __name__ == "__main__":
    unittest.main()
