#include <fmt/format.h>

#include <cmath>
#include <foundation/error.hpp>
#include <theory/drop.hpp>

namespace tetsuame::theory {

namespace {

void require(bool good, const char* what, double value) {
  if (!good) foundation::fail_input(fmt::format("drop theory: {}, not {}", what, value));
}

// kappa/(1 + kappa), 0 for a gas bubble, 1 for a rigid sphere; well defined at infinity.
double rigidity(double viscosity_ratio) {
  require(viscosity_ratio >= 0.0, "the viscosity ratio must be >= 0", viscosity_ratio);
  return std::isinf(viscosity_ratio) ? 1.0 : viscosity_ratio / (1.0 + viscosity_ratio);
}

// Drag of a fluid sphere over that of a rigid one, (2 + 3 kappa)/(3 + 3 kappa), 2/3 to 1.
double mobility_factor(double viscosity_ratio) { return (2.0 + rigidity(viscosity_ratio)) / 3.0; }

}  // namespace

double hadamard_rybczynski(const drop& d) {
  require(d.radius > 0.0, "the radius must be > 0 m", d.radius);
  require(d.viscosity > 0.0, "the viscosity must be > 0 Pa s", d.viscosity);
  require(d.gravity > 0.0, "gravity must be > 0 m/s^2", d.gravity);
  return 2.0 / 9.0 * d.density_difference * d.gravity * d.radius * d.radius /
         (d.viscosity * mobility_factor(d.drop_viscosity / d.viscosity));
}

double cubic_array_factor(double c, double viscosity_ratio) {
  require(c >= 0.0 && c <= 0.1, "the volume fraction must lie in [0, 0.1]", c);
  return 1.0 - 1.7601 * mobility_factor(viscosity_ratio) * std::cbrt(c) + rigidity(viscosity_ratio) * c;
}

double square_array_velocity(double c, double viscosity_ratio) {
  require(c > 0.0 && c <= 0.1, "the area fraction must lie in (0, 0.1]", c);
  const double r = rigidity(viscosity_ratio);
  return 0.25 * (-0.5 * std::log(c) - 0.7381 + 0.5 * (1.0 - r) + c * r);
}

double largest_radius(double surface_tension, double density_difference, double gravity) {
  require(surface_tension >= 0.0, "the surface tension must be >= 0 N/m", surface_tension);
  require(density_difference != 0.0 && gravity > 0.0, "density difference times gravity must not be 0", gravity);
  return 2.0 * std::sqrt(surface_tension / (std::abs(density_difference) * gravity));
}

double oscillation_frequency(int n, int dimension, double surface_tension, double radius, double density,
                             double density_outside) {
  require(n >= 2, "a drop oscillates with n >= 2", n);
  require(dimension == 2 || dimension == 3, "the dimension must be 2 or 3", dimension);
  require(surface_tension >= 0.0, "the surface tension must be >= 0 N/m", surface_tension);
  require(radius > 0.0, "the radius must be > 0 m", radius);
  require(density >= 0.0 && density_outside >= 0.0 && density + density_outside > 0.0,
          "the densities must be >= 0 kg/m3, and not both 0", density);
  const double m = n, stiffness = surface_tension * m * (m * m - 1.0) / (radius * radius * radius);
  return std::sqrt(dimension == 2 ? stiffness / (density + density_outside)
                                  : stiffness * (m + 2.0) / ((m + 1.0) * density + m * density_outside));
}

double hindered_settling_factor(double c, double reynolds) {
  require(c >= 0.0 && c <= 0.6, "the volume fraction must lie in [0, 0.6]", c);
  require(reynolds >= 0.0, "the Reynolds number must be >= 0", reynolds);
  const double n = reynolds < 0.2     ? 4.65
                   : reynolds < 1.0   ? 4.35 * std::pow(reynolds, -0.03)
                   : reynolds < 500.0 ? 4.45 * std::pow(reynolds, -0.1)
                                      : 2.39;
  return std::pow(1.0 - c, n);
}

}  // namespace tetsuame::theory
