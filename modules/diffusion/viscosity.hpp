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

// Eta: an array, or the one value of all particles, 4 η η/(η + η) = 2 η: without a division a pair.
template <int D, class Eta>
struct viscous_sum {
  using real = pairs::real;
  static constexpr bool uniform = std::is_same_v<Eta, double>;

  std::array<const double*, D> v;  // m/s
  Eta eta;                         // Pa s
  const double* dV;                // m^D
  std::array<double*, D> force;    // N, added to
  double* heat;                    // W, added to; null: not wanted

  struct me {
    real factor;  // 2 η ΔV where η is uniform
    pairs::vec<real, D> force;
    real dissipation;
  };

  auto reads() const {
    using namespace pairs;
    const std::tuple always{read(of_velocity, v), read(of_volume, dV)};
    if constexpr (uniform)
      return always;
    else
      return std::tuple_cat(always, std::tuple{read(of_viscosity, eta)});
  }
  me begin(const pairs::cluster& i) const {
    me a{real(0.0), foundation::zero<real, D>(), real(0.0)};
    if constexpr (uniform) a.factor = 2.0 * eta * i(dV);
    return a;
  }
  void add(me& a, const auto& ij) const {
    using namespace pairs;
    real factor = a.factor;
    if constexpr (!uniform) factor = harmonic(ij.own(of_viscosity), ij(of_viscosity)) * ij.own(of_volume);
    factor *= ij(of_volume) * ij.F;
    const auto v_ij = ij.difference(of_velocity);
    a.force += factor * v_ij;
    a.dissipation -= factor * foundation::dot(v_ij, v_ij);
  }
  void end(const pairs::cluster& i, const me& a) const {
    for (std::size_t k = 0; k < D; ++k) i.add(force[k], a.force[k]);
    if (heat != nullptr) i.add(heat, 0.5 * a.dissipation);
  }
};

template <int D>
using viscosity = viscous_sum<D, const double*>;
template <int D>
using uniform_viscosity = viscous_sum<D, double>;

}  // namespace tetsuame::diffusion
