// The schemes with Riemann problems.
//
// Godunov SPH, case 3 of [S.-H. Cha, A. P. Whitworth, MNRAS 340, 73 (2003)]:
//   m_i dv_i/dt = -Σ_j m_i m_j P*_ij [ρ_i⁻² ∇W_ij(h_i) + ρ_j⁻² ∇W_ij(h_j)]
//   dU_i/dt     = -Σ_j m_i m_j P*_ij (v*_ij - v_i)·[the same]
//
// Godunov DISPH [S4, eqs. (11), (12)]: DISPH with the star pressure of the Riemann problem between i and j.
//   m_i dv_i/dt = -Σ_j U_i U_j P*_ij [f_i/q_i² ∇W_ij(h_i) + f_j/q_j² ∇W_ij(h_j)]
//   dU_i/dt     =  Σ_j U_i U_j P*_ij  f_i/q_i² v_ij·∇W_ij(h_i)
// or, weighted by the mean B of the two ends' Balsara factors, with (1 - B) P_i + B P* and (1 - B) P_j + B P* in the
// two terms: DISPH without viscosity where gas is sheared and not compressed. Weight, z: as in viscous.hpp.
// or, where pressures differ, without the terms of varying supports and with one volume of the pair ('fading'; derived
// here). With P = p + p_inf, z of common.hpp and the mean Y of 1/q_i and 1/q_j:
//   m_i dv_i/dt = -Σ_j P*_ij {U_i (U_j + φ z_i) [φ/q_i² + (1 - φ) Y²] ∇W_ij(h_i) + the same of j}
//   φ = max[0, 1 - fading |p_i - p_j|/(P_i + P_j)]
// and the first term's part of the power.
//
// The Riemann problem is that along e from j (left) to i (right). First order: the particles' own states, as slopes are
// zero. Second order: p, ρ and v·e are carried half the way to the middle along limited slopes; with Δ = a_i - a_j and
// d = x_ij·∇a of one end, as on an even mesh where the difference behind it would be 2d - Δ,
//   slope = minmod(θΔ, d, θ(2d - Δ)),   θ = 1: minmod, θ = 2: monotonised central [B. van Leer, J. Comput. Phys. 23,
//   276 (1977)]
// which leaves the value between a_i and a_j.
#pragma once

#include <riemann/approximate.hpp>
#include <schemes/common.hpp>

namespace tetsuame::schemes {

template <class R>
struct star_state {
  R p, u;     // Pa; m/s along e
  R closing;  // m/s, of the particles themselves: w_ij
};

template <class R>
R limited(const R& difference, const R& slope, double theta) {
  const R behind = 2.0 * slope - difference;
  const R size = lesser(R(abs(slope)), R(theta * lesser(R(abs(difference)), R(abs(behind)))));
  return copysign(select(0.0 < difference * behind, size, R(0.0)), difference);
}

// By three steps of Newton's method. A function of its own: it is long, and rarely asked for.
template <class R>
[[gnu::noinline]] riemann::contact<R> exact_contact(const riemann::side<R>& l, const riemann::side<R>& r) {
  const auto star = riemann::solve(l, r, 3);
  return {star.p, star.u};
}

// theta: of the limiter, 1 to 2
template <int D>
auto interface(double theta, bool exact, const auto& ij) {
  using R = std::remove_cvref_t<decltype(ij.r)>;
  using foundation::dot;
  const auto e = ij.per_r * ij.x_ij;
  riemann::side<R> l{ij(of_density), dot(ij(of_velocity), e), ij(of_pressure), ij(of_gamma), ij(of_stiffness)};
  riemann::side<R> r{ij.own(of_density), dot(ij.own(of_velocity), e), ij.own(of_pressure), ij.own(of_gamma),
                     ij.own(of_stiffness)};
  const R closing = r.u - l.u;
  const auto along = [&](const vec<R, D>& gradient) { return dot(gradient, ij.x_ij); };
  const auto shear = [&](const auto& gradient) {
    R sum(0.0);
    foundation::for_each_of<D>([&](std::size_t a) {
      foundation::for_each_of<D>([&](std::size_t b) { sum += e[a] * gradient[D * a + b] * ij.x_ij[b]; });
    });
    return sum;
  };
  const auto carry = [&](R& a_l, R& a_r, const R& d_l, const R& d_r) {
    const R difference = a_r - a_l;
    a_l += 0.5 * limited(difference, d_l, theta);
    a_r -= 0.5 * limited(difference, d_r, theta);
  };
  carry(l.p, r.p, along(ij(of_grad_p)), along(ij.own(of_grad_p)));
  carry(l.rho, r.rho, along(ij(of_grad_rho)), along(ij.own(of_grad_rho)));
  carry(l.u, r.u, shear(ij(of_grad_v)), shear(ij.own(of_grad_v)));
  if constexpr (std::is_same_v<R, pairs::real>)
    if (exact) {
      const auto star = exact_contact(l, r);
      return star_state<R>{star.p, star.u, closing};
    }
  const auto star = riemann::hllc_contact(l, r, R(ij(of_sound)), R(ij.own(of_sound)));
  return star_state<R>{star.p, star.u, closing};
}

template <int D, class Kernel>
struct godunov : forces<D, Kernel> {
  double theta;
  bool exact;  // in double precision

  // What the interface reads, and what else.
  auto read_with(auto... tags) const {
    return this->g.read(of_velocity, of_density, of_pressure, of_sound, of_gamma, of_stiffness, of_grad_p, of_grad_rho,
                        of_grad_v, tags...);
  }
  auto star_of(const auto& ij) const { return interface<D>(theta, exact, ij); }

  template <class R>
  static void signal(auto& sum, const auto& ij, const two_slopes<R>& F, const star_state<R>& star) {
    keep_signal(sum, F, R(ij.own(of_sound) + ij(of_sound) - 3.0 * lesser(star.closing, R(0.0))));
  }
};

// weight = m; slope = 1/ρ²
template <int D, class Kernel>
struct gsph : godunov<D, Kernel> {
  auto reads() const { return this->read_with(of_mass, of_slope, of_per_support); }
  void add(auto& sum, const auto& ij) const {
    const auto F = slopes_of<D>(this->unit, ij);
    const auto star = this->star_of(ij);
    const auto mmP = ij.own(of_mass) * ij(of_mass) * star.p;
    const auto both = mmP * (rounded(ij.own(of_slope) * F.i) + rounded(ij(of_slope) * F.j));
    const auto own = foundation::dot(ij.own(of_velocity), ij.x_ij);
    sum.force -= both * ij.x_ij;
    sum.power -= both * (star.u * ij.r - own);
    this->signal(sum, ij, F, star);
  }
};

// weight = U; slope = f/q², or 1/q² with z; dissipation = B
template <int D, class Kernel>
struct gdisph : godunov<D, Kernel> {
  auto reads() const { return this->read_with(of_weight, of_slope, of_correction, of_per_support, of_dissipation); }
  void add(auto& sum, const auto& ij) const {
    const auto F = slopes_of<D>(this->unit, ij);
    const auto star = this->star_of(ij);
    const auto B = 0.5 * (ij.own(of_dissipation) + ij(of_dissipation)), rest = 1.0 - B, P = B * star.p;
    const auto U_i = ij.own(of_weight), U_j = ij(of_weight);
    const auto from_i = U_i * ij.own(of_slope) * (U_j + ij.own(of_correction)) * F.i * (P + rest * ij.own(of_pressure));
    const auto from_j = U_j * ij(of_slope) * (U_i + ij(of_correction)) * F.j * (P + rest * ij(of_pressure));
    sum.force -= (rounded(from_i) + rounded(from_j)) * ij.x_ij;
    sum.power += from_i * star.closing * ij.r;
    this->signal(sum, ij, F, star);
  }
};

// weight = U; slope = 1/q; dissipation = B
template <int D, class Kernel>
struct gdisph_of_contacts : godunov<D, Kernel> {
  double fading;

  auto reads() const { return this->read_with(of_weight, of_slope, of_correction, of_per_support, of_dissipation); }
  void add(auto& sum, const auto& ij) const {
    using R = std::remove_cvref_t<decltype(ij.r)>;
    const auto F = slopes_of<D>(this->unit, ij);
    const auto star = this->star_of(ij);
    const auto B = 0.5 * (ij.own(of_dissipation) + ij(of_dissipation)), rest = 1.0 - B, P = B * star.p;
    const auto U_i = ij.own(of_weight), U_j = ij(of_weight);
    const R p_i = ij.own(of_pressure), p_j = ij(of_pressure);
    const R size = p_i + ij.own(of_stiffness) + p_j + ij(of_stiffness);
    const R terms = greater(R(0.0), R(1.0 - fading * abs(p_i - p_j) / size));
    const R per_q_i = ij.own(of_slope), per_q_j = ij(of_slope), Y = 0.5 * (per_q_i + per_q_j);
    const R shared = (1.0 - terms) * Y * Y;
    const auto from_i =
        (terms * per_q_i * per_q_i + shared) * U_i * (U_j + terms * ij.own(of_correction)) * F.i * (P + rest * p_i);
    const auto from_j =
        (terms * per_q_j * per_q_j + shared) * U_j * (U_i + terms * ij(of_correction)) * F.j * (P + rest * p_j);
    sum.force -= (from_i + from_j) * ij.x_ij;
    sum.power += from_i * star.closing * ij.r;
    this->signal(sum, ij, F, star);
  }
};

}  // namespace tetsuame::schemes
