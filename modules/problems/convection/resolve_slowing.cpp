#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <convection/options.hpp>
#include <numbers>

namespace tetsuame::convection {

namespace {

// Of the viscosity that answers at once: viscous and sonic limits of the step then agree; below kappa nothing is
// gained. Where the viscosity varies, compression counts three times.
constexpr double sonic_share = 0.35, sonic_share_varying = 0.12;
// Waves of shear are so many times as fast as slowed sound; those of compression then travel at 1.22 c_eff.
constexpr double shear_share = 0.7;
// m, the way of a wave of shear in the time of relaxation: 1/k, k = √2 π/L that of a roll as wide as high, whose waves
// are damped by half of what would stop their swinging.
double relaxation_length(const parameters& p) { return p.fluid.L / (std::numbers::sqrt2 * std::numbers::pi); }

// Only the steady state is right, and inertia and sound are free. Relaxed where one viscosity is everywhere: buoyancy
// of noise at the spacing, k, makes velocities k/k_0 times those of the Stokes flow before waves of shear die, and
// where ν is low at the bottom those are large (docs/theory/convection.md).
void slow_for_the_steady_state(const options& o, const relaxation::choice& wanted, parameters& p) {
  const auto& f = p.fluid;
  const double steady_mach = *o.convection.steady_mach;
  auto middle = f;  // the reference is that of the cold top
  middle.nu *= std::exp(p.law.log_middle);
  p.c_eff = p.c_end = relaxation::stokes_speed(middle, true) / steady_mach;
  p.sonic_share = p.law.varies ? sonic_share_varying : sonic_share;
  p.relaxed = !p.law.varies;
  p.slowing = relaxation::recommend(f, wanted);
  p.slowing.how = "rsst_vim";
  p.slowing.zeta_rule = p.slowing.xi_rule = "steady state";
  p.slowing.c_eff = p.c_eff;
  p.slowing.mach = p.slowing.speed / p.c_eff;
  follow(p, f.L / static_cast<double>(o.domain.particles[1]));
  p.lines.push_back(fmt::format(
      "slowed for the steady state: xi {:.4g} (Pr_eff {:.4g}{} max({} c_eff dx/kappa, 1)), zeta {:.4g} (c_eff "
      "{:.4g} m/s, {:.4g} kappa/L: Mach {:.3g} by Ra^(2/3) kappa/L); the way there is not a history",
      p.slowing.xi, p.nu_eff / f.kappa, p.relaxed ? ", at once" : " =", p.sonic_share, p.slowing.zeta, p.c_eff,
      p.c_eff * f.L / f.kappa, steady_mach));
  if (!p.relaxed) return;
  p.lines.push_back(fmt::format(
      "viscous force of a velocity that relaxes in {:.4g} s ({:.3g} L^2/kappa): waves of shear at {:.3g} c_eff, {:.3g} "
      "of the viscosity answers at once; the flow answers buoyancy late by {:.2g} of the time L/(Ra^(2/3) kappa/L)",
      p.relaxation_time, p.relaxation_time * f.kappa / (f.L * f.L), p.shear_speed / p.c_eff, p.instant_share,
      p.slowing.speed * f.L / (2.0 * std::numbers::pi * std::numbers::pi * p.nu_eff)));
}

void slow_by_rules(const relaxation::choice& wanted, parameters& p) {
  const auto& f = p.fluid;
  p.slowing = relaxation::recommend(f, wanted);
  p.c_eff = relaxation::sound_speed(f) / (p.slowing.zeta * p.slowing.xi);
  p.nu_eff = f.nu / (p.slowing.xi * p.slowing.xi);
  p.lines.push_back(
      fmt::format("slowed by {}: zeta {:.4g} ({}), xi {:.4g} ({}): c_eff {:.4g} m/s ({:.4g} kappa/L), Pr_eff {:.4g}, "
                  "expected Mach number {:.3g}{}",
                  p.slowing.how, p.slowing.zeta, p.slowing.zeta_rule, p.slowing.xi, p.slowing.xi_rule, p.c_eff,
                  p.c_eff * f.L / f.kappa, p.nu_eff / f.kappa, p.slowing.speed / p.c_eff,
                  p.steady ? "; inertia vanishes in the steady state: the way there is not a history" : ""));
}

// A flow that has no inertia answers the start at once, with all the buoyancy of the first, unresolved roll: it begins
// with the viscosity at which Ra is 1000, where that is as slow as slowed sound allows, and slowed sound follows.
void choose_ramp(const convection_options& c, parameters& p) {
  const auto& f = p.fluid;
  const double first = relaxation::rayleigh(f) / 1000.0, of_decade = 0.033 * f.L * f.L / f.kappa;
  const bool falls = p.relaxed && first > 1.0 && c.steady_tolerance > 0.0;
  p.ramp = c.viscosity_ramp.value_or(falls ? of_decade * std::log10(first) : 0.0);
  p.start = falls && p.ramp > 0.0 ? first : 1.0;
  if (p.start != 1.0)
    p.lines.push_back(
        fmt::format("the viscosity falls from {:.4g} times over {:.4g} s ({:.3g} L^2/kappa), slowed sound follows",
                    p.start, p.ramp, p.ramp * f.kappa / (f.L * f.L)));
}

}  // namespace

void resolve_slowing(options& o, parameters& p) {
  auto& c = o.convection;
  const auto& wanted = o.physics.relaxation;
  const auto& f = p.fluid;
  const bool viscous = relaxation::reached_balance(f, wanted.boundary_layers) == relaxation::balance::viscous;
  p.steady = c.target == "steady" || (c.target == "auto" && viscous);
  p.instant_share = 1.0;
  p.lines.push_back(fmt::format("Ra {:.6g}, Pr {:.6g}, M_th {:.4g}, {} balances buoyancy", relaxation::rayleigh(f),
                                relaxation::prandtl(f), relaxation::thermal_mach(f),
                                viscous ? "viscosity" : "inertia"));
  if (!c.steady_mach) c.steady_mach = p.law.varies ? 1.0 : 1.5;
  if (p.steady && !wanted.zeta && !wanted.xi)
    slow_for_the_steady_state(o, wanted, p);
  else
    slow_by_rules(wanted, p);
  choose_ramp(c, p);
  // The divergence that it makes goes with 1/ξ²: a tenth is as much where the response is relaxed. In a transient flow
  // viscosity may be too low to damp what the lagged correction feeds.
  if (!c.pressure_diffusion) c.pressure_diffusion = p.relaxed ? 0.02 : p.steady ? 0.2 : 0.4;
}

void follow(parameters& p, double dx) {
  if (p.sonic_share == 0.0) return;
  const auto& f = p.fluid;
  if (p.relaxed) {
    p.c_eff = p.c_end * std::pow(p.nu / f.nu, -2.0 / 3.0);
    p.shear_speed = shear_share * p.c_eff;
    p.relaxation_time = relaxation_length(p) / p.shear_speed;
  }
  const double at_once = std::max(p.sonic_share * p.c_eff * dx, f.kappa);
  p.nu_eff = at_once + relaxation_length(p) * p.shear_speed;
  p.instant_share = at_once / p.nu_eff;
  p.slowing.xi = std::sqrt(f.nu / p.nu_eff);
  p.slowing.zeta = relaxation::sound_speed(f) / (p.c_eff * p.slowing.xi);
  p.slowing.Pr_eff = p.nu_eff / f.kappa;
  p.slowing.viscous_share = p.instant_share;
  p.slowing.wave_share = p.relaxed ? std::hypot(1.0, shear_share) : 1.0;
  p.slowing.reynolds = p.slowing.speed * f.L / p.nu_eff;
}

}  // namespace tetsuame::convection
