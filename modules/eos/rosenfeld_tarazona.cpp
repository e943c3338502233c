#include <cmath>
#include <eos/inversion.hpp>
#include <eos/rosenfeld_tarazona.hpp>
#include <limits>

namespace tetsuame::eos {

namespace {

bool in_reach(const rosenfeld_tarazona& m, double rho) {
  return rho >= m.least_compression * m.rho0 && rho <= m.most_compression * m.rho0;
}

// What depends on density alone: b and its derivatives by ln rho, and the reference adiabat.
struct at_density {
  double L, b, b_L, b_LL;  // J/kg
  characteristic_point adiabat;
  double rate_S;      // f'(T_S), 1/K
  double capacity_S;  // c_V at T_S, J/(kg K)
};

double rate(const rosenfeld_tarazona& m, double T) { return m.m / m.T0 * std::pow(T / m.T0, m.m - 1.0); }

at_density look_at(const rosenfeld_tarazona& m, double rho) {
  const double L = std::log(rho / m.rho0), x = m.rho0 / rho, y = x - 1.0;
  double b = 0.0, first = 0.0, second = 0.0;  // by x
  for (std::size_t n = m.b.size(); n-- > 0;) {
    second = second * y + 2.0 * first;
    first = first * y + b;
    b = b * y + m.b[n];
  }
  const auto adiabat = m.adiabat.at(L);
  const double rate_S = rate(m, adiabat.theta);
  return {L, b, -x * first, x * (first + x * second), adiabat, rate_S, b * rate_S + 1.5 * m.k};
}

double entropy(const rosenfeld_tarazona& m, const at_density& d, double T) {
  return d.b / (m.m - 1.0) * (rate(m, T) - d.rate_S) + 1.5 * m.k * std::log(T / d.adiabat.theta);
}

// dS/d ln rho and its derivative, J/(kg K)
struct entropy_slopes {
  double first, second;
};
entropy_slopes slopes(const rosenfeld_tarazona& m, const at_density& d, double T) {
  const double by_b = (rate(m, T) - d.rate_S) / (m.m - 1.0), g = d.adiabat.gamma;
  return {d.b_L * by_b - g * d.capacity_S, d.b_LL * by_b - 2.0 * g * d.b_L * d.rate_S - d.adiabat.slope * d.capacity_S -
                                               g * g * (m.m - 1.0) * d.b * d.rate_S};
}

// u of what does not change with T at a density, J/kg.
double energy_at_rest(const rosenfeld_tarazona& m, const at_density& d) {
  return m.reference.energy(d.L) / m.rho0 + m.T0 * entropy(m, d, m.T0) - d.b - 1.5 * m.k * m.T0;
}

}  // namespace

properties rosenfeld_tarazona::evaluate(double rho, double T) const {
  if (!(in_reach(*this, rho) && T > 0.0)) return {nan, nan, nan, nan, nan};
  const at_density d = look_at(*this, rho);
  const auto curve = reference.at(d.L);
  const entropy_slopes hot = slopes(*this, d, T), cold = slopes(*this, d, T0);
  const double f = std::pow(T / T0, m) - 1.0;
  const double thermal = rho * (d.b_L * f + T0 * cold.first - T * hot.first);
  const double K_T = curve.K + thermal + rho * (d.b_LL * f + T0 * cold.second - T * hot.second);
  return from_derivatives(rho, T, curve.p + thermal, K_T, -rho * hot.first, d.b * rate(*this, T) + 1.5 * k);
}

double rosenfeld_tarazona::density(double p, double T) const {
  return invert(*this, p, T, {least_compression * rho0, rho0, most_compression * rho0});
}

double rosenfeld_tarazona::internal_energy(double rho, double T) const {
  if (!(in_reach(*this, rho) && T > 0.0)) return nan;
  const at_density d = look_at(*this, rho);
  return energy_at_rest(*this, d) + d.b * std::pow(T / T0, m) + 1.5 * k * T;
}

double rosenfeld_tarazona::temperature(double rho, double u) const {
  if (!in_reach(*this, rho)) return nan;
  const at_density d = look_at(*this, rho);
  const double gained = u - energy_at_rest(*this, d);
  if (!(gained > 0.0)) return nan;
  // Newton from below, where u is concave in T: the one of both terms alone that gives the lower half of the heat.
  double T = std::min(gained / (3.0 * k), T0 * std::pow(0.5 * gained / d.b, 1.0 / m));
  for (int n = 0; n < 100; ++n) {
    const double step = (gained - d.b * std::pow(T / T0, m) - 1.5 * k * T) / (d.b * rate(*this, T) + 1.5 * k);
    T += step;
    if (!(std::abs(step) > 4.0 * std::numeric_limits<double>::epsilon() * T)) break;
  }
  return T;
}

}  // namespace tetsuame::eos
