// Godunov DISPH [S4, eqs. (11), (12)]: DISPH with the star pressure of the Riemann problem between i and j.
//   m_i dv_i/dt = -Σ_j U_i U_j P*_ij [f_i/q_i² ∇W_ij(h_i) + f_j/q_j² ∇W_ij(h_j)]
//   dU_i/dt     =  Σ_j U_i U_j P*_ij  f_i/q_i² v_ij·∇W_ij(h_i)
// or, weighted by the mean B of the two ends' Balsara factors, with (1 - B) P_i + B P* and (1 - B) P_j + B P* in the
// two terms: DISPH without viscosity where gas is sheared and not compressed. Weight, z: as in disph.hpp.
#pragma once

#include <schemes/interface.hpp>

namespace tetsuame::schemes {

template <int D, class Kernel, bool Second>
struct gdisph {
  Kernel unit;
  gas<D> s;  // weight = U; slope = f/q², or 1/q² with z; dissipation = B
  rates<D> out;

  using me = sums<D>;
  auto reads() const {
    return std::tuple_cat(interface_reads<D, Second>(s),
                          std::tuple{pairs::read(pairs::of_weight, s.weight), pairs::read(of_slope, s.slope),
                                     pairs::read(of_correction, s.correction), pairs::read(of_per_support, s.per_S),
                                     pairs::read(of_dissipation, s.dissipation)});
  }
  me begin(const pairs::cluster<>&) const { return nothing<D>(); }
  void add(me& a, const auto& ij) const {
    const two_slopes F = slopes_of<D>(unit, ij);
    const star_state star = interface<D, Second>(s, ij);
    const real B = 0.5 * (ij.own(of_dissipation) + ij(of_dissipation)), rest = 1.0 - B, P = B * star.p;
    const real U_i = ij.own(pairs::of_weight), U_j = ij(pairs::of_weight);
    const real from_i =
        U_i * ij.own(of_slope) * (U_j + ij.own(of_correction)) * F.i * (P + rest * ij.own(pairs::of_pressure));
    const real from_j = U_j * ij(of_slope) * (U_i + ij(of_correction)) * F.j * (P + rest * ij(pairs::of_pressure));
    a.force -= (from_i + from_j) * ij.x_ij;
    a.power += from_i * star.closing * ij.r;
    keep_signal(a, F, real(ij.own(of_sound) + ij(of_sound) - 3.0 * lesser(star.closing, real(0.0))));
  }
  void end(const pairs::cluster<>& i, const me& a) const { write(out, i, a); }
};

}  // namespace tetsuame::schemes
