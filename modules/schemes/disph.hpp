// Density-independent SPH [T. R. Saitoh, J. Makino, Astrophys. J. 768, 44 (2013)] with the terms of varying h of [S4]:
//   m_i dv_i/dt = -Σ_j U_i U_j [f_i P_i/q_i² ∇W_ij(h_i) + f_j P_j/q_j² ∇W_ij(h_j)] + viscosity
//   dU_i/dt     =  Σ_j U_i U_j  f_i P_i/q_i² v_ij·∇W_ij(h_i)                       + viscosity
// P = (γ - 1) q; ρ = m q/U in the viscosity. With z for f: schemes/common.hpp. The weight may be another than U [Saitoh
// and Makino, section 5]: then P is of ρ = m y/w and u by the equation of state.
#pragma once

#include <schemes/artificial_viscosity.hpp>
#include <schemes/forces.hpp>

namespace tetsuame::schemes {

template <int D, class Kernel>
struct disph {
  Kernel unit;
  gas<D> s;  // weight = U; slope = f P/q², or P/q² with z
  rates<D> out;

  using me = sums<D>;
  auto reads() const {
    return std::tuple{pairs::read(pairs::of_velocity, s.v),
                      pairs::read(pairs::of_weight, s.weight),
                      pairs::read(of_mass, s.m),
                      pairs::read(of_density, s.rho),
                      pairs::read(of_sound, s.c),
                      pairs::read(of_slope, s.slope),
                      pairs::read(of_correction, s.correction),
                      pairs::read(of_per_support, s.per_S),
                      pairs::read(of_dissipation, s.dissipation)};
  }
  me begin(std::size_t) const { return nothing<D>(); }
  void add(me& a, const auto& ij) const {
    const two_slopes F = slopes_of<D>(unit, ij);
    const real v_x = ij.along(pairs::of_velocity), closing = lesser(real(v_x * ij.per_r), real(0.0));
    const real signal = ij.own(of_sound) + ij(of_sound) - 3.0 * closing;
    const real U_i = ij.own(pairs::of_weight), U_j = ij(pairs::of_weight);
    const real from_i = U_i * ij.own(of_slope) * (U_j + ij.own(of_correction)) * F.i;
    const real from_j = U_j * ij(of_slope) * (U_i + ij(of_correction)) * F.j;
    const real viscosity = viscous(ij, F, closing, signal);
    a.force -= (from_i + from_j + viscosity) * ij.x_ij;
    a.power += (from_i + 0.5 * viscosity) * v_x;
    keep_signal(a, F, signal);
  }
  void end(std::size_t i, const me& a) const { write(out, i, a); }
};

}  // namespace tetsuame::schemes
