// Particles of equal mass on shells about the centre, by a profile: [J. A. Kegerreis et al., MNRAS 487, 5029
// (2019)] for the idea. Each shell is as thick as its particles are apart and holds a whole number of them, spread
// along a spiral of equal areas (Fibonacci lattice), turned at random from shell to shell. Shells of a cylinder are
// rings, on which particles are evenly spaced.
#pragma once

#include <array>
#include <cstdint>
#include <planet/profile.hpp>
#include <vector>

namespace tetsuame::planet {

struct particle {
  std::array<double, 3> x;  // m, from the centre
  double mass;              // kg
  std::size_t layer;        // from the centre outwards
};

// About `number` particles, whole numbers in each layer, whose masses differ from layer to layer by less than a
// particle over the layer's number. fail_input where a layer would have less than 8.
std::vector<particle> on_shells(const profile& planet, const std::vector<std::string>& names, std::int64_t number);

}  // namespace tetsuame::planet
