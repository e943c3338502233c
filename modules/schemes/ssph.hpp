// Standard SPH with the terms of varying h [V. Springel, L. Hernquist, MNRAS 333, 649 (2002)]:
//   m_i dv_i/dt = -Σ_j m_i m_j [f_i P_i/ρ_i² ∇W_ij(h_i) + f_j P_j/ρ_j² ∇W_ij(h_j)] + viscosity
//   dU_i/dt     =  Σ_j m_i m_j  f_i P_i/ρ_i² v_ij·∇W_ij(h_i)                       + viscosity
#pragma once

#include <schemes/artificial_viscosity.hpp>

namespace tetsuame::schemes {

template <int D, class Kernel>
struct ssph {
  Kernel unit;
  gas<D> s;  // weight = m; slope = f P/ρ²
  rates<D> out;

  using me = sums<D>;
  auto reads() const { return viscous_reads(s); }
  me begin(const pairs::cluster<>&) const { return nothing<D>(); }
  void add(me& a, const auto& ij) const {
    const two_slopes F = slopes_of<D>(unit, ij);
    const real mm = ij.own(of_mass) * ij(of_mass);
    const real from_i = mm * ij.own(of_slope) * F.i, from_j = mm * ij(of_slope) * F.j;
    add_with_viscosity(a, ij, F, from_i, from_j);
  }
  void end(const pairs::cluster<>& i, const me& a) const { write(out, i, a); }
};

}  // namespace tetsuame::schemes
