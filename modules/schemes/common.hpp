// What the schemes for gas share: their arrays and the names of these, the two kernels of a pair whose ends have
// supports of their own, and the sums before the forces. Notation: w the weight that a scheme smooths, m (SSPH, GSPH)
// or U = m u (DISPH, GDISPH);
//   y_i = Σ_j w_j W_ij(h_i)                        ρ or q = P/(γ - 1)                        [S4, eq. (7)]
//   f_i = [1 + h_i/(D y_i) Σ_j w_j ∂W_ij/∂h_i]⁻¹ = -D y_i / Σ_j w_j r² F_ij(h_i)             [S4, eq. (9)]
// by h ∂W/∂h = -(D W + r W'). Kernels are evaluated at q = r/S with support 1: W = Ŵ/S^D, W'/r = F̂/S^(D+2).
//
// The support follows the number density n_i = Σ_j W_ij(h_i), itself included: S^D n = (S/Δx)^D of the start lattice.
// Then DISPH's forces have w_i (w_j + z_i) in the place of f_i w_i w_j (docs/theory/shocks.md):
//   z_i = -(D y_i + Σ_j w_j r W'(h_i))/Σ_j r W'(h_i)
#pragma once

#include <cmath>
#include <operators/symmetric.hpp>
#include <pairs/long_sum.hpp>
#include <pairs/pairs.hpp>
#include <particles/named_fields.hpp>

namespace tetsuame::schemes {

using foundation::greater, foundation::lesser, foundation::rounded, foundation::select;
using pairs::of_pressure, pairs::of_velocity, pairs::of_volume, pairs::of_weight, pairs::vec;

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
inline constexpr field<struct energy_tag> of_energy;            // J/kg
inline constexpr field<struct integral_tag> of_integral;        // C, 1/m²
inline constexpr field<struct geometric_tag> of_geometric;      // g
inline constexpr field<struct gamma_tag> of_gamma;
inline constexpr field<struct stiffness_tag> of_stiffness;  // p_inf, Pa
inline constexpr field<struct grad_p_tag> of_grad_p;
inline constexpr field<struct grad_rho_tag> of_grad_rho;
inline constexpr field<struct grad_v_tag> of_grad_v;  // [D a + b]: ∂v_a/∂x_b

// What a scheme reads beside what all do.
struct needs {
  bool slopes = false;     // gradients
  bool corrects = false;   // REMIX's kernels, and ρ by continuity
  bool integral = false;   // gradients by an integral (integral.hpp)
  bool geometric = false;  // the factor of forces with geometric densities (density_based.hpp)
  bool counts = false;     // of neighbours, once lists are new and before sums over them: supports follow these
};

// One field a quantity, beside those that all particles have.
template <int D>
struct arrays {
  using array = particles::array;
  static constexpr std::size_t G = static_cast<std::size_t>(D) * (D + 2), R = 2 + G, M = operators::symmetric_terms(D);
  template <std::size_t N>
  using vector_field = particles::vector_field<N>;

 private:
  particles::particles<D>& table_;
  const needs has_;
  particles::role role_of_counts() const { return has_.counts ? particles::role::memory : particles::role::derived; }

 protected:
  array& derived(const char* name, const char* unit, const char* about, bool needed = true) {
    return particles::declare_if(needed, table_, name, unit, particles::role::derived, about);
  }
  template <std::size_t N>
  vector_field<N> derived_vector(const char* name, const char* unit, const char* about, bool needed = true) {
    return particles::declare_vector_if<N>(needed, table_, name, unit, particles::role::derived, about);
  }

 public:
  arrays(particles::particles<D>& s, const needs& of_scheme) : table_(s), has_(of_scheme) {}
  arrays(const arrays&) = delete;  // its fields are the particles', and move with them
  arrays& operator=(const arrays&) = delete;
  arrays(arrays&&) = default;

  // Of all particles, ghosts and images included
  array& S = derived("KernelSupport", "m", "S, in the sums");
  array& per_S = derived("InverseSupport", "1/m", "1/S");
  array& weight = derived("SmoothedWeight", "", "w: m, m u or the volume at the start");
  array& slope = derived("SlopeFactor", "", "f/y^2, with the pressure where the scheme has one of its own");
  array& correction = derived("SupportTerm", "", "z where the forces have it");
  array& dissipation = derived("DissipationFactor", "1", "of the pair's viscosity or star pressure");
  array& gamma = derived("AdiabaticExponent", "1", "of the gas, or of the material at the start");
  array& stiffness = derived("StiffenedPressure", "Pa", "p_inf");
  array& kind = derived("KindOfMaterial", "1", "which material");
  vector_field<G> gradient = derived_vector<G>("Gradient", "", "of p (REMIX: u), of rho, [D a + b] of v", has_.slopes);
  vector_field<R> reproducing =
      derived_vector<R>("ReproducingCoefficient", "", "m_0, A, B, gradients of A and B", has_.corrects);
  vector_field<M> integral = derived_vector<M>("IntegralGradient", "1/m^2", "C, a symmetric tensor", has_.integral);
  array& factor = derived("GeometricFactor", "1", "g, of gradients", has_.geometric);
  // Of the particles that have neighbours
  array& y = derived("SumOfWeights", "", "y: sum of w W");
  array& f = derived("SupportFactor", "1", "f: of supports that follow y");
  array& z = derived("SupportSum", "", "z: of supports that follow n");
  array& divergence = derived("VelocityDivergence", "1/s", "");
  array& curl = derived("VelocityCurl", "1/s", "absolute value");
  array& number = derived("NumberDensity", "1/m^D", "n: sum of W");
  array& mass_density = derived("MassDensity", "kg/m^D", "sum of m W");
  array& count = particles::declare(table_, "NeighbourCount", "1", role_of_counts(), "n S^D");
  array& count_slope = particles::declare(table_, "NeighbourCountSlope", "1", role_of_counts(), "its slope over S");
  vector_field<D> force = derived_vector<D>("Force", "N", "");
  array& power = derived("Power", "W", "");
  array& signal = derived("SignalVelocity", "m/s", "");
  array& density_rate = derived("DensityRate", "kg/(m^D s)", "by continuity", has_.corrects);
};

template <std::size_t N, std::size_t M>
std::array<const double*, N> slice(const particles::vector_field<M>& all, std::size_t first) {
  std::array<const double*, N> part;
  for (std::size_t k = 0; k < N; ++k) part[k] = all[first + k].data();
  return part;
}

// What terms read, with the power of m that it goes with (pairs/cluster.hpp), and write.
template <int D>
struct fields {
  const particles::particles<D>& s;
  arrays<D>& a;

  template <class... Tags>
  auto read(Tags... tags) const {
    return std::tuple{of(tags)...};
  }

 private:
  static constexpr std::size_t N = D;
  static auto one(auto tag, const particles::array& values, int lengths = 0) {
    return pairs::read(tag, values.data(), lengths);
  }
  auto of(pairs::velocity_tag tag) const { return pairs::read(tag, pairs::pointers<D>(s.v)); }
  auto of(pairs::pressure_tag tag) const { return one(tag, s.p); }
  auto of(pairs::volume_tag tag) const { return one(tag, s.dV, D); }
  auto of(pairs::weight_tag tag) const { return one(tag, a.weight, D); }
  auto of(field<mass_tag> tag) const { return one(tag, s.m, D); }
  auto of(field<density_tag> tag) const { return one(tag, s.rho); }
  auto of(field<sound_tag> tag) const { return one(tag, s.c); }
  auto of(field<per_support_tag> tag) const { return one(tag, a.per_S, -1); }
  auto of(field<slope_tag> tag) const { return one(tag, a.slope); }
  auto of(field<dissipation_tag> tag) const { return one(tag, a.dissipation); }
  auto of(field<correction_tag> tag) const { return one(tag, a.correction, D); }
  auto of(field<energy_tag> tag) const { return one(tag, s.u); }
  auto of(field<geometric_tag> tag) const { return one(tag, a.factor); }
  auto of(field<integral_tag> tag) const { return pairs::read(tag, slice<arrays<D>::M>(a.integral, 0), -2); }
  auto of(field<gamma_tag> tag) const { return one(tag, a.gamma); }
  auto of(field<stiffness_tag> tag) const { return one(tag, a.stiffness); }
  auto of(field<grad_p_tag> tag) const { return pairs::read(tag, slice<N>(a.gradient, 0), -1); }
  auto of(field<grad_rho_tag> tag) const { return pairs::read(tag, slice<N>(a.gradient, N), -1); }
  auto of(field<grad_v_tag> tag) const { return pairs::read(tag, slice<N * N>(a.gradient, 2 * N), -1); }
};

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

template <class R>
struct shape {
  R q, W, F;  // r/S, Ŵ, F̂
};

// Of a particle whose support is 1/per_S.
template <class Kernel, class R>
shape<R> shape_of(const Kernel& unit, const auto& ij, const R& S, const R& per_S) {
  shape<R> s;
  s.q = ij.r * per_S;
  unit.both(s.q, R(ij.per_r * S), s.W, s.F);
  return s;
}

// Of an end whose support is 1/per_S: Ŵ, and W'(r)/r = scale F, 1/m^(D+2). A spline's F̂ is W'(q)/q: with F = W' and the
// pair's 1/r in the scale a division is saved. The null particle has 1/S = 0.
template <class R>
struct end_kernel {
  R W, F, scale;
};
template <int D, class Kernel, class R>
end_kernel<R> kernel_of_end(const Kernel& unit, const auto& ij, const R& per_S) {
  end_kernel<R> k;
  const R q = ij.r * per_S;
  constexpr bool has_shape = requires { Kernel::shape(q, q, k.W, k.F); };
  unit.both(q, has_shape ? q : R(1.0), k.W, k.F);
  k.scale = power<D>(per_S) * per_S * (has_shape ? per_S : ij.per_r);
  return k;
}

// W'(r)/r of either end, 1/m^(D+2).
template <class R>
struct two_slopes {
  R i, j;
};
template <int D, class Kernel>
auto slopes_of(const Kernel& unit, const auto& ij) {
  const auto i = kernel_of_end<D>(unit, ij, ij.own(of_per_support)), j = kernel_of_end<D>(unit, ij, ij(of_per_support));
  using R = std::remove_cvref_t<decltype(ij.r)>;
  return two_slopes<R>{rounded(R(i.scale * i.F)), rounded(R(j.scale * j.F))};
}

// The next S of S^D n = target by Newton's method, by at most a fifth at once.
inline double next_support(double S, double count, double slope, double target) {
  constexpr double most = 0.2;
  const double miss = count - target;
  const double change = slope < -1e-12 * count ? miss / slope : -miss;  // alone: a larger support
  return S * (1.0 + std::fmin(std::fmax(change, -most), most));
}

// y, f, z, ∇·v, |∇×v|, n, and Σ_j m_j W_ij.
template <int D, class Kernel>
struct density {
  Kernel unit;
  fields<D> g;

  static constexpr int C = D == 1 ? 0 : D == 2 ? 1 : 3;
  template <class R>
  struct me {
    R S, per_S, y, slope, n, n_slope, rho, divergence;
    std::array<R, C> curl;
  };
  auto reads() const { return g.read(of_weight, of_mass, of_velocity); }
  template <class R>
  me<R> begin(const pairs::cluster<R>& i) const {
    const R S_i = i(g.a.S.data(), 1);
    me<R> sum{S_i, R(1.0 / S_i), R(0.0), R(0.0), R(0.0), R(0.0), R(0.0), R(0.0), {}};
    for (auto& c : sum.curl) c = R(0.0);
    return sum;
  }
  void add(auto& sum, const auto& ij) const {
    const auto s = shape_of(unit, ij, sum.S, sum.per_S);
    const auto w = ij(of_weight), wF = w * s.F, q2 = s.q * s.q;
    sum.n += s.W;
    sum.n_slope += s.F * q2;
    sum.y += w * s.W;
    sum.rho += ij(of_mass) * s.W;
    sum.slope += wF * q2;
    sum.divergence += wF * ij.along(of_velocity);
    const auto v_ij = ij.difference(of_velocity);
    if constexpr (D == 2) sum.curl[0] += wF * (v_ij[0] * ij.x_ij[1] - v_ij[1] * ij.x_ij[0]);
    if constexpr (D == 3)
      foundation::for_each_of<3>([&](std::size_t k) {
        const std::size_t b = (k + 1) % 3, c = (k + 2) % 3;
        sum.curl[k] += wF * (v_ij[b] * ij.x_ij[c] - v_ij[c] * ij.x_ij[b]);
      });
  }
  void end(const auto& members, const auto& sum) const {
    members.each([&](std::size_t i, const auto& of) { end(i, sum, of); });
  }

 private:
  void end(std::size_t i, const auto& sum, const auto& of) const {
    auto& a = g.a;
    const double S = a.S[i], y = a.weight[i] * unit.self() + of(sum.y, D), slope = of(sum.slope, D);
    const double per_volume = 1.0 / power<D>(S);
    const double f = slope < -1e-12 * y ? -D * y / slope : 1.0;
    const double factor = f / (y * S * S);
    double curl2 = 0.0;
    for (const auto& c : sum.curl) curl2 += of(c, D + 1) * of(c, D + 1);
    a.y[i] = per_volume * y;
    a.f[i] = f;
    const double n_slope = of(sum.n_slope);
    a.z[i] = n_slope < 0.0 ? -(D * y + slope) / n_slope : 0.0;
    a.divergence[i] = -factor * of(sum.divergence, D + 1);
    a.curl[i] = factor * std::sqrt(curl2);
    a.count[i] = unit.self() + of(sum.n);
    a.count_slope[i] = n_slope;
    a.number[i] = per_volume * a.count[i];
    a.mass_density[i] = per_volume * (g.s.m[i] * unit.self() + of(sum.rho, D));
  }
};

// ---- what the force terms have in common -----------------------------------------------------

template <int D, class R>
struct sums {
  pairs::long_sum<R, D> force;  // N
  R power, signal;              // W, m/s
};

// c_i + c_j - 3 min(w_ij, 0), where the neighbour is within the support of either.
template <class R>
void keep_signal(auto& sum, const two_slopes<R>& F, const R& signal) {
  sum.signal = greater(sum.signal, select(F.i + F.j == 0.0, R(0.0), signal));
}

template <int D, class Kernel>
struct forces {
  Kernel unit;
  fields<D> g;

  template <class R>
  sums<D, R> begin(const pairs::cluster<R>& i) const {
    // The pressure on one side of a particle is some 3 p V/S, and a neighbour's may be twenty times as large.
    const R larger = 64.0 * i(g.s.p.data()) * i(g.s.dV.data(), D) * i(g.a.per_S.data(), -1);
    return {pairs::long_sum<R, D>(larger), R(0.0), R(0.0)};
  }
  static void join(auto& sum, const auto& other) {
    sum.force.join();
    sum.power += other.power;
    sum.signal = greater(sum.signal, other.signal);
  }
  void end(const auto& i, const auto& sum) const {
    for (std::size_t k = 0; k < D; ++k) i.set_doubles(g.a.force[k].data(), sum.force[k], D - 1);
    i.set(g.a.power.data(), sum.power, D - 1);
    i.set(g.a.signal.data(), sum.signal);
  }
};

}  // namespace tetsuame::schemes
