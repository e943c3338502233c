// Viscous force where the viscosity varies, by forces along the lines between particles that take energy whatever the
// contrast; why so: docs/theory/convection_viscosity.md. The divergence of ν (∇v + ∇vᵀ + ∇·v) over ν_i is
//   A_i = (d + 2) (2d/m) V [Σ F s_ij (ν_ij/ν_i) (e·v_ij) e - G(v):Σ F s_ij e e r],  m = -V Σ F s_ij r²
// [Español & Revenga, Phys. Rev. E 67, 026705 (2003)]. The second sum, zero on a lattice, makes linear velocities
// exact. s_ij = 1, or isotropic, in 2-D: s_ij = 1 + ½ (a_i + a_j)·n(e), n = (cos 2φ, sin 2φ, cos 4φ, sin 4φ) of the
// line's angle φ, with a such that Σ F r² s_ij n(e) = 0; |a| is kept so small that s > 0.
//
// Where the stress τ is smooth the sum is ∇·τ + β ∇²(∇·τ), β = R/(4(d + 4)), of flows without divergence. With
// isotropic forces the deferred correction is A - β ∇²(ν A)/ν, of an earlier A; with s = 1 there is none. ∇ln ν as the
// lines see it, for walls: (2d/Σ F r²) Σ F (ν_ij/ν_i - 1) r.
#pragma once

#include <operators/consistent.hpp>

namespace tetsuame::convection {

// ν_ij/ν_i, of ν^½ of i and of j: 6/ν_ij = 1/ν_i + 4/(ν_i ν_j)^½ + 1/ν_j. Below 6.
template <class real>
inline real line_viscosity(const real& mine, const real& other) {
  const real nu_j = other * other;
  return 6.0 * nu_j / (mine * mine + 4.0 * mine * other + nu_j);
}

struct viscosity_root_tag {};
inline constexpr viscosity_root_tag of_viscosity_root;

struct forces_tag {};
inline constexpr forces_tag of_forces;

struct angles_tag {};
inline constexpr angles_tag of_angles;

inline constexpr std::size_t angular_terms = 4;  // numbers of a

template <int D>
struct graded_viscosity {
  static constexpr bool isotropic = D == 2;
  static constexpr std::size_t S = operators::symmetric_terms(D), N = isotropic ? angular_terms : 0;

  const double* root;                              // ν^½
  std::array<std::array<double*, D>, D> gradient;  // G(v) of this very sum: stands before it in the list of terms
  std::array<double*, D> out;                      // 1/(m s)
  std::array<double*, D> slope;                    // ∇ln ν as the lines see it, 1/m
  // Isotropic only: R/(4(d + 4)), m2; ν A of an earlier evaluation, m/s2; A, 1/(m s); a, and the next.
  double beta = 0.0;
  std::array<const double*, D> force = {};
  std::array<double*, D> plain = {};
  std::array<const double*, N> angular = {};
  std::array<double*, N> next_angular = {};

  template <class R>
  struct me {
    pairs::vec<R, D> sum, force, slope;
    std::array<pairs::vec<R, D>, S> third;  // Σ F s e e r
    R m, second;                            // Σ F s r², Σ F r²
    std::array<R, N> b;                     // Σ F r² (1 + ½ a_j·n) n
    std::array<R, N*(N + 1) / 2> M;         // Σ F r² n n
  };
  auto reads() const {
    const auto of_root = pairs::read(of_viscosity_root, root);
    if constexpr (isotropic)
      return std::tuple{of_root, pairs::read(of_forces, force), pairs::read(of_angles, angular)};
    else
      return std::tuple{of_root};
  }
  template <class R>
  me<R> begin(const pairs::cluster<R>&) const {
    me<R> a;
    a.sum = a.force = a.slope = foundation::zero<R, D>();
    for (auto& t : a.third) t = foundation::zero<R, D>();
    a.m = a.second = R(0.0);
    a.b.fill(R(0.0));
    a.M.fill(R(0.0));
    return a;
  }
  void add(auto& a, const auto& ij) const {
    using R = std::remove_cvref_t<decltype(ij.F)>;
    const auto& r = ij.x_ij;
    const auto v = ij.difference(operators::of_fields);
    const R per_r2 = 1.0 / ij.r2, F_r2 = ij.F * ij.r2;
    R s(1.0);
    if constexpr (isotropic) {
      const auto c2 = (r[0] * r[0] - r[1] * r[1]) * per_r2, s2 = 2.0 * r[0] * r[1] * per_r2;
      const std::array<R, N> n{c2, s2, c2 * c2 - s2 * s2, 2.0 * c2 * s2};
      const auto mine = ij.own(of_angles), other = ij(of_angles);
      R half(0.0), halves(0.0);
      for (std::size_t k = 0; k < N; ++k) {
        half += 0.5 * other[k] * n[k];
        halves += 0.5 * (mine[k] + other[k]) * n[k];
      }
      s += halves;
      const auto of_other = F_r2 * (1.0 + half);
      for (std::size_t k = 0, place = 0; k < N; ++k) {
        a.b[k] += of_other * n[k];
        for (std::size_t l = 0; l <= k; ++l) a.M[place++] += F_r2 * n[k] * n[l];
      }
    }
    if constexpr (isotropic) a.force += ij.F * ij.difference(of_forces);
    a.second += F_r2;
    const auto part = ij.F * per_r2 * s;
    R along(0.0);
    for (std::size_t b = 0; b < D; ++b) along += v[b] * r[b];
    const auto nu = line_viscosity(ij.own(of_viscosity_root), ij(of_viscosity_root));
    a.sum += (part * along * nu) * r;
    a.slope += (ij.F * (nu - 1.0)) * r;
    std::size_t n = 0;
    for (std::size_t p = 0; p < D; ++p)
      for (std::size_t q = p; q < D; ++q) a.third[n++] += (part * r[p] * r[q]) * r;
    a.m += F_r2 * s;
  }
  void end(const auto& members, const auto& a) const {
    members.with_doubles([&](const pairs::cluster<pairs::real>& i, const auto& of) { finish(i, in_metres(a, of)); });
  }

 private:
  using real = pairs::real;

  // The sums of those members whose lanes `of` takes.
  static me<real> in_metres(const auto& a, const auto& of) {
    constexpr auto d = static_cast<int>(D);
    me<real> all;
    for (std::size_t p = 0; p < D; ++p) {
      all.sum[p] = of(a.sum[p], -d - 2);
      all.force[p] = of(a.force[p], -d - 2);
      all.slope[p] = of(a.slope[p], -d - 1);
      for (std::size_t k = 0; k < S; ++k) all.third[k][p] = of(a.third[k][p], -d - 1);
    }
    all.m = of(a.m, -d);
    all.second = of(a.second, -d);
    for (std::size_t k = 0; k < a.b.size(); ++k) all.b[k] = of(a.b[k], -d);
    for (std::size_t k = 0; k < a.M.size(); ++k) all.M[k] = of(a.M[k], -d);
    return all;
  }

  [[gnu::noinline]] void finish(const pairs::cluster<real>& i, const me<real>& a) const {
    constexpr auto d = static_cast<double>(D);
    const real scale = -2.0 * d * (d + 2.0) / a.m, of_laplacian = -2.0 * d / a.second;
    for (std::size_t p = 0; p < D; ++p) {
      real force_i = a.sum[p];
      for (std::size_t q = 0; q < D; ++q)
        for (std::size_t c = 0; c < D; ++c)
          force_i -= i(gradient[q][c]) * a.third[operators::symmetric_place(p, q, D)][c];
      force_i *= scale;
      i.set(slope[p], of_laplacian * a.slope[p]);
      if constexpr (isotropic) {
        const real own_root = i(root);
        i.set(plain[p], force_i);
        force_i -= beta * of_laplacian * a.force[p] / (own_root * own_root);
      }
      i.set(out[p], force_i);
    }
    if constexpr (isotropic) next_angles(i, a);
  }

  // Half the way to the a_i that is right for the neighbours' a_j.
  void next_angles(const pairs::cluster<real>& i, const me<real>& a) const {
    std::array<std::array<real, N>, N> M;
    std::array<real, N> b, next;
    for (std::size_t k = 0, place = 0; k < N; ++k) {
      b[k] = 2.0 * a.b[k];  // F < 0: both sides change their signs
      for (std::size_t l = 0; l <= k; ++l) M[k][l] = -a.M[place++];
    }
    constexpr double most = 0.8;
    const auto solvable = operators::factorise(M);
    const auto wanted = operators::solve(M, b);
    real sum = 0.0;
    for (std::size_t k = 0; k < N; ++k) {
      next[k] = 0.5 * (i(angular[k]) + foundation::select(solvable, wanted[k], real(0.0)));
      sum += abs(next[k]);
    }
    const real part = foundation::select(sum > most, most / sum, real(1.0));
    for (std::size_t k = 0; k < N; ++k) i.set(next_angular[k], next[k] * part);
  }
};

}  // namespace tetsuame::convection
