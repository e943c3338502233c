// Heat conduction [S2]: Q_i = Σ_j [4 k_i k_j/(k_i + k_j)] ΔV_i ΔV_j (x_ij·∇_i W_ij/|x_ij|²) T_ij  (W).
// Antisymmetric in i and j: heat is exchanged, none is made.
#pragma once

#include <diffusion/viscosity.hpp>

namespace tetsuame::diffusion {

template <int D>
struct conduction {
  using real = pairs::real;

  const double* T;   // K
  const double* k;   // W/(m K)
  const double* dV;  // m^D
  double* heat;      // W, added to

  struct me {
    real k, dV, T, sum;
  };

  auto reads() const {
    using namespace pairs;
    return std::tuple{read(of_temperature, T), read(of_conductivity, k), read(of_volume, dV)};
  }
  me begin(std::size_t i) const { return {real(k[i]), real(dV[i]), real(T[i]), real(0.0)}; }
  void add(me& a, const auto& ij) const {
    const real factor = harmonic(a.k, ij(pairs::of_conductivity)) * a.dV * ij(pairs::of_volume) * ij.F;
    a.sum += factor * (a.T - ij(pairs::of_temperature));
  }
  void end(std::size_t i, const me& a) const { heat[i] += pairs::sum(a.sum); }
};

}  // namespace tetsuame::diffusion
