// What runs are held against.
//
// A small standing wave on water of depth d, wavenumber k = 2π/wavelength [H. Lamb, Hydrodynamics, 6th ed. (1932)]:
//   ω² = (g k + σ k³/ρ) tanh kd (art. 228, 267);   energy ∝ exp(-4 ν k² t) (art. 348, where the floor is far away or
//   slips) surface a sin ωt cos kx, velocity (a ω cos ωt/sinh kd) (-cosh ky sin kx, sinh ky cos kx)
//
// A drop of semi-axes a along x, b along y and velocity (-A x, A y), without gravity [J. J. Monaghan, J. Comput. Phys.
// 110, 399 (1994), section 5.1]:
//   da/dt = -A a,   db/dt = A b,   dA/dt = A² (a² - b²)/(a² + b²);   pressure ½ ρ A² (R² - r²) of the circle
//
// A round drop of radius R whose outline is a little out of round, as r^n, in vacuum [Lamb, art. 273 and 275; two
// dimensions: Rayleigh, Proc. R. Soc. London 29, 71 (1879)], n = 2:
//   D = 2: ω² = n (n² - 1) σ/(ρ R³), amplitude ∝ exp(-2 n (n - 1) ν t/R²)
//   D = 3: ω² = n (n - 1) (n + 2) σ/(ρ R³), amplitude ∝ exp(-(n - 1) (2 n + 1) ν t/R²) [Lamb, art. 355]
#pragma once

#include <array>

namespace tetsuame::free_surface {

struct standing_wave {
  double wavenumber, depth, gravity, amplitude;  // 1/m, m, m/s2, m
  double tension = 0.0;                          // m3/s2, σ/ρ
  double frequency() const;                      // 1/s, ω
  double period() const;                         // s
  double energy_decay(double viscosity) const;   // 1/s, of ν in m2/s
  // m/s, when the surface is level and rises with its largest speed.
  std::array<double, 2> velocity(double x, double y) const;
};

struct round_drop {
  int dimension;
  double radius, tension;                // m, m3/s2 (σ/ρ)
  double period() const;                 // s
  double decay(double viscosity) const;  // 1/s, of the amplitude, of ν in m2/s
};

struct semi_axes {
  double a, b;  // m
};
semi_axes drawn_out(double radius, double strain_rate, double time);

}  // namespace tetsuame::free_surface
