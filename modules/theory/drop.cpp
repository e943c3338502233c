#include <cmath>
#include <theory/drop.hpp>

namespace tetsuame::theory {

namespace {

// kappa/(1 + kappa), 0 for a gas bubble, 1 for a rigid sphere; well defined at infinity.
double rigidity(double viscosity_ratio) {
  return std::isinf(viscosity_ratio) ? 1.0 : viscosity_ratio / (1.0 + viscosity_ratio);
}

// Drag of a fluid sphere over that of a rigid one, (2 + 3 kappa)/(3 + 3 kappa), 2/3 to 1.
double mobility_factor(double viscosity_ratio) { return (2.0 + rigidity(viscosity_ratio)) / 3.0; }

}  // namespace

double hadamard_rybczynski(const drop& d) {
  return 2.0 / 9.0 * d.density_difference * d.gravity * d.radius * d.radius /
         (d.viscosity * mobility_factor(d.drop_viscosity / d.viscosity));
}

double cubic_array_factor(double c, double viscosity_ratio) {
  return 1.0 - 1.7601 * mobility_factor(viscosity_ratio) * std::cbrt(c) + rigidity(viscosity_ratio) * c;
}

double square_array_velocity(double c, double viscosity_ratio) {
  const double r = rigidity(viscosity_ratio);
  return 0.25 * (-0.5 * std::log(c) - 0.7381 + 0.5 * (1.0 - r) + c * r);
}

double largest_radius(double surface_tension, double density_difference, double gravity) {
  return 2.0 * std::sqrt(surface_tension / (std::abs(density_difference) * gravity));
}

double oscillation_frequency(int n, int dimension, double surface_tension, double radius, double density,
                             double density_outside) {
  const double m = n, stiffness = surface_tension * m * (m * m - 1.0) / (radius * radius * radius);
  return std::sqrt(dimension == 2 ? stiffness / (density + density_outside)
                                  : stiffness * (m + 2.0) / ((m + 1.0) * density + m * density_outside));
}

double hindered_settling_factor(double c, double reynolds) {
  const double n = reynolds < 0.2     ? 4.65
                   : reynolds < 1.0   ? 4.35 * std::pow(reynolds, -0.03)
                   : reynolds < 500.0 ? 4.45 * std::pow(reynolds, -0.1)
                                      : 2.39;
  return std::pow(1.0 - c, n);
}

}  // namespace tetsuame::theory
