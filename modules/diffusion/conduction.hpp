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

  me begin(std::size_t i) const { return {real(k[i]), real(dV[i]), real(T[i]), real(0.0)}; }
  void add(me& a, const pairs::pair<D>& ij) const {
    const real factor = harmonic(a.k, pairs::gather(k, ij.j)) * a.dV * pairs::gather(dV, ij.j) * ij.F;
    a.sum += factor * (a.T - pairs::gather(T, ij.j));
  }
  void end(std::size_t i, const me& a) const { heat[i] += pairs::sum(a.sum); }
};

}  // namespace tetsuame::diffusion
