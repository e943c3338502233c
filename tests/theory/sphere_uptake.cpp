#include <foundation/error.hpp>
#include <numbers>
#include <theory/sphere_uptake.hpp>

#include "close.hpp"

namespace theory = tetsuame::theory;

namespace {

constexpr double pi = std::numbers::pi;

// Mean concentration from its definition, 3 int c r^2 dr, by Simpson's rule.
double mean_of_profile(double fourier) {
  constexpr int n = 400;
  double sum = 0.0;
  for (int i = 0; i <= n; ++i) {
    const double r = static_cast<double>(i) / n;
    sum += (i == 0 || i == n ? 1.0 : i % 2 ? 4.0 : 2.0) * theory::concentration(r, fourier) * r * r;
  }
  return 3.0 * sum / (3.0 * n);
}

// Finite volumes in shells, implicit steps: surroundings of limited volume.
double limited_by_shells(double fourier, double alpha, int shells, int steps) {
  std::vector<double> c(static_cast<std::size_t>(shells), 0.0), lower, diagonal, right;
  const double d = 1.0 / shells, dt = fourier / steps;
  double surface = 1.0;
  for (int s = 0; s < steps; ++s) {
    // Thomas algorithm; the surface value is that of the last step.
    std::vector<double> up(c.size()), value(c.size());
    for (std::size_t i = 0; i < c.size(); ++i) {
      const double r0 = static_cast<double>(i) * d, r1 = r0 + d, volume = (r1 * r1 * r1 - r0 * r0 * r0) / 3.0;
      const bool last = i + 1 == c.size();
      const double in = i == 0 ? 0.0 : r0 * r0 / d, out = last ? 2.0 * r1 * r1 / d : r1 * r1 / d;
      const double middle = volume / dt + in + out;
      const double rhs = volume / dt * c[i] + (last ? out * surface : 0.0);
      const double pivot = middle - (i == 0 ? 0.0 : in * up[i - 1]);
      up[i] = last ? 0.0 : out / pivot;
      value[i] = (rhs + (i == 0 ? 0.0 : in * value[i - 1])) / pivot;
    }
    double mean = 0.0;
    for (std::size_t i = c.size(); i-- > 0;) {
      c[i] = value[i] + (i + 1 < c.size() ? up[i] * c[i + 1] : 0.0);
      const double r0 = static_cast<double>(i) * d, r1 = r0 + d;
      mean += c[i] * (r1 * r1 * r1 - r0 * r0 * r0);
    }
    surface = 1.0 - mean / alpha;
  }
  return (1.0 - surface) * (1.0 + alpha);
}

}  // namespace

BOOST_AUTO_TEST_CASE(constant_surface) {
  for (const double t : {1e-3, 0.01, 0.0499999, 0.0500001, 0.2})
    BOOST_TEST(close(mean_of_profile(t), theory::uptake(t), 1e-6));
  // Early and late forms in themselves.
  BOOST_TEST(close(theory::uptake(1e-8), 6.0 * std::sqrt(1e-8 / pi) - 3e-8, 1e-12));
  BOOST_TEST(close(1.0 - theory::uptake(1.0), 6.0 / (pi * pi) * std::exp(-pi * pi), 1e-9));
  BOOST_TEST(close(theory::uptake(0.05 - 1e-12), theory::uptake(0.05), 1e-9));
  for (const double r : {0.0, 0.3, 0.9}) {
    BOOST_TEST(close(theory::concentration(r, 0.05 - 1e-12), theory::concentration(r, 0.05), 1e-8));
    // dc/dt = (1/r)(r c)'' by differences
    const double at = r == 0.0 ? 0.01 : r, h = 1e-3, dt = 1e-6;
    for (const double t : {0.03, 0.1}) {
      const auto rc = [&](double x) { return x * theory::concentration(x, t); };
      const double laplacian = (rc(at + h) + rc(at - h) - 2.0 * rc(at)) / (h * h * at);
      BOOST_TEST(
          close((theory::concentration(at, t + dt) - theory::concentration(at, t - dt)) / (2.0 * dt), laplacian, 1e-3));
    }
  }
  BOOST_CHECK_THROW(theory::uptake(-1.0), tetsuame::foundation::error);
}

BOOST_AUTO_TEST_CASE(limited_surroundings) {
  BOOST_TEST(close(theory::limited_uptake(0.05, 1e9), theory::uptake(0.05), 1e-7));
  BOOST_TEST(close(theory::limited_uptake(0.05, 1.0), limited_by_shells(0.05, 1.0, 200, 4000), 2e-3));
  BOOST_CHECK_THROW(theory::limited_uptake(1e-12, 1.0), tetsuame::foundation::error);
}

BOOST_AUTO_TEST_CASE(changing_surface) {
  // Constant: the series again, whatever the steps.
  const std::vector<double> times{0.0, 1e-3, 0.01, 0.05, 0.3}, ones(5, 1.0);
  const std::vector<double> constant = theory::uptake_history(times, ones, 0.0);
  for (std::size_t i = 0; i < times.size(); ++i) BOOST_TEST(close(constant[i], theory::uptake(times[i]), 1e-9));
  // A ramp is Duhamel's integral of the step's answer: mean(t) = int_0^t uptake(s) ds, by Simpson's rule in sqrt s.
  const double end = 0.2;
  double integral = 0.0;
  constexpr int n = 2000;
  for (int i = 0; i <= n; ++i) {
    const double z = std::sqrt(end) * i / n;
    integral += (i == 0 || i == n ? 1.0 : i % 2 ? 4.0 : 2.0) * theory::uptake(z * z) * 2.0 * z;
  }
  integral *= std::sqrt(end) / (3.0 * n);
  const std::vector<double> ramp_times{0.0, 0.07, end}, ramp{0.0, 0.07, end};
  BOOST_TEST(close(theory::uptake_history(ramp_times, ramp, 0.0).back(), integral, 1e-8));
  BOOST_CHECK_THROW(theory::uptake_history(times, ramp, 0.0), tetsuame::foundation::error);
}

BOOST_AUTO_TEST_CASE(partition_coefficients) {
  // By hand: 1.06 + 1553/2500 - 98*10/2500 = 1.2892
  BOOST_TEST(close(theory::exchange_coefficient(theory::nickel, 10e9, 2500.0), std::pow(10.0, 1.2892), 1e-12));
  BOOST_TEST(
      close(theory::partition_coefficient(theory::nickel, 10e9, 2500.0, 12.0), 12.0 * std::pow(10.0, 1.2892), 1e-12));
  // Less siderophile with depth, nickel more so than cobalt: they meet, as in the mantle, at tens of GPa.
  const auto ratio = [](double p, double T) {
    return theory::exchange_coefficient(theory::nickel, p, T) / theory::exchange_coefficient(theory::cobalt, p, T);
  };
  BOOST_TEST(ratio(1e5, 2000.0) > 4.0);
  BOOST_TEST(ratio(50e9, 3500.0) < 0.6 * ratio(1e5, 2000.0));
}
