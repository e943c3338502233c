// Gradients that are exact for linear fields on any arrangement of particles, and Laplacians consistent with them, in
// one pass over the neighbours. With r = x_i - x_j, e = r/|r|, F = W'(r)/r, equal volumes V, d dimensions:
//
//   M = -Σ V F r rᵀ                      G(f) = M⁻¹ Σ V F r (f_j - f_i)          [Bonet & Lok, CMAME 180, 97 (1999)]
//   L(f) = (2d/m_s) Σ V F s [(f_i - f_j) - G(f)·r],   m_s = -Σ V F s r²,   s = eᵀB e
//
// B is the unit tensor, or solves -Σ V F r_a r_b (eᵀB e) = δ_ab: then every second moment is right, and not their sum
// only. L is exact for quadratic fields where the neighbourhood is symmetric; elsewhere a part of second order in its
// asymmetry is left, G's error times Σ V F s r, which no resolution takes away. Skewed: B takes it in [after Fatehi &
// Manzari, Comput. Math. Appl. 61, 482 (2011)],
//   -Σ V F s (r_a r_b + N_ab·r) = δ_ab,   N_ab = M⁻¹ Σ V F r r_a r_b,   m_s = -Σ V F s (r² + N_aa·r)
// so that L is exact for quadratic fields on any arrangement.
//
// Deferred correction (docs/theory/convection.md#derivatives), with R = Σ F r⁴/Σ F r² on a lattice: with P(f), the
// plain Laplacian of an earlier evaluation, L(f - β P) and G(f - 2β P), β = R/(4(d + 2)), are of fourth order there.
#pragma once

#include <algorithm>
#include <kernels/kernel.hpp>
#include <operators/symmetric.hpp>
#include <pairs/pairs.hpp>

namespace tetsuame::operators {

struct fields_tag {};
struct corrections_tag {};
inline constexpr fields_tag of_fields;
inline constexpr corrections_tag of_corrections;

// Where the operators of K fields f and of their earlier plain Laplacians P go; arrays of particles, rows are written.
template <int D, int K>
struct results {
  std::array<std::array<double*, D>, K> gradient;  // G(f - 2β P)
  std::array<double*, K> laplacian;                // L(f - β P)
  std::array<double*, K> plain;                    // L(f), the next P
  std::array<double*, symmetric_terms(D)> next_B;  // the next B; null where B is the unit tensor
};

// `whole`: with the next P and B. Who keeps those of the start of a step needs them only there, and saves a third else.
// `wanted`: bit k, L of field k is asked for; the rest of out.laplacian is not written.
template <int D, int K, bool whole = true, unsigned wanted = ~0U, bool skewed = false>
struct consistent {
  static constexpr std::size_t S = symmetric_terms(D), third = skewed ? D * S : 0;

  std::array<const double*, K> f, P;
  std::array<const double*, S> B;  // dimensionless; null: the unit tensor
  double V;                        // m^D
  double beta;                     // m2; 0: no correction
  results<D, K> out;
  bool* singular;  // set where a neighbourhood does not determine a gradient

  template <class R>
  struct me {
    std::array<R, S> B;
    std::array<R, S> M;                             // Σ F r_a r_b
    std::array<std::array<R, S>, whole ? S : 0> Q;  // Σ F r_a r_b e_c e_d, b-th of pair (a b) <= (c d)
    pairs::vec<R, D> first;                         // Σ F s r
    R m_s;                                          // Σ F s r²
    std::array<pairs::vec<R, D>, K> gradient;       // Σ F r (f_i - f_j), of f - 2β P
    std::array<R, K> laplacian;                     // Σ F s (f_i - f_j), of f - β P
    std::array<R, whole ? K : 0> plain;             // of f
    std::array<R, third> T, U;                      // Σ F r_k r_a r_b, Σ F r_k e_a e_b, k behind k
  };

  auto reads() const { return std::tuple{pairs::read(of_fields, f), pairs::read(of_corrections, P, 0, beta)}; }

  template <class R>
  me<R> begin(const pairs::cluster<R>& i) const {
    me<R> a;
    for (std::size_t k = 0; k < S; ++k) {
      a.B[k] = B[k] != nullptr ? i(B[k]) : R(0.0);
      a.M[k] = R(0.0);
      if constexpr (whole)
        for (std::size_t l = k; l < S; ++l) a.Q[k][l] = R(0.0);
    }
    a.first = foundation::zero<R, D>();
    a.m_s = R(0.0);
    for (std::size_t k = 0; k < third; ++k) a.T[k] = a.U[k] = R(0.0);
    for (std::size_t k = 0; k < K; ++k) {
      a.gradient[k] = foundation::zero<R, D>();
      a.laplacian[k] = R(0.0);
      if constexpr (whole) a.plain[k] = R(0.0);
    }
    return a;
  }

  void add(auto& a, const auto& ij) const {
    using R = std::remove_cvref_t<decltype(ij.F)>;
    const auto& r = ij.x_ij;
    const R F = ij.F;
    std::array<R, S> rr;
    std::size_t n = 0;
    for (std::size_t p = 0; p < D; ++p)
      for (std::size_t q = p; q < D; ++q) rr[n++] = r[p] * r[q];
    auto Fs = F;
    if (B[0] != nullptr) {
      R s(0.0);
      n = 0;
      for (std::size_t p = 0; p < D; ++p)
        for (std::size_t q = p; q < D; ++q, ++n) s += (p == q ? 1.0 : 2.0) * a.B[n] * rr[n];
      const auto F_per_r2 = F / ij.r2;
      Fs = s * F_per_r2;
      if constexpr (whole)
        for (std::size_t k = 0; k < S; ++k) {
          const auto part = F_per_r2 * rr[k];
          for (std::size_t l = k; l < S; ++l) a.Q[k][l] += part * rr[l];
        }
    }
    if constexpr (skewed) {
      const auto F_per_r2 = F / ij.r2;
      for (std::size_t p = 0; p < D; ++p)
        for (std::size_t k = 0; k < S; ++k) {
          const auto rrr = r[p] * rr[k];
          a.T[p * S + k] += F * rrr;
          a.U[p * S + k] += F_per_r2 * rrr;
        }
    }
    for (std::size_t k = 0; k < S; ++k) a.M[k] += F * rr[k];
    a.first += Fs * r;
    a.m_s += Fs * ij.r2;
    const auto f_ij = ij.difference(of_fields), correction = ij.difference(of_corrections);
    const auto Fr = F * r;
    for (std::size_t k = 0; k < K; ++k) {
      const auto once = f_ij[k] - correction[k], twice = once - correction[k];
      a.gradient[k] += twice * Fr;
      if ((wanted >> k & 1U) != 0) a.laplacian[k] += Fs * once;
      if constexpr (whole) a.plain[k] += Fs * f_ij[k];
    }
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
    for (std::size_t k = 0; k < S; ++k) {
      all.M[k] = of(a.M[k], -d);
      if constexpr (whole)
        for (std::size_t l = k; l < S; ++l) all.Q[k][l] = of(a.Q[k][l], -d);
    }
    for (std::size_t p = 0; p < D; ++p) all.first[p] = of(a.first[p], -d - 1);
    all.m_s = of(a.m_s, -d);
    for (std::size_t k = 0; k < third; ++k) {
      all.T[k] = of(a.T[k], -d + 1);
      all.U[k] = of(a.U[k], -d - 1);
    }
    for (std::size_t k = 0; k < K; ++k) {
      for (std::size_t p = 0; p < D; ++p) all.gradient[k][p] = of(a.gradient[k][p], -d - 1);
      all.laplacian[k] = of(a.laplacian[k], -d - 2);
      if constexpr (whole) all.plain[k] = of(a.plain[k], -d - 2);
    }
    return all;
  }

  // Compiled once for all kernels and precisions.
  [[gnu::noinline]] void finish(const pairs::cluster<real>& i, const me<real>& a) const {
    constexpr auto d = static_cast<double>(D);
    std::array<std::array<real, D>, D> M;
    for (std::size_t p = 0; p < D; ++p)
      for (std::size_t q = 0; q <= p; ++q) M[p][q] = -V * a.M[symmetric_place(q, p, D)];
    if ((i.mask & ~foundation::bits_of(factorise(M))) != 0) {
#pragma omp atomic write
      *singular = true;
      return;
    }
    const auto first = V * a.first;
    real m_s = -V * a.m_s;
    std::array<std::array<real, D>, skewed ? S : 0> N;
    for (std::size_t k = 0; k < N.size(); ++k) {
      std::array<real, D> T;
      for (std::size_t p = 0; p < D; ++p) T[p] = V * a.T[p * S + k];
      N[k] = solve(M, T);
    }
    if constexpr (skewed)
      for (std::size_t c = 0; c < D; ++c)
        for (std::size_t p = 0; p < D; ++p) m_s -= N[symmetric_place(c, c, D)][p] * first[p];
    const real scale = 2.0 * d / m_s;
    for (std::size_t k = 0; k < K; ++k) {
      const auto G = solve(M, (-V * a.gradient[k]).c);
      real linear = 0.0;
      for (std::size_t p = 0; p < D; ++p) {
        i.set(out.gradient[k][p], G[p]);
        linear += G[p] * first[p];
      }
      if ((wanted >> k & 1U) != 0) i.set(out.laplacian[k], scale * (V * a.laplacian[k] - linear));
      if constexpr (whole) i.set(out.plain[k], scale * (V * a.plain[k] - linear));
    }
    if constexpr (whole)
      if (B[0] != nullptr) {
        if constexpr (skewed)
          next_skewed_tensor(i, a, N);
        else
          next_tensor(i, a);
      }
  }

  // δ_ab, and how often a component stands in the whole tensor.
  struct unit_tensor {
    std::array<real, S> delta;
    std::array<double, S> weight;

    unit_tensor() {
      std::size_t n = 0;
      for (std::size_t p = 0; p < D; ++p)
        for (std::size_t q = p; q < D; ++q, ++n) {
          delta[n] = p == q ? 1.0 : 0.0;
          weight[n] = p == q ? 1.0 : 2.0;
        }
    }
  };

  // -Σ V F r_a r_b (eᵀB e) = δ_ab. Where it cannot be solved the unit tensor stays.
  void next_tensor(const pairs::cluster<real>& i, const me<real>& a) const {
    const auto [b, weight] = unit_tensor();
    std::array<std::array<real, S>, S> A;
    // Rows of off-diagonal components are doubled, which makes the matrix symmetric.
    for (std::size_t k = 0; k < S; ++k)
      for (std::size_t l = 0; l <= k; ++l) A[k][l] = -V * weight[k] * weight[l] * a.Q[l][k];
    const auto solvable = factorise(A);
    const auto solution = solve(A, b);
    for (std::size_t k = 0; k < S; ++k) i.set(out.next_B[k], foundation::select(solvable, solution[k], b[k]));
  }

  // The same with N. Not symmetric; next to the symmetric matrix, so that elimination needs no pivots.
  void next_skewed_tensor(const pairs::cluster<real>& i, const me<real>& a,
                          const std::array<std::array<real, D>, S>& N) const {
    const auto [unit, weight] = unit_tensor();
    std::array<std::array<real, S>, S> A;
    for (std::size_t k = 0; k < S; ++k)
      for (std::size_t l = 0; l < S; ++l) {
        real moment = -V * a.Q[std::min(k, l)][std::max(k, l)];
        for (std::size_t p = 0; p < D; ++p) moment -= N[k][p] * V * a.U[p * S + l];
        A[k][l] = weight[l] * moment;
      }
    auto b = unit;
    const auto solvable = eliminate(A, b);
    for (std::size_t k = 0; k < S; ++k) i.set(out.next_B[k], foundation::select(solvable, b[k], unit[k]));
  }
};

// R/(4(d + 2)) of the kernel on the square (cubic) lattice: β above, m².
template <int D>
double lattice_beta(const kernels::any<D>& kernel, double dx) {
  double second = 0.0, fourth = 0.0;
  std::visit(
      [&](const auto& k) {
        const int reach = static_cast<int>(std::ceil(k.support() / dx));
        std::array<int, D> at;
        at.fill(-reach);
        while (true) {
          double r2 = 0.0;
          for (const int n : at) r2 += n * n * dx * dx;
          const double F = k.gradient_over_r(std::sqrt(r2));
          second += F * r2;
          fourth += F * r2 * r2;
          std::size_t axis = 0;
          while (axis < D && ++at[axis] > reach) at[axis++] = -reach;
          if (axis == D) break;
        }
      },
      kernel);
  return fourth / second / (4.0 * (D + 2));
}

}  // namespace tetsuame::operators
