// Shape functions φ_j of a marker, f(x_m) = Σ_j φ_j f_j over fluid particles only:
//   shepard  φ_j = W_mj / Σ_k W_mk                            exact for constants [S2]
//   mls      φ_j = W_mj P_j·c,  Σ_k W_mk P_k P_kᵀ c = P(0)    P = (1, x, y, z): exact for linear fields
//   mls2     the same with the quadratic terms in P           exact for quadratic fields
// Volumes cancel at the start's equal spacing, so that markers do not need densities before these are known.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <foundation/lanes.hpp>
#include <foundation/vec.hpp>
#include <operators/symmetric.hpp>
#include <span>
#include <string>

namespace tetsuame::walls {

using foundation::lanes, foundation::real, foundation::vec;

// Number of terms of a polynomial of the order in D dimensions.
constexpr std::size_t terms(int order, int D) {
  return order == 0   ? 1
         : order == 1 ? 1 + static_cast<std::size_t>(D)
                      : static_cast<std::size_t>((D + 1) * (D + 2) / 2);
}

inline int polynomial_order(const std::string& interpolation) {
  return interpolation == "shepard" ? 0 : interpolation == "mls" ? 1 : 2;
}

// P to the given order at the offset e (in units of the marker's reach, so that the moments are of order one).
template <int D, int Order = 2, class R>
std::array<R, terms(Order, D)> polynomial(const vec<R, D>& e) {
  std::array<R, terms(Order, D)> P;
  std::size_t n = 0;
  P[n++] = R(1.0);
  if constexpr (Order > 0)
    for (std::size_t a = 0; a < D; ++a) P[n++] = e[a];
  if constexpr (Order > 1)
    for (std::size_t a = 0; a < D; ++a)
      for (std::size_t b = a; b < D; ++b) P[n++] = e[a] * e[b];
  return P;
}

// Neighbours of a marker, one a lane.
template <int D>
struct seen {
  real weight;          // 1/m^D, W_mj; zero in a lane without a particle
  vec<real, D> offset;  // (x_j - x_m)/reach
};

namespace detail {

// A c = (1, 0, …) of the order, or of the next lower one for which the particles suffice; c is zero where none does.
template <int D, int Order, std::size_t N>
void solve_first(const std::array<std::array<double, N>, N>& A, std::array<double, N>& c) {
  constexpr std::size_t n = terms(Order, D);
  std::array<std::array<double, n>, n> L;
  for (std::size_t a = 0; a < n; ++a) std::copy_n(A[a].begin(), a + 1, L[a].begin());
  if (operators::factorise(L)) {
    const auto solution = operators::solve(L, {1.0});
    std::copy(solution.begin(), solution.end(), c.begin());
  } else if constexpr (Order > 0) {
    solve_first<D, Order - 1>(A, c);
  }
}

// Of one order, so that the loops over terms have a fixed length.
template <int D, int Order>
void coefficients_of(std::span<const seen<D>> near, double* out) {
  constexpr std::size_t N = terms(Order, D);
  std::array<std::array<real, N>, N> moments;
  for (std::size_t a = 0; a < N; ++a)
    for (std::size_t b = 0; b <= a; ++b) moments[a][b] = real(0.0);
  for (const auto& j : near) {
    const auto P = polynomial<D, Order>(j.offset);
    for (std::size_t a = 0; a < N; ++a) {
      const real weighted = j.weight * P[a];
      for (std::size_t b = 0; b <= a; ++b) moments[a][b] += weighted * P[b];
    }
  }
  std::array<std::array<double, N>, N> A;
  for (std::size_t a = 0; a < N; ++a)
    for (std::size_t b = 0; b <= a; ++b) A[a][b] = foundation::sum(moments[a][b]);
  std::array<double, N> c{};
  if (A[0][0] > 0.0) solve_first<D, Order>(A, c);
  std::copy(c.begin(), c.end(), out);
}

template <int D, int Order>
[[gnu::always_inline]] inline real shape_function(const seen<D>& j, const double* c) {
  const auto P = polynomial<D, Order>(j.offset);
  real value(c[0]);
  foundation::for_each_of<terms(Order, D) - 1>([&](std::size_t a) { value += P[a + 1] * c[a + 1]; });
  return j.weight * value;
}

template <int D, int Order>
void shape_functions_of(std::span<const seen<D>> near, const double* c, double* phi) {
  for (const auto& j : near) {
    shape_function<D, Order>(j, c).copy_to(phi, std::experimental::element_aligned);
    phi += lanes;
  }
}

}  // namespace detail

// c: out, terms(order, D) numbers. All zero where the marker sees no fluid.
template <int D>
void coefficients(std::span<const seen<D>> near, int order, double* c) {
  if (order == 0) detail::coefficients_of<D, 0>(near, c);
  if (order == 1) detail::coefficients_of<D, 1>(near, c);
  if (order == 2) detail::coefficients_of<D, 2>(near, c);
}

// phi: out, one a lane.
template <int D>
void shape_functions(std::span<const seen<D>> near, int order, const double* c, double* phi) {
  if (order == 0) detail::shape_functions_of<D, 0>(near, c, phi);
  if (order == 1) detail::shape_functions_of<D, 1>(near, c, phi);
  if (order == 2) detail::shape_functions_of<D, 2>(near, c, phi);
}

}  // namespace tetsuame::walls
