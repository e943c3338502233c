"""Carries out the recipe "A new pressure gradient" of docs/add_a_variant.md as it stands there, in a copy of the sources: its
files, its lines for CMake, its run and its test. The library is the one that is built already, which the recipe leaves alone."""

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


def recipe():
    """The section of the page, and its blocks: the file that the text before a block names last, its language, its content."""
    page = (SOURCE / "docs" / "add_a_variant.md").read_text()
    section = page.partition("\n## A new pressure gradient\n")[2].partition("\n## ")[0]
    blocks, before = [], 0
    for block in re.finditer(r"^```(\w*)\n(.*?)^```$", section, re.MULTILINE | re.DOTALL):
        named = re.findall(r"[`*]((?:modules|programs|tests)/[\w/]+\.\w+)[`*]", section[before:block.start()])
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

    def test_recipe(self):
        self.copy_sources()
        files, shell = [], []
        for name, language, content in recipe():
            if language == "cpp":
                self.assertFalse((self.here / name).exists(), f"{name} is there already")
                (self.here / name).write_text(content)
                files.append(name)
            elif language == "cmake":
                with open(self.here / name, "a") as file:
                    file.write(content)
            else:
                shell += content.splitlines()
        self.assertEqual(len(files), 3, "a module, a program, a test")
        self.configure()

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
