// Program B [S0, table 1]: Y by Hosono's iteration, no wall support, gradient pattern 1.
#pragma once

#include <gradient/pattern_1.hpp>
#include <volume/hosono_iteration.hpp>
#include <walls/treatments.hpp>

namespace tetsuame::programs {

struct program_b {
  static constexpr const char* name = "disph_b";
  using volume = tetsuame::volume::hosono_iteration;
  using pressure = tetsuame::volume::smoothed;
  using wall = walls::none;
  using gradient = tetsuame::gradient::pattern_1;
};

}  // namespace tetsuame::programs
