#include <algorithm>
#include <cmath>
#include <foundation/error.hpp>
#include <relaxation/steps.hpp>

namespace tetsuame::relaxation {

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

std::int64_t largest_n_in_steps(const fluid_layer& f, const recommendation& r, double steps, double fraction) {
  return largest_that([&](std::int64_t n) { return plan_convection(f, r, n, 2, 1.0, fraction, {}).steps <= steps; });
}

std::int64_t largest_n_in_seconds(const fluid_layer& f, const recommendation& r, int dimension, double volume_ratio,
                                  double fraction, const cost& c, double seconds) {
  if (!(c.updates_per_second > 0.0)) foundation::fail_input("a run time needs the rate of updates of the machine");
  return largest_that([&](std::int64_t n) {
    return plan_convection(f, r, n, dimension, volume_ratio, fraction, c).seconds <= seconds;
  });
}

}  // namespace tetsuame::relaxation
