// Where the terms of the equations of motion and energy add their part.
#pragma once

#include <array>

namespace tetsuame::gradient {

template <int D>
struct sums {
  std::array<double*, D> force;  // N, m_i Dv_i/Dt
  double* power;                 // W, m_i Du_i/Dt
};

}  // namespace tetsuame::gradient
