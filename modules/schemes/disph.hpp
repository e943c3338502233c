// Density-independent SPH [T. R. Saitoh, J. Makino, Astrophys. J. 768, 44 (2013)] with the terms of varying h of [S4]:
//   m_i dv_i/dt = -Σ_j U_i U_j [f_i P_i/q_i² ∇W_ij(h_i) + f_j P_j/q_j² ∇W_ij(h_j)] + viscosity
//   dU_i/dt     =  Σ_j U_i U_j  f_i P_i/q_i² v_ij·∇W_ij(h_i)                       + viscosity
// P = (γ - 1) q; ρ = m q/U in the viscosity. With z for f: schemes/common.hpp. The weight may be another than U [Saitoh
// and Makino, section 5]: then P is of ρ = m y/w and u by the equation of state.
#pragma once

#include <schemes/artificial_viscosity.hpp>

namespace tetsuame::schemes {

template <int D, class Kernel>
struct disph {
  Kernel unit;
  gas<D> s;  // weight = U; slope = f P/q², or P/q² with z
  rates<D> out;

  using me = sums<D>;
  auto reads() const {
    return std::tuple_cat(viscous_reads(s), std::tuple{pairs::read(pairs::of_weight, s.weight),
                                                       pairs::read(of_correction, s.correction)});
  }
  me begin(const pairs::cluster<>&) const { return nothing<D>(); }
  void add(me& a, const auto& ij) const {
    const two_slopes F = slopes_of<D>(unit, ij);
    const real U_i = ij.own(pairs::of_weight), U_j = ij(pairs::of_weight);
    const real from_i = U_i * ij.own(of_slope) * (U_j + ij.own(of_correction)) * F.i;
    const real from_j = U_j * ij(of_slope) * (U_i + ij(of_correction)) * F.j;
    add_with_viscosity(a, ij, F, from_i, from_j);
  }
  void end(const pairs::cluster<>& i, const me& a) const { write(out, i, a); }
};

}  // namespace tetsuame::schemes
