#!/usr/bin/python3
"""`./run docs`: README and docs/ as pages that open without a network, with equations (KaTeX) and a search, by MkDocs."""
import json
import re
import shutil
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(HERE.parent))
KATEX = Path("/usr/share/javascript/katex")  # Debian's libjs-katex

from check_links import LINK, part_name, without_blocks  # noqa: E402
from mkdocs.commands.build import build  # noqa: E402
from mkdocs.config import load_config  # noqa: E402


def pages() -> list[Path]:
    return [path.relative_to(ROOT) for path in sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")])]


def menu() -> list:
    """What stands beside each page."""
    titled = {"README.md": "Tetsuame", "README.ja.md": "鉄雨", "CHANGELOG.md": "Changes"}

    def below(folder: str) -> list:
        found = [str(page) for page in pages() if str(page.parent) == folder]
        return sorted(found, key=lambda name: (not name.endswith("index.md"), name))

    return [*({title: name} for name, title in titled.items()), {"Guide": below("docs")}, {"Cookbook": below("docs/cookbook")},
            {"Theory": below("docs/theory")}, {"Studies": below("docs/studies")[:1] + below("docs/studies")[:0:-1]}]


def as_mkdocs_reads(text: str) -> str:
    """GitHub begins lists and tables without an empty line before them, and its links lead to sources too, which are not here."""
    lines, in_block = [], False
    for line in text.split("\n"):
        in_block ^= line.startswith("```")
        before = lines[-1] if lines else ""
        begins = re.match(r"([-*]|\d+\.) ", line) and not re.match(r"([-*]|\d+\.) |  ", before)
        begins = begins or line.startswith("|") and not before.startswith("|")
        if not in_block and begins and before:
            lines.append("")
        lines.append(line if in_block else LINK.sub(kept_link, line))
    return "\n".join(lines)


def kept_link(link: re.Match) -> str:
    target = link[1].partition("#")[0]
    kept = re.match(r"[a-z]+:", target) or not target or target.endswith((".md", ".png"))
    return link[0] if kept else link[0][1:].partition("]")[0]


def stage(folder: Path) -> None:
    for page in pages():
        (folder / page).parent.mkdir(parents=True, exist_ok=True)
        (folder / page).write_text(as_mkdocs_reads((ROOT / page).read_text()))
    shutil.copytree(ROOT / "docs/figures", folder / "docs/figures", ignore=lambda _, names: [n for n in names if not n.endswith(".png")])


def sections(folder: Path) -> list[list[str]]:
    """Of all pages, for the search: address, the page's title, the section's, its words."""
    found = []
    for page in pages():
        address = "index.html" if str(page) == "README.md" else str(page.with_suffix(".html"))
        text = re.sub(r"```(?!math).*?```", "", (folder / page).read_text(), flags=re.DOTALL)
        first, title = True, ""
        for part in re.split(r"^(?=#+ )", text, flags=re.MULTILINE):
            head, _, words = part.partition("\n")
            heading = re.sub(r"[`*]", "", LINK.sub(lambda link: link[0][1:].partition("]")[0], head.lstrip("# ")))
            title = title or heading
            words = " ".join(re.sub(r"!?\[([^\]]*)\]\([^)]*\)|[`*|#]|<[^>]*>", r"\1", words).split())
            if heading or words:
                found.append([address + ("" if first else "#" + part_name(head.lstrip("# "))), title, heading, words])
                first = False
    return found


def make(site: Path) -> Path:
    if site.is_symlink() or site.exists() and not site.is_dir() or site.is_dir() and any(site.iterdir()) and not (site / "sections.js").is_file():
        sys.exit(f"run docs: {site}: holds something else than these pages, and is not replaced; give a new folder")
    shutil.rmtree(site, ignore_errors=True)
    with tempfile.TemporaryDirectory() as name:
        folder, settings = Path(name, "pages"), Path(name, "mkdocs.yml")
        stage(folder)
        settings.write_text("{}")  # MkDocs wants the file; what stands in it is given here
        build(load_config(
            config_file=str(settings), site_name="Tetsuame", docs_dir=str(folder), site_dir=str(site), use_directory_urls=False, plugins=[], nav=menu(),
            theme={"name": None, "custom_dir": str(HERE / "theme")}, strict=True,
            markdown_extensions=["tables", "fenced_code", {"toc": {"slugify": lambda heading, _: part_name(heading)}}]))
        index = json.dumps(sections(folder), ensure_ascii=False)
    (site / "sections.js").write_text(f"const SECTIONS = {index};\n")
    (site / "katex").mkdir()
    for part in ("katex.min.js", "katex.min.css"):
        shutil.copy(KATEX / part, site / "katex")
    shutil.copytree(KATEX / "fonts", site / "katex/fonts", ignore=lambda _, names: [n for n in names if not n.endswith((".woff2", ".ttf"))])
    return site / "index.html"


if __name__ == "__main__":
    if len(sys.argv) > 2 or sys.argv[1:2] in (["-h"], ["--help"]):
        sys.exit("usage: ./run docs [FOLDER]: pages of the documentation, in output/docs unless FOLDER is given")
    print(make(Path(sys.argv[1] if len(sys.argv) == 2 else ROOT / "output/docs")))
