// Heat conduction [S2]: Q_i = Σ_j [4 k_i k_j/(k_i + k_j)] ΔV_i ΔV_j (x_ij·∇_i W_ij/|x_ij|²) T_ij  (W).
// Antisymmetric in i and j: heat is exchanged, none is made.
#pragma once

#include <diffusion/viscosity.hpp>

namespace tetsuame::diffusion {

// Conductivity: an array, or the one value of all particles, 4 k k/(k + k) = 2 k.
template <int D, class Conductivity>
struct conduction_sum {
  static constexpr bool uniform = std::is_same_v<Conductivity, double>;

  const double* T;   // K
  Conductivity k;    // W/(m K)
  const double* dV;  // m^D
  double* heat;      // W, added to

  template <class R>
  struct me {
    R sum;
  };

  auto reads() const {
    using namespace pairs;
    const std::tuple always{read(of_temperature, T), read(of_volume, dV, D)};
    if constexpr (uniform)
      return always;
    else
      return std::tuple_cat(always, std::tuple{read(of_conductivity, k)});
  }
  template <class R>
  me<R> begin(const pairs::cluster<R>&) const {
    return {R(0.0)};
  }
  void add(auto& a, const auto& ij) const {
    using namespace pairs;
    using R = std::remove_cvref_t<decltype(ij.F)>;
    R both(1.0);
    if constexpr (!uniform) both = harmonic(ij.own(of_conductivity), ij(of_conductivity));
    const auto factor = of_both_ends(both, ij.own(of_volume), ij(of_volume), ij.F);
    a.sum += factor * ij.difference(of_temperature);
  }
  void end(const auto& i, const auto& a) const {
    if constexpr (uniform)
      i.add(heat, 2.0 * k * a.sum, D - 2);
    else
      i.add(heat, a.sum, D - 2);
  }
};

template <int D>
using conduction = conduction_sum<D, const double*>;

}  // namespace tetsuame::diffusion
