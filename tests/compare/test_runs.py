"""Runs as arrays, pictures, movies and pages: on snapshots made here, of fields that are known."""
import base64
import fcntl
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
import zlib
from pathlib import Path
from xml.etree import ElementTree

import h5py
import numpy as np
from PIL import Image

import inside
import tetsuame
from tetsuame import across, plots, reading, rendering, runs, style, view

SOURCES = Path(__file__).resolve().parents[2] / "programs/python"
LENGTH = 100.0


def call(*arguments, **options):
    return subprocess.run([sys.executable, "-m", "tetsuame", *map(str, arguments)], capture_output=True, text=True,
                          env=os.environ | {"PYTHONPATH": str(SOURCES)}, **options)


def places_of(n, dimension):
    """A jittered lattice."""
    axes = np.meshgrid(*[(np.arange(n) + 0.5) / n] * dimension, indexing="ij")
    places = np.stack([axis.ravel() for axis in axes], 1) * LENGTH
    return places + np.random.default_rng(1).uniform(-0.2, 0.2, places.shape) * LENGTH / n


def write_snapshot(path, time, places, periodic=False, length=LENGTH, **more):
    n, dimension = places.shape
    density = np.full(n, 3000.0)
    fields = {"Coordinates": (np.pad(places, [(0, 0), (0, 3 - dimension)]), "m"), "Velocities": (np.zeros((n, 3)), "m/s"),
              "ParticleIDs": (np.arange(n)[::-1] + 7, "1"), "Density": (density, "kg/m^3"),
              "Masses": (density * (length**dimension / n), "kg"), "Temperature": (300 + 2 * places[:, 0] - places[:, 1] + time, "K"),
              **{name: (values, "Pa") for name, values in more.items()}}
    with h5py.File(path, "w") as file:
        header = file.create_group("Header").attrs
        header["Time"], header["Step"], header["Dimension"] = time, int(time), dimension
        header["BoxLengths"], header["Periodic"] = [length] * 3, [int(periodic)] * 3
        for name, (values, unit) in fields.items():
            file[f"PartType0/{name}"] = values
            file[f"PartType0/{name}"].attrs["units"] = unit


def write_run(directory, dimension=2, n=12, times=(0, 10, 20, 30), warmer=0.0, **options):
    directory.mkdir(parents=True)
    (directory / "resolved.nml").write_text(f"! rti, every key as run\n&time\n  dt = {1 + warmer}\n/\n")
    (directory / "summary.json").write_text(json.dumps({"status": "completed", "steps": 30, "errors": None, "conservation": {"mass": 0.0},
                                                        "metrics": {"growth_rate": 0.5 + warmer, "kind": "a word", "wrong": None}}))
    (directory / "history.csv").write_text("step [1],time [s],v_rms [m/s]\n" + "".join(f"{t},{t},{0.1 * t}\n" for t in range(31)))
    places = places_of(n, dimension)
    for index, t in enumerate(times):
        write_snapshot(directory / f"snapshot_{index:04d}.h5", t, places + 0.01 * t, Pressure=np.full(len(places), 5.0 + warmer), **options)
    return directory


def write_wall(directory):
    """Markers below the box, in each snapshot."""
    for path in directory.glob("snapshot_*.h5"):
        with h5py.File(path, "a") as file:
            x = (np.arange(20) + 0.5) * LENGTH / 20
            file["PartType1/Coordinates"] = np.column_stack([x, np.full(20, -5.0), np.zeros(20)])
            file["PartType1/ParticleIDs"] = np.arange(20)


def write_series(directory):
    """series.xdmf and walls.xdmf as the programs write them, and the rows' numbers that these name."""
    def item(path, data):
        return (f'<DataItem Format="HDF" NumberType="{"Float" if data.dtype.kind == "f" else "Int"}" Precision="{data.dtype.itemsize}" '
                f'Dimensions="{" ".join(map(str, data.shape))}">{path.name}:{data.name}</DataItem>')

    for group, name, target in (("PartType0", "fluid", "series.xdmf"), ("PartType1", "wall", "walls.xdmf")):
        text = ""
        for path in sorted(directory.glob("snapshot_*.h5")):
            with h5py.File(path, "a") as file:
                if group not in file:
                    continue
                n = len(file[group]["Coordinates"])
                numbers = file.create_dataset(f"Connectivity{group[-1]}", data=np.arange(n, dtype=np.int32)[:, None])
                text += (f'\n<Grid Name="{name}" GridType="Uniform"><Time Value="{file["Header"].attrs["Time"]}"/>'
                         f'<Topology TopologyType="Polyvertex" NumberOfElements="{n}" NodesPerElement="1">'
                         f'{item(path, numbers)}</Topology><Geometry GeometryType="XYZ">{item(path, file[group]["Coordinates"])}</Geometry>')
                text += "".join(f'<Attribute Name="{key}" AttributeType="{"Scalar" if data.ndim == 1 else "Vector"}" Center="Node">{item(path, data)}'
                                "</Attribute>" for key, data in file[group].items()) + "</Grid>"
        if text:
            (directory / target).write_text('<?xml version="1.0" encoding="utf-8"?>\n<Xdmf Version="3.0"><Domain><Grid Name="series" GridType="Collection" '
                                            f'CollectionType="Temporal">{text}</Grid></Domain></Xdmf>\n')
    return directory


class Case(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.here = Path(scratch.name)

    def assert_refused(self, said, *words, status=2):
        """One sentence, and exit 2, or 4 where a file is at fault."""
        self.assertEqual((said.returncode, said.stdout), (status, ""), said.stderr)
        self.assertEqual(len(said.stderr.strip().splitlines()), 1, said.stderr)
        for word in words:
            self.assertIn(word, said.stderr)


class Loading(Case):
    def test_history_snapshots_and_measures(self):
        run = tetsuame.load(write_run(self.here / "a"))
        self.assertEqual((run.program, run.summary["steps"], len(run.snapshots)), ("rti", 30, 4))
        self.assertEqual((run.history["v_rms"][10], run.history.units["v_rms"], run.history.units["step"]), (1.0, "m/s", "1"))
        self.assertEqual([run.snapshot(time=t).time for t in (-5, 4, 6, 14.9, 99)], [0, 0, 10, 10, 30])
        last = run.snapshot()
        self.assertEqual((last.particles, last["Velocities"].shape, last.unit("Speed")), (144, (144, 2), "m/s"))
        self.assertEqual(run.metrics(), {"mass": 0.0, "growth_rate": 0.5})

    def test_what_is_no_run_or_is_damaged(self):
        run = write_run(self.here / "a")
        (self.here / "empty").mkdir()
        whole = (run / "snapshot_0002.h5").read_bytes()
        self.assert_refused(call("plot", self.here / "none"), "none", "no such directory")
        self.assert_refused(inside.call("plot", self.here / "empty"), "no resolved.nml")
        self.assert_refused(inside.call("plot", run, "--fields", "Magnetism"), "no field 'Magnetism'", "Temperature")
        three = self.here / "three.js"  # any text: these runs are refused before a browser sees it
        three.write_text("")
        for command, *options in (("plot",), ("movie",), ("view", "--three", three), ("paraview",)):
            for size in (0, 100, len(whole) // 2):
                with self.subTest(command, size=size):
                    (run / "snapshot_0002.h5").write_bytes(whole[:size])
                    self.assert_refused(inside.call(command, run, *options), "snapshot_0002.h5", status=4)
        with h5py.File(run / "snapshot_0002.h5", "w") as file:
            file["something"] = 1
        self.assert_refused(inside.call("view", run, "--three", three), "not a snapshot of these programs", status=4)
        (run / "snapshot_0002.h5").unlink()
        (run / "history.csv").write_text("time [s]\nzero\n")
        self.assert_refused(inside.call("plot", run), "history.csv", "not a table", status=4)

    def test_few_fields(self):
        """Whatever &output fields left: what is there is shown, at the start lattice's spacing."""
        three = self.here / "three.js"
        three.write_text("")
        for number, kept in enumerate((["Density", "Pressure"], ["Masses"], ["Velocities"], ["Temperature"], [])):
            run = write_run(self.here / str(number), times=(0, 10))
            for path in run.glob("snapshot_*.h5"):
                with h5py.File(path, "a") as file:
                    for name in set(file["PartType0"]) - {"Coordinates", "ParticleIDs", *kept}:
                        del file["PartType0"][name]
            write_series(run)
            for command, *options in (("plot",), ("movie", "--gif"), ("view", "--three", three), ("paraview",)):
                with self.subTest(command, kept=kept):
                    said = inside.call(command, run, *options)
                    self.assertEqual(said.returncode, 0, said.stderr)
            last = tetsuame.load(run).snapshot()
            np.testing.assert_allclose(last.spacing, LENGTH / 12)
            self.assertEqual("Speed" in last, "Velocities" in kept)
            with open(run / "resolved.nml", "a") as file:
                file.write(f"&domain\n  length_x = {2 * LENGTH}\n  particles_x = 12\n/\n")
            np.testing.assert_allclose(tetsuame.load(run).snapshot().spacing, LENGTH / 6)

    def test_runs_of_different_dimensions(self):
        a, b = write_run(self.here / "a"), write_run(self.here / "b", dimension=3, n=4)
        self.assert_refused(inside.call("compare", a, b), "different dimensions", "a 2, b 3")
        self.assert_refused(inside.call("compare", a), "two directories")


class Rendering(Case):
    def snapshot(self, places, **more):
        write_snapshot(self.here / "snapshot.h5", 0.0, places, **more)
        return runs.Snapshot(self.here / "snapshot.h5")

    def test_linear_fields_are_exact_up_to_the_walls(self):
        for dimension, n in ((2, 16), (3, 10)):
            for axis in range(dimension) if dimension == 3 else [2]:
                with self.subTest(dimension=dimension, axis=axis):
                    snapshot = self.snapshot(places_of(n, dimension))
                    values = 3 * snapshot["Coordinates"][:, 0] - snapshot["Coordinates"][:, 1] + 7
                    picture = rendering.slice_of(snapshot, values, 40, axis, 30.0)
                    place = [None] * 3
                    place[picture.axes[0]], place[picture.axes[1]] = np.meshgrid(picture.x, picture.y)
                    x, y = (30.0 if place[a] is None else place[a] for a in (0, 1))
                    exact = np.clip(3 * x - y + 7, *(values.min() - 0.03 * np.ptp(values), values.max() + 0.03 * np.ptp(values)))
                    self.assertLess(np.abs(picture.values - exact).max(), 1e-9 * np.ptp(values))

    def insulated(self, **keys):
        """A snapshot beside the input of a run that conducts, insulated at the sides."""
        keys = {"thermal": "'adiabatic'", "thermal_bottom": "'fixed'", "thermal_top": "'fixed'", "temperature_bottom": "1.0",
                "temperature_top": "0.0"} | keys
        (self.here / "resolved.nml").write_text("! convection, every key as run\n&material\n  conductivity = 2.0\n/\n&walls\n"
                                                + "".join(f"  {key} = {value}\n" for key, value in keys.items()) + "/\n")
        return self.snapshot(places_of(10, 2))

    def test_isotherms_meet_insulating_walls_at_a_right_angle(self):
        snapshot = self.insulated()
        self.assertEqual([(wall.axis, wall.place, wall.value) for wall in snapshot.mirrors],
                         [(0, 0.0, None), (0, LENGTH, None), (1, 0.0, 1.0), (1, LENGTH, 0.0)])
        x, y = snapshot["Coordinates"].T / LENGTH
        field = 1 - y + 0.3 * np.cos(np.pi * x) * np.sin(np.pi * y)  # nothing flows through the sides; 1 and 0 below and above
        mirrored = rendering.slice_of(snapshot, field, 200, 2, None, snapshot.mirrors)
        plain = rendering.slice_of(snapshot, field, 200, 2, None)
        right, up = mirrored.x / LENGTH, mirrored.y[:, None] / LENGTH
        exact = 1 - up + 0.3 * np.cos(np.pi * right) * np.sin(np.pi * up)
        # What falls or rises between the two pixels next to a side: with the planes of the particles on one side alone far too much.
        for near, next_to_it in ((0, 1), (-1, -2)):
            found, without, true = (field[:, next_to_it] - field[:, near] for field in (mirrored.values, plain.values, exact))
            self.assertLess(np.abs(found - true).max(), 0.005)
            self.assertGreater(np.abs(without - true).max(), 1.5 * np.abs(found - true).max())
        for row in (0, -1):
            self.assertLess(np.abs(mirrored.values[row] - exact[row]).max(), 0.01)
        self.assertLess(np.abs(mirrored.values - exact).max(), 0.03)

    def test_walls_in_which_nothing_is_seen(self):
        self.assertEqual(len(self.insulated(thermal_bottom="'flux'").mirrors), 3)
        self.assertEqual(len(self.insulated(slip_top="'free_surface'").mirrors), 3)
        self.assertEqual([wall.value for wall in self.insulated(thermal="'fixed'", thermal_top="'inherit'", temperature_left="5.0",
                                                                temperature_right="6.0").mirrors], [5.0, 6.0, 1.0, 0.0])
        (self.here / "resolved.nml").write_text("&material\n  conductivity = 0.0\n/\n&walls\n  thermal = 'adiabatic'\n/\n")
        self.assertEqual(self.snapshot(places_of(4, 2)).mirrors, ())
        (self.here / "resolved.nml").unlink()
        self.assertEqual(self.snapshot(places_of(4, 2)).mirrors, ())

    def test_a_periodic_border_leaves_no_trace(self):
        places = places_of(20, 2) % LENGTH
        snapshot = self.snapshot(places, periodic=True)
        wave = np.sin(2 * np.pi * places[:, 0] / LENGTH)
        picture = rendering.slice_of(snapshot, wave, 80, 2, None)
        error = np.abs(picture.values - np.sin(2 * np.pi * picture.x / LENGTH))
        self.assertLess(error[:, [0, 1, -2, -1]].max(), 1.2 * error[:, 2:-2].max())
        self.assertLess(error.max(), 0.03)

    def test_nothing_is_beyond_a_free_surface(self):
        places = places_of(20, 2)
        picture = self.snapshot(places[places[:, 1] < 50]).map("Temperature", 80)
        self.assertFalse(np.isnan(picture.values[picture.y < 48]).any())
        self.assertTrue(np.isnan(picture.values[picture.y > 60]).all())

    def test_a_contact_does_not_overshoot(self):
        places = places_of(20, 2)
        picture = rendering.slice_of(self.snapshot(places), np.where(places[:, 0] > 50, 1.0, 0.0), 80, 2, None)
        self.assertGreaterEqual(picture.values.min(), -0.03)
        self.assertLessEqual(picture.values.max(), 1.03)

    def test_columns_hold_the_mass(self):
        snapshot = self.snapshot(places_of(12, 3), periodic=True)
        picture = snapshot.column("Density", 48, axis=1)
        self.assertAlmostEqual(picture.values.mean() / (3000 * LENGTH), 1, delta=0.01)
        self.assertLess(picture.values.std() / picture.values.mean(), 0.05)
        with self.assertRaisesRegex(reading.Unreadable, "needs three"):
            self.snapshot(places_of(4, 2)).column("Density")

    def test_profiles_are_means_over_layers(self):
        places, values = self.snapshot(places_of(16, 2)).profile("Temperature", axis=0, bins=8)
        self.assertLess(np.abs(values - (300 + 2 * places - 50)).max(), 3)


class Pictures(Case):
    def test_plot(self):
        for dimension, n in ((2, 12), (3, 5)):
            with self.subTest(dimension=dimension):
                run = write_run(self.here / str(dimension), dimension, n)
                said = call("plot", run, "--fields", "Temperature,Density")
                self.assertEqual(said.returncode, 0, said.stderr)
                names = [Path(line).name for line in said.stdout.split()]
                self.assertEqual(names, ["history.png", "map.png", "profile.png"])
                for name in names:
                    self.assertGreater(np.asarray(Image.open(run / "plots" / name)).std(), 10)

    def test_a_run_in_one_dimension_has_a_profile_without_gaps(self):
        run = write_run(self.here / "tube", n=4)
        x = np.r_[np.linspace(1, 50, 50), np.linspace(55, 95, 9)][:, None]  # dense, then thin: layers between the particles are empty
        for path in run.glob("snapshot_*.h5"):
            path.unlink()
        with h5py.File(run / "snapshot_0000.h5", "w") as file:
            file.create_group("Header").attrs.update({"Time": 0.0, "Step": 0, "Dimension": 1, "BoxLengths": [LENGTH] * 3, "Periodic": [0] * 3})
            for name, values in (("Coordinates", np.pad(x, [(0, 0), (0, 2)])), ("Velocities", np.zeros((59, 3))), ("ParticleIDs", np.arange(59)),
                                 ("Volume", np.r_[np.full(50, 1.0), np.full(9, 5.0)]), ("Density", np.r_[np.full(50, 5.0), np.full(9, 1.0)])):
                file[f"PartType0/{name}"] = values
        last = runs.Run(run).snapshot()
        line = plots.profiles([("", last)], ["Density"]).axes[0].lines[0]
        self.assertTrue(np.isfinite(line.get_ydata()).all())
        self.assertGreater(line.get_xdata().max(), 90)
        said = call("plot", run)
        self.assertEqual((said.returncode, [Path(name).name for name in said.stdout.split()]), (0, ["history.png", "profile.png"]), said.stderr)
        said = call("compare", run, run, "--output", self.here / "page")
        self.assertEqual(said.returncode, 0, said.stderr)

    def test_a_body_that_attracts_itself_has_profiles_by_radius(self):
        run = write_run(self.here / "planet", n=6)
        random = np.random.default_rng(3)
        x = random.normal(0.5 * LENGTH, 0.1 * LENGTH, (500, 3))
        x[0] = 40 * LENGTH  # has flown away: not in the picture
        r = np.linalg.norm(x - 0.5 * LENGTH, axis=1)
        for path in run.glob("snapshot_*.h5"):
            path.unlink()
        with h5py.File(run / "snapshot_0000.h5", "w") as file:
            file.create_group("Header").attrs.update({"Time": 0.0, "Step": 0, "Dimension": 3, "BoxLengths": [LENGTH] * 3, "Periodic": [0] * 3})
            for name, values in (("Coordinates", x), ("Velocities", np.zeros((500, 3))), ("ParticleIDs", np.arange(500)), ("Volume", np.full(500, 1.0)),
                                 ("Density", 5.0 - r / LENGTH), ("GravitationalPotential", -1.0 / (1.0 + r / LENGTH))):
                file[f"PartType0/{name}"] = values
        last = runs.Run(run).snapshot()
        ax = plots.profiles([("", last)], ["Density"]).axes[0]
        self.assertTrue(ax.get_xlabel().startswith("radius"))
        drawn = ax.lines[0]
        self.assertEqual(len(drawn.get_xdata()), 495)
        slope = np.polyfit(drawn.get_xdata(), drawn.get_ydata(), 1)[0] * drawn.get_xdata().max()
        self.assertLess(slope, 0.0)
        extent = last.map("Density", 50).extent
        self.assertLess(extent[1], 2 * LENGTH)

    def test_movies(self):
        run = write_run(self.here / "a")
        said = call("movie", run, "--gif")
        self.assertEqual(said.returncode, 0, said.stderr)
        with Image.open(run / "movie.gif") as movie:
            self.assertEqual(movie.n_frames, 4)
        if shutil.which("ffmpeg"):
            said = call("movie", run)
            self.assertEqual(said.returncode, 0, said.stderr)
            probe = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-show_entries", "stream=codec_name,nb_read_frames", "-of", "csv=p=0",
                                    run / "movie.mp4"], capture_output=True, text=True)
            self.assertEqual(probe.stdout.strip(), "h264,4")

    def test_one_snapshot_is_no_movie(self):
        self.assert_refused(inside.call("movie", write_run(self.here / "a", times=(0,))), "one snapshot is no movie")


class ForParaView(Case):
    def state(self, run, *options):
        """The proxies by their kind: each a dictionary of lists."""
        said = call("paraview", run, *options)
        self.assertEqual((said.returncode, said.stdout), (0, f"{run / 'series.pvsm'}\n"), said.stderr)
        proxies = {}
        root = ElementTree.parse(run / "series.pvsm").getroot()
        for proxy in root.iter("Proxy"):
            if "type" in proxy.attrib:
                proxies[proxy.get("type")] = {place.get("name"): [item.get("value") for item in place] for place in proxy.iter("Property")}
        named = {item.get("id") for item in root.findall(".//ProxyCollection/Item")}
        self.assertEqual(named, {proxy.get("id") for proxy in root.iter("Proxy") if "type" in proxy.attrib})
        self.assertLessEqual({proxy.get("value") for proxy in root.findall(".//Property/Proxy")}, named)
        return proxies

    def test_particles_colours_and_times(self):
        run = write_series(write_run(self.here / "a & b"))
        made = self.state(run)
        self.assertEqual(made["Xdmf3ReaderT"]["FileName"], [str((run / "series.xdmf").resolve())])
        particles = made["UnstructuredGridRepresentation"]
        self.assertEqual((particles["Representation"], particles["ColorArrayName"][-1]), (["Point Gaussian"], "Temperature"))
        self.assertAlmostEqual(float(particles["GaussianRadius"][0]), 0.55 * LENGTH / 12, delta=0.01 * LENGTH / 12)
        self.assertEqual((made["ScalarBarWidgetRepresentation"]["Title"], made["TimeToTextConvertor"]["Format"]), (["temperature [K]"], ["t = {time:.4g} s"]))
        scene = made["AnimationScene"]
        self.assertEqual((scene["StartTime"], scene["EndTime"]), (["0"], ["30"]))
        values = [float(value) for value in made["PVLookupTable"]["RGBPoints"]]
        temperatures = np.concatenate([snapshot["Temperature"] for snapshot in tetsuame.load(run).snapshots])
        self.assertTrue(temperatures.min() <= values[0] < values[-4] <= temperatures.max())
        self.assertTrue(all(0 <= values[i] <= 1 for i in range(len(values)) if i % 4))

    def test_two_dimensions_are_seen_from_above_and_three_aslant(self):
        flat = self.state(write_series(write_run(self.here / "flat")))["RenderView"]
        self.assertEqual((flat["CameraParallelProjection"], flat["CameraPosition"][:2]), (["1"], flat["CameraFocalPoint"][:2]))
        self.assertGreater(2 * float(flat["CameraParallelScale"][0]), LENGTH)
        made = self.state(write_series(write_run(self.here / "deep", 3, 4)))
        self.assertEqual((made["RenderView"]["CameraParallelProjection"], made["RenderView"]["CameraViewUp"]), (["0"], ["0", "1", "0"]))
        run = write_run(self.here / "walls", 3, 4)
        write_wall(run)
        made = self.state(write_series(run))
        self.assertEqual(made["Clip"]["Input"], [self.number(run, "Xdmf3ReaderT")])
        self.assertEqual(made["UnstructuredGridRepresentation"]["Input"], [self.number(run, "Clip")])
        self.assertNotIn("walls.xdmf", (run / "series.pvsm").read_text())

    def test_walls_beside_a_flat_fluid(self):
        run = write_run(self.here / "walls")
        write_wall(run)
        made = self.state(write_series(run))
        self.assertEqual(made["Xdmf3ReaderT"]["FileName"], [str((run / "walls.xdmf").resolve())])  # the second of two
        self.assertEqual(made["UnstructuredGridRepresentation"]["ColorArrayName"], [""] * 5)
        (run / "walls.xdmf").unlink()
        self.assert_refused(inside.call("paraview", run), "walls.xdmf", "No such file", status=4)

    def number(self, run, kind):
        return ElementTree.parse(run / "series.pvsm").getroot().find(f".//Proxy[@type='{kind}']").get("id")

    def test_other_fields(self):
        run = write_series(write_run(self.here / "a"))
        for field, title in (("Density", "density [kg/m³]"), ("Speed", "speed [m/s]")):
            made = self.state(run, "--field", field)
            array = made["UnstructuredGridRepresentation"]["ColorArrayName"][-1]
            self.assertEqual((array, made["ScalarBarWidgetRepresentation"]["Title"]), ({"Speed": "Velocities"}.get(field, field), [title]))

    def test_what_cannot_be_shown(self):
        run = write_run(self.here / "a")
        self.assert_refused(inside.call("paraview", self.here), "no resolved.nml")
        self.assert_refused(inside.call("paraview", run), "series.xdmf", "No such file", status=4)
        write_series(run)
        self.assert_refused(inside.call("paraview", run, "--field", "Magnetism"), "no field 'Magnetism'")
        self.assert_refused(inside.call("paraview", run, "--field", "Velocities"), "Velocities is a vector")
        whole = (run / "series.xdmf").read_text()
        (run / "series.xdmf").write_text(whole[:700])
        self.assert_refused(inside.call("paraview", run), "series.xdmf", "damaged", status=4)
        (run / "series.xdmf").write_text(whole)
        (run / "snapshot_0002.h5").unlink()
        self.assert_refused(inside.call("paraview", run), "names snapshot_0002.h5, which is not there", status=4)
        for path in run.glob("snapshot_*.h5"):
            path.unlink()
        self.assert_refused(inside.call("paraview", run), "no snapshot in it")
        self.assertFalse((run / "series.pvsm").exists())

    @unittest.skipUnless(shutil.which("pvbatch") and shutil.which("xvfb-run"), "Debian's paraview, python3-paraview and xvfb are not installed")
    def test_paraview_draws_it(self):
        """From another folder, after the run was moved and the command was run again: fluid and wall at each time, in their colours."""
        script = self.here / "draw.py"
        script.write_text("""
import sys
from paraview.simple import *
LoadState(sys.argv[1] + "/series.pvsm")
view = GetRenderViews()[0]
scene = GetAnimationScene()
scene.GoToFirst()
for index in range(4):
    SaveScreenshot(f"{sys.argv[1]}/{index}.png", view)
    shown = [r for r in view.Representations if hasattr(r, "GaussianRadius")]
    print("seen", view.ViewTime, sum(r.GetRepresentedDataInformation().GetNumberOfPoints() for r in shown), flush=True)
    scene.GoToNext()
""")
        moved = []
        for dimension, n in ((2, 12), (3, 6)):
            run = write_run(self.here / f"{dimension} before", dimension, n)
            write_wall(run)
            self.state(write_series(run))
            moved.append(run.rename(self.here / f"{dimension} after"))
            self.state(moved[-1])
        said = subprocess.run(["xvfb-run", "-a", "-s", "-screen 0 1280x1024x24 -noreset",  # else the server starts anew between two clients
                               "sh", "-c", f'for run; do pvbatch {script} "$run" || exit; done', "sh", *moved], capture_output=True, text=True, cwd="/", timeout=200, env={name: value for name, value in os.environ.items() if name != "PYTHONPATH"})
        self.assertEqual(re.findall("seen (.*)", said.stdout), [f"{t}.0 {shown}" for shown in (144 + 20, 6**3 // 2) for t in (0, 10, 20, 30)],
                         said.stdout + said.stderr)
        for run in moved:
            pictures = [np.asarray(Image.open(run / f"{index}.png").convert("RGB")).astype(int) for index in range(4)]
            self.assertEqual(pictures[0].shape, (900, 1200, 3))
            coloured = np.ptp(pictures[0], axis=2) > 40  # more than ParaView's background
            self.assertGreater(coloured.mean(), 0.15)
            rows, columns = np.nonzero(coloured[:, :1000])
            self.assertTrue(rows.min() > 5 and rows.max() < 895 and columns.min() > 5, "the particles do not fit the picture")
            self.assertGreater(np.abs(pictures[3] - pictures[0]).max(), 20)


class Beside(Case):
    def test_differences_of_fields_by_id(self):
        a, b = write_run(self.here / "a"), write_run(self.here / "b", warmer=0.25)
        said = call("compare", a, b, "--output", self.here / "page")
        self.assertEqual(said.returncode, 0, said.stderr)
        page = (self.here / "page/report.html").read_text()
        self.assertRegex(page, r"time\.dt</td><td class=\"number\">1\.0</td><td class=\"number\">1\.25<")
        self.assertRegex(page, r"growth rate</td><td class=\"number\">0\.5</td><td class=\"number\">0\.75<")
        self.assertRegex(page, r"Pressure \[Pa\]</td><td class=\"number\">144</td><td class=\"number\">0\.25</td><td class=\"number\">0\.25<")
        self.assertRegex(page, r"Temperature \[K\]</td><td class=\"number\">144</td><td class=\"number\">0<")
        self.assertRegex(page, r"Density \[kg/m\^?3?³?\]</td>.*<td class=\"number e0\">0<")
        self.assertRegex(page, r"Pressure \[Pa\]</td>(<td class=\"number\">[\d.]+</td>){3}<td class=\"number e5\">0\.05<")
        self.assertGreater(page.count("<img"), 2)

    def test_titles_are_short_and_different(self):
        names = {"a_run_of_metal_over_silicate_n=24_amplitude=0.001": "…0.001", "a_run_of_metal_over_silicate_n=24_amplitude=0.005": "…0.005"}
        for folder in ("", "one/", "a long way to the folder of all these runs/"):
            made = across.titles([runs.Run(write_run(self.here / f"{folder}x" / name)) for name in names])
            self.assertEqual(made, [f"…amplitude={value.strip('…')}" for value in names.values()])
        self.assertEqual(across.titles([runs.Run(write_run(self.here / f"y/{name}")) for name in ("one", "two")]), ["one", "two"])
        alike = [runs.Run(write_run(self.here / f"z/{'x' * 40}{letter}{'x' * 40}")) for letter in "ab"]
        self.assertEqual([title[:3] for title in across.titles(alike)], ["1: ", "2: "])

    def test_what_machines_do_is_not_compared(self):
        a, b = write_run(self.here / "a"), write_run(self.here / "b", warmer=0.25)
        for number, run in enumerate((a, b), 1):
            summary = json.loads((run / "summary.json").read_text())
            summary["metrics"] |= {"collectives_per_step": -2.29 * number, "waiting_seconds_per_step": 1e-6 * number, "centroid": 0.5 + 1e-9 * number}
            (run / "summary.json").write_text(json.dumps(summary))
        page = across.metrics([("a", runs.Run(a)), ("b", runs.Run(b))])
        self.assertNotIn("collectives", page)
        self.assertNotIn("waiting", page)
        self.assertRegex(page, r"centroid</td><td class=\"number\">0\.50000000\d+</td><td class=\"number\">0\.50000000")  # as many digits as differ

    def test_nothing_of_a_map_is_cut_off(self):
        for wide in (0.2, 1.0, 5.0):
            for count, title in ((1, "a"), (2, "a title that is as long as it may be"), (4, "a title that is as long as it may be")):
                figure, panels = style.map_panels(count, wide, 2)
                for ax in panels:
                    picture = rendering.Map(np.linspace(0, 1e9, 400).reshape(20, 20), (0, wide * 1e5, 0, 1e5), (0, 1))
                    plots.draw_map(ax, picture, "Pressure", "Pa")
                    style.entitle(ax, title, "t = 612.5 s")
                style.room_for_titles(figure, panels)
                figure.canvas.draw()
                box, (width, height) = figure.get_tightbbox(figure.canvas.get_renderer()), figure.get_size_inches()
                style.plt.close(figure)
                with self.subTest(wide=wide, count=count):
                    self.assertGreater(min(box.x0, box.y0, width - box.x1, height - box.y1), -0.05)


class Sweeping(Case):
    """A stand-in for a program, which writes down that it was run, and ends as it is told."""

    def setUp(self):
        super().setUp()
        (self.here / "bin").mkdir()
        program = self.here / "bin/rti"
        program.write_text(f"""#!/bin/sh
echo "$@" >> {self.here}/calls
while [ $# -gt 0 ]; do
  [ "$1" = --output ] && out=$2
  case $2 in rti.n=*) n=${{2#*=}} ;; esac
  shift
done
[ "$n" = 3 ] && [ ! -e {self.here}/mended ] && {{ mkdir -p "$out"; echo half > "$out/history.csv"; echo "bang" >&2; exit 1; }}
mkdir -p "$out"
echo '! rti, every key as run' > "$out/resolved.nml"
echo '{{"status": "completed", "steps": 1, "wall_seconds": 0.1, "errors": null, "conservation": null, "metrics": {{"n_squared": '$((n * n))'}}}}' > "$out/summary.json"
""")
        program.chmod(0o755)
        (self.here / "a.nml").write_text("&rti /\n")
        self.command = ["sweep", self.here / "a.nml", "--program", "rti", "--programs", self.here / "bin", "--output", self.here / "out",
                        "--set", "rti.n=1,2,3,4", "--set", "rti.word='a,b'"]

    def calls(self):
        return sorted(re.findall(r"rti\.n=(\d)", (self.here / "calls").read_text()))

    def test_what_is_complete_is_not_run_again(self):
        said = call(*self.command)
        self.assertEqual(said.returncode, 3, said.stderr)
        self.assertRegex(said.stdout, "n=3_word=-a-b-: exit 1: bang")
        self.assertEqual(self.calls(), ["1", "2", "3", "4"])
        (self.here / "mended").touch()
        said = call(*self.command)
        self.assertEqual(said.returncode, 0, said.stderr)
        self.assertEqual(self.calls(), ["1", "2", "3", "3", "4"])
        self.assertIn("--force", (self.here / "calls").read_text().splitlines()[-1])
        table = (self.here / "out/sweep.csv").read_text().splitlines()
        self.assertEqual((table[0], table[3]), ("rti.n,rti.word,status,steps,wall_seconds,n_squared", "3,\"'a,b'\",completed,1,0.1,9"))

    def test_a_doubtful_run_is_complete_and_shown_as_doubtful(self):
        (self.here / "mended").touch()
        program = self.here / "bin/rti"
        program.write_text(program.read_text().replace('"status": "completed"', '"status": "completed_doubtful"'))
        for _ in range(2):
            said = call(*self.command)
            self.assertEqual(said.returncode, 0, said.stderr)
        self.assertEqual(self.calls(), ["1", "2", "3", "4"])  # not run again
        self.assertIn(",doubtful,", (self.here / "out/sweep.csv").read_text())
        self.assertIn("<td class=\"stop\">doubtful</td>", (self.here / "out/report.html").read_text())

    def test_page(self):
        (self.here / "mended").touch()
        said = call(*self.command)
        self.assertEqual(said.returncode, 0, said.stderr)
        self.assertEqual(said.stdout.splitlines()[-1], f"Report: {self.here / 'out/report.html'}")
        page = (self.here / "out/report.html").read_text()
        self.assertEqual(page.count("data:image/png;base64,iVBOR"), 1)
        self.assertIn("<td class=\"good\">completed</td>", page)
        self.assertRegex(page, r"<td>3</td><td>&#x27;a,b&#x27;</td>.*<td class=\"number\">9</td>")

    def test_two_sweeps_in_one_folder(self):
        (self.here / "out").mkdir()
        held = os.open(self.here / "out", os.O_RDONLY)
        fcntl.flock(held, fcntl.LOCK_EX)
        self.assert_refused(call(*self.command), "another sweep is running in it")
        self.assertFalse((self.here / "calls").exists())
        os.close(held)
        (self.here / "mended").touch()
        self.assertEqual(call(*self.command).returncode, 0)

    def test_another_input_is_not_taken_for_this_one(self):
        call(*self.command)
        (self.here / "a.nml").write_text("&rti  m = 2 /\n")
        said = call(*self.command)
        self.assert_refused(said, "another input")

    def test_bad_command_lines(self):
        self.assert_refused(inside.call(*self.command, "--set", "n=1"), "expected group.key=value")
        self.assert_refused(inside.call("sweep", "none.nml", *self.command[2:]), "no such file")
        self.assert_refused(inside.call(*self.command, "--program", "disph_z"), "no program 'disph_z'")
        self.assert_refused(inside.call(*self.command, "--set", "rti.m=1,1"), "the same folder")


class Viewing(Case):
    def three(self):
        """A stand-in where Debian's package is not installed: what is tested does not draw."""
        if not any(path.is_file() for path in view.LIBRARIES):
            (self.here / "three.min.js").write_text("// three")
            return ["--three", self.here / "three.min.js"]
        return []

    def test_frames_give_the_places_back(self):
        run = write_run(self.here / "a")
        said = call("view", run, "--fields", "Temperature", *self.three())
        self.assertEqual(said.returncode, 0, said.stderr)
        page = (run / "view.html").read_text()
        about = json.loads(re.search(r'id="about">(.*?)</script>', page).group(1))
        self.assertEqual((about["times"], about["particles"], about["slots"]), ([0, 10, 20, 30], [144] * 4, [144, 0]))
        places, values, there = np.zeros((2, 144), np.uint16), np.zeros(144, np.uint8), np.zeros(144, np.uint8)
        low, high = np.array(about["low"]), np.array(about["high"])
        field = about["fields"][0]
        for index, snapshot in enumerate(tetsuame.load(run).snapshots):
            chunk = re.search(rf'id="frame{index}">(.*?)</script>', page).group(1)
            planes = np.frombuffer(zlib.decompress(base64.b64decode(chunk)), np.uint8).reshape(6, 144)
            places += planes[[0, 2]] + 256 * planes[[1, 3]].astype(np.uint16)
            there += planes[4]
            values += planes[5]
            self.assertTrue((there == 1).all())
            order = np.argsort(snapshot["ParticleIDs"])
            here = low + places.T / 65535 * (high - low)
            self.assertLess(np.abs(here - snapshot["Coordinates"][order]).max(), LENGTH / 60000)
            shown = field["low"] + values / 255 * (field["high"] - field["low"])
            inside = np.clip(snapshot["Temperature"][order], field["low"], field["high"])
            self.assertLess(np.abs(shown - inside).max(), (field["high"] - field["low"]) / 500)

    def decoded(self, page):
        """Of each frame, of fluid and bodies: places in metres of those that are there, and how many places there are in all."""
        about = json.loads(re.search(r'id="about">(.*?)</script>', page).group(1))
        low, high, dimension = np.array(about["low"]), np.array(about["high"]), about["dimension"]
        kinds = [[np.zeros((dimension, count), np.uint16), np.zeros(count, np.uint8)] for count in about["slots"]]
        for chunk in re.findall(r'id="frame\d+">(.*?)</script>', page):
            left, found = np.frombuffer(zlib.decompress(base64.b64decode(chunk)), np.uint8), []
            for kind, (places, there) in enumerate(kinds):
                count = len(there)
                planes = left[: (2 * dimension + 1) * count].reshape(-1, count)
                left = left[(2 * dimension + 1 + (len(about["fields"]) if kind == 0 else 0)) * count:]
                places += planes[:-1:2] + 256 * planes[1:-1:2].astype(np.uint16)
                there += planes[-1]
                found.append(low + places.T[there == 1] / 65535 * (high - low))
            self.assertEqual(len(left), 0)
            yield found

    def test_particles_that_come_and_go(self):
        """As in a run of convection that begins on fewer particles, or where others have left. Bodies may move, and be seen anew."""
        for dimension in (2, 3):
            run = write_run(self.here / str(dimension), dimension=dimension, n=4, times=(0, 10))
            write_snapshot(run / "snapshot_0002.h5", 20, places_of(6, dimension), Pressure=np.arange(6.0**dimension))
            write_snapshot(run / "snapshot_0003.h5", 30, places_of(3, dimension), Pressure=np.arange(3.0**dimension))
            snapshots = tetsuame.load(run).snapshots
            blocks = []
            for index, snapshot in enumerate(snapshots):
                block = np.pad(places_of(3, dimension)[: 5 + index] / 4 + index, [(0, 0), (0, 3 - dimension)])
                behind = block - (0, LENGTH, 0)  # a wall below the box is none of the bodies
                with h5py.File(snapshot.path, "a") as file:
                    file["PartType1/Coordinates"] = np.concatenate([block, behind])
                    file["PartType1/ParticleIDs"] = np.arange(2 * len(block))
                blocks.append(block[:, :dimension])
            said = call("view", run, *self.three())
            self.assertEqual(said.returncode, 0, said.stderr)
            frames = list(self.decoded((run / "view.html").read_text()))
            self.assertEqual(len(frames), 4)
            for (fluid, bodies), snapshot, block in zip(frames, snapshots, blocks):
                order = np.argsort(snapshot["ParticleIDs"])
                self.assertLess(np.abs(fluid - snapshot["Coordinates"][order]).max(), LENGTH / 30000)
                self.assertLess(np.abs(bodies - block).max(), LENGTH / 30000)

    def test_a_page_too_large_leaves_snapshots_out(self):
        run = write_run(self.here / "a", n=60, times=range(40))
        whole = call("view", run, *self.three())
        self.assertEqual(whole.returncode, 0, whole.stderr)
        size = (run / "view.html").stat().st_size
        limit = max(size / 1e6 - 0.1, 2)
        if size / 1e6 <= 2:
            self.skipTest("the page is smaller than the smallest limit")
        self.assertEqual(call("view", run, "--megabytes", limit, *self.three()).returncode, 0)
        self.assertLessEqual((run / "view.html").stat().st_size, limit * 1e6)
        self.assertIn("of 40 snapshots", (run / "view.html").read_text())

    def test_in_a_browser(self):
        try:
            from selenium import webdriver
            from selenium.webdriver.common.by import By
            from selenium.webdriver.support.ui import Select
        except ImportError:
            self.skipTest("no python3-selenium")
        driver, browser = shutil.which("chromedriver"), shutil.which("chromium")
        if not driver or not browser or self.three():
            self.skipTest("no chromium-driver, chromium or libjs-three")
        run = write_run(self.here / "a", times=range(0, 30, 2))
        self.assertEqual(call("view", run).returncode, 0)
        options = webdriver.ChromeOptions()
        for argument in ["--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--window-size=1200,800",
                         "--disable-dev-shm-usage", f"--user-data-dir={self.here}/profile"]:
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        page = webdriver.Chrome(service=webdriver.chrome.service.Service(driver), options=options)
        self.addCleanup(page.quit)
        page.get((run / "view.html").as_uri())
        self.wait(lambda: page.execute_script("return window.viewer && viewer.ready"))

        def picture():
            time.sleep(0.3)
            page.save_screenshot(str(self.here / "shot.png"))
            return np.asarray(Image.open(self.here / "shot.png").convert("RGB")).astype(int)[80:600, 50:800]

        particles = picture()
        self.assertGreater(particles.std(), 20)  # not an empty stage
        Select(page.find_element(By.ID, "mode")).select_by_value("rendered")
        rendered = picture()
        self.assertGreater(np.abs(rendered - particles).mean(), 3)
        self.assertGreater(rendered.std(), 20)
        page.find_element(By.ID, "play").click()
        self.wait(lambda: page.execute_script("return viewer.frame") > 3)
        page.find_element(By.ID, "play").click()
        self.assertFalse(page.execute_script("return viewer.playing"))
        Select(page.find_element(By.ID, "field")).select_by_index(0)
        page.execute_script("show(14)")
        self.assertTrue(page.execute_script("return of('cuts').hidden && of('shown').hidden"))
        self.assertEqual(page.find_element(By.ID, "time").text, "t = 28 s")
        self.assertEqual(page.get_log("browser"), [])

        # In 3-D y is upwards, and each cut takes its own side away: the right (x), the top (y), the near (z).
        deep = write_run(self.here / "deep", dimension=3, n=8, times=(0, 10))
        self.assertEqual(call("view", deep).returncode, 0)
        page.get((deep / "view.html").as_uri())
        self.wait(lambda: page.execute_script("return window.viewer && viewer.ready"))

        def left_of(axis):
            page.execute_script(f"of('along').value = {axis}; of('cut').value = 0.5; cut()")
            # Without the lines of the box and letters: what is drawn in colours.
            return np.nonzero(np.ptp(picture(), axis=2) > 40)

        page.execute_script("of('cut').value = 1; cut()")
        all_rows, all_columns = np.nonzero(np.ptp(picture(), axis=2) > 40)
        cut_rows, cut_columns = left_of(0)
        self.assertLess(cut_columns.max(), all_columns.max() - 0.3 * np.ptp(all_columns))
        cut_rows, cut_columns = left_of(1)
        self.assertGreater(cut_rows.min(), all_rows.min() + 0.3 * np.ptp(all_rows))
        self.assertAlmostEqual(cut_rows.max(), all_rows.max(), delta=3)
        cut_rows, cut_columns = left_of(2)
        self.assertLess(cut_rows.max(), all_rows.max() - 10)
        self.assertEqual(page.get_log("browser"), [])

    def wait(self, until, seconds=30):
        end = time.monotonic() + seconds
        while not until():
            self.assertLess(time.monotonic(), end, "the page does not get there")
            time.sleep(0.1)


if __name__ == "__main__":
    unittest.main()
