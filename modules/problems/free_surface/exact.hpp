// What runs are held against.
//
// A small standing wave on water of depth d, wavenumber k = 2π/wavelength [H. Lamb, Hydrodynamics, 6th ed. (1932)]:
//   ω² = g k tanh kd (art. 228);   energy ∝ exp(-4 ν k² t) (art. 348, where the floor is far away or slips)
//   surface a sin ωt cos kx, velocity (a ω cos ωt/sinh kd) (-cosh ky sin kx, sinh ky cos kx)
//
// A drop of semi-axes a along x, b along y and velocity (-A x, A y), without gravity [J. J. Monaghan, J. Comput. Phys.
// 110, 399 (1994), section 5.1]:
//   da/dt = -A a,   db/dt = A b,   dA/dt = A² (a² - b²)/(a² + b²);   pressure ½ ρ A² (R² - r²) of the circle
#pragma once

#include <array>

namespace tetsuame::free_surface {

struct standing_wave {
  double wavenumber, depth, gravity, amplitude;  // 1/m, m, m/s2, m
  double frequency() const;                      // 1/s, ω
  double period() const;                         // s
  double energy_decay(double viscosity) const;   // 1/s, of ν in m2/s
  // m/s, when the surface is level and rises with its largest speed.
  std::array<double, 2> velocity(double x, double y) const;
};

struct semi_axes {
  double a, b;  // m
};
semi_axes drawn_out(double radius, double strain_rate, double time);

}  // namespace tetsuame::free_surface
