"""plan: the notes' tables from options and from a namelist, backwards answers, run times from bench's file."""

import json
import math
import unittest

import h5py

from running import BAD_INPUT, COMPLETED, FILE_FAILED, INPUTS, SLOW, Case
from test_all_inputs import particles

# [S1, table 1]; Ra = 1e4, 1e5, 1e6 by dT = 1e-2, 1e-1, 1
AIR = ["--L", 0.1, "--rho", 1, "--kappa", 1e-5, "--nu", 7.1e-6, "--g", 10, "--alpha", 7.1e-3, "--c-p", 1e3, "--K", 1.4e5]

# The same air by density, conductivity k = kappa rho c_p and viscosity eta = nu rho.
AIR_NML = """! dry air, dT = 1 K: Ra = 1e6, Pr = 0.71
&domain length_x = 0.1, length_y = 0.1, particles_x = 100, particles_y = 100 /
&material density = 1, expansivity = 7.1e-3, heat_capacity = 1e3, conductivity = 1e-2, viscosity = 7.1e-6
  bulk_modulus = 1.4e5 /
&gravity g = 10 /
&walls thermal_bottom = 'fixed', temperature_bottom = 301, thermal_top = 'fixed', temperature_top = 300 /
&time method = 'rk4', dt = 1e-3 /
&output interval = 1 /
"""


def bench_record(name, dimension, particles, threads, rate):
    return {"name": name, "dimension": dimension, "particles": particles, "threads": threads,
            "updates_per_second": rate, "load_average": 0.5, "processor": "a processor"}


class Plan(Case):
    def plan(self, *arguments, expect=COMPLETED):
        result = self.call("plan", *arguments, "--json", "plan.json")
        self.assertEqual(result.status, expect, result)
        return json.loads((self.here / "plan.json").read_text()), result.stdout

    def write_bench(self, records):
        folder = self.here / "output" / "bench"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "bench.json").write_text(json.dumps(records))


class OfAnInput(Case):
    """By a few steps of the run itself, which leaves nothing behind."""

    SMALL = ["--set", "domain.particles_x=20", "--set", "domain.particles_y=20"]

    def figures(self, result):
        """The value and the remark of each line."""
        self.assertEqual(result.status, COMPLETED, result)
        lines = [line for line in result.stdout.splitlines() if line.startswith("  ")]
        return {line[2:12].strip(): line[13:].strip() for line in lines}

    def test_every_program(self):
        before = self.listing()
        for name, program, settings in [("hydrostatic_12", "disph_c", []), ("rti_linear", "rti", []), ("drop_cylinder", "drop", []),
                                        ("hydrostatic_13", "disph_a", ["--program", "disph_a", "--set", "hosono.solver=newton"]),
                                        ("conduction_plate", "conduction", []), ("blankenbach_1a", "convection", []), ("sod", "shock", []),
                                        ("dam_break_front", "flow", [])]:
            with self.subTest(name):
                small = [] if program == "flow" else self.SMALL[:2] if program == "shock" else self.SMALL
                result = self.call("plan", INPUTS / f"{name}.nml", *small, *settings)
                said = self.figures(result)
                self.assertTrue(result.stdout.startswith(program + " "), result.stdout)
                self.assertEqual(list(said), ["particles", "dt", "steps", "a step", "run time", "memory", "snapshots"])
        self.assertEqual(self.listing(), before)

    def test_the_program_of_an_input(self):
        """By its groups, and by who chooses the walls."""
        said = self.call("plan", INPUTS / "contact.nml", "--set", "time.steps=5")
        self.assertTrue(said.stdout.startswith("disph_c "), said)
        self.assert_says(self.call("plan", INPUTS / "balance_blobs.nml"), BAD_INPUT, "balance, which takes no time steps")

    @unittest.skipUnless(SLOW, "slow")
    def test_every_input(self):
        for path in sorted(INPUTS.glob("*.nml")):
            with self.subTest(path.name):
                settings = [word for key, value in particles(path).items() for word in ("--set", f"{key}={value}")]
                result = self.call("plan", path, *settings)
                if path.name.startswith("balance_"):
                    self.assert_says(result, BAD_INPUT, "balance, which takes no time steps")
                elif result.status != BAD_INPUT:  # too few particles for a body
                    self.assertGreater(float(self.figures(result)["steps"].split()[0]), 0)

    def test_is_what_the_run_takes(self):
        """The number of steps and the size of a snapshot, against those of the run."""
        for fields in ([], ["--set", "output.fields='Density', 'Velocities'", "--set", "output.precision=single"]):
            words = [INPUTS / "rti_linear.nml", *self.SMALL, "--set", "time.t_end=60", "--set", "output.interval=20", *fields]
            said = self.figures(self.call("disph_c", *words, "--plan"))
            run = self.call("disph_c", *words, "--output", f"out_{len(fields)}")
            self.assertEqual(run.status, COMPLETED, run)
            summary = json.loads((self.here / f"out_{len(fields)}" / "summary.json").read_text())
            self.assertAlmostEqual(float(said["steps"].split()[0]) / summary["steps"], 1, delta=0.05)
            self.assertEqual(int(said["particles"].split()[0]), summary["fluid_particles"])
            files = sorted((self.here / f"out_{len(fields)}").glob("snapshot_*.h5"))
            self.assertEqual(int(said["snapshots"].split()[0]), len(files))
            with h5py.File(files[-1]) as file:
                size = sum(data.nbytes for group in ("PartType0", "PartType1") if group in file for data in file[group].values())
                size += sum(file[name].nbytes for name in ("Connectivity0", "Connectivity1") if name in file)
            value, unit = said["snapshots"].split("of ")[1].split(" each")[0].split()
            self.assertAlmostEqual(float(value) * {"kB": 1e3, "MB": 1e6}[unit] / size, 1, delta=0.01)

    def test_steps_that_change_on_the_way(self):
        """Metal that falls fast shortens the steps: the first ones say a third of their number. A tube begins with short ones."""
        (self.here / "temporary").mkdir()
        for program, name, settings in [("rti", "rti_note", {"domain.particles_x": 40, "domain.particles_y": 40, "time.t_end": 2500}),
                                        ("shock", "sod", {"domain.particles_x": 200})]:
            with self.subTest(name):
                words = [INPUTS / f"{name}.nml", *(word for key, value in settings.items() for word in ("--set", f"{key}={value}"))]
                said = self.figures(self.call(program, *words, "--plan", more={"TMPDIR": str(self.here / "temporary")}))
                self.assertIn("as dt changed with", said["steps"])
                steps = self.run_program(program, name, settings, name).summary["steps"]
                self.assertLess(abs(math.log(float(said["steps"].split()[0]) / steps)), math.log(1.5))
        self.assertEqual(list((self.here / "temporary").iterdir()), [])

    def test_a_start_that_settles(self):
        """Its steps are those of the run, and their time is a part of the run's."""
        settings = {"planet.particles": 300, "expert.settle": 1, "time.t_end": 2000, "output.interval": 0}
        words = [INPUTS / "planet_earth.nml", *(word for key, value in settings.items() for word in ("--set", f"{key}={value}"))]
        said = self.figures(self.call("planet", *words, "--plan"))
        run = self.run_program("planet", "planet_earth", settings)
        self.assertIn(f"settled: {said['settling'].split()[0]} steps of", (run.directory / "run.log").read_text())
        self.assertIn("how dt changes is not known", said["steps"])  # a planet of an eighth of the particles would be none
        self.assertLess(abs(math.log(float(said["steps"].split()[0]) / run.summary["steps"])), math.log(1.5))
        more = {"planet.particles": 1000, "expert.settle": 0, "time.t_end": 3000, "output.interval": 0}
        said = self.figures(self.call("planet", INPUTS / "planet_earth.nml", *(word for key, value in more.items() for word in ("--set", f"{key}={value}")), "--plan"))
        self.assertIn("as dt changed with 125 particles", said["steps"])
        self.assertLess(abs(math.log(float(said["steps"].split()[0]) / self.run_program("planet", "planet_earth", more).summary["steps"])), math.log(1.5))
        still = self.figures(self.call("planet", *words, "--set", "expert.settle=0", "--plan"))
        self.assertNotIn("settling", still)

    def test_ranks(self):
        said = self.figures(self.call("plan", INPUTS / "hydrostatic_12.nml", *self.SMALL, "--ranks", 2))
        self.assertIn("on 2 x ", said["a step"])

    def test_refusals(self):
        self.assert_says(self.call("plan", "none.nml"), BAD_INPUT, "none.nml")
        self.assert_says(self.call("plan", INPUTS / "sod.nml", "--program", "rtii"), BAD_INPUT, "rtii", "no program")
        self.assert_says(self.call("plan", INPUTS / "sod.nml", "--set", "time.dt=-1"), BAD_INPUT, "dt")
        self.assert_says(self.call("disph_c", INPUTS / "hydrostatic_12.nml", "--plan", "--restart", "latest"), BAD_INPUT, "--plan", "--restart")


class Relaxation(Plan):
    def test_table_2(self):
        for dT, zeta, c in ((1e-2, 10800, 3.47e-2), (1e-1, 4290, 8.72e-2), (1, 1710, 2.19e-1)):
            found, said = self.plan("relaxation", *AIR, "--dT", dT)
            self.assertAlmostEqual(found["recommended"]["zeta"] / zeta, 1, delta=0.003)
            self.assertAlmostEqual(found["recommended"]["c_eff_m_s"] / c, 1, delta=0.003)
            self.assertEqual(found["recommended"]["method"], "rsst")
            self.assertAlmostEqual(found["plan"]["steps"], 1e4, delta=1)
            self.assertIn("<- sets zeta", said)
        found, _ = self.plan("relaxation", *AIR, "--dT", 1e-2, "--set", "expert.boundary_layers=F")
        self.assertAlmostEqual(found["recommended"]["zeta"] / 4440, 1, delta=0.003)

    def test_table_4(self):
        for nu, zeta, xi, effective in ((2.5e19, 9.28, 1.16e11, 1857), (2.5e18, 13.6, 1.70e10, 8618),
                                        (2.5e17, 20, 2.5e9, 4e4)):
            found, said = self.plan("relaxation", "--nu", nu)
            self.assertAlmostEqual(found["recommended"]["zeta"] / zeta, 1, delta=0.003)
            self.assertAlmostEqual(found["recommended"]["xi"] / xi, 1, delta=0.003)
            self.assertAlmostEqual(found["recommended"]["Pr_eff"] / effective, 1, delta=0.003)
            self.assertEqual(found["plan"]["time_step"]["binding"], "momentum")
            self.assertAlmostEqual(found["plan"]["steps"], 8e5, delta=100)
            self.assertIn("<- binds", said)

    def test_a_namelist_says_the_same_as_options(self):
        (self.here / "air.nml").write_text(AIR_NML)
        by_file, _ = self.plan("relaxation", "air.nml")
        by_options, _ = self.plan("relaxation", *AIR, "--dT", 1)
        for part in ("given", "numbers", "speeds", "recommended"):
            for key, value in by_options[part].items():
                if isinstance(value, str):
                    self.assertEqual(by_file[part][key], value)
                else:
                    self.assertAlmostEqual(by_file[part][key] / value, 1, delta=1e-12, msg=key)
        changed, _ = self.plan("relaxation", "air.nml", "--set", "walls.temperature_bottom=310", "--n", 50)
        self.assertAlmostEqual(changed["numbers"]["Ra"], 1e7, delta=1e-3)
        self.assertEqual(changed["plan"]["particles"], 2500)

    def test_the_convection_program_s_own_input(self):
        """What the program will run with: its target, its Rayleigh number, its slowing."""
        (self.here / "mantle.nml").write_text(
            "&convection rayleigh = 1e5 target = 'steady' /\n&expert steady_mach = 2 thermal_left = 'flux' flux_left = 1e-3 /\n")
        found, said = self.plan("relaxation", "mantle.nml", "--n", 100)
        self.assertAlmostEqual(found["numbers"]["Ra"] / 1e5, 1, delta=1e-12)
        kappa_per_L = found["given"]["kappa_m2_s"] / found["given"]["L_m"]
        c = found["recommended"]["c_eff_m_s"] / kappa_per_L
        self.assertAlmostEqual(c / (1e5 ** (2 / 3) / 2), 1, delta=1e-9)
        # Waves of shear at 0.7 c_eff that relax over a roll's wave number, sqrt(2) pi/L, and what answers at once.
        self.assertAlmostEqual(found["recommended"]["Pr_eff"] / (0.7 * c / (math.sqrt(2) * math.pi) + 0.35 * c / 100), 1, delta=1e-9)
        # Where the viscosity varies it answers at once; the middle's sets the speed of sound.
        varies, _ = self.plan("relaxation", "mantle.nml", "--n", 100, "--set", "convection.viscosity_law=blankenbach_2a")
        faster = (1e5 * math.sqrt(1000)) ** (2 / 3) / 2
        self.assertAlmostEqual(varies["recommended"]["Pr_eff"] / (0.12 * faster / 100), 1, delta=1e-9)
        self.assertAlmostEqual(varies["plan"]["time_step"]["sound_s"] / found["plan"]["time_step"]["sound_s"], math.hypot(1, 0.7) * c / faster, delta=1e-9)
        self.assertIn("steady state", said)
        self.assertIn("0.001 W/m^2", said)

    def test_every_formula_binds_to_the_numbers(self):
        found, _ = self.plan("relaxation", *AIR, "--dT", 0.5)
        Ra, Pr, M = (found["numbers"][key] for key in ("Ra", "Pr", "M_th"))
        bounds = {rule["source"]: rule["bound"] for rule in found["rules"]}
        self.assertAlmostEqual(bounds["S1 (34)"] * (Ra * Pr) ** 0.4 * M, 1, delta=1e-12)
        self.assertAlmostEqual(bounds["S1 (40)"] * Ra ** (1 / 3) / math.sqrt(Pr), 1, delta=1e-12)
        self.assertEqual(len(found["rules"]), 16)

    def test_backwards_and_run_time(self):
        self.write_bench([bench_record("transport", 2, 10000, 1, 1e6), bench_record("transport", 2, 10000, 2, 2e6),
                          bench_record("transport", 2, 10**6, 2, 4e6), bench_record("program_c", 2, 10000, 2, 9e6),
                          bench_record("transport", 3, 10000, 2, 8e6)])
        found, said = self.plan("relaxation", "--steps", 1e5, "--run-time", "2h", "--method", "ab2")
        self.assertEqual(found["machine"]["updates_per_second"], 2e6)
        self.assertAlmostEqual(found["plan"]["run_time_s"], 8e5 * 1e4 / 2e6, delta=1)
        self.assertEqual(found["backwards"]["in_steps"]["n"], 35)  # 2 n^2/(0.1 * 0.25) <= 1e5
        n = found["backwards"]["in_run_time"]["n"]
        self.assertLessEqual(80 * n**4 / 2e6, 7200)
        self.assertGreater(80 * (n + 1)**4 / 2e6, 7200)
        self.assertIn("bench: transport 2-D, 10000 particles, threads 2", said)
        one, _ = self.plan("relaxation", "--threads", 1)
        self.assertEqual(one["machine"]["updates_per_second"], 1e6)
        large, _ = self.plan("relaxation", "--n", 1500)
        self.assertEqual(large["machine"]["updates_per_second"], 4e6)
        given, _ = self.plan("relaxation", "--rate", 5e6)
        self.assertEqual(given["machine"]["updates_per_second"], 5e6)

    def test_length_and_viscosity_backwards(self):
        # Slowed by the rules a turnover takes 2 n^2/(C phi_xi^2) steps, whatever L and the viscosity.
        found, said = self.plan("relaxation", "--steps", 1e5, "--rate", 1e6, "--seconds", 3600)
        self.assertIsNone(found["backwards"]["L_m"])
        self.assertIn("does not change the steps", said)
        # Not slowed, N = (L/V)/dt: what is given as the limit is just affordable, and a tenth less steps are not.
        free = ["relaxation", *AIR[2:], "--dT", 1, "--set", "expert.zeta=1", "--set", "expert.xi=1"]
        steps = self.plan(*free, "--L", 0.1)[0]["plan"]["steps"]
        span = self.plan(*free, "--L", 0.1, "--steps", 1.001 * steps)[0]["backwards"]["L_m"]
        edge = span["from"] if span["from"] is not None else span["to"]
        inside, _ = self.plan(*free, "--L", edge)
        self.assertLessEqual(inside["plan"]["steps"], 1.001 * steps)
        beyond, _ = self.plan(*free, "--L", edge / 10**0.05 if edge == span["from"] else edge * 10**0.05)
        self.assertGreater(beyond["plan"]["steps"], 1.001 * steps)

    def test_without_bench_no_run_time_is_invented(self):
        found, said = self.plan("relaxation")
        self.assertIsNone(found["plan"]["run_time_s"])
        self.assertIn("not known", said)
        self.assert_says(self.call("plan", "relaxation", "--run-time", "1h"), BAD_INPUT, "rate")

    def test_refusals(self):
        (self.here / "cold.nml").write_text("&walls temperature_bottom = 200\n temperature_top = 300 /\n")
        self.assert_says(self.call("plan", "relaxation", "cold.nml"), BAD_INPUT, "cold.nml:1", "hotter")
        (self.here / "typo.nml").write_text("&relaxtion zeta = 3 /\n")
        self.assert_says(self.call("plan", "relaxation", "typo.nml"), BAD_INPUT, "typo.nml:1", "&relaxation")
        self.assert_says(self.call("plan", "relaxation", "--set", "expert.zeta=0.5"), BAD_INPUT, "zeta", "in [1, ")
        self.assert_says(self.call("plan", "relaxation", "--nu", -1), BAD_INPUT, "--nu")
        self.assert_says(self.call("plan"), BAD_INPUT, "--help")
        self.assert_says(self.call("plan", "relaxation", "--bench", "none.json"), FILE_FAILED, "none.json")
        (self.here / "bad.json").write_text("{")
        self.assert_says(self.call("plan", "relaxation", "--bench", "bad.json"), FILE_FAILED, "bad.json")
        self.assert_says(self.call("plan", "relaxation", "--json", "no/where.json"), FILE_FAILED, "where.json")

    def test_describe_is_a_valid_input(self):
        described = self.call("plan", "relaxation", "--describe")
        self.assertEqual(described.status, COMPLETED, described)
        (self.here / "all.nml").write_text(described.stdout)
        (self.here / "empty.nml").write_text("&convection /\n")
        self.assertEqual(self.plan("relaxation", "all.nml")[0], self.plan("relaxation", "empty.nml")[0])


class Ocean(Case):
    def ocean(self, *words):
        path = self.here / "ocean.json"
        result = self.call("plan", "ocean", *words, "--json", path)
        self.assertEqual(result.status, 0, result)
        return json.loads(path.read_text()), result.stdout

    def test_depth(self):
        """Where the coefficients of Rubie et al. (2015) on the liquidus are those asked for, written out here; the depth is PREM's within a tenth."""
        found, said = self.ocean("--nickel", 30, "--cobalt", 20, "--iron-ratio", 12)
        for name, observed, (a, b, c) in [("nickel", 30, (1.06, 1553, -98)), ("cobalt", 20, (0.13, 2057, -57))]:
            p, T = found[name]["pressure_Pa"], found[name]["temperature_K"]
            self.assertAlmostEqual(T / (78.74 * (p / 4.054e6 + 1) ** (1 / 2.44)), 1, delta=1e-6)
            self.assertAlmostEqual(12 * 10 ** (a + (b + c * p * 1e-9) / T) / observed, 1, delta=1e-6)
        p, T = found["both"]["pressure_Pa"] * 1e-9, found["both"]["temperature_K"]
        self.assertAlmostEqual(12 * 10 ** (1.06 + (1553 - 98 * p) / T), 30, delta=1e-6)
        self.assertAlmostEqual(12 * 10 ** (0.13 + (2057 - 57 * p) / T), 20, delta=1e-6)
        found, said = self.ocean()
        for name, depth in [("nickel", 1117e3), ("cobalt", 816e3)]:  # of 44.0 and 30.4 GPa
            self.assertAlmostEqual(found[name]["depth_m"] / depth, 1, delta=0.1)
        self.assertIn("no melt", said)

    def test_none_and_refused(self):
        found, said = self.ocean("--nickel", 1e6)
        self.assertIsNone(found["nickel"]["pressure_Pa"])
        self.assertIn("none to 140", said)
        for words in (["--nickel", -1], ["--melt-fraction", 2], ["--composition", "basaltic"], ["--rock", "granite"]):
            with self.subTest(words=words):
                self.assertEqual(self.call("plan", "ocean", *words).status, BAD_INPUT)


class TwoLayers(Plan):
    """Slowed sound and inertia of an input of rti, by the growth rate of linear theory."""

    def of_box(self, L, viscosity, *more):
        settings = [f"domain.length_x={L}", f"domain.length_y={L}", f"rti.wavelength={L}", f"rti.amplitude={5e-4 * L}",
                    f"rti.viscosity_upper={viscosity}", f"rti.viscosity_lower={viscosity}"]
        return self.plan("relaxation", INPUTS / "rti_linear.nml", *(word for one in settings for word in ("--set", one)), *more)

    def test_two_numbers_rule_it(self):
        """The note's box and one of 1 km: dynamic pressure over K and share of inertia; what is recommended keeps to the error."""
        for L, viscosity, dynamic, gain in [(1.5e6, 1e14, 0.06, 100), (1e3, 1e10, 4e-5, 1000), (1e3, 1e6, 4e-5, 20)]:
            with self.subTest(L=L, viscosity=viscosity):
                said, text = self.of_box(L, viscosity)
                self.assertAlmostEqual(said["numbers"]["dynamic_pressure"] / dynamic, 1, delta=0.01)
                growth, k = said["numbers"]["growth_1_s"], 2 * math.pi / L
                self.assertAlmostEqual(said["numbers"]["inertia_share_lower"] / (growth * 3000 / (viscosity * k**2)), 1, delta=0.12)
                r = said["recommended"]
                self.assertLessEqual(abs(r["growth_error"]), 0.01)
                self.assertGreater(abs(r["growth_error_sound"]) + abs(r["growth_error_inertia"]), 0.0095)
                self.assertGreater(r["gain"], gain)
                self.assertIn("Recommended", text)

    def test_a_stabilised_method_has_no_step_of_viscosity(self):
        """Its stages take viscosity: what bounds its steps is sound, at any viscosity."""
        for method, bound in (("rk4", True), ("rkl2", False), ("rkc2", False)):
            said, text = self.of_box(1e4, 1e16, "--set", f"time.method={method}")
            r = said["recommended"]
            self.assertEqual(r["step_viscous_as_is_s"] is not None, bound)
            self.assertEqual("taken by stages" in text, not bound)
            self.assertEqual(r["step_as_is_s"] < 0.5 * r["step_sound_as_is_s"], bound)

    def test_unequal_viscosities(self):
        """The stiffer one is made the heavier: both then have the same viscosity over inertia."""
        r = self.of_box(1e5, 1e13, "--set", "rti.viscosity_lower=1e15")[0]["recommended"]
        self.assertAlmostEqual(r["xi_lower"] ** 2 * 3000 / 1e15 / (r["xi_upper"] ** 2 * 7000 / 1e13), 1, delta=0.01)

    def test_map(self):
        said = self.of_box(1e4, 1e10, "--map", 4)[0]
        zeta, xi, error = (said["map"][key] for key in ("zeta", "xi", "error"))
        self.assertEqual((zeta[0], xi[0], error[0][0]), (1, 1, 0))
        self.assertTrue(error[3][0] > 0.01 > -0.01 > error[0][3])

    def test_refused(self):
        self.assertEqual(self.call("plan", "relaxation", INPUTS / "rti_linear.nml", "--L", 1e3).status, BAD_INPUT)


class Timestep(Plan):
    def test_the_note(self):
        found, said = self.plan("timestep")
        plan = found["plan"]
        self.assertAlmostEqual(plan["eta_Pa_s"], 6e11, delta=1)
        self.assertAlmostEqual(plan["dt_sound_s"], 2, delta=1e-9)
        self.assertAlmostEqual(plan["V_m_s"], 70 / 3, delta=1e-9)  # the note's 20
        self.assertAlmostEqual(plan["tau_s"], 4.5e6 / 70, delta=1e-3)  # the note's 7e4
        self.assertAlmostEqual(plan["steps"], 2.25e6 / 70, delta=1e-3)
        self.assertAlmostEqual(plan["steps_of_20"], plan["steps"], delta=1e-6)
        self.assertIsNone(plan["dt_heat_s"])
        self.assertIn("<- binds", said)

    def test_backwards(self):
        self.write_bench([bench_record("program_c", 2, 10000, 1, 1e6)])
        found, _ = self.plan("timestep", "--steps", 1000, "--L", 1e6)
        self.assertEqual(found["backwards"]["n"], 10)  # the note's conclusion
        again, _ = self.plan("timestep", "--L", found["backwards"]["L_m"])
        self.assertAlmostEqual(again["plan"]["steps"], 1000, delta=1e-6)
        thin, _ = self.plan("timestep", "--L", 1e6, "--eta", found["backwards"]["eta_Pa_s"])
        self.assertAlmostEqual(thin["plan"]["steps"], 1000, delta=1e-6)
        timed, _ = self.plan("timestep", "--run-time", "60s")
        self.assertAlmostEqual(timed["plan"]["run_time_s"], timed["plan"]["steps"] * 5625 / 1e6, delta=1e-6)
        n = timed["backwards"]["n"]
        self.assertLessEqual(2.25e6 / 70 * (n / 75)**2 * n**2 / 1e6, 60)
        self.assertGreater(2.25e6 / 70 * ((n + 1) / 75)**2 * (n + 1)**2 / 1e6, 60)

    def test_beside_a_run(self):
        ran = self.run_program("rti", "rti_linear", {"domain.particles_x": 16, "domain.particles_y": 16, "time.steps": 20,
                                                      "output.history_interval": 5})
        found, said = self.plan("timestep", "--run", ran.directory)
        plan, measured = found["plan"], found["measured"]
        self.assertEqual((found["given"]["n"], found["given"]["eta_Pa_s"], found["given"]["delta_rho_kg_m3"]), (16, 6e11, 4000))
        self.assertAlmostEqual(found["given"]["c_m_s"], math.sqrt(5e11 / 3000), delta=1e-6)
        self.assertAlmostEqual(plan["dt_sound_s"], 1.5e6 / 16 / math.sqrt(5e11 / 3000), delta=1e-9)
        header, rows = ran.rows()
        fall = [float(row[header.index("fall_velocity [m/s]")]) for row in rows]
        self.assertEqual(measured["V_m_s"], max(fall))
        self.assertEqual(measured["steps"], 20)
        self.assertAlmostEqual(measured["dt_s"], ran.summary["time"] / 20, delta=1e-9)
        self.assertIsNone(measured["tau_s"])  # the linear stage does not get that far
        self.assertEqual(found["note"], {"V_m_s": 20, "tau_s": 7e4, "dt_s": 2, "steps": 5e3})
        self.assertIn("not reached", said)
        other, _ = self.plan("timestep", "--run", ran.directory, "--c", 1e4)
        self.assertEqual(other["given"]["c_m_s"], 1e4)
        (ran.directory / "history.csv").write_text("step [1],time [s]\n0\n")
        self.assert_says(self.call("plan", "timestep", "--run", ran.directory), FILE_FAILED, "history.csv:2")
        self.assert_says(self.call("plan", "timestep", "--run", self.here), FILE_FAILED, "summary.json")

    def test_refusals(self):
        self.assert_says(self.call("plan", "timestep", "--n", 0), BAD_INPUT, "--n")
        self.assert_says(self.call("plan", "timestep", "--run-time", "60s"), BAD_INPUT, "rate")


if __name__ == "__main__":
    unittest.main()
