// Whether the particles of a start can be computed with: each has neighbours, and none lies where another does.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace tetsuame::run {

// Where places are: m; along a periodic axis they lie in [0, length), along others anywhere.
struct start_region {
  int dimension = 2;
  std::array<double, 3> length{};
  std::array<bool, 3> periodic{};
};

// Two that lie nearer to each other than `near` (m): the pair is the first by cells. None: there is none.
std::optional<std::pair<std::size_t, std::size_t>> find_coincident(const start_region& where,
                                                                   const std::vector<double>& places, double near);

// Of each particle.
struct neighbourhoods {
  std::vector<double> nearest;  // m, to the nearest other; infinite where none is within reach
  // Σ_j V_j W_ij with a Wendland C2 kernel of 2.5 of the particle's own spacings, V^(1/D): 1 inside, less at a surface,
  // 2 where two lattices lie over each other.
  std::vector<double> filled;
};

// places: m, one particle's components behind another's; volumes: m^D; reach: m, how far the particle sees others.
neighbourhoods find_neighbourhoods(const start_region& where, const std::vector<double>& places,
                                   const std::vector<double>& volumes, const std::vector<double>& reach);

}  // namespace tetsuame::run
