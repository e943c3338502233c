// Gradients that are exact for linear fields on any arrangement of particles, and Laplacians consistent with them, in
// one pass over the neighbours. With r = x_i - x_j, e = r/|r|, F = W'(r)/r, equal volumes V, d dimensions:
//
//   M = -Σ V F r rᵀ                      G(f) = M⁻¹ Σ V F r (f_j - f_i)          [Bonet & Lok, CMAME 180, 97 (1999)]
//   L(f) = (2d/m_s) Σ V F s [(f_i - f_j) - G(f)·r],   m_s = -Σ V F s r²,   s = eᵀB e
//
// B is the unit tensor, or solves -Σ V F r_a r_b (eᵀB e) = δ_ab: then every second moment is right, and not their sum
// only. L is exact for quadratic fields where the neighbourhood is symmetric; elsewhere a part of second order in its
// asymmetry is left, G's error times Σ V F s r [after Fatehi & Manzari, Comput. Math. Appl. 61, 482 (2011), who take it
// into B].
//
// Deferred correction (docs/theory/convection.md#derivatives), with R = Σ F r⁴/Σ F r² on a lattice: with P(f), the
// plain Laplacian of an earlier evaluation, L(f - β P) and G(f - 2β P), β = R/(4(d + 2)), are of fourth order there.
#pragma once

#include <kernels/kernel.hpp>
#include <operators/symmetric.hpp>
#include <pairs/pairs.hpp>

namespace tetsuame::operators {

struct fields_tag {};
struct laplacians_tag {};
inline constexpr fields_tag of_fields;
inline constexpr laplacians_tag of_laplacians;

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
template <int D, int K, bool whole = true, unsigned wanted = ~0U>
struct consistent {
  static constexpr std::size_t S = symmetric_terms(D);

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
    R beta;                                         // m2
    std::array<pairs::vec<R, D>, K> gradient;       // Σ F r (f_i - f_j), of f - 2β P
    std::array<R, K> laplacian;                     // Σ F s (f_i - f_j), of f - β P
    std::array<R, whole ? K : 0> plain;             // of f
  };

  auto reads() const { return std::tuple{pairs::read(of_fields, f), pairs::read(of_laplacians, P, -2)}; }

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
    a.beta = R(beta * i.lengths.to(-2));
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
      const R inverse_r2 = 1.0 / ij.r2;
      R s(0.0);
      n = 0;
      for (std::size_t p = 0; p < D; ++p)
        for (std::size_t q = p; q < D; ++q, ++n) s += (p == q ? 1.0 : 2.0) * a.B[n] * rr[n];
      const auto F_per_r2 = F * inverse_r2;
      Fs = s * F_per_r2;
      if constexpr (whole)
        for (std::size_t k = 0; k < S; ++k) {
          const auto part = F_per_r2 * rr[k];
          for (std::size_t l = k; l < S; ++l) a.Q[k][l] += part * rr[l];
        }
    }
    for (std::size_t k = 0; k < S; ++k) a.M[k] += F * rr[k];
    a.first += Fs * r;
    a.m_s += Fs * ij.r2;
    const auto f_ij = ij.difference(of_fields), P_ij = ij.difference(of_laplacians);
    for (std::size_t k = 0; k < K; ++k) {
      const auto f_k = f_ij[k], correction = a.beta * P_ij[k], once = f_k - correction;
      a.gradient[k] += (F * (once - correction)) * r;
      if ((wanted >> k & 1U) != 0) a.laplacian[k] += Fs * once;
      if constexpr (whole) a.plain[k] += Fs * f_k;
    }
  }

  void end(const auto& members, const auto& a) const {
    members.each([&](std::size_t i, const auto& of) { end(i, a, of); });
  }

 private:
  // Of particle i, whose lane of a sum `of` takes.
  void end(std::size_t i, const auto& a, const auto& of) const {
    constexpr auto d = static_cast<double>(D);
    std::array<std::array<double, D>, D> M{};
    for (std::size_t p = 0; p < D; ++p)
      for (std::size_t q = 0; q <= p; ++q) M[p][q] = -V * of(a.M[symmetric_place(q, p, D)], -D);
    if (!factorise(M)) {
#pragma omp atomic write
      *singular = true;
      return;
    }
    std::array<double, D> first;
    for (std::size_t p = 0; p < D; ++p) first[p] = V * of(a.first[p], -D - 1);
    const double scale = -2.0 * d / (V * of(a.m_s, -D));
    for (std::size_t k = 0; k < K; ++k) {
      std::array<double, D> b;
      for (std::size_t p = 0; p < D; ++p) b[p] = -V * of(a.gradient[k][p], -D - 1);
      const auto G = solve(M, b);
      double linear = 0.0;
      for (std::size_t p = 0; p < D; ++p) {
        out.gradient[k][p][i] = G[p];
        linear += G[p] * first[p];
      }
      if ((wanted >> k & 1U) != 0) out.laplacian[k][i] = scale * (V * of(a.laplacian[k], -D - 2) - linear);
      if constexpr (whole) out.plain[k][i] = scale * (V * of(a.plain[k], -D - 2) - linear);
    }
    if constexpr (whole)
      if (B[0] != nullptr) next_tensor(i, a, of);
  }

  // -Σ V F r_a r_b (eᵀB e) = δ_ab. Where it cannot be solved the unit tensor stays.
  void next_tensor(std::size_t i, const auto& a, const auto& of) const {
    std::array<std::array<double, S>, S> A{};
    std::array<double, S> b{}, weight{};
    std::size_t n = 0;
    for (std::size_t p = 0; p < D; ++p)
      for (std::size_t q = p; q < D; ++q, ++n) {
        b[n] = p == q ? 1.0 : 0.0;
        weight[n] = p == q ? 1.0 : 2.0;
      }
    // Rows of off-diagonal components are doubled, which makes the matrix symmetric.
    for (std::size_t k = 0; k < S; ++k)
      for (std::size_t l = 0; l <= k; ++l) A[k][l] = -V * weight[k] * weight[l] * of(a.Q[l][k], -D);
    const bool solvable = factorise(A);
    const auto solution = solvable ? solve(A, b) : b;
    for (std::size_t k = 0; k < S; ++k) out.next_B[k][i] = solution[k];
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
