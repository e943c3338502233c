// Continuity in DISPH form: D ln ρ_i/Dt = Σ_j (Y_j/p_j) v_ij·∇_i W_ij  [S0],
// and with the same sum the velocity divergence ∇·v = -D ln ρ/Dt.
#pragma once

#include <pairs/pairs.hpp>

namespace tetsuame::gradient {

template <int D>
struct continuity {
  std::array<const double*, D> v;  // m/s
  const double* dV;                // m^D, Y/p
  double* dlnrho;                  // 1/s, set

  template <class R>
  struct me {
    R sum;
  };

  auto reads() const { return std::tuple{pairs::read(pairs::of_velocity, v), pairs::read(pairs::of_volume, dV, D)}; }
  template <class R>
  me<R> begin(const pairs::cluster<R>&) const {
    return {R(0.0)};
  }
  void add(auto& a, const auto& ij) const { a.sum += ij(pairs::of_volume) * ij.F * ij.along(pairs::of_velocity); }
  void end(const auto& i, const auto& a) const { i.set(dlnrho, a.sum, -1); }
};

}  // namespace tetsuame::gradient
