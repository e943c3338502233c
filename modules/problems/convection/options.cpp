#include <fmt/format.h>

#include <cmath>
#include <convection/options.hpp>
#include <foundation/error.hpp>

namespace tetsuame::convection {

namespace {

using namelist::between, namelist::for_expert, namelist::positive, namelist::up_to;

constexpr const char* g = "convection";

const domain::demands demands{
    .walls_below_and_above = "heat comes from the bottom and leaves at the top: these are walls", .jitters = false};

void declare_numbers(namelist::schema& schema, convection_options& o) {
  schema.add(g, "rayleigh", o.rayleigh,
             {.minimum = 0.0,
              .exclusive_minimum = true,
              .meaning = "overrides the expansivity and keeps the Prandtl number; the viscosity where the expansivity "
                         "is not free: heat of friction or of compression, an equation of state, viscosity_law "
                         "'table' or 'melt'"});
  schema.add(g, "prandtl", o.prandtl,
             {.minimum = 0.0,
              .exclusive_minimum = true,
              .meaning = "overrides the viscosity and keeps the Rayleigh number, by the expansivity"});
  schema.add(g, "viscous_heating", o.viscous_heating, {.meaning = "heat from friction, 2 nu e:e"});
  schema.add(g, "adiabatic_heating", o.adiabatic_heating,
             {.meaning = "cooling of what rises, alpha g v_y T; temperatures are absolute then"});
  schema.add(g, "heating", o.heating, {.unit = "W/kg", .meaning = "from inside, uniform"});
}

void declare_aim(namelist::schema& schema, convection_options& o) {
  schema.add(g, "target", o.target,
             {.choices = {"auto", "steady", "transient"},
              .meaning = "steady: inertia acts on the rate of velocity at a place, and vanishes in a steady flow, "
                         "whatever xi; transient: on D v/D t; auto: steady where viscosity balances buoyancy"});
  schema.add(g, "steady_tolerance", o.steady_tolerance,
             between(0.0, 1.0,
                     "the run ends when Nusselt number and rms velocity change by less over six turnovers; 0: at "
                     "t_end only"));
  schema.add(
      g, "levels", o.levels,
      for_expert(between(-1, 10,
                         "the run starts with twice the particle spacing, so many times twice, and goes on with half "
                         "of it whenever the flow is steady to ten times steady_tolerance, which it needs. -1: as many "
                         "as resolve the flow where only the steady state is the aim and the viscosity is constant, "
                         "else none")));
  schema.add(g, "steady_mach", o.steady_mach,
             for_expert(up_to(10.0,
                              "target steady: Ra^(2/3) kappa/L over slowed sound; the flow itself is about six times "
                              "slower: at 1.5, Mach 0.25. Not given: 1.5, where the viscosity varies 1")));
}

void declare_gravity(namelist::schema& schema, convection_options& o) {
  schema.add(g, "gravity_density", o.gravity_density,
             {.choices = {"boussinesq", "separated", "conventional", "equation_of_state"},
              .meaning = "gravity feels -alpha T', with p'/K_0 (GDS), or with the slowed fluid's zeta^2 p'/K_0; or the "
                         "density of an equation of state at the pressure of a column at rest, and p'/K"});
  std::vector<std::string> materials(eos::names().begin(), eos::names().end());
  schema.add(g, "eos", o.eos,
             {.choices = materials,
              .meaning = "whose density gravity feels, temperatures are absolute then; linear: of &material"});
  schema.add(
      g, "p_top", o.p_top,
      {.unit = "Pa", .meaning = "pressure on top of the column at rest, for eos and viscosity by melt fraction"});
  schema.add(g, "eos_dynamic_pressure", o.eos_dynamic_pressure,
             {.expert = true,
              .meaning = "with eos: gravity feels p'/K too; the heat of that compression is not in the balance"});
}

void declare_viscosity(namelist::schema& schema, convection_options& o) {
  schema.add(
      g, "viscosity_law", o.viscosity_law,
      {.choices = {"constant", "blankenbach_2a", "blankenbach_2b", "exponential", "table", "melt"},
       .meaning = "nu = nu_0 exp(-b (T - T_top)/DeltaT + c depth/L); 2a: b = ln 1000, 2b: b = ln 16384, c = ln 64; "
                  "exponential: exponents of &expert; of "
                  "viscosity_file; or by melt fraction between the mantle's solidus and liquidus at the pressure of a "
                  "column at rest (temperatures are absolute then); a Rayleigh number given scales the last two"});
  schema.add(g, "viscosity_file", o.viscosity_file,
             {.meaning = "law 'table': temperature (K), depth (m), viscosity (Pa s), a line for each pair, ascending, "
                         "depth fastest; ln nu is bilinear between"});
  const auto limit = [&](const char* key, double& value, const char* meaning) {
    schema.add(g, key, value, for_expert(positive("Pa s", meaning)));
  };
  limit("viscosity_min", o.viscosity_min, "law 'melt': the viscosity is not below this");
  limit("viscosity_max", o.viscosity_max, "law 'melt': nor above this");
  schema.add(g, "viscosity_ramp", o.viscosity_ramp,
             {.unit = "s",
              .minimum = 0.0,
              .meaning = "the exponents grow from zero over this time; with one viscosity and the steady state as the "
                         "aim it falls over this time from that at which Ra is 1000. Not given: 0; falling, 0.033 "
                         "L^2/kappa for each power of ten"});
  schema.add(g, "temperature_exponent", o.temperature_exponent,
             {.expert = true, .meaning = "b of the exponential law"});
  schema.add(g, "depth_exponent", o.depth_exponent, {.expert = true, .meaning = "c of the exponential law"});
  schema.add(g, "composition", o.composition,
             {.choices = {"peridotitic", "chondritic"},
              .expert = true,
              .meaning = "law 'melt': of the liquidus above 20 GPa"});
}

void declare_noise(namelist::schema& schema, convection_options& o) {
  schema.add(
      g, "pressure_diffusion", o.pressure_diffusion,
      for_expert(between(0.0, 1.0,
                         "delta of the term that smooths the pressure's noise; not given: target transient 0.4, steady "
                         "0.2, with one viscosity 0.02")));
  schema.add(
      g, "remap_diffusion", o.remap_diffusion,
      for_expert(between(
          0.0, 10.0, "of the noise in temperature and velocity, times the speed with which particles are shifted")));
  schema.add(g, "shifting", o.shifting, for_expert(between(0.0, 10.0, "strength of the particle shifting")));
}

// Keys of a choice that is not made, but for their defaults, which --describe and resolved.nml write.
void refuse_unused(const namelist::schema& schema, const convection_options& c) {
  const convection_options initially;
  const auto only_for = [&](bool used, const char* choice, const char* key, bool differs) {
    if (differs && !used) schema.fail(g, key, fmt::format("is for {}", choice));
  };
  const bool table = c.viscosity_law == "table", melt = c.viscosity_law == "melt";
  const bool weighed = c.gravity_density == "equation_of_state";
  only_for(weighed, "gravity_density = 'equation_of_state'", "eos", c.eos != initially.eos);
  only_for(weighed, "gravity_density = 'equation_of_state'", "eos_dynamic_pressure", !c.eos_dynamic_pressure);
  only_for(weighed || melt, "gravity_density = 'equation_of_state'", "p_top", c.p_top != 0.0);
  only_for(table, "viscosity_law = 'table'", "viscosity_file", !c.viscosity_file.empty());
  only_for(melt, "viscosity_law = 'melt'", "composition", c.composition != initially.composition);
  only_for(melt, "viscosity_law = 'melt'", "viscosity_min", c.viscosity_min != initially.viscosity_min);
  only_for(melt, "viscosity_law = 'melt'", "viscosity_max", c.viscosity_max != initially.viscosity_max);
  if ((c.viscosity_law == "constant" || table || melt) && (c.temperature_exponent != 0.0 || c.depth_exponent != 0.0))
    schema.fail(g, "viscosity_law", "exponents belong to the 'exponential' law");
}

// Whether the expansivity says more than how strongly heat drives the flow: how much heat friction and compression make
// (alpha g L/c_p), which density an equation of state has; or the viscosity is a law's, up to a factor.
bool expansivity_is_bound(const convection_options& c) {
  return c.viscous_heating || c.adiabatic_heating || c.gravity_density == "equation_of_state" ||
         c.viscosity_law == "table" || c.viscosity_law == "melt";
}

// The input's with values that a Rayleigh or Prandtl number overrides; the number that is not given stays as it was.
relaxation::material_options consistent_material(const options& o, double dT) {
  const auto& c = o.convection;
  auto m = o.physics.material;
  const double kappa = m.conductivity / (m.density * m.heat_capacity), L = o.domain.length[1];
  const double drive = o.physics.g * dT * L * L * L / kappa;  // Ra = alpha drive/nu
  const double Ra = c.rayleigh.value_or(m.expansivity * drive / (m.viscosity / m.density));
  if (c.prandtl) m.viscosity = *c.prandtl * kappa * m.density;
  if (c.prandtl || (c.rayleigh && !expansivity_is_bound(c)))
    m.expansivity = Ra * (m.viscosity / m.density) / drive;
  else if (c.rayleigh)
    m.viscosity = m.expansivity * drive / Ra * m.density;
  return m;
}

// Coarser lattices that still resolve the steady flow: a spacing not above the thermal boundary layer L/(2 Nu), with
// Nu = 0.25 Ra^(1/3) of free slip, and 24 particles in any case.
std::int64_t levels_that_resolve(const options& o, const parameters& p) {
  const auto& c = o.convection;
  if (!p.steady || c.viscosity_law != "constant" || c.steady_tolerance == 0.0) return 0;
  const double least = std::max(24.0, 2.0 * 0.25 * std::cbrt(relaxation::rayleigh(p.fluid)));
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

void declare(namelist::schema& schema, options& o) {
  domain::declare(schema, demands, o.domain);
  relaxation::declare(schema, o.physics);
  schema.group(g, "numbers, aim, gravity and viscosity");
  declare_numbers(schema, o.convection);
  declare_aim(schema, o.convection);
  declare_gravity(schema, o.convection);
  declare_viscosity(schema, o.convection);
  declare_noise(schema, o.convection);
  schema.group("initial", "start: conduction, at rest, with a disturbance");
  schema.add("initial", "perturbation", o.initial.perturbation,
             between(-1.0, 1.0, "a of T = T_conductive + a DeltaT cos(half_waves pi x/length_x) sin(pi y/L)"));
  schema.add("initial", "half_waves", o.initial.half_waves, between(0, 1000, "along x"));
  auto& sides = o.walls.sides;
  o.walls.slip = "free_slip";
  sides[2].thermal = sides[3].thermal = "fixed";
  sides[2].temperature = 1000.0;
  sides[3].temperature = 0.0;
  walls::declare(schema, {.flux = true}, o.walls);
  o.common.kernel.skin = 0.6;  // a particle moves by a sixth of its spacing and more in one step of slowed sound
  run::declare(schema, o.common, {.single_pairs = true, .keeps_rate = true});
}

std::array<std::int64_t, 3> particles_of_level(const options& o, std::int64_t level) {
  auto n = o.domain.particles;
  for (auto& along : n) along >>= level;
  return n;
}

parameters resolve(const namelist::schema& schema, options& o) {
  run::resolve(schema, o.common);
  domain::resolve(schema, demands, o.domain);
  const auto& c = o.convection;
  parameters p{};
  p.fluid = relaxation::layer(schema, o.physics, o.domain.length[1], o.temperature_bottom(), o.temperature_top());
  const auto material = consistent_material(o, o.temperature_bottom() - o.temperature_top());
  p.fluid.nu = material.viscosity / material.density;
  p.fluid.alpha = material.expansivity;
  p.T_bottom = o.temperature_bottom();
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
  run::check_output(schema, o.common);
  return p;
}

}  // namespace tetsuame::convection
