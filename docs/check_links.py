#!/usr/bin/python3
"""Checks the Markdown files and what names them. Prints what is wrong, one line each; exit status 1.

- Every relative link leads to a file, and its #part to a heading there.
- Every file or folder of the repository that a page names in backticks is there.
- Every file of docs/ that a source, an input or a test names is there.
- A page of docs/theory has at most 1500 words, equations apart: what was measured or tried stands in docs/studies.
"""
import re
import sys
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
NAMED = re.compile(r"`((?:modules|programs|inputs|tests|docs|cmake)/[\w./-]+)`")
PAGE_NAMED = re.compile(r"\bdocs/[\w./-]+\.(?:md|py|png|json)\b")
SOURCES = ("modules/**/*", "programs/**/*", "tests/**/*", "inputs/*", "cmake/*", "docs/*.py", "docs/figures/*.py", "run")
WORDS = 1500


def without_blocks(text: str) -> str:
    """Code blocks emptied, lines kept."""
    return re.sub(r"```.*?```", lambda block: "\n" * block[0].count("\n"), text, flags=re.DOTALL)


def part_name(heading: str) -> str:
    """That GitHub gives a heading."""
    words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).strip().lower()
    return re.sub(r"[^\w\- ]", "", words).replace(" ", "-")


@cache
def parts(page: Path) -> frozenset[str]:
    return frozenset(part_name(heading) for heading in re.findall(r"^#+ +(.*)$", without_blocks(page.read_text()), flags=re.MULTILINE))


def broken(page: Path, target: str) -> bool:
    name, _, part = target.partition("#")
    path = page.parent / name if name else page
    return not path.exists() or bool(part) and path.suffix == ".md" and part not in parts(path)


def of_page(page: Path) -> list[str]:
    found = []
    for number, line in enumerate(without_blocks(page.read_text()).splitlines(), 1):
        wrong = [target for target in LINK.findall(line) if not re.match(r"[a-z]+:", target) and broken(page, target)]
        wrong += [name for name in NAMED.findall(line) if not (ROOT / name).exists()]
        found += [f"{page.relative_to(ROOT)}:{number}: there is no {name}" for name in wrong]
    words = len(without_blocks(page.read_text()).split())
    if page.parent == ROOT / "docs" / "theory" and words > WORDS:
        found.append(f"{page.relative_to(ROOT)}: {words} words, more than {WORDS}")
    return found


def of_source(source: Path) -> list[str]:
    try:
        lines = source.read_text().splitlines()
    except UnicodeDecodeError:  # no text
        return []
    return [f"{source.relative_to(ROOT)}:{number}: there is no {name}" for number, line in enumerate(lines, 1)
            for name in PAGE_NAMED.findall(line) if not (ROOT / name).exists()]


def main() -> int:
    pages = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")])
    sources = sorted(path for pattern in SOURCES for path in ROOT.glob(pattern) if path.is_file())
    found = [line for page in pages for line in of_page(page)] + [line for source in sources for line in of_source(source)]
    print(*found, sep="\n", end="\n" if found else "")
    print(f"{len(pages)} pages, {len(sources)} other files, {len(found)} faults")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
