// Approximate star states without iteration, for double and lanes.
#pragma once

#include <riemann/exact.hpp>

namespace tetsuame::riemann {

// Linearised: Z_K = rho c,
//   p* = [Z_r p_l + Z_l p_r + Z_l Z_r (u_l - u_r)]/(Z_l + Z_r),
//   u* = [Z_l u_l + Z_r u_r + p_l - p_r]/(Z_l + Z_r)       [Toro (2009), section 9.3]
// p* may be below what the sides can have: no vacuum is found. For waves at fixed
// temperature fit the sides with K_T (states.hpp).
template <class R>
star<R> acoustic(const side<R>& l, const side<R>& r) {
  const R c_l = sound_speed(l), c_r = sound_speed(r), z_l = l.rho * c_l, z_r = r.rho * c_r;
  const R p = (z_r * l.p + z_l * r.p + z_l * z_r * (l.u - r.u)) / (z_l + z_r);
  const R u = (z_l * l.u + z_r * r.u + l.p - r.p) / (z_l + z_r);
  return {p, u, u, u, l.rho + (p - l.p) / (c_l * c_l), r.rho + (p - r.p) / (c_r * c_r), mask_of<R>(false)};
}

template <class R>
struct hllc_star {
  R p, u;          // Pa, m/s: pressure and speed of the contact
  R s_l, s_r;      // m/s, speeds of the outer waves
  R rho_l, rho_r;  // kg/m^3
};

// HLLC [E. F. Toro, M. Spruce, W. Speares, Shock Waves 4, 25 (1994)] with outer wave speeds
// u_K -+ c_K q_K, where q_K = 1 for a rarefaction and that of a shock to the pressure p_est
// else [Toro (2009), (10.59)-(10.60), with P = p + p_inf]:
//   q_K^2 = 1 + (gamma+1)/(2 gamma) (P_est/P_K - 1).
// p_est is the start of the exact iteration and not acoustics alone, which gives far too slow
// waves where cold gas collides (derived here).
template <class R>
hllc_star<R> hllc(const side<R>& l, const side<R>& r) {
  using detail::greater, detail::square_root;
  const detail::problem<R> both(l, r);
  const R estimate = both.start();
  const auto q = [&](const side<R>& s) {
    const R excess = greater(R(estimate - s.p), R(0.0)) / (s.p + s.p_infinity);
    return square_root(R(1.0 + 0.5 * (s.gamma + 1.0) / s.gamma * excess));
  };
  const R w_l = both.c_l * q(l), w_r = both.c_r * q(r);  // relative to the gas
  const R m_l = l.rho * w_l, m_r = r.rho * w_r;          // kg/(m^2 s)
  const R u = (m_l * l.u + m_r * r.u + l.p - r.p) / (m_l + m_r);
  const R p = (m_r * l.p + m_l * r.p + m_l * m_r * (l.u - r.u)) / (m_l + m_r);
  return {p, u, l.u - w_l, r.u + w_r, l.rho * w_l / (w_l + u - l.u), r.rho * w_r / (w_r + r.u - u)};
}

}  // namespace tetsuame::riemann
