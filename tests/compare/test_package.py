"""The package's command line, and what all reports share: files read, parts of pages."""
import json
import os
import re
import subprocess
import sys
import tempfile
import types
import unittest
from pathlib import Path

import matplotlib
import numpy as np

import inside
from tetsuame import fields, pages, plots, reading, rendering, style

SOURCES = Path(__file__).resolve().parents[2] / "programs/python"


def call(*arguments):
    return subprocess.run([sys.executable, "-m", "tetsuame", *arguments], capture_output=True, text=True,
                          env=os.environ | {"PYTHONPATH": str(SOURCES)})


class Commands(unittest.TestCase):
    def test_help_names_each_command_and_each_has_its_own(self):
        said = call("--help")
        self.assertEqual(said.returncode, 0, said.stderr)
        for command, option in (("compare", "--programs"), ("bench", "folder"), ("balance", "folder"), ("scaling", "--ranks"), ("plot", "--fields"), ("movie", "--gif"), ("view", "--megabytes"),
                                ("paraview", "--field"), ("sweep", "--set"), ("building", "--storeys"), ("eos", "folder")):
            with self.subTest(command):
                self.assertRegex(said.stdout, rf"(?m)^  {command} ")
                own = inside.call(command, "--help")
                self.assertEqual(own.returncode, 0, own.stderr)
                self.assertIn(option, own.stdout)

    def test_unknown_command_is_refused_in_a_sentence(self):
        said = call("contrast", "--programs", "A")
        self.assertEqual((said.returncode, said.stdout), (2, ""))
        self.assertEqual(said.stderr, "tetsuame: no command 'contrast' (there are compare, bench, balance, scaling, plot, movie, view, paraview, sweep, building, eos)\n")

    def test_no_command(self):
        said = call()
        self.assertEqual(said.returncode, 2)
        self.assertIn("COMMAND", said.stderr)

    def test_pip_installs_it_without_a_network(self):
        with tempfile.TemporaryDirectory() as scratch:
            made = subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", scratch], capture_output=True, text=True)
            if made.returncode:
                self.skipTest("no python3-venv")
            said = subprocess.run([f"{scratch}/bin/pip", "install", "--no-index", "--quiet", str(SOURCES)], capture_output=True, text=True)
            self.assertEqual(said.returncode, 0, said.stderr)
            said = subprocess.run([f"{scratch}/bin/tetsuame", "view", "/nowhere"], capture_output=True, text=True, cwd=scratch)
            self.assertEqual((said.returncode, said.stderr), (2, "tetsuame view: /nowhere: no such directory\n"))


class Reading(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.file = Path(scratch.name) / "file"

    def test_columns_lose_their_units_and_a_line_cut_short(self):
        self.file.write_text("step [1],time [s]\n0,0.5\n1,1.5\n2")
        columns = reading.Columns(self.file)
        self.assertEqual({name: list(values) for name, values in columns.items()}, {"step": [0.0, 1.0], "time": [0.5, 1.5]})

    def test_columns_of_a_file_without_a_whole_line(self):
        for text in ("", "step [1],time [s]\n", "step [1],time [s]\n1"):
            with self.subTest(text):
                self.file.write_text(text)
                self.assertEqual(reading.Columns(self.file), {})

    def test_keys_of_a_resolved_input(self):
        self.file.write_text("! rti, every key as run\n&domain\n  length_x = 1.5d6  ! m\n/\n&walls\n  thermal = 'fixed'  ! not 'adiabatic'\n"
                             "  Name = 'a ! b'\n  list = 1, 2\n/\n")
        self.assertEqual(reading.Keys(self.file), {"domain.length_x": "1.5d6", "walls.thermal": "fixed", "walls.name": "a ! b",
                                                        "walls.list": "1, 2"})
        self.assertEqual(reading.real("1.5D6"), 1.5e6)

    def test_json_that_is_absent_or_none_names_who_writes_it(self):
        with self.assertRaisesRegex(reading.Unreadable, "file: No such file or directory; run bench first"):
            reading.read_json(self.file, "bench")
        self.file.write_text("{")
        with self.assertRaisesRegex(reading.Unreadable, "not the JSON that bench writes"):
            reading.read_json(self.file, "bench")


class Pages(unittest.TestCase):
    def test_text_is_shown_as_it_is(self):
        made = pages.text_table(["name", "a < b"], [["<b>", "1"]], 1)
        self.assertIn("<tr><td>&lt;b&gt;</td><td class=\"number\">1</td></tr>", made)
        self.assertIn("<th class=\"number\">a &lt; b</th>", made)

    def test_empty_parts_are_left_out(self):
        self.assertIn("<body>\n<p>a</p>\n<p>b</p>\n</body>", pages.document("x", ["<p>a</p>", "", "<p>b</p>"]))

    def test_a_page_has_a_section_for_what_there_is(self):
        self.assertEqual(pages.section("Nothing", "", ""), "")
        self.assertEqual(pages.section("a < b", "", "<p>c</p>"), "<h2>a &lt; b</h2>\n<p>c</p>")

    def test_a_picture_is_as_wide_as_it_was_drawn(self):
        for inches, share in ((style.WIDTH, "100.0%"), (style.WIDTH / 2, "50.0%")):
            made = pages.figure(style.plt.figure(figsize=(inches, 1)), caption="<code>x</code> & y")
            self.assertIn(f"--share: {share}", made)
            self.assertIn('alt="x &amp; y"', made)

    def test_errors_have_the_colour_of_their_logarithm(self):
        self.assertEqual([pages.error_class(value) for value in (0.0, -1e-15, 1e-10, 1e-6, 1e-4, -4e-3, 0.03, 0.1, -0.25, 7.0)],
                         ["e0", "e0", "e1", "e2", "e3", "e4", "e5", "e6", "e7", "e7"])
        self.assertEqual([pages.error_class(value) for value in (None, float("nan"), float("inf"))], ["", "", ""])
        self.assertEqual(pages.error(0.1, "10 %", "best"), '<td class="number best e6">10 %</td>')
        self.assertEqual(pages.error(None, "–"), '<td class="number">–</td>')

    def test_colours_of_errors_can_be_read_and_told_apart(self):
        css = pages.STYLE.read_text(encoding="utf-8")
        shades = [re.search(rf"--e{index}: (#\w+);", css)[1] for index in range(len(pages.ERRORS) + 1)]
        self.assertEqual(len(set(shades)), len(shades))
        for index, shade in enumerate(shades):
            letters = "#ffffff" if index == 0 else style.INK
            self.assertGreater(contrast(shade, letters), 4.5, shade)
        red_over_green = [matplotlib.colors.to_rgb(shade)[0] - matplotlib.colors.to_rgb(shade)[1] for shade in shades]
        self.assertEqual(red_over_green[1:], sorted(red_over_green[1:]))  # from green over neutral to warm
        self.assertIn("td.e0, .step.e0 { background: var(--e0); color: #fff; }", css)


def contrast(one: str, other: str) -> float:
    """Of the Web Content Accessibility Guidelines."""
    def luminance(colour: str) -> float:
        parts = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in matplotlib.colors.to_rgb(colour)]
        return float(np.dot(parts, (0.2126, 0.7152, 0.0722)))

    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


class Figures(unittest.TestCase):
    def tearDown(self):
        style.plt.close("all")

    def test_crosses_lie_within_their_axes(self):
        for scale in ("linear", "log"):
            for x, y in ((5, 5), (500, 5), (5, 1e9), (-3, 1e-9), (5, None), (5, float("inf"))):
                with self.subTest(scale=scale, x=x, y=y):
                    figure, (ax,) = style.panels(1, 1, 3)
                    ax.set_yscale(scale)
                    ax.plot([1, 10], [1, 10])
                    limits = ax.get_xlim(), ax.get_ylim()
                    style.stopped(ax, x, y, style.INK)
                    figure.canvas.draw()
                    self.assertEqual((ax.get_xlim(), ax.get_ylim()), limits)
                    box, cross = ax.get_window_extent(), ax.lines[-1].get_window_extent()
                    self.assertTrue(box.x0 <= cross.x0 and cross.x1 <= box.x1 and box.y0 <= cross.y0 and cross.y1 <= box.y1)
        style.stopped(ax, 5.5, 10**0.5, style.INK)  # where it belongs, if that is within
        for place in ax.lines[-1].get_xydata()[0]:
            self.assertAlmostEqual(place, 0.5)

    def test_maps_leave_no_half_empty_row(self):
        for count, wanted, rows, columns in ((1, 2, 1, 1), (2, 2, 1, 2), (3, 2, 1, 3), (4, 2, 2, 2), (4, 3, 2, 2), (5, 3, 2, 3), (6, 3, 2, 3)):
            with self.subTest(count=count):
                figure, axes = style.map_panels(count, columns=wanted)
                grid = axes[0].get_gridspec()
                self.assertEqual((len(axes), grid.nrows, grid.ncols), (count, rows, columns))
                self.assertLessEqual(figure.get_size_inches()[0], style.WIDTH + 1e-9)

    def test_a_single_map_is_no_wider_than_it_needs(self):
        picture = rendering.Map(np.arange(12.0).reshape(3, 4), (0.0, 4.0, 0.0, 3.0), (0, 1))
        figure, (ax,) = style.map_panels(1, plots.wide(picture))
        plots.draw_map(ax, picture, "Temperature", "K")
        figure.canvas.draw()
        size = figure.get_size_inches()
        self.assertLess(size[0], 0.7 * style.WIDTH)
        box = ax.get_window_extent().transformed(figure.transFigure.inverted())
        self.assertGreater(box.width, 0.6)

    def test_measures_come_before_what_is_conserved(self):
        class History(dict):
            units = {f"measure_{k}": "m" for k in range(11)} | {"time": "s", "momentum_x": "kg m/s", "angular_momentum_z": "kg m^2/s"}

        history = History(time=np.arange(3.0), momentum_x=np.arange(3.0), angular_momentum_z=np.arange(3.0), **{f"measure_{k}": np.arange(3.0) for k in range(11)})
        figure = plots.histories([("", types.SimpleNamespace(history=history, directory=Path(".")))])
        titles = [ax.get_title(loc="left") for ax in figure.axes]
        self.assertEqual([title.split()[0] for title in titles if title], ["measure"] * 11 + ["momentum"])

    def test_a_body_in_open_space_is_shown_with_its_surface(self):
        class Ball(dict):
            lengths, periodic, dimension = np.array([2.0, 2.0, 2.0]), np.full(3, False), 3

        places = np.array([[0.0, 1.0, 1.0], [2.0, 1.0, 1.0], [1.0, 0.0, 1.0], [1.0, 2.0, 1.0]])
        spacing = np.full(4, 0.1)
        walled = rendering._Grid(Ball(Coordinates=places), (0, 1), 50, spacing)
        free = rendering._Grid(Ball(Coordinates=places, GravitationalPotential=np.zeros(4)), (0, 1), 50, spacing)
        np.testing.assert_allclose((walled.low, walled.high), ([0, 0], [2, 2]))
        np.testing.assert_allclose((free.low, free.high), ([-0.2, -0.2], [2.2, 2.2]))

    def test_isolines_reach_the_edges(self):
        x, y = (np.arange(8) + 0.5) / 8, (np.arange(4) + 0.5) / 4
        wider = plots.to_the_edges(2 * x + 3 * y[:, None])
        np.testing.assert_allclose(wider, 2 * np.r_[0, x, 1] + 3 * np.r_[0, y, 1][:, None], atol=1e-12)
        self.assertEqual(plots.to_the_edges(np.ones((1, 3))).shape, (3, 5))

    def test_magnitudes_have_sequential_colours(self):
        for name in ("Temperature", "Pressure", "Density", "Speed", "Viscosity"):
            with self.subTest(name):
                shades = matplotlib.colormaps[fields.look(name).colours](np.linspace(0, 1, 40))[:, :3]
                brightness = shades @ (0.2126, 0.7152, 0.0722)
                self.assertTrue((np.diff(brightness) > 0).all())

    def test_no_module_chooses_colours_of_its_own(self):
        own = {path.name: re.findall(r"\"#[0-9A-Fa-f]{6}\"", path.read_text(encoding="utf-8"))
               for path in (SOURCES / "tetsuame").rglob("*.py") if path.name != "style.py"}
        self.assertEqual({name: found for name, found in own.items() if found}, {})

    def test_no_module_writes_its_own_page(self):
        for path in (SOURCES / "tetsuame").rglob("*.py"):
            if path.name not in ("pages.py", "view.py"):
                with self.subTest(path.name):
                    self.assertEqual(re.findall(r"<(?:html|head|h1|h2|h3|table|td|p|ul|li|img|pre)\b", path.read_text(encoding="utf-8")), [])


class BalancePage(unittest.TestCase):
    def write(self, folder: Path, dimension: int = 2):
        """Four ranks, two decisions."""
        metrics = {f"{prefix}{name}": 0.5 for prefix in ("", "rcb_") for name in
                   ("spread_initial", "spread_final", "efficiency_initial", "efficiency_predicted", "updates", "migrated_fraction_per_update",
                    "run_time_balanced", "run_time_reduction")} | {"updates_to_5_percent": 1, "rcb_updates_to_5_percent": None}
        (folder / "summary.json").write_text(json.dumps({"status": "completed", "counts": [2, 2], "steps": 200, "fluid_particles": 900,
                                                         "wall_particles": 100, "metrics": metrics, "version": "0000000"}))
        (folder / "cuts.csv").write_text("decision,axis,group,index,position [m]\n" + "".join(
            f"{d},{axis},{group},{index},{position}\n" for d in (0, 1) for axis, group in ((0, 0), (1, 0), (1, 1))
            for index, position in enumerate((0.0, 0.5 + 0.1 * d, 1.0))))
        (folder / "times.csv").write_text("decision,rank,particles,computing [s],communication [s]\n" + "".join(
            f"{d},{rank},250,{1 + (rank == 0) * (1 - d)},0.1\n" for d in (0, 1) for rank in range(4)))
        names = ("spread", "slowest_step", "migrated_fraction", "gain", "cost", "moved")
        (folder / "history.csv").write_text(",".join(["step [1]", *(f"{p}{name} [1]" for p in ("", "rcb_") for name in names)]) + "\n"
                                            + "0" + ",0.8,2.1,0,0.5,0.1,1" * 2 + "\n100" + ",0.1,1.2,0.25,0,0,0" * 2 + "\n")

    def test_page_and_pictures(self):
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch)
            self.write(folder)
            said = call("balance", scratch)
            self.assertEqual((said.returncode, said.stdout), (0, f"Report: {folder / 'report.html'}\n"), said.stderr)
            page = (folder / "report.html").read_text(encoding="utf-8")
            self.assertEqual(page.count("data:image/png;base64,iVBOR"), 2)
            for text in ("1,000 particles", "4 virtual ranks, 2 × 2", "Zoltan RCB", "80.0 %", "<td class=\"number\">–</td>"):
                self.assertIn(text, page)
            for name in ("cuts.png", "course.png"):
                self.assertEqual((folder / name).read_bytes()[1:4], b"PNG")

    def test_what_is_no_run_of_balance(self):
        with tempfile.TemporaryDirectory() as scratch:
            said = call("balance", scratch)
            self.assertEqual((said.returncode, said.stdout), (2, ""))
            self.assertEqual(len(said.stderr.strip().splitlines()), 1)
            self.assertEqual(list(Path(scratch).iterdir()), [])


if __name__ == "__main__":
    unittest.main()
