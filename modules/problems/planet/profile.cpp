#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/generation/generation_runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <cmath>
#include <eos/caloric.hpp>
#include <foundation/error.hpp>
#include <functional>
#include <optional>
#include <planet/profile.hpp>

namespace tetsuame::planet {

namespace {

constexpr int levels_per_layer = 400;        // at least
constexpr double integration_error = 1e-10;  // of a step, relative

// The state is integrated by s = m^(1/D), since r ∝ s at the centre; with the area A r^(D - 1) and the field
// F m/r^(D - 1):
//   dr/ds = D (s/r)^(D - 1)/(A ρ),  dln ρ/ds = -D F s (s/r)^(2 D - 2)/A/(ρ dp/dρ)
// with, along the way, ρ dp/dρ = K_T (1 + α n T) and dln T = n dln ρ, n = 0 or a; on an adiabat ρ dp/dρ = ρ c² and
// du = p/ρ dln ρ. The third unknown is ln T, or u on an adiabat.
using unknowns = std::array<double, 3>;  // r, ln ρ, and that

class path {
 public:
  path(const structure_input& in, const eos::any& material) : in_(in), material_(material) {
    if (in.law == temperature_law::adiabatic) waves_.emplace(material);
  }

  unknowns start(double r, double p, double T) const {
    const double rho = eos::density(material_, p, T);
    return {r, std::log(rho), waves_ ? waves_->internal_energy(rho, T) : std::log(T)};
  }
  void operator()(const unknowns& y, unknowns& by_s, double s) const {
    const double rho = std::exp(y[1]), q = s / y[0];
    const auto [stiffness, n] = along(rho, y[2]);
    by_s[0] = in_.form.dimension, by_s[1] = -in_.form.dimension * in_.form.strength() * s;
    for (int k = 1; k < in_.form.dimension; ++k) by_s[0] *= q, by_s[1] = by_s[1] * q * q;
    by_s[0] /= in_.form.area() * rho;
    by_s[1] /= in_.form.area() * stiffness;
    by_s[2] = n * by_s[1];
  }
  // What is left about the centre, of one density but for what its own weight adds: p_c = p + ½ F A/D ρ² r².
  unknowns centre(const unknowns& y) const {
    const double rho = std::exp(y[1]);
    const auto [stiffness, n] = along(rho, y[2]);
    const double gain = 0.5 * in_.form.volume() * in_.form.strength() * rho * rho * y[0] * y[0] / stiffness;
    return {0.0, y[1] + gain, y[2] + n * gain};
  }
  level at(double s, const unknowns& y) const {
    const double rho = std::exp(y[1]), T = waves_ ? waves_->temperature(rho, y[2]) : std::exp(y[2]);
    const double p = waves_ ? waves_->at(rho, y[2]).p : eos::evaluate(material_, rho, T).p;
    return {in_.form.power(s), std::max(y[0], 0.0), rho, p, T};
  }

 private:
  struct slopes {
    double stiffness, of_third;  // Pa, ρ dp/dρ; by ln ρ
  };
  slopes along(double rho, double third) const {
    if (waves_) {
      const auto now = waves_->at(rho, third);
      return {rho * now.c * now.c, now.p / rho};
    }
    const double T = std::exp(third), n = in_.law == temperature_law::power ? in_.exponent : 0.0;
    const auto at = eos::evaluate(material_, rho, T);
    return {at.K_T * (1.0 + at.alpha * n * T), n};
  }

  const structure_input& in_;
  const eos::any& material_;
  std::optional<eos::caloric> waves_ = {};
};

// Inwards from the surface of a planet of this radius, to a small ball about the centre: its radius less that of its
// mass at its density, over the planet's; where r comes to 0 before, a number below -1.
struct outcome {
  double left_over;
  std::vector<profile::layer_levels> layers;  // from the outside to the inside
};

// Inwards from s = begin to end by steps no longer than a level, shorter where the error asks for it (as in the thin
// outside of a gas); note(s) after each. Returns end, or the s at which r comes to 0 or an equation of state ends.
// Within r = smallest the mass that is left may be far denser than its surroundings: then it has no room either,
// however much these can be compressed.
template <class Note>
double advance(const shape& form, const path& slopes, unknowns& y, double begin, double end, double smallest,
               const Note& note) {
  const auto is_point = [&form](const unknowns& at, double s) {
    return form.power(s) > 100.0 * form.volume() * form.power(at[0]) * std::exp(at[1]);
  };
  namespace odeint = boost::numeric::odeint;
  auto stepper = odeint::make_controlled(integration_error, integration_error, odeint::runge_kutta_dopri5<unknowns>());
  const double level = (end - begin) / (levels_per_layer - 1);
  double s = begin, step = level;
  // Beyond the reach of an equation of state steps become ever shorter.
  for (int tries = 0; s != end && tries < 10 * levels_per_layer; ++tries) {
    step = std::max(step, level);  // both are below 0
    const bool is_last = s + step <= end;
    if (is_last) step = end - s;
    const double from = s, tried = step;
    const unknowns before = y;
    bool done = stepper.try_step(std::cref(slopes), y, s, step) == odeint::success;
    if (done && y[0] > 0.0 && y[0] < smallest && is_point(y, s)) return s;
    if (done && !(y[0] > 0.0 && std::isfinite(y[1]))) {  // errors that are no numbers count as small
      y = before, s = from, step = 0.2 * tried;
      stepper.reset();
      done = false;
    }
    if (!done && !(std::abs(step) > 1e-12 * begin)) return from;
    if (!done) continue;
    if (is_last) s = end;
    note(s);
  }
  return s;
}

outcome integrate(const structure_input& in, const std::vector<path>& paths, double radius, bool keep) {
  outcome all{0.0, {}};
  double m = in.mass, p = in.surface_pressure, T = in.surface_temperature, r = radius;
  for (std::size_t n = in.layers.size(); n-- > 0;) {
    const layer& now = in.layers[n];
    const double inner = n == 0 ? 0.0 : std::max(m - now.fraction * in.mass, 0.0);
    const double begin = in.form.root(m);
    const path& slopes = paths[n];
    unknowns y;
    try {
      y = slopes.start(r, p, T);
    } catch (const foundation::error&) {
      // At the surface, or at last, a fault; on the way the pressures of too small a planet.
      if (keep || n + 1 == in.layers.size()) throw;
      all.left_over = -1.0 - in.form.root(m / in.mass);
      return all;
    }
    if (keep) all.layers.push_back({{slopes.at(begin, y)}});
    const auto note = [&](double s) {
      if (keep) all.layers.back().levels.push_back(slopes.at(s, y));
    };
    const double last = n == 0 ? begin / levels_per_layer : in.form.root(inner);
    const double reached = advance(in.form, slopes, y, begin, last, n == 0 ? 0.1 * radius : 0.0, note);
    if (reached != last) {  // no room for the mass that is left
      all.left_over = -1.0 - reached / in.form.root(in.mass);
      return all;
    }
    if (n == 0) {
      all.left_over = (y[0] - last * in.form.root(in.form.dimension / (in.form.area() * std::exp(y[1])))) / radius;
      if (keep) all.layers.back().levels.push_back(slopes.at(0.0, slopes.centre(y)));
      return all;
    }
    const level end = slopes.at(in.form.root(inner), y);
    m = inner, p = end.p, T = end.T, r = y[0];
  }
  return all;
}

// The root of f between low and high, to rounding; none where f has one sign.
template <class F>
std::optional<std::array<double, 2>> bracket_root(const F& f, double low, double high) {
  const double at_low = f(low), at_high = f(high);
  if (!(at_low * at_high < 0.0)) return std::nullopt;
  std::uintmax_t most = 200;
  const auto found = boost::math::tools::toms748_solve(f, low, high, at_low, at_high,
                                                       boost::math::tools::eps_tolerance<double>(50), most);
  return std::array{found.first, found.second};
}

std::vector<path> paths_of(const structure_input& in) {
  std::vector<path> all;
  for (const auto& layer : in.layers) all.emplace_back(in, layer.material);
  return all;
}

// fail_input where the centre is not reached: an equation of state ends before.
profile complete(const structure_input& in, const std::vector<path>& paths, double radius) {
  auto whole = integrate(in, paths, radius, true);
  constexpr double closed = 1e-6;
  const auto is_finite = [](const level& l) {
    return std::isfinite(l.rho) && std::isfinite(l.p) && std::isfinite(l.T);
  };
  const auto& inner = whole.layers.back().levels;
  const bool all_finite = std::ranges::all_of(inner, is_finite);
  if (whole.layers.size() < in.layers.size() || !all_finite || !(std::abs(whole.left_over) < closed)) {
    const layer& in_it = in.layers[in.layers.size() - whole.layers.size()];
    const auto last = std::ranges::find_if_not(inner, is_finite);
    const level& known = last == inner.begin() ? inner.front() : *(last - 1);
    foundation::fail_input(
        fmt::format("no equilibrium: layer '{}' would be compressed to more than its equation of state reaches, about "
                    "{:.3g} kg/m3 and {:.3g} Pa; take less mass or another equation of state",
                    in_it.name, known.rho, known.p));
  }
  std::reverse(whole.layers.begin(), whole.layers.end());
  return profile(std::move(whole.layers), in.form);
}

// The end of the bracket on which the centre is reached.
template <class F>
double end_at_centre(const F& f, const std::array<double, 2>& ends) {
  return f(ends[1]) >= 0.0 ? ends[1] : ends[0];
}

double radius_of_density(const structure_input& in, double rho) {
  return in.form.root(in.form.dimension * in.mass / (in.form.area() * rho));
}

}  // namespace

profile structure_of_mass(const structure_input& in) {
  const auto paths = paths_of(in);
  const auto left_over = [&](double radius) { return integrate(in, paths, radius, false).left_over; };
  const double smallest = radius_of_density(in, 1e6), largest = radius_of_density(in, 1.0);
  // Of two radii the larger one: on the other branch, which an equation of state has that can be compressed at will, a
  // planet that is squeezed collapses.
  double low = largest;
  while (low > smallest && left_over(low) >= 0.0) low *= 0.95;
  const auto ends = bracket_root(left_over, low, std::min(largest, low / 0.95));
  if (!ends)
    foundation::fail_input(
        fmt::format("no planet of {:.6g} kg with these layers has a radius between {:.6g} and {:.6g} m", in.mass,
                    smallest, largest));
  return complete(in, paths, end_at_centre(left_over, *ends));
}

profile structure_of_radius(structure_input in, double radius) {
  const auto paths = paths_of(in);
  const auto with = [&](double fraction) {
    in.layers[0].fraction = fraction;
    in.layers[1].fraction = 1.0 - fraction;
  };
  const auto left_over = [&](double fraction) {
    with(fraction);
    return integrate(in, paths, radius, false).left_over;
  };
  const auto ends = bracket_root(left_over, 1e-9, 1.0 - 1e-9);
  if (!ends) {
    const bool large = left_over(1e-9) > 0.0;
    foundation::fail_input(
        fmt::format("no planet of {:.6g} kg and a radius of {:.6g} m: of {} alone it would be {} than that", in.mass,
                    radius, large ? in.layers[1].name : in.layers[0].name, large ? "smaller" : "larger"));
  }
  with(end_at_centre(left_over, *ends));
  return complete(in, paths, radius);
}

std::size_t profile::layer_at(double r) const {
  for (std::size_t n = 0; n + 1 < layers_.size(); ++n)
    if (r < layers_[n].outer().r) return n;
  return layers_.size() - 1;
}

namespace {

// Between two levels, linear in the fraction of what `by` gives.
level between(const shape& form, const level& a, const level& b, double t) {
  const auto mix = [t](double x, double y) { return x + t * (y - x); };
  return {mix(a.m, b.m), form.root(mix(std::pow(a.r, form.dimension), std::pow(b.r, form.dimension))),
          mix(a.rho, b.rho), mix(a.p, b.p), mix(a.T, b.T)};
}

template <class By>
level find(const shape& form, const std::vector<level>& levels, double value, const By& by) {
  if (value >= by(levels.front())) return levels.front();
  if (value <= by(levels.back())) return levels.back();
  const auto after = std::ranges::find_if(levels, [&](const level& l) { return by(l) < value; });
  const level &a = *(after - 1), &b = *after;
  return between(form, a, b, (value - by(a)) / (by(b) - by(a)));
}

}  // namespace

level profile::at(double r, std::size_t layer) const {
  return find(form_, layers_[layer].levels, form_.power(r), [this](const level& one) { return form_.power(one.r); });
}

level profile::at_mass(double m, std::size_t layer) const {
  return find(form_, layers_[layer].levels, m, [](const level& one) { return one.m; });
}

}  // namespace tetsuame::planet
