// The schemes of Σ_j m_j W_ij with other gradients, forces and dissipation than SSPH's (viscous.hpp), whose viscosity
// they share. G_i stands for ∇_i W_ij(h_i), or for what takes its place (integral.hpp); G_j likewise, of h_j.
//
// Standard SPH:
//   m_i dv_i/dt = -Σ_j m_i m_j [f_i P_i/ρ_i² G_i + f_j P_j/ρ_j² G_j],   dU_i/dt = Σ_j m_i m_j f_i P_i/ρ_i² v_ij·G_i
//
// Geometric densities [J. W. Wadsley, B. W. Keller, T. R. Quinn, MNRAS 471, 2357 (2017)]:
//   m_i dv_i/dt = -Σ_j m_i m_j (P_i + P_j)/(ρ_i ρ_j) ½ [g_i G_i + g_j G_j]
//   dU_i/dt     =  Σ_j m_i m_j  P_i/(ρ_i ρ_j) v_ij·½ [g_i G_i + g_j G_j]
// At one pressure nothing is left of the densities but the volumes V = m/ρ. g makes a flow towards a point compress as
// its density says: published, with supports that stay, and with the supports' own factor f as in SSPH
//   g_i = [Σ_j m_j/ρ_i r W'(h_i)]/[Σ_j m_j/ρ_j r W'(h_i)],   f_i g_i = -D/[Σ_j V_j r W'(h_i)]
// Gradients by an integral need neither: Σ_j V_j x_ij·G_i = -D by construction.
//
// Artificial conductivity [D. J. Price, J. Comput. Phys. 227, 10040 (2008)]: with α_u and ρ̄ = (ρ_i + ρ_j)/2,
//   dU_i/dt ⊃ Σ_j m_i m_j α_u v_u (u_i - u_j)/ρ̄ r̂_ij·½ [∇_i W_ij(h_i) + ∇_i W_ij(h_j)],   v_u = (|P_i - P_j|/ρ̄)^½
// from the hotter to the colder end, until the pressures are equal.
#pragma once

#include <schemes/integral.hpp>
#include <schemes/viscous.hpp>

namespace tetsuame::schemes {

// g, of particles whose V and f are known.
template <int D, class Kernel>
struct geometric_factor {
  Kernel unit;
  fields<D> g;
  bool supports_vary;

  template <class R>
  struct me {
    R S, per_S, slope;
  };
  auto reads() const { return g.read(of_volume); }
  template <class R>
  me<R> begin(const pairs::cluster<R>& i) const {
    const R S_i = i(g.a.S.data(), 1);
    return {S_i, R(1.0 / S_i), R(0.0)};
  }
  void add(auto& a, const auto& ij) const {
    const auto s = shape_of(unit, ij, a.S, a.per_S);
    a.slope += ij(of_volume) * s.F * s.q * s.q;
  }
  void end(const auto& members, const auto& a) const {
    members.each([&](std::size_t i, const auto& of) {
      const double slope = of(a.slope, D) / power<D>(g.a.S[i]);  // Σ V r W'
      const double own = supports_vary ? 1.0 : g.a.f[i];
      g.a.factor[i] = slope < -1e-12 ? -D / (slope * own) : 1.0;
    });
  }
};

// weight = m; slope = f P/ρ². conductivity: α_u
template <int D, class Kernel, bool Geometric, bool Integral>
struct density_based : forces<D, Kernel> {
  double conductivity;

  auto reads() const {
    const auto with = [&](auto... own) {
      return this->g.read(of_velocity, of_mass, of_density, of_sound, of_pressure, of_energy, of_per_support,
                          of_dissipation, own...);
    };
    if constexpr (Geometric && Integral)
      return with(of_volume, of_integral);
    else if constexpr (Geometric)
      return with(of_volume, of_geometric);
    else if constexpr (Integral)
      return with(of_slope, of_integral);
    else
      return with(of_slope);
  }

  void add(auto& sum, const auto& ij) const {
    using R = std::remove_cvref_t<decltype(ij.r)>;
    const auto of_i = [&](auto tag) { return ij.own(tag); };
    const auto of_j = [&](auto tag) { return ij(tag); };
    const auto k_i = kernel_of_end<D>(this->unit, ij, R(ij.own(of_per_support)));
    const auto k_j = kernel_of_end<D>(this->unit, ij, R(ij(of_per_support)));
    const two_slopes<R> F{rounded(R(k_i.scale * k_i.F)), rounded(R(k_j.scale * k_j.F))};
    auto from_i = gradient<R>(of_i, ij, k_i, F.i), from_j = gradient<R>(of_j, ij, k_j, F.j);
    const R mm = ij.own(of_mass) * ij(of_mass), P_i = ij.own(of_pressure), P_j = ij(of_pressure);
    if constexpr (Geometric) {
      const R VV = 0.5 * ij.own(of_volume) * ij(of_volume);
      const vec<R, D> both = from_i + from_j;
      from_i = scaled(R(VV * P_i), both);
      from_j = scaled(R(VV * P_j), both);
    } else {
      from_i = scaled(R(mm * ij.own(of_slope)), from_i);
      from_j = scaled(R(mm * ij(of_slope)), from_j);
    }
    const R v_x = ij.along(of_velocity), closing = lesser(R(v_x * ij.per_r), R(0.0));
    const R signal = ij.own(of_sound) + ij(of_sound) - 3.0 * closing;
    const R viscosity = viscous(ij, F, closing, signal);
    const R density = ij.own(of_density) + ij(of_density);
    using std::sqrt;
    const R speed = sqrt(R(2.0 * abs(P_i - P_j) / density));
    sum.force -= from_i + from_j + viscosity * ij.x_ij;
    sum.power += foundation::dot(from_i, ij.difference(of_velocity)) + 0.5 * viscosity * v_x +
                 conductivity * mm * speed * ij.difference(of_energy) / density * (F.i + F.j) * ij.r;
    keep_signal(sum, F, signal);
  }

 private:
  // Rounded, so that both ends have the same of a pair.
  template <class R>
  static vec<R, D> scaled(const R& factor, const vec<R, D>& a) {
    return vec<R, D>::of([&](std::size_t k) { return rounded(R(factor * a[k])); });
  }
  // G of one end, with the factor g.
  template <class R>
  static vec<R, D> gradient(const auto& end, const auto& ij, const end_kernel<R>& k, const R& F) {
    if constexpr (Integral)
      return integral_gradient<D>(end(of_integral), ij.x_ij, R(power<D>(R(end(of_per_support))) * k.W));
    else if constexpr (Geometric)
      return scaled(rounded(R(end(of_geometric) * F)), ij.x_ij);
    else
      return scaled(F, ij.x_ij);
  }
};

}  // namespace tetsuame::schemes
