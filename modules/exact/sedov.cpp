#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <cmath>
#include <exact/sedov.hpp>
#include <foundation/error.hpp>
#include <numbers>

namespace tetsuame::exact {

namespace {

using similarity_state = std::array<double, 3>;  // ln z, ln g, integral of the energy from lambda to 1

// phi, g and h of a state at lambda.
sedov::similarity values(double gamma, double ln_z, double ln_g, double lambda) {
  const double z = std::exp(ln_z), phi = (1.0 + z) / gamma, g = std::exp(ln_g);
  const double m = 0.5 * (gamma - 1.0) * phi * phi * (1.0 - phi);
  return {phi, g, std::exp(ln_g - ln_z + 2.0 * std::log(lambda)) * m};
}

struct similarity_slopes {
  double D, gamma;

  void operator()(const similarity_state& y, similarity_state& by_s, double s) const {
    const double z = std::exp(y[0]), phi = (1.0 + z) / gamma, rest = 1.0 - phi;
    const double m = 0.5 * (gamma - 1.0) * phi * phi * rest;
    by_s[0] =
        gamma * phi * rest * (0.5 * D + 1.0 - phi - 0.5 * D * (gamma - 1.0) * phi) / (gamma * m - z * rest * rest);
    by_s[1] = (by_s[0] * z / gamma + D * phi) / rest;
    const double lambda = std::exp(s);
    const sedov::similarity v = values(gamma, y[0], y[1], lambda);
    by_s[2] = -std::pow(lambda, D) * (0.5 * v.g * lambda * lambda * phi * phi + v.h / (gamma - 1.0));
  }
};

}  // namespace

sedov::sedov(int dimension, double gamma) : dimension_(dimension), gamma_(gamma) {
  if (dimension < 1 || dimension > 3 || !(gamma > 1.0 && std::isfinite(gamma)) || (dimension == 3 && gamma >= 7.0))
    foundation::fail_input(
        fmt::format("Sedov explosion: dimension {} and gamma {:g}; dimension 1, 2 or 3 and gamma above 1 "
                    "are needed, below 7 in 3-D (the centre is hollow from there)",
                    dimension, gamma));
  namespace odeint = boost::numeric::odeint;
  constexpr int intervals = 4096;
  const double D = dimension, tail = 2.0 + D / (gamma - 1.0);
  // To where z has fallen to about e^-40: below, the powers of the centre hold to rounding.
  step_ = 40.0 / tail / intervals;
  const similarity_slopes system{D, gamma};
  // Behind a strong shock phi = 2/(gamma+1), g = (gamma+1)/(gamma-1).
  similarity_state y{std::log((gamma - 1.0) / (gamma + 1.0)), std::log((gamma + 1.0) / (gamma - 1.0)), 0.0};
  // One step an interval: 40/4096 of a scale height of z, to the 8th power, is below rounding.
  odeint::runge_kutta_fehlberg78<similarity_state> stepper;
  table_.reserve(intervals + 1);
  for (int k = 0;; ++k) {
    const double s = -k * step_;
    similarity_state by_s;
    system(y, by_s, s);
    table_.push_back({y[0], y[1], by_s[0], by_s[1]});
    if (k == intervals) break;
    stepper.do_step(system, y, s, -step_);
  }
  const double last = -intervals * step_;
  const double core = values(gamma, y[0], y[1], std::exp(last)).h * std::exp(D * last) / (D * (gamma - 1.0));
  const double surface = dimension == 1 ? 2.0 : dimension == 2 ? 2.0 * std::numbers::pi : 4.0 * std::numbers::pi;
  alpha_ = surface * (y[2] + core) * 4.0 / ((D + 2.0) * (D + 2.0));
}

double sedov::shock_radius(double energy, double rho0, double t) const {
  return std::pow(energy * t * t / (alpha_ * rho0), 1.0 / (dimension_ + 2.0));
}

double sedov::shock_speed(double energy, double rho0, double t) const {
  return 2.0 * shock_radius(energy, rho0, t) / ((dimension_ + 2.0) * t);
}

sedov::similarity sedov::profile(double lambda) const {
  const double x = std::max(-std::log(lambda) / step_, 0.0);
  const auto k = static_cast<std::size_t>(x);
  if (!(x < static_cast<double>(table_.size() - 1))) {
    const double beyond = -(x - static_cast<double>(table_.size() - 1)) * step_;  // ln(lambda/lambda_last)
    const node& n = table_.back();
    return values(gamma_, n.ln_z + (2.0 + dimension_ / (gamma_ - 1.0)) * beyond,
                  n.ln_g + dimension_ / (gamma_ - 1.0) * beyond, lambda);
  }
  const double a = x - static_cast<double>(k), b = 1.0 - a;
  const node &n = table_[k], &m = table_[k + 1];
  const auto hermite = [&](double from, double from_slope, double to, double to_slope) {
    return b * b * (1.0 + 2.0 * a) * from + a * a * (1.0 + 2.0 * b) * to -
           step_ * a * b * (b * from_slope - a * to_slope);  // the table runs towards smaller ln lambda
  };
  return values(gamma_, hermite(n.ln_z, n.ln_z_slope, m.ln_z, m.ln_z_slope),
                hermite(n.ln_g, n.ln_g_slope, m.ln_g, m.ln_g_slope), lambda);
}

riemann::primitive sedov::at(double r, double t, double energy, double rho0) const {
  const double r_s = shock_radius(energy, rho0, t), u_s = shock_speed(energy, rho0, t);
  if (r > r_s) return {rho0, 0.0, 0.0};
  // h is constant in the centre, where z and g lambda^2 would be below all doubles.
  const double lambda = std::max(r / r_s, std::exp(-2.0 * step_ * static_cast<double>(table_.size())));
  const similarity v = profile(lambda);
  const double centre = r / r_s / lambda;  // 1 but there
  return {rho0 * v.g * std::pow(centre, dimension_ / (gamma_ - 1.0)), u_s * r / r_s * v.phi, rho0 * u_s * u_s * v.h};
}

}  // namespace tetsuame::exact
