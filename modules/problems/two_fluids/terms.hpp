// Sums over neighbours of two fluids with walls that are mirror images.
//
// Pressure and viscosity, one pass:
//   m_i dv_i/dt = -Σ_j (A_i + A_j) ∇_i W_ij
//                 + Σ_j [4 η_i η_j/(η_i + η_j)] ΔV_i ΔV_j F_ij [a v_ij + b (v_ij·x_ij) x_ij/|x_ij|²]
//   A = p ΔV² = Y²/p: pattern 1 [S0, S2]
//   F_ij = F (a0 - a1 |x_ij|²): a0 = 1, a1 = 0 is the notes' sum, which smooths like the kernel, by a part of order
//   (kS)²; lattice.hpp has weights that do so by (kS)⁴ only
//   a = 1, b = 0: ∇·(η ∇v) [S2];   `symmetric`: a = 0, b = d + 2: the divergence of η [∇v + (∇v)ᵀ + (∇·v) 1], which
//   conserves angular momentum and holds where η varies [J. J. Monaghan, Rep. Prog. Phys. 68, 1703 (2005), sect. 3.2]
// and with it D_i = Σ_j v_ij·∇_i W_ij: A_i D_i (W) is what compression takes up; and the heat of friction.
//
// Density by continuity, with diffusion of the dynamic pressure (δ-SPH: after S. Marrone et al., Comput. Methods Appl.
// Mech. Eng. 200, 1526 (2011); across materials, since p is continuous where ρ jumps):
//   dρ_i/dt = ρ_i Σ_j ΔV_j v_ij·∇_i W_ij
//             + δ (h/c_i) Σ_j 2 [(p̂_i - p̂_j) + ½ (ρ_i + ρ_j) g (y_i - y_j)] F_ij ΔV_j
#pragma once

#include <diffusion/viscosity.hpp>
#include <pairs/pairs.hpp>
#include <schemes/common.hpp>

namespace tetsuame::two_fluids {

inline constexpr schemes::field<struct stress_tag> of_stress;
inline constexpr schemes::field<struct density_tag> of_density;

// Where either end has a support of its own (supports.hpp): A_i F_i + A_j F_j, F_i, and r² on the scale of the start.
template <class R>
R slope_of(const auto& ij, const R& A_i, const R& A_j) {
  if constexpr (requires { ij.F_i; })
    return A_i * ij.F_i + A_j * ij.F_j;
  else
    return (A_i + A_j) * ij.F;
}
auto own_slope(const auto& ij) {
  if constexpr (requires { ij.F_i; })
    return ij.F_i;
  else
    return ij.F;
}
auto r2_of_start(const auto& ij) {
  if constexpr (requires { ij.r2_of_start; })
    return ij.r2_of_start;
  else
    return ij.r2;
}

template <int D, bool symmetric>
struct forces {
  std::array<const double*, D> v;  // m/s
  const double *A, *V, *eta;       // Pa m^2D, m^D, Pa s
  double a0, a1;                   // 1, 1/m2
  std::array<double*, D> force;    // N
  double *compression, *heat;      // D_i; W

  template <class R>
  struct me {
    pairs::vec<R, D> force;
    R compression, heat;
    R a1;
  };
  auto reads() const {
    using namespace pairs;
    return std::tuple{read(of_velocity, v), read(of_stress, A, 2 * D), read(of_volume, V, D),
                      read(of_viscosity, eta, 1)};
  }
  template <class R>
  me<R> begin(const pairs::cluster<R>& i) const {
    return {foundation::zero<R, D>(), R(0.0), R(0.0), R(a1 * i.lengths.to(2))};
  }
  void add(auto& sums, const auto& ij) const {
    using namespace pairs;
    const auto slope = slope_of(ij, ij.own(of_stress), ij(of_stress));
    const auto friction = diffusion::of_both_ends(diffusion::harmonic(ij.own(of_viscosity), ij(of_viscosity)),
                                                  ij.own(of_volume), ij(of_volume), ij.F) *
                          (a0 - sums.a1 * r2_of_start(ij));
    const auto v_ij = ij.difference(of_velocity);
    const auto along = foundation::dot(v_ij, ij.x_ij);
    sums.compression += own_slope(ij) * along;
    if constexpr (symmetric) {
      const auto parallel = (D + 2.0) * friction * along / ij.r2;
      sums.force += (parallel - slope) * ij.x_ij;
      sums.heat -= parallel * along;
    } else {
      sums.force += friction * v_ij;
      sums.force -= slope * ij.x_ij;
      sums.heat -= friction * foundation::dot(v_ij, v_ij);
    }
  }
  void end(const auto& i, const auto& sums) const {
    for (std::size_t k = 0; k < D; ++k) i.set(force[k], sums.force[k], D - 1);
    i.set(compression, sums.compression, -D - 1);
    i.set(heat, 0.5 * sums.heat, D - 1);
  }
};

template <int D>
struct density_rate {
  std::array<const double*, D> v;           // m/s
  const double *V, *p, *rho, *sound_speed;  // m^D, Pa, kg/m3, m/s
  double g, delta_h;                        // m/s2; δ h, m
  double* out;                              // kg/(m3 s)

  template <class R>
  struct me {
    R divergence, diffusion;
    R g;
  };
  auto reads() const {
    using namespace pairs;
    return std::tuple{read(of_velocity, v), read(of_volume, V, D), read(of_pressure, p), read(of_density, rho)};
  }
  template <class R>
  me<R> begin(const pairs::cluster<R>& i) const {
    return {R(0.0), R(0.0), R(g * i.lengths.to(1))};
  }
  void add(auto& a, const auto& ij) const {
    using namespace pairs;
    const auto VF = ij(of_volume) * ij.F;
    a.divergence += VF * ij.along(of_velocity);
    a.diffusion += VF * (2.0 * ij.difference(of_pressure) + a.g * (ij.own(of_density) + ij(of_density)) * ij.x_ij[1]);
  }
  void end(const auto& i, const auto& a) const {
    const double diffusivity = delta_h * i.lengths.to(-1);
    i.set(out, i(rho) * a.divergence + diffusivity / i(sound_speed) * a.diffusion, -1);
  }
};

}  // namespace tetsuame::two_fluids
