#!/usr/bin/python3
"""Checks that every relative link in the Markdown files leads to a file, and that every file or
folder of the repository that they name in backticks is there. Prints what is not; exit status 1."""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
NAMED = re.compile(r"`((?:modules|programs|inputs|tests|docs|cmake)/[\w./-]+)`")


def problems(page: Path) -> list[str]:
    text = re.sub(r"```.*?```", lambda block: "\n" * block[0].count("\n"), page.read_text(), flags=re.DOTALL)
    found = []
    for number, line in enumerate(text.splitlines(), 1):
        targets = [(target, page.parent / target.partition("#")[0]) for target in LINK.findall(line)
                   if not re.match(r"[a-z]+:|#", target)]
        targets += [(name, ROOT / name) for name in NAMED.findall(line)]
        found += [f"{page.relative_to(ROOT)}:{number}: there is no {name}" for name, path in targets
                  if not path.exists()]
    return found


def main() -> int:
    pages = [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")]
    found = [line for page in sorted(pages) for line in problems(page)]
    print(*found, sep="\n", end="\n" if found else "")
    print(f"{len(pages)} pages, {len(found)} broken links or names")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
