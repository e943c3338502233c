"""The package's command line, and what all reports share: files read, parts of pages."""
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from tetsuame import pages, reading

SOURCES = Path(__file__).resolve().parents[2] / "programs/python"


def call(*arguments):
    return subprocess.run([sys.executable, "-m", "tetsuame", *arguments], capture_output=True, text=True,
                          env=os.environ | {"PYTHONPATH": str(SOURCES)})


class Commands(unittest.TestCase):
    def test_help_names_each_command_and_each_has_its_own(self):
        said = call("--help")
        self.assertEqual(said.returncode, 0, said.stderr)
        for command, option in (("compare", "--programs"), ("bench", "folder"), ("balance", "folder"), ("scaling", "--ranks"), ("plot", "--fields"), ("movie", "--gif"), ("view", "--megabytes"),
                                ("paraview", "--field"), ("sweep", "--set")):
            with self.subTest(command):
                self.assertRegex(said.stdout, rf"(?m)^  {command} ")
                own = call(command, "--help")
                self.assertEqual(own.returncode, 0, own.stderr)
                self.assertIn(option, own.stdout)

    def test_unknown_command_is_refused_in_a_sentence(self):
        said = call("contrast", "--programs", "A")
        self.assertEqual((said.returncode, said.stdout), (2, ""))
        self.assertEqual(said.stderr, "tetsuame: no command 'contrast' (there are compare, bench, balance, scaling, plot, movie, view, paraview, sweep)\n")

    def test_no_command(self):
        said = call()
        self.assertEqual(said.returncode, 2)
        self.assertIn("COMMAND", said.stderr)

    def test_pip_installs_it_without_a_network(self):
        with tempfile.TemporaryDirectory() as scratch:
            made = subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", scratch], capture_output=True, text=True)
            if made.returncode:
                self.skipTest("no python3-venv")
            said = subprocess.run([f"{scratch}/bin/pip", "install", "--no-index", "--quiet", str(SOURCES)], capture_output=True, text=True)
            self.assertEqual(said.returncode, 0, said.stderr)
            said = subprocess.run([f"{scratch}/bin/tetsuame", "view", "/nowhere"], capture_output=True, text=True, cwd=scratch)
            self.assertEqual((said.returncode, said.stderr), (2, "tetsuame view: /nowhere: no such directory\n"))


class Reading(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.file = Path(scratch.name) / "file"

    def test_columns_lose_their_units_and_a_line_cut_short(self):
        self.file.write_text("step [1],time [s]\n0,0.5\n1,1.5\n2")
        columns = reading.read_columns(self.file)
        self.assertEqual({name: list(values) for name, values in columns.items()}, {"step": [0.0, 1.0], "time": [0.5, 1.5]})

    def test_columns_of_a_file_without_a_whole_line(self):
        for text in ("", "step [1],time [s]\n", "step [1],time [s]\n1"):
            with self.subTest(text):
                self.file.write_text(text)
                self.assertEqual(reading.read_columns(self.file), {})

    def test_json_that_is_absent_or_none_names_who_writes_it(self):
        with self.assertRaisesRegex(reading.Unreadable, "file: No such file or directory; run bench first"):
            reading.read_json(self.file, "bench")
        self.file.write_text("{")
        with self.assertRaisesRegex(reading.Unreadable, "not the JSON that bench writes"):
            reading.read_json(self.file, "bench")


class Pages(unittest.TestCase):
    def test_text_is_shown_as_it_is(self):
        made = pages.text_table(["name", "a < b"], [["<b>", "1"]], 1)
        self.assertIn("<tr><td>&lt;b&gt;</td><td class=\"number\">1</td></tr>", made)
        self.assertIn("<th class=\"number\">a &lt; b</th>", made)

    def test_empty_parts_are_left_out(self):
        self.assertIn("<body>\n<p>a</p>\n<p>b</p>\n</body>", pages.document("x", ["<p>a</p>", "", "<p>b</p>"]))


if __name__ == "__main__":
    unittest.main()
