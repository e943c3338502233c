// What the schemes for gas share: names of fields, the two kernels of a pair whose ends have supports of their own, and
// the sums before the forces. Notation: w the weight that a scheme smooths, m (SSPH, GSPH) or U = m u (DISPH, GDISPH);
//   y_i = Σ_j w_j W_ij(h_i)                        ρ or q = P/(γ - 1)                        [S4, eq. (7)]
//   f_i = [1 + h_i/(D y_i) Σ_j w_j ∂W_ij/∂h_i]⁻¹ = -D y_i / Σ_j w_j r² F_ij(h_i)             [S4, eq. (9)]
// by h ∂W/∂h = -(D W + r W'). Kernels are evaluated at q = r/S with support 1: W = Ŵ/S^D, W'/r = F̂/S^(D+2).
//
// The support follows the number density n_i = Σ_j W_ij(h_i), itself included: S^D n = (S/Δx)^D of the start lattice.
// Then DISPH's forces have w_i (w_j + z_i) in the place of f_i w_i w_j (docs/theory/shocks.md):
//   z_i = -(D y_i + Σ_j w_j r W'(h_i))/Σ_j r W'(h_i)
#pragma once

#include <cmath>
#include <pairs/pairs.hpp>

namespace tetsuame::schemes {

using foundation::greater, foundation::lesser;
using pairs::real, pairs::vec;

// The name by which terms read a field.
template <class Tag>
struct field {};

inline constexpr field<struct mass_tag> of_mass;
inline constexpr field<struct per_support_tag> of_per_support;  // 1/S; 0 for the null particle
inline constexpr field<struct density_tag> of_density;
inline constexpr field<struct sound_tag> of_sound;
inline constexpr field<struct slope_tag> of_slope;  // f_i/y_i², with the pressure where the scheme has one of its own
inline constexpr field<struct dissipation_tag> of_dissipation;  // α_i and Balsara's factor; the part of P* (Godunov)
inline constexpr field<struct correction_tag> of_correction;    // z_i
inline constexpr field<struct gamma_tag> of_gamma;
inline constexpr field<struct stiffness_tag> of_stiffness;  // p_inf, Pa

// In place of a kernel in pairs::sum_over: the terms evaluate their own.
struct distances_only {
  double nearest;  // m
  double smallest_r() const { return nearest; }
  template <class R>
  void both(const R&, const R&, R&, R&) const {}
};

template <int D, class R>
R power(const R& a) {
  if constexpr (D == 1)
    return a;
  else if constexpr (D == 2)
    return a * a;
  else
    return a * a * a;
}

struct shape {
  real q, W, F;  // r/S, Ŵ, F̂
};

// Of a particle whose support is 1/per_S.
template <class Kernel>
shape shape_of(const Kernel& unit, const auto& ij, const real& S, const real& per_S) {
  shape s;
  s.q = ij.r * per_S;
  unit.both(s.q, real(ij.per_r * S), s.W, s.F);
  return s;
}

// Of an end whose support is 1/per_S: Ŵ, and W'(r)/r = scale F, 1/m^(D+2). A spline's F̂ is W'(q)/q: with F = W' and the
// pair's 1/r in the scale a division is saved. The null particle has 1/S = 0.
struct end_kernel {
  real W, F, scale;
};
template <int D, class Kernel>
end_kernel kernel_of_end(const Kernel& unit, const auto& ij, const real& per_S) {
  end_kernel k;
  const real q = ij.r * per_S;
  constexpr bool has_shape = requires { Kernel::shape(q, q, k.W, k.F); };
  unit.both(q, has_shape ? q : real(1.0), k.W, k.F);
  k.scale = power<D>(per_S) * per_S * (has_shape ? per_S : ij.per_r);
  return k;
}

// W'(r)/r of either end, 1/m^(D+2).
struct two_slopes {
  real i, j;
};
template <int D, class Kernel>
two_slopes slopes_of(const Kernel& unit, const auto& ij) {
  const auto i = kernel_of_end<D>(unit, ij, ij.own(of_per_support)), j = kernel_of_end<D>(unit, ij, ij(of_per_support));
  return {i.scale * i.F, j.scale * j.F};
}

// n_i S_i^D and the same of r² F, by which Newton's method finds S at the start.
template <class Kernel>
struct number_density {
  Kernel unit;
  const double* S;
  double *count, *slope;

  struct me {
    real S, per_S, count, slope;
  };
  me begin(const pairs::cluster<>& i) const {
    const real S_i = i(S);
    return {S_i, real(1.0 / S_i), real(0.0), real(0.0)};
  }
  void add(me& a, const auto& ij) const {
    const shape s = shape_of(unit, ij, a.S, a.per_S);
    a.count += s.W;
    a.slope += s.q * s.q * s.F;
  }
  void end(const pairs::cluster<>& i, const me& a) const {
    i.set(count, unit.self() + a.count);
    i.set(slope, a.slope);
  }
};

// The next S of S^D n = target by Newton's method, by at most a fifth at once.
inline double next_support(double S, double count, double slope, double target) {
  constexpr double most = 0.2;
  const double miss = count - target;
  const double change = slope < -1e-12 * count ? miss / slope : -miss;  // alone: a larger support
  return S * (1.0 + std::fmin(std::fmax(change, -most), most));
}

// y, f, z, ∇·v, |∇×v| (1/s), n, and Σ_j m_j W_ij.
template <int D, class Kernel>
struct density {
  Kernel unit;
  const double *weight, *m;
  std::array<const double*, D> v;
  const double* S;
  struct {
    double *y, *f, *z, *divergence, *curl, *n, *rho;
    double *count, *slope;  // as of number_density
  } out;

  static constexpr int C = D == 1 ? 0 : D == 2 ? 1 : 3;
  struct me {
    real S, per_S, y, slope, n, n_slope, rho, divergence;
    std::array<real, C> curl;
  };
  auto reads() const {
    return std::tuple{pairs::read(pairs::of_weight, weight), pairs::read(of_mass, m),
                      pairs::read(pairs::of_velocity, v)};
  }
  me begin(const pairs::cluster<>& i) const {
    const real S_i = i(S);
    me a{S_i, real(1.0 / S_i), real(0.0), real(0.0), real(0.0), real(0.0), real(0.0), real(0.0), {}};
    for (auto& c : a.curl) c = real(0.0);
    return a;
  }
  void add(me& a, const auto& ij) const {
    const shape s = shape_of(unit, ij, a.S, a.per_S);
    const real w = ij(pairs::of_weight), wF = w * s.F, q2 = s.q * s.q;
    a.n += s.W;
    a.n_slope += s.F * q2;
    a.y += w * s.W;
    a.rho += ij(of_mass) * s.W;
    a.slope += wF * q2;
    a.divergence += wF * ij.along(pairs::of_velocity);
    const auto v_ij = ij.difference(pairs::of_velocity);
    if constexpr (D == 2) a.curl[0] += wF * (v_ij[0] * ij.x_ij[1] - v_ij[1] * ij.x_ij[0]);
    if constexpr (D == 3)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t b = (k + 1) % 3, c = (k + 2) % 3;
        a.curl[k] += wF * (v_ij[b] * ij.x_ij[c] - v_ij[c] * ij.x_ij[b]);
      }
  }
  void end(const pairs::cluster<>& members, const me& a) const {
    members.each([&](std::size_t i, const auto& of) { end(i, a, of); });
  }

 private:
  void end(std::size_t i, const me& a, const auto& of) const {
    const double y = weight[i] * unit.self() + of(a.y), slope = of(a.slope);
    const double per_volume = 1.0 / power<D>(S[i]);
    const double f = slope < -1e-12 * y ? -D * y / slope : 1.0;
    const double factor = f / (y * S[i] * S[i]);
    double curl2 = 0.0;
    for (const real& c : a.curl) curl2 += of(c) * of(c);
    out.y[i] = per_volume * y;
    out.f[i] = f;
    const double n_slope = of(a.n_slope);
    out.z[i] = n_slope < 0.0 ? -(D * y + slope) / n_slope : 0.0;
    out.divergence[i] = -factor * of(a.divergence);
    out.curl[i] = factor * std::sqrt(curl2);
    out.count[i] = unit.self() + of(a.n);
    out.slope[i] = n_slope;
    out.n[i] = per_volume * out.count[i];
    out.rho[i] = per_volume * (m[i] * unit.self() + of(a.rho));
  }
};

// ---- what the force terms have in common -----------------------------------------------------

// Arrays of all particles; null: not read by the scheme.
template <int D>
struct gas {
  std::array<const double*, D> v;
  const double *m, *weight, *rho, *p, *c;
  const double *slope, *correction, *per_S;
  const double* dissipation;
  const double *gamma, *stiffness;
  std::array<const double*, D> grad_p, grad_rho;                      // limited in the pair
  std::array<const double*, static_cast<std::size_t>(D) * D> grad_v;  // [D a + b]: ∂v_a/∂x_b
  double theta;                                                       // of the limiter, 1 to 2
  bool exact;
};

// N, W and m/s.
template <int D>
struct rates {
  std::array<double*, D> force;
  double *power, *signal;
};

template <int D>
struct sums {
  vec<real, D> force;
  real power, signal;
};

template <int D>
sums<D> nothing() {
  return {foundation::zero<real, D>(), real(0.0), real(0.0)};
}

// c_i + c_j - 3 min(w_ij, 0), where the neighbour is within the support of either.
template <int D>
void keep_signal(sums<D>& a, const two_slopes& F, const real& signal) {
  real seen = signal;
  where(F.i + F.j == 0.0, seen) = 0.0;
  a.signal = greater(a.signal, seen);
}

template <int D>
void write(const rates<D>& out, const pairs::cluster<>& i, const sums<D>& a) {
  for (std::size_t k = 0; k < D; ++k) i.set(out.force[k], a.force[k]);
  i.set(out.power, a.power);
  i.set(out.signal, a.signal);
}

}  // namespace tetsuame::schemes
