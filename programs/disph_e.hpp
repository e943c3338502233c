// Program E [S0, table 1]: Y by our method, smoothed pressure, corrected walls, gradient pattern 2.
#pragma once

#include <gradient/pattern_2.hpp>
#include <volume/our_method.hpp>
#include <walls/treatments.hpp>

namespace tetsuame::programs {

struct program_e {
  static constexpr const char* name = "disph_e";
  using volume = tetsuame::volume::our_method;
  using pressure = tetsuame::volume::smoothed;
  using wall = walls::virtual_marker;
  using gradient = tetsuame::gradient::pattern_2;
};

}  // namespace tetsuame::programs
