#include <algorithm>
#include <cmath>
#include <relaxation/steps.hpp>

namespace tetsuame::relaxation {

namespace {

// The largest n in 1 … 10^9 that is affordable, where affordable(n) is true up to some n and false
// beyond it; 0 if none is.
template <class Test>
std::int64_t largest_that(const Test& affordable) {
  std::int64_t below = 0, above = 1'000'000'001;
  while (above - below > 1) {
    const std::int64_t middle = below + (above - below) / 2;
    (affordable(middle) ? below : above) = middle;
  }
  return below;
}

// Pa s, (18)
double damping_viscosity(const two_layers& s, std::int64_t n) { return s.c * s.rho_min * s.L / static_cast<double>(n); }

}  // namespace

double step_bounds::least() const { return std::min({sound, momentum, heat}); }

std::string step_bounds::binding() const {
  if (sound <= momentum && sound <= heat) return "sound";
  return momentum <= heat ? "momentum" : "heat";
}

step_bounds bounds(const fluid_layer& f, double zeta, double xi, double dx, double fraction) {
  return {fraction * zeta * xi * dx / sound_speed(f), fraction * xi * xi * dx * dx / (2.0 * f.nu),
          fraction * dx * dx / (2.0 * f.kappa)};
}

convection_plan plan_convection(const fluid_layer& f, const recommendation& r, std::int64_t n, int dimension,
                                double volume_ratio, double fraction, const cost& c) {
  convection_plan p{};
  p.n = n;
  p.particles = volume_ratio * std::pow(static_cast<double>(n), dimension);
  p.dx = f.L / static_cast<double>(n);
  p.dt = bounds(f, r.zeta, r.xi, p.dx, fraction);
  p.dt.sound /= r.wave_share;
  p.dt.momentum /= r.viscous_share;
  p.tau = f.L / r.speed;
  p.steps = p.tau / p.dt.least();
  if (c.updates_per_second > 0.0) p.seconds = p.steps * c.evaluations_per_step * p.particles / c.updates_per_second;
  return p;
}

std::int64_t largest_n(const fluid_layer& f, const recommendation& r, int dimension, double volume_ratio,
                       double fraction, const cost& c, const budget& b) {
  return largest_that([&](std::int64_t n) {
    const auto p = plan_convection(f, r, n, dimension, volume_ratio, fraction, c);
    return p.steps <= b.steps && p.seconds <= b.seconds;
  });
}

double steps_of_20(const two_layers& s, std::int64_t n) {
  const auto side = static_cast<double>(n);
  return 2.0 * s.c * s.c * s.rho_min * side * side / (s.L * s.delta_rho * s.g);
}

overturn_plan plan_overturn(const two_layers& s, std::int64_t n, int dimension, const cost& c) {
  overturn_plan p{};
  p.n = n;
  p.dx = s.L / static_cast<double>(n);
  p.eta = s.eta.value_or(damping_viscosity(s, n));
  const double dx2 = p.dx * p.dx;
  p.dt_sound = p.dx / s.c;
  p.dt_momentum = s.rho_min * dx2 / p.eta;
  p.dt_heat = s.rho_min * s.heat_capacity * dx2 / s.conductivity;
  // By (18) sound and momentum give one step up to rounding: it is called sound's.
  p.binding = p.dt_sound <= p.dt_momentum * (1.0 + 1e-12) ? "sound" : "momentum";
  p.dt = std::min(p.dt_sound, p.dt_momentum);
  if (p.dt_heat < p.dt) {
    p.dt = p.dt_heat;
    p.binding = "heat";
  }
  p.V = dx2 * s.delta_rho * s.g / (2.0 * p.eta);
  p.tau = s.L / p.V;
  p.steps = p.tau / p.dt;
  p.particles = std::pow(static_cast<double>(n), dimension);
  if (c.updates_per_second > 0.0) p.seconds = p.steps * c.evaluations_per_step * p.particles / c.updates_per_second;
  return p;
}

affordable afford(const two_layers& s, std::int64_t n, int dimension, const cost& c, const budget& b) {
  affordable a{};
  a.n = largest_that([&](std::int64_t side) {
    const auto p = plan_overturn(s, side, dimension, c);
    return p.steps <= b.steps && p.seconds <= b.seconds;
  });

  // Steps allowed at this n, whatever makes them.
  const double particles = std::pow(static_cast<double>(n), dimension);
  const double by_time = c.updates_per_second > 0.0
                             ? b.seconds * c.updates_per_second / (c.evaluations_per_step * particles)
                             : std::numeric_limits<double>::infinity();
  const double steps = std::min(b.steps, by_time);
  a.L = s.L * steps_of_20(s, n) / steps;  // (20), N ~ 1/L
  // tau ~ eta; dt = dt_CFL up to (18), dt_mom ~ 1/eta beyond it.
  const double damping = damping_viscosity(s, n);
  const double ratio = steps / steps_of_20(s, n);
  a.eta_over_damping = ratio <= 1.0 ? ratio : std::sqrt(ratio);
  a.eta = a.eta_over_damping * damping;
  return a;
}

}  // namespace tetsuame::relaxation
