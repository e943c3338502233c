// Program D [S0, table 1]: Y by our method, smoothed pressure, no wall support, gradient pattern 1.
#pragma once

#include <gradient/pattern_1.hpp>
#include <volume/our_method.hpp>
#include <walls/treatments.hpp>

namespace tetsuame::programs {

struct program_d {
  static constexpr const char* name = "disph_d";
  using volume = tetsuame::volume::our_method;
  using pressure = tetsuame::volume::smoothed;
  using wall = walls::none;
  using gradient = tetsuame::gradient::pattern_1;
};

}  // namespace tetsuame::programs
