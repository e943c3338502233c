"""A number that is none, in any field that is integrated over time, ends the run of any program in that step, with the
particle and the field.

What no input lets in is written into a checkpoint, as modules/output/checkpoint.cpp describes it, with its checksums.
"""

import struct
import unittest

import numpy

from running import CALCULATION_FAILED, Case

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
TWO = {**VECTOR, "InternalEnergyGain_0": "u", "Dissipated_0": "q"}
GAS = {"Coordinates_0": "x", "Velocities_0": "vx", "InternalEnergyGain_0": "u"}

# Of each program and form of its state: the input, its settings, and what the fields of a checkpoint are called.
CASES = {
    "C": ("disph_c", "hydrostatic_13_linear", SMALL, {**LIQUID, "Density_0": "rho"}),
    "N": ("disph_n", "hydrostatic_13_linear", SMALL, LIQUID),
    "A": ("disph_a", "hydrostatic_13_linear", {**SMALL, "hosono.solver": "newton"}, LIQUID),
    "Y": ("disph_y", "hydrostatic_13_linear", SMALL, {**LIQUID, "Weight_0": "Y"}),
    "rti": ("rti", "rti_linear", SMALL, TWO),
    "rti, density": ("rti", "rti_linear", {**SMALL, "rti.volume": "our_method", "rti.temperature_law": "adiabatic"},
                     {**TWO, "Density_0": "rho", "Temperature_0": "T"}),
    "rti by Y": ("disph_y", "rti_linear", {**SMALL, "rti.p_top": 1e10}, {**TWO, "Weight_0": "Y"}),
    "heat content": ("rti", "pond_on_mantle", SMALL, {**TWO, "Enthalpy_0": "h"}),
    "element": ("drop", "partitioning", SMALL, {**TWO, "Concentration_0": "c"}),
    "conduction": ("conduction", "conduction_plate", SMALL, {"Temperature_0": "T"}),
    "convection": ("convection", "air_1e4", SMALL, {**VECTOR, "Temperature_0": "T", "DynamicPressure_0": "p"}),
    "convection, relaxed": ("convection", "blankenbach_1a", SMALL,
                            {**VECTOR, "Temperature_0": "T", "DynamicPressure_0": "p", "RelaxedVelocity_0_0": "zx", "RelaxedVelocity_1_0": "zy"}),
    "flow": ("flow", "still_water", {"domain.particles_x": 20, "domain.particles_y": 24}, {**VECTOR, "Density_0": "rho"}),
    "gas": ("shock", "sod", {"domain.particles_x": 48, "shock.scheme": "ssph", "shock.time_dependent_alpha": ".true."}, {**GAS, "Alpha_0": "alpha", "Support_0": "Support"}),
    "gas, Godunov": ("shock", "sod", {"domain.particles_x": 48}, GAS),
    "gas, materials": ("shock", "melts_shock", {"domain.particles_x": 48}, GAS),
    "planet": ("planet", "planet_metal", {"planet.particles": 200}, {**GAS, "Concentration_0": "c"}),
    "gas, density": ("shock", "sod", {"domain.particles_x": 48, "shock.scheme": "remix"}, {**GAS, "EvolvedDensity_0": "density"}),
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

    def test_every_program_and_field(self):
        for label in CASES:
            with self.subTest(label):
                self.check(label)


if __name__ == "__main__":
    unittest.main()
