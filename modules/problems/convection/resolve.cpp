// What the input leaves open: numbers that override dimensional values, slowed sound and inertia, viscous response,
// levels. Gravity: gravity_density.cpp; the law of viscosity: viscosity.cpp.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <convection/options.hpp>
#include <numbers>

namespace tetsuame::convection {

namespace {

// Keys of a choice that is not made, but for their defaults, which --describe and resolved.nml write.
void refuse_unused(const namelist::schema& schema, const convection_options& c) {
  const convection_options initially;
  const auto only_for = [&](bool used, const char* choice, const char* key, bool differs) {
    if (differs && !used) schema.fail("convection", key, fmt::format("is for {}", choice));
  };
  const bool table = c.viscosity_law == "table", melt = c.viscosity_law == "melt";
  const bool weighed = c.gravity_density == "equation_of_state";
  only_for(weighed, "gravity_density = 'equation_of_state'", "eos", c.eos != initially.eos);
  only_for(c.eos == "table", "eos = 'table'", "eos_table", !c.eos_table.empty());
  only_for(weighed, "gravity_density = 'equation_of_state'", "eos_dynamic_pressure", !c.eos_dynamic_pressure);
  only_for(weighed || melt, "gravity_density = 'equation_of_state'", "p_top", c.p_top != 0.0);
  only_for(table, "viscosity_law = 'table'", "viscosity_file", !c.viscosity_file.empty());
  only_for(melt, "viscosity_law = 'melt'", "composition", c.composition != initially.composition);
  only_for(melt, "viscosity_law = 'melt'", "melt_viscosity", c.melt_viscosity != initially.melt_viscosity);
  only_for(melt, "viscosity_law = 'melt'", "viscosity_min", c.viscosity_min != initially.viscosity_min);
  only_for(melt, "viscosity_law = 'melt'", "viscosity_max", c.viscosity_max != initially.viscosity_max);
  if ((c.viscosity_law == "constant" || table || melt) && (c.temperature_exponent != 0.0 || c.depth_exponent != 0.0))
    schema.fail("convection", "viscosity_law", "exponents belong to the 'exponential' law");
}

// Whether the expansivity says more than how strongly heat drives the flow: how much heat friction and compression make
// (alpha g L/c_p), which density an equation of state has; or the viscosity is a law's, up to a factor.
bool expansivity_is_bound(const convection_options& c) {
  return c.viscous_heating || c.adiabatic_heating || c.gravity_density == "equation_of_state" ||
         c.viscosity_law == "table" || c.viscosity_law == "melt";
}

// The input's with values that a Rayleigh or Prandtl number overrides; the number that is not given stays as it was. Of
// its own result it makes the same, to the bit.
relaxation::material_options consistent_material(const options& o, double dT) {
  const auto& c = o.convection;
  auto m = o.physics.material;
  const double kappa = m.conductivity / (m.density * m.heat_capacity), L = o.domain.length[1];
  const double drive = o.physics.g * dT * L * L * L / kappa;  // Ra = alpha drive/nu
  const double Ra = c.rayleigh.value_or(m.expansivity * drive / (m.viscosity / m.density));
  const double given_viscosity = m.viscosity;
  if (c.prandtl) m.viscosity = *c.prandtl * kappa * m.density;
  if (!c.rayleigh && m.viscosity == given_viscosity) return m;
  if (c.prandtl || (c.rayleigh && !expansivity_is_bound(c)))
    m.expansivity = Ra * (m.viscosity / m.density) / drive;
  else if (c.rayleigh)
    m.viscosity = m.expansivity * drive / Ra * m.density;
  return m;
}

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
  // A flow is some six times slower than the estimate; a lid is as fast as it is.
  p.c_eff = p.c_end = std::max(relaxation::stokes_speed(middle, true), 6.0 * p.lid) / steady_mach;
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
  const bool falls = p.relaxed && first > 1.0 && c.steady_tolerance > 0.0 && p.lid == 0.0;
  p.ramp = c.viscosity_ramp.value_or(falls ? of_decade * std::log10(first) : 0.0);
  p.start = falls && p.ramp > 0.0 ? first : 1.0;
  if (p.start != 1.0)
    p.lines.push_back(
        fmt::format("the viscosity falls from {:.4g} times over {:.4g} s ({:.3g} L^2/kappa), slowed sound follows",
                    p.start, p.ramp, p.ramp * f.kappa / (f.L * f.L)));
}

// Aim, slowed sound and inertia, viscous response, and how the viscosity comes to its law.
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
  p.lid = 0.0;
  for (const auto& side : o.walls.sides) p.lid = std::max(p.lid, std::abs(side.velocity));
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

void check_sides(const namelist::schema& schema, const options& o) {
  if (!o.heated_from_a_side()) return;
  if (o.temperature_hot() == o.temperature_cold())
    schema.fail("walls", "temperature_left",
                fmt::format("left and right hold {} K both: of two sides between which heat goes one must be hotter",
                            o.temperature_hot()));
  if (o.convection.gravity_density == "equation_of_state")
    schema.fail("convection", "gravity_density",
                "an equation of state is weighed about heat that is conducted from bottom to top: here it goes from "
                "side to side");
}

// Heated from a side, what is conducted there drives a flow: T_ref is the mean of both.
void resolve_way_of_heat(const options& o, parameters& p) {
  const double hot = o.temperature_hot(), cold = o.temperature_cold();
  const bool aside = o.heated_from_a_side();
  p.heat_axis = aside ? 0 : 1;
  p.heat_length = o.domain.length[p.heat_axis];
  p.heat_sign = o.hot_side() % 2 == 0 ? 1.0 : -1.0;
  p.T_bottom = aside ? 0.5 * (hot + cold) : hot;
  p.dT_reference = aside ? 0.0 : p.fluid.dT;
}

// Coarser lattices that still resolve the steady flow: a spacing not above the thermal boundary layer L/(2 Nu), with
// Nu = 0.25 Ra^(1/3) of free slip, and 12 particles in any case.
std::int64_t levels_that_resolve(const options& o, const parameters& p) {
  const auto& c = o.convection;
  if (!p.steady || c.viscosity_law != "constant" || c.steady_tolerance == 0.0) return 0;
  const double least = std::max(12.0, 2.0 * 0.25 * std::cbrt(relaxation::rayleigh(p.fluid)));
  const auto& d = o.domain;
  for (std::int64_t level = 0;; ++level) {
    const std::int64_t halved = std::int64_t{2} << level;
    for (std::size_t a = 0; a < static_cast<std::size_t>(d.dimension); ++a)
      if (d.particles[a] % halved != 0) return level;
    if (static_cast<double>(d.particles[1]) < least * static_cast<double>(halved)) return level;
  }
}

// The coarsest lattice must hold the kernel, and the fit of the heat through a wall (measures.hpp).
void check_lattices(const namelist::schema& schema, const options& o) {
  const auto& d = o.domain;
  auto coarsest = d;
  coarsest.particles = particles_of_level(o, o.convection.levels);
  const double dx = coarsest.dx(), support = std::max(run::support_over_dx(o.common.kernel), fit_radius) * dx;
  domain::check_widths(schema, coarsest, support + o.common.kernel.skin * dx, support);
}

void resolve_levels(const namelist::schema& schema, options& o, const parameters& p) {
  auto& c = o.convection;
  const auto& d = o.domain;
  if (c.levels < 0) c.levels = levels_that_resolve(o, p);
  if (c.levels > 0 && c.steady_tolerance == 0.0)
    schema.fail("convection", "levels",
                "coarser particles on the way to a steady state; without a steady_tolerance the history is the aim");
  for (std::size_t a = 0; a < static_cast<std::size_t>(d.dimension); ++a)
    if (d.particles[a] % (std::int64_t{1} << c.levels) != 0)
      schema.fail("convection", "levels",
                  fmt::format("{} particles cannot be halved {} times", d.particles[a], c.levels));
  check_lattices(schema, o);
}

}  // namespace

bool options::heated_from_a_side() const {
  const auto is = [&](std::size_t n, const char* wanted) { return walls::thermal_of(walls, n) == wanted; };
  return !domain.periodic[0] && is(0, "fixed") && is(1, "fixed") && is(2, "adiabatic") && is(3, "adiabatic");
}

std::size_t options::hot_side() const {
  if (!heated_from_a_side()) return 2;
  return walls.sides[0].temperature < walls.sides[1].temperature ? 1 : 0;
}

std::size_t options::cold_side() const { return heated_from_a_side() ? 1 - hot_side() : 3; }

std::array<std::int64_t, 3> particles_of_level(const options& o, std::int64_t level) {
  auto n = o.domain.particles;
  for (auto& along : n) along >>= level;
  return n;
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

parameters resolve(const namelist::schema& schema, options& o) {
  run::resolve(schema, o.common);
  domain::resolve(schema, demands, o.domain);
  const auto& c = o.convection;
  parameters p{};
  check_sides(schema, o);
  p.fluid = relaxation::layer(schema, o.physics, o.domain.length[1], o.temperature_hot(), o.temperature_cold());
  const auto& material = o.physics.material = consistent_material(o, o.temperature_hot() - o.temperature_cold());
  p.fluid.nu = material.viscosity / material.density;
  p.fluid.alpha = material.expansivity;
  resolve_way_of_heat(o, p);
  p.conductivity = material.conductivity;
  p.heat_capacity = material.heat_capacity;
  p.heating = c.heating * p.fluid.kappa / p.conductivity * p.fluid.rho;
  refuse_unused(schema, c);
  resolve_gravity(schema, o, p);
  resolve_viscosity(schema, o, p);
  p.nu = p.fluid.nu;
  p.reached = 1.0;
  resolve_slowing(o, p);
  resolve_levels(schema, o, p);
  p.compressibility = c.gravity_density == "separated"      ? 1.0
                      : p.weighed                           ? (c.eos_dynamic_pressure ? 1.0 : 0.0)
                      : c.gravity_density == "conventional" ? p.slowing.zeta * p.slowing.zeta
                                                            : 0.0;
  if (!o.common.time.t_end)
    o.common.time.t_end = static_cast<double>(1 + c.levels) * p.fluid.L * p.fluid.L / p.fluid.kappa;
  run::check_output(schema, o.common, o.domain, {"Viscosity", "Volume"});
  p.regions = regions::all(schema, of_regions, o.of_regions, static_cast<int>(o.domain.dimension), o.domain.length,
                           o.domain.dx());
  p.sources = sources::all(schema, o.of_sources, o.of_regions, static_cast<int>(o.domain.dimension), o.domain.length,
                           o.domain.dx());
  if (o.common.start.file.empty()) return p;
  if (o.initial.temperature_noise > 0.0)
    schema.fail("initial", "temperature_noise", "a snapshot says how warm each particle is");
  if (p.regions.any()) schema.fail("initial", "file", "a snapshot says what is where, and so does &region");
  if (c.levels > 0) schema.fail("convection", "levels", "a snapshot has particles of one spacing: expected 0");
  return p;
}

}  // namespace tetsuame::convection
