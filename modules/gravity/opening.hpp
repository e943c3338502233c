// Which groups of particles act on each other by multipoles, and up to what order (docs/theory/self_gravity.md).
#pragma once

#include <array>
#include <cstddef>
#include <foundation/lanes.hpp>
#include <gravity/nodes.hpp>

namespace tetsuame::gravity {

inline constexpr std::size_t least_order = 2;
// Inverse of the square of what (extent/R)^(order + 1) is at most: the relative error of a pair's potential. It bounds
// the errors of many groups that lie in one direction, which add up.
inline constexpr double per_coarsest = 1e4;

template <int D>
struct opening {
  using real = foundation::real;

  double per_opening = 1.0, per_tolerance = 1.0;  // inverse of those of tree_options

  // The orders of the multipoles by which a node and four others act on each other, the same seen from either; above P
  // if they are too close, P + 2 if supports may overlap. The error of the force of a on particles anywhere in b is
  // about m_a/R^(D-1) ((spread of a + radius of b)/R)^order [W. Dehnen (2014), with a bound for the multipoles' power].
  real orders(const node<D>& a, const std::array<const node<D>*, foundation::lanes>& others) const {
    const auto load = [&](auto member) { return real([&](auto lane) { return member(*others[lane]); }); };
    real d2 = 0.0, gap2 = 0.0;  // between centres of mass; between boxes
    for (std::size_t k = 0; k < D; ++k) {
      const real d = load([k](const node<D>& b) { return b.centre[k]; }) - a.centre[k];
      d2 += d * d;
      const real apart = foundation::stdx::abs(load([k](const node<D>&b) { return b.middle[k]; }) - a.middle[k]),
                 gap = foundation::greater(apart - (load([k](const node<D>&b) { return b.half[k]; }) + a.half[k]),
                                           real(0.0));
      gap2 += gap * gap;
    }
    const real radius = load([](const node<D>&b) { return b.radius; }), radii = radius + a.radius;
    const real support = foundation::greater(load([](const node<D>& b) { return b.support; }), real(a.support));
    const real least = radii * per_opening;
    const real extent =
        foundation::greater(load([](const node<D>& b) { return b.spread; }) + a.radius, radius + a.spread);
    const real scale = foundation::greater(load([](const node<D>& b) { return b.per_field; }) * a.mass,
                                           load([](const node<D>& b) { return b.mass; }) * a.per_field) *
                       per_tolerance;
    const real ratio2 = extent * extent / d2, most = D == 3 ? d2 * d2 : d2;
    real error2 = foundation::greater(scale * scale, per_coarsest * ratio2 * most) * ratio2 * ratio2,
         order = static_cast<double>(least_order);
    detail::unroll<far_field<D>::order + 1 - least_order>([&](auto) {
      order += foundation::select(error2 < most, real(0.0), real(1.0));
      error2 *= ratio2;
    });
    const real none = static_cast<double>(far_field<D>::order + 1);
    const auto beyond = support * support < gap2;
    const real close = foundation::select(beyond, none, none + 1.0);
    return foundation::select(beyond && least * least < d2 && order < none, order, close);
  }
};

}  // namespace tetsuame::gravity
