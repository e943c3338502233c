#include <cmath>
#include <free_surface/exact.hpp>
#include <numbers>

namespace tetsuame::free_surface {

double standing_wave::frequency() const {
  const double k = wavenumber;
  return std::sqrt((gravity * k + tension * k * k * k) * std::tanh(k * depth));
}

double standing_wave::period() const { return 2.0 * std::numbers::pi / frequency(); }

double standing_wave::energy_decay(double viscosity) const { return 4.0 * viscosity * wavenumber * wavenumber; }

std::array<double, 2> standing_wave::velocity(double x, double y) const {
  const double k = wavenumber, size = amplitude * frequency() / std::sinh(k * depth);
  return {-size * std::cosh(k * y) * std::sin(k * x), size * std::sinh(k * y) * std::cos(k * x)};
}

double round_drop::period() const {
  const double cubed = radius * radius * radius;
  return 2.0 * std::numbers::pi / std::sqrt((dimension == 2 ? 6.0 : 8.0) * tension / cubed);
}

double round_drop::decay(double viscosity) const {
  return (dimension == 2 ? 4.0 : 5.0) * viscosity / (radius * radius);
}

// By the classical Runge-Kutta method, in steps of a hundredth of 1/A at most.
semi_axes drawn_out(double radius, double strain_rate, double time) {
  using state = std::array<double, 3>;  // a, b, A
  const auto rate = [](const state& y) {
    const double a2 = y[0] * y[0], b2 = y[1] * y[1];
    return state{-y[2] * y[0], y[2] * y[1], y[2] * y[2] * (a2 - b2) / (a2 + b2)};
  };
  const auto beyond = [](state y, double dt, const state& f) {
    for (std::size_t k = 0; k < 3; ++k) y[k] += dt * f[k];
    return y;
  };
  const double steps = std::ceil(100.0 * strain_rate * time) + 1.0, dt = time / steps;
  state y{radius, radius, strain_rate};
  for (double n = 0.0; n < steps; n += 1.0) {
    const state k1 = rate(y), k2 = rate(beyond(y, 0.5 * dt, k1)), k3 = rate(beyond(y, 0.5 * dt, k2)),
                k4 = rate(beyond(y, dt, k3));
    for (std::size_t k = 0; k < 3; ++k) y[k] += dt * (k1[k] + 2.0 * k2[k] + 2.0 * k3[k] + k4[k]) / 6.0;
  }
  return {y[0], y[1]};
}

}  // namespace tetsuame::free_surface
