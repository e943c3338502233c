// Program N: volumes from the number density, pressure of the equation of state, mirrored walls, gradient pattern 1.
#pragma once

#include <gradient/pattern_1.hpp>
#include <volume/number_density.hpp>
#include <walls/treatments.hpp>

namespace tetsuame::programs {

struct program_n {
  static constexpr const char* name = "disph_n";
  using volume = tetsuame::volume::number_density;
  using pressure = tetsuame::volume::non_smoothed;
  using wall = walls::mirror;
  using gradient = tetsuame::gradient::pattern_1;
};

}  // namespace tetsuame::programs
