"""Reads DIRECTORY as a stranger would: snapshots by h5py, series.xdmf by an XML reader.

usage: check_snapshot.py DIRECTORY FLUID WALL SNAPSHOTS
Values follow value() of scratch.hpp.
"""
import os
import sys
import xml.etree.ElementTree as xml

import h5py
import numpy as np


def value(ids, field):
    return (ids + 0.1) / 3.0 * (field + 1) * np.where(ids % 2 == 0, 1e-12, -1e12)


def within_period(x, length):
    """What lies beyond a periodic side comes in at the other."""
    x = np.where(x < 0, x + length, x)
    return np.where(x >= length, x - length, x)


def check_header(f, counts):
    header = f["Header"].attrs
    assert list(header["NumPart_ThisFile"]) == counts + [0] * 4
    assert list(header["NumPart_Total"]) == counts + [0] * 4
    assert list(header["NumPart_Total_HighWord"]) == [0] * 6
    assert list(header["MassTable"]) == [0.0] * 6
    assert header["NumFilesPerSnapshot"] == 1 and header["Redshift"] == 0.0
    assert header["BoxSize"] == 2.0 and list(header["BoxLengths"]) == [2.0, 1.0, 0.0]
    assert list(header["Periodic"]) == [1, 0, 0] and header["Dimension"] == 2
    assert header["KernelSupport"] == 3.0
    for flag in "Sfr Cooling StellarAge Metals Feedback Entropy_ICs".split():
        assert header["Flag_" + flag] == 0
    provenance = f["Provenance"]
    assert provenance.attrs["Program"] == b"disph_c" and provenance.attrs["Version"] == b"abc123"
    assert provenance["ResolvedInput"][()].decode() == "&domain\n  length_x = 2.0 ! 鉄\n/\n"


def check_particles(f, kind, n, first):
    group = f[f"PartType{kind}"]
    ids = group["ParticleIDs"][...]
    assert ids.dtype == np.int64 and np.array_equal(ids, first + np.arange(n))
    for name, fields, units in (("Coordinates", (0, 1), b"m"), ("Velocities", (2, 3), b"m/s")):
        data = group[name]
        assert data.shape == (n, 3) and data.dtype == np.float64 and data.attrs["units"] == units
        for component, field in enumerate(fields):
            wanted = value(ids, field)
            if name == "Coordinates" and component == 0:  # the periodic axis
                wanted = within_period(wanted, 2.0)
            assert np.array_equal(data[:, component], wanted), name
        assert not np.any(data[:, 2])
    assert group["Density"].shape == (n,) and np.array_equal(group["Density"][...], value(ids, 4))
    for name, data in group.items():
        assert data.attrs["units"] and data.attrs["description"], name
    assert np.array_equal(f[f"Connectivity{kind}"][...], np.arange(n).reshape(n, 1))


def check_series(directory, series, kind, times):
    root = xml.parse(os.path.join(directory, series)).getroot()
    collection = root.find("Domain/Grid")
    assert collection.get("CollectionType") == "Temporal"
    grids = collection.findall("Grid")
    assert [float(g.find("Time").get("Value")) for g in grids] == times
    items = 0
    for grid in grids:
        # Grids within the grid of a time are unknown to some readers.
        assert grid.get("Name") == kind and grid.get("GridType") == "Uniform" and grid.find("Grid") is None
        assert grid.find("Geometry") is not None and grid.find("Topology/DataItem") is not None
        for item in grid.iter("DataItem"):
            name, path = item.text.split(":")
            with h5py.File(os.path.join(directory, name), "r") as f:
                data = f[path]
                assert data.shape == tuple(map(int, item.get("Dimensions").split())), path
                assert data.dtype.itemsize == int(item.get("Precision")), path
                assert data.dtype.kind == {"Int": "i", "Float": "f"}[item.get("NumberType")], path
                assert data.shape[0] == int(grid.find("Topology").get("NumberOfElements"))
            items += 1
    assert items == len(times) * 6


directory, fluid, wall, snapshots = sys.argv[1], *map(int, sys.argv[2:])
for number in range(snapshots):
    with h5py.File(os.path.join(directory, f"snapshot_{number:04}.h5"), "r") as snapshot:
        check_header(snapshot, [fluid, wall])
        assert snapshot["Header"].attrs["Time"] == 0.5 * number
        check_particles(snapshot, 0, fluid, 0)
        check_particles(snapshot, 1, wall, fluid)
for series, kind in (("series.xdmf", "fluid"), ("walls.xdmf", "wall")):
    check_series(directory, series, kind, [0.5 * k for k in range(snapshots)])
