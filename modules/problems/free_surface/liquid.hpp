// Weakly compressible water [J. J. Monaghan, J. Comput. Phys. 110, 399 (1994)], s = ρ/ρ0:
//   p = B (s^γ - 1),   B = c0² ρ0/γ,   c = c0 s^((γ-1)/2)
//   e = ∫ p/ρ² dρ = B/ρ0 [s^(γ-1)/(γ-1) + 1/s - γ/(γ-1)],   γ = 1: c0² [ln s + 1/s - 1]
// At rest under its own weight, a depth d beneath the surface, where dp/dd = ρ g:
//   s^(γ-1) = 1 + (γ-1) g d/c0²,   γ = 1: s = exp(g d/c0²)
// Compiled once, without fused multiplications: the density of a particle and of its copies gives the same bits.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tetsuame::free_surface {

struct liquid {
  double density = 1000.0;  // kg/m3, ρ0
  double sound = 0.0;       // m/s, c0
  std::int64_t exponent = 7;

  double pressure(double rho) const;        // Pa
  double density_at(double p) const;        // kg/m3
  double density_beneath(double gd) const;  // kg/m3, g d in J/kg
  double elastic_energy(double rho) const;  // J/kg, e
};

// Pressure (Pa) and volume (m^D) of particles [first, last), of their densities and masses (kg/m3, kg).
void find_pressures(const liquid& water, std::size_t first, std::size_t last, const double* rho, const double* m,
                    double* p, double* V);

}  // namespace tetsuame::free_surface
