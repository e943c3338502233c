// What a particle's place and state say alone: temperature of conduction, buoyancy, viscosity, inertia.
#pragma once

#include <cmath>
#include <convection/options.hpp>

namespace tetsuame::convection {

// K, the conductive profile; y: m above the bottom.
inline double reference_temperature(const parameters& layer, double y) {
  return layer.T_bottom - layer.fluid.dT * y / layer.fluid.L;
}

// b = α g (T - T_ref) - g q p/K₀, m/s2 upwards, or by an equation of state; q: 0, 1 (separated gravity density [S1
// (64)]), ζ² (conventional density).
inline double buoyancy(const parameters& layer, double y, double T, double p) {
  if (layer.weighed) return layer.weighed->buoyancy(y, T, p, layer.compressibility);
  const auto& f = layer.fluid;
  return f.alpha * f.g * (T - reference_temperature(layer, y)) - f.g * layer.compressibility * p / f.K;
}

// ∂b/∂T, m/(s2 K): what rises cools by it, times T v_y/c_p.
inline double buoyancy_slope(const parameters& layer, double y, double T) {
  return layer.weighed ? layer.weighed->slope(y, T) : layer.fluid.alpha * layer.fluid.g;
}

inline double viscosity(const parameters& layer, double y, double T) {  // m2/s
  return layer.law.varies ? layer.nu * std::exp(layer.reached * layer.law.log(T, y)) : layer.nu;
}

// ξ² where the viscosity is ν.
inline double inertia(const parameters& layer, double nu) {
  return layer.steady ? nu / layer.nu_eff : layer.slowing.xi * layer.slowing.xi;
}

}  // namespace tetsuame::convection
