// The Riemann problem between two particles, along e from j (left) to i (right), and its star state. First order: the
// particles' own states. Second order: p, ρ and v·e are carried half the way to the middle along limited slopes; with
// Δ = a_i - a_j and d = x_ij·∇a of one end, as on an even mesh where the difference behind it would be 2d - Δ,
//   slope = minmod(θΔ, d, θ(2d - Δ)),   θ = 1: minmod, θ = 2: monotonised central [B. van Leer, J. Comput. Phys. 23,
//   276 (1977)]
// which leaves the value between a_i and a_j.
#pragma once

#include <riemann/approximate.hpp>
#include <schemes/common.hpp>

namespace tetsuame::schemes {

struct star_state {
  real p, u;     // Pa; m/s along e
  real closing;  // m/s, of the particles themselves: w_ij
};

inline constexpr field<struct grad_p_tag> of_grad_p;
inline constexpr field<struct grad_rho_tag> of_grad_rho;
inline constexpr field<struct grad_v_tag> of_grad_v;

inline real limited(const real& difference, const real& slope, double theta) {
  const real behind = 2.0 * slope - difference;
  real size = lesser(real(abs(slope)), real(theta * lesser(real(abs(difference)), real(abs(behind)))));
  where(difference * behind <= 0.0, size) = 0.0;
  return copysign(size, difference);
}

// What a term of a Godunov scheme reads for the interface.
template <int D, bool Second>
auto interface_reads(const gas<D>& s) {
  const auto first = std::tuple{pairs::read(pairs::of_velocity, s.v), pairs::read(of_density, s.rho),
                                pairs::read(pairs::of_pressure, s.p), pairs::read(of_sound, s.c),
                                pairs::read(of_gamma, s.gamma),       pairs::read(of_stiffness, s.stiffness)};
  if constexpr (Second)
    return std::tuple_cat(first, std::tuple{pairs::read(of_grad_p, s.grad_p), pairs::read(of_grad_rho, s.grad_rho),
                                            pairs::read(of_grad_v, s.grad_v)});
  else
    return first;
}

template <int D, bool Second>
star_state interface(const gas<D>& s, const auto& ij) {
  using foundation::dot;
  const auto e = ij.per_r * ij.x_ij;
  riemann::side<real> l{ij(of_density), dot(ij(pairs::of_velocity), e), ij(pairs::of_pressure), ij(of_gamma),
                        ij(of_stiffness)};
  riemann::side<real> r{ij.own(of_density), dot(ij.own(pairs::of_velocity), e), ij.own(pairs::of_pressure),
                        ij.own(of_gamma), ij.own(of_stiffness)};
  const real closing = r.u - l.u;
  if constexpr (Second) {
    const auto along = [&](const vec<real, D>& gradient) { return dot(gradient, ij.x_ij); };
    const auto shear = [&](const auto& gradient) {
      real sum(0.0);
      for (std::size_t a = 0; a < D; ++a)
        for (std::size_t b = 0; b < D; ++b) sum += e[a] * gradient[D * a + b] * ij.x_ij[b];
      return sum;
    };
    const auto carry = [&](real& a_l, real& a_r, const real& d_l, const real& d_r) {
      const real difference = a_r - a_l;
      a_l += 0.5 * limited(difference, d_l, s.theta);
      a_r -= 0.5 * limited(difference, d_r, s.theta);
    };
    carry(l.p, r.p, along(ij(of_grad_p)), along(ij.own(of_grad_p)));
    carry(l.rho, r.rho, along(ij(of_grad_rho)), along(ij.own(of_grad_rho)));
    carry(l.u, r.u, shear(ij(of_grad_v)), shear(ij.own(of_grad_v)));
  }
  if (s.exact) {
    const auto star = riemann::solve(l, r, 3);
    return {star.p, star.u, closing};
  }
  const auto star = riemann::hllc_contact(l, r, real(ij(of_sound)), real(ij.own(of_sound)));
  return {star.p, star.u, closing};
}

}  // namespace tetsuame::schemes
