// Gradients by an integral [D. García-Senz, R. M. Cabezón, J. A. Escartín, Astron. Astrophys. 538, A9 (2012)]:
//   T_i = Σ_j V_j x_ij ⊗ x_ij W_ij(h_i),   C_i = T_i⁻¹,   A_ij(h_i) = -C_i x_ij W_ij(h_i)   in the place of ∇_i
//   W_ij(h_i)
// with V = m/ρ. By their definition Σ_j V_j x_ij ⊗ A_ij = -1 on any arrangement, so that
//   ∇a = -Σ_j V_j (a_i - a_j) A_ij   is exact where a is linear in x,
// and the slope of no kernel is needed. In a pair force A_ij(h_i) and A_ij(h_j) = -C_j x_ij W_ij(h_j) change sign with
// the order of i and j. Where the neighbours lie so that T cannot be inverted, C = D/tr T: the trace alone is exact.
#pragma once

#include <operators/symmetric.hpp>
#include <schemes/common.hpp>

namespace tetsuame::schemes {

template <int D, class Kernel>
struct integral {
  Kernel unit;
  fields<D> g;

  static constexpr std::size_t M = operators::symmetric_terms(D), N = D;
  template <class R>
  struct me {
    R S, per_S;
    std::array<R, M> moments;
  };
  auto reads() const { return g.read(of_volume); }
  template <class R>
  me<R> begin(const pairs::cluster<R>& i) const {
    const R S_i = i(g.a.S.data(), 1);
    me<R> a{S_i, R(1.0 / S_i), {}};
    for (auto& m : a.moments) m = R(0.0);
    return a;
  }
  void add(auto& a, const auto& ij) const {
    const auto weighted = (ij(of_volume) * shape_of(unit, ij, a.S, a.per_S).W) * ij.x_ij;
    foundation::for_each_of<D>([&](std::size_t b) {
      foundation::for_each_of<D>([&](std::size_t c) {
        if (b <= c) a.moments[operators::symmetric_place(b, c, N)] += weighted[b] * ij.x_ij[c];
      });
    });
  }
  void end(const auto& members, const auto& a) const {
    members.each([&](std::size_t i, const auto& of) { end(i, a, of); });
  }

 private:
  void end(std::size_t i, const auto& a, const auto& of) const {
    std::array<std::array<double, N>, N> T;
    double trace = 0.0;
    for (std::size_t b = 0; b < N; ++b) {
      for (std::size_t c = 0; c < N; ++c)
        T[b][c] = of(a.moments[operators::symmetric_place(b, c, N)], D + 2) / power<D>(g.a.S[i]);
      trace += T[b][b];
    }
    // Of a matrix that single numbers have rounded.
    constexpr double singular = 1e-5;
    const bool exists = operators::factorise(T, singular);
    for (std::size_t b = 0; b < N; ++b) {
      std::array<double, N> column{};
      column[b] = 1.0;
      if (exists)
        column = operators::solve(T, column);
      else
        column[b] = trace > 0.0 ? D / trace : 0.0;
      for (std::size_t c = b; c < N; ++c) g.a.integral[operators::symmetric_place(b, c, N)][i] = column[c];
    }
  }
};

// A of one end, by its C and W(h): opposite to the bit for who sees -x.
template <int D, class R>
vec<R, D> integral_gradient(const auto& C, const vec<R, D>& x, const R& W) {
  vec<R, D> A;
  foundation::for_each_of<D>([&](std::size_t b) {
    R sum(0.0);
    foundation::for_each_of<D>(
        [&](std::size_t c) { sum += rounded(R(C[operators::symmetric_place(b, c, D)] * x[c])); });
    A[b] = -rounded(R(sum * W));
  });
  return A;
}

}  // namespace tetsuame::schemes
