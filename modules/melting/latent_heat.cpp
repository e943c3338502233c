#include <cmath>
#include <limits>
#include <melting/latent_heat.hpp>
#include <melting/melting.hpp>

namespace tetsuame::melting {

namespace {

// At temperature and pressure alone.
double fraction_at(const options& o, const eos::caloric_state& now) {
  const auto [T_s, T_l] = range(o, now.p);
  if (!(std::isfinite(now.T) && T_l > T_s)) return std::numeric_limits<double>::quiet_NaN();
  return melt_fraction(now.T, T_s, T_l);
}

}  // namespace

double internal_energy(const eos::caloric& material, const options& o, double rho, double T) {
  const double u = material.internal_energy(rho, T);
  return u + o.latent_heat * fraction_at(o, material.at(rho, u));
}

double melt_fraction(const eos::caloric& material, const options& o, double rho, double u) {
  const auto excess = [&](double f) { return fraction_at(o, material.at(rho, u - o.latent_heat * f)) - f; };
  double a = 0.0, b = 1.0, at_a = excess(a);
  if (!(at_a > 0.0) || o.latent_heat == 0.0) return at_a;
  double at_b = excess(b);
  if (!(at_b < 0.0)) return b + at_b;
  // Regula falsi, the value of an end that stays halved ("Illinois"): the excess falls with f, and is nearly linear.
  int stayed = 0;
  for (int k = 0; k < 100 && b - a > 1e-12; ++k) {
    const double f = (a * at_b - b * at_a) / (at_b - at_a), here = excess(f);
    if (std::abs(here) < 1e-13) return f;
    if (here > 0.0) {
      a = f, at_a = here;
      if (stayed == -1) at_b *= 0.5;
      stayed = -1;
    } else {
      b = f, at_b = here;
      if (stayed == 1) at_a *= 0.5;
      stayed = 1;
    }
  }
  return 0.5 * (a + b);
}

}  // namespace tetsuame::melting
