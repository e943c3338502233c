// Standard SPH, to stand beside DISPH: density by summation, mirrored walls, gradient pattern 1.
#pragma once

#include <gradient/pattern_1.hpp>
#include <volume/density_sum.hpp>
#include <walls/treatments.hpp>

namespace tetsuame::programs {

struct standard_sph {
  static constexpr const char* name = "ssph";
  using volume = tetsuame::volume::density_sum;
  using pressure = tetsuame::volume::non_smoothed;
  using wall = walls::mirror;
  using gradient = tetsuame::gradient::pattern_1;
};

}  // namespace tetsuame::programs
