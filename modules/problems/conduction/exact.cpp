#include <cmath>
#include <conduction/exact.hpp>
#include <numbers>

namespace tetsuame::conduction {

double half_space(double T0, double T1, double kappa, double depth, double t) {
  if (t == 0.0) return depth > 0.0 ? T1 : T0;
  return T1 + (T0 - T1) * std::erfc(depth / (2.0 * std::sqrt(kappa * t)));
}

double plate(double T0, double T1, double kappa, double L, double depth, double t) {
  const double tau = kappa * t / (L * L), y = depth / L;
  constexpr double pi = std::numbers::pi;
  if (tau < 0.02) {  // mirror images of the surface: erfc of 2 L and more is below 1e-14 of these
    double cooled = 0.0;
    for (int k = 0; k < 4; ++k) {
      const double width = 2.0 * std::sqrt(tau);
      if (width == 0.0) return depth > 0.0 ? T1 : T0;
      cooled += std::erfc((2.0 * k + y) / width) - std::erfc((2.0 * k + 2.0 - y) / width);
    }
    return T1 + (T0 - T1) * cooled;
  }
  double sum = y;
  for (int n = 1; n < 200; ++n) {
    const double decay = std::exp(-tau * n * n * pi * pi);
    if (decay < 1e-17) break;
    sum += 2.0 / (pi * n) * decay * std::sin(n * pi * y);
  }
  return T0 + (T1 - T0) * sum;
}

}  // namespace tetsuame::conduction
