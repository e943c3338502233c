// Pressure gradient, pattern 1 [S0 eq. (1), S2]:
//   m_i Dv_i/Dt = -Σ_j (Y_i²/p_i + Y_j²/p_j) ∇_i W_ij
//   m_i Du_i/Dt =  ½ Σ_j (Y_i²/p_i + Y_j²/p_j) v_ij·∇_i W_ij
// Written with ΔV = Y/p as Y²/p = p ΔV², which needs no division by p: the same for
// smoothed and non-smoothed pressure. Momentum and energy are exchanged pair by pair.
#pragma once

#include <gradient/continuity.hpp>
#include <gradient/sums.hpp>
#include <pairs/long_sum.hpp>
#include <pairs/pairs.hpp>

namespace tetsuame::gradient {

struct pattern_1 {
  static constexpr const char* name = "pattern_1";
  template <int D>
  using energy_conserving_continuity = own_continuity<D>;
  template <int D>
  struct term;
};

template <int D>
struct pattern_1::term {
  std::array<const double*, D> v;  // m/s
  const double* p;                 // Pa
  const double* dV;                // m^D
  sums<D> out;

  template <class R>
  struct me {
    R stress;                     // J m^D, p ΔV² of particle i
    pairs::long_sum<R, D> force;  // N
    R work;                       // W
  };

  auto reads() const {
    using namespace pairs;
    return std::tuple{read(of_velocity, v), read(of_pressure, p), read(of_volume, dV, D)};
  }
  template <class R>
  me<R> begin(const pairs::cluster<R>& i) const {
    const R Y = i(p) * i(dV, D);
    return {R(Y * i(dV, D)), pairs::long_sum<R, D>(R(larger * Y)), R(0.0)};
  }
  void add(auto& a, const auto& ij) const {
    const auto dV_j = ij(pairs::of_volume);
    const auto stress = a.stress + foundation::rounded(ij(pairs::of_pressure) * dV_j * dV_j);
    const auto slope = stress * ij.F;
    a.force -= slope * ij.x_ij;
    a.work += slope * ij.along(pairs::of_velocity);
  }
  static void join(auto& a, const auto& other) {
    a.force.join();
    a.work += other.work;
  }
  void end(const auto& i, const auto& a) const {
    for (std::size_t k = 0; k < D; ++k) i.add_doubles(out.force[k], a.force[k], D - 1);
    i.add(out.power, 0.5 * a.work, D - 1);
  }
};

}  // namespace tetsuame::gradient
