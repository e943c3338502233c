// Godunov SPH, case 3 of [S.-H. Cha, A. P. Whitworth, MNRAS 340, 73 (2003)]:
//   m_i dv_i/dt = -Σ_j m_i m_j P*_ij [ρ_i⁻² ∇W_ij(h_i) + ρ_j⁻² ∇W_ij(h_j)]
//   dU_i/dt     = -Σ_j m_i m_j P*_ij (v*_ij - v_i)·[the same]
#pragma once

#include <schemes/interface.hpp>

namespace tetsuame::schemes {

template <int D, class Kernel, bool Second>
struct gsph {
  Kernel unit;
  gas<D> s;  // weight = m; slope = 1/ρ²
  rates<D> out;

  using me = sums<D>;
  auto reads() const {
    return std::tuple_cat(
        interface_reads<D, Second>(s),
        std::tuple{pairs::read(of_mass, s.m), pairs::read(of_slope, s.slope), pairs::read(of_per_support, s.per_S)});
  }
  me begin(const pairs::cluster<>&) const { return nothing<D>(); }
  void add(me& a, const auto& ij) const {
    const two_slopes F = slopes_of<D>(unit, ij);
    const star_state star = interface<D, Second>(s, ij);
    const real mmP = ij.own(of_mass) * ij(of_mass) * star.p;
    const real both = mmP * (ij.own(of_slope) * F.i + ij(of_slope) * F.j);
    const real own = foundation::dot(ij.own(pairs::of_velocity), ij.x_ij);
    a.force -= both * ij.x_ij;
    a.power -= both * (star.u * ij.r - own);
    keep_signal(a, F, real(ij.own(of_sound) + ij(of_sound) - 3.0 * lesser(star.closing, real(0.0))));
  }
  void end(const pairs::cluster<>& i, const me& a) const { write(out, i, a); }
};

}  // namespace tetsuame::schemes
