// Where the terms of the equations of motion and energy add their part.
#pragma once

#include <array>

namespace tetsuame::gradient {

template <int D>
struct rates {
  std::array<double*, D> dv;  // m/s2
  double* du;                 // W/kg
};

}  // namespace tetsuame::gradient
