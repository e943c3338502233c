// What runs are held against, ν the water's kinematic viscosity.
//
// A small standing wave on water of depth d on a floor that slips, wavenumber k = 2π/wavelength, ω² = (g k + σ k³/ρ)
// tanh kd [H. Lamb, Hydrodynamics, 6th ed. (1932), art. 228, 267]. With ν it moves as exp(st), 1/s [after Lamb, art.
// 349, where the water is deep; for a depth derived in docs/theory/waves_and_drops.md],
//   (s + 2νk²)² + ω² = 4ν²k³ m tanh kd coth md,   m² = k² + s/ν
// (ν → 0: s = iω - 2νk²). At an amplitude a it is faster by the part ½ (ka)² Ω₂/Ω [I. Tadjbakhsh, J. B. Keller, J.
// Fluid Mech. 8, 442 (1960)], Ω = √tanh kd:
//   Ω₂ = (9 Ω⁻⁷ - 12 Ω⁻³ - 3 Ω - 2 Ω⁵)/32
// It starts with the surface a sin ωt cos kx, velocity (a ω cos ωt/sinh kd) (-cosh ky sin kx, sinh ky cos kx).
//
// A drop of semi-axes a along x, b along y and velocity (-A x, A y), without gravity [J. J. Monaghan, J. Comput. Phys.
// 110, 399 (1994), section 5.1]:
//   da/dt = -A a,   db/dt = A b,   dA/dt = A² (a² - b²)/(a² + b²);   pressure ½ ρ A² (R² - r²) of the circle
//
// A round drop of radius R whose outline is a little out of round, as r^n, in vacuum, n = 2 [Lamb, art. 273 and 275;
// two dimensions: Rayleigh, Proc. R. Soc. London 29, 71 (1879)],
//   D = 2: ω² = n (n² - 1) σ/(ρ R³),   D = 3: ω² = n (n - 1) (n + 2) σ/(ρ R³)
// With ν [W. H. Reid, Q. Appl. Math. 18, 86 (1960); two dimensions derived in docs/theory/waves_and_drops.md] it moves
// as exp(st), with z² = s R²/ν,
//   s² + 2 (ν/R²) s [n (n-1) + n c (G-1) b] + ω² (1 + c b) = 0
//   D = 2: b = -2n (n-1)/(z² + 2n² - 2G),        c = 1,     G = z I'(z)/I(z) of the Bessel function I_n
//   D = 3: b = -2 (n-1)/(z² + 2n (n+1) - 2 - 2G), c = n + 1, G of z^(-½) I_(n+½)
// ν → 0: s = iω - 2n (n-1) ν/R², in three dimensions -(n-1) (2n+1) ν/R² [Lamb, art. 355].
#pragma once

#include <array>
#include <complex>
#include <optional>

namespace tetsuame::free_surface {

// s, of what moves as exp(rate·t); none where it does not swing.
std::optional<double> period_of(std::complex<double> rate);

struct standing_wave {
  double wavenumber, depth, gravity, amplitude;       // 1/m, m, m/s2, m
  double tension = 0.0;                               // m3/s2, σ/ρ
  double frequency() const;                           // 1/s, ω
  std::complex<double> rate(double viscosity) const;  // 1/s, s, of ν in m2/s
  double faster_by() const;                           // of the frequency, by the amplitude
  // s, of what starts with the amplitude, until then (s).
  std::optional<double> mean_period(double viscosity, double until) const;
  // m/s, when the surface is level and rises with its largest speed.
  std::array<double, 2> velocity(double x, double y) const;
};

struct round_drop {
  int dimension;
  double radius, tension;                             // m, m3/s2 (σ/ρ)
  double frequency() const;                           // 1/s, ω
  std::complex<double> rate(double viscosity) const;  // 1/s, s, of ν in m2/s
};

struct semi_axes {
  double a, b;  // m
};
semi_axes drawn_out(double radius, double strain_rate, double time);

}  // namespace tetsuame::free_surface
