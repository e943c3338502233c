#include <fmt/core.h>

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <foundation/error.hpp>
#include <limits>
#include <riemann/general.hpp>

namespace tetsuame::riemann {

namespace {

constexpr int steps_along_isentrope = 64;  // of the whole fan; relative error about 1e-9 for a fall of rho to a half

// The root of f between ends of different sign, to the last digits.
template <class F>
double root_between(F f, double low, double high) {
  std::uintmax_t most = 200;
  const auto [a, b] =
      boost::math::tools::toms748_solve(f, low, high, boost::math::tools::eps_tolerance<double>(50), most);
  return 0.5 * (a + b);
}

}  // namespace

// Towards -x: gas that expands gains velocity, dv = -c d ln rho.
general_state general_tube::side_of::along(const general_state& from, double rho, int steps) const {
  const double h = std::log(rho / from.rho) / steps;
  struct slope {
    double u, v;
  };
  const auto slopes = [&](double L, double u) {
    const double r = from.rho * std::exp(L);
    const eos::caloric_state s = material->at(r, u);
    return slope{s.p / r, -s.c};
  };
  general_state now = from;
  for (int k = 0; k < steps; ++k) {
    const double L = h * k;
    const slope a = slopes(L, now.u), b = slopes(L + 0.5 * h, now.u + 0.5 * h * a.u);
    const slope c = slopes(L + 0.5 * h, now.u + 0.5 * h * b.u), d = slopes(L + h, now.u + h * c.u);
    now.u += h / 6.0 * (a.u + 2.0 * (b.u + c.u) + d.u);
    now.v += h / 6.0 * (a.v + 2.0 * (b.v + c.v) + d.v);
  }
  now.rho = rho;
  now.p = material->at(rho, now.u).p;
  return now;
}

general_state general_tube::side_of::compressed(double rho) const {
  const double dV = 1.0 / outer.rho - 1.0 / rho;
  const auto miss = [&](double p) { return material->at(rho, outer.u + 0.5 * (p + outer.p) * dV).p - p; };
  // From the isentrope's pressure, which is too low, by the secant: p(u) is all but linear.
  double p0 = along(outer, rho, 4).p, f0 = miss(p0);
  double p1 = p0 + f0, f1 = miss(p1);
  for (int k = 0; k < 50 && f1 != f0 && std::abs(p1 - p0) > 1e-15 * std::abs(p1); ++k) {
    const double next = p1 - f1 * (p1 - p0) / (f1 - f0);
    p0 = p1, f0 = f1, p1 = next, f1 = miss(p1);
  }
  return {rho, outer.v - std::sqrt(std::max((p1 - outer.p) * dV, 0.0)), p1, outer.u + 0.5 * (p1 + outer.p) * dV};
}

general_state general_tube::side_of::by_density(double rho) const {
  return rho > outer.rho ? compressed(rho) : along(outer, rho, steps_along_isentrope);
}

general_state general_tube::side_of::by_pressure(double p) const {
  if (p == outer.p) return outer;
  const auto miss = [&](double rho) { return by_density(rho).p - p; };
  // Out from the side's own density, to where the pressure has passed p.
  double near = outer.rho, far = near;
  const double factor = p > outer.p ? 1.02 : 1.0 / 1.02;
  for (int k = 0; k < 200; ++k) {
    near = far;
    far *= factor;
    const double f = miss(far);
    if (!std::isfinite(f)) break;
    if ((f > 0.0) == (p > outer.p)) return by_density(root_between(miss, std::min(near, far), std::max(near, far)));
  }
  const double none = std::numeric_limits<double>::quiet_NaN();
  return {none, none, p, none};
}

void general_tube::side_of::settle(double p) {
  star = by_pressure(p);
  shock = std::numeric_limits<double>::quiet_NaN();
  fan.clear();
  if (p > outer.p) {
    // Mass flux through the shock: rho_K (v_K - s) = rho (v - s)
    shock = (star.rho * star.v - outer.rho * outer.v) / (star.rho - outer.rho);
    return;
  }
  constexpr int pieces = 128;
  fan.push_back(outer);
  for (int k = 1; k <= pieces; ++k)
    fan.push_back(along(fan.back(), outer.rho * std::pow(star.rho / outer.rho, double(k) / pieces), 1));
}

general_state general_tube::side_of::at(double xi) const {
  if (!std::isnan(shock)) return xi < shock ? outer : star;
  const auto speed = [&](const general_state& s) { return s.v - sound(s); };
  if (xi <= speed(outer)) return outer;
  if (xi >= speed(star) || star.rho == outer.rho) return star;
  const auto next =
      std::lower_bound(fan.begin(), fan.end(), xi, [&](const general_state& s, double x) { return speed(s) < x; });
  const general_state& from = *(next - 1);
  return along(from, root_between([&](double rho) { return speed(along(from, rho, 1)) - xi; }, next->rho, from.rho), 1);
}

general_tube::general_tube(const body& left, const body& right) {
  const auto make = [](const body& b, double v) {
    const double u = b.material->internal_energy(b.rho, b.T);
    const eos::caloric_state s = b.material->at(b.rho, u);
    if (!(s.c > 0.0))
      foundation::fail_input(fmt::format("Riemann problem: '{}' has no sound at {:g} kg/m^3 and {:g} K",
                                         eos::about(b.material->material()).name, b.rho, b.T));
    side_of made{b.material, {b.rho, v, s.p, u}, {}, 0.0, {}};
    return made;
  };
  left_ = make(left, left.v);
  right_ = make(right, -right.v);
  // How much too fast the sides run into each other with p between them: falls with p.
  const auto closing = [&](double p) { return left_.by_pressure(p).v + right_.by_pressure(p).v; };
  const auto fail = [&](double p) {
    foundation::fail_calculation(fmt::format("Riemann problem: the wave curves do not meet near {:g} Pa", p));
  };
  double low = std::min(left_.outer.p, right_.outer.p), high = std::max(left_.outer.p, right_.outer.p);
  const double scale = left_.outer.rho * std::pow(left_.sound(left_.outer), 2);
  for (double step = 0.02 * scale; !(closing(high) <= 0.0); high += step, step *= 1.5)
    if (!std::isfinite(closing(high))) fail(high);
  for (double step = 0.02 * scale; !(closing(low) >= 0.0); low -= step)
    if (!std::isfinite(closing(low))) fail(low);
  const double p = low == high ? low : root_between(closing, low, high);
  left_.settle(p);
  right_.settle(p);
  star_r_ = right_.star;
  star_r_.v = -star_r_.v;
}

general_state general_tube::at(double xi) const {
  if (on_left(xi)) return left_.at(xi);
  general_state s = right_.at(-xi);
  s.v = -s.v;
  return s;
}

}  // namespace tetsuame::riemann
