// Continuity in DISPH form: D ln ρ_i/Dt = Σ_j (Y_j/p_j) v_ij·∇_i W_ij  [S0],
// and with the same sum the velocity divergence ∇·v = -D ln ρ/Dt.
#pragma once

#include <pairs/pairs.hpp>

namespace tetsuame::gradient {

template <int D>
struct continuity {
  using real = pairs::real;

  std::array<const double*, D> v;  // m/s
  const double* dV;                // m^D, Y/p
  double* dlnrho;                  // 1/s, set

  struct me {
    real sum;
  };

  auto reads() const { return std::tuple{pairs::read(pairs::of_velocity, v), pairs::read(pairs::of_volume, dV)}; }
  me begin(const pairs::cluster&) const { return {real(0.0)}; }
  void add(me& a, const auto& ij) const { a.sum += ij(pairs::of_volume) * ij.F * ij.along(pairs::of_velocity); }
  void end(const pairs::cluster& i, const me& a) const { i.set(dlnrho, a.sum); }
};

}  // namespace tetsuame::gradient
