// Program Y [S2, improved DISPH]: Y by its own evolution equation, smoothed pressure, corrected walls, gradient
// pattern 1.
#pragma once

#include <gradient/pattern_1.hpp>
#include <volume/y_evolution.hpp>
#include <walls/treatments.hpp>

namespace tetsuame::programs {

struct program_y {
  static constexpr const char* name = "disph_y";
  using volume = tetsuame::volume::y_evolution;
  using pressure = tetsuame::volume::smoothed;
  using wall = walls::virtual_marker;
  using gradient = tetsuame::gradient::pattern_1;
};

}  // namespace tetsuame::programs
