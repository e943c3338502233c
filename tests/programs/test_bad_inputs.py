"""Inputs that nobody should give, drawn at random but the same in every run: extreme, missing and mistaken values,
boxes of a few particles, broken files, odd command lines. No program may crash or hang, leave something behind where it
refuses its input, refuse it without saying where, or call a run completed whose numbers are not finite.

    TETSUAME_BAD_INPUTS=500   so many for each program (else a few)
    TETSUAME_BAD_SEED=7       another draw
    TETSUAME_BAD_PROGRAMS=rti,drop
"""

import concurrent.futures
import dataclasses
import json
import math
import os
import pathlib
import random
import re
import resource
import shutil
import signal
import subprocess
import tempfile
import threading
import unittest

from running import BAD_INPUT, CALCULATION_FAILED, COMPLETED, FILE_FAILED, INPUTS, INTERRUPTED, PROGRAMS, ZOLTAN, environment

EACH = int(os.environ.get("TETSUAME_BAD_INPUTS", 9))
SEED = int(os.environ.get("TETSUAME_BAD_SEED", 1))
MEMORY = 4 << 30  # bytes of address space
CPU_S = 5         # of computing: on a busy machine the clock says little
WALL_S = 90

SMALL = {"domain.particles_x": 12, "domain.particles_y": 12}
# The shipped inputs that a program is shown, and what makes them small.
CASES = {
    **{f"disph_{letter}": [("hydrostatic_11", {}), ("hydrostatic_13", {"hosono.solver": "newton"}),
                           ("hydrostatic_13_linear", {}), ("hydrostatic_column", {})] for letter in "abcdef"},
    **{scheme: [(name, SMALL) for name in ("rti_linear", "drop_cylinder", "conduction_plate", "pond_on_mantle")] + [("hydrostatic_13", {})]
       for scheme in ("disph_y", "disph_n", "ssph")},
    "rti": [(name, SMALL) for name in ("rti_note", "rti_linear", "rti_van_keken", "rti_poster", "pond_on_mantle")],
    "drop": [("drop_cylinder", SMALL), ("drop_emulsion", {"domain.particles_x": 16, "domain.particles_y": 24}),
             ("partitioning", SMALL), ("drop_surface_tension", {}), ("drop_sphere", {**SMALL, "domain.particles_z": 12})],
    "conduction": [("conduction_plate", SMALL), ("conduction_half_space", {})],
    "convection": [(name, SMALL) for name in ("air_1e4", "blankenbach_1a", "blankenbach_2b", "rayleigh_benard",
                                              "super_earth", "melting_layer", "square_pr1")],
    "shock": [("sod", {"domain.particles_x": 40}), ("strong", {"domain.particles_x": 40}), ("blasts", {"domain.particles_x": 40}),
              ("square", {"domain.particles_x": 16, "domain.particles_y": 16}), ("gresho", {"domain.particles_x": 16, "domain.particles_y": 16}),
              ("kelvin_helmholtz", {"domain.particles_x": 16, "domain.particles_y": 16}), ("iron_silicate", {"domain.particles_x": 40}),
              ("melts_shock", {"domain.particles_x": 40}), ("noh", {}), ("rayleigh_taylor", {}), ("iron_over_silicate", {}),
              ("impact_2d", {})],
    "flow": [("still_water", {"domain.particles_x": 10, "domain.particles_y": 12}),
             ("still_wedge", {"domain.particles_x": 20, "domain.particles_y": 12}),
             ("dam_break_front", {"gauges.file": "''", "gauges.front_column": "''"}),
             ("standing_wave", {"domain.particles_x": 20, "domain.particles_y": 12}),
             ("elliptical_drop", {"domain.particles_x": 22, "domain.particles_y": 22}),
             ("oscillating_drop", {"domain.particles_x": 24, "domain.particles_y": 24})],
    "balance": [(name, {"distribution.particles": 2000, "machine.ranks": 8, **({} if ZOLTAN else {"compare.methods": "none"})}) for name in ("balance_bowl", "balance_blobs", "balance_slow_half")],
    "plan": [("air_1e4", {}), ("blankenbach_1a", {}), ("rayleigh_benard", {}), ("super_earth", {})],
    "submit": [("hydrostatic_11", {}), ("rti_note", {}), ("sod", {})],
}
# Whatever else an input says, it is to be short.
SHORT = {"balance": {"schedule.updates": 3, "schedule.steps": 10}, "plan": {}, "submit": {}}
SHORT_RUN = {"time.steps": 3}

REALS = ["0", "-0.0", "-1", "1", "1e-300", "5e-324", "1e300", "1e308", "-1e300", "nan", "inf", "-Infinity", "1e999", "'x'", "", "1,2",
         "2*3", ".true.", "1.5d0", "1e-12", "1e12", "0.1", "3"]
INTEGERS = ["0", "-1", "1", "2", "3", "5", "2147483648", "9223372036854775807", "9223372036854775808", "1000000", "1000000000000",
            "3.5", "nan", "'x'", "", "1e3", "-9223372036854775808"]
LOGICALS = [".true.", ".false.", "T", "maybe", "1", "", "'T'"]
TEXTS = ["''", "'x'", "'" + "a" * 300 + "'", "1", "", "'../../etc'", "nothing", "'\u00e9\u00df'"]
JUNK = [b"\x00\x01\x02\xff", b"&", b"/", b"&domain /", b"'", b"\xef\xbb\xbf", b"$end", b"&time dt = 1e-3 /", b"! \xff", b"=", b",,", b"(1:2)",
        b"1000000000*0", b"&x\n y = 1\n/"]
JOB_TEXTS = ["", "x", "0", "-1", "1", "99999999999", "nan", "01:00:00", "1:0:0", "99:99:99", "0000:00:00", "a\nb", "a b", "$(x)", "'", "/", "\u00e9", "slurm",
             "pjm", "pbs", "nqsv", "ahead", "self", "4", "x" * 500]
JOB_OPTIONS = ["--ranks", "--threads", "--nodes", "--time", "--margin", "--queue", "--account", "--group", "--name", "--set", "--before", "--directive",
               "--launcher", "--max-jobs", "--chain", "--scheduler"]
PLAN_OPTIONS = {"relaxation": ["--L", "--dT", "--rho", "--kappa", "--nu", "--g", "--alpha", "--c-p", "--K", "--n", "--fraction", "--steps", "--run-time",
                               "--method", "--rate", "--threads", "--case"],
                "timestep": ["--n", "--L", "--c", "--rho-min", "--delta-rho", "--g", "--eta", "--c-p", "--k", "--dimension", "--steps", "--run-time",
                             "--method", "--rate", "--threads"]}

# "file:7: …", "--set time.dt=-1: …", "--L: …": where a mistake is.
PLACED = re.compile(r"\S+\.nml(:\d+)?: |--set \S+|--[a-zA-Z-]+|default value: |[A-Z]+\b.*required|argument \d+|program .* is no program")
FAULTS = re.compile(rb"\b-?(nan|inf)\b", re.IGNORECASE)


@dataclasses.dataclass
class Key:
    name: str  # "time.dt"
    kind: str  # "real", "integer", …
    choices: list
    default: str


def keys_of(program):
    """What --describe says there is to be given."""
    words = ["plan", "relaxation"] if program == "plan" else [program]
    said = subprocess.run([PROGRAMS / words[0], *words[1:], "--describe"], env=environment(alone=True), capture_output=True, text=True, timeout=60).stdout
    found, group, facts = [], "", ""
    for line in said.splitlines():
        if start := re.match(r"&(\w+)", line):
            group = start[1]
        elif line.startswith("  ! "):
            facts = line[4:]
        elif given := re.match(r"  (\w+) =\s*(.*)", line):
            choices = re.findall(r"'([^']*)'", facts.split(", default")[0]) if "one of" in facts else []
            kind = next(k for k in ("list", "real", "integer", "logical", "text") if k in facts.split(",")[0].split("[")[0])
            found.append(Key(f"{group}.{given[1]}", kind, choices, given[2]))
    return found


def odd_value(draw, key):
    if key.choices and draw.random() < 0.9:
        return f"'{draw.choice(key.choices)}'"
    if draw.random() < 0.4:
        plain = {"logical": [".true.", ".false."], "integer": ["0", "1", "2", "3", "4", "7", "16"], "real": ["0", "1e-3", "0.1", "0.5", "1", "2", "10", "1e5"]}
        if key.kind in plain:
            return draw.choice(plain[key.kind])
    pool = {"real": REALS, "integer": INTEGERS, "logical": LOGICALS, "text": TEXTS, "list": REALS + TEXTS}[key.kind]
    number = re.fullmatch(r"-?[\d.]+(e[+-]?\d+)?", key.default)
    if key.kind == "real" and number and draw.random() < 0.7:
        return repr(float(key.default) * draw.choice([10.0**k for k in (-200, -30, -9, -3, -1, 1, 3, 9, 30, 200)] + [0.5, 0.99, 1.01, 2.0, 3.0]))
    return draw.choice(pool)


def tiny_box(draw):
    n = draw.choice([1, 1, 2, 3, 3, 4, 5, 8])
    sizes = {f"domain.particles_{axis}": n for axis in "xyz"}
    sizes.update({f"domain.length_{axis}": draw.choice(["1", "1e5", "1e-3"]) for axis in "x"})
    sizes.update({f"domain.length_{axis}": sizes["domain.length_x"] for axis in "yz"})
    if draw.random() < 0.2:
        sizes["domain.dimension"] = 3
    return sizes


def other_numbers(draw, text):
    """The input with some of its numbers changed."""
    numbers = list(re.finditer(rb"(?<==)\s*(-?(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d+)?)(?![\w.*'])", text))
    for found in sorted(draw.sample(numbers, min(len(numbers), draw.randrange(1, 4))), key=lambda m: -m.start()):
        value = float(found[1].lower().replace(b"d", b"e"))
        new = draw.choice([repr(value * 10.0 ** draw.choice([-9, -3, -1, 1, 3, 9, 100])), repr(-value), "0", str(int(min(value, 1e9)) + 1), repr(0.5 * value)])
        text = text[:found.start(1)] + new.encode() + text[found.end(1):]
    return text


def broken(draw, text):
    """The bytes of a file after an accident."""
    way = draw.randrange(8)
    at = draw.randrange(len(text) + 1)
    if way == 0:
        return text[:at]
    if way == 1:
        return text[:at] + draw.choice(JUNK) + text[at:]
    if way == 2:
        return bytes(draw.randrange(256) for _ in range(draw.randrange(400)))
    if way == 3:
        return draw.choice([b"", b" \n\t\n", b"! nothing but a remark\n", b"\x7fELF\x02\x01", b"&", b"&time", b"/"])
    if way == 4:
        lines = text.splitlines(keepends=True)
        del lines[draw.randrange(len(lines))]
        return b"".join(lines)
    if way == 5:
        return text + text
    if way == 6:
        flipped = bytearray(text)
        for _ in range(draw.randrange(1, 5)):
            flipped[draw.randrange(len(flipped))] ^= 1 << draw.randrange(8)
        return bytes(flipped)
    words = re.findall(rb"[\w.+-]+", text)
    return text.replace(draw.choice(words), draw.choice([b"nan", b"1e308", b"0", b"-1", b"x", b"''"]), 1)


@dataclasses.dataclass
class Trial:
    program: str
    text: bytes   # of in.nml
    words: list   # of the command line, behind the program
    output: str = "out"


def settings_of(draw, program, keys, small):
    settings = dict(small)
    if draw.random() < 0.15 and program not in ("balance", "plan", "submit"):
        settings.update(tiny_box(draw))
    for _ in range(draw.choice([0, 1, 1, 1, 2, 3])):
        key = draw.choice(keys)
        settings[key.name] = odd_value(draw, key)
    return {**settings, **SHORT.get(program, SHORT_RUN)}


def trial(program, number, keys):
    draw = random.Random(f"{program} {SEED} {number}")
    name, small = draw.choice(CASES[program])
    text = (INPUTS / f"{name}.nml").read_bytes()
    way = draw.random()
    if way < 0.15:
        text = broken(draw, text)
    elif way < 0.4:
        text = other_numbers(draw, text)
    settings = settings_of(draw, program, keys, small)
    words = ["in.nml"] + [word for key, value in settings.items() for word in ("--set", f"{key}={value}")]
    if program == "plan":
        question = draw.choice(["relaxation", "relaxation", "timestep"])
        options = [word for _ in range(draw.randrange(4)) for word in
                   (draw.choice(PLAN_OPTIONS[question]), draw.choice(REALS + INTEGERS + ["rk4", "euler"]).strip("'") or "x")]
        return Trial("plan", text, [question, *(words if question == "relaxation" else []), *options, "--json", "plan.json"], "plan.json")
    if program == "submit":
        runs = {"hydrostatic_11": "disph_c", "rti_note": "rti", "sod": "shock"}[name]
        words = ["in.nml"] if draw.random() < 0.7 else words
        options = [word for _ in range(draw.choice([0, 1, 1, 2])) for word in (draw.choice(JOB_OPTIONS), draw.choice(JOB_TEXTS))]
        return Trial("submit", text, [draw.choice([runs, runs, runs, "nothing", ".", "bench"]), *words, "--scheduler", "slurm", "--time", "00:10:00",
                                      "--output", "out", *options])
    if draw.random() < 0.1:
        words.append(draw.choice(["--check", "--nothing", "--restart", "--force"]))
    if draw.random() < 0.1 and program in ("rti", "drop"):
        words.append("--theory")
    return Trial(program, text, [*words, "--output", "out"])


def limit():
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def carried_out(one, here):
    """The exit status (negative: a signal), seconds of computing, and what was said."""
    (here / "in.nml").write_bytes(one.text)
    words = [w.encode("utf-8", "surrogateescape").replace(b"\0", b"") for w in map(str, [PROGRAMS / one.program, *one.words])]
    with open(here / "said", "wb") as said:
        child = subprocess.Popen(words, cwd=here, env=environment(alone=True), stdin=subprocess.DEVNULL, stdout=said, stderr=subprocess.STDOUT, preexec_fn=limit,
                                 start_new_session=True)
        timer = threading.Timer(WALL_S, lambda: os.killpg(child.pid, signal.SIGKILL))
        timer.start()
        _, status, used = os.wait4(child.pid, 0)
        timer.cancel()
        child.returncode = os.waitstatus_to_exitcode(status)
    return child.returncode, used.ru_utime + used.ru_stime, (here / "said").read_bytes()


def not_finite_in(folder):
    """A file of results that holds a number which is none."""
    for path in folder.rglob("history.csv") if folder.is_dir() else []:
        if FAULTS.search(path.read_bytes()):
            return path
    for path in [*folder.rglob("summary.json")] if folder.is_dir() else [folder]:
        try:
            json.loads(path.read_text(), parse_constant=lambda word: math.nan)
            if FAULTS.search(re.sub(rb'"[^"]*"', b"", path.read_bytes())):
                return path
        except (OSError, ValueError):
            return path
    return None


def complaint(one, here):
    """What is wrong with how the program took its input; nothing: None."""
    status, seconds, said = carried_out(one, here)
    output = here / one.output
    if status < 0 or status > 128:
        return f"ended by signal {-status if status < 0 else status - 128}"
    if seconds > CPU_S:
        return f"computed for {seconds:.1f} s"
    if status == INTERRUPTED and b"wall_clock_limit" in one.text + " ".join(map(str, one.words)).encode():
        return None
    if status not in (COMPLETED, BAD_INPUT, CALCULATION_FAILED, FILE_FAILED):
        return f"exit {status}"
    if status == BAD_INPUT and output.exists():
        return f"refused the input and left {sorted(p.name for p in output.rglob('*'))}"
    if status == BAD_INPUT and not PLACED.search(said.decode(errors="replace")):
        return "refused the input without saying where"
    if status == COMPLETED and output.exists() and one.program != "submit" and (path := not_finite_in(output)):
        return f"completed, and {path.relative_to(here)} holds what is no number"
    if status == COMPLETED and one.program in ("plan",) and FAULTS.search(said):
        return "completed, and told what is no number"
    return None


def attempt(program, number, keys):
    here = pathlib.Path(tempfile.mkdtemp(prefix="tetsuame_bad_"))
    try:
        one = trial(program, number, keys)
        fault = complaint(one, here)
        if fault is None:
            return None
        said = (here / "said").read_bytes()[-600:].decode(errors="replace")
        line = " ".join("'" + w.replace("'", "'\\''") + "'" for w in map(str, one.words))
        return f"{program} {SEED} {number}: {fault}\n  {program} {line}\n  in.nml: {one.text[:1500]!r}\n  {said}"
    finally:
        shutil.rmtree(here, ignore_errors=True)


class BadInputs(unittest.TestCase):
    def test_all_programs(self):
        wanted = os.environ.get("TETSUAME_BAD_PROGRAMS")
        programs = wanted.split(",") if wanted else list(CASES)
        keys = {program: keys_of("disph_c" if program == "submit" else program) for program in programs}
        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            all_of_them = [pool.submit(attempt, program, number, keys[program]) for number in range(EACH) for program in programs]
            faults = [fault for one in all_of_them if (fault := one.result())]
        self.assertEqual(len(faults), 0, f"{len(faults)} of {len(all_of_them)} inputs:\n" + "\n".join(faults[:40]))


if __name__ == "__main__":
    unittest.main()
