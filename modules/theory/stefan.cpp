#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <theory/stefan.hpp>
#include <utility>

namespace tetsuame::theory {

namespace {

double diffusivity(const half_space& h) { return h.conductivity / (h.density * h.heat_capacity); }

// exp(x²) erfc(x), x >= 0; from 25 on by its asymptotic series, right to rounding there.
double scaled_erfc(double x) {
  if (x < 25.0) return std::exp(x * x) * std::erfc(x);
  const double u = 0.5 / (x * x);
  return std::numbers::inv_sqrtpi / x * (1.0 - u * (1.0 - u * (3.0 - u * (15.0 - 105.0 * u))));
}

// exp(a²) [erf(x) - erf(a)] for x >= a >= 0: a thin mush far out has a in the hundreds.
double beyond(double a, double x) { return scaled_erfc(a) - std::exp((a - x) * (a + x)) * scaled_erfc(x); }

// Next to where `reached` changes from false at `low` to true at `high`, to rounding: a number where it is false, and
// one where it is true.
std::pair<double, double> crossing(const auto& reached, double low, double high) {
  return boost::math::tools::bisect([&](double x) { return reached(x) ? 1.0 : -1.0; }, low, high,
                                    boost::math::tools::eps_tolerance<double>());
}

// From the contact outwards for a temperature of the contact; returns T far away, or infinity where it cannot fall to
// the next bound.
double outwards(const melting_contact& p, double contact, std::vector<stefan_solution::piece>& pieces) {
  const auto& m = p.cold;
  double at = 0.0, T = contact;
  double flux = -2.0 * p.hot.conductivity * (p.hot.temperature - contact) /
                std::sqrt(std::numbers::pi * diffusivity(p.hot));  // k dT/d(x/(2 sqrt t))
  pieces.clear();
  const auto mush_c = m.heat_capacity + p.latent_heat / (p.liquidus - p.solidus);
  struct range {
    double bound, c;  // K, where it ends; J/(kg K)
  };
  for (const auto& [bound, c] :
       {range{p.liquidus, m.heat_capacity}, range{p.solidus, mush_c}, range{0.0, m.heat_capacity}}) {
    const bool last = bound == 0.0;
    if (!last && T <= bound) continue;  // the contact is colder
    const double kappa = m.conductivity / (m.density * c), root = std::sqrt(kappa);
    const double B = flux * std::sqrt(std::numbers::pi * kappa) / (2.0 * m.conductivity);
    pieces.push_back({at, kappa, T, B});
    const double start = at / root;
    if (last) return T + B * scaled_erfc(start);
    const double wanted = (bound - T) / B;
    if (!(wanted < scaled_erfc(start))) return std::numeric_limits<double>::infinity();
    double high = start + 1.0;
    while (beyond(start, high) < wanted) high += high;
    high = crossing([&](double x) { return beyond(start, x) >= wanted; }, start, high).second;
    flux *= std::exp((start - high) * (start + high));
    at = root * high;
    T = bound;
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

stefan_solution solve(const melting_contact& p) {
  stefan_solution s{p, 0.0, {}};
  const auto too_hot = [&](double contact) { return outwards(p, contact, s.pieces) > p.cold.temperature; };
  s.contact = crossing(too_hot, p.cold.temperature, p.hot.temperature).first;  // from where the far field is reached
  outwards(p, s.contact, s.pieces);
  return s;
}

double stefan_solution::temperature(double x, double t) const {
  const double at = std::abs(x) / (2.0 * std::sqrt(t));
  if (x < 0.0)
    return contact + (problem.hot.temperature - contact) * std::erf(at / std::sqrt(diffusivity(problem.hot)));
  std::size_t k = 0;
  while (k + 1 < pieces.size() && pieces[k + 1].from <= at) ++k;
  const auto& p = pieces[k];
  const double root = std::sqrt(p.kappa);
  return p.T + p.B * beyond(p.from / root, at / root);
}

// Gauss's rule from where the liquid ends outwards to the solidus.
double stefan_solution::melt_thickness(double t) const {
  double liquid = 0.0, solid = 0.0;  // where they end, x/(2 sqrt t)
  for (const auto& p : pieces) {
    if (p.T <= problem.liquidus && liquid == 0.0) liquid = p.from;
    if (p.T <= problem.solidus) solid = p.from;
  }
  const double scale = 2.0 * std::sqrt(t);
  if (!(solid > liquid)) return scale * liquid;
  const auto fraction = [&](double x) {
    return (temperature(scale * x, t) - problem.solidus) / (problem.liquidus - problem.solidus);
  };
  return scale * (liquid + boost::math::quadrature::gauss<double, 30>::integrate(fraction, liquid, solid));
}

}  // namespace tetsuame::theory
