"""Carries out the commands of README and of the cookbook, in English and in Japanese, in a copy of what they need. They stand as they are
there, but for what would take minutes: a run ends after STEPS steps, at most SIDE particles stand along an axis and RANKS processes are
started, and ./run is only asked for help on what builds, compares all or measures. Each ends with status 0, and files that are named exist."""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

THREE = Path("/usr/share/javascript/three/three.min.js")
SOURCE, BUILD = (Path(os.environ[name]).resolve() for name in ("TETSUAME_SOURCE", "TETSUAME_BUILD"))
STEPS, SIDE, RANKS = 3, 24, 2
SLOW = bool(os.environ.get("TETSUAME_SLOW"))
HEAVY = ("build", "test", "compare", "bench", "check", "docs", "package")  # commands of ./run
ELSEWHERE = ("apt-get ", "git ", "cd ", "paraview ", "cmake ", "source ", "touch ")  # what is another program's
QUESTIONS = ("--check", "--describe", "--theory", "--help", "--plan")
NOT_MADE = ("output/compare", "output/bench", "output/docs", "output/balance", "output/PROGRAM")  # by the commands that are left out
PLACEHOLDER = re.compile(r"…|\[|\b(INPUT|DIR\d?|NAME|FILE|PROGRAM|COMMAND|NEW_DIR|OPTIONS)\b|フォルダ")
# What README says that mpirun wants as root and on few cores.
MPI = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1",
       "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe"}


def commands(text: str) -> list[str]:
    """Shell lines of blocks and of inline code, whole, in order; without comments and placeholders."""
    found = []
    for block, language, body, inline in re.findall(r"^(```(\w*)\n(.*?)^```$)|`([^`\n]+)`", text, re.MULTILINE | re.DOTALL):
        if block and language == "python":
            found.append("python\n" + body)
        elif block and not language:
            lines = body.replace("\\\n", " ").splitlines()
            if any(line.startswith(("./run", "build/programs", "mpirun", "apt-get")) for line in lines):
                found += [re.sub(r"\s+#.*", "", line) for line in lines]
        elif inline and inline.startswith(("./run ", "build/programs/", "mpirun ")) and " " in inline:
            found.append(inline)
    return [line for line in found if line.strip() and (line.startswith("python\n") or not PLACEHOLDER.search(line))]


def smaller(line: str) -> str | None:
    """As it is carried out here; None where it is not."""
    if line.startswith(ELSEWHERE):
        return None
    words = line.split()
    if words[0] == "./run":
        if len(words) == 2:  # a name alone
            return f"./run help | grep -E '^  {words[1]} '"
        if words[1] in HEAVY and not (words[1] == "compare" and "/" in line.partition("compare")[2].partition("--")[0]):
            return "./run compare --help" if words[1] == "compare" else f"./run help | grep -E '^  {words[1]} '"
    line = re.sub(r"(particles_\w=)([\d,]+)", lambda at: at[1] + ",".join(dict.fromkeys(str(min(int(n), SIDE)) for n in at[2].split(","))), line)
    line = re.sub(r"(--ranks |mpirun .*?-n )(\d+)", lambda at: at[1] + str(min(int(at[2]), RANKS)), line)
    runs = re.match(r"(mpirun .*)?build/programs/", line) and not any(word in line for word in (*QUESTIONS, "/plan ", "/submit ", "/balance ", "/bench "))
    return line + f" --set time.steps={STEPS}" if runs or words[:2] == ["./run", "sweep"] else line


def named(text: str) -> set[str]:
    """Files below output/ that a page says are there."""
    found = set(re.findall(r"(?<![\w/])(output/[\w./]+\.\w+)", text))
    for folder, names in re.findall(r"# (output/[\w/]+): ([\w.]+(?:, [\w.]+)*)", text):
        found |= {f"{folder}/{name}" for name in names.split(", ")}
    return {name for name in found if not name.startswith(NOT_MADE)}


class Pages(unittest.TestCase):
    def setUp(self):
        self.here = Path(tempfile.mkdtemp(prefix="tetsuame_commands_"))
        self.addCleanup(shutil.rmtree, self.here, ignore_errors=True)
        for folder in ("build", "output", "bin"):
            (self.here / folder).mkdir()
        shutil.copytree(SOURCE / "programs/python", self.here / "programs/python", ignore=shutil.ignore_patterns("__pycache__"))
        shutil.copy(SOURCE / "run", self.here)
        shutil.copytree(SOURCE / "inputs", self.here / "inputs")
        shutil.copy(SOURCE / "inputs/rti_note.nml", self.here / "my.nml")  # the input that a reader copies and changes
        (self.here / "build/programs").symlink_to(BUILD / "programs")
        for stamp in ("output/.no-install", "build/build.ninja", "build/.configured"):
            (self.here / stamp).touch()
        for name, does in (("cmake", "exit 0"), ("less", "exec cat"), ("sbatch", '[ -s "$1" ]')):
            (self.here / "bin" / name).write_text(f"#!/bin/sh\n{does}\n")
            (self.here / "bin" / name).chmod(0o755)

    def carry_out(self, page: str, least: int):
        text = (SOURCE / page).read_text(encoding="utf-8")
        surroundings = os.environ | {"PATH": f"{self.here / 'bin'}:{os.environ['PATH']}", "PYTHON": sys.executable, "OMP_NUM_THREADS": "1", **MPI,
                                     "MPLBACKEND": "Agg", "PYTHONPATH": str(self.here / "programs/python")}
        done = 0
        for line in commands(text):
            carried = f"{sys.executable} - <<'END'\n{line.partition(chr(10))[2]}END" if line.startswith("python\n") else smaller(line)
            if carried is None:
                continue
            if carried.startswith("./run movie ") and not shutil.which("ffmpeg"):
                carried += " --gif"
            if carried.startswith("./run view ") and not THREE.is_file():
                continue
            said = subprocess.run(["bash", "-ec", carried], cwd=self.here, env=surroundings, capture_output=True, text=True, stdin=subprocess.DEVNULL)
            self.assertEqual(said.returncode, 0, f"{page}: {line}\n{said.stdout[-1500:]}{said.stderr[-1500:]}")
            done += 1
        self.assertGreaterEqual(done, least, f"{page}: commands are not found")
        for name in named(text):
            needs_more = (name.endswith(".mp4") and not shutil.which("ffmpeg")) or (name.endswith("view.html") and not THREE.is_file())
            self.assertTrue((self.here / name).exists() or needs_more, f"{page}: {name} is not there")


# Each page, and how many commands it has at least.
for page, least in {"README.md": 8, "README.ja.md": 3, "docs/cookbook/overturn.md": 8, "docs/cookbook/overturn.ja.md": 5, "docs/cookbook/table.md": 2,
                    "docs/cookbook/table.ja.md": 1, "docs/cookbook/convection.md": 6, "docs/cookbook/convection.ja.md": 5,
                    "docs/cookbook/impact.md": 6, "docs/cookbook/impact.ja.md": 6}.items():
    def test(self, page=page, least=least):
        self.carry_out(page, least)
    # Those of the Japanese pages are the English ones.
    setattr(Pages, "test_" + re.sub(r"\W", "_", page), unittest.skipUnless(SLOW or ".ja." not in page, "slow")(test))


class Reading(unittest.TestCase):
    def test_what_is_found(self):
        text = "```\n./run build   # six minutes\nbuild/programs/rti a.nml \\\n  --set domain.particles_x=400\n```\nand `mpirun -n 16 build/programs/rti b.nml`, `./run plot DIR`\n"
        self.assertEqual(commands(text), ["./run build", "build/programs/rti a.nml    --set domain.particles_x=400", "mpirun -n 16 build/programs/rti b.nml"])
        self.assertEqual(smaller("mpirun -n 16 build/programs/rti b.nml --set domain.particles_x=400"),
                         "mpirun -n 2 build/programs/rti b.nml --set domain.particles_x=24 --set time.steps=3")
        self.assertEqual(named("output/a/view.html # output/a/plots: b.png, c.png; output/compare/report.html"),
                         {"output/a/view.html", "output/a/plots/b.png", "output/a/plots/c.png"})


if __name__ == "__main__":
    unittest.main()
