// Gradients of p, ρ and v for the reconstruction, exact for fields linear in x on any arrangement of particles:
//   M ∇a = -Σ_j V_j F_ij (a_i - a_j) x_ij,   M = -Σ_j V_j F_ij x_ij ⊗ x_ij
// zero where the neighbours lie so that M cannot be inverted.
#pragma once

#include <operators/symmetric.hpp>
#include <schemes/common.hpp>

namespace tetsuame::schemes {

template <int D, class Kernel>
struct gradients {
  Kernel unit;
  const double *volume, *p, *rho;
  std::array<const double*, D> v;
  const double* S;
  std::array<double*, static_cast<std::size_t>(D) * (D + 2)> out;  // of p, of ρ, [D a + b] of v

  static constexpr std::size_t M = operators::symmetric_terms(D), K = D + 2;
  struct me {
    real S, per_S;
    std::array<real, M> moments;
    std::array<vec<real, D>, K> sums;
  };
  auto reads() const {
    return std::tuple{pairs::read(pairs::of_volume, volume), pairs::read(pairs::of_pressure, p),
                      pairs::read(of_density, rho), pairs::read(pairs::of_velocity, v)};
  }
  me begin(const pairs::cluster<>& i) const {
    const real S_i = i(S);
    me a{S_i, real(1.0 / S_i), {}, {}};
    for (auto& m : a.moments) m = real(0.0);
    for (auto& s : a.sums) s = foundation::zero<real, D>();
    return a;
  }
  void add(me& a, const auto& ij) const {
    const real VF = -ij(pairs::of_volume) * shape_of(unit, ij, a.S, a.per_S).F;
    const auto weighted = VF * ij.x_ij;
    for (std::size_t b = 0, k = 0; b < D; ++b)
      for (std::size_t c = b; c < D; ++c, ++k) a.moments[k] += weighted[b] * ij.x_ij[c];
    a.sums[0] += ij.difference(pairs::of_pressure) * weighted;
    a.sums[1] += ij.difference(of_density) * weighted;
    const auto v_ij = ij.difference(pairs::of_velocity);
    for (std::size_t b = 0; b < D; ++b) a.sums[2 + b] += v_ij[b] * weighted;
  }
  void end(const pairs::cluster<>& members, const me& a) const {
    members.each([&](std::size_t i, const auto& of) { end(i, a, of); });
  }

 private:
  void end(std::size_t i, const me& a, const auto& of) const {
    std::array<std::array<double, D>, D> moments;
    for (std::size_t b = 0; b < D; ++b)
      for (std::size_t c = 0; c < D; ++c) moments[b][c] = of(a.moments[operators::symmetric_place(b, c, D)]);
    const bool exists = operators::factorise(moments);
    for (std::size_t k = 0; k < K; ++k) {
      std::array<double, D> gradient{};
      if (exists) {
        for (std::size_t b = 0; b < D; ++b) gradient[b] = of(a.sums[k][b]);
        gradient = operators::solve(moments, gradient);
      }
      for (std::size_t b = 0; b < D; ++b) out[D * k + b][i] = gradient[b];
    }
  }
};

}  // namespace tetsuame::schemes
