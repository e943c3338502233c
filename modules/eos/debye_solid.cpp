#include <cmath>
#include <eos/debye.hpp>
#include <eos/debye_solid.hpp>
#include <eos/inversion.hpp>
#include <limits>

namespace tetsuame::eos {

namespace {

// Both terms of A and of its derivatives, J/(kg K^2): sum A, sum m A, sum m^2 A.
struct quadratic_sums {
  double A, first, second;
};

quadratic_sums sums(const debye_solid& s, double L) {
  quadratic_sums sum{0.0, 0.0, 0.0};
  for (const quadratic_term& t : {s.anharmonic, s.electronic}) {
    const double A = 3.0 * s.k * t.coefficient * std::exp(-t.exponent * L);
    sum.A += A;
    sum.first += t.exponent * A;
    sum.second += t.exponent * t.exponent * A;
  }
  return sum;
}

bool in_reach(const debye_solid& s, double rho) {
  return rho >= s.least_compression * s.rho0 && rho <= s.most_compression * s.rho0;
}

characteristic_point vibration_at(const debye_solid& s, double L) {
  return std::visit([&](const auto& v) { return v.at(L); }, s.vibration);
}

// u = F + T S of what does not change with T at a density, J/kg.
double energy_at_rest(const debye_solid& s, double L, double theta, double A) {
  const double curve = std::visit([&](const auto& r) { return r.energy(L); }, s.reference) / s.rho0;
  return curve - s.k * s.T0 * debye(theta, s.T0).free_energy + 0.5 * A * s.T0 * s.T0;
}

}  // namespace

properties debye_solid::evaluate(double rho, double T) const {
  if (!(in_reach(*this, rho) && T > 0.0)) return {nan, nan, nan, nan, nan};
  const double L = std::log(rho / rho0);
  const auto curve = std::visit([&](const auto& r) { return r.at(L); }, reference);
  const auto [theta, gamma, slope] = vibration_at(*this, L);
  const auto hot = debye(theta, T), cold = debye(theta, T0);
  const quadratic_sums q = sums(*this, L);
  const double E = k * (T * hot.energy - T0 * cold.energy);       // J/kg, over that at T0
  const double TC = k * (T * hot.capacity - T0 * cold.capacity);  // likewise T C_V
  const double squares = 0.5 * (T * T - T0 * T0);
  const double p = curve.p + rho * (gamma * E + q.first * squares);
  // dE/d ln rho = gamma (E - T C_V), as E is of first degree in theta and T
  const double K_T = curve.K + rho * ((gamma + slope) * E + gamma * gamma * (E - TC) + (q.first - q.second) * squares);
  const double alpha_K = rho * (gamma * k * hot.capacity + q.first * T);
  return from_derivatives(rho, T, p, K_T, alpha_K, k * hot.capacity + q.A * T);
}

double debye_solid::density(double p, double T) const {
  return invert(*this, p, T, {least_compression * rho0, rho0, most_compression * rho0});
}

double debye_solid::internal_energy(double rho, double T) const {
  if (!(in_reach(*this, rho) && T > 0.0)) return nan;
  const double L = std::log(rho / rho0), theta = vibration_at(*this, L).theta, A = sums(*this, L).A;
  return energy_at_rest(*this, L, theta, A) + k * T * debye(theta, T).energy + 0.5 * A * T * T;
}

double debye_solid::temperature(double rho, double u) const {
  if (!in_reach(*this, rho)) return nan;
  const double L = std::log(rho / rho0), theta = vibration_at(*this, L).theta, A = sums(*this, L).A;
  const double gained = u - energy_at_rest(*this, L, theta, A);
  if (!(gained > 0.0)) return nan;
  // Newton from above, where u is convex in T: the energy is that of 3k T less 9/8 k theta at the least.
  double T = gained / (3.0 * k) + 0.375 * theta;
  for (int n = 0; n < 100; ++n) {
    const auto d = debye(theta, T);
    const double step = (gained - k * T * d.energy - 0.5 * A * T * T) / (k * d.capacity + A * T);
    T += step;
    if (!(std::abs(step) > 4.0 * std::numeric_limits<double>::epsilon() * T)) break;
  }
  return T;
}

}  // namespace tetsuame::eos
