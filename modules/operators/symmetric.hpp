// Small symmetric systems of one particle, or of several in lanes: gradients are solved with the moments of a
// neighbourhood.
#pragma once

#include <cmath>
#include <cstddef>
#include <foundation/lanes.hpp>
#include <tuple>
#include <type_traits>

namespace tetsuame::operators {

// Number of components of a symmetric tensor, in the order xx, xy, …, yy, …
constexpr std::size_t symmetric_terms(int D) { return static_cast<std::size_t>(D * (D + 1) / 2); }
constexpr std::size_t symmetric_place(std::size_t a, std::size_t b, std::size_t D) {
  return a <= b ? a * D - a * (a + 1) / 2 + b : symmetric_place(b, a, D);
}

// A = L Lᵀ of a symmetric matrix (rows beyond the diagonal are not looked at), in place; false where it is not
// positive definite to the accuracy of its numbers, a share of the diagonal. Of lanes a mask, one matrix a lane.
template <class Matrix>
auto factorise(Matrix& A, double singular = 1e-10) {
  using std::sqrt;
  using number = typename Matrix::value_type::value_type;
  constexpr std::size_t N = std::tuple_size_v<Matrix>;
  decltype(A[0][0] > A[0][0]) definite(true);
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      for (std::size_t l = 0; l < k; ++l) A[i][k] -= A[i][l] * A[k][l];
      A[i][k] /= A[k][k];
    }
    const number diagonal = A[i][i];
    for (std::size_t l = 0; l < i; ++l) A[i][i] -= A[i][l] * A[i][l];
    definite = definite && A[i][i] > singular * diagonal;
    if constexpr (std::is_same_v<number, double>)
      if (!definite) return false;
    A[i][i] = sqrt(A[i][i]);
  }
  return definite;
}

// b becomes A⁻¹ b, by elimination without pivots: for matrices near a positive definite one. False where a pivot has
// lost its sign or all but a share of its size. Of lanes a mask.
template <class Matrix>
auto eliminate(Matrix& A, typename Matrix::value_type& b, double singular = 1e-10) {
  constexpr std::size_t N = std::tuple_size_v<Matrix>;
  decltype(A[0][0] > A[0][0]) regular(true);
  for (std::size_t k = 0; k < N; ++k)
    for (std::size_t i = k + 1; i < N; ++i) {
      const auto diagonal = A[i][i];
      const auto part = A[i][k] / A[k][k];
      for (std::size_t l = k; l < N; ++l) A[i][l] -= part * A[k][l];
      b[i] -= part * b[k];
      regular = regular && A[i][i] > singular * diagonal;
    }
  for (std::size_t k = N; k-- > 0;) {
    for (std::size_t l = k + 1; l < N; ++l) b[k] -= A[k][l] * b[l];
    b[k] /= A[k][k];
  }
  return regular && A[0][0] > A[0][0] * singular;
}

// c with L Lᵀ c = b, from factorise().
template <class Matrix>
typename Matrix::value_type solve(const Matrix& L, typename Matrix::value_type b) {
  const std::size_t N = b.size();
  for (std::size_t k = 0; k < N; ++k) {
    for (std::size_t l = 0; l < k; ++l) b[k] -= L[k][l] * b[l];
    b[k] /= L[k][k];
  }
  for (std::size_t k = N; k-- > 0;) {
    for (std::size_t i = k + 1; i < N; ++i) b[k] -= L[i][k] * b[i];
    b[k] /= L[k][k];
  }
  return b;
}

}  // namespace tetsuame::operators
