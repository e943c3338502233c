#include <cmath>
#include <free_surface/exact.hpp>
#include <numbers>

namespace tetsuame::free_surface {

namespace {

using number = std::complex<double>;

// By secants from nearby.
template <class Function>
number root_of(number s, const Function& f) {
  number before = s * (1.0 + 1e-4), f_before = f(before);
  for (int n = 0; n < 100; ++n) {
    const number f_s = f(s);
    if (f_s == f_before) break;
    const number by = f_s * (s - before) / (f_s - f_before);
    before = s;
    f_before = f_s;
    s -= by;
    if (std::abs(by) < 1e-13 * std::abs(s)) break;
  }
  return s;
}

// z I'(z)/I(z) of the modified Bessel function of this order, by the continued fraction of I_(order+1)/I_order.
number bessel_slope(double order, const number& z) {
  number ratio = 0.0;
  for (double k = std::ceil(30.0 + 2.0 * std::abs(z)); k >= 0.0; k -= 1.0)
    ratio = 1.0 / (2.0 * (order + k + 1.0) / z + ratio);
  return order + z * ratio;
}

}  // namespace

std::optional<double> period_of(std::complex<double> rate) {
  const double w = std::abs(rate.imag());
  if (!(w > 1e-9 * std::abs(rate))) return {};
  return 2.0 * std::numbers::pi / w;
}

double standing_wave::frequency() const {
  const double k = wavenumber;
  return std::sqrt((gravity * k + tension * k * k * k) * std::tanh(k * depth));
}

std::complex<double> standing_wave::rate(double viscosity) const {
  const double k = wavenumber, w = frequency(), nu = viscosity, slow = 2.0 * nu * k * k, flat = std::tanh(k * depth);
  const number inviscid(-slow, w);
  if (!(nu > 0.0)) return inviscid;
  return root_of(inviscid, [&](const number& s) {
    const number m = std::sqrt(k * k + s / nu), at = s + slow;
    return at * at + w * w - slow * slow / k * m * flat / std::tanh(m * depth);
  });
}

double standing_wave::faster_by() const {
  const double steep = wavenumber * amplitude, w = std::sqrt(std::tanh(wavenumber * depth)), w3 = w * w * w;
  return 0.5 * steep * steep * (9.0 / (w3 * w3 * w) - 12.0 / w3 - 3.0 * w - 2.0 * w3 * w * w) / 32.0 / w;
}

std::array<double, 2> standing_wave::velocity(double x, double y) const {
  const double k = wavenumber, size = amplitude * frequency() / std::sinh(k * depth);
  return {-size * std::cosh(k * y) * std::sin(k * x), size * std::sinh(k * y) * std::cos(k * x)};
}

std::optional<double> standing_wave::mean_period(double viscosity, double until) const {
  const auto s = rate(viscosity);
  const double lost = -2.0 * s.real() * until, mean_square = lost > 0.0 ? -std::expm1(-lost) / lost : 1.0;
  const auto period = period_of(s);
  if (!period) return {};
  return *period / (1.0 + mean_square * faster_by());
}

double round_drop::frequency() const {
  return std::sqrt((dimension == 2 ? 6.0 : 8.0) * tension / (radius * radius * radius));
}

std::complex<double> round_drop::rate(double viscosity) const {
  constexpr double n = 2.0;
  const bool flat = dimension == 2;
  const double w = frequency(), slow = viscosity / (radius * radius);
  const number inviscid(-(flat ? 2.0 * n * (n - 1.0) : (n - 1.0) * (2.0 * n + 1.0)) * slow, w);
  if (!(viscosity > 0.0)) return inviscid;
  const double c = flat ? 1.0 : n + 1.0, of_b = flat ? 2.0 * n * n : 2.0 * n * (n + 1.0) - 2.0;
  return root_of(inviscid, [&](const number& s) {
    const number z2 = s / slow, G = bessel_slope(flat ? n : n + 0.5, std::sqrt(z2)) - (flat ? 0.0 : 0.5);
    const number b = -2.0 * (flat ? n : 1.0) * (n - 1.0) / (z2 + of_b - 2.0 * G);
    return s * s + 2.0 * slow * s * (n * (n - 1.0) + n * c * (G - 1.0) * b) + w * w * (1.0 + c * b);
  });
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
