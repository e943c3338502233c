"""Usage and input errors: exit 2 with file:line, the key and what was expected, and nothing written."""

import os
import pathlib
import pty
import re
import select
import shutil
import signal
import subprocess
import time
import unittest

from running import ALL, BAD_INPUT, COMPLETED, FILE_FAILED, INPUTS, PROGRAMS, Case

SHORT = {"time.steps": 3, "output.interval": 0}

BASE = """&domain
  length_x = 100.0e3
  length_y = 100.0e3
  particles_x = 20
  particles_y = 20
/
&time
  steps = 3
/
"""


class Refused(Case):
    """Each message is asked for its parts, not its wording; the directory must stay as it was."""

    def refuse(self, *arguments, says, status=BAD_INPUT, program="disph_c"):
        before = self.listing()
        result = self.call(program, *arguments)
        self.assert_says(result, status, program, *says)
        self.assertEqual(self.listing(), before, "something was written")
        return result

    def refuse_text(self, text, *says):
        (self.here / "in.nml").write_text(text)
        return self.refuse("in.nml", "--output", "out", says=says)

    def refuse_set(self, *settings, says, name="hydrostatic_13_linear"):
        changes = [word for setting in settings for word in ("--set", setting)]
        return self.refuse(INPUTS / f"{name}.nml", *changes, "--output", "out", says=says)

    # ---- the command line ----

    def test_no_arguments(self):
        self.refuse(says=["INPUT", "--help"])

    def test_unknown_option(self):
        self.refuse(INPUTS / "hydrostatic_12.nml", "--outptu", "x", says=["--outptu"])

    def test_second_input(self):
        self.refuse(INPUTS / "hydrostatic_12.nml", INPUTS / "hydrostatic_13.nml", says=["hydrostatic_13.nml"])

    def test_force_with_restart(self):
        self.refuse(INPUTS / "hydrostatic_12.nml", "--force", "--restart", "latest", says=["--force", "--restart"])

    def test_option_without_its_value(self):
        self.refuse(INPUTS / "hydrostatic_12.nml", "--output", says=["--output"])

    def test_missing_input(self):
        self.refuse("no_such.nml", "--output", "out", says=["no_such.nml", "path"])

    def test_directory_as_input(self):
        self.refuse(".", "--output", "out", says=["is a directory"])

    def test_empty_input(self):
        (self.here / "in.nml").write_text("")
        self.refuse("in.nml", "--output", "out", says=["in.nml", "empty"])

    def test_malformed_set(self):
        for setting in ["nonsense", "time=3", "time.steps", "=3", "time.steps=", ".steps=3"]:
            with self.subTest(setting):
                self.refuse_set(setting, says=["--set", setting])

    def test_unknown_set(self):
        self.refuse_set("time.stepz=3", says=["--set time.stepz=3", "unknown key", "steps"])
        self.refuse_set("tyme.steps=3", says=["--set tyme.steps=3", "unknown group", "&time"])

    def test_bad_value_by_set(self):
        self.refuse_set("time.dt=-1", says=["--set time.dt=-1", "&time dt", "s", "-1"])

    # ---- the input file ----

    def test_unknown_group(self):
        self.refuse_text(BASE + "&tyme\n  steps = 3\n/\n", "in.nml:10", "unknown group &tyme", "&time")

    def test_unknown_key(self):
        self.refuse_text(BASE.replace("particles_y", "particle_y"), "in.nml:5", "particle_y", "nearest", "particles_y")

    def test_group_twice(self):
        self.refuse_text(BASE + "&time\n  dt = 1e-3\n/\n", "in.nml:10", "time", "7")

    def test_wrong_type(self):
        self.refuse_text(BASE.replace("steps = 3", "steps = 'three'"), "in.nml:8", "&time steps", "integer", "three")
        self.refuse_text(BASE.replace("steps = 3", "steps = 3.5"), "in.nml:8", "&time steps", "integer", "3.5")
        self.refuse_text(BASE.replace("particles_y = 20", "periodic_x = 7"), "in.nml:5", "&domain periodic_x", "7")

    def test_not_finite(self):
        for value in ["NaN", "Inf", "-Infinity", "1e999"]:
            with self.subTest(value):
                self.refuse_text(BASE.replace("steps = 3", f"dt = {value}"), "in.nml:8", "&time dt", value, "finite")

    def test_out_of_range(self):
        self.refuse_text(BASE.replace("steps = 3", "steps = -1"), "in.nml:8", "&time steps", "-1")
        self.refuse_text(BASE.replace("steps = 3", "rtol = 0.5"), "in.nml:8", "&time rtol", "0.5", "0.1")

    def test_an_option_that_is_not_there(self):
        self.refuse(INPUTS / "hydrostatic_12.nml", "--outptu", "here", says=["--outptu", "the nearest option is --output"])

    def test_a_key_without_its_group(self):
        result = self.call("disph_c", INPUTS / "hydrostatic_12.nml", "--set", "steps=7", "--check")
        self.assertEqual(result.status, COMPLETED, result.stderr)
        self.assertRegex(result.stdout, "(?m)^  steps = 7$")
        self.refuse_set("stps=7", says=["--set stps=7", "unknown key stps", "the nearest is steps"])
        self.refuse_set("name=x", says=["--set name=x", "several groups", "kernel.name=x"], name="rti_note")

    def test_an_input_for_another_program(self):
        for given_to, name, program in [("rti", "blankenbach_1a", "convection"), ("convection", "sod", "shock"), ("shock", "balance_bowl", "balance"), ("rti", "dam_break_2d", "flow"),
                                        ("drop", "rti_note", "rti")]:
            self.refuse(INPUTS / f"{name}.nml", program=given_to, says=[f"{name}.nml:", f"this input is for program {program}"])

    @unittest.skipUnless(shutil.which("zsh"), "there is no zsh")
    def test_completion_in_zsh(self):
        """In a terminal of its own, with the key pressed."""
        completion = pathlib.Path(__file__).resolve().parents[2] / "programs/completion.bash"
        begin = f"autoload -U +X compinit && compinit -u; autoload -U +X bashcompinit && bashcompinit; source {completion}; cd {INPUTS}; echo re''ady\n"
        for typed, completed in [("tetsuame vi", "view"), (f"{PROGRAMS}/disph_c sod", "sod.nml"),
                                 (f"{PROGRAMS}/disph_c hydrostatic_12.nml --set time.st", "time.steps="), (f"{PROGRAMS}/disph_c --descr", "--describe")]:
            with self.subTest(typed):
                process, terminal = pty.fork()
                if process == 0:
                    os.execvpe("zsh", ["zsh", "-f", "-i"], {**os.environ, "TERM": "dumb", "COLUMNS": "400"})

                def seen(what, limit=20):
                    text, end = "", time.monotonic() + limit
                    while what not in text and time.monotonic() < end:
                        if select.select([terminal], [], [], 0.1)[0]:
                            text += os.read(terminal, 65536).decode(errors="replace")
                    return text

                os.write(terminal, begin.encode())
                self.assertIn("ready", seen("ready"))
                os.write(terminal, typed.encode() + b"\t")
                self.assertIn(completed, seen(completed))
                os.kill(process, signal.SIGKILL)
                os.waitpid(process, 0)
                os.close(terminal)

    def test_completion(self):
        """What bash would offer for the last word."""
        completion = pathlib.Path(__file__).resolve().parents[2] / "programs/completion.bash"
        for words, offered in [(["disph_c", INPUTS / "rti_note.nml", "--set", "rti.viscosity_l"], "rti.viscosity_lower="),
                               (["rti", "--re"], "--restart"), (["rti", INPUTS / "sedov_oc"], f"{INPUTS}/sedov_octant.nml"), (["./run", "mo"], "movie")]:
            with self.subTest(words):
                function = "_tetsuame_run" if words[0] == "./run" else "_tetsuame_program"
                script = (f"source {completion}; compopt() {{ :; }}; COMP_WORDS=({' '.join(map(str, words))}); COMP_CWORD={len(words) - 1}; {function}; "
                          'echo "${COMPREPLY[@]}"')
                said = subprocess.run(["bash", "-c", script], capture_output=True, text=True, env={"PATH": f"{PROGRAMS}:/usr/bin:/bin"})
                self.assertEqual((said.stdout.strip(), said.stderr), (offered, ""))

    def test_questions_need_no_mpi(self):
        """Where MPI may not start: a cluster's login node. (A component that is not there ends MPI_Init.)"""
        for question in (["--help"], ["--version"], ["--describe"], [INPUTS / "hydrostatic_12.nml", "--check"]):
            with self.subTest(question):
                result = self.call("disph_c", *question, more={"OMPI_MCA_pml": "none_such"})
                self.assertEqual(result.status, COMPLETED, result.stderr)
                self.assertGreater(len(result.stdout), 5 if question == ["--version"] else 300)

    def test_unknown_choice(self):
        self.refuse_text(BASE.replace("steps = 3", "method = 'euller'"), "in.nml:8", "&time method", "'euler'", "'adaptive'")

    def test_unterminated(self):
        self.refuse_text(BASE.rstrip().rstrip("/"), "in.nml:", "time")
        self.refuse_text(BASE.replace("steps = 3", "method = 'euler"), "in.nml:8")

    def test_zero_particles(self):
        self.refuse_text(BASE.replace("particles_x = 20", "particles_x = 0"), "in.nml:4", "&domain particles_x", "0")

    def test_negative_pressure(self):
        self.refuse_set("initial.pressure=-1e5", says=["&initial pressure", "-1e5", "Pa"])

    def test_spacing_differs(self):
        self.refuse_text(BASE.replace("particles_y = 20", "particles_y = 21"), "in.nml:5", "&domain particles_y",
                         "spacing", "5000", "4761")

    def test_support_wider_than_the_box(self):
        self.refuse_text(BASE.replace("length_x = 100.0e3", "length_x = 35.0e3").replace("particles_x = 20", "particles_x = 7"),
                         "in.nml:4", "&domain particles_x", "support", "36000", "35000")

    def test_wall_box_narrower_than_the_support(self):
        self.refuse_text(BASE.replace("length_y = 100.0e3", "length_y = 15.0e3").replace("particles_y = 20", "particles_y = 3"),
                         "narrower")

    def test_hydrostatic_and_periodic(self):
        self.refuse_set("domain.periodic_y=.true.", says=["periodic_y", "hydrostatic", ".false."], name="hydrostatic_column")

    def test_parameter_of_another_equation_of_state(self):
        self.refuse_set("material.gruneisen=1.5", says=["&material", "gruneisen", "linear"])

    def test_unknown_equation_of_state(self):
        self.refuse_set("material.eos=liquid_irn", says=["&material eos", "liquid_iron"])

    def test_dimension(self):
        self.refuse_set("domain.dimension=4", says=["&domain dimension", "4", "3"])
        # In 3-D the third axis counts: 100 km with 30 particles is another spacing.
        self.refuse_set("domain.dimension=3", "domain.particles_z=30", says=["&domain particles_z", "spacing", "5000", "3333"])

    # ---- where the output goes ----
    # A directory below a regular file and one in /proc can be made by nobody, root included.

    def test_output_is_a_file(self):
        (self.here / "out").write_text("mine")
        self.refuse(INPUTS / "hydrostatic_12.nml", "--output", "out", says=["out", "is a file", "--output"])

    def test_output_below_a_file(self):
        (self.here / "file").write_text("mine")
        self.refuse(INPUTS / "hydrostatic_12.nml", "--output", "file/out", says=["file/out"], status=FILE_FAILED)

    def test_output_cannot_be_made(self):
        self.refuse(INPUTS / "hydrostatic_12.nml", "--output", "/proc/tetsuame/out", says=["/proc/tetsuame"], status=FILE_FAILED)
        self.assertFalse(pathlib.Path("/proc/tetsuame").exists())

    def test_output_not_empty(self):
        (self.here / "out").mkdir()
        (self.here / "out" / "notes.txt").write_text("mine")
        self.refuse(INPUTS / "hydrostatic_12.nml", "--output", "out", says=["out", "not empty", "--force", "--restart latest"])

    # ---- ranks ----

    def test_ranks_x_that_does_not_divide(self):
        before = self.listing()
        result = self.call("disph_c", INPUTS / "hydrostatic_12.nml", "--output", "out", "--set", "domain.ranks_x=2", ranks=3)
        self.assert_says(result, BAD_INPUT, "--set domain.ranks_x=2: &domain ranks_x: 2", "number of MPI ranks, 3")
        self.assertEqual(self.listing(), before, "something was written")
        self.assertEqual(result.stderr.count("MPI ranks"), 1, "rank 0 speaks, alone")

    def test_halo_wider_than_the_periodic_box(self):
        before = self.listing()
        result = self.call("disph_c", INPUTS / "hydrostatic_12.nml", "--output", "out", "--set", "domain.particles_x=8",
                           "--set", "domain.length_x=40e3", "--set", "kernel.skin=2", "--set", "kernel.h_over_dx=1.3",
                           "--set", "walls.marker_radius=2")
        self.assert_says(result, BAD_INPUT, "too narrow along x", "skin")
        self.assertEqual(self.listing(), before, "something was written")

    def test_one_rank_speaks(self):
        result = self.call("disph_c", "no_such.nml", ranks=2)
        self.assert_says(result, BAD_INPUT, "no_such.nml")
        self.assertEqual(result.stderr.count("no_such.nml"), 1, result.stderr)


class Force(Case):
    def test_removes_our_files_only(self):
        first = self.run_program("disph_a", "hydrostatic_12", {**SHORT, "hosono.solver": "newton", "run.checkpoint_interval": 1}, "out")
        ours = {path.name for path in first.directory.iterdir()}
        self.assertLessEqual({"residuals.csv", "summary.json", "series.xdmf", "checkpoint_00000003.h5"}, ours)
        theirs = ["notes.txt", "snapshot_final.h5", "checkpoint_kept.h5", "figure.png"]
        for name in theirs:
            (first.directory / name).write_text("mine")
        # Program F has no residuals, and without the interval no checkpoints: whatever is left of these is A's.
        second = self.run_program("disph_f", "hydrostatic_12", SHORT, "out", options=["--force"])
        left = {path.name for path in second.directory.iterdir()}
        clean = self.run_program("disph_f", "hydrostatic_12", SHORT, "clean")
        self.assertEqual(left - set(theirs), {path.name for path in clean.directory.iterdir()})
        for name in theirs:
            self.assertEqual((second.directory / name).read_text(), "mine")

    def test_refused_input_removes_nothing(self):
        self.run_program("disph_f", "hydrostatic_12", SHORT, "out")
        before = self.listing()
        self.run_program("disph_f", "hydrostatic_12", {"time.dt": -1}, "out", options=["--force"], expect=BAD_INPUT)
        self.assertEqual(self.listing(), before)


class Describe(Case):
    def test_is_a_valid_input_of_every_program(self):
        for program in ALL:
            with self.subTest(program):
                described = self.call(program, "--describe")
                self.assertEqual(described.status, COMPLETED, described)
                for part in ["&domain", "length_x", "[m", "&hosono", "&run", "wall_clock_limit"]:
                    self.assertIn(part, described.stdout)
                (self.here / f"{program}.nml").write_text(described.stdout)
                checked = self.call(program, f"{program}.nml", "--check")
                self.assertEqual(checked.status, COMPLETED, checked)

    def test_at_most_sixty_keys_before_expert(self):
        """Without the pieces of bodies, the regions of a start, layers of planets, further materials, grains and packings, sources, inflows and outflows and the points of gauges, of which a run
        without them has none."""
        asked = [(program,) for program in [*ALL, "rti", "drop", "conduction", "convection", "shock", "planet", "flow", "granular"]]
        asked += [("disph_c", INPUTS / f"{name}.nml") for name in ("rti_linear", "drop_cylinder", "conduction_plate", "pond_on_mantle")]
        for words in asked:
            with self.subTest(words=words):
                ordinary = self.call(*words, "--describe").stdout.split("&expert\n")[0]
                ordinary = re.sub(r"^&(solids|motions|region|constants|sources|inflow|outflow|layer|grain|packing|pair)\n.*?^/\n", "", ordinary, flags=re.MULTILINE | re.DOTALL)
                if re.search("^&(rti|drop|granular)$", ordinary, re.MULTILINE):  # others have one &material
                    ordinary = re.sub(r"^&material\n.*?^/\n", "", ordinary, flags=re.MULTILINE | re.DOTALL)
                ordinary = re.sub(r"^ *point(_\w+)? =.*\n", "", ordinary, flags=re.MULTILINE)
                keys = [line for line in ordinary.splitlines() if " =" in line and not line.lstrip().startswith("!")]
                self.assertGreater(len(keys), 25)
                self.assertLessEqual(len(keys), 60)

    def test_states_the_defaults(self):
        """As an input it gives what an input without a key gives."""
        (self.here / "described.nml").write_text(self.call("disph_c", "--describe").stdout)
        (self.here / "nothing.nml").write_text("&domain\n/\n")
        strip = lambda text: [line.split("!")[0].strip() for line in text.splitlines()]
        self.assertEqual(strip(self.call("disph_c", "described.nml", "--check").stdout),
                         strip(self.call("disph_c", "nothing.nml", "--check").stdout))


class Check(Case):
    def test_prints_and_writes_nothing(self):
        for program in ALL:
            with self.subTest(program):
                before = self.listing()
                result = self.call(program, INPUTS / "hydrostatic_column.nml", "--set", "time.steps=7", "--check")
                self.assertEqual(result.status, COMPLETED, result)
                self.assertRegex(result.stdout, r"steps\s*=\s*7\b")
                self.assertRegex(result.stdout, r"reference_pressure\s*=\s*1e\+05")  # resolved: the initial pressure
                self.assertEqual(self.listing(), before)

    def test_output_is_an_input(self):
        first = self.call("disph_f", INPUTS / "hydrostatic_column.nml", "--check").stdout
        (self.here / "resolved.nml").write_text(first)
        self.assertEqual(self.call("disph_f", "resolved.nml", "--check").stdout, first)

    def test_finds_errors(self):
        self.assert_says(self.call("disph_f", INPUTS / "hydrostatic_12.nml", "--set", "domain.particles_x=0", "--check"),
                         BAD_INPUT, "particles_x")


class Resolved(Case):
    def test_runs_again_with_the_same_result(self):
        # Only what `resolved.nml` keeps can make the second run the same: the settings are not given again.
        settings = {"time.steps": 20, "time.dt": 0.01, "initial.pressure": 1.0e10 / 3.0, "domain.particles_x": 10,
                    "domain.length_x": 50e3, "expert.velocity_top": 100.0, "walls.slip": "no_slip", "material.viscosity": 1e11}
        for program in ["disph_c", "disph_d", "disph_f"]:
            with self.subTest(program):
                first = self.run_program(program, "hydrostatic_column", settings)
                again = self.run_program(program, first.directory / "resolved.nml")
                self.assertEqual(again.summary["state_hash"], first.summary["state_hash"])
                self.assertEqual((again.directory / "resolved.nml").read_text(), (first.directory / "resolved.nml").read_text())


if __name__ == "__main__":
    unittest.main()
