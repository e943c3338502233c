#include <algorithm>
#include <cmath>
#include <foundation/error.hpp>
#include <two_fluids/recommended.hpp>
#include <two_fluids/step_limit.hpp>

namespace tetsuame::two_fluids {

namespace {

constexpr double most_zeta2 = 1e12, most_xi2 = 1e24;

double wave_number(const parameters& p) { return std::hypot(p.k_x, p.k_z); }

std::array<place, 2> at_contact(const parameters& p) {
  return {p.base->at(p.interface * (1.0 - 1e-12)), p.base->at(p.interface)};
}

template <int D>
step_bounds bounds_of(options o, const parameters& p, const slowing_options& slowed) {
  o.slowing = slowed;
  const auto kernel = kernels::make<D>(o.common.kernel.name, o.common.kernel.h_over_dx * p.dx);
  const auto weights = o.scheme.viscous_order == 4 ? fourth_order_weights<D>(kernel, p.dx) : viscous_weights{};
  return bounds_of<D>(o, p, kernel, p.dx, weights);
}

// The largest factor of 1 … most at which `error`, which rises from 0 at 1, is within the tolerance. Sought from below:
// far beyond it boundary layers are too thin for the theory.
template <class F>
double largest_within(double tolerance, double most, const F& error) {
  double low = 1.0, high = 8.0;
  while (error(high) <= tolerance) {
    if (high == most) return most;
    low = high;
    high = std::min(most, 8.0 * high);
  }
  while (high > low * 1.001) {
    const double middle = std::sqrt(low * high);
    (error(middle) <= tolerance ? low : high) = middle;
  }
  return low;
}

// ζ², and ξ² of that material which takes less of it.
slowing_options slowed_by(const options& o, const parameters& p, double zeta2, double xi2) {
  slowing_options s{.zeta = std::sqrt(zeta2)};
  if (o.material[0].viscosity == o.material[1].viscosity) {
    s.xi = std::sqrt(xi2);
    return s;
  }
  const auto rest = at_contact(p);
  std::array<double, 2> nu;
  for (const std::size_t n : {0, 1}) nu[n] = o.material[n].viscosity / rest[n].density;
  for (const std::size_t n : {0, 1}) s.xi_of[n] = std::sqrt(std::min(most_xi2, xi2 * nu[n] / std::min(nu[0], nu[1])));
  if (xi2 == 1.0) s.xi_of = {};
  return s;
}

}  // namespace

slowing_scales slowing_scales_of(const options& o, const parameters& p) {
  if (!p.growth) foundation::fail_input("how far to slow is by the growth rate, and there is none: " + p.theory_about);
  const double L = o.domain.length[1], k = wave_number(p);
  slowing_scales s{};
  double softest = std::numeric_limits<double>::infinity();
  for (const std::size_t n : {0, 1}) {
    const place here = at_contact(p)[n];
    const auto e = eos::evaluate((*p.material)[n], here.density, here.temperature);
    const bool adiabatic = o.temperature_law == "adiabatic";
    softest = std::min(softest, adiabatic ? here.density * e.sound_speed * e.sound_speed : e.K_T);
    s.inertia_share[n] = *p.growth * here.density / (o.material[n].viscosity * k * k);
    s.sound = std::max(s.sound, e.sound_speed);
  }
  s.dynamic_pressure = std::abs(p.density_difference) * o.gravity * L / (2.0 * softest);
  s.speed = 0.25 * *p.growth * L;
  return s;
}

double growth_error(const options& o, const parameters& p, const slowing_options& slowed) {
  if (!slowed.any()) return 0.0;
  return theory::growth_rate(slowed_layers(o, p, slowed), wave_number(p)) / *p.growth - 1.0;
}

slowing_options widest_slowing(const options& o, const parameters& p, double tolerance) {
  const auto within = [&](double most, const auto& slowed) {
    return std::sqrt(
        largest_within(tolerance, most, [&](double x) { return std::abs(growth_error(o, p, slowed(std::sqrt(x)))); }));
  };
  return {.zeta = within(most_zeta2, [](double x) { return slowing_options{.zeta = x}; }),
          .xi = within(most_xi2, [](double x) { return slowing_options{.xi = x}; })};
}

recommended_slowing recommend_slowing(const options& o, const parameters& p, double tolerance) {
  if (!p.growth) foundation::fail_input("how far to slow is by the growth rate, and there is none: " + p.theory_about);
  const auto within = [&](double most, const auto& slowed) {
    return largest_within(tolerance, most, [&](double x) { return std::abs(growth_error(o, p, slowed(x))); });
  };
  const double zeta2 = within(most_zeta2, [&](double x) { return slowed_by(o, p, x, 1.0); });
  const double xi2 = within(most_xi2, [&](double x) { return slowed_by(o, p, 1.0, x); });
  const auto bounds = [&](const slowing_options& s) {
    return o.domain.dimension == 3 ? bounds_of<3>(o, p, s) : bounds_of<2>(o, p, s);
  };
  // Errors are in proportion to ζ² - 1 and ξ² - 1: a part of the tolerance to each.
  recommended_slowing r{};
  const auto as_is = bounds({});
  r.step_as_is = r.step = as_is.step.dt;
  r.sound_as_is = as_is.sound;
  r.viscous_as_is = as_is.viscous;
  constexpr int parts = 20;
  double share = 0.0;
  for (int part = 0; part <= parts; ++part) {
    const double of_sound = static_cast<double>(part) / parts;
    const auto s = slowed_by(o, p, 1.0 + of_sound * (zeta2 - 1.0), 1.0 + (1.0 - of_sound) * (xi2 - 1.0));
    const double dt = bounds(s).step.dt;
    if (dt <= r.step * 1.001) continue;
    r.step = dt;
    r.slowing = s;
    share = of_sound;
  }
  r.error = growth_error(o, p, r.slowing);
  r.error_of_sound = growth_error(o, p, slowed_by(o, p, 1.0 + share * (zeta2 - 1.0), 1.0));
  r.error_of_inertia = growth_error(o, p, slowed_by(o, p, 1.0, 1.0 + (1.0 - share) * (xi2 - 1.0)));
  return r;
}

}  // namespace tetsuame::two_fluids
