// Godunov DISPH [S4, eqs. (11), (12)]: DISPH with the star pressure of the Riemann problem between i and j.
//   m_i dv_i/dt = -Σ_j U_i U_j P*_ij [f_i/q_i² ∇W_ij(h_i) + f_j/q_j² ∇W_ij(h_j)]
//   dU_i/dt     =  Σ_j U_i U_j P*_ij  f_i/q_i² v_ij·∇W_ij(h_i)
#pragma once

#include <schemes/interface.hpp>

namespace tetsuame::schemes {

template <int D, class Kernel, bool Second>
struct gdisph {
  Kernel unit;
  gas<D> s;  // weight = U; slope = f/q²
  rates<D> out;

  using me = sums<D>;
  auto reads() const {
    return std::tuple_cat(interface_reads<D, Second>(s),
                          std::tuple{pairs::read(pairs::of_weight, s.weight), pairs::read(of_slope, s.slope),
                                     pairs::read(of_per_support, s.per_S)});
  }
  me begin(std::size_t) const { return nothing<D>(); }
  void add(me& a, const auto& ij) const {
    const two_slopes F = slopes_of<D>(unit, ij);
    const star_state star = interface<D, Second>(s, ij);
    const real UUP = ij.own(pairs::of_weight) * ij(pairs::of_weight) * star.p;
    const real from_i = UUP * ij.own(of_slope) * F.i, from_j = UUP * ij(of_slope) * F.j;
    a.force -= (from_i + from_j) * ij.x_ij;
    a.power += from_i * star.closing * ij.r;
    keep_signal(a, F, real(ij.own(of_sound) + ij(of_sound) - 3.0 * lesser(star.closing, real(0.0))));
  }
  void end(std::size_t i, const me& a) const { write(out, i, a); }
};

}  // namespace tetsuame::schemes
