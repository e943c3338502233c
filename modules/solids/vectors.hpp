// Points and rotations of solids in two or three dimensions.
#pragma once

#include <array>
#include <cmath>
#include <foundation/vec.hpp>
#include <string>

namespace tetsuame::solids {

template <int D>
using point = foundation::vec<double, D>;

template <int D>
double norm(const point<D>& a) {
  return std::sqrt(foundation::dot(a, a));
}

// The unit vector along an axis.
template <int D>
point<D> unit(std::size_t axis) {
  auto e = foundation::zero<double, D>();
  e[axis] = 1.0;
  return e;
}

// Row by row; turns a vector by multiplication from the left.
template <int D>
using rotation = std::array<point<D>, D>;

template <int D>
point<D> turn(const rotation<D>& R, const point<D>& a) {
  return point<D>::of([&](std::size_t k) { return foundation::dot(R[k], a); });
}

// By the inverse, which is the transpose.
template <int D>
point<D> turn_back(const rotation<D>& R, const point<D>& a) {
  auto sum = foundation::zero<double, D>();
  for (std::size_t k = 0; k < D; ++k) sum += a[k] * R[k];
  return sum;
}

template <int D>
rotation<D> no_rotation() {
  rotation<D> R;
  for (std::size_t k = 0; k < D; ++k) R[k] = unit<D>(k);
  return R;
}

// "(0.1, 0.2, 0.3)", in m.
template <int D>
std::string place_text(const point<D>& x);

}  // namespace tetsuame::solids
