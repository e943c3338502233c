// Surface tension between the two materials (docs/theory/drop.md): the divergence of a stress along their contact,
// which the gradient of a colour C (0 in one material, 1 in the other) finds:
//
//   G_i = Σ_j ΔV_j (C_j - C_i) ∇_iW_ij,   Π = σ (|G| 1/d - G G/|G|)
//   m_i dv_i/dt = Σ_j (ΔV_i² Π_i + ΔV_j² Π_j)·∇_iW_ij/s,   s the lattice sum of the number density
//
// [B. Lafaurie et al., J. Comput. Phys. 113, 134 (1994); for particles X. Y. Hu, N. A. Adams, ibid. 213, 844 (2006),
// whose number density and form of the sum these are]. The trace is left to the pressure, so that no particle is pulled
// in all directions.
#pragma once

#include <two_fluids/terms.hpp>

namespace tetsuame::two_fluids {

struct colour_gradient_tag {};
inline constexpr colour_gradient_tag of_colour_gradient;

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
  me begin(std::size_t) const { return {foundation::zero<real, D>()}; }
  void add(me& a, const auto& ij) const {
    a.sum -= (ij(pairs::of_volume) * ij.difference(of_material) * ij.F) * ij.x_ij;
  }
  void end(std::size_t i, const me& a) const {
    for (std::size_t k = 0; k < D; ++k) G[k][i] = pairs::sum(a.sum[k]);
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
  me begin(std::size_t) const { return {foundation::zero<real, D>()}; }
  void add(me& a, const auto& ij) const {
    a.force += (ij.F * ij.own(of_stress)) * along(ij.own(of_colour_gradient), ij.x_ij);
    a.force += (ij.F * ij(of_stress)) * along(ij(of_colour_gradient), ij.x_ij);
  }
  void end(std::size_t i, const me& a) const {
    for (std::size_t k = 0; k < D; ++k) force[k][i] = sigma * pairs::sum(a.force[k]);
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
