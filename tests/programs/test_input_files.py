"""Files that an input names, and the input itself: one rule for all, from anywhere; what is dropped, changed or no plain file is refused."""

import json
import os
import shutil

from running import BAD_INPUT, INPUTS, Case

TANK = """&domain length_x = 1.6 length_y = 0.8 particles_x = 32 particles_y = 16 /
&flow low_x = 0.2 high_x = 1.4 low_y = 0.1 high_y = 0.5 /
&solids body = 'tank' shape = 'box' solid = 'outside' centre_x = 0.8 centre_y = 1.1 length_x = 1.2 length_y = 2.0 /
&motions body = 'tank' kind = 'table' file = 'way.csv' /
&gauges interval = 0.01 height_x = 0.8 file = 'curves.csv' height_columns = 'h' /
&walls slip_top = 'free_surface' /
&time t_end = 1.0 steps = 6 /
"""
WAY = "t,x,y,z,angle\n0.0,0,0,0,0\n0.1,0.01,0,0,0\n0.2,0.02,0,0,0\n0.3,0.02,0,0,0\n"
CURVES = "t,h\n0.0,0.4\n0.02,0.4\n0.04,0.4\n"
LAYER = """&domain length_x = 2.0 length_y = 1.0 particles_x = 32 particles_y = 16 /
&material density = 1000 expansivity = 1e-4 heat_capacity = 1000 conductivity = 5 viscosity = 1 bulk_modulus = 1e6 /
&gravity g = 10 /
&convection rayleigh = 100 target = 'steady' viscosity_law = 'table' viscosity_file = 'viscosity.txt' /
&walls slip = 'free_slip' thermal = 'adiabatic' thermal_bottom = 'fixed' temperature_bottom = 350 thermal_top = 'fixed'
  temperature_top = 300 /
&time t_end = 1e9 steps = 2 /
"""
VISCOSITY = "300 0 1e3\n300 1 1e3\n350 0 1e2\n350 1 1e2\n"
SURFACE = """&domain dimension = 3 length_x = 1.2 length_y = 1.0 length_z = 0.6 particles_x = 12 particles_y = 10 particles_z = 6 /
&flow high_x = 0.5 high_y = 0.7 sound_factor = 15.0 around_bodies = .true. /
&solids body = 'tank' shape = 'file' file = 'tank.stl' solid = 'outside' centre_x = 0.6 centre_y = 0.5 centre_z = 0.3
  angle_z = 20.0 /
&time t_end = 1e9 steps = 2 /
&output interval = 0 /
"""
LAYERS = {"domain.particles_x": 16, "domain.particles_y": 16, "kernel.name": "wendland_c6", "rti.p_top": 1e10, "rti.amplitude": 4e4,
          "output.interval": 0}
LATER = {"time.steps": 12}


class Files(Case):
    def setUp(self):
        super().setUp()
        self.case = self.here / "case"
        self.case.mkdir()
        for name, text in [("tank.nml", TANK), ("way.csv", WAY), ("curves.csv", CURVES), ("layer.nml", LAYER), ("viscosity.txt", VISCOSITY),
                           ("surface.nml", SURFACE)]:
            (self.case / name).write_text(text)
        shutil.copy(INPUTS / "tank.stl", self.case / "tank.stl")

    def test_run_goes_on_from_anywhere(self):
        """Without the files, without the input, from another folder, and with the results moved: the state of a run that was not stopped."""
        tank = self.case / "tank.nml"
        whole = self.run_program("flow", tank, LATER, "whole").summary["state_hash"]
        first = self.run_program("flow", tank, {}, "first")
        self.assertEqual((first.directory / "input_way.csv").read_text(), WAY)
        self.assertEqual((first.directory / "input_curves.csv").read_text(), CURVES)
        shutil.copytree(first.directory, self.here / "second")
        for name in ("way.csv", "curves.csv"):
            (self.case / name).unlink()
        again = self.run_program("flow", tank, LATER, "second", ["--restart", "latest"])
        self.assertEqual(again.summary["state_hash"], whole)
        shutil.rmtree(self.case)
        moved = self.here / "elsewhere" / "run"
        moved.parent.mkdir()
        shutil.move(first.directory, moved)
        self.assert_completed(self.call("flow", "--output", moved, "--restart", "latest", "--set", "time.steps=12"))
        self.assertEqual(json.loads((moved / "summary.json").read_text())["state_hash"], whole)
        # Into a folder of its own, from which it goes on again.
        other = self.here / "other"
        checkpoint = sorted(moved.glob("checkpoint_*.h5"))[-1]
        self.assert_completed(self.call("flow", "--output", other, "--restart", checkpoint, "--set", "time.steps=14"))
        shutil.rmtree(moved)
        self.assert_completed(self.call("flow", "--output", other, "--restart", "latest", "--set", "time.steps=16"))

    def assert_completed(self, result):
        self.assertEqual(result.status, 0, result)

    def test_changed_files_are_refused(self):
        for program, name, file, new, on in [
                ("flow", "tank", "way.csv", WAY.replace("0.01", "0.02"), LATER),
                ("flow", "tank", "curves.csv", CURVES.replace("0.04,0.4", "0.04,0.5"), LATER),
                ("convection", "layer", "viscosity.txt", VISCOSITY.replace("1e2", "2e2"), {"time.steps": 4})]:
            with self.subTest(file):
                source, directory = self.case / f"{name}.nml", file.split(".")[0]
                self.run_program(program, source, {}, directory)
                (self.case / file).write_text(new)
                before = self.listing()
                refused = self.run_program(program, source, on, directory, ["--restart", "latest"], expect=BAD_INPUT)
                self.assert_says(refused, BAD_INPUT, file, "is another file than the one that the run was begun with")
                self.assertEqual(self.listing(), before)
                # Without the input the run goes on with its own copy; one that was changed is refused as well.
                copy = self.here / directory / f"input_{file}"
                kept = copy.read_text()
                copy.write_text(new)
                refused = self.call(program, "--output", self.here / directory, "--restart", "latest")
                self.assert_says(refused, BAD_INPUT, f"input_{file}", "is another file")
                copy.write_text(kept)
                changes = [word for key, value in on.items() for word in ("--set", f"{key}={value}")]
                self.assert_completed(self.call(program, "--output", self.here / directory, "--restart", "latest", *changes))

    def test_a_changed_surface_is_refused(self):
        source, stl = self.case / "surface.nml", self.case / "tank.stl"
        first = self.call("flow", source, "--output", self.here / "out")
        if "built without CGAL" in first.stderr:
            self.skipTest("built without CGAL")
        self.assert_completed(first)
        stl.write_bytes(stl.read_bytes() + b"\0")
        refused = self.call("flow", source, "--output", self.here / "out", "--restart", "latest", "--set", "time.steps=4")
        self.assert_says(refused, BAD_INPUT, "&solids file", "tank.stl", "is another file")
        stl.unlink()
        self.assert_completed(self.call("flow", source, "--output", self.here / "out", "--restart", "latest", "--set", "time.steps=4"))

    def test_paths_begin_at_the_input(self):
        """Of --set at the current folder; of the viscosity and of a snapshot to start from as of all."""
        first = self.run_program("convection", self.case / "layer.nml", {}, "layer")
        self.assertIn("viscosity_file = 'input_viscosity.txt'", (first.directory / "resolved.nml").read_text())
        (self.here / "here.txt").write_text(VISCOSITY)
        self.run_program("convection", self.case / "layer.nml", {"convection.viscosity_file": "here.txt"}, "by_set")
        self.run_program("convection", first.directory / "resolved.nml", {}, "again")
        settings = {**LAYERS, "time.steps": 2, "time.dt": 2.0}
        start = self.run_program("disph_f", "rti_linear", settings, "start")
        shutil.copy(sorted(start.directory.glob("snapshot_*.h5"))[-1], self.case / "start.h5")
        resolved = (start.directory / "resolved.nml").read_text()
        self.assertIn("file = ''", resolved)
        source = self.case / "goes_on.nml"
        source.write_text(resolved.replace("file = ''", "file = 'start.h5'", 1))
        on = self.run_program("disph_f", source, {}, "on")
        self.assertIn("file = 'input_start.h5'", (on.directory / "resolved.nml").read_text())
        whole = (self.case / "start.h5").read_bytes()
        (self.case / "start.h5").write_bytes(whole + b" ")
        refused = self.run_program("disph_f", source, {"time.steps": 3}, "on", ["--restart", "latest"], expect=BAD_INPUT)
        self.assert_says(refused, BAD_INPUT, "&initial file", "start.h5 is another file")
        refused = self.run_program("disph_f", source, {"time.steps": 3, "initial.file": "''"}, "on", ["--restart", "latest"], expect=BAD_INPUT)
        self.assert_says(refused, BAD_INPUT, "the run was begun from a snapshot")
        (self.case / "start.h5").unlink()
        self.run_program("disph_f", source, {"time.steps": 3}, "on", ["--restart", "latest"])
        self.run_program("disph_f", on.directory / "resolved.nml", {}, "anew")

    def test_no_plain_files(self):
        """Pipes are refused at once, and what is not there, and folders; nothing is written."""
        os.mkfifo(self.here / "pipe")
        for program, name, key, more in [
                ("flow", self.case / "tank.nml", "gauges.file", {}), ("flow", self.case / "tank.nml", "motions.file", {}),
                ("flow", self.case / "surface.nml", "solids.file", {}), ("convection", self.case / "layer.nml", "convection.viscosity_file", {}),
                ("disph_f", "rti_linear", "initial.file", LAYERS)]:
            for file, says in [("pipe", "is no plain file, but a pipe or a device"), ("absent", "there is no file absent"),
                               ("case", "is a directory, not a file"), ("/dev/zero", "is no plain file")]:
                with self.subTest(f"{key} = {file}"):
                    before = self.listing()
                    refused = self.run_program(program, name, {key: f"'{file}'", **more}, "bad", expect=BAD_INPUT)
                    self.assert_says(refused, BAD_INPUT, "&" + key.replace(".", " "), says)
                    self.assertEqual(self.listing(), before)

    def test_force_leaves_nothing_of_the_earlier_run(self):
        first = self.run_program("flow", self.case / "tank.nml", {}, "out")
        self.assertTrue((first.directory / "gauges.csv").is_file())
        theirs = {"input_notes.txt": "mine", "gauges_of_mine.csv": "t,h\n", "notes.txt": "mine"}
        for name, text in theirs.items():
            (first.directory / name).write_text(text)
        bare = self.case / "bare.nml"
        bare.write_text("\n".join(line for line in TANK.splitlines() if not line.startswith(("&gauges", "&motions", "&solids"))))
        self.run_program("flow", bare, {}, "out", ["--force"])
        clean = self.run_program("flow", bare, {}, "clean")
        left = {path.name for path in first.directory.iterdir()}
        self.assertEqual(left - set(theirs), {path.name for path in clean.directory.iterdir()})
        for name, text in theirs.items():
            self.assertEqual((first.directory / name).read_text(), text)

    def test_tables_of_all_writers(self):
        """Byte order mark, CRLF and empty last lines, semicolons, quotes, units, what is not used."""
        whole = self.run_program("flow", self.case / "tank.nml", {}, "plain").summary
        for n, (way, curves) in enumerate([
                ("\ufeff" + WAY, "\ufeff# measured\n" + CURVES),
                (WAY.replace("\n", "\r\n") + "\r\n", CURVES.replace("\n", "\r\n") + "\r\n\r\n"),
                (WAY.replace(",", ";").replace("0.01", "+1D-2"), '"t";"h"\n"s";"m"\n0;+0.4\n0.02;4D-1\n0.04;.4\n;\n'),
                (WAY.replace(",", "\t"), "t\tbad\th\n0\tnan\t0.4\n0.02\t\t0.4\n0.04\tx\t0.4\n"),
                ("angle;by;z;y;x;time (s)\n" + "".join(f"0;me;nan;0;{x};{t}\n" for t, x in [(0, 0), (0.1, 0.01), (0.2, 0.02), (0.3, 0.02)]),
                 "t h # of it\n".replace("# of it", "") + "0 0.4 # so\n0.02 0.4\n0.04 0.4\n")]):
            with self.subTest(n):
                (self.case / "way.csv").write_text(way, newline="")
                (self.case / "curves.csv").write_text(curves, newline="")
                again = self.run_program("flow", self.case / "tank.nml", {}, f"form_{n}").summary
                self.assertEqual(again["state_hash"], whole["state_hash"])
                self.assertEqual(again["metrics"]["height_1_mean_error"], whole["metrics"]["height_1_mean_error"])

    def test_curves_of_other_times(self):
        """No error of none in common: null, and why."""
        (self.case / "curves.csv").write_text("t,h\n1,0.4\n2,0.4\n")
        metrics = self.run_program("flow", self.case / "tank.nml", {"gauges.pressure_x": 0.8, "gauges.pressure_y": 0.2, "gauges.impulse_from": 0,
                                                                    "gauges.impulse_until": 0.5}).summary["metrics"]
        self.assertIsNone(metrics["height_1_mean_error"])
        self.assertIn("have no time in common", metrics["height_1_mean_error_reason"])
        self.assertIsNone(metrics["pressure_1_impulse"])
        self.assertIn("asked for from 0 to 0.5 s", metrics["pressure_1_impulse_reason"])

    def test_a_gate_that_moves_at_once(self):
        """Its velocity is known when the first step is chosen."""
        small = {"domain.particles_x": 161, "domain.particles_y": 60, "time.steps": 5, "output.interval": 0, "gauges.interval": 0}
        for settings in ({"flow.scheme": "riemann", "flow.alpha": 0}, {"flow.sound_factor": 5}):
            self.run_program("flow", "dam_break_2d", {**small, **settings})


class Namelists(Case):
    def refuse(self, text, *parts, program="flow"):
        source = self.here / "case.nml"
        source.write_bytes(text if isinstance(text, bytes) else text.encode())
        before = self.listing()
        self.assert_says(self.run_program(program, source, {}, "out", expect=BAD_INPUT), BAD_INPUT, *parts)
        self.assertEqual(self.listing(), before)

    def test_nothing_is_dropped(self):
        box = "&domain length_x = 1.0 length_y = 1.0 particles_x = 20 particles_y = 20 /\n"
        for program in ("flow", "disph_f", "convection", "shock"):
            self.refuse(box + "flow\n  high_y = 0.5\n/\n&time t_end = 0.05 /\n", "case.nml:3", "'high_y = 0.5' stands outside of all groups", program=program)
            self.refuse(box + "&time t_end = 0.1 dt = 1/4000\n cfl = 0.5\n/\n", "case.nml:2", "'4000' stands behind the end of group &time", program=program)
        self.refuse(box.replace("particles_x", "/ box\n particles_x"), "case.nml:1", "'box' stands behind the end of group &domain")

    def test_other_files_are_no_input(self):
        snapshot = next(self.run_program("shock", "sod", {"domain.particles_x": 50, "time.t_end": 0.01, "output.interval": 0}).directory.glob("snapshot_*.h5"))
        checkpoint = next(snapshot.parent.glob("checkpoint_*.h5"))
        for file in (snapshot, checkpoint):
            self.refuse(file.read_bytes(), "is an HDF5 file, where a namelist is expected")
        self.refuse(b"&domain\0/", "is a binary file")
