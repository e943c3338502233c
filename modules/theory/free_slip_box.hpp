// Creeping fall of a round drop in a box whose walls are all free-slip, or periodic at the sides: the flow is a Fourier
// series, so that in three dimensions too there is a terminal velocity with every wall in it. SI units.
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace tetsuame::theory {

struct drop_among_free_slip {
  int dimension;                     // 2 or 3; y (index 1) is up
  std::array<double, 3> length;      // m
  std::array<bool, 3> periodic;      // of the sides across x and z; floor and lid are walls
  double radius;                     // m
  std::array<double, 3> centre;      // m; the drop must not touch floor or lid
  double viscosity, drop_viscosity;  // Pa s
  double density_difference;         // kg/m^3, drop minus surroundings
  double gravity;                    // m/s^2, towards -y
};

// Fall velocity, m/s, downward positive: mean over the drop. For equal viscosities η it is exact for the round drop,
//   V = (Δρ g V_d/(η V_box)) Σ_k N_k (k_x² + k_z²)/k⁴ [cos k_x x cos k_z z sin k_y y]² S(ka)²,
// over k_a = n_a π/L_a (periodic sides: cos² becomes 1 for k = 2π n/L), N_k = 2 for each n_a > 0, S = 3 (sin q - q cos
// q)/q³, in 2-D 2 J_1(q)/q: the drop's weight and its mean taken with the same weights. Terms up to ka = 60 are added:
// 1e-4. Else, in 3-D, Hadamard's and Rybczynski's velocity replaces that of equal viscosities without a box, and in 2-D
// that of a cylinder (drop.hpp): the walls' part is of first order in radius over length. fail_input: geometry.
double fall_velocity(const drop_among_free_slip& d);
// About how many terms that are: of small drops in three dimensions very many.
double terms_of_fall(const drop_among_free_slip& d);

// The same of several drops of one size and of their surroundings' viscosity, as they lie at `centres` (d.centre is not
// looked at): their mean, with Σ_j cos k_x x_j cos k_z z_j sin k_y y_j in the place of one drop's and divided by their
// number; waves along periodic sides as cosines and sines. The flow of each is superposed: exact while they are round.
// In 3-D terms up to ka = 30 are added. fail_input: geometry, unlike viscosities.
double mean_fall_velocity(const drop_among_free_slip& d, std::span<const std::array<double, 3>> centres);
// About how many terms, all centres' together.
double terms_of_mean_fall(const drop_among_free_slip& d, std::size_t centres);

}  // namespace tetsuame::theory
