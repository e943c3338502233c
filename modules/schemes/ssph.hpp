// Standard SPH with the terms of varying h [V. Springel, L. Hernquist, MNRAS 333, 649 (2002)]:
//   m_i dv_i/dt = -Σ_j m_i m_j [f_i P_i/ρ_i² ∇W_ij(h_i) + f_j P_j/ρ_j² ∇W_ij(h_j)] + viscosity
//   dU_i/dt     =  Σ_j m_i m_j  f_i P_i/ρ_i² v_ij·∇W_ij(h_i)                       + viscosity
#pragma once

#include <schemes/artificial_viscosity.hpp>
#include <schemes/forces.hpp>

namespace tetsuame::schemes {

template <int D, class Kernel>
struct ssph {
  Kernel unit;
  gas<D> s;  // weight = m; slope = f P/ρ²
  rates<D> out;

  using me = sums<D>;
  auto reads() const {
    return std::tuple{pairs::read(pairs::of_velocity, s.v),
                      pairs::read(of_mass, s.m),
                      pairs::read(of_density, s.rho),
                      pairs::read(of_sound, s.c),
                      pairs::read(of_slope, s.slope),
                      pairs::read(of_per_support, s.per_S),
                      pairs::read(of_dissipation, s.dissipation)};
  }
  me begin(std::size_t) const { return nothing<D>(); }
  void add(me& a, const auto& ij) const {
    const two_slopes F = slopes_of<D>(unit, ij);
    const real v_x = ij.along(pairs::of_velocity), closing = lesser(real(v_x * ij.per_r), real(0.0));
    const real signal = ij.own(of_sound) + ij(of_sound) - 3.0 * closing;
    const real mm = ij.own(of_mass) * ij(of_mass);
    const real from_i = mm * ij.own(of_slope) * F.i, from_j = mm * ij(of_slope) * F.j;
    const real viscosity = viscous(ij, F, closing, signal);
    a.force -= (from_i + from_j + viscosity) * ij.x_ij;
    a.power += (from_i + 0.5 * viscosity) * v_x;
    keep_signal(a, F, signal);
  }
  void end(std::size_t i, const me& a) const { write(out, i, a); }
};

}  // namespace tetsuame::schemes
