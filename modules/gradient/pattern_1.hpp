// Pressure gradient, pattern 1 [S0 eq. (1), S2]:
//   m_i Dv_i/Dt = -Σ_j (Y_i²/p_i + Y_j²/p_j) ∇_i W_ij
//   m_i Du_i/Dt =  ½ Σ_j (Y_i²/p_i + Y_j²/p_j) v_ij·∇_i W_ij
// Written with ΔV = Y/p as Y²/p = p ΔV², which needs no division by p: the same for
// smoothed and non-smoothed pressure. Momentum and energy are exchanged pair by pair.
#pragma once

#include <gradient/sums.hpp>
#include <pairs/pairs.hpp>

namespace tetsuame::gradient {

struct pattern_1 {
  static constexpr const char* name = "pattern_1";
  template <int D>
  struct term;
};

template <int D>
struct pattern_1::term {
  using real = pairs::real;

  std::array<const double*, D> v;  // m/s
  const double* p;                 // Pa
  const double* dV;                // m^D
  sums<D> out;

  struct me {
    real stress;                // J m^D, p ΔV² of particle i
    pairs::vec<real, D> force;  // N, its sign reversed
    real work;                  // W
  };

  auto reads() const {
    using namespace pairs;
    return std::tuple{read(of_velocity, v), read(of_pressure, p), read(of_volume, dV)};
  }
  me begin(const pairs::cluster& i) const {
    return {real(i(p) * i(dV) * i(dV)), foundation::zero<real, D>(), real(0.0)};
  }
  void add(me& a, const auto& ij) const {
    const real dV_j = ij(pairs::of_volume);
    const real stress = a.stress + ij(pairs::of_pressure) * dV_j * dV_j;
    const real slope = stress * ij.F;
    a.force += slope * ij.x_ij;
    a.work += slope * ij.along(pairs::of_velocity);
  }
  void end(const pairs::cluster& i, const me& a) const {
    for (std::size_t k = 0; k < D; ++k) i.add(out.force[k], -a.force[k]);
    i.add(out.power, 0.5 * a.work);
  }
};

}  // namespace tetsuame::gradient
