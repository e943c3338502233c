// Where the terms of the equations of motion and energy add their part.
#pragma once

#include <array>

namespace tetsuame::gradient {

template <int D>
struct sums {
  std::array<double*, D> force;  // N, m_i Dv_i/Dt
  double* power;                 // W, m_i Du_i/Dt
};

// What a long_sum begins with, over Y and a unit of length near the support: the pressure on one side of a particle is
// some 3 Y/S, and a neighbour's may be twenty times as large.
inline constexpr double larger = 64.0;

}  // namespace tetsuame::gradient
