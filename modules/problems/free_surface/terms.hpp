// Sums over neighbours of weakly compressible water.
//
// Momentum, pressure and viscosity in one pass; momentum is exchanged pair by pair:
//   m_i dv_i/dt = -Σ_j (p_i + p_j) V_i V_j ∇_i W_ij + 2 (D+2) Σ_j η V_i V_j (v_ij·x_ij)/|x_ij|² ∇_i W_ij + m_i g
// with η = viscosity + α h c0 ρ0/(2 (D+2)), the artificial one of J. J. Monaghan [J. Comput. Phys. 110, 399 (1994)]
// without its switch. Only this form of the viscous sum dissipates rightly at a free surface [A. Colagrossi, M.
// Antuono, A. Souto-Iglesias, D. Le Touzé, Phys. Rev. E 84, 026705 (2011)].
//
// Density by continuity, with diffusion of what the pressure has beyond the hydrostatic one [G. Fourtakas et al.,
// Comput. Fluids 190, 346 (2019)], so that still water stays:
//   dρ_i/dt = ρ_i Σ_j V_j v_ij·∇_i W_ij + δ (h/c0) Σ_j 2 l_ij [p_i - p_j + ½ (ρ_i + ρ_j) g (y_i - y_j)] V_j F_ij
// with l_ij = min[1, ½ (v_i² + v_j²)/(0.01 c0)²] (derived here): water at rest diffuses nothing.
//
// The arrangement of particles [S. Marrone et al., J. Comput. Phys. 229, 3652 (2010)]: λ is the smallest eigenvalue of
//   M_i = -Σ_j V_j F_ij x_ij x_ijᵀ
// 1 inside, about a half at a plane surface, 0 for a particle by itself.
#pragma once

#include <array>
#include <cmath>
#include <free_surface/eigenvalue.hpp>
#include <free_surface/options.hpp>
#include <pairs/pairs.hpp>
#include <schemes/common.hpp>

namespace tetsuame::free_surface {

using pairs::real;

inline constexpr schemes::field<struct density_tag> of_density;
inline constexpr schemes::field<struct eigenvalue_tag> of_eigenvalue;
inline constexpr struct viscous_velocity_tag : pairs::velocity_tag {
} of_viscous_velocity;

// What sums over pairs of water go by, whatever the scheme, and where they leave it. two_velocities: what stands behind
// walls has another velocity in the viscous sum than in continuity, as that of walls of no slip, to which what moves
// along them is no compression, and of all bodies in the default scheme.
template <int D, bool two_velocities>
struct sums_of_water {
  using kernels = kernels_of_water<D>;
  std::array<const double*, D> v, v_viscous;  // m/s
  const double *p, *V, *rho;                  // Pa, m^D, kg/m3
  double eta, g;                              // Pa s, m/s2
  std::array<double*, D> force;               // N, without gravity
  double* rho_rate;                           // kg/(m3 s)

  auto reads() const {
    using namespace pairs;
    const auto of_all =
        std::tuple{read(of_velocity, v), read(of_pressure, p), read(of_volume, V, D), read(of_density, rho)};
    if constexpr (two_velocities)
      return std::tuple_cat(of_all, std::tuple{read(of_viscous_velocity, v_viscous)});
    else
      return of_all;
  }
};

// Of the default scheme.
template <int D, bool two_velocities>
struct motion : sums_of_water<D, two_velocities> {
  double delta_h_per_c;  // δ h/c0, s
  double slow_speed;     // m/s

  template <class R>
  struct me {
    pairs::vec<R, D> force;
    R divergence, diffusion;
    R viscous, g, per_slow2;  // 2 (D+2) η, g, ½/(slow speed)²: the same for all
  };
  template <class R>
  me<R> begin(const pairs::cluster<R>& i) const {
    return {foundation::zero<R, D>(),
            R(0.0),
            R(0.0),
            R(2.0 * (D + 2.0) * this->eta * i.lengths.to(-1)),
            R(this->g * i.lengths.to(1)),
            R(0.5 / (slow_speed * slow_speed))};
  }
  void add(auto& a, const auto& ij) const {
    using namespace pairs;
    const auto VF = ij(of_volume) * ij.F;
    const auto closing = ij.along(of_velocity), per_r2 = ij.per_r * ij.per_r;
    auto sheared = closing;
    if constexpr (two_velocities) sheared = ij.along(of_viscous_velocity);
    const auto p_i = ij.own(of_pressure), p_j = ij(of_pressure);
    const auto v_i = ij.own(of_velocity), v_j = ij(of_velocity);
    using R = std::remove_cvref_t<decltype(ij.F)>;
    const R lively =
        foundation::lesser(R(1.0), R(a.per_slow2 * (foundation::dot(v_i, v_i) + foundation::dot(v_j, v_j))));
    a.divergence += VF * closing;
    a.diffusion += lively * VF * (2.0 * (p_i - p_j) + a.g * (ij.own(of_density) + ij(of_density)) * ij.x_ij[1]);
    a.force += (VF * (a.viscous * sheared * per_r2 - (p_i + p_j))) * ij.x_ij;
  }
  void end(const auto& i, const auto& a) const {
    const auto V_i = i(this->V, D);
    for (std::size_t k = 0; k < D; ++k) i.set(this->force[k], V_i * a.force[k], D - 1);
    i.set(this->rho_rate, i(this->rho) * a.divergence + delta_h_per_c * i.lengths.to(-1) * a.diffusion, -1);
  }
};

// Where the surface is near, Σ_j V_j ∇_i W_ij points away from it.
template <int D>
struct inward {
  using kernels = kernels_of_water<D>;
  const double* V;           // m^D
  std::array<double*, D> G;  // 1/m

  template <class R>
  struct me {
    pairs::vec<R, D> G;
  };
  auto reads() const { return std::tuple{pairs::read(pairs::of_volume, V, D)}; }
  template <class R>
  me<R> begin(const pairs::cluster<R>&) const {
    return {foundation::zero<R, D>()};
  }
  void add(auto& a, const auto& ij) const { a.G += (ij(pairs::of_volume) * ij.F) * ij.x_ij; }
  void end(const auto& i, const auto& a) const {
    for (std::size_t k = 0; k < D; ++k) i.set(G[k], a.G[k], -1);
  }
};

// λ, and the sum that shifting goes by [P. N. Sun, A. Colagrossi, S. Marrone, A. M. Zhang, Comput. Methods Appl. Mech.
// Eng. 315, 25 (2017)]:  Σ_j V_j [1 + 0.2 (W_ij/W(Δx))⁴] ∇_i W_ij
template <int D>
struct arrangement {
  using kernels = kernels_of_water<D>;
  const double* V;               // m^D
  double per_W;                  // m^D, 1/W(Δx)
  double* eigenvalue;            // λ
  std::array<double*, D> slope;  // 1/m

  static constexpr std::size_t S = D * (D + 1) / 2;
  template <class R>
  struct me {
    std::array<R, S> M;
    pairs::vec<R, D> slope;
    R per_W;  // the same for all
  };
  auto reads() const { return std::tuple{pairs::read(pairs::of_volume, V, D)}; }
  template <class R>
  me<R> begin(const pairs::cluster<R>& i) const {
    me<R> a{{}, foundation::zero<R, D>(), R(per_W * i.lengths.to(-D))};
    for (auto& m : a.M) m = R(0.0);
    return a;
  }
  void add(auto& a, const auto& ij) const {
    const auto VF = ij(pairs::of_volume) * ij.F, w = ij.W * a.per_W, w2 = w * w;
    std::size_t n = 0;
    for (std::size_t p = 0; p < D; ++p)
      for (std::size_t q = p; q < D; ++q) a.M[n++] -= VF * ij.x_ij[p] * ij.x_ij[q];
    a.slope += (VF * (1.0 + 0.2 * w2 * w2)) * ij.x_ij;
  }
  void end(const auto& i, const auto& a) const {
    for (std::size_t k = 0; k < D; ++k) i.set(slope[k], a.slope[k], -1);
    // Of each member by itself; of a copy, so that the sums themselves can stay in registers.
    std::array<std::array<double, pairs::lanes>, S> M;
    for (std::size_t k = 0; k < S; ++k) i.in_doubles(a.M[k]).copy_to(M[k].data(), pairs::stdx::element_aligned);
    i.each([&](std::size_t n, const auto&) {
      std::array<double, S> mine;
      for (std::size_t k = 0; k < S; ++k) mine[k] = M[k][n - i.first];
      eigenvalue[n] = smallest_eigenvalue(mine);
    });
  }
};

// Outwards is where λ falls: -Σ_j V_j (λ_j - λ_i) ∇_i W_ij; and the smallest λ within the kernel's reach.
template <int D>
struct outward {
  using kernels = kernels_of_water<D>;
  const double *V, *eigenvalue;   // m^D, λ
  std::array<double*, D> normal;  // of length 1, or 0 where there is none
  double* least;

  template <class R>
  struct me {
    pairs::vec<R, D> slope;
    R least;
  };
  auto reads() const { return std::tuple{pairs::read(pairs::of_volume, V, D), pairs::read(of_eigenvalue, eigenvalue)}; }
  template <class R>
  me<R> begin(const pairs::cluster<R>& i) const {
    return {foundation::zero<R, D>(), i(eigenvalue)};
  }
  void add(auto& a, const auto& ij) const {
    const auto lambda = ij(of_eigenvalue);
    a.slope += (ij(pairs::of_volume) * ij.F * ij.difference(of_eigenvalue)) * ij.x_ij;
    a.least = foundation::select(0.0 < ij.W, foundation::lesser(a.least, lambda), a.least);
  }
  static void join(auto& a, const auto& other) {
    a.slope += other.slope;
    a.least = foundation::lesser(a.least, other.least);
  }
  void end(const auto& i, const auto& a) const {
    using R = std::remove_cvref_t<decltype(a.least)>;
    const auto squared = foundation::greater(foundation::dot(a.slope, a.slope), R(foundation::tiny<R>));
    const auto per_length = foundation::both_roots(squared).inverse;
    for (std::size_t k = 0; k < D; ++k) i.set(normal[k], per_length * a.slope[k]);
    i.set(least, a.least);
  }
};

// Whether a neighbour lies in the cone about the outward normal n, with T = x_i + h n: nearer than √2 h within 45° of
// n, or farther within h of T. A particle without such a neighbour is on the surface.
template <int D>
struct cone {
  using kernels = kernels_of_water<D>;
  std::array<const double*, D> normal;
  const double* V;  // m^D
  double h;         // m
  double* covered;  // 1 or 0

  template <class R>
  struct me {
    pairs::vec<R, D> normal;
    R covered;
    R h;  // the same for all
  };
  auto reads() const { return std::tuple{pairs::read(pairs::of_volume, V, D)}; }
  template <class R>
  me<R> begin(const pairs::cluster<R>& i) const {
    return {pairs::vec<R, D>::of([&](std::size_t k) { return i(normal[k]); }), R(0.0), R(h * i.lengths.to(-1))};
  }
  void add(auto& a, const auto& ij) const {
    using R = std::remove_cvref_t<decltype(ij.F)>;
    const R one(1.0), none(0.0);
    const auto ahead = -foundation::dot(a.normal, ij.x_ij);  // m, of the neighbour
    const auto near = foundation::select(std::sqrt(0.5) * ij.r < ahead, one, none);
    const auto beyond = foundation::select(ij.r2 - 2.0 * a.h * ahead < 0.0, one, none);
    const auto inside = foundation::select(ij.r2 < 2.0 * a.h * a.h, near, beyond);
    const auto there = foundation::select(0.0 < ij(pairs::of_volume), inside, none);
    a.covered = foundation::greater(a.covered, there);
  }
  static void join(auto& a, const auto& other) { a.covered = foundation::greater(a.covered, other.covered); }
  void end(const auto& i, const auto& a) const { i.set(covered, a.covered); }
};

}  // namespace tetsuame::free_surface
