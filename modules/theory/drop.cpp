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

void require_drop(const drop& d) {
  require(d.radius > 0.0, "the radius must be > 0 m", d.radius);
  require(d.viscosity > 0.0, "the viscosity must be > 0 Pa s", d.viscosity);
  require(d.gravity > 0.0, "gravity must be > 0 m/s^2", d.gravity);
}

}  // namespace

double mobility_factor(double viscosity_ratio) { return (2.0 + rigidity(viscosity_ratio)) / 3.0; }

double hadamard_rybczynski(const drop& d) {
  require_drop(d);
  return 2.0 / 9.0 * d.density_difference * d.gravity * d.radius * d.radius /
         (d.viscosity * mobility_factor(d.drop_viscosity / d.viscosity));
}

double tube_factor(double lambda, double viscosity_ratio) {
  require(lambda >= 0.0 && lambda <= 0.6, "radius over tube radius must lie in [0, 0.6]", lambda);
  // kappa/(1 + kappa) = r, 1/(1 + kappa) = 1 - r
  const double r = rigidity(viscosity_ratio);
  const double l2 = lambda * lambda, l3 = l2 * lambda, l5 = l3 * l2, l6 = l3 * l3;
  const double above = 1.0 - 0.7017 * (2.0 + r) * lambda + 2.0865 * r * l3 + 0.5689 * (2.0 - 5.0 * r) * l5 -
                       0.72603 * (1.0 - 2.0 * r) * l6;
  const double below = 1.0 + 2.2757 * (1.0 - 2.0 * r) / (2.0 + r) * l5;
  return above / below;
}

double plates_factor_rigid(double lambda) {
  require(lambda >= 0.0 && lambda <= 0.5, "radius over half the gap must lie in [0, 0.5]", lambda);
  const double l3 = lambda * lambda * lambda;
  return 1.0 - 1.004 * lambda + 0.418 * l3 + 0.21 * l3 * lambda - 0.169 * l3 * lambda * lambda;
}

double wall_factor_along(double lambda, double viscosity_ratio) {
  require(lambda >= 0.0 && lambda <= 0.3, "radius over distance of the wall must lie in [0, 0.3]", lambda);
  return 1.0 - 9.0 / 16.0 * mobility_factor(viscosity_ratio) * lambda;
}

double wall_factor_towards(double lambda, double viscosity_ratio) {
  require(lambda >= 0.0 && lambda <= 0.3, "radius over distance of the wall must lie in [0, 0.3]", lambda);
  return 1.0 - 9.0 / 8.0 * mobility_factor(viscosity_ratio) * lambda;
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

double rigid_terminal_velocity(const drop& d, double density_outside) {
  require_drop(d);
  require(density_outside > 0.0, "the density outside must be > 0 kg/m^3", density_outside);
  const double a = d.radius, weight = std::abs(d.density_difference) * d.gravity;
  const double to_reynolds = 2.0 * a * density_outside / d.viscosity;
  // Excess of weight over drag, per area: (4/3) a drho g - (1/2) C_D rho V^2, falling in V.
  const auto excess = [&](double V) {
    const double Re = to_reynolds * V;
    const double drag = Re > 1000.0 ? 0.5 * 0.44 * density_outside * V * V
                                    : 6.0 * d.viscosity * V / a * (1.0 + 0.15 * std::pow(Re, 0.687));
    return 4.0 / 3.0 * a * weight - drag;
  };
  double low = 0.0, high = 2.0 / 9.0 * weight * a * a / d.viscosity;  // Stokes' law is the fastest
  for (int i = 0; i < 200 && high - low > 1e-15 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (excess(middle) > 0.0 ? low : high) = middle;
  }
  return std::copysign(high, d.density_difference);
}

double capillary_length(double surface_tension, double density_difference, double gravity) {
  require(surface_tension >= 0.0, "the surface tension must be >= 0 N/m", surface_tension);
  require(density_difference != 0.0 && gravity > 0.0, "density difference times gravity must not be 0", gravity);
  return std::sqrt(surface_tension / (std::abs(density_difference) * gravity));
}

double weber_radius(double surface_tension, double density_difference, double gravity, double critical_weber,
                    double drag_coefficient) {
  require(critical_weber > 0.0, "the critical Weber number must be > 0", critical_weber);
  require(drag_coefficient > 0.0, "the drag coefficient must be > 0", drag_coefficient);
  return std::sqrt(3.0 / 16.0 * critical_weber * drag_coefficient) *
         capillary_length(surface_tension, density_difference, gravity);
}

double largest_radius(double surface_tension, double density_difference, double gravity) {
  return 2.0 * capillary_length(surface_tension, density_difference, gravity);
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

double settling_time(double depth, double velocity) {
  require(depth >= 0.0 && velocity > 0.0, "depth must be >= 0 m and velocity > 0 m/s", velocity);
  return depth / velocity;
}

double response_time(const drop& d, double drop_density, double density_outside) {
  require_drop(d);
  return 2.0 * (drop_density + 0.5 * density_outside) * d.radius * d.radius /
         (9.0 * d.viscosity * mobility_factor(d.drop_viscosity / d.viscosity));
}

double hindered_settling_exponent(double reynolds) {
  require(reynolds >= 0.0, "the Reynolds number must be >= 0", reynolds);
  if (reynolds < 0.2) return 4.65;
  if (reynolds < 1.0) return 4.35 * std::pow(reynolds, -0.03);
  if (reynolds < 500.0) return 4.45 * std::pow(reynolds, -0.1);
  return 2.39;
}

double hindered_settling_factor(double c, double reynolds) {
  require(c >= 0.0 && c <= 0.6, "the volume fraction must lie in [0, 0.6]", c);
  return std::pow(1.0 - c, hindered_settling_exponent(reynolds));
}

}  // namespace tetsuame::theory
