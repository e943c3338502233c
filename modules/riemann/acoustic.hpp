// The contact between two sides of one liquid that is hardly compressed: acoustics with the mean impedance ρ̄ c,
//   u* = ½ (u_l + u_r) + (p_l - p_r)/(2 ρ̄ c)
//   p* = ½ (p_l + p_r) + ½ β ρ̄ (u_l - u_r),   β = min(3 max(u_l - u_r, 0), c)
// where β = c is the acoustic solution, and the smaller one keeps smooth flow from being damped [C. Zhang, X. Y. Hu,
// N. A. Adams, J. Comput. Phys. 335, 605 (2017)].
#pragma once

#include <riemann/approximate.hpp>

namespace tetsuame::riemann {

template <class R>
struct liquid_side {
  R rho, u, p;  // kg/m3; m/s towards +x; Pa
};

// c: the speed of sound, m/s. limiter: the 3 of β; a large one gives acoustics wherever the sides meet.
template <class R>
contact<R> acoustic_contact(const liquid_side<R>& l, const liquid_side<R>& r, const R& c, double limiter = 3.0) {
  using foundation::greater, foundation::lesser;
  const R mean = 0.5 * (l.rho + r.rho), meeting = greater(R(0.0), R(l.u - r.u));
  const R beta = lesser(R(limiter * meeting), c);
  return {0.5 * (l.p + r.p + beta * mean * meeting), 0.5 * (l.u + r.u + (l.p - r.p) / (mean * c))};
}

}  // namespace tetsuame::riemann
