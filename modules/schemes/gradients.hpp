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
  fields<D> g;
  const particles::array& first;  // p; or u, for REMIX

  static constexpr std::size_t M = operators::symmetric_terms(D), K = D + 2;
  template <class R>
  struct me {
    R S, per_S;
    std::array<R, M> moments;
    std::array<vec<R, D>, K> sums;
  };
  auto reads() const {
    return std::tuple_cat(g.read(of_volume, of_density, of_velocity),
                          std::tuple{pairs::read(of_pressure, first.data())});
  }
  template <class R>
  me<R> begin(const pairs::cluster<R>& i) const {
    const R S_i = i(g.a.S.data(), 1);
    me<R> a{S_i, R(1.0 / S_i), {}, {}};
    for (auto& m : a.moments) m = R(0.0);
    for (auto& s : a.sums) s = foundation::zero<R, D>();
    return a;
  }
  void add(auto& a, const auto& ij) const {
    const auto VF = -ij(of_volume) * shape_of(unit, ij, a.S, a.per_S).F;
    const auto weighted = VF * ij.x_ij;
    foundation::for_each_of<D>([&](std::size_t b) {
      foundation::for_each_of<D>([&](std::size_t c) {
        if (b <= c) a.moments[operators::symmetric_place(b, c, D)] += weighted[b] * ij.x_ij[c];
      });
    });
    a.sums[0] += ij.difference(of_pressure) * weighted;
    a.sums[1] += ij.difference(of_density) * weighted;
    const auto v_ij = ij.difference(of_velocity);
    foundation::for_each_of<D>([&](std::size_t b) { a.sums[2 + b] += v_ij[b] * weighted; });
  }
  void end(const auto& members, const auto& a) const {
    members.each([&](std::size_t i, const auto& of) { end(i, a, of); });
  }

 private:
  void end(std::size_t i, const auto& a, const auto& of) const {
    std::array<std::array<double, D>, D> moments;
    for (std::size_t b = 0; b < D; ++b)
      for (std::size_t c = 0; c < D; ++c) moments[b][c] = of(a.moments[operators::symmetric_place(b, c, D)], D + 2);
    const bool exists = operators::factorise(moments);
    for (std::size_t k = 0; k < K; ++k) {
      std::array<double, D> gradient{};
      if (exists) {
        for (std::size_t b = 0; b < D; ++b) gradient[b] = of(a.sums[k][b], D + 1);
        gradient = operators::solve(moments, gradient);
      }
      for (std::size_t b = 0; b < D; ++b) g.a.gradient[D * k + b][i] = gradient[b];
    }
  }
};

}  // namespace tetsuame::schemes
