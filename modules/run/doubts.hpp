// What says of a run that ended that its result means nothing: the same for all programs, out of what each of them has
// measured.
#pragma once

#include <run/summary.hpp>
#include <string>

namespace tetsuame::run {

// Of the metric energy_residual_max, or energy_residual: what the sums have made or lost of the energy, over the scale
// that the program gives it. Runs that follow the flow stay below 0.1; 1 is all that there is to move.
inline constexpr double most_energy_made = 0.2;
// Of the metric density_excess: the factor by which a density has left the range that the equation of state has at the
// pressures of the start. Flows have pressures beyond these, which change a liquid's density by some tenths.
inline constexpr double most_density_excess = 2.0;
// Of the metric particles_put_back, over the steps and N^(1-1/D), the particles in a row (layer) along a wall: so many
// of them pass a wall in each step.
inline constexpr double most_put_back = 0.1;

// The reasons, in words; empty: there are none.
std::string doubts(const summary& s);

}  // namespace tetsuame::run
