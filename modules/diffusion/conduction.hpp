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
    real sum;
  };

  auto reads() const {
    using namespace pairs;
    return std::tuple{read(of_temperature, T), read(of_conductivity, k), read(of_volume, dV)};
  }
  me begin(const pairs::cluster&) const { return {real(0.0)}; }
  void add(me& a, const auto& ij) const {
    using namespace pairs;
    const real factor =
        harmonic(ij.own(of_conductivity), ij(of_conductivity)) * ij.own(of_volume) * (ij(of_volume) * ij.F);
    a.sum += factor * ij.difference(of_temperature);
  }
  void end(const pairs::cluster& i, const me& a) const { i.add(heat, a.sum); }
};

}  // namespace tetsuame::diffusion
