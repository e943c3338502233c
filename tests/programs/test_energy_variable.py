"""&energy variable: temperature or internal energy as what is integrated, against each other and by the energy of the state."""

import unittest

import h5py
import numpy as np

from running import BAD_INPUT, Case

K, RHO, ALPHA, T0, P0, C_V = 1e11, 7000.0, 1e-4, 2500.0, 1e10, 800.0  # of a linear equation of state, SI units


def given(n):
    """A liquid that is driven for 10 s by a wave of forces, at a Reynolds number of the spacing that is the same for any n."""
    return f"""&domain length_x = 1e5 length_y = 1e5 particles_x = {n} particles_y = {n} periodic_x = .true. periodic_y = .true. jitter = 0.1 /
&initial temperature = {T0} pressure = {P0} /
&material eos = 'linear' reference_density = {RHO} bulk_modulus = {K} thermal_expansivity = {ALPHA} reference_temperature = {T0}
  heat_capacity = {C_V} viscosity = {1.6e11 / n} /
&sources force_x = 't < 10 ? 20*sin(2*pi*x/length_x) : 0' /
&output history_interval = 20 /
"""


def energy(f):
    """J/m, kinetic and internal of a snapshot: u = c T - (p0 - K - alpha K T0)/rho + (K/rho0) ln rho, by du/drho = (p - T alpha K)/rho²."""
    rho = f["Density"]
    u = C_V * f["Temperature"] - (P0 - K - ALPHA * K * T0) / rho + K / RHO * np.log(rho)
    return (f["Masses"] * (0.5 * (f["Velocities"]**2).sum(axis=1) + u)).sum()


class EnergyVariable(Case):
    def driven(self, program, n, steps, variable):
        """The last state, what its energy is off by over the work of the forces, and summary.json."""
        path = self.here / f"driven_{n}.nml"
        path.write_text(given(n))
        run = self.run_program(program, path, {"time.method": "order_4", "time.dt": 20 / steps, "time.steps": steps,
                                               "energy.variable": f"'{variable}'"})
        first, last = ({}, {})
        for state, name in ((first, "snapshot_0000.h5"), (last, "snapshot_0001.h5")):
            with h5py.File(run.directory / name) as file:
                order = np.argsort(file["PartType0/ParticleIDs"][...])
                state.update({key: values[...][order] for key, values in file["PartType0"].items()})
        work = run.summary["metrics"]["work_of_forces"]
        return last, (energy(last) - energy(first) - work) / work, run.summary

    def test_energy_of_the_state(self):
        for program in ("disph_f", "disph_n"):
            with self.subTest(program):
                by_T, off_T, _ = self.driven(program, 16, 400, "temperature")
                by_U, off_U, summary = self.driven(program, 16, 400, "internal_energy")
                self.assertLess(abs(off_U), 0.01 * abs(off_T))
                self.assertLess(abs(summary["metrics"]["energy_residual"]), 1e-6)  # of what is integrated, in both
                warmed = np.sqrt(((by_U["Temperature"] - T0)**2).mean())
                self.assertLess(np.sqrt(((by_T["Temperature"] - by_U["Temperature"])**2).mean()), 0.2 * warmed)
                self.assertGreater(warmed, 1.0)

    def test_ranks_and_restart(self):
        path = self.here / "driven.nml"
        path.write_text(given(12))
        self.assert_exact("disph_f", path, {"energy.variable": "'internal_energy'", "time.dt": 0.05, "time.steps": 40}, 15, [(2, 1)])

    def test_wrong_input(self):
        for program, name in [("disph_a", "hydrostatic_13"), ("disph_y", "hydrostatic_13"), ("disph_f", "rti_note")]:
            with self.subTest(program=program, name=name):
                result = self.run_program(program, name, {"energy.variable": "'internal_energy'"}, expect=BAD_INPUT)
                self.assert_says(result, BAD_INPUT, "energy_variable", "expected 'temperature'")
                self.assertFalse(result.directory.exists())


if __name__ == "__main__":
    unittest.main()
