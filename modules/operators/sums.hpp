// The plain sums of smoothed particle hydrodynamics, without corrections, for comparison with consistent.hpp:
//
//   G(f) = Σ V F r (f_j - f_i),   L(f) = 2 Σ V F (f_i - f_j),   G(p) = Σ V F r (p_i + p_j) of the last field
//
// The last form conserves momentum; none is exact for a linear field off a lattice.
#pragma once

#include <operators/consistent.hpp>

namespace tetsuame::operators {

template <int D, int K>
struct sums {
  using real = pairs::real;
  std::array<const double*, K> f;
  double V;  // m^D
  results<D, K> out;

  struct me {
    std::array<pairs::vec<real, D>, K> gradient;
    std::array<real, K> laplacian;
  };
  auto reads() const { return std::tuple{pairs::read(of_fields, f)}; }
  me begin(std::size_t) const {
    me a;
    for (auto& g : a.gradient) g = foundation::zero<real, D>();
    a.laplacian.fill(real(0.0));
    return a;
  }
  void add(me& a, const auto& ij) const {
    const auto d = ij.difference(of_fields);
    for (std::size_t k = 0; k < K; ++k) {
      const real part = k + 1 < K ? real(-d[k]) : real(ij.own(of_fields)[k] + ij(of_fields)[k]);
      a.gradient[k] += (ij.F * part) * ij.x_ij;
      a.laplacian[k] += ij.F * d[k];
    }
  }
  void end(std::size_t i, const me& a) const {
    for (std::size_t k = 0; k < K; ++k) {
      for (std::size_t p = 0; p < D; ++p) out.gradient[k][p][i] = V * pairs::sum(a.gradient[k][p]);
      out.laplacian[k][i] = 2.0 * V * pairs::sum(a.laplacian[k]);
    }
  }
};

}  // namespace tetsuame::operators
