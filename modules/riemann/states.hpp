// The two sides of a Riemann problem. Each is a stiffened gas of its own,
//   p = (gamma - 1) rho e - p_inf,   K_S = rho c^2 = gamma (p + p_inf),
// which holds the ideal gas (p_inf = 0) and, with gamma = dK_S/dp and p_inf = K_S/gamma - p at a state, any equation of
// state near it (docs/theory/riemann.md).
// R: double, or lanes of it.
#pragma once

#include <cmath>
#include <experimental/simd>
#include <foundation/lanes.hpp>

namespace tetsuame::riemann {

// A choice by mask, and whether a mask holds anywhere.
template <class R>
using mask_of = decltype(R() < R());

using foundation::select;
inline double select(bool yes, double a, double b) { return yes ? a : b; }
inline bool any(bool yes) { return yes; }

template <class T, class Abi>
bool any(const std::experimental::simd_mask<T, Abi>& yes) {
  return any_of(yes);
}

template <class R>
struct side {
  R rho, u, p;          // kg/m^3; m/s towards +x; Pa. rho > 0, p > -p_infinity
  R gamma, p_infinity;  // dimensionless > 1; Pa
};

template <class R>
R sound_speed(const side<R>& s) {
  using std::sqrt;
  return sqrt(s.gamma * (s.p + s.p_infinity) / s.rho);
}

// Between the outer waves. The contact parts left from right.
template <class R>
struct star {
  R p, u;             // Pa, m/s; u is (u_l + u_r)/2
  R u_l, u_r;         // m/s: both u, but where a vacuum opens between them
  R rho_l, rho_r;     // kg/m^3
  mask_of<R> vacuum;  // the sides part: p is the least pressure either can have
};

}  // namespace tetsuame::riemann
