// Sums over neighbours of two fluids with walls that are mirror images.
//
// Pressure and viscosity, one pass:
//   m_i dv_i/dt = -Σ_j (A_i B_j + B_i A_j) ∇_i W_ij
//                 + Σ_j [4 η_i η_j/(η_i + η_j)] ΔV_i ΔV_j F_ij [a v_ij + b (v_ij·x_ij) x_ij/|x_ij|²]
//   pattern 1 [S0, S2]: A = p ΔV² = Y²/p, B = 1;   pattern 2: A = p ΔV = Y, B = ΔV
//   F_ij = F (a0 - a1 |x_ij|²): a0 = 1, a1 = 0 is the notes' sum, which smooths like the kernel, by a part of order
//   (kS)²; lattice.hpp has weights that do so by (kS)⁴ only
//   a = 1, b = 0: ∇·(η ∇v) [S2];   a = 0, b = d + 2: the divergence of η [∇v + (∇v)ᵀ + (∇·v) 1], which conserves
//   angular momentum and holds where η varies [J. J. Monaghan, Rep. Prog. Phys. 68, 1703 (2005), sect. 3.2]
// and with it D_i = Σ_j B_j v_ij·∇_i W_ij: A_i D_i (W) is what compression takes up; and the heat of friction.
//
// Density by continuity, with diffusion of the dynamic pressure (δ-SPH: after S. Marrone et al., Comput. Methods Appl.
// Mech. Eng. 200, 1526 (2011); across materials, since p is continuous where ρ jumps):
//   dρ_i/dt = ρ_i Σ_j ΔV_j v_ij·∇_i W_ij
//             + δ (h/c_i) Σ_j 2 [(p̂_i - p̂_j) + ½ (ρ_i + ρ_j) g (y_i - y_j)] F_ij ΔV_j
//
// An element dissolved in both materials, c the amount per mass (docs/theory/partition.md#in-a-run):
//   m_i dc_i/dt = Σ_j K_ij ΔV_i ΔV_j F_ij (u_i - u_j),  K_ij = 4 k_i k_j/(k_i + k_j)
//   within a material u = c and k = ρ D; across the contact u = c/P in the metal, and k = ρ D P
#pragma once

#include <diffusion/viscosity.hpp>
#include <pairs/pairs.hpp>
#include <schemes/common.hpp>

namespace tetsuame::two_fluids {

inline constexpr schemes::field<struct stress_tag> of_stress;
inline constexpr schemes::field<struct factor_tag> of_factor;
inline constexpr schemes::field<struct density_tag> of_density;
inline constexpr schemes::field<struct concentration_tag> of_concentration;
inline constexpr schemes::field<struct partition_tag> of_partition;
inline constexpr schemes::field<struct element_tag> of_element;
inline constexpr schemes::field<struct material_tag> of_material;
inline constexpr schemes::field<struct colour_gradient_tag> of_colour_gradient;

// Where either end has a support of its own (supports.hpp): A_i F_i + A_j F_j, F_i, and r² on the scale of the start.
pairs::real slope_of(const auto& ij, const pairs::real& A_i, const pairs::real& A_j) {
  if constexpr (requires { ij.F_i; })
    return A_i * ij.F_i + A_j * ij.F_j;
  else
    return (A_i + A_j) * ij.F;
}
pairs::real own_slope(const auto& ij) {
  if constexpr (requires { ij.F_i; })
    return ij.F_i;
  else
    return ij.F;
}
pairs::real r2_of_start(const auto& ij) {
  if constexpr (requires { ij.r2_of_start; })
    return ij.r2_of_start;
  else
    return ij.r2;
}

template <int D>
struct forces {
  using real = pairs::real;
  std::array<const double*, D> v;  // m/s
  const double *A, *B, *V, *eta;   // above; m^D; Pa s
  double a, b;                     // of the viscous stress
  double a0, a1;                   // 1, 1/m2
  std::array<double*, D> force;    // N
  double *compression, *heat;      // D_i; W

  struct me {
    pairs::vec<real, D> force;
    real compression, heat;
  };
  auto reads() const {
    using namespace pairs;
    return std::tuple{read(of_velocity, v), read(of_stress, A), read(of_factor, B), read(of_volume, V),
                      read(of_viscosity, eta)};
  }
  me begin(const pairs::cluster&) const { return {foundation::zero<real, D>(), real(0.0), real(0.0)}; }
  void add(me& sums, const auto& ij) const {
    using namespace pairs;
    const real B_j = ij(of_factor);
    const real slope = slope_of(ij, ij.own(of_stress) * B_j, ij.own(of_factor) * ij(of_stress));
    const real friction = diffusion::harmonic(ij.own(of_viscosity), ij(of_viscosity)) * ij.own(of_volume) *
                          (ij(of_volume) * ij.F) * (a0 - a1 * r2_of_start(ij));
    const auto v_ij = ij.difference(of_velocity);
    const real along = foundation::dot(v_ij, ij.x_ij);
    const real parallel = b != 0.0 ? real(b * friction * along / foundation::greater(ij.r2, real(1e-200))) : real(0.0);
    sums.force += (a * friction) * v_ij;
    sums.force += (parallel - slope) * ij.x_ij;
    sums.compression += B_j * own_slope(ij) * along;
    sums.heat -= a * friction * foundation::dot(v_ij, v_ij) + parallel * along;
  }
  void end(const pairs::cluster& i, const me& sums) const {
    for (std::size_t k = 0; k < D; ++k) i.set(force[k], sums.force[k]);
    i.set(compression, sums.compression);
    i.set(heat, 0.5 * sums.heat);
  }
};

template <int D>
struct density_rate {
  using real = pairs::real;
  std::array<const double*, D> v;           // m/s
  const double *V, *p, *rho, *sound_speed;  // m^D, Pa, kg/m3, m/s
  double g, delta_h;                        // m/s2; δ h, m
  double* out;                              // kg/(m3 s)

  struct me {
    real divergence, diffusion;
  };
  auto reads() const {
    using namespace pairs;
    return std::tuple{read(of_velocity, v), read(of_volume, V), read(of_pressure, p), read(of_density, rho)};
  }
  me begin(const pairs::cluster&) const { return {real(0.0), real(0.0)}; }
  void add(me& a, const auto& ij) const {
    using namespace pairs;
    const real VF = ij(of_volume) * ij.F;
    a.divergence += VF * ij.along(of_velocity);
    a.diffusion += VF * (2.0 * ij.difference(of_pressure) + g * (ij.own(of_density) + ij(of_density)) * ij.x_ij[1]);
  }
  void end(const pairs::cluster& i, const me& a) const {
    i.set(out, i(rho) * a.divergence + delta_h / i(sound_speed) * a.diffusion);
  }
};

template <int D>
struct element_exchange {
  using real = pairs::real;
  const double *c, *P, *k, *metal, *V;  // 1; 1, 1 in silicate; kg/(m s); 1 or 0; m^D
  double* gain;                         // kg/s

  struct me {
    real sum;
  };
  auto reads() const {
    using namespace pairs;
    return std::tuple{read(of_concentration, c), read(of_partition, P), read(of_element, k), read(of_material, metal),
                      read(of_volume, V)};
  }
  me begin(const pairs::cluster&) const { return {real(0.0)}; }
  void add(me& a, const auto& ij) const {
    using namespace pairs;
    real P_i = ij.own(of_partition), P_j = ij(of_partition);
    const auto same = ij.own(of_material) == ij(of_material);
    stdx::where(same, P_i) = 1.0;
    stdx::where(same, P_j) = 1.0;
    const real K = diffusion::harmonic(ij.own(of_element) * P_i, ij(of_element) * P_j);
    a.sum +=
        K * ij.own(of_volume) * (ij(of_volume) * ij.F) * (ij.own(of_concentration) / P_i - ij(of_concentration) / P_j);
  }
  void end(const pairs::cluster& i, const me& a) const { i.set(gain, a.sum); }
};

// Surface tension between the two materials (docs/theory/drop.md): the divergence of a stress along their contact,
// which the gradient of a colour C (0 in one material, 1 in the other) finds:
//
//   G_i = Σ_j ΔV_j (C_j - C_i) ∇_iW_ij,   Π = σ (|G| 1/d - G G/|G|)
//   m_i dv_i/dt = Σ_j (ΔV_i² Π_i + ΔV_j² Π_j)·∇_iW_ij/s,   s the lattice sum of the number density
//
// [B. Lafaurie et al., J. Comput. Phys. 113, 134 (1994); for particles X. Y. Hu, N. A. Adams, ibid. 213, 844 (2006),
// whose number density and form of the sum these are]. The trace is left to the pressure, so that no particle is pulled
// in all directions.

// G_i, 1/m.
template <int D>
struct colour_gradient {
  using real = pairs::real;
  const double *V, *C;  // m^D; 0 or 1
  std::array<double*, D> G;

  struct me {
    pairs::vec<real, D> sum;
  };
  auto reads() const { return std::tuple{pairs::read(pairs::of_volume, V), pairs::read(of_material, C)}; }
  me begin(const pairs::cluster&) const { return {foundation::zero<real, D>()}; }
  void add(me& a, const auto& ij) const {
    a.sum -= (ij(pairs::of_volume) * ij.difference(of_material) * ij.F) * ij.x_ij;
  }
  void end(const pairs::cluster& i, const me& a) const {
    for (std::size_t k = 0; k < D; ++k) i.set(G[k], a.sum[k]);
  }
};

template <int D>
struct surface_stress {
  using real = pairs::real;
  const double* V2;                // ΔV²/s, m^(2D)
  std::array<const double*, D> G;  // 1/m
  double sigma;                    // N/m
  std::array<double*, D> force;    // N

  struct me {
    pairs::vec<real, D> force;
  };
  auto reads() const {
    using namespace pairs;
    return std::tuple{read(of_stress, V2), read(of_colour_gradient, G)};
  }
  me begin(const pairs::cluster&) const { return {foundation::zero<real, D>()}; }
  void add(me& a, const auto& ij) const {
    a.force += (ij.F * ij.own(of_stress)) * along(ij.own(of_colour_gradient), ij.x_ij);
    a.force += (ij.F * ij(of_stress)) * along(ij(of_colour_gradient), ij.x_ij);
  }
  void end(const pairs::cluster& i, const me& a) const {
    for (std::size_t k = 0; k < D; ++k) i.set(force[k], sigma * a.force[k]);
  }

 private:
  // Π x/σ
  static pairs::vec<real, D> along(const pairs::vec<real, D>& G, const pairs::vec<real, D>& x) {
    const real G2 = foundation::greater(foundation::dot(G, G), real(1e-200));
    const real inverse = foundation::both_roots(G2).inverse;
    return (G2 * inverse * (1.0 / D)) * x - (inverse * foundation::dot(G, x)) * G;
  }
};

}  // namespace tetsuame::two_fluids
