// What the kernels share: the positive part, which stands in for every branch.
#pragma once

#include <algorithm>
#include <experimental/simd>
#include <numbers>

namespace tetsuame::kernels {

// max(x, 0) for a double and, found through its own namespace, for several lanes.
template <class R>
R positive_part(const R& x) {
  using std::max;
  return max(x, R(0.0));
}

// The constant of dimension D out of one for each of D = 1, 2, 3.
template <int D>
constexpr double of_dimension(double one, double two, double three) {
  static_assert(D >= 1 && D <= 3, "kernels exist in one, two and three dimensions");
  return D == 1 ? one : D == 2 ? two : three;
}

}  // namespace tetsuame::kernels
