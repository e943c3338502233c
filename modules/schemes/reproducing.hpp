// Kernels that reproduce linear fields on any arrangement of particles [W. K. Liu, S. Jun, Y. F. Zhang, Int. J. Numer.
// Meth. Fluids 20, 1081 (1995); N. Frontiere, C. D. Raskin, J. M. Owen, J. Comput. Phys. 332, 160 (2017)]:
//   W^R_ij = A_i [1 + B_i·x_ij] W_ij,   Σ_j V_j W^R_ij = 1,   Σ_j V_j x_ij W^R_ij = 0
//   B = -m_2⁻¹ m_1,   A = 1/(m_0 + B·m_1),   m_0, m_1, m_2 = Σ_j V_j {1, x_ij, x_ij ⊗ x_ij} W_ij
// with the mean of both ends' kernels for W_ij, and the gradients at x_i of all these, supports held (the particle
// itself included in the sums). Where the neighbours lie so that m_2 cannot be inverted, B = 0: constants alone are
// reproduced.
#pragma once

#include <operators/symmetric.hpp>
#include <schemes/common.hpp>

namespace tetsuame::schemes {

using pairs::real;

inline constexpr field<struct amplitude_tag> of_amplitude;            // A
inline constexpr field<struct tilt_tag> of_tilt;                      // B, 1/m
inline constexpr field<struct grad_amplitude_tag> of_grad_amplitude;  // ∂A/∂x_b, 1/m
inline constexpr field<struct grad_tilt_tag> of_grad_tilt;            // [D a + b]: ∂B_a/∂x_b, 1/m²

struct mean_kernel {
  real W, F;  // 1/m^D, W'(r)/r in 1/m^(D+2)
};
template <int D, class Kernel>
mean_kernel mean_kernel_of(const Kernel& unit, const auto& ij) {
  mean_kernel mean{real(0.0), real(0.0)};
  for (const real& per_S : {real(ij.own(of_per_support)), real(ij(of_per_support))}) {
    const auto k = kernel_of_end<D>(unit, ij, per_S);
    mean.F += 0.5 * k.scale * k.F;
    mean.W += 0.5 * power<D>(per_S) * k.W;
  }
  return mean;
}

template <int D, class Kernel>
struct reproducing {
  Kernel unit;
  fields<D> g;

  static constexpr std::size_t N = D, M = operators::symmetric_terms(D);
  struct me {
    real m0;
    vec<real, D> m1, g0;         // g: the same sums with F x_ij for W
    std::array<real, M> m2, g2;  // g2 is of x_ij once
    std::array<vec<real, D>, M> g3;
  };
  auto reads() const { return g.read(of_volume, of_per_support); }
  me begin(const pairs::cluster<>&) const {
    me a;
    a.m0 = real(0.0);
    a.m1 = a.g0 = foundation::zero<real, D>();
    for (auto* all : {&a.m2, &a.g2})
      for (auto& s : *all) s = real(0.0);
    for (auto& s : a.g3) s = foundation::zero<real, D>();
    return a;
  }
  void add(me& a, const auto& ij) const {
    const mean_kernel k = mean_kernel_of<D>(unit, ij);
    const real V = ij(of_volume), VW = V * k.W, VF = V * k.F;
    const auto& x = ij.x_ij;
    a.m0 += VW;
    a.m1 += VW * x;
    a.g0 += VF * x;
    for (std::size_t b = 0, n = 0; b < N; ++b)
      for (std::size_t c = b; c < N; ++c, ++n) {
        const real xx = x[b] * x[c];
        a.m2[n] += VW * xx;
        a.g2[n] += VF * xx;
        a.g3[n] += (VF * xx) * x;
      }
  }
  void end(const pairs::cluster<>& members, const me& a) const {
    members.each([&](std::size_t i, const auto& of) { end(i, a, of); });
  }

 private:
  void end(std::size_t i, const me& a, const auto& of) const {
    const auto place = [](std::size_t b, std::size_t c) { return operators::symmetric_place(b, c, N); };
    const double m0 = of(a.m0) + g.s.dV[i] * std::pow(g.a.per_S[i], D) * unit.self();
    std::array<double, N> m1, B{};
    std::array<std::array<double, N>, N> m2;
    for (std::size_t b = 0; b < N; ++b) {
      m1[b] = of(a.m1[b]);
      for (std::size_t c = 0; c < N; ++c) m2[b][c] = of(a.m2[place(b, c)]);
    }
    const bool exists = operators::factorise(m2);
    if (exists) {
      B = operators::solve(m2, m1);
      for (double& b : B) b = -b;
    }
    double of_B = m0;
    for (std::size_t b = 0; b < N; ++b) of_B += B[b] * m1[b];
    const double A = 1.0 / of_B;
    auto& out = g.a.reproducing;
    out[0][i] = m0;
    out[1][i] = A;
    for (std::size_t e = 0; e < N; ++e) {
      // ∂m_0, ∂m_1, ∂m_2 along e
      std::array<double, N> dm1, right, dB{};
      for (std::size_t b = 0; b < N; ++b) {
        dm1[b] = (b == e ? m0 : 0.0) + of(a.g2[place(b, e)]);
        right[b] = dm1[b];
        for (std::size_t c = 0; c < N; ++c)
          right[b] += ((c == e ? m1[b] : 0.0) + (b == e ? m1[c] : 0.0) + of(a.g3[place(b, c)][e])) * B[c];
      }
      if (exists) {
        dB = operators::solve(m2, right);
        for (double& b : dB) b = -b;
      }
      double change = of(a.g0[e]);
      for (std::size_t b = 0; b < N; ++b) change += dB[b] * m1[b] + B[b] * dm1[b];
      out[2 + e][i] = B[e];
      out[2 + N + e][i] = -A * A * change;
      for (std::size_t b = 0; b < N; ++b) out[2 + 2 * N + N * b + e][i] = dB[b];
    }
  }
};

// What a term reads for it.
template <int D>
auto reproducing_reads(const arrays<D>& a) {
  constexpr std::size_t N = D;
  return std::tuple{pairs::read(of_amplitude, a.reproducing[1].data()),
                    pairs::read(of_tilt, slice<N>(a.reproducing, 2)),
                    pairs::read(of_grad_amplitude, slice<N>(a.reproducing, 2 + N)),
                    pairs::read(of_grad_tilt, slice<N * N>(a.reproducing, 2 + 2 * N))};
}

// ½ [∂W^R_ij - ∂W^R_ji], 1/m^(D+1): changes sign with the order of i and j.
template <int D>
vec<real, D> reproducing_gradient(const mean_kernel& k, const auto& ij) {
  const auto& x = ij.x_ij;
  const auto one = [&](const auto& end, double sign) {
    const real A = end(of_amplitude);
    const auto B = end(of_tilt), grad_A = end(of_grad_amplitude);
    const auto grad_B = end(of_grad_tilt);
    const real linear = 1.0 + sign * foundation::dot(B, x);
    vec<real, D> g;
    for (std::size_t b = 0; b < D; ++b) {
      real tilt = B[b];
      for (std::size_t a = 0; a < D; ++a) tilt += sign * grad_B[D * a + b] * x[a];
      g[b] = k.W * (grad_A[b] * linear + A * tilt) + (sign * A * linear * k.F) * x[b];
    }
    return g;
  };
  const auto at_i = one([&](auto tag) { return ij.own(tag); }, 1.0);
  const auto at_j = one([&](auto tag) { return ij(tag); }, -1.0);
  return 0.5 * (at_i - at_j);
}

}  // namespace tetsuame::schemes
