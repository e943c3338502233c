// Continuity in DISPH form: D ln ρ_i/Dt = Σ_j (Y_j/p_j) v_ij·∇_i W_ij  [S0],
// and with the same sum the velocity divergence ∇·v = -D ln ρ/Dt. Or with the particle's own volume,
//   D ln ρ_i/Dt = ΔV_i Σ_j v_ij·∇_i W_ij,
// at which the number density changes. To either belongs a force whose work the pressure at that density takes up
// (docs/theory/consistency.md): to the former pattern 2, to the latter pattern 1.
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

template <int D>
struct own_continuity : continuity<D> {
  void add(auto& a, const auto& ij) const { a.sum += ij.F * ij.along(pairs::of_velocity); }
  void end(const auto& i, const auto& a) const { i.set(this->dlnrho, i(this->dV, D) * a.sum, -1); }
};

}  // namespace tetsuame::gradient
