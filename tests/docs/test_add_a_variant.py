"""Carries out the recipes "A new pressure gradient" of docs/add_a_variant.md and "A dye in a uniform flow" of docs/add_a_problem.md
as they stand there, in a copy of the sources: their files, their lines for CMake, their runs and tests. The library is the one that
is built already, which the recipes leave alone."""

import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import tempfile
import unittest

SOURCE = pathlib.Path(os.environ["TETSUAME_SOURCE"]).resolve()
BUILD = pathlib.Path(os.environ["TETSUAME_BUILD"]).resolve()

# What decides how things are compiled.
CACHED = ["CMAKE_BUILD_TYPE", "CMAKE_CXX_COMPILER", "CMAKE_CXX_COMPILER_LAUNCHER", "TETSUAME_ARCH", "TETSUAME_AVX512", "TETSUAME_SANITIZE"]


def recipe(page, title):
    """A section of a page, in blocks: the file that the text before a block names last, its language, its content."""
    section = (SOURCE / "docs" / page).read_text().partition(f"\n## {title}\n")[2].partition("\n## ")[0]
    blocks, before = [], 0
    for block in re.finditer(r"^```(\w*)\n(.*?)^```$", section, re.MULTILINE | re.DOTALL):
        named = re.findall(r"[`*]((?:modules|programs|tests|inputs)/[\w/]+\.\w+)[`*]", section[before:block.start()])
        blocks.append((named[-1] if named else None, block[1], block[2]))
        before = block.end()
    return blocks


class AddAVariant(unittest.TestCase):
    def setUp(self):
        self.here = pathlib.Path(tempfile.mkdtemp(prefix="tetsuame_recipe_"))
        self.addCleanup(shutil.rmtree, self.here, ignore_errors=True)

    def run_in(self, folder, words, shell=False):
        done = subprocess.run(words, cwd=folder, shell=shell, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True)
        self.assertEqual(done.returncode, 0, f"{words}\n{done.stdout}")
        return done.stdout

    def copy_sources(self):
        listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "-z"], cwd=SOURCE, check=True, capture_output=True)
        for name in listed.stdout.decode().split("\0"):
            if name and (SOURCE / name).is_file():
                (self.here / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(SOURCE / name, self.here / name)

    def configure(self):
        cache = dict(re.findall(r"^(\w+):\w+=(.+)$", (BUILD / "CMakeCache.txt").read_text(), re.MULTILINE))
        self.run_in(self.here, ["cmake", "-G", "Ninja", "-B", "build", *(f"-D{name}={cache[name]}" for name in CACHED if name in cache)])
        for library in BUILD.rglob("*.a"):
            link = self.here / "build" / library.relative_to(BUILD)
            link.parent.mkdir(parents=True, exist_ok=True)
            link.symlink_to(library)

    def build(self, target, name):
        """What ninja would do for a target, but for what is not of it: the library, which stands."""
        commands = [line for line in self.run_in(self.here, ["ninja", "-C", "build", "-t", "commands", target]).splitlines()
                    if name in line]
        self.assertGreaterEqual(len(commands), 2, "a compilation and a link")
        for command in commands:
            self.run_in(self.here / "build", command, shell=True)

    def write(self, page, title):
        """The files of a recipe, and its commands."""
        files, shell = [], []
        for name, language, content in recipe(page, title):
            if language in ("cpp", "fortran"):
                self.assertFalse((self.here / name).exists(), f"{name} is there already")
                (self.here / name).write_text(content)
                files.append(name)
            elif language == "cmake":
                with open(self.here / name, "a") as file:
                    file.write(content)
            else:
                shell += content.splitlines()
        return files, shell

    def test_recipes(self):
        self.copy_sources()
        files, shell = self.write("add_a_variant.md", "A new pressure gradient")
        self.assertEqual(len(files), 3, "a module, a program, a test")
        problem, runs = self.write("add_a_problem.md", "A dye in a uniform flow")
        self.assertEqual(len(problem), 2, "a program, an input")
        self.configure()
        self.variant(files, shell)
        self.problem(pathlib.Path(problem[0]).stem, [line for line in runs if "build/programs/" in line])

    def problem(self, program, runs):
        self.build(program, program)
        self.assertEqual(len(runs), 2, "on one rank and on two")
        for line in runs:
            self.run_in(self.here, shlex.split(line))
        summaries = [json.loads((self.here / shlex.split(line)[-1] / "summary.json").read_text()) for line in runs]
        self.assertEqual(summaries[0]["state_hash"], summaries[1]["state_hash"])
        error = summaries[0]["metrics"]["concentration_error"]
        said = float(re.search(r"`concentration_error`, (-?[\d.]+) at", (SOURCE / "docs/add_a_problem.md").read_text())[1])
        self.assertAlmostEqual(error, said, delta=0.02 * abs(said))
        # The Gaussian is where it began, and 1/1.2 high, with a variance of 0.012 m2; a gauge adds the kernel's, 0.0003 m2, and so reads
        # 2.4 % less.
        histories = [(self.here / shlex.split(line)[-1] / "history.csv").read_text() for line in runs]
        self.assertEqual(histories[0], histories[1])
        names, *_, last = (line.split(",") for line in histories[0].splitlines())
        self.assertAlmostEqual(float(last[names.index("concentration_middle [1]")]), 1.0 / 1.2 * 0.012 / 0.0123, delta=0.01)

    def variant(self, files, shell):
        program, test = (pathlib.Path(name).stem for name in files[1:])
        self.build(program, program)
        line = next(command for text in shell for command in text.split(" && ") if command.startswith("build/programs/"))
        self.run_in(self.here, shlex.split(line) + ["--set", "time.steps=10"])
        summary = json.loads(next(self.here.glob("output/*/summary.json")).read_text())
        self.assertEqual((summary["program"], summary["status"], summary["steps"]), (program, "completed", 10))
        # Uniform pressure on the lattice: no force, so that nothing moves, and no smoothing, so that no error is there.
        self.assertLess(summary["errors"]["pressure_max"], 1e-12)

        self.assertTrue(any(f"-R {test}" in text for text in shell), "the page says how the test is run")
        self.build(f"test_{test}", test)
        said = self.run_in(self.here, ["ctest", "--test-dir", "build", "--no-tests=error", "--output-on-failure", "-R", test])
        self.assertIn("100% tests passed", said)


if __name__ == "__main__":
    unittest.main()
