// Friction and conduction of a gas, by the sums of module diffusion:
//
//   ρ dv/dt ⊃ ∇·[μ (∇v + ∇vᵀ - ⅔ ∇·v) + ζ ∇·v]     ρ du/dt ⊃ ∇·(k ∇T) + heat of friction
//
// With μ and ζ the same everywhere the force is μ ∇²v + (ζ + μ/3) ∇(∇·v), which is that of two sums,
//
//   (μ - c) times ∇²v, c times ∇²v + 2 ∇(∇·v),   c = ½ (ζ + μ/3)
//
// whose kernel is the mean of both ends'. Both heat, for 0 <= c <= μ, and what a pair loses in motion it gains in heat:
// momentum and energy are kept (docs/theory/viscous_gas.md). Free slip at walls, whose images are even.
#pragma once

#include <diffusion/conduction.hpp>
#include <diffusion/viscosity.hpp>
#include <schemes/common.hpp>

namespace tetsuame::schemes {

// A pair whose kernel is the mean of both ends'.
template <class Pair, class R>
struct with_mean_slope {
  const Pair& of;
  decltype(Pair::x_ij) x_ij;
  R r2, F;

  auto operator()(auto tag) const { return of(tag); }
  auto own(auto tag) const { return of.own(tag); }
  auto difference(auto tag) const { return of.difference(tag); }
  R along(auto tag) const { return of.along(tag); }
};

// A sum of one kernel, for supports that differ.
template <int D, class Kernel, class Term>
struct of_mean_kernel {
  Kernel unit;
  fields<D> g;
  Term term;

  auto reads() const { return std::tuple_cat(g.read(of_per_support), term.reads()); }
  template <class R>
  auto begin(const pairs::cluster<R>& i) const {
    return term.begin(i);
  }
  void add(auto& a, const auto& ij) const {
    using pair = std::remove_cvref_t<decltype(ij)>;
    using R = std::remove_cvref_t<decltype(ij.r)>;
    const auto F = slopes_of<D>(unit, ij);
    term.add(a, with_mean_slope<pair, R>{ij, ij.x_ij, ij.r2, rounded(R(0.5 * (F.i + F.j)))});
  }
  void end(const auto& i, const auto& a) const { term.end(i, a); }
};

struct transport {
  double viscosity = 0.0, bulk_viscosity = 0.0;  // Pa s: μ, ζ
  double heat_conductivity = 0.0;                // W/(m K)

  bool any() const { return viscosity > 0.0 || bulk_viscosity > 0.0 || heat_conductivity > 0.0; }
  bool rubs() const { return viscosity > 0.0 || bulk_viscosity > 0.0; }
  bool conducts() const { return heat_conductivity > 0.0; }
  double symmetric() const { return 0.5 * (bulk_viscosity + viscosity / 3.0); }  // c
  double along() const { return 4.0 / 3.0 * viscosity + bulk_viscosity; }        // of sound
  // Of no wave is the friction larger.
  double largest(int D) const { return viscosity + (D + 1.0) * symmetric(); }
};

}  // namespace tetsuame::schemes
