"""What a restart may change: each key of each program, changed, takes effect or is refused by name; and what it may not:
summaries and counts are those of the run that was not interrupted."""

import dataclasses
import json
import re
import shutil
import unittest

import h5py

from running import BAD_INPUT, COMPLETED, INPUTS, INTERRUPTED, SLOW, Case, Result
from test_ranks import SHEARED

LATEST = ["--restart", "latest"]
SMALL = {"domain.particles_x": 16, "domain.particles_y": 16}
WATER = {"domain.length_x": 0.84, "domain.length_y": 0.6, "domain.particles_x": 42, "domain.particles_y": 30, "flow.high_x": 0.2,
         "flow.high_y": 0.4, "walls.slip_top": "free_surface"}
AT_REST = {**SHEARED[1], "time.steps": 12}


def water(more):
    return "flow", "empty", {**WATER, "time.t_end": 1.0, **more}


# Program, input, settings: of a few steps.
CASES = {
    "a": ("disph_a", SHEARED[0], {**AT_REST, "time.steps": 6}),
    "a_order_3": ("disph_a", SHEARED[0], {**AT_REST, "time.method": "order_3", "time.steps": 6}),
    "f": ("disph_f", SHEARED[0], AT_REST),
    "f_adaptive": ("disph_f", SHEARED[0], {**AT_REST, "time.method": "adaptive", "time.rtol": 1e-5, "time.t_end": 6}),
    "rti": ("rti", "rti_note", {**SMALL, "time.steps": 12}),
    "rti_order_3": ("rti", "rti_note", {**SMALL, "time.steps": 12, "time.method": "order_3"}),
    "drop": ("drop", "drop_emulsion", {"domain.particles_x": 32, "domain.particles_y": 48, "time.steps": 12}),
    "conduction": ("conduction", "conduction_plate", {"conduction.operator": "corrected", "domain.jitter": 0.1, "time.steps": 12}),
    "mantle": ("convection", "blankenbach_1a", {**SMALL, "time.steps": 12}),
    "air_ab2": ("convection", "air_1e4", {**SMALL, "time.steps": 12, "time.method": "ab2"}),
    "air_rkl2": ("convection", "air_1e4", {**SMALL, "time.steps": 12, "time.method": "rkl2"}),
    "shock": ("shock", "sod", {"domain.particles_x": 100, "time.steps": 12}),
    "flow": water({"time.steps": 12, "gauges.front": ".true."}),
}
# Each program with an input of its own, and a scheme with those of others.
OF_PROGRAMS = ["f", "rti", "drop", "conduction", "mantle", "shock", "flow"]

# Of what the clock says, or other ranks.
OF_THE_CLOCK = {"wall_seconds", "stepping_seconds", "particle_updates_per_second", "stages"}
OF_RANKS = ("time_spread", "waiting_seconds", "balance_seconds", "collectives_per_step", "halo_", "migration_bytes")


def told(summary):
    kept = {name: value for name, value in summary.items() if name not in OF_THE_CLOCK}
    return kept | {"metrics": {name: value for name, value in summary["metrics"].items() if not name.startswith(OF_RANKS)}}


@dataclasses.dataclass
class Key:
    name: str       # "time.dt"
    facts: str      # "real [s], > 0, default none; a restart may change it"
    now: str = ""   # in a resolved input

    @property
    def may_change(self):
        return self.facts.endswith("a restart may change it")

    def changed(self):
        """Another value that is allowed by itself."""
        kind = self.facts.split(",")[0].split(" [")[0]
        if self.name == "output.fields":
            return "'Density'"
        if kind == "logical":
            return ".false." if self.now == ".true." else ".true."
        choices = re.findall(r"'([^']*)'", self.facts.split(", default")[0]) if "one of" in self.facts else []
        if kind.startswith("list of"):
            return f"'{choices[0]}'" if choices else "'x'" if kind.endswith("texts") else "0.25" if "reals" in kind else "1"
        if kind == "text":
            return f"'{next((c for c in choices if c != self.now.strip(chr(39))), 'x')}'" if choices else "'other.csv'"
        number = float(self.now or 0)
        if self.name == "time.t_end" and not number:
            return "1000"
        highest = re.search(r", (-?[\d.e+-]+)\]", self.facts.split(", default")[0])
        if highest and number * 1.01 + (kind == "integer") > float(highest[1]):
            return str(int(number) - 1) if kind == "integer" else repr(number * 0.99)
        lowest = re.search(r"(?:>=?|\[|\() ?(-?[\d.e+-]+)", self.facts.split(", default")[0].partition(",")[2])
        if kind == "integer":
            return str(int(number) + 1)
        return repr(number * 1.01 if number else (float(lowest[1]) if lowest else 0.0) + 0.25)


def keys_in(described):
    found, group, facts = [], "", ""
    for line in described.splitlines():
        if start := re.match(r"&(\w+)", line):
            group = start[1]
        elif line.startswith("  ! "):
            facts = line[4:]
        elif given := re.match(r"  (\w+) =", line):
            found.append(Key(f"{group}.{given[1]}", facts))
    return found


def values_in(resolved):
    found, group = {}, ""
    for line in resolved.splitlines():
        if line.startswith("&"):
            group = line[1:].strip()
        elif given := re.match(r"  (\w+) = ?(?:! ?)?(.*)", line):
            found[f"{group}.{given[1]}"] = given[2].strip()
    return found


class Rules(Case):
    def setUp(self):
        super().setUp()
        (self.here / "empty.nml").write_text("&flow high_y = 0.4 /\n")

    def start(self, label, output, **more):
        program, name, settings = CASES[label]
        source = self.here / "empty.nml" if name == "empty" else name
        return self.run_program(program, source, {**settings, "output.history_interval": 3, **more}, output)

    def go_on(self, label, output, settings=None, options=(), expect=COMPLETED):
        words = [word for key, value in (settings or {}).items() for word in ("--set", f"{key}={value}")]
        result = self.call(CASES[label][0], *LATEST, "--output", output, *words, *options, directory=self.here / output)
        self.assertEqual(result.status, expect, (settings, result))
        return result


class EveryKey(Rules):
    """Without a step: --check compares with the checkpoint, too."""

    def check_keys(self, label):
        program = CASES[label][0]
        run = self.start(label, "out", **{"time.steps": 3})
        now = values_in((run.directory / "resolved.nml").read_text())
        keys = keys_in(self.call(program, run.directory / "resolved.nml", "--describe").stdout)
        self.assertEqual(len(keys), len(now))
        described = {key.name for key in keys if key.may_change}
        if not SLOW:  # one declaration, one rule: keys that programs share are tried in the first of them
            earlier = OF_PROGRAMS[:OF_PROGRAMS.index(label)]
            shared = {(key.name, key.facts) for other in earlier for key in keys_in(self.call(CASES[other][0], "--describe").stdout)}
            keys = [key for key in keys if (key.name, key.facts) not in shared]
        by_name = 0
        unchanged = values_in(self.go_on(label, "out", {}, ["--check"]).stdout)
        for key in keys:
            key.now = now[key.name]
            with self.subTest(program=program, key=key.name, value=key.changed()):
                if key.may_change:
                    end = {"time.t_end": now["time.t_end"] or "1000"} if key.name == "time.dt" else {}
                    words = [word for name, value in {**end, key.name: key.changed()}.items() for word in ("--set", f"{name}={value}")]
                    changed = self.call(program, *LATEST, "--output", "out", *words, "--check", directory=self.here / "out")
                    if changed.status == BAD_INPUT:  # too many snapshots, say
                        self.assertIn("&{} {}".format(*key.name.split(".")), changed.stderr)
                    else:
                        self.assertNotEqual(values_in(changed.stdout)[key.name], key.now)
                    continue
                words = ["--set", f"{key.name}={key.changed()}", "--check"]
                refused = self.call(program, *LATEST, "--output", "out", *words, directory=self.here / "out")
                if refused.status == COMPLETED:  # such as a column's profile without gravity: what is run is the same
                    self.assertEqual(values_in(refused.stdout), unchanged)
                    continue
                self.assertEqual(refused.status, BAD_INPUT, refused)
                group, name = key.name.split(".")
                self.assertRegex(refused.stderr, r"&\w+ \w+")
                if "a restart cannot change it" in refused.stderr:
                    self.assertIn(f"--set {key.name}=", refused.stderr)
                    self.assertIn(f": &{group} {name} = ", refused.stderr)
                    self.assertIn("&time method", refused.stderr)
                    by_name += 1
        # Others do not go with the rest of the input; one key alone is no region.
        alone = [key for key in keys if not key.may_change and not key.name.startswith("region.")]
        self.assertGreater(by_name, 0.25 * len(alone))
        self.assertEqual({name.split(".")[0] for name in described} - {"expert", "domain", "initial"}, {"time", "output", "run"})
        self.assertIn("completed 3 steps", self.go_on(label, "out").stdout)

    def test_at_rest(self):
        self.check_keys("f")

    def test_layers_and_drops(self):
        self.check_keys("rti")
        shutil.rmtree(self.here / "out")
        self.check_keys("drop")

    def test_heat(self):
        self.check_keys("conduction")
        shutil.rmtree(self.here / "out")
        self.check_keys("mantle")

    def test_gas(self):
        self.check_keys("shock")

    def test_water(self):
        self.check_keys("flow")


class Taken(Rules):
    """What may change does."""

    def test_steps_of_every_program(self):
        """cfl and diffusive scale the step, as in a run that had them from the start; dt is it; a method has its evaluations."""
        for label in ["f", "rti", "drop", "conduction", "mantle", "flow"]:
            program, _, settings = CASES[label]
            whole = self.start(label, label, **{"output.interval": 0}).summary
            first = self.start(label, f"{label}_first", **{"output.interval": 0, "time.steps": 1}).summary
            changes = [{"time.dt": whole["last_dt"] / 3}, {"time.method": "order_2"}]
            if label in ("rti", "mantle", "flow"):
                changes.append({"time.cfl": 0.01})
            if label == "conduction":
                changes.append({"expert.time_diffusive": 0.001})
            for change in changes:
                with self.subTest(program, change=change):
                    output = f"{label}_again"
                    for used in (output, f"{label}_fresh"):
                        shutil.rmtree(self.here / used, ignore_errors=True)
                    shutil.copytree(self.here / label, self.here / output)
                    more = {**change, "time.steps": whole["steps"] + 1, "time.t_end": 100 * whole["time"]}
                    again = self.go_on(label, output, more).summary
                    fresh = self.start(label, f"{label}_fresh", **{**change, "time.steps": 1}).summary
                    self.assertEqual(again["steps"], whole["steps"] + 1)
                    if not {"time.dt", "time.method"} & change.keys():  # what a step may be changes on the way, with the flow
                        as_fresh = again["last_dt"] / fresh["last_dt"]
                        as_much_shorter = as_fresh * first["last_dt"] / whole["last_dt"]
                        self.assertLess(min(abs(as_fresh - 1), abs(as_much_shorter - 1)), 0.1)
                    if "time.dt" in change:
                        self.assertAlmostEqual(again["last_dt"] / change["time.dt"], 1, delta=1e-9)
                    elif "time.method" in change:
                        self.assertIn(again["rhs_evaluations"] - whole["rhs_evaluations"], (2, 3))
                    else:
                        self.assertLess(again["last_dt"], 0.2 * whole["last_dt"])

    def test_all_of_a_run(self):
        """Whatever a restart may change has an effect that is seen; those of the balancer and of ranks decide who works, and of a
        start's file it is the path alone."""
        self.start("flow", "out", **{"output.history_interval": 3})
        described = [key.name for key in keys_in(self.call("flow", "--describe").stdout) if key.may_change]
        observed = {
            "time.method": ("'euler'", lambda r: r.summary["rhs_evaluations"] < 4 * 18),
            "time.dt": ("1e-4", lambda r: abs(r.summary["last_dt"] - 1e-4) < 1e-9),
            "time.steps": ("14", lambda r: r.summary["steps"] == 14),
            "time.t_end": ("0.012", lambda r: r.summary["time"] == 0.012),
            "time.cfl": ("0.1", lambda r: r.summary["last_dt"] < 2e-4),
            "expert.time_diffusive": ("1e-4", lambda r: r.summary["last_dt"] < 2e-4),
            "time.rtol": ("1e-9", lambda r: r.summary["rejections"] > 0 or r.summary["last_dt"] < 6e-4),
            "expert.time_order": ("5", lambda r: r.summary["rhs_evaluations"] > 4 * 12 + 6 * 6),
            "output.interval": ("1e-3", lambda r: len(list(r.directory.glob("snapshot_*.h5"))) > 3),
            "output.history_interval": ("1", lambda r: len(r.rows()[1]) > 10),
            "output.fields": ("'Density'", lambda r: "Pressure" not in self.last_snapshot(r)),
            "output.precision": ("'single'", lambda r: self.last_snapshot(r)["Density"].dtype == "float32"),
            "output.compress": (".true.", lambda r: self.last_snapshot(r)["Density"].compression == "gzip"),
            "run.wall_clock_limit": ("1e-6", lambda r: r.status == INTERRUPTED),
            "run.checkpoint_interval": ("2", lambda r: (r.directory / "run.log").read_text().count("checkpoint ") > 3),
            "run.checkpoint_seconds": ("1e-9", lambda r: (r.directory / "run.log").read_text().count("checkpoint ") > 3),
        }
        unseen = {name for name in described if name not in observed and not re.match(r"expert\.balancer_|domain\.(ranks_x|balance)$|initial\.file$", name)}
        self.assertEqual(unseen, set())
        for name, (value, seen) in observed.items():
            with self.subTest(name):
                shutil.rmtree(self.here / "again", ignore_errors=True)
                shutil.copytree(self.here / "out", self.here / "again")
                settings = {"time.steps": 18, name: value}
                if name in ("time.rtol", "expert.time_order"):
                    settings["time.method"] = "'adaptive'"
                words = [word for key, text in settings.items() for word in ("--set", f"{key}={text}")]
                done = self.call("flow", *LATEST, "--output", "again", *words, directory=self.here / "again")
                self.assertIn(done.status, (COMPLETED, INTERRUPTED), done)
                self.assertTrue(seen(done), done)

    def last_snapshot(self, result):
        file = h5py.File(sorted(result.directory.glob("snapshot_*.h5"))[-1])
        self.addCleanup(file.close)
        return file["PartType0"]

    def test_fresh_run_of_the_changed_input(self):
        """As many steps behind the restart as a run with the smaller steps takes."""
        program, _, _ = CASES["flow"]
        settings = {"time.t_end": 0.02, "time.steps": 100000}
        first = self.start("flow", "out", **settings).summary["steps"]
        again = self.go_on("flow", "out", {"time.t_end": 0.04, "time.cfl": 0.2}).summary
        fresh = self.start("flow", "fresh", **{**settings, "time.t_end": 0.02, "time.cfl": 0.2}).summary
        self.assertAlmostEqual((again["steps"] - first) / fresh["steps"], 1, delta=0.1)

    def test_an_end_before_the_checkpoint(self):
        self.start("flow", "out")
        before = self.listing()
        for change, key in [({"time.steps": 5}, "steps"), ({"time.t_end": 1e-5}, "t_end")]:
            for options in ([], ["--check"]):
                refused = self.go_on("flow", "out", change, options, expect=BAD_INPUT)
                self.assertRegex(refused.stderr, rf"--set time.{key}=\S+: &time {key}: expected no less than .*, where the checkpoint stands")
        self.assertEqual(self.listing(), before)


class Same(Rules):
    """The same summary, tables and counts: of a complete run that is restarted, and of one that was complete on the way."""

    def assert_same(self, whole, again):
        self.assertEqual(told(again.summary), told(whole.summary))
        for table in ["history.csv", "residuals.csv", "gauges.csv"]:
            texts = [(r.directory / table).read_text() if (r.directory / table).exists() else None for r in (whole, again)]
            self.assertEqual(*texts, table)

    def test_every_program(self):
        for label, (program, _, settings) in CASES.items():
            with self.subTest(label):
                whole = self.start(label, label)
                part = f"{label}_part"
                self.start(label, part, **{"time.steps": settings["time.steps"] // 2 + 1})
                self.assert_same(whole, self.go_on(label, part, {"time.steps": settings["time.steps"]}))
                shutil.copytree(whole.directory, self.here / "kept")
                kept = Result(0, "", "", self.here / "kept")
                self.assert_same(kept, self.go_on(label, label))
                shutil.rmtree(self.here / "kept")


class Ends(Rules):
    """Without t_end a run is of so many steps of a given length: in every program."""

    def test_steps_and_dt(self):
        for label in OF_PROGRAMS:
            program, _, settings = CASES[label]
            with self.subTest(program):
                name = CASES[label][1]
                source = self.here / "empty.nml" if name == "empty" else INPUTS / f"{name}.nml"
                text = re.sub(r"\bt_end *= *\S+", "", source.read_text())
                (self.here / "case.nml").write_text(text)
                settings = {key: value for key, value in settings.items() if key not in ("time.t_end", "time.method")}
                dt = {"mantle": 1e10, "shock": 1e-4, "flow": 1e-4, "drop": 1e-3}.get(label, 0.05)
                settings |= {"time.dt": dt, "time.steps": 4, "time.method": "euler", "output.interval": 0}
                if label == "drop":
                    settings |= {"drop.measure_from": 0, "drop.measure_until": 1e-3}
                done = self.run_program(program, self.here / "case.nml", settings, label).summary
                self.assertEqual(done["steps"], 4)
                self.assertAlmostEqual(done["time"] / (4 * dt), 1, delta=1e-9)
                again = self.call(program, *LATEST, "--output", label, "--set", "time.steps=6", directory=self.here / label)
                self.assertAlmostEqual(again.summary["time"] / (6 * dt), 1, delta=1e-9)

    def test_neither(self):
        (self.here / "case.nml").write_text("&flow high_y = 0.4 /\n&walls slip_top = 'free_surface' /\n&time steps = 5 /\n")
        self.assert_says(self.call("flow", "case.nml", "--check"), BAD_INPUT, "&time t_end: must be given, or else steps and dt")


if __name__ == "__main__":
    unittest.main()
