"""What moves as a whole takes no more steps than at rest, and ends in the same state: where nothing stands still, only
what particles move with respect to each other bounds a step. And where they do, lists follow them.

In double precision the two states differ by the rounding of places (2^-52 of the box's length a step) and of velocities
(2^-52 of the frame's); single precision rounds what pairs are computed of, whose order goes with the place of a particle in the
box, by 2^-24."""

import shutil
import unittest

import h5py
import numpy

from running import Case

FRAMES = (1.0, 10.0, 100.0)
SQUARE = """&domain
  dimension = 2  length_x = 1.0  length_y = 1.0  particles_x = 32  periodic_x = .true.  periodic_y = .true.
/
&shock
  test = 'square'  scheme = 'disph'  masses = 'equal_spacing'  rho_l = 4.0  p_l = 2.5  rho_r = 1.0  p_r = 2.5  gamma = 1.6666666666666667
/
&time
  t_end = 0.3
/
"""
SHEARED = {"domain.particles_x": 24, "kernel.precision": "double", "time.t_end": 0.1}
# Program, input, settings, velocities of the two parts of the fluid at rest.
FLOWS = {
    "a square of gas": ("shock", SQUARE, {}, (0.0, 0.0)),
    "in three dimensions": ("shock", SQUARE, {"domain.dimension": 3, "domain.length_z": 1.0, "domain.particles_x": 14, "domain.periodic_z": ".true.",
                                              "kernel.precision": "double", "time.t_end": 0.1}, (0.0, 0.0)),
    "with fixed steps": ("shock", SQUARE, {"time.method": "rk4", "kernel.precision": "double", "time.t_end": 0.1}, (0.0, 0.0)),
    "shear": ("shock", "kelvin_helmholtz", SHEARED, (-0.5, 0.5)),
    "shear by the standard scheme": ("shock", "kelvin_helmholtz", {**SHEARED, "shock.scheme": "ssph"}, (-0.5, 0.5)),
}
SINGLE = 1e-5
EXACT = 1e-12


def fluid(directory):
    with h5py.File(sorted(directory.glob("snapshot_*.h5"))[-1]) as file:
        group = file["PartType0"]
        order = numpy.argsort(group["ParticleIDs"][...])
        return {name: values[...][order] for name, values in group.items()}


def differences(rest, moved, velocity, time, length, speed, fields=("Density", "Pressure")):
    """Of places over the box's length, of velocities over a speed, of others over the largest."""
    along = moved["Coordinates"] - rest["Coordinates"]
    along[:, 0] -= velocity * time
    along -= numpy.round(along / length) * length
    v = moved["Velocities"] - rest["Velocities"]
    v[:, 0] -= velocity
    found = {"Coordinates": abs(along).max() / length, "Velocities": abs(v).max() / speed}
    for name in fields:
        found[name] = (abs(moved[name] - rest[name]) / abs(rest[name]).max()).max()
    return found


class Frames(Case):
    def input(self, name):
        if "&" not in name:
            return name
        path = self.here / "input.nml"
        path.write_text(name)
        return path

    def assert_same(self, rest, moved, limit, **how):
        for name, difference in differences(fluid(rest.directory), fluid(moved.directory), **how).items():
            self.assertLess(difference, limit, name)
        self.assertLessEqual(moved.summary["steps"], 1.2 * rest.summary["steps"])

    def test_of_gas(self):
        for name, (program, text, settings, velocities) in FLOWS.items():
            def run(u):
                left, right = velocities
                return self.run_program(program, self.input(text), {**settings, "output.interval": 0, "shock.u_l": left + u, "shock.u_r": right + u})
            rest = run(0.0)
            for u in FRAMES:
                with self.subTest(name, frame=u):
                    self.assert_same(rest, run(u), EXACT, velocity=u, time=rest.summary["time"], length=1.0, speed=2.0)

    def test_of_gas_in_single_precision(self):
        settings = {**SHEARED, "kernel.precision": "single", "output.interval": 0}
        rest = self.run_program("shock", "kelvin_helmholtz", settings)
        for u in FRAMES:
            moved = self.run_program("shock", "kelvin_helmholtz", {**settings, "shock.u_l": u - 0.5, "shock.u_r": u + 0.5})
            self.assert_same(rest, moved, SINGLE, velocity=u, time=rest.summary["time"], length=1.0, speed=2.0)

    def test_of_liquids(self):
        """Each scheme, from a snapshot whose velocities are those of another frame: of about the speed of sound, and beyond."""
        settings = {"domain.particles_x": 14, "domain.particles_y": 14, "domain.jitter": 0.1, "domain.periodic_y": ".true.",
                    "time.dt": 0.1, "time.steps": 8, "output.interval": 0}
        first = self.run_program("disph_c", "hydrostatic_13_linear", {**settings, "time.steps": 1}, output="first")
        for program in ("disph_a", "disph_b", "disph_c", "disph_d", "disph_e", "disph_f", "disph_n", "ssph"):
            iterates = program in ("disph_a", "disph_b")  # until Y changes by less than 1e-12 of itself
            more = {"hosono.solver": "newton"} if iterates else {}

            def run(u):
                file = self.here / f"start_{u:g}.h5"
                shutil.copy(sorted(first.directory.glob("snapshot_*.h5"))[-1], file)
                with h5py.File(file, "r+") as start:
                    start["PartType0/Velocities"][:, 0] += u
                return self.run_program(program, "hydrostatic_13_linear", {**settings, "initial.file": f"'{file}'", **more})
            rest = run(0.0)
            for u in FRAMES:
                with self.subTest(program, frame=u):
                    self.assert_same(rest, run(1e3 * u), 10 * EXACT if iterates else EXACT, velocity=1e3 * u, time=rest.summary["time"], length=1e5, speed=4e3)

    def test_ranks_and_restarts(self):
        moving = {"shock.u_l": 10.0, "shock.u_r": 10.0, "output.interval": 0}
        whole = self.assert_exact("shock", self.input(SQUARE), moving, 20, [(3, 1)])
        self.assertLess(whole["steps"], 60)


class Fast(Case):
    """Two discs that meet at the speed of sound, and what they throw out."""

    def test_lists_follow_with_ranks_and_restarts(self):
        settings = {"domain.particles_x": 48, "time.t_end": 12, "output.interval": 0}
        whole = self.assert_exact("shock", "impact_2d", settings, 23, [(3, 1)])
        self.assertLess(whole["steps"], 76)  # those of lists with a fixed skin


if __name__ == "__main__":
    unittest.main()
