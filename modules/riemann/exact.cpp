#include <fmt/core.h>

#include <algorithm>
#include <foundation/error.hpp>
#include <riemann/exact.hpp>

namespace tetsuame::riemann {

namespace {

void require_gas(const side<double>& s, const char* name) {
  const double P = s.p + s.p_infinity;
  if (s.rho > 0.0 && P > 0.0 && s.gamma > 1.0 && std::isfinite(s.rho + P + s.gamma + s.u)) return;
  foundation::fail_input(
      fmt::format("Riemann problem: the {} state has density {:g} kg/m^3, velocity {:g} m/s, pressure {:g} Pa, gamma "
                  "{:g}, p_infinity {:g} Pa; all must be finite with density > 0, p + p_infinity > 0, gamma > 1",
                  name, s.rho, s.u, s.p, s.gamma, s.p_infinity));
}

side<double> mirrored(side<double> s) {
  s.u = -s.u;
  return s;
}

// Left of the contact.
primitive sample_left(const side<double>& s, double p, double u, double rho, double xi) {
  const double c = sound_speed(s), P_K = s.p + s.p_infinity, P = p + s.p_infinity;
  const double plus = s.gamma + 1.0, minus = s.gamma - 1.0;
  const primitive outer{s.rho, s.u, s.p}, inner{rho, u, p};
  if (p > s.p) {
    const double shock = s.u - c * std::sqrt((plus * P / P_K + minus) / (2.0 * s.gamma));
    return xi < shock ? outer : inner;
  }
  const double head = s.u - c, tail = u - c * std::pow(P / P_K, 0.5 * minus / s.gamma);
  if (xi <= head) return outer;
  if (xi >= tail) return inner;
  // [Toro (4.56)]
  const double ratio = (2.0 + minus / c * (s.u - xi)) / plus;  // c(xi)/c
  return {s.rho * std::pow(ratio, 2.0 / minus), 2.0 / plus * (c + 0.5 * minus * s.u + xi),
          P_K * std::pow(ratio, 2.0 * s.gamma / minus) - s.p_infinity};
}

}  // namespace

star<double> solve(const side<double>& left, const side<double>& right) {
  require_gas(left, "left");
  require_gas(right, "right");
  const detail::problem<double> both(left, right);
  if (both.vacuum) return both.finish(both.p_least);
  double p = both.start();
  // The last digits of p* are those of the largest of the pressures in the sum.
  const double scale = std::max(left.p_infinity, right.p_infinity);
  for (int k = 0; k < 100; ++k) {
    const double q = both.next(p), change = std::abs(q - p);
    p = q;
    if (change <= 4e-16 * (std::abs(p) + scale)) return both.finish(p);
    // Past the first steps the iterates go one way; a turn is rounding.
    if (k > 4 && change <= 1e-13 * (std::abs(p) + scale)) return both.finish(p);
  }
  foundation::fail_calculation(
      fmt::format("Riemann problem: no convergence in 100 steps; left {:g} kg/m^3, {:g} m/s, {:g} Pa; right {:g} "
                  "kg/m^3, {:g} m/s, {:g} Pa; p* about {:g} Pa",
                  left.rho, left.u, left.p, right.rho, right.u, right.p, p));
}

primitive sample(const side<double>& left, const side<double>& right, const star<double>& between, double xi) {
  if (between.vacuum && xi > between.u_l && xi < between.u_r) return {0.0, xi, between.p};
  if (xi <= between.u_l) return sample_left(left, between.p, between.u_l, between.rho_l, xi);
  primitive w = sample_left(mirrored(right), between.p, -between.u_r, between.rho_r, -xi);
  w.u = -w.u;
  return w;
}

}  // namespace tetsuame::riemann
