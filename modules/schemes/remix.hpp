// REMIX [T. D. Sandnes, V. R. Eke, J. A. Kegerreis, R. J. Massey, L. F. A. Teodoro, J. Comput. Phys. 532, 113907
// (2025)]: densities by continuity, kernels that reproduce linear fields, G_ij = ½ [∂W^R_ij - ∂W^R_ji]
// (reproducing.hpp), V = m/ρ.
//   m_i dv_i/dt = -Σ_j V_i V_j (P_i + Q_i + P_j + Q_j) G_ij
//   m_i du_i/dt =  Σ_j V_i V_j (P_i + Q_i) v_ij·G_ij                    + diffusion of u
//       dρ_i/dt =  ρ_i Σ_j V_j v_ij·G_ij + (m_0 - 1) ρ_i Σ_j m_j |v_ij| |G_ij|/ρ̄ + diffusion of ρ
// du = P/ρ² dρ but for what is viscous or diffuses: entropy is kept at contacts. Momentum and energy are kept whatever
// the kernels are, as G_ij = -G_ji. Viscous pressure and diffusion see values in the middle of the pair,
//   ṽ_i = v_i - ½ (1 - B_i) φ ∇v_i·x_ij,   φ = max(0, 4 a_i a_j/(a_i + a_j)²) e,   a = x_ij·∇v·x_ij
//   e = exp[-(η - η_c)²/0.04] for η = r/max(h_i, h_j) < η_c, else 1;   η_c: the spacing over h
//   Q_i = ½ (2/3 + B_i/3) ρ_i (-1.5 c_i μ_i + 3 μ_i²),   μ_i = min{0, ṽ_ij·x_ij/h_i/[(r/h_i)² + 0.1²]}
//   diffusion of a = u, ρ:  -(0.05 + 0.95 B̄) Σ_j m_j |ṽ_ij| (ã_i - ã_j) |G_ij|/ρ̄   among particles of one material
// B is Balsara's factor. What is not as published: docs/theory/shocks.md.
#pragma once

#include <foundation/lanes_math.hpp>
#include <schemes/reproducing.hpp>

namespace tetsuame::schemes {

inline constexpr field<struct normalisation_tag> of_normalisation;  // m_0
inline constexpr field<struct kind_tag> of_kind;                    // which material

// The part of a pair's slopes that the middle takes, of the two ends' differences.
inline real slope_part(const real& a_i, const real& a_j) {
  const real both = a_i + a_j, product = 4.0 * a_i * a_j;
  real part = greater(real(product / (both * both)), real(0.0));
  where(both == 0.0, part) = 0.0;
  where(a_i == 0.0 && a_j == 0.0, part) = 1.0;
  return lesser(part, real(1.0));
}

template <int D, class Kernel>
struct remix {
  // S/h: h is twice the standard deviation of the kernel [W. Dehnen, H. Aly, MNRAS 425, 1068 (2012)], of the quintic in
  // 2-D; the others here are within a tenth of it.
  static constexpr double support_over_h = 2.16;

  Kernel unit;
  fields<D> g;     // dissipation = B; gradients are of u in the place of p
  double spacing;  // S over the spacing

  struct me {
    vec<real, D> force;
    real power, signal, density_rate;
  };
  auto reads() const {
    return std::tuple_cat(
        reproducing_reads(g.a),
        g.read(of_velocity, of_mass, of_density, of_pressure, of_sound, of_per_support, of_dissipation, of_volume,
               of_grad_p, of_grad_rho, of_grad_v, of_energy),
        std::tuple{pairs::read(of_normalisation, g.a.reproducing[0].data()), pairs::read(of_kind, g.a.kind.data())});
  }
  me begin(const pairs::cluster<>&) const { return {foundation::zero<real, D>(), real(0.0), real(0.0), real(0.0)}; }
  void add(me& a, const auto& ij) const {
    using foundation::dot;
    const mean_kernel k = mean_kernel_of<D>(unit, ij);
    const auto G = reproducing_gradient<D>(k, ij);
    const auto& x = ij.x_ij;
    const auto v = ij.difference(of_velocity);
    const real B_i = ij.own(of_dissipation), B_j = ij(of_dissipation), mean_B = 0.5 * (B_i + B_j);
    const real h_i = support_over_h * ij.own(of_per_support), h_j = support_over_h * ij(of_per_support);  // 1/h

    const real eta = ij.r * lesser(h_i, h_j), near = eta - support_over_h / spacing;
    real close = foundation::exp(real(-25.0 * near * near));
    where(near >= 0.0, close) = 1.0;
    const auto along = [&](const vec<real, D>& gradient) { return dot(gradient, x); };
    const auto change = [&](const auto& gradient) {
      vec<real, D> sum;
      for (std::size_t b = 0; b < D; ++b) {
        sum[b] = real(0.0);
        for (std::size_t c = 0; c < D; ++c) sum[b] += gradient[D * b + c] * x[c];
      }
      return sum;
    };
    const auto v_i = change(ij.own(of_grad_v)), v_j = change(ij(of_grad_v));
    const real part = 0.5 * close * slope_part(real(dot(v_i, x)), real(dot(v_j, x)));
    const vec<real, D> w = v - (part * (1.0 - B_i)) * v_i - (part * (1.0 - B_j)) * v_j;
    // ã_i - ã_j. Where a slope would take a positive value of one end to zero or below, the pair has no slopes.
    const auto middle = [&](const real& a_i, const real& a_j, const real& d_i, const real& d_j) {
      const real half = 0.5 * close * slope_part(d_i, d_j), at_i = a_i - half * d_i, at_j = a_j + half * d_j;
      real difference = (a_i - a_j) - half * (d_i + d_j);
      where((a_i > 0.0 && at_i <= 0.0) || (a_j > 0.0 && at_j <= 0.0), difference) = a_i - a_j;
      return difference;
    };
    const real u_ij = middle(ij.own(of_energy), ij(of_energy), along(ij.own(of_grad_p)), along(ij(of_grad_p)));
    const real rho_i = ij.own(of_density), rho_j = ij(of_density);
    const real rho_ij = middle(rho_i, rho_j, along(ij.own(of_grad_rho)), along(ij(of_grad_rho)));

    const real w_x = dot(w, x), r2 = ij.r * ij.r;
    const auto closing = [&](const real& per_h) {
      return lesser(real(w_x * per_h / (r2 * per_h * per_h + 0.01)), real(0.0));
    };
    const real mu_i = closing(h_i), mu_j = closing(h_j);
    const auto viscous = [](const real& B, const real& rho, const real& c, const real& mu) {
      return real((1.0 / 3.0 + B / 6.0) * rho * mu * (3.0 * mu - 1.5 * c));
    };
    const real P_i = ij.own(of_pressure) + viscous(B_i, rho_i, ij.own(of_sound), mu_i);
    const real P_j = ij(of_pressure) + viscous(B_j, rho_j, ij(of_sound), mu_j);

    const real V_j = ij(of_volume), VV = ij.own(of_volume) * V_j, v_G = dot(v, G);
    using std::sqrt;
    const real size = 2.0 * ij(of_mass) * sqrt(real(dot(G, G))) / (rho_i + rho_j);
    real mixes = (0.05 + 0.95 * mean_B) * sqrt(real(dot(w, w))) * size;
    where(ij.own(of_kind) != ij(of_kind), mixes) = 0.0;
    a.force -= (VV * (P_i + P_j)) * G;
    a.power += VV * P_i * v_G - ij.own(of_mass) * mixes * u_ij;
    a.density_rate +=
        rho_i * V_j * v_G + (ij.own(of_normalisation) - 1.0) * rho_i * sqrt(real(dot(v, v))) * size - mixes * rho_ij;
    real signal = ij.own(of_sound) + ij(of_sound) - 4.0 * lesser(mu_i, mu_j);
    where(k.W == 0.0, signal) = 0.0;
    a.signal = greater(a.signal, signal);
  }
  void end(const pairs::cluster<>& i, const me& a) const {
    forces<D, Kernel>{unit, g}.end(i, a);
    i.set(g.a.density_rate.data(), a.density_rate);
  }
};

}  // namespace tetsuame::schemes
