"""compare, run as a user runs it, on programs that only pretend to calculate."""
import csv
import os
import re
import subprocess
import sys
import tempfile
import unittest
from html.parser import HTMLParser
from pathlib import Path

import inside

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]


class Folders:
    """A folder with the programs, and what is made of their runs."""

    def prepare(self, folder):
        self.output, self.binaries = Path(folder) / "compare", Path(folder) / "programs"
        self.binaries.mkdir()
        for letter in "abcdef":
            program = self.binaries / f"disph_{letter}"
            program.write_bytes((HERE / "fake_program.py").read_bytes())
            program.chmod(0o755)

    def run_compare(self, *arguments, fault="", place="2,2"):
        command = [sys.executable, "-m", "tetsuame", "compare", "--binaries", self.binaries, "--output", self.output, *arguments]
        environment = os.environ | {"PYTHONPATH": str(ROOT / "programs/python"), "FAKE_FAULT": fault, "FAKE_PLACE": place}
        return subprocess.run(command, capture_output=True, text=True, env=environment, cwd=ROOT)

    def rows(self):
        with open(self.output / "table.csv", newline="") as file:
            return {(row["file"], row["program"], row["variant"]): row for row in csv.DictReader(file)}

    def page(self):
        return (self.output / "report.html").read_text()



class AllOfThem(Folders, unittest.TestCase):
    """One comparison, looked at by all tests."""

    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.prepare(cls, scratch.name)
        cls.done = cls.run_compare(cls, "--inputs", "12,column")

    def test_table_holds_what_the_programs_measured(self):
        done = self.done
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = self.rows()
        self.assertEqual(len(rows), 6 + 4 + 4 + 6 + 4)  # C to F adaptive; the cures of A and B run on 12, not on the column
        diverged = rows["12", "A", ""]
        self.assertEqual((diverged["outcome"], diverged["step"], diverged["iteration"]), ("diverged", "2", "2"))
        self.assertIn("particle 7", diverged["reason"])
        self.assertEqual(diverged["pressure_error_mean"], "")  # of a state on its way out
        self.assertEqual((diverged["note"], diverged["agrees"], diverged["agrees_in_place"]),
                         ("diverges, step 2, iteration 2", "yes", "yes"))
        self.assertNotIn("Not the note's", self.page())
        self.assertEqual(float(rows["12", "A", "newton"]["pressure_error_mean"]), 4.7e-4)
        self.assertEqual(float(rows["column", "E", ""]["pressure_error_mean"]), 4.9e-5)
        self.assertEqual(rows["column", "E", ""]["agrees"], "")  # the note has no column
        share, cost = (float(rows["12", "C", ""][key]) for key in ("wall_correction_share", "seconds_per_step"))
        self.assertAlmostEqual(share, 0.2 / 1.21)
        self.assertAlmostEqual(cost, 1.21 / 1000)
        self.assertRegex(done.stdout, r"(?m)^A +diverged 2/2 +diverged 2/2$")
        self.assertRegex(done.stdout, r"(?m)^C +5\.6e-05 +4\.4e-05$")
        self.assertIn("file 12: F &gt; C = E &gt; D", self.page())
        self.assertIn("file column: F &gt; C &gt; E &gt; D", self.page())

    def test_errors_are_coloured_by_their_size(self):
        page = self.page()
        for text, shade in (("5.6e-05", 3), ("4.9e-02", 5), ("0", 0)):
            self.assertIn(f'<td class="number e{shade}">{text}</td>', page)
        self.assertIn('<span class="step e0">', page)

    def test_page_needs_nothing_else(self):
        page = self.page()
        self.assertEqual(re.findall(r'(?:src|href)\s*=\s*"(?!data:)[^"]*"|url\(|<script|<link|@import|https?://', page), [])
        # one figure each of residuals, pressure, displacements on each file, cost
        self.assertEqual(page.count("data:image/png;base64,iVBOR"), 5)
        balance = Balance()
        balance.feed(page)
        self.assertEqual((balance.open, balance.wrong), ([], []))
        for name in ("residual", "pressure", "displacement_12", "displacement_column", "cost"):
            self.assertGreater((self.output / f"{name}.png").stat().st_size, 10000)


class Compare(Folders, unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.prepare(scratch.name)

    def calls(self, run):
        return len((self.output / "runs" / Path(run).parent / f"calls_{Path(run).name}").read_text())

    def test_what_has_no_solution_has_not_diverged(self):
        done = self.run_compare("--programs", "A", "--inputs", "11")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"(?m)^A +diverged 2/2$")
        self.assertRegex(done.stdout, r"(?m)^A \(newton\) +no solution$")
        row = self.rows()["11", "A", "newton"]
        self.assertEqual((row["outcome"], row["step"], row["iteration"]), ("diverged", "1", "0"))
        page = self.page()
        self.assertIn('<td class="number stop">no solution</td>', page)
        self.assertNotIn("diverged 1", page)

    def test_divergence_is_a_result_and_a_crash_is_not(self):
        said = {"B": ("exit4", "exit 4: disk full"), "C": ("abort", "killed by SIGABRT"), "D": ("no_summary", "exit 0, but left no summary.json"),
                "E": ("bad_json", "exit 3, but left a summary.json that is no JSON"),
                "F": ("contradiction", "exit 0, but summary.json says 'diverged'")}
        done = self.run_compare("--inputs", "12", fault=" ".join(f"disph_{letter.lower()}:{kind}" for letter, (kind, _) in said.items()))
        self.assertEqual(done.returncode, 1)
        rows, page = self.rows(), self.page()
        for letter, (kind, reason) in said.items():
            with self.subTest(kind):
                self.assertIn(f"CRASHED: {letter} on file 12: {reason}", done.stdout)
                row = rows["12", letter, ""]
                self.assertEqual((row["outcome"], row["reason"], row["agrees"]), ("crashed", reason, "no"))
                self.assertRegex(page, rf'<p class="bad">Crashed: {letter} on file 12')
        self.assertEqual(rows["12", "A", ""]["outcome"], "diverged")
        # Without the fault, which is not in the fingerprint, it is run again.
        self.assertEqual(self.run_compare("--programs", "A,C", "--inputs", "12").returncode, 0)

    def test_a_missing_program_is_a_crash(self):
        (self.binaries / "disph_f").unlink()
        done = self.run_compare("--programs", "F", "--inputs", "13")
        self.assertEqual(done.returncode, 1)
        self.assertIn("disph_f is not there", done.stdout)

    def test_departure_from_the_note_is_said_but_no_failure(self):
        done = self.run_compare("--programs", "A", "--inputs", "12", "--set", "hosono.solver=newton")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("Not as in the note: A on file 12: completed; the note: diverges, step 2, iteration 2", done.stdout)
        self.assertEqual(len(self.rows()), 1)  # the user chose the solver: no other is run beside it

    def test_the_same_outcome_elsewhere_is_said_with_its_reason(self):
        done = self.run_compare("--programs", "A,C", "--inputs", "12", "--set", "time.dt=2e-5", place="1,16")
        self.assertEqual(done.returncode, 0, done.stderr)
        row = self.rows()["12", "A", ""]
        self.assertEqual((row["agrees"], row["agrees_in_place"]), ("yes", "no"))
        self.assertEqual(self.rows()["12", "C", ""]["agrees_in_place"], "")  # it completes, here and there
        self.assertIn("Not where the note has it: A on file 12: diverged, step 1, iteration 16; the note: "
                      "diverges, step 2, iteration 2", done.stdout)
        page = self.page()
        self.assertIn("<td>plain, 1.0e-12</td>", page)
        self.assertIn("A on file 12: step 1, iteration 16; the note: diverges, step 2, iteration 2; the residual of the last one "
                      "grew from 1.0e-07 in", page)
        self.assertIn("C on file 12: &amp;time dt = 2e-05, the note: 1e-5", page)

    def test_messages_cannot_break_the_page(self):
        done = self.run_compare("--programs", "C", "--inputs", "13", "--set", "output.note=<b>&")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("output.note=&lt;b&gt;&amp;", self.page())
        self.assertNotIn("<b>&", self.page())

    def test_second_call_does_no_work_again(self):
        arguments = ("--programs", "C,D", "--inputs", "13_linear")
        self.run_compare(*arguments)
        written = (self.output / "report.html").stat().st_mtime_ns
        again = self.run_compare(*arguments)
        self.assertEqual((again.returncode, self.calls("13_linear/disph_c")), (0, 1))
        self.assertEqual((self.output / "report.html").stat().st_mtime_ns, written)
        self.assertIn("Nothing has changed", again.stdout)
        self.assertIn("5.6e-05", again.stdout)

        self.run_compare(*arguments, "--set", "time.steps=5")
        self.assertEqual(self.calls("13_linear/disph_c"), 2)
        with open(self.binaries / "disph_c", "a") as program:
            program.write("# rebuilt\n")
        self.run_compare(*arguments, "--set", "time.steps=5")
        self.assertEqual((self.calls("13_linear/disph_c"), self.calls("13_linear/disph_d")), (3, 2))
        self.run_compare(*arguments, "--set", "time.steps=5", "--fresh")
        self.assertEqual(self.calls("13_linear/disph_d"), 3)

    def test_usage_errors_run_nothing(self):
        for arguments, word in ((("--programs", "A,G"), "no program 'G'"), (("--inputs", "14"), "'14' is neither"),
                                (("--set", "steps=3"), "group.key=value"), (("--jobs", "0"), "--jobs"),
                                (("--programs", ","), "nothing to run")):
            with self.subTest(word):
                done = inside.call("compare", "--binaries", self.binaries, "--output", self.output, *arguments)
                self.assertEqual(done.returncode, 2)
                self.assertIn(word, done.stderr)
        self.assertFalse(self.output.exists())


class Balance(HTMLParser):
    """Tags left open or closed out of turn."""

    def __init__(self):
        super().__init__()
        self.open, self.wrong = [], []

    def handle_starttag(self, tag, attributes):
        if tag not in ("meta", "img"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.wrong.append(tag)


if __name__ == "__main__":
    unittest.main()
