// Viscous force and dissipation [S2]:
//   m_i Dv_i/Dt ⊃ Σ_j [4 η_i η_j/(η_i + η_j)] ΔV_i ΔV_j (x_ij·∇_i W_ij/|x_ij|²) v_ij
//   Φ_i         = -½ Σ_j [the same factor] v_ij²        (W, goes into heat)
// x·∇W/|x|² is the pair's F. What a pair loses in motion, its two halves gain in heat.
#pragma once

#include <pairs/pairs.hpp>

namespace tetsuame::diffusion {

// 4 a b/(a + b): zero where both vanish.
template <class R>
R harmonic(const R& a, const R& b) {
  const R sum = a + b;
  return foundation::select(sum == 0.0, R(0.0), R(4.0 * a * b / sum));
}

// a ΔV_i ΔV_j F. In single numbers the two volumes come first, so that both ends of a pair round the product alike.
template <class R>
R of_both_ends(const R& a, const R& dV_i, const R& dV_j, const R& F) {
  if constexpr (std::is_same_v<R, pairs::single>)
    return (dV_i * dV_j) * (a * F);
  else
    return a * dV_i * (dV_j * F);
}

// Eta: an array, or the one value of all particles, 4 η η/(η + η) = 2 η: without a division a pair. Of N components of
// the velocity; with the dissipation, which needs all of them, or without. one_sided: nobody compares it with the sum
// of the pair's other end, so that ΔV_i, and 2 η too, are factors of the whole sum: a multiplication a pair less.
template <int D, class Eta, std::size_t N = D, bool heats = true, bool one_sided = false>
struct viscous_sum {
  static constexpr bool uniform = std::is_same_v<Eta, double>;
  static_assert(N == D || !heats);
  static_assert(!one_sided || !heats);
  // In single numbers 2 η is a factor of the whole sum in any case: see of_both_ends.
  template <class R>
  static constexpr bool eta_at_end = uniform && (one_sided || std::is_same_v<R, pairs::single>);

  std::array<const double*, N> v;  // m/s
  Eta eta;                         // Pa s
  const double* dV;                // m^D
  std::array<double*, N> force;    // N, added to
  double* heat = nullptr;          // W, added to; null: not wanted

  template <class R>
  struct me {
    R factor;  // 2 η ΔV where η is uniform; ΔV if 2 η comes at the end; not used where both do
    pairs::vec<R, static_cast<int>(N)> force;
    R dissipation;
  };

  auto reads() const {
    using namespace pairs;
    const std::tuple always{read(of_velocity, v), read(of_volume, dV, D)};
    if constexpr (uniform)
      return always;
    else
      return std::tuple_cat(always, std::tuple{read(of_viscosity, eta, 1)});
  }
  template <class R>
  me<R> begin(const pairs::cluster<R>& i) const {
    me<R> a{R(0.0), foundation::zero<R, static_cast<int>(N)>(), R(0.0)};
    if constexpr (one_sided)
      return a;
    else if constexpr (eta_at_end<R>)
      a.factor = i(dV, D);
    else if constexpr (uniform)
      a.factor = 2.0 * eta * i(dV, D);
    return a;
  }
  void add(auto& a, const auto& ij) const {
    using namespace pairs;
    using R = std::remove_cvref_t<decltype(ij.F)>;
    R factor;
    if constexpr (one_sided && uniform)
      factor = ij(of_volume) * ij.F;
    else if constexpr (one_sided)
      factor = harmonic(ij.own(of_viscosity), ij(of_viscosity)) * (ij(of_volume) * ij.F);
    else if constexpr (eta_at_end<R>)
      factor = a.factor * ij(of_volume) * ij.F;
    else if constexpr (uniform)
      factor = a.factor * (ij(of_volume) * ij.F);
    else
      factor = of_both_ends(harmonic(ij.own(of_viscosity), ij(of_viscosity)), ij.own(of_volume), ij(of_volume), ij.F);
    const auto v_ij = ij.difference(of_velocity);
    a.force += factor * v_ij;
    if constexpr (heats) a.dissipation -= factor * foundation::dot(v_ij, v_ij);
  }
  void end(const auto& i, const auto& a) const {
    const auto factor = factor_of(i);
    for (std::size_t k = 0; k < N; ++k) i.add(force[k], factor * a.force[k], D - 1);
    if constexpr (heats)
      if (heat != nullptr) i.add(heat, 0.5 * factor * a.dissipation, D - 1);
  }

 private:
  template <class R>
  auto factor_of(const pairs::cluster<R>& i) const {
    double of_viscosity = 1.0;
    if constexpr (eta_at_end<R>) of_viscosity = 2.0 * eta * i.lengths.to(-1);
    if constexpr (one_sided)
      return R(of_viscosity * i(dV, D));
    else
      return of_viscosity;
  }
};

// The divergence of η [∇v + (∇v)ᵀ + (∇·v) 1], for viscosities that differ: with ∇·(η∇v) in its place a force across a
// contact is missing, and angular momentum is not conserved [J. J. Monaghan, Rep. Prog. Phys. 68, 1703 (2005),
// sect. 3.2]:
//   m_i Dv_i/Dt ⊃ Σ_j [4 η_i η_j/(η_i + η_j)] ΔV_i ΔV_j F_ij (d + 2) (v_ij·x_ij) x_ij/|x_ij|²
//   Φ_i         = -½ Σ_j [the same factor] (d + 2) (v_ij·x_ij)²/|x_ij|²
// Eta as above.
template <int D, class Eta>
struct symmetric_viscous_sum {
  static constexpr bool uniform = std::is_same_v<Eta, double>;

  std::array<const double*, D> v;  // m/s
  Eta eta;                         // Pa s
  const double* dV;                // m^D
  std::array<double*, D> force;    // N, added to
  double* heat;                    // W, added to

  template <class R>
  struct me {
    pairs::vec<R, D> force;
    R dissipation;
  };
  auto reads() const {
    using namespace pairs;
    const std::tuple always{read(of_velocity, v), read(of_volume, dV, D)};
    if constexpr (uniform)
      return always;
    else
      return std::tuple_cat(always, std::tuple{read(of_viscosity, eta, 1)});
  }
  template <class R>
  me<R> begin(const pairs::cluster<R>&) const {
    return {foundation::zero<R, D>(), R(0.0)};
  }
  void add(auto& a, const auto& ij) const {
    using namespace pairs;
    using R = std::remove_cvref_t<decltype(ij.F)>;
    const auto along = ij.along(of_velocity);
    R factor(1.0);
    if constexpr (!uniform) factor = harmonic(ij.own(of_viscosity), ij(of_viscosity));
    const auto parallel = (D + 2.0) * of_both_ends(factor, ij.own(of_volume), ij(of_volume), ij.F) * along / ij.r2;
    a.force += parallel * ij.x_ij;
    a.dissipation -= parallel * along;
  }
  void end(const auto& i, const auto& a) const {
    if constexpr (uniform) {
      const double of_viscosity = 2.0 * eta * i.lengths.to(-1);
      for (std::size_t k = 0; k < D; ++k) i.add(force[k], of_viscosity * a.force[k], D - 1);
      i.add(heat, 0.5 * of_viscosity * a.dissipation, D - 1);
    } else {
      for (std::size_t k = 0; k < D; ++k) i.add(force[k], a.force[k], D - 1);
      i.add(heat, 0.5 * a.dissipation, D - 1);
    }
  }
};

template <int D>
using viscosity = viscous_sum<D, const double*>;
template <int D>
using uniform_viscosity = viscous_sum<D, double>;
template <int D>
using symmetric_viscosity = symmetric_viscous_sum<D, const double*>;

}  // namespace tetsuame::diffusion
