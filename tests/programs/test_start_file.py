"""Snapshots as a start, in the many forms that programs and people write: read with the same values, or refused with the place."""

import os
import shutil
import unittest

import h5py
import numpy as np

from running import BAD_INPUT, COMPLETED, FILE_FAILED, Case, outcome

N, EDGE = 8, 1.6e5  # particles along an axis, m: the spacing is 20 km
INPUT = f"""&domain  length_x = {EDGE}  length_y = {EDGE}  particles_x = {N}  particles_y = {N}
  periodic_x = .true.  periodic_y = .true.  jitter = 0.1 /
&initial  temperature = 3000  pressure = 1e10 /
&material  eos = 'liquid_iron' /
&kernel  h_over_dx = 0.9 /
&time  dt = 1e-3  steps = 1 /
"""
FIELDS = ["Coordinates", "Velocities", "Density", "Temperature", "Masses"]
UNITS = ["UnitLength_in_cm", "UnitMass_in_g", "UnitVelocity_in_cm_per_s"]
SAME, READ = "same values", "read"


def scaled(file, field, factor, units=None):
    """The field in another unit, which its attribute says; without any where it is None."""
    data = file["PartType0"][field]
    data[...] = data[...] * factor
    del data.attrs["units"]
    if units is not None:
        data.attrs["units"] = units


def bare(file, fields=FIELDS):
    """Without units of the datasets."""
    for field in fields:
        del file["PartType0"][field].attrs["units"]


def silent(file):
    """Without any units, as a script may write it."""
    bare(file)
    for name in UNITS:
        del file["Header"].attrs[name]


def replace(file, field, values, **attributes):
    group = file["PartType0"]
    old = dict(group[field].attrs) if field in group else {}
    if field in group:
        del group[field]
    group[field] = values
    group[field].attrs.update({**old, **attributes})


def header(file, **attributes):
    for name, value in attributes.items():
        file["Header"].attrs.pop(name, None)
        if value is not None:
            file["Header"].attrs[name] = value


def set_value(field, row, value):
    def work(file):
        file["PartType0"][field][row] = value
    return work


def to_km(file):
    """As GADGET does it: the file's unit system, and BoxSize in it."""
    bare(file)
    header(file, UnitLength_in_cm=1e5, UnitMass_in_g=1e9, UnitVelocity_in_cm_per_s=1e5, BoxSize=EDGE / 1e3, BoxLengths=None)
    for field, factor in {"Coordinates": 1e-3, "Velocities": 1e-3, "Density": 1e-6 * 1e9, "Masses": 1e-6 * 1e3}.items():
        file["PartType0"][field][...] *= factor  # 1e6 kg/km^3 is 1e-3 kg/m^3, 1e6 kg/km is 1e3 kg/m


def to_swift(file):
    """A group Units, BoxSize along each axis, no units of datasets."""
    silent(file)
    header(file, BoxSize=[EDGE * 1e2, EDGE * 1e2, 0.0], BoxLengths=None, Redshift=[0.0], NumFilesPerSnapshot=[1])
    units = file.create_group("Units")
    for name, value in {"current": 1, "length": 1, "mass": 1, "temperature": 1, "time": 1}.items():
        letter = {"current": "I", "length": "L", "mass": "M", "temperature": "T", "time": "t"}[name]
        units.attrs[f"Unit {name} in cgs (U_{letter})"] = [float(value)]
    for field, factor in {"Coordinates": 1e2, "Velocities": 1e2, "Density": 1e-3, "Masses": 1e3 / 1e2}.items():
        file["PartType0"][field][...] *= factor


def to_gadget_4(file):
    """Factors to cgs at each dataset, single precision."""
    silent(file)
    header(file, BoxSize=EDGE / 1e3, BoxLengths=None, Dimension=None)
    for field, factor, cgs in [("Coordinates", 1e-3, 1e5), ("Velocities", 1.0, 1e2), ("Density", 1.0, 1e-3), ("Masses", 1e3, 1e3)]:
        replace(file, field, (file["PartType0"][field][...] * factor).astype(np.float32 if field != "Coordinates" else float))
        file["PartType0"][field].attrs["to_cgs"] = cgs
    file["PartType0/Temperature"].attrs["to_cgs"] = 1.0
    file.create_group("Parameters").attrs["UnitLength_in_cm"] = 1e5


def by_one(file, shift, dtype=np.int64):
    ids = file["PartType0/ParticleIDs"][...]
    replace(file, "ParticleIDs", ids.astype(dtype) + dtype(shift))


def external(file, other):
    shutil.copy(file.filename, other)
    del file["PartType0/Coordinates"]
    file["PartType0/Coordinates"] = h5py.ExternalLink(os.path.basename(other), "PartType0/Coordinates")


def reversed_rows(file):
    for field in file["PartType0"].values():
        field[...] = field[...][::-1]


def external_storage(file):
    del file["PartType0/Masses"]
    file["PartType0"].create_dataset("Masses", shape=(N * N,), dtype=float, external=[("masses.raw", 0, 8 * N * N)])


def virtual(file):
    source = h5py.VirtualSource("elsewhere.h5", "Masses", shape=(N * N,))
    layout = h5py.VirtualLayout(shape=(N * N,), dtype=float)
    layout[:] = source
    del file["PartType0/Masses"]
    file["PartType0"].create_virtual_dataset("Masses", layout)


def compressed(file, field, **how):
    group = file["PartType0"]
    values = group[field][...]
    del group[field]
    group.create_dataset(field, data=values, **how)  # without its unit: the header's holds


# What is done to a snapshot of ours; then SAME, or the exit status and parts of the message.
FORMS = {
    "as it is": (lambda file: None, SAME),
    "rows in another order": (reversed_rows, SAME),
    # ---- units
    "places in km, by attribute": (lambda f: scaled(f, "Coordinates", 1e-3, "km"), SAME),
    "attribute of fixed length": (lambda f: scaled(f, "Coordinates", 1e-3, np.bytes_("km")), SAME),
    "speeds in cm s-1": (lambda f: scaled(f, "Velocities", 1e2, "cm s-1"), SAME),
    "densities in g/cm^3": (lambda f: scaled(f, "Density", 1e-3, "g/cm**3"), SAME),
    "masses in t/m": (lambda f: scaled(f, "Masses", 1e-3, "Mg/m"), SAME),
    "kilometres as a unit system": (to_km, SAME),
    "SWIFT": (to_swift, SAME),
    "GADGET-4": (to_gadget_4, SAME),
    "no units of datasets": (bare, SAME),  # the header's are left
    "no units at all": (silent, BAD_INPUT, "PartType0/Coordinates", "says no unit"),
    "an unknown unit": (lambda f: scaled(f, "Velocities", 1.0, "knots"), BAD_INPUT, "PartType0/Velocities", "'knots'", "m/s"),
    "a unit of something else": (lambda f: scaled(f, "Density", 1.0, "m/s"), BAD_INPUT, "PartType0/Density", "kg/m^3"),
    "densities in g/cm^3, unsaid": (lambda f: f["PartType0/Density"].write_direct(f["PartType0/Density"][...] / 1e3), BAD_INPUT,
                                    "particle 0", "Density is 7.0", "kg/m^3"),
    "masses in g, unsaid": (lambda f: f["PartType0/Masses"].write_direct(f["PartType0/Masses"][...] * 1e3), BAD_INPUT, "particle 0", "volume"),
    "masses of twice the depth": (lambda f: f["PartType0/Masses"].write_direct(f["PartType0/Masses"][...] * 2), BAD_INPUT, "fill"),
    "places in km, unsaid": (lambda f: f["PartType0/Coordinates"].write_direct(f["PartType0/Coordinates"][...] / 1e3), BAD_INPUT, "particle 0",
                            "Coordinates are of another unit"),
    "a unit of zero": (lambda f: (bare(f), header(f, UnitLength_in_cm=0.0)), BAD_INPUT, "UnitLength_in_cm is 0"),
    "units of 1/h": (lambda f: header(f, HubbleParam=0.7), BAD_INPUT, "HubbleParam is 0.7"),
    "comoving": (lambda f: header(f, Redshift=2.0), BAD_INPUT, "redshift 2"),
    # ---- the box
    "a box of another size": (lambda f: header(f, BoxLengths=[2e5, 2e5, 0.0], BoxSize=None), BAD_INPUT, "200000 x 200000", "160000 x 160000 m"),
    "a box of zero": (lambda f: header(f, BoxLengths=[0.0, 0.0, 0.0]), BAD_INPUT, "0 x 0", "160000 x 160000 m"),
    "BoxSize of another": (lambda f: header(f, BoxSize=160.0), BAD_INPUT, "BoxSize is 160 m", "160000 x 160000 m"),
    "BoxSize alone": (lambda f: header(f, BoxLengths=None), SAME),
    "no box": (lambda f: header(f, BoxLengths=None, BoxSize=None), BAD_INPUT, "neither BoxSize nor BoxLengths"),
    "a box that is no number": (lambda f: header(f, BoxSize="large"), BAD_INPUT, "BoxSize"),
    "a box not finite": (lambda f: header(f, BoxSize=float("nan")), BAD_INPUT, "BoxSize is nan"),
    # ---- IDs
    "IDs from 1": (lambda f: by_one(f, 1), SAME),
    "IDs from 2^62": (lambda f: by_one(f, 2**62), SAME),
    "IDs beyond 2^63": (lambda f: by_one(f, 2**63, np.uint64), SAME),
    "IDs of 32 bits": (lambda f: by_one(f, 0, np.uint32), SAME),
    "an ID twice": (set_value("ParticleIDs", 5, 9), BAD_INPUT, "same ID, 9"),
    "an ID below 0": (set_value("ParticleIDs", 5, -1), BAD_INPUT, "row 5", "-1"),
    "IDs that are real": (lambda f: replace(f, "ParticleIDs", np.arange(N * N) + 0.5), BAD_INPUT, "ParticleIDs"),
    # ---- values
    "a place not finite": (set_value("Coordinates", (3, 1), float("nan")), BAD_INPUT, "particle 3", "Coordinates along y"),
    "a place far outside": (set_value("Coordinates", (3, 0), 3 * EDGE), BAD_INPUT, "particle 3", "x = 480000 m", "160000"),
    "a place a little outside": (lambda f: replace(f, "Coordinates", f["PartType0/Coordinates"][...] - [0.45 * EDGE / N, 0, 0]), READ),
    "two at one place": (lambda f: set_value("Coordinates", 7, f["PartType0/Coordinates"][21])(f), BAD_INPUT, "7 and 21", "same place"),
    "two across a border": (lambda f: (set_value("Coordinates", 7, [EDGE, 5e3, 0])(f), set_value("Coordinates", 12, [0, 5e3, 0])(f)), BAD_INPUT,
                            "7 and 12", "same place"),
    "a speed not finite": (set_value("Velocities", (7, 0), float("inf")), BAD_INPUT, "particle 7", "Velocities along x"),
    "a speed out of the plane": (set_value("Velocities", (7, 2), 1.0), BAD_INPUT, "particle 7", "along z"),
    "a temperature of zero": (set_value("Temperature", 4, 0.0), BAD_INPUT, "particle 4", "Temperature is 0 K"),
    "a temperature not finite": (set_value("Temperature", 4, float("nan")), BAD_INPUT, "particle 4", "Temperature"),
    "a density below zero": (set_value("Density", 4, -7000.0), BAD_INPUT, "particle 4", "Density"),
    "a density far off": (set_value("Density", 4, 7e4), BAD_INPUT, "particle 4", "Density is 70000"),
    "a mass of zero": (set_value("Masses", 9, 0.0), BAD_INPUT, "particle 9", "mass is 0"),
    "a mass not finite": (set_value("Masses", 9, float("nan")), BAD_INPUT, "particle 9", "Masses"),
    "a material that is not there": (set_value("Material", 9, 1), BAD_INPUT, "particle 9", "Material is 1"),
    # ---- shapes and types
    "two columns": (lambda f: [replace(f, name, f["PartType0"][name][:, :2]) for name in ("Coordinates", "Velocities")], SAME),
    "single precision": (lambda f: [replace(f, name, f["PartType0"][name][...].astype(np.float32)) for name in ("Density", "Temperature")], SAME),
    "big-endian": (lambda f: [replace(f, name, f["PartType0"][name][...].astype(">f8")) for name in FIELDS], SAME),
    "a column of one": (lambda f: replace(f, "Density", f["PartType0/Density"][...][:, None]), SAME),
    "compressed": (lambda f: compressed(f, "Density", compression="gzip", shuffle=True, chunks=(10,)), SAME),
    "compressed by a filter of h5py": (lambda f: compressed(f, "Density", compression="lzf"), FILE_FAILED, "PartType0/Density", "filter 32000"),
    "no Dimension": (lambda f: header(f, Dimension=None), SAME),
    "no Provenance": (lambda f: f.__delitem__("Provenance"), SAME),
    "three dimensions": (lambda f: header(f, Dimension=3), BAD_INPUT, "3 dimensions"),
    "a column too few": (lambda f: replace(f, "Velocities", f["PartType0/Velocities"][:, 0]), BAD_INPUT, "Velocities"),
    "transposed": (lambda f: replace(f, "Coordinates", f["PartType0/Coordinates"][...].T), BAD_INPUT, "rows"),
    "a row too few": (lambda f: replace(f, "Masses", f["PartType0/Masses"][:-1]), BAD_INPUT, "Masses", "63"),
    "a text": (lambda f: replace(f, "Density", np.full(N * N, b"7000")), BAD_INPUT, "Density", "numbers"),
    "one value": (lambda f: replace(f, "Density", 7000.0), BAD_INPUT, "Density", "one value"),
    "complex": (lambda f: replace(f, "Temperature", np.full(N * N, 3000 + 0j)), BAD_INPUT, "Temperature", "numbers"),
    "no temperature": (lambda f: f.__delitem__("PartType0/Temperature"), BAD_INPUT, "no field Temperature"),
    "energy in its place": (lambda f: f["PartType0"].move("Temperature", "InternalEnergy"), BAD_INPUT, "Temperature", "InternalEnergy"),
    "no masses": (lambda f: f.__delitem__("PartType0/Masses"), BAD_INPUT, "no field Masses"),
    "a table of masses": (lambda f: (header(f, MassTable=[f["PartType0/Masses"][0] * 1.0, 0, 0, 0, 0, 0]), f.__delitem__("PartType0/Masses")), SAME),
    "no particles": (lambda f: f.__delitem__("PartType0"), BAD_INPUT, "no group PartType0"),
    "dark matter": (lambda f: f.create_group("PartType2").create_dataset("Coordinates", data=np.zeros((3, 3))), BAD_INPUT, "PartType2 holds 3"),
    "one of several files": (lambda f: header(f, NumFilesPerSnapshot=4), BAD_INPUT, "one of 4 files"),
    "another number in the header": (lambda f: header(f, NumPart_ThisFile=[63, 0, 0, 0, 0, 0]), BAD_INPUT, "63"),
    # ---- other files
    "a link to another file": (lambda f: external(f, f.filename + ".other"), BAD_INPUT, "PartType0/Coordinates", "another file"),
    "values in another file": (external_storage, FILE_FAILED, "PartType0/Masses", "other files"),
    "virtual": (virtual, BAD_INPUT, "PartType0/Masses", "another file"),
}


class Forms(Case):
    def setUp(self):
        super().setUp()
        self.input = self.here / "box.nml"
        self.input.write_text(INPUT)
        made = self.run_program("disph_c", self.input, {}, output="made")
        self.ours = made.directory / "snapshot_0000.h5"
        with h5py.File(self.ours) as file:
            self.wanted = {name: file["PartType0"][name][...] for name in FIELDS}

    def start(self, path, directory, **settings):
        return self.call("disph_c", *self.arguments(self.input, {"initial.file": f"'{path}'", "time.steps": 0, **settings}, directory))

    def test_forms(self):
        for number, (name, (work, wanted, *parts)) in enumerate(FORMS.items()):
            with self.subTest(name):
                path, directory = self.here / "start.h5", self.here / f"run{number}"
                shutil.copy(self.ours, path)
                with h5py.File(path, "r+") as file:
                    work(file)
                result = self.start(path, directory)
                if wanted in (SAME, READ):
                    self.assertEqual(result.status, COMPLETED, result)
                    if wanted == SAME:
                        self.assert_same(directory)
                    continue
                self.assert_says(result, wanted, "start.h5", *parts)
                self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
                self.assertFalse(directory.exists())

    def assert_same(self, directory):
        with h5py.File(directory / "snapshot_0000.h5") as file:
            for name, values in self.wanted.items():
                np.testing.assert_allclose(file["PartType0"][name][...], values, rtol=1e-6, atol=1e-6 * abs(values).max(), err_msg=name)

    def test_no_snapshot(self):
        path = self.here / "start.h5"
        for what, make, parts in [("nothing", lambda: None, ["there is no file"]), ("a text", lambda: path.write_text("no HDF5"), ["signature"]),
                                  ("half of it", lambda: path.write_bytes(self.ours.read_bytes()[:20000]), ["start.h5"]),
                                  ("a pipe", lambda: os.mkfifo(path), ["start.h5"]), ("a folder", path.mkdir, ["start.h5"])]:
            with self.subTest(what):
                make()
                result = self.start(path, self.here / "no")
                self.assertIn(result.status, (BAD_INPUT, FILE_FAILED), result)
                self.assert_says(result, result.status, *parts)
                self.assertFalse((self.here / "no").exists())
                if path.is_dir():
                    path.rmdir()
                elif path.exists():
                    path.unlink()

    def test_a_link_to_a_pipe(self):
        """Which would be waited for."""
        path = self.here / "start.h5"
        os.mkfifo(self.here / "pipe.h5")
        shutil.copy(self.ours, path)
        with h5py.File(path, "r+") as file:
            file["PartType0/Note"] = h5py.ExternalLink("pipe.h5", "/x")
        result = self.start(path, self.here / "note")
        self.assertEqual(result.status, COMPLETED, result)
        with h5py.File(path, "r+") as file:
            file["PartType0"].move("Temperature", "T")
            file["PartType0/Temperature"] = h5py.ExternalLink("pipe.h5", "/x")
        self.assert_says(self.start(path, self.here / "no"), BAD_INPUT, "PartType0/Temperature", "another file")


class OwnSnapshots(Case):
    def test_of_a_periodic_box_within_it(self):
        """Particles that have just left through a periodic side are written where they come in, and such a snapshot is a start."""
        given = self.here / "box.nml"
        given.write_text(INPUT.replace("jitter = 0.1", "jitter = 0"))
        made = self.run_program("disph_c", given, {}, output="made")
        path = self.here / "start.h5"
        shutil.copy(made.directory / "snapshot_0000.h5", path)
        with h5py.File(path, "r+") as file:
            file["PartType0/Coordinates"][:, 0] -= 0.499 * EDGE / N
            file["PartType0/Velocities"][:, 0] = -100.0  # 60 m to the side: two spacings' thousandth
        moved = self.run_program("disph_c", given, {"initial.file": f"'{path}'", "time.steps": 3, "time.dt": 0.1, "output.interval": 0.1}, output="moved")
        for number in range(4):
            with h5py.File(moved.directory / f"snapshot_{number:04}.h5") as file:
                places, displaced = file["PartType0/Coordinates"][:, :2], file["PartType0/Displacement"][:, 0]
            self.assertTrue(((places >= 0) & (places < EDGE)).all(), places.min())
            np.testing.assert_allclose(displaced, -10.0 * number, rtol=1e-3, atol=1e-2)
        self.assertGreater(places[:, 0].max(), 0.99 * EDGE)
        last = moved.directory / "snapshot_0003.h5"
        again = self.run_program("disph_c", given, {"initial.file": f"'{last}'"}, output="again")
        self.assertEqual(again.summary["status"], "completed")

    def test_the_kernels_support_is_told(self):
        for kernel, support in [("quintic", 3.0), ("wendland_c2", 2.0)]:
            given = self.here / "box.nml"
            given.write_text(INPUT)
            made = self.run_program("disph_c", given, {"kernel.name": kernel})
            with h5py.File(made.directory / "snapshot_0000.h5") as file:
                h = file["PartType0/SmoothingLength"]
                self.assertEqual((file["Header"].attrs["KernelSupport"], h.attrs["KernelSupport"]), (support, support))
                self.assertIn(b"KernelSupport", h.attrs["description"])

    def test_restart_and_ranks(self):
        given = self.here / "box.nml"
        given.write_text(INPUT.replace("steps = 1 ", "steps = 6 "))
        made = self.run_program("disph_c", given, {}, output="made")
        path = self.here / "start.h5"
        shutil.copy(made.directory / "snapshot_0001.h5", path)
        with h5py.File(path, "r+") as file:
            by_one(file, 2**62)
        settings = {"initial.file": f"'{path}'"}
        whole = self.run_program("disph_c", given, settings)
        self.assertEqual(outcome(self.run_program("disph_c", given, settings, ranks=2).summary), outcome(whole.summary))
        self.run_program("disph_c", given, {**settings, "time.steps": 3}, output="part")
        again = self.run_program("disph_c", given, settings, output="part", options=["--restart", "latest"])
        self.assertEqual(outcome(again.summary), outcome(whole.summary))


if __name__ == "__main__":
    unittest.main()
