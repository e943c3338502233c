// Surface tension between two liquids whose volumes are those of the number density (docs/theory/drop.md): the
// divergence of a stress along their contact, which the gradient of a colour C (0 in one, 1 in the other) finds:
//
//   G_i = Σ_j ΔV_j (C_j - C_i) ∇_iW_ij,   Π = σ (|G| 1/d - G G/|G|)
//   m_i dv_i/dt = Σ_j (ΔV_i² Π_i + ΔV_j² Π_j)·∇_iW_ij/s,   s the lattice sum of the number density
//
// [B. Lafaurie et al., J. Comput. Phys. 113, 134 (1994); for particles X. Y. Hu, N. A. Adams, ibid. 213, 844 (2006),
// whose number density and form of the sum these are]. The trace is left to the pressure, so that no particle is pulled
// in all directions. A problem has it by
//
//   tension::between_liquids<D> tension{world, sigma, colour};  // colour: a field of the problem, set with new lists
//   tension.declare(e);                                         // behind the pass that writes ΔV
//
// and adds tension.force to the forces on its particles. Walls are mirror images, or there are none. What pulls at a
// free surface, where particles are under no pressure, is another force (docs/theory/water_surface_tension.md).
#pragma once

#include <pairs/pairs.hpp>
#include <particles/named_fields.hpp>
#include <passes/evaluation.hpp>

namespace tetsuame::tension {

// The names by which the sums read fields.
template <class Tag>
struct field {};
inline constexpr field<struct colour_tag> of_colour;
inline constexpr field<struct colour_gradient_tag> of_colour_gradient;
inline constexpr field<struct squared_volume_tag> of_squared_volume;

// G_i, 1/m.
template <int D>
struct colour_gradient {
  const double *V, *C;  // m^D; 0 or 1
  std::array<double*, D> G;

  template <class R>
  struct me {
    pairs::vec<R, D> sum;
  };
  auto reads() const { return std::tuple{pairs::read(pairs::of_volume, V, D), pairs::read(of_colour, C)}; }
  template <class R>
  me<R> begin(const pairs::cluster<R>&) const {
    return {foundation::zero<R, D>()};
  }
  void add(auto& a, const auto& ij) const {
    a.sum -= (ij(pairs::of_volume) * ij.difference(of_colour) * ij.F) * ij.x_ij;
  }
  void end(const auto& i, const auto& a) const {
    for (std::size_t k = 0; k < D; ++k) i.set(G[k], a.sum[k], -1);
  }
};

template <int D>
struct surface_stress {
  const double* V2;                // ΔV²/s, m^(2D)
  std::array<const double*, D> G;  // 1/m
  double sigma;                    // N/m
  std::array<double*, D> force;    // N

  template <class R>
  struct me {
    pairs::vec<R, D> force;
  };
  auto reads() const {
    using namespace pairs;
    return std::tuple{read(of_squared_volume, V2, 2 * D), read(of_colour_gradient, G, -1)};
  }
  template <class R>
  me<R> begin(const pairs::cluster<R>&) const {
    return {foundation::zero<R, D>()};
  }
  void add(auto& a, const auto& ij) const {
    a.force += (ij.F * ij.own(of_squared_volume)) * along(ij.own(of_colour_gradient), ij.x_ij);
    a.force += (ij.F * ij(of_squared_volume)) * along(ij(of_colour_gradient), ij.x_ij);
  }
  void end(const auto& i, const auto& a) const {
    for (std::size_t k = 0; k < D; ++k) i.set(force[k], sigma * a.force[k], D - 2);
  }

 private:
  // Π x/σ
  template <class R>
  static pairs::vec<R, D> along(const pairs::vec<R, D>& G, const pairs::vec<R, D>& x) {
    const auto G2 = foundation::greater(foundation::dot(G, G), R(foundation::tiny<R>));
    const auto inverse = foundation::both_roots(G2).inverse;
    return (G2 * inverse * (1.0 / D)) * x - (inverse * foundation::dot(G, x)) * G;
  }
};

template <int D>
class between_liquids {
 private:
  using role = particles::role;

  double sigma_;  // N/m
  pairs::workspace<D>& w_;
  particles::array& colour_;

 public:
  // sigma: N/m; 0: there is none, and no field has values. colour: 0 or 1 of all particles, ghosts and images.
  between_liquids(run::state<D>& of, double sigma, particles::array& colour)
      : sigma_(sigma), w_(of.w), colour_(colour) {}
  between_liquids(const between_liquids&) = delete;  // its fields are the state's
  between_liquids& operator=(const between_liquids&) = delete;

  bool acts() const { return sigma_ > 0.0; }

  particles::array& area = particles::declare_if(acts(), w_.s, "ContactArea", "1/m", role::derived);  // |G|
  particles::vector_field<D> force = particles::declare_vector_if<D>(acts(), w_.s, "TensionForce", "N", role::derived);

  void declare(passes::evaluation<D>& e) {
    if (!acts()) return;
    auto& V = w_.s.dV;
    e.given({colour_});
    e.mirrored(walls::vector(slope_));
    e.sum("surface tension", {.at_neighbours = {V, colour_}, .writes = {slope_}},
          [this](const pairs::row_range& rows) { sum_colour(rows); });
    e.each("surface tension", {.reads = {slope_}, .writes = {area}}, [this](std::size_t i) {
      double G2 = 0.0;
      for (std::size_t a = 0; a < D; ++a) G2 += slope_[a][i] * slope_[a][i];
      area[i] = std::sqrt(G2);
    });
    e.each(
        "surface tension", {.reads = {V}, .writes = {squared_volume_}},
        [this, &V](std::size_t i) { squared_volume_[i] = V[i] * V[i] / w_.lattice_sum; }, true);
    e.sum("surface tension", {.at_neighbours = {squared_volume_, slope_}, .writes = {force}},
          [this](const pairs::row_range& rows) { sum_stress(rows); });
  }

  // The sums, which a problem may compile by themselves.
  void sum_colour(const pairs::row_range& rows) {
    w_.sum(rows, colour_gradient<D>{w_.s.dV.data(), colour_.data(), slope_.data()});
  }
  void sum_stress(const pairs::row_range& rows) {
    w_.sum(rows, surface_stress<D>{squared_volume_.data(), slope_.read(), sigma_, force.data()});
  }

 private:
  particles::array& squared_volume_ =
      particles::declare_if(acts(), w_.s, "SquaredVolume", "m^2D", role::derived);  // ΔV²/s
  particles::vector_field<D> slope_ =
      particles::declare_vector_if<D>(acts(), w_.s, "ColourGradient", "1/m", role::derived);  // G
};

}  // namespace tetsuame::tension
