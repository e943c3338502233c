"""The pages of `./run docs`: all there, whole without a network, and the search knows their words."""
import importlib.util
import json
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
MAKE = ROOT / "docs/site/make.py"


@unittest.skipIf(importlib.util.find_spec("mkdocs") is None, "Debian's mkdocs is not installed")
class Site(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.site = Path(cls.folder.name) / "site"
        made = subprocess.run([sys.executable, str(MAKE), str(cls.site)], capture_output=True, text=True)
        assert made.returncode == 0, made.stderr
        cls.pages = {path: path.read_text() for path in cls.site.rglob("*.html")}

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_every_page(self):
        self.assertEqual(len(self.pages), len([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")]))

    def test_links(self):
        """Every link, picture, style and script is a file here, and every part of a page that is named is there."""
        for path, text in self.pages.items():
            for target in re.findall(r'(?:href|src)="([^"]+)"', text):
                if re.match(r"(https?|mailto):", target):
                    continue
                name, _, part = target.partition("#")
                to = (path.parent / name).resolve() if name else path
                self.assertTrue(to.exists(), f"{path.name}: {target}")
                if part:
                    self.assertIn(f'id="{part}"', self.pages[to], f"{path.name}: {target}")

    def test_nothing_is_loaded_from_elsewhere(self):
        for text in self.pages.values():
            self.assertEqual(re.findall(r'<(?:script|link|img)[^>]*(?:src|href)="(?:https?:)?//', text), [])
        for style in self.site.rglob("*.css"):
            for url in re.findall(r"url\(([^)]+)\)", style.read_text()):
                if url.endswith((".woff2", ".ttf")):
                    self.assertTrue((style.parent / url).exists(), url)
                self.assertNotIn("//", url)

    def test_equations(self):
        """As many as the pages of theory have, and the library that draws them is there."""
        wanted = sum(path.read_text().count("```math") for path in ROOT.glob("docs/**/*.md"))
        self.assertGreater(wanted, 40)
        self.assertEqual(sum(text.count('class="language-math"') for text in self.pages.values()), wanted)
        self.assertTrue((self.site / "katex/katex.min.js").exists())

    def test_search(self):
        text = (self.site / "sections.js").read_text().removeprefix("const SECTIONS = ").rstrip(";\n")
        sections = json.loads(text)
        for word in ["repulsion", "Blankenbach", "粒子"]:
            self.assertTrue(any(word in section[3] for section in sections), word)
        for address, *_ in sections:
            name, _, part = address.partition("#")
            page = self.pages[self.site / name]
            self.assertTrue(not part or f'id="{part}"' in page, address)


if __name__ == "__main__":
    unittest.main()
