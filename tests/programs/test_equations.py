"""Equations of state as a user meets them: plan eos, tables in every program that takes one, what is refused."""

import csv
import json
import os
import pathlib
import shutil
import subprocess
import sys
import unittest

import h5py
import numpy as np

from running import BAD_INPUT, CALCULATION_FAILED, COMPLETED, FILE_FAILED, Case

SOURCES = pathlib.Path(__file__).resolve().parents[2] / "programs/python"

# Pressure and energy of the table go through nodes 1 % apart in density.
IRON = ["--rho", 6000, 20000, "--T", 1000, 9000, "--nodes", 130, 80]
TUBE = """&domain dimension = 1 length_x = 1e5 particles_x = 100 /
&shock test = 'riemann' scheme = 'gdisph' weight = 'volume'
  eos_l = '{}' p_l = 6e10 temperature_l = 3500 eos_r = '{}' p_r = 1e10 temperature_r = 3000 {} /
&time t_end = 3.0 /
&kernel name = 'quintic' skin = 2.0 /
"""
BOX = """&domain particles_x = 16 particles_y = 16 length_x = 1e5 length_y = 1e5 /
&initial temperature = 2500 pressure = 1e10 /
&gravity g = 10 /
&material eos = '{}' {} viscosity = 1e8 /
&time steps = 20 dt = 0.05 /
"""
LAYERS = """&domain length_x = 1e6 length_y = 1e6 particles_x = 16 particles_y = 16 /
&rti eos_upper = '{}' {} density_lower = 3000 p_top = 1e10 temperature = 3000 temperature_law = 'adiabatic'
  amplitude = 2e4 wavelength = 1e6 viscosity_upper = 6e11 viscosity_lower = 6e11 /
&time steps = 20 dt = 2.0 t_end = 1e9 /
"""
DROP = """&domain length_x = 1e6 length_y = 1e6 particles_x = 24 particles_y = 24 /
&drop eos_drop = '{}' {} density_outside = 3000 p_top = 1e10 temperature = 3000 temperature_law = 'adiabatic' /
&time steps = 10 dt = 2.0 t_end = 1e9 /
"""
LAYER = """&domain length_x = 2e6 length_y = 2e6 particles_x = 16 particles_y = 16 /
&material density = 1e4 expansivity = 3e-5 heat_capacity = 800 conductivity = 50 viscosity = 1e23 bulk_modulus = 2e11 /
&gravity g = 10 /
&convection rayleigh = 1e4 target = 'steady' gravity_density = 'equation_of_state' eos = '{}' {} p_top = 2e10 /
&walls slip = 'free_slip' thermal = 'adiabatic' thermal_bottom = 'fixed' temperature_bottom = 4000 thermal_top = 'fixed'
  temperature_top = 2500 /
&time steps = 10 t_end = 1e30 /
"""


class Equations(Case):
    def plan(self, *arguments, status=COMPLETED):
        result = self.call("plan", "eos", *arguments)
        self.assertEqual(result.status, status, result)
        return result

    def table(self, name="iron.txt", equation="liquid_iron_isentrope", axes=IRON):
        self.plan(equation, "--table", name, *axes)
        return self.here / name


class Plan(Equations):
    def test_states(self):
        """Against the definitions: K_T = 82.1 GPa of liquid iron at its reference, gamma = 2.02, K_S = rho c^2."""
        said = self.plan("liquid_iron", "--temperature", 1811, "--pressure", 1e5, 1e11, "--json", "states.json").stdout
        self.assertIn("Kuwayama", said)
        at = json.loads((self.here / "states.json").read_text())["states"]
        self.assertAlmostEqual(at[0]["rho_kg_m3"], 7030.0, delta=1e-6)
        self.assertAlmostEqual(at[0]["K_T_Pa"], 82.1e9, delta=1e3)
        self.assertAlmostEqual(at[0]["gamma"], 2.02, delta=1e-9)
        self.assertAlmostEqual(at[1]["K_S_Pa"] / (at[1]["rho_kg_m3"] * at[1]["c_m_s"] ** 2), 1.0, delta=1e-12)
        for name in ("linear", "liquid_mgsio3", "iron_hcp", "bridgmanite", "post_perovskite", "tillotson", "ideal_gas"):
            self.plan(name)
        self.assertIn("none", self.plan("liquid_iron", "--temperature", 3000, "--pressure", -1e12).stdout)

    def test_curves(self):
        """The Hugoniot's velocities and energy by the jump conditions; the isentrope's temperature above the isotherm's."""
        self.plan("iron_hcp", "--temperature", 300, 2000, "--pressure", 1e10, 1e12, "--output", "out")
        self.assertEqual(sorted(p.name for p in (self.here / "out").iterdir()), ["hugoniot.csv", "isentrope.csv", "isotherm.csv"])
        with open(self.here / "out" / "hugoniot.csv", encoding="utf-8") as file:
            rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
        first, last = rows[0], rows[-1]
        p, rho, u, speed, shock = (last[name] for name in ("p [Pa]", "rho [kg/m^3]", "u [J/kg]", "particle velocity [m/s]",
                                                            "shock velocity [m/s]"))
        self.assertGreater(p, 0.99e12)
        self.assertAlmostEqual(first["rho [kg/m^3]"] * shock / (rho * (shock - speed)), 1.0, delta=1e-6)
        self.assertAlmostEqual(first["rho [kg/m^3]"] * shock * speed / (p - first["p [Pa]"]), 1.0, delta=1e-6)
        self.assertAlmostEqual((u - first["u [J/kg]"]) / (0.5 * speed**2 + first["p [Pa]"] * (1 / first["rho [kg/m^3]"] - 1 / rho)), 1.0, delta=1e-6)

    def test_picture(self):
        """Of all curves, and of a gas; a file that is not of plan eos is a sentence."""
        draw = lambda folder: subprocess.run([sys.executable, "-m", "tetsuame", "eos", str(self.here / folder)], capture_output=True, text=True,
                                             env={**os.environ, "PYTHONPATH": str(SOURCES)})
        for name in ("iron_hcp", "ideal_gas"):
            self.plan(name, "--output", name)
            self.assertEqual(draw(name).returncode, COMPLETED, draw(name))
            self.assertTrue((self.here / name / "eos.png").read_bytes().startswith(b"\x89PNG"))
        (self.here / "ideal_gas" / "isotherm.csv").write_text("a,b\n1,2\n")
        said = draw("ideal_gas")
        self.assertEqual((said.returncode, said.stderr.count("\n")), (FILE_FAILED, 1), said)
        self.assertIn("start [K]", said.stderr)

    def test_refusals(self):
        for arguments, said in [(["steel"], "liquid_iron"), (["table"], "needs a file"), (["table", "--file", "none.txt"], "none.txt"),
                                (["linear", "--set", "gama=2"], "gama=2"), (["linear", "--set", "gamma=2"], "has no parameter gamma"),
                                (["linear", "--table", "t.txt"], "--rho"),
                                (["liquid_iron", "--table", "t.txt", "--rho", 1, 2, "--T", 300, 600], "no state of 1 kg/m^3"),
                                (["liquid_iron", "--table", "t.txt", "--rho", 9000, 8000, "--T", 300, 600], "LOW < HIGH"),
                                (["linear", "--temperature", -3], "temperature")]:
            with self.subTest(said):
                before = self.listing()
                self.assert_says(self.call("plan", "eos", *arguments), BAD_INPUT, said)
                self.assertEqual(self.listing(), before)


class Tables(Equations):
    """A run with a table of an equation is the run with that equation: its errors, 1e-6, and what steps make of them."""

    def case(self, name, text):
        path = self.here / name
        path.write_text(text)
        return path

    def both(self, program, text, key, equation="liquid_iron_isentrope"):
        self.table(equation=equation)
        own = self.run_program(program, self.case("own.nml", text.format(equation, "")), {}, "own")
        read = self.run_program(program, self.case("read.nml", text.format("table", f"{key} = 'iron.txt'")), {}, "read")
        return own, read

    def test_a_box_at_rest(self):
        own, read = self.both("disph_c", BOX, "table")
        self.assertEqual((self.here / "read" / "input_iron.txt").read_bytes(), (self.here / "iron.txt").read_bytes())
        self.assertIn("input_iron.txt", (read.directory / "resolved.nml").read_text())
        self.assert_fields(own, read, {"Density": 1e-6, "Pressure": 1e-5, "Temperature": 1e-6})

    def assert_fields(self, own, read, fields):
        with h5py.File(sorted(own.directory.glob("snapshot_*.h5"))[-1]) as a, h5py.File(sorted(read.directory.glob("snapshot_*.h5"))[-1]) as b:
            for name, relative in fields.items():
                first, second = (np.array(f[f"PartType0/{name}"])[np.argsort(f["PartType0/ParticleIDs"])] for f in (a, b))
                self.assertLess(np.abs(second / first - 1.0).max(), relative, name)

    def test_layers_and_drops(self):
        for program, text, key in [("rti", LAYERS, "table_upper"), ("drop", DROP, "table_drop"), ("disph_n", LAYERS, "table_upper")]:
            with self.subTest(program):
                own, read = self.both(program, text, key)
                self.assert_fields(own, read, {"Density": 1e-5, "Temperature": 1e-5})
                for folder in ("own", "read"):
                    self.remove(folder)

    def remove(self, folder):
        shutil.rmtree(self.here / folder)

    def test_a_shock_by_energy(self):
        """p, u and T along the tube, between liquids of 60 and 10 GPa."""
        self.table()
        own = self.run_program("shock", self.case("own.nml", TUBE.format("liquid_iron_isentrope", "liquid_iron_isentrope", "")), {}, "own")
        keys = "table_l = 'iron.txt' table_r = 'iron.txt'"
        read = self.run_program("shock", self.case("read.nml", TUBE.format("table", "table", keys)), {}, "read")
        self.assert_fields(own, read, {"Density": 1e-4, "Pressure": 1e-3})

    def test_convection(self):
        own, read = self.both("convection", LAYER, "eos_table")
        velocities = []
        for run in (own, read):
            with h5py.File(sorted(run.directory.glob("snapshot_*.h5"))[-1]) as file:
                velocities.append(np.array(file["PartType0/Velocities"])[np.argsort(file["PartType0/ParticleIDs"])])
        largest = np.abs(velocities[0]).max()
        self.assertGreater(largest, 0.0)
        self.assertLess(np.abs(velocities[1] - velocities[0]).max(), 1e-4 * largest)

    def test_refused_before_anything_is_written(self):
        good = self.table().read_text().splitlines()
        for name, lines, said in [("short", good[:-3], ["t.txt", "ends after"]), ("word", good[:500] + ["1 2 three 4"] + good[501:], ["t.txt:501", "three"]),
                                  ("nan", good[:500] + ["nan 1e9 3e3 1"] + good[501:], ["t.txt:501", "finite"]),
                                  ("row", good[:500] + ["1e5 1e9 3e3"] + good[501:], ["t.txt:501", "found 3"]),
                                  ("order", good[:14] + [good[14].replace(" 6000 ", " 60000 ")] + good[15:], ["t.txt:15", "does not lie above"])]:
            (self.here / "t.txt").write_text("\n".join(lines) + "\n")
            for program, text, key in [("disph_c", BOX, "table"), ("rti", LAYERS, "table_upper")]:
                with self.subTest(name, program=program):
                    source = self.case("bad.nml", text.format("table", f"{key} = 't.txt'"))
                    before = self.listing()
                    self.assert_says(self.call(program, source, "--output", self.here / "out"), BAD_INPUT, "bad.nml:", *said)
                    self.assertEqual(self.listing(), before)
        for text, key, said in [(BOX, "", "needs a file"), (BOX, "table = 'gone.txt'", "gone.txt")]:
            source = self.case("bad.nml", text.format("table", key))
            self.assert_says(self.call("disph_c", source, "--output", self.here / "out"), BAD_INPUT, said)
        self.assert_says(self.call("disph_c", self.case("bad.nml", BOX.format("linear", "table = 't.txt'")), "--output", self.here / "out"),
                         BAD_INPUT, "has no parameter table")

    def test_line_ends_and_marks(self):
        """A table with a mark and line ends of other systems is the same table."""
        path = self.table()
        source = self.case("box.nml", BOX.format("table", "table = 'iron.txt'"))
        plain = self.run_program("disph_c", source, {}, "plain").summary["state_hash"]
        path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes().replace(b"\n", b"\r\n"))
        self.assertEqual(self.run_program("disph_c", source, {}, "marked").summary["state_hash"], plain)

    def test_out_of_range(self):
        """Refused at the start; in a run with the particle, its number and place."""
        self.table(axes=["--rho", 7000, 9000, "--T", 2000, 3000, "--nodes", 30, 20])
        hot = self.case("hot.nml", BOX.format("table", "table = 'iron.txt'").replace("2500", "3500"))
        self.assert_says(self.call("disph_c", hot, "--output", self.here / "out"), BAD_INPUT, "hot.nml:", "outside its table")
        dense = self.case("dense.nml", BOX.format("table", "table = 'iron.txt'").replace("1e10", "9e10"))
        self.assert_says(self.call("disph_c", dense, "--output", self.here / "out"), BAD_INPUT, "dense.nml:", "no density")
        # Sound in the box makes more of its temperature than the table has.
        self.table(axes=["--rho", 7000, 9000, "--T", 2499.999, 2500.001, "--nodes", 30, 5])
        box = self.case("box.nml", BOX.format("table", "table = 'iron.txt'"))
        result = self.call("disph_c", box, "--output", self.here / "out")
        self.assert_says(result, CALCULATION_FAILED, "particle", "step")
        # A wave that would leave the table is refused where it is known beforehand.
        self.table(axes=["--rho", 7000, 9800, "--T", 2000, 5000, "--nodes", 30, 20])
        tube = TUBE.format("table", "table", "table_l = 'iron.txt' table_r = 'iron.txt' u_l = 4e3 u_r = -4e3")
        self.assert_says(self.call("shock", self.case("tube.nml", tube), "--output", self.here / "out2"), BAD_INPUT, "tube.nml:")


class Tillotson(Equations):
    def test_of_any_material_in_layers(self):
        """Granite by its name, and by its parameters over iron's: one run."""
        where = ("&rti eos_upper = 'liquid_iron' eos_lower = 'tillotson' p_top = 1e10 temperature = 2000 temperature_law = 'adiabatic'"
                 " amplitude = 2e4 wavelength = 1e6 viscosity_upper = 6e11 viscosity_lower = 6e11 /\n")
        rest = LAYERS.splitlines()[0] + "\n" + where + LAYERS.splitlines()[-1] + "\n"
        granite = {"reference_density": 2680, "nonlinear_modulus": 18e9, "tillotson_b": 1.3, "tillotson_energy": 1.6e7,
                   "incipient_energy": 3.5e6, "complete_energy": 1.8e7, "bulk_modulus": 18e9, "heat_capacity": 790}
        named = self.case("named.nml", rest + "&expert tillotson_lower = 'granite' /\n")
        given = self.case("given.nml", rest + "&expert " + " ".join(f"{key}_lower = {value}" for key, value in granite.items()) + " /\n")
        hashes = [self.run_program("rti", path, {}, path.stem).summary["state_hash"] for path in (named, given)]
        self.assertEqual(hashes[0], hashes[1])
        basalt = self.case("basalt.nml", rest + "&expert tillotson_lower = 'basalt' /\n")
        self.assertNotEqual(self.run_program("rti", basalt, {}, "basalt").summary["state_hash"], hashes[0])

    def case(self, name, text):
        path = self.here / name
        path.write_text(text)
        return path

    def test_refusals(self):
        text = LAYERS.format("liquid_iron", "")
        for key, value, said in [("tillotson_upper", "'granite'", "'tillotson'"), ("gamma_upper", 1.4, "has no parameter gamma"),
                                 ("gruneisen_lower", 1.0, "'linear' has density_lower"), ("table_upper", "'t.txt'", "")]:
            source = self.case("bad.nml", text + f"&expert {key} = {value} /\n")
            self.assert_says(self.call("rti", source, "--output", self.here / "out"), BAD_INPUT, key.split("_")[0], said)

    def test_conductivity_of_each(self):
        """Of both or of each, one run where they are the same; where one conducts nothing no heat crosses."""
        text = LAYERS.format("liquid_iron", "")
        hashes = [self.run_program("rti", self.case(f"c{n}.nml", text + extra), {}, f"c{n}").summary["state_hash"] for n, extra in enumerate(
            ("&expert conductivity_upper = 1e12 conductivity_lower = 1e12 /\n", "&expert conductivity_upper = 1e12 /\n"))]
        common = self.run_program("rti", self.case("c.nml", text), {"rti.conductivity": 1e12}, "c").summary["state_hash"]
        self.assertEqual(hashes[0], common)
        self.assertNotEqual(hashes[1], common)


if __name__ == "__main__":
    unittest.main()
