"""Every key of the input that the documentation names, some program's --describe has. Studies are dated records, and may tell of keys
that there were."""
import os
import re
import subprocess
import unittest
from pathlib import Path

SOURCE, BUILD = (Path(os.environ[name]).resolve() for name in ("TETSUAME_SOURCE", "TETSUAME_BUILD"))
OTHERS = (("disph_c", "rti_note"), ("disph_c", "drop_sphere"), ("disph_c", "conduction_plate"), ("balance", "balance_bowl"))  # keys by the input's problem
NO_KEYS = {"nml", "json", "csv", "md", "cpp", "hpp", "h5", "py", "sh", "html", "log", "xdmf", "png", "stl"}  # `rti.cpp` is a file
OF_PYTHON = {"run.summary", "run.history", "run.snapshot", "run.snapshots"}  # run = tetsuame.load(…)
OLDER = {"floor", "lid", "sides"}  # names that &walls still reads


def described() -> dict[str, set[str]]:
    """Keys by group, of all programs. Those of &expert belong to the group that is said there, and are taken in it as well."""
    programs = [path for path in (BUILD / "programs").iterdir() if path.is_file() and os.access(path, os.X_OK)]
    known: dict[str, set[str]] = {}
    for command in [[path] for path in programs] + [[BUILD / "programs" / name, SOURCE / f"inputs/{of}.nml"] for name, of in OTHERS]:
        group = of = ""
        for line in subprocess.run([*command, "--describe"], capture_output=True, text=True, stdin=subprocess.DEVNULL).stdout.splitlines():
            if line.startswith("&"):
                group = line[1:].split()[0]
                known.setdefault(group, set())
            elif found := re.match(r"\s*! of &(\w+):", line):
                of = found[1]
            elif group and (found := re.match(r"\s*!?\s*(\w+)(?:\(.*?\))?\s*=", line)):
                known[group].add(found[1])
                if group == "expert":
                    known.setdefault(of, set()).update({found[1], found[1].removeprefix(f"{of}_")})
    return known


def named(text: str, known) -> set[tuple[str, str]]:
    """Groups and keys: `group.key`, `&group … key = value`, `&group key`, and in tables whose first cell is a group what the others name."""
    found = {(group, key) for group, key in re.findall(r"(?<![\w./-])([a-z_]+)\.([a-z_0-9]+)(?:\(\d+\))?(?![\w.(/])", text)
             if group in known and key not in NO_KEYS and f"{group}.{key}" not in OF_PYTHON}
    for block, inline in re.findall(r"^```\w*\n(.*?)^```$|`([^`\n]+)`", text, re.MULTILINE | re.DOTALL):
        code = re.sub(r"'[^']*'|![^\n]*", "", block or inline)
        for group, content in re.findall(r"&(\w+)([^&/]*)", code):
            if group in known:
                found |= {(group, key) for key in re.findall(r"\b([a-z]\w*)(?:\(\d+\))?\s*=", content)}
                found |= {(group, key) for key in re.findall(r"^ +([a-z]\w*)$", content)}
    for first, rest in re.findall(r"^\| ((?:`&\w+`(?:, )?)+) \| (.*) \|$", text, re.MULTILINE):
        groups = [group for group in re.findall(r"&(\w+)", first) if group in known]
        for key in re.findall(r"`([a-z]\w+)`", rest):
            elsewhere = key in known or key in OLDER or any(key in keys for keys in known.values())  # a group or program; a key of another group
            if groups and len(groups) == len(first.split(",")) and (not elsewhere or any(key in known[group] for group in groups)):
                found.add((next((group for group in groups if key in known[group]), groups[0]), key))
    return found


class Keys(unittest.TestCase):
    def test_documentation(self):
        known = described()
        self.assertTrue({"domain", "time", "walls", "flow", "shock"} <= set(known), sorted(known))
        pages = [*SOURCE.glob("*.md"), *(path for path in SOURCE.glob("docs/**/*.md") if path.parent.name != "studies")]
        unknown, count = [], 0
        for page in pages:
            text = page.read_text(encoding="utf-8")
            if page.name == "CHANGELOG.md":  # tells of keys that there were
                continue
            keys = named(text, known)
            count += len(keys)
            unknown += [f"{page.relative_to(SOURCE)}: &{group} {key}" for group, key in sorted(keys) if key not in known[group]]
        self.assertEqual(unknown, [])
        self.assertGreater(count, 100)

    def test_what_is_found(self):
        known = {"time": {"dt"}, "walls": {"slip"}}
        self.assertEqual(named("`time.dt`, `time.d_t`, `&walls slip`, `&walls slop = 'a'`, `time.cpp`\n| `&walls` | `slip`, `slup`, `'value'` |\n", known),
                         {("time", "dt"), ("time", "d_t"), ("walls", "slip"), ("walls", "slop"), ("walls", "slup")})


if __name__ == "__main__":
    unittest.main()
