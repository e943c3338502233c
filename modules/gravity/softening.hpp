// The field of a particle whose mass is spread as the Wendland C2 kernel of support H, a polynomial of q = r/H within
// and Newton's beyond: [H. Wendland, Adv. Comput. Math. 4, 389 (1995)], for gravity [M. Schaller et al., MNRAS 530,
// 2378 (2024); W. Dehnen, MNRAS 324, 273 (2001)]. The two particles of a pair use the larger of their
// supports, so that forces are opposite.
//
// Kernel of one dimensionless shape, W ∝ (1 - q)^4 (1 + 4 q); mass within q, of 1:
//   3-D: 14 q³ - 84 q⁵ + 140 q⁶ - 90 q⁷ + 21 q⁸
//   2-D: 7 q² - 35 q⁴ + 56 q⁵ - 35 q⁶ + 8 q⁷
#pragma once

#include <foundation/lanes.hpp>
#include <foundation/lanes_math.hpp>
#include <type_traits>

namespace tetsuame::gravity {

// At distance r from mass 1: the acceleration is -strength · force · (vector of length r from the mass), and the
// potential strength · potential (-1/r or ln r beyond the support).
template <class R>
struct pair_field {
  R force;      // 1/m^D
  R potential;  // 1/m; 2-D: of 1
};

// A support of 0 has this inverse (1/m): two points without a support are beyond it from 1e-90 m on, and nearer ones do
// not act on each other. In single numbers, which need units of about the cloud's size: from 1e-11 of it on.
template <class R>
inline constexpr double no_support = std::is_same_v<R, foundation::single> ? 1e11 : 1e90;
// A square of a distance has an inverse, and that the power 3/2.
template <class R>
inline constexpr double least_square = std::is_same_v<R, foundation::single> ? 1e-24 : 1e-200;

template <class R>
double inverse_support(double support) {
  return support * no_support<R> > 1.0 ? 1.0 / support : no_support<R>;
}

// Newton's; r2 > 0 (m²).
template <int D, class R>
[[gnu::always_inline]] inline pair_field<R> point_field(const R& r2) {
  if constexpr (D == 2) {
    return {R(1.0) / r2, 0.5 * foundation::log(r2)};
  } else {
    const R inverse = foundation::both_roots(r2).inverse;
    return {inverse * inverse * inverse, -inverse};
  }
}

// Within the support; h = 1/H (1/m). In 2-D the potential lacks ln H.
template <int D, class R>
[[gnu::always_inline]] inline pair_field<R> field_within(const R& q, const R& h) {
  const R q2 = q * q;
  if constexpr (D == 2) {
    const R force = ((8.0 * q - 35.0) * q + 56.0) * (q * q2) + (7.0 - 35.0 * q2);
    const R depth = (((8.0 / 7.0) * q - 35.0 / 6.0) * q + 56.0 / 5.0) * (q * (q2 * q2)) + (3.5 - 8.75 * q2) * q2;
    return {force * (h * h), depth - 529.0 / 420.0};
  } else {
    const R force = ((21.0 * q - 90.0) * q + 140.0) * (q * q2) + (14.0 - 84.0 * q2);
    const R depth = ((3.0 * q - 15.0) * q + 28.0) * (q * (q2 * q2)) + ((7.0 - 21.0 * q2) * q2 - 3.0);
    return {force * (h * h * h), depth * h};
  }
}

// r2 >= 0 (m²), h = 1/H (1/m), H the larger support of the two.
template <int D, class R>
[[gnu::always_inline]] inline pair_field<R> soft_field(const R& r2, const R& h) {
  using foundation::select;
  const auto root = foundation::both_roots(foundation::greater(r2, R(least_square<R>)));
  R force = root.inverse * root.inverse, potential;
  if constexpr (D == 3) force *= root.inverse;
  const R q = foundation::lesser(root.r * h, R(1.0));
  const auto within = q < R(1.0);
  const auto near = field_within<D, R>(q, h);
  const auto ignored = within && !(h < R(no_support<R>));
  if constexpr (D == 2)
    potential = foundation::log(select(within, R(1.0) / h, root.r)) + select(within, near.potential, R(0.0));
  else
    potential = select(within, near.potential, -root.inverse);
  return {select(ignored, R(0.0), select(within, near.force, force)), select(ignored, R(0.0), potential)};
}

}  // namespace tetsuame::gravity
