// What is summed over neighbours beside the operators: the smoothing Q of fields, and how unevenly particles stand.
#pragma once

#include <convection/graded_viscosity.hpp>
#include <operators/consistent.hpp>

namespace tetsuame::convection {

struct slopes_tag {};
inline constexpr slopes_tag of_slopes;

// Q(f) = Σ V F [2 (f_i - f_j) - (G_i + G_j)·r] [after Antuono et al., Comput. Phys. Commun. 181, 532 (2010)] of the K
// fields of operators::consistent. Graded: Q(p) takes the part min(1, ν_i/ν_j) of a pair. Where ξ² goes with ν, energy
// is p²/ξ²: so it falls, whatever the contrast.
template <int D, int fields, bool graded>
struct noise {
  using real = pairs::real;
  static constexpr std::size_t K = fields;
  std::array<const double*, K * D> gradients;  // of each field
  double V;                                    // m^D
  std::array<double*, K> out;                  // of each field, over m^2

  struct me {
    std::array<real, K> sum;
  };
  auto reads() const { return std::tuple{pairs::read(of_slopes, gradients)}; }
  me begin(std::size_t) const {
    me a;
    a.sum.fill(real(0.0));
    return a;
  }
  void add(me& a, const auto& ij) const {
    const auto G = ij.own(of_slopes) + ij(of_slopes);
    const auto f_ij = ij.difference(operators::of_fields);
    for (std::size_t k = 0; k < K; ++k) {
      real steps = 2.0 * f_ij[k];
      for (std::size_t b = 0; b < D; ++b) steps -= G[k * D + b] * ij.x_ij[b];
      if constexpr (graded)
        if (k == D + 1) {
          const real mine = ij.own(of_viscosity_root) * ij.own(of_viscosity_root);
          steps *= mine / foundation::greater(mine, real(ij(of_viscosity_root) * ij(of_viscosity_root)));
        }
      a.sum[k] += ij.F * steps;
    }
  }
  void end(std::size_t i, const me& a) const {
    for (std::size_t k = 0; k < K; ++k) out[k][i] = V * pairs::sum(a.sum[k]);
  }
};

// Σ_j V F r [1 + 0.2 (W/W(Δx))⁴] (1/m), and Σ_j W with the particle itself (1/m^D).
template <int D>
struct unevenness {
  using real = pairs::real;
  double V, W_self, per_W_dx;
  std::array<double*, D> out;
  double* W_sum;

  struct me {
    pairs::vec<real, D> sum;
    real W;
  };
  me begin(std::size_t) const { return {foundation::zero<real, D>(), real(0.0)}; }
  void add(me& a, const auto& ij) const {
    const real q = ij.W * per_W_dx, q2 = q * q;
    a.sum += (ij.F * (1.0 + 0.2 * q2 * q2)) * ij.x_ij;
    a.W += ij.W;
  }
  void end(std::size_t i, const me& a) const {
    for (std::size_t k = 0; k < D; ++k) out[k][i] = V * pairs::sum(a.sum[k]);
    W_sum[i] = W_self + pairs::sum(a.W);
  }
};

}  // namespace tetsuame::convection
