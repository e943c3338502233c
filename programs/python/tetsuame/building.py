"""A building of columns and floors as a surface of triangles, for &solids of program flow: `tetsuame building FILE.stl`.

Boxes that touch or overlap are one solid. Its surface is made of rectangles between all planes of all boxes, so that triangles meet
edge to edge, and no face lies inside."""
import argparse
import itertools
import math
import struct
from pathlib import Path

import numpy as np

from . import COMPLETED, writing

MOST = 100  # bays and storeys: the triangles are counted over all planes of all boxes
Box = tuple[tuple[float, float, float], tuple[float, float, float]]  # lowest and highest corner, m


def frame(bays: tuple[int, int], storeys: int, opening: float, clear: float, thickness: float, foundation: float) -> list[Box]:
    """Columns in rows along x and z, `opening` (m) between two, and a slab on each storey's columns, `clear` (m) above the last; y is
    upwards. The columns are as thick as the slabs, and go on as far beneath the ground as `foundation` (m)."""
    places = [[k * (opening + thickness) for k in range(n + 1)] for n in bays]
    width, depth = (row[-1] + thickness for row in places)
    top = storeys * (clear + thickness)
    columns = [((x, -foundation, z), (x + thickness, top, z + thickness)) for x, z in itertools.product(*places)]
    floors = [k * (clear + thickness) + clear for k in range(storeys)]
    return columns + [((0.0, y, 0.0), (width, y + thickness, depth)) for y in floors]


def surface(boxes: list[Box]) -> np.ndarray:
    """Triangles of the boxes' union, [triangle][corner][x, y, z], counterclockwise from outside."""
    lines = [np.unique([corner[axis] for box in boxes for corner in box]) for axis in range(3)]
    filled = np.zeros([len(line) + 1 for line in lines], dtype=bool)  # with an empty cell beyond either end
    for low, high in boxes:
        filled[tuple(slice(np.searchsorted(line, a) + 1, np.searchsorted(line, b) + 1)
                     for line, a, b in zip(lines, low, high))] = True
    triangles = []
    for axis in range(3):
        one, two = (axis + 1) % 3, (axis + 2) % 3
        change = np.diff(filled.astype(int), axis=axis)  # 1: solid begins
        for cell in np.argwhere(change != 0):
            corner = [None] * 3
            corner[axis] = [lines[axis][cell[axis]]] * 2
            for along in (one, two):
                corner[along] = [lines[along][cell[along] - 1], lines[along][cell[along]]]
            around = [(0, 0), (1, 0), (1, 1), (0, 1)]
            if change[tuple(cell)] > 0:
                around.reverse()
            rectangle = []
            for a, b in around:
                point = np.empty(3)
                point[axis], point[one], point[two] = corner[axis][0], corner[one][a], corner[two][b]
                rectangle.append(point)
            triangles += [[rectangle[0], rectangle[1], rectangle[2]], [rectangle[0], rectangle[2], rectangle[3]]]
    return np.array(triangles)


def write_stl(path: Path, triangles: np.ndarray) -> None:
    """Binary; normals are left zero, since the corners' order tells them."""
    records = np.zeros(len(triangles), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    records["corners"] = triangles
    writing.contents(path, b"columns and floors".ljust(80) + struct.pack("<I", len(triangles)) + records.tobytes())


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="tetsuame building", formatter_class=argparse.ArgumentDefaultsHelpFormatter,
                                     description="Write a building of columns and floors as an STL surface, in metres, with y upwards; "
                                                 "its lowest corner in x and z, on the ground, is the origin.")
    parser.add_argument("file", type=Path, metavar="FILE.stl")
    parser.add_argument("--bays", type=int, nargs=2, default=(2, 2), metavar=("X", "Z"), help="openings between columns along x and z")
    parser.add_argument("--storeys", type=int, default=2, help="floors above the ground")
    parser.add_argument("--opening", type=float, default=0.24, help="width between columns (m)")
    parser.add_argument("--clear", type=float, default=0.24, help="height between floors (m)")
    parser.add_argument("--thickness", type=float, default=0.12, help="of columns and floors (m)")
    parser.add_argument("--foundation", type=float, default=0.12, help="how far the columns go on beneath the ground (m)")
    given = parser.parse_args(arguments)
    if min(*given.bays, given.storeys) < 1:
        parser.error("--bays and --storeys are at least 1")
    if max(*given.bays, given.storeys) > MOST:
        parser.error(f"--bays and --storeys are at most {MOST}")
    if not all(0.0 < length < math.inf for length in (given.opening, given.clear, given.thickness, given.foundation)):
        parser.error("--opening, --clear, --thickness and --foundation are lengths above 0")
    triangles = surface(frame(tuple(given.bays), given.storeys, given.opening, given.clear, given.thickness, given.foundation))
    write_stl(given.file, triangles)
    print(f"{given.file}: {len(triangles)} triangles")
    return COMPLETED
