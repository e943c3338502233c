// Heat conduction [S2]: Q_i = Σ_j [4 k_i k_j/(k_i + k_j)] ΔV_i ΔV_j (x_ij·∇_i W_ij/|x_ij|²) T_ij  (W).
// Antisymmetric in i and j: heat is exchanged, none is made.
#pragma once

#include <diffusion/viscosity.hpp>

namespace tetsuame::diffusion {

template <int D>
struct conduction {
  const double* T;   // K
  const double* k;   // W/(m K)
  const double* dV;  // m^D
  double* heat;      // W, added to

  template <class R>
  struct me {
    R sum;
  };

  auto reads() const {
    using namespace pairs;
    return std::tuple{read(of_temperature, T), read(of_conductivity, k), read(of_volume, dV, D)};
  }
  template <class R>
  me<R> begin(const pairs::cluster<R>&) const {
    return {R(0.0)};
  }
  void add(auto& a, const auto& ij) const {
    using namespace pairs;
    const auto factor =
        of_both_ends(harmonic(ij.own(of_conductivity), ij(of_conductivity)), ij.own(of_volume), ij(of_volume), ij.F);
    a.sum += factor * ij.difference(of_temperature);
  }
  void end(const auto& i, const auto& a) const { i.add(heat, a.sum, D - 2); }
};

}  // namespace tetsuame::diffusion
