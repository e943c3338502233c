// Debye's solid of three oscillators an atom, by y = theta/T, per N k_B of its atoms and without the energy at rest:
//   E/T = 3 D(y),  F/T = 3 ln(1 - e^-y) - D(y),  C_V = 3 [4 D(y) - 3 y/(e^y - 1)]
//   D(y) = 3/y^3 int_0^y t^3/(e^t - 1) dt
// [P. Debye, Ann. Phys. 344, 789 (1912)].
#pragma once

namespace tetsuame::eos {

struct debye_point {
  double energy, free_energy, capacity;  // E/T, F/T, C_V, each per N k_B
};

// theta > 0, T > 0, both in K; to rounding.
debye_point debye(double theta, double T);

}  // namespace tetsuame::eos
