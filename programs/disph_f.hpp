// Program F [S0, table 1]: Y by our method, non-smoothed pressure, corrected walls, gradient pattern 1.
#pragma once

#include <gradient/pattern_1.hpp>
#include <volume/our_method.hpp>
#include <walls/treatments.hpp>

namespace tetsuame::programs {

struct program_f {
  static constexpr const char* name = "disph_f";
  using volume = tetsuame::volume::our_method;
  using pressure = tetsuame::volume::non_smoothed;
  using wall = walls::virtual_marker;
  using gradient = tetsuame::gradient::pattern_1;
};

}  // namespace tetsuame::programs
