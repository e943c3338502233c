// Sums over neighbours of weakly compressible water with Riemann problems between its particles [C. Zhang, X. Y. Hu, N.
// A. Adams, J. Comput. Phys. 335, 605 (2017)], along e from i to j (docs/theory/water_schemes.md):
//   m_i dv_i/dt = -Σ_j 2 p* V_i V_j ∇_i W_ij + 2 (D+2) Σ_j η V_i V_j (v_ij·x_ij)/|x_ij|² ∇_i W_ij + m_i g
//   dρ_i/dt = ρ_i Σ_j 2 V_j (v_i - v*)·∇_i W_ij,   v* = ½ (v_i + v_j) + (u* - ½ (v_i + v_j)·e) e
// Both states are those at the middle of the pair, to where water at rest goes on with the weight of its mean density:
// so still water stays, as with the diffusion of terms.hpp. η is the water's viscosity alone.
#pragma once

#include <free_surface/terms.hpp>
#include <riemann/acoustic.hpp>

namespace tetsuame::free_surface {

// As the two's mean velocity sees it. closing: v_ij·x_ij, m2/s; rise: g (y_i - y_j), m2/s2; c: m/s.
template <class R>
riemann::contact<R> contact_of_pair(const R& rho_i, const R& rho_j, const R& p_i, const R& p_j, const R& closing,
                                    const R& per_r, const R& rise, const R& c) {
  const R u = -0.5 * closing * per_r, weight = 0.25 * (rho_i + rho_j) * rise;
  return riemann::acoustic_contact(riemann::liquid_side<R>{rho_i, u, p_i + weight},
                                   riemann::liquid_side<R>{rho_j, 0.0 - u, p_j - weight}, c);
}

// Riemann problems take the velocities of continuity: a wall is no leak.
template <int D, bool two_velocities>
struct riemann_motion : sums_of_water<D, two_velocities> {
  double c;  // m/s

  template <class R>
  struct me {
    pairs::vec<R, D> force;
    R divergence;
    R viscous, g, c;  // 2 (D+2) η, g, c: the same for all
  };
  template <class R>
  me<R> begin(const pairs::cluster<R>& i) const {
    return {foundation::zero<R, D>(), R(0.0), R(2.0 * (D + 2.0) * this->eta * i.lengths.to(-1)),
            R(this->g * i.lengths.to(1)), R(c)};
  }
  void add(auto& a, const auto& ij) const {
    using namespace pairs;
    using R = std::remove_cvref_t<decltype(ij.F)>;
    const R VF = ij(of_volume) * ij.F, closing = ij.along(of_velocity), per_r2 = ij.per_r * ij.per_r;
    R sheared = closing;
    if constexpr (two_velocities) sheared = ij.along(of_viscous_velocity);
    const auto star = contact_of_pair<R>(ij.own(of_density), ij(of_density), ij.own(of_pressure), ij(of_pressure),
                                         closing, ij.per_r, a.g * ij.x_ij[1], a.c);
    a.divergence += VF * (closing + 2.0 * star.u * ij.r);
    a.force += (VF * (a.viscous * sheared * per_r2 - 2.0 * star.p)) * ij.x_ij;
  }
  void end(const auto& i, const auto& a) const {
    const auto V_i = i(this->V, D);
    for (std::size_t k = 0; k < D; ++k) i.set(this->force[k], V_i * a.force[k], D - 1);
    i.set(this->rho_rate, i(this->rho) * a.divergence, -1);
  }
};

}  // namespace tetsuame::free_surface
