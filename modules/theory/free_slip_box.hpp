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

// Fall velocity, m/s, downward positive: mean over the drop, by the series of docs/theory/drop.md with terms up to ka =
// 60: 1e-4. Exact for the round drop of equal viscosities; else, in 3-D only, the part that belongs to the drop alone
// is exchanged, which leaves an error of third order in radius over length.
double fall_velocity(const drop_among_free_slip& d);
// About how many terms that are: of small drops in three dimensions very many.
double terms_of_fall(const drop_among_free_slip& d);

// The same of several drops of one size and of their surroundings' viscosity, as they lie at `centres` (d.centre is not
// looked at): their mean. In 3-D terms up to ka = 30 are added.
double mean_fall_velocity(const drop_among_free_slip& d, std::span<const std::array<double, 3>> centres);
// About how many terms, all centres' together.
double terms_of_mean_fall(const drop_among_free_slip& d, std::size_t centres);

}  // namespace tetsuame::theory
