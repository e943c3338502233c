"""Every shipped input in every program, with few particles and steps: it completes, or is refused in one sentence before the
first step, or fails in a way that is known."""

import concurrent.futures
import math
import re
import subprocess
import unittest

from running import ALL, BAD_INPUT, CALCULATION_FAILED, COMPLETED, INPUTS, SLOW, Case

PROGRAMS = [*ALL, "disph_f2", "disph_n", "disph_y", "ssph", "rti", "drop", "conduction", "convection", "flow", "shock", "planet", "granular"]
MOST = {True: 10, False: 24}  # particles along an axis, in three dimensions and in fewer
STEPS = 100 if SLOW else 3
OF_LIQUIDS = ("a liquid's", "rti", "drop")  # whose inputs all programs for liquids read
NOT_LIQUIDS = ("conduction", "convection", "flow", "shock", "planet", "granular")

# How a calculation is known to fail: programs, inputs, message. The plain iteration of A and B cannot converge for a liquid,
# nor Newton's method where there is no state with p > 0 (docs/theory/hosono_iteration.md). B and D have nothing behind their
# walls, and SSPH smears the density over a contact: the rows beside these are torn away; and Y = p dV has no meaning where
# the pressure falls below 0 (docs/studies/2026-11-22_schemes_on_the_same_layers.md).
LAYERS = "rti_.*|drop_.*|partitioning|contact|pond_on_mantle|diapir_star|three_layers|three_materials"
KNOWN = [("disph_[ab]", r"hydrostatic_.*|slides_by_program", r"Hosono's iteration \(plain\) diverged"),
         ("disph_[ab]", LAYERS, r"Hosono's iteration \(newton\)"),
         ("disph_[bd]|ssph", LAYERS, r"particles moved .* within one step"),
         ("disph_[a-fy]2?", LAYERS, r"is not positive and finite")]


def particles(path):
    """The settings that leave an input at most so many particles along an axis, in the same proportions."""
    if "&planet" in path.read_text():
        return {"planet.particles": 500, "expert.settle": 0}
    found = {name: int(n) for line in path.read_text().splitlines() for name, n in re.findall(r"\b(particles_[xyz])\s*=\s*(\d+)", line.split("!")[0])}
    most = MOST["particles_z" in found]
    if max(found.values(), default=0) <= most:
        return {}
    divisor = math.gcd(*found.values())
    unit = {name: n // divisor for name, n in found.items()}
    times = max(1, most // max(unit.values()))
    return {f"domain.{name}": n * times for name, n in unit.items()}


class AllInputs(Case):
    def one(self, program, path):
        """What is wrong with its end, or an empty text."""
        directory = self.here / f"{program}_{path.stem}"
        settings = {**particles(path), "time.steps": STEPS, "output.interval": 0}
        try:
            result = self.call(program, *self.arguments(path, settings, directory), directory=directory)
        except subprocess.TimeoutExpired as late:
            return f"no end within {late.timeout:g} s"
        said = result.stderr.strip().splitlines()[-1] if result.stderr.strip() else ""
        if result.status == COMPLETED:
            return "" if result.summary["status"] in ("completed", "completed_doubtful") else f"status {result.summary['status']}"
        if result.status == BAD_INPUT:
            one = [line for line in result.stderr.splitlines() if line.startswith(f"{program}: ") and ": warning" not in line]
            return "" if len(one) == 1 and not directory.exists() else f"refused in {len(one)} lines, or something was written: {said}"
        if result.status == CALCULATION_FAILED and any(
                re.fullmatch(programs, program) and re.fullmatch(inputs, path.stem) and re.search(message, said) for programs, inputs, message in KNOWN):
            return ""
        return f"exit {result.status}: {said}"

    def test_check_prints_what_a_run_uses(self):
        """Each input by the program of its groups: what --check prints, values that follow from others too, is what a run resolves."""
        for path in sorted(INPUTS.glob("*.nml")):
            if path.name.startswith("balance_"):
                continue
            with self.subTest(path.name):
                groups = re.findall(r"^\s*&(\w+)", path.read_text(), re.M)
                program = next((g for g in groups if g in PROGRAMS), "disph_c")
                program = "disph_c" if path.stem == "contact" else program
                settings = {**particles(path), "time.steps": 1, "output.interval": 0}
                words = [word for key, value in settings.items() for word in ("--set", f"{key}={value}")]
                checked = self.call(program, path, *words, "--check")
                if checked.status == BAD_INPUT:  # too few particles for a body
                    continue
                run = self.run_program(program, path, settings, path.stem)
                self.assertEqual(self.assignments(checked.stdout), self.assignments((run.directory / "resolved.nml").read_text()))

    def test_derived_values_are_checked(self):
        """A Rayleigh number takes the place of the expansivity."""
        said = self.call("convection", INPUTS / "blankenbach_1a.nml", "--set", "convection.rayleigh=10", "--check").stdout
        self.assertEqual(float(dict(self.assignments(said))["expansivity"]), 2.5e-8)

    @staticmethod
    def assignments(resolved):
        lines = (line.split("!")[0].partition("=") for line in resolved.splitlines())
        # A run names its own copies of files.
        return [(key.strip(), re.sub(r"'[^']*/|'input_", "'", value.strip())) for key, sign, value in lines if sign]

    def test_all(self):
        """Unless what takes long is done too, of the inputs that are another program's one each, and of those of all programs for liquids every
        fourth by each, so that over four inputs each program has one."""
        cases, seen = [], set()
        for n, path in enumerate(sorted(INPUTS.glob("*.nml"))):
            groups = re.findall(r"^\s*&(\w+)", path.read_text(), re.M)
            owner = next((g for g in groups if g in PROGRAMS), "a liquid's")
            for k, program in enumerate(PROGRAMS):
                foreign = program != owner and (owner not in OF_LIQUIDS or program in NOT_LIQUIDS)
                by_turns = program == owner or owner not in OF_LIQUIDS or (n + k) % 4 == 0
                if SLOW or (not foreign and by_turns) or (foreign and (program, owner) not in seen):
                    cases.append((program, path))
                seen.add((program, owner))
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            ends = list(pool.map(lambda case: self.one(*case), cases))
        wrong = [f"{program} {path.name}: {end}" for (program, path), end in zip(cases, ends) if end]
        self.assertEqual(wrong, [], "\n" + "\n".join(wrong))


if __name__ == "__main__":
    unittest.main()
