#include <fmt/format.h>

#include <cmath>
#include <foundation/error.hpp>
#include <numbers>
#include <theory/sphere_uptake.hpp>

namespace tetsuame::theory {

namespace {

using std::numbers::inv_sqrtpi;
using std::numbers::pi;

constexpr double early = 0.05;  // below, the series of reflections; above, that of eigenfunctions

double ierfc(double x) { return inv_sqrtpi * std::exp(-x * x) - x * std::erfc(x); }

void require(bool good, const char* what, double value) {
  if (!good) foundation::fail_input(fmt::format("uptake of a sphere: {}, not {}", what, value));
}

}  // namespace

double uptake(double fourier) {
  require(fourier >= 0.0, "the time must be >= 0", fourier);
  if (fourier == 0.0) return 0.0;
  if (fourier < early) {
    const double root = std::sqrt(fourier);
    double sum = inv_sqrtpi;
    for (int n = 1; n <= 4; ++n) sum += 2.0 * ierfc(n / root);
    return 6.0 * root * sum - 3.0 * fourier;
  }
  double sum = 0.0;
  for (int n = 1; n <= 10; ++n) sum += std::exp(-n * n * pi * pi * fourier) / (n * n);
  return 1.0 - 6.0 / (pi * pi) * sum;
}

double concentration(double r_over_a, double fourier) {
  require(r_over_a >= 0.0 && r_over_a <= 1.0, "r/a must lie in [0, 1]", r_over_a);
  require(fourier >= 0.0, "the time must be >= 0", fourier);
  const double r = r_over_a;
  if (r == 1.0) return 1.0;
  if (fourier == 0.0) return 0.0;
  if (fourier < early) {
    const double half = 0.5 / std::sqrt(fourier);
    double sum = 0.0;
    for (int n = 0; n <= 4; ++n) {
      const double odd = 2.0 * n + 1.0;
      // At the centre (erfc(A - x) - erfc(A + x))/x becomes -2 erfc'(A).
      sum += r < 1e-6 ? 4.0 * half * inv_sqrtpi * std::exp(-half * half * odd * odd)
                      : (std::erfc((odd - r) * half) - std::erfc((odd + r) * half)) / r;
    }
    return sum;
  }
  double sum = 0.0;
  for (int n = 1; n <= 10; ++n) {
    const double shape = r < 1e-6 ? n * pi : std::sin(n * pi * r) / r;
    sum += (n % 2 ? -1.0 : 1.0) / n * shape * std::exp(-n * n * pi * pi * fourier);
  }
  return 1.0 + 2.0 / pi * sum;
}

double limited_uptake(double fourier, double alpha) {
  require(fourier >= 0.0, "the time must be >= 0", fourier);
  require(alpha > 0.0, "alpha must be > 0", alpha);
  if (fourier == 0.0) return 0.0;
  // tan q = 3 q/(3 + alpha q^2) has one root in each (n pi, n pi + pi/2).
  const auto excess = [&](double q) { return std::sin(q) * (3.0 + alpha * q * q) - 3.0 * q * std::cos(q); };
  const auto root = [&](int n) {
    double low = n * pi, high = low + 0.5 * pi;
    const bool rises = excess(high) > 0.0;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      ((excess(middle) > 0.0) == rises ? high : low) = middle;
    }
    return 0.5 * (low + high);
  };
  constexpr int most = 20000;
  double sum = 0.0;
  for (int n = 1; n <= most; ++n) {
    const double q = root(n), decay = q * q * fourier;
    sum += 6.0 * alpha * (1.0 + alpha) * std::exp(-decay) / (9.0 + 9.0 * alpha + q * q * alpha * alpha);
    if (decay > 40.0) return 1.0 - sum;
  }
  foundation::fail_input(fmt::format("uptake of a sphere: D t/a^2 = {} is too early for the series (6.30)", fourier));
}

std::vector<double> uptake_history(std::span<const double> fourier, std::span<const double> surface, double initial) {
  if (fourier.size() != surface.size()) {
    foundation::fail_input(
        fmt::format("uptake of a sphere: {} times but {} surface values", fourier.size(), surface.size()));
  }
  if (fourier.empty()) return {};
  constexpr int modes = 400;
  // Mean = sum of the weights 6/(n pi)^2 times a_n, da_n/dt = (n pi)^2 (surface - a_n).
  std::vector<double> a(modes, initial), mean{initial};
  for (std::size_t i = 1; i < fourier.size(); ++i) {
    const double t = fourier[i] - fourier[i - 1];
    require(t > 0.0, "the times must ascend; a step of the time is", t);
    const double slope = (surface[i] - surface[i - 1]) / t;
    double sum = 0.0, rest = 1.0, rest_lag = 1.0 / 15.0;  // sums of 6/(n pi)^2 and 6/(n pi)^4 over all n
    for (int n = 1; n <= modes; ++n) {
      const double rate = n * n * pi * pi, weight = 6.0 / rate;
      // Particular solution: surface - slope/rate.
      double& amplitude = a[static_cast<std::size_t>(n - 1)];
      amplitude = surface[i] - slope / rate + (amplitude - surface[i - 1] + slope / rate) * std::exp(-rate * t);
      sum += weight * amplitude;
      rest -= weight;
      rest_lag -= weight / rate;
    }
    mean.push_back(sum + rest * surface[i] - rest_lag * slope);
  }
  return mean;
}

double exchange_coefficient(const exchange_law& law, double pressure, double T) {
  require(T > 0.0, "the temperature must be > 0 K", T);
  return std::pow(10.0, law.a + (law.b + law.c * pressure * 1e-9) / T);
}

double partition_coefficient(const exchange_law& law, double pressure, double T, double iron_ratio) {
  require(iron_ratio > 0.0, "the ratio of iron must be > 0", iron_ratio);
  return exchange_coefficient(law, pressure, T) * std::pow(iron_ratio, 0.5 * law.valence);
}

}  // namespace tetsuame::theory
