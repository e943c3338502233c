// HLLC's approximate contact, without iteration, for double and lanes.
#pragma once

#include <riemann/exact.hpp>

namespace tetsuame::riemann {

template <class R>
struct contact {
  R p, u;  // Pa, m/s
};

// Pressure and speed of the contact of HLLC [E. F. Toro, M. Spruce, W. Speares, Shock Waves 4, 25 (1994)], for the pair
// loop: two roots and three divisions. c_l, c_r may be the sound speeds of states near by. The squares of the mass
// fluxes are those of a rarefaction, or of a shock to the pressure p_est [Toro (2009), (10.59)-(10.60)],
//   m_K^2 = rho_K [gamma P_K + (gamma+1)/2 max(p_est - p_K, 0)],   P = p + p_inf
// p_est the greater of acoustics and of two shocks into cold gas with its densities' harmonic mean (derived here),
//   p_est = (gamma+1)/4 (u_l - u_r)^2 rho_l rho_r/(rho_l + rho_r),
// exact where the densities are equal and never too large else. Not below -min(p_inf), where a vacuum opens.
template <class R>
contact<R> hllc_contact(const side<R>& l, const side<R>& r, const R& c_l, const R& c_r) {
  using detail::sqrt, foundation::greater, foundation::lesser, foundation::rounded;
  const R z_l = l.rho * c_l, z_r = r.rho * c_r, closing = l.u - r.u;
  const R acoustic = (rounded(R(z_r * l.p)) + rounded(R(z_l * r.p)) + z_l * z_r * closing) / (z_l + z_r);
  const R meeting = greater(R(0.0), closing);
  const R cold = 0.125 * (l.gamma + r.gamma + 2.0) * meeting * meeting * (l.rho * r.rho) / (l.rho + r.rho) -
                 greater(r.p_infinity, l.p_infinity);
  const R estimate = greater(cold, acoustic);
  const auto flux = [&](const side<R>& s) {
    return sqrt(
        R(s.rho * (s.gamma * (s.p + s.p_infinity) + 0.5 * (s.gamma + 1.0) * greater(R(0.0), R(estimate - s.p)))));
  };
  const R m_l = flux(l), m_r = flux(r), per_sum = 1.0 / (m_l + m_r);
  const R p = (rounded(R(m_r * l.p)) + rounded(R(m_l * r.p)) + m_l * m_r * closing) * per_sum;
  return {greater(R(0.0 - lesser(r.p_infinity, l.p_infinity)), p), (m_l * l.u + m_r * r.u + l.p - r.p) * per_sum};
}

}  // namespace tetsuame::riemann
