#include <fmt/format.h>

#include <cmath>
#include <foundation/error.hpp>
#include <limits>
#include <numbers>
#include <theory/stefan.hpp>

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
    double low = start, high = start + 1.0;
    while (beyond(start, high) < wanted) high += high;
    for (int k = 0; k < 100 && high - low > 1e-16 * high; ++k) {
      const double middle = 0.5 * (low + high);
      (beyond(start, middle) < wanted ? low : high) = middle;
    }
    flux *= std::exp((start - high) * (start + high));
    at = root * high;
    T = bound;
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

stefan_solution solve(const melting_contact& p) {
  if (!(p.hot.temperature > p.cold.temperature && p.cold.temperature <= p.solidus && p.solidus < p.liquidus))
    foundation::fail_input(
        fmt::format("melting at a contact: {} K must be hotter than {} K, which must be at most the solidus {} K, and "
                    "that below the liquidus {} K",
                    p.hot.temperature, p.cold.temperature, p.solidus, p.liquidus));
  stefan_solution s{p, 0.0, {}};
  double low = p.cold.temperature, high = p.hot.temperature;
  for (int k = 0; k < 200 && high - low > 1e-15 * high; ++k) {
    s.contact = 0.5 * (low + high);
    (outwards(p, s.contact, s.pieces) > p.cold.temperature ? high : low) = s.contact;
  }
  s.contact = low;  // from where the far field is reached
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

// Simpson's rule on each side of the place where the liquid ends, outwards to the solidus.
double stefan_solution::melt_thickness(double t) const {
  double liquid = 0.0, solid = 0.0;  // where they end, x/(2 sqrt t)
  for (const auto& p : pieces) {
    if (p.T <= problem.liquidus && liquid == 0.0) liquid = p.from;
    if (p.T <= problem.solidus) solid = p.from;
  }
  const double scale = 2.0 * std::sqrt(t);
  if (!(solid > liquid)) return scale * liquid;
  constexpr int n = 200;
  double sum = 0.0;
  for (int k = 0; k <= n; ++k) {
    const double x = liquid + (solid - liquid) * k / n;
    const double f = (temperature(scale * x, t) - problem.solidus) / (problem.liquidus - problem.solidus);
    sum += (k == 0 || k == n ? 1.0 : k % 2 == 1 ? 4.0 : 2.0) * f;
  }
  return scale * (liquid + (solid - liquid) * sum / (3.0 * n));
}

}  // namespace tetsuame::theory
