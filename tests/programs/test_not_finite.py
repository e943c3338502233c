"""A number that is none, in any field that is integrated over time, ends the run of any program in that step, with the
particle and the field.

What no input lets in is written into a checkpoint, as modules/output/checkpoint.cpp describes it, with its checksums.
"""

import pathlib
import re
import struct
import unittest

import numpy

from running import CALCULATION_FAILED, COMPLETED, Case

MAGIC = b"tetsuame checkpoint 1 "
BODY = len(MAGIC) + 33
WORD = numpy.uint64


def mix(x):
    x = (x ^ (x >> WORD(30))) * WORD(0xbf58476d1ce4e5b9)
    x = (x ^ (x >> WORD(27))) * WORD(0x94d049bb133111eb)
    return x ^ (x >> WORD(31))


def checksum(content):
    """modules/output/hash.hpp."""
    words = numpy.frombuffer(content + b"\0" * (-len(content) % 8), dtype="<u8")
    at = numpy.arange(len(words), dtype=WORD)
    with numpy.errstate(over="ignore"):
        a = numpy.sum(mix(words ^ mix(at + WORD(0x9e3779b97f4a7c15))), dtype=WORD)
        b = numpy.sum(mix(words + mix(at ^ WORD(0xd1b54a32d192ed03))), dtype=WORD)
    return f"{int(a):016x}{int(b):016x}"


class Checkpoint:
    def __init__(self, path):
        self.content = bytearray(path.read_bytes())
        self.block = int(self.content[BODY:].split(b"\n", 1)[0].split()[2])
        self.lines = self.content[BODY:self.block].rstrip(b"\0").decode().splitlines()
        self.fields = {line.split(" ", 5)[5]: number for number, line in enumerate(self.lines) if line.startswith(("field_real ", "ids "))}

    def with_value(self, path, row, value):
        """The file's bytes with another value in that row of that field."""
        content = bytearray(self.content)
        kind, count, offset, length, _, name = self.lines[self.fields[path]].split(" ", 5)
        begin, end = int(offset), int(offset) + int(length)
        content[begin + 8 * row:begin + 8 * row + 8] = struct.pack("<d", value)
        lines = list(self.lines)
        lines[self.fields[path]] = " ".join([kind, count, offset, length, checksum(bytes(content[begin:end])), name])
        body = ("\n".join(lines) + "\n").encode()
        body += b"\0" * (self.block - BODY - len(body))
        content[:self.block] = MAGIC + checksum(body).encode() + b"\n" + body
        return bytes(content)


SMALL = {"domain.particles_x": 12, "domain.particles_y": 12}
VECTOR = {"Coordinates_0": "x", "Coordinates_1": "y", "Velocities_0": "vx", "Velocities_1": "vy"}
LIQUID = {**VECTOR, "Temperature_0": "T", "InternalEnergyGain_0": "u"}
TWO = {**VECTOR, "InternalEnergyGain_0": "u", "DissipatedEnergy_0": "q"}
BOX = {**SMALL, "domain.length_x": 12, "domain.length_y": 12}

# Of each program and form of its state: the input, its settings, and what the fields of a checkpoint are called.
CASES = {
    "C": ("disph_c", "hydrostatic_13_linear", BOX, {**LIQUID, "Density_0": "rho"}),
    "N": ("disph_n", "hydrostatic_13_linear", BOX, LIQUID),
    "A": ("disph_a", "hydrostatic_13_linear", {**BOX, "hosono.solver": "newton"}, LIQUID),
    "Y": ("disph_y", "hydrostatic_13_linear", BOX, {**LIQUID, "Weight_0": "Y"}),
}


class NotFinite(Case):
    def check(self, label):
        program, name, settings, fields = CASES[label]
        settings = {**settings, "time.steps": 2}
        self.run_program(program, name, settings, label)
        saved = self.here / label / "checkpoint_00000002.h5"
        checkpoint = Checkpoint(saved)
        row = 5
        for field, told in fields.items():
            for value in (float("nan"), float("inf")):
                with self.subTest(field=field, value=value):
                    changed = self.here / f"{label}_{field}.h5"
                    changed.write_bytes(checkpoint.with_value(f"/particles/fluid/{field}", row, value))
                    result = self.run_program(program, name, {**settings, "time.steps": 4}, f"{label}_{field}_{value}",
                                              ["--restart", changed], expect=CALCULATION_FAILED)
                    self.assertRegex(result.stderr, rf"step 3: {told} is {value}, not a finite number: particle {row} at \(")
                    self.assertEqual(result.summary["status"], "failed")
                    self.assertEqual(list(result.directory.glob("checkpoint_*")), [], "what is no state is not kept")
