// Viscous force and dissipation [S2]:
//   m_i Dv_i/Dt ⊃ Σ_j [4 η_i η_j/(η_i + η_j)] ΔV_i ΔV_j (x_ij·∇_i W_ij/|x_ij|²) v_ij
//   Φ_i         = -½ Σ_j [the same factor] v_ij²        (W, goes into heat)
// x·∇W/|x|² is the pair's F. What a pair loses in motion, its two halves gain in heat.
#pragma once

#include <pairs/pairs.hpp>

namespace tetsuame::diffusion {

// 4 a b/(a + b): zero where both vanish.
inline pairs::real harmonic(const pairs::real& a, const pairs::real& b) {
  const pairs::real sum = a + b;
  pairs::real mean = 4.0 * a * b / sum;
  pairs::stdx::where(sum == 0.0, mean) = 0.0;
  return mean;
}

template <int D>
struct viscosity {
  using real = pairs::real;

  std::array<const double*, D> v;  // m/s
  const double* eta;               // Pa s
  const double* dV;                // m^D
  std::array<double*, D> force;    // N, added to
  double* heat;                    // W, added to; null: not wanted

  struct me {
    pairs::vec<real, D> force;
    real dissipation;
  };

  auto reads() const {
    using namespace pairs;
    return std::tuple{read(of_velocity, v), read(of_volume, dV), read(of_viscosity, eta)};
  }
  me begin(std::size_t) const { return {foundation::zero<real, D>(), real(0.0)}; }
  void add(me& a, const auto& ij) const {
    using namespace pairs;
    const real factor = harmonic(ij.own(of_viscosity), ij(of_viscosity)) * ij.own(of_volume) * (ij(of_volume) * ij.F);
    const auto v_ij = ij.difference(pairs::of_velocity);
    a.force += factor * v_ij;
    a.dissipation -= factor * foundation::dot(v_ij, v_ij);
  }
  void end(std::size_t i, const me& a) const {
    for (std::size_t k = 0; k < D; ++k) force[k][i] += pairs::sum(a.force[k]);
    if (heat != nullptr) heat[i] += 0.5 * pairs::sum(a.dissipation);
  }
};

// The same where all particles share one viscosity: 4 η η/(η + η) = 2 η, without a division a pair.
template <int D>
struct uniform_viscosity {
  using real = pairs::real;

  std::array<const double*, D> v;  // m/s
  double eta;                      // Pa s
  const double* dV;                // m^D
  std::array<double*, D> force;    // N, added to
  double* heat;                    // W, added to; null: not wanted

  struct me {
    real factor;
    pairs::vec<real, D> force;
    real dissipation;
  };

  auto reads() const { return std::tuple{pairs::read(pairs::of_velocity, v), pairs::read(pairs::of_volume, dV)}; }
  me begin(std::size_t i) const { return {real(2.0 * eta * dV[i]), foundation::zero<real, D>(), real(0.0)}; }
  void add(me& a, const auto& ij) const {
    const real factor = a.factor * (ij(pairs::of_volume) * ij.F);
    const auto v_ij = ij.difference(pairs::of_velocity);
    a.force += factor * v_ij;
    a.dissipation -= factor * foundation::dot(v_ij, v_ij);
  }
  void end(std::size_t i, const me& a) const {
    for (std::size_t k = 0; k < D; ++k) force[k][i] += pairs::sum(a.force[k]);
    if (heat != nullptr) heat[i] += 0.5 * pairs::sum(a.dissipation);
  }
};

}  // namespace tetsuame::diffusion
