#include <cmath>
#include <exact/flows.hpp>
#include <numbers>

namespace tetsuame::exact {

primitive shock_tube::at(double x, double t) const {
  if (t > 0.0) return riemann::sample(left_, right_, between_, x / t);
  const riemann::side<double>& s = x < 0.0 ? left_ : right_;
  return {s.rho, s.u, s.p};
}

double noh::shock_radius(double t) const { return 0.5 * (gamma - 1.0) * u0 * t; }

primitive noh::at(double r, double t) const {
  if (r < shock_radius(t)) {
    const double rho = rho0 * std::pow((gamma + 1.0) / (gamma - 1.0), dimension);
    return {rho, 0.0, 0.5 * (gamma - 1.0) * rho * u0 * u0};
  }
  return {rho0 * std::pow(1.0 + u0 * t / r, dimension - 1), -u0, 0.0};
}

double gresho::velocity(double r) const {
  const double q = r / radius;
  return speed * (q < 1.0 ? q : q < 2.0 ? 2.0 - q : 0.0);
}

double gresho::pressure(double r) const {
  const double q = r / radius, inner = 0.5 * q * q;
  const double rise = q < 1.0   ? inner
                      : q < 2.0 ? 4.0 - 4.0 * q + inner + 4.0 * std::log(q)
                                : 4.0 * std::numbers::ln2 - 2.0;
  return p0 + rho * speed * speed * rise;
}

}  // namespace tetsuame::exact
