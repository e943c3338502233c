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

template <class R>
struct contact {
  R p, u;  // Pa, m/s
};

// Pressure and speed of HLLC's contact alone, for the pair loop: two roots and three divisions. c_l, c_r may be the
// sound speeds of states near by. The squares of the mass fluxes are those of hllc(),
//   m_K^2 = rho_K [gamma P_K + (gamma+1)/2 max(p_est - p_K, 0)],
// p_est the greater of acoustics and of two shocks into cold gas with its densities' harmonic mean (derived here),
//   p_est = (gamma+1)/4 (u_l - u_r)^2 rho_l rho_r/(rho_l + rho_r),
// exact where the densities are equal and never too large else. Not below -min(p_inf), where a vacuum opens.
template <class R>
contact<R> hllc_contact(const side<R>& l, const side<R>& r, const R& c_l, const R& c_r) {
  using detail::greater, detail::smaller, detail::square_root;
  const R z_l = l.rho * c_l, z_r = r.rho * c_r, closing = l.u - r.u;
  const R acoustic = (z_r * l.p + z_l * r.p + z_l * z_r * closing) / (z_l + z_r);
  const R meeting = greater(closing, R(0.0));
  const R cold = 0.125 * (l.gamma + r.gamma + 2.0) * meeting * meeting * (l.rho * r.rho) / (l.rho + r.rho) -
                 greater(l.p_infinity, r.p_infinity);
  const R estimate = greater(acoustic, cold);
  const auto flux = [&](const side<R>& s) {
    return square_root(
        R(s.rho * (s.gamma * (s.p + s.p_infinity) + 0.5 * (s.gamma + 1.0) * greater(R(estimate - s.p), R(0.0)))));
  };
  const R m_l = flux(l), m_r = flux(r), per_sum = 1.0 / (m_l + m_r);
  const R p = (m_r * l.p + m_l * r.p + m_l * m_r * closing) * per_sum;
  return {greater(p, R(0.0 - smaller(l.p_infinity, r.p_infinity))), (m_l * l.u + m_r * r.u + l.p - r.p) * per_sum};
}

}  // namespace tetsuame::riemann
