#include <fmt/format.h>

#include <boussinesq/options.hpp>
#include <boussinesq/wall_gradient.hpp>
#include <cmath>
#include <foundation/error.hpp>
#include <melting/melting.hpp>
#include <numbers>

namespace tetsuame::boussinesq {

namespace {

void declare(namelist::schema& schema, convection_options& o) {
  const char* g = "convection";
  schema.group(g, "numbers, slowing and scheme");
  schema.add(
      g, "rayleigh", o.rayleigh,
      {.minimum = 0.0,
       .exclusive_minimum = true,
       .meaning = "overrides the expansivity and keeps the Prandtl number; the viscosity where the expansivity is "
                  "not free: heat of friction or of compression, an equation of state, viscosity_law 'table' or "
                  "'melt'"});
  schema.add(g, "prandtl", o.prandtl,
             {.minimum = 0.0,
              .exclusive_minimum = true,
              .meaning = "overrides the viscosity and keeps the Rayleigh number, by the expansivity"});
  schema.add(g, "zeta", o.zeta, {.minimum = 0.0, .maximum = 1e30, .meaning = "sound is slowed by it; 0: recommended"});
  schema.add(g, "xi", o.xi,
             {.minimum = 0.0, .maximum = 1e30, .meaning = "inertia is multiplied by its square; 0: recommended"});
  schema.add(g, "steady_tolerance", o.steady_tolerance,
             {.minimum = 0.0,
              .maximum = 1.0,
              .meaning = "the run ends when Nusselt number and rms velocity change by less; 0: at t_end only"});
  schema.add(g, "steady_turnovers", o.steady_turnovers,
             {.minimum = 0.0,
              .maximum = 1000.0,
              .exclusive_minimum = true,
              .meaning = "steadiness and averages are over so many L/v_rms, and at least 0.01 L^2/kappa"});
  schema.add(
      g, "levels", o.levels,
      {.minimum = -1,
       .maximum = 10,
       .meaning =
           "the run starts with twice the particle spacing, so many times twice, and goes on with half of "
           "it whenever the flow is steady; needs a steady_tolerance. -1: as many as resolve the flow where only "
           "the steady state is the aim and the viscosity is constant, else none"});
  schema.add(g, "level_tolerance", o.level_tolerance,
             {.minimum = 0.0, .maximum = 1.0, .meaning = "a coarser level is steady when it changes by less"});
  schema.add(g, "level_time", o.level_time,
             {.unit = "s", .minimum = 0.0, .meaning = "at most, of each coarser level; 0: until it is steady"});
  schema.add(
      g, "target", o.target,
      {.choices = {"auto", "steady", "transient"},
       .meaning = "steady: inertia acts on the rate of velocity at a place, and vanishes in a steady flow, whatever "
                  "xi; transient: on D v/D t; auto: steady where viscosity balances buoyancy"});
  schema.add(g, "steady_mach", o.steady_mach,
             {.minimum = 0.0,
              .maximum = 10.0,
              .exclusive_minimum = true,
              .meaning = "target steady: Ra^(2/3) kappa/L over slowed sound; the flow itself is about six times "
                         "slower: at 1.5, Mach 0.25"});
  schema.add(
      g, "viscous_response", o.viscous_response,
      {.choices = {"auto", "instant", "relaxed"},
       .meaning = "target steady: the viscous force is that of the velocity, or of one that relaxes to it (a "
                  "Jeffreys fluid: shear travels as waves), which lets inertia be smaller by about a third of "
                  "the particles along the height; auto: relaxed where zeta and xi are not given and the viscosity is "
                  "constant"});
  schema.add(
      g, "shear_damping", o.shear_damping,
      {.minimum = 0.1,
       .maximum = 1000.0,
       .meaning =
           "relaxed viscous response: rate of relaxation over k_0 c_s, k_0 = sqrt(2) pi/L, c_s the speed of "
           "shear; larger: waves die faster, and inertia is heavier. Not given: 1, where the viscosity varies 10"});
  schema.add(g, "gravity_density", o.gravity_density,
             {.choices = {"boussinesq", "separated", "conventional", "equation_of_state"},
              .meaning = "gravity feels -alpha T', with p'/K_0 (GDS), or with the slowed fluid's zeta^2 p'/K_0; or the "
                         "density of an equation of state at the pressure of a column at rest, and p'/K"});
  std::vector<std::string> materials(eos::names().begin(), eos::names().end());
  schema.add(g, "eos", o.eos,
             {.choices = materials,
              .meaning = "whose density gravity feels, temperatures are absolute then; linear: of &material"});
  schema.add(g, "eos_dynamic_pressure", o.eos_dynamic_pressure,
             {.meaning = "with eos: gravity feels p'/K too; the heat of that compression is not in the balance"});
  schema.add(
      g, "p_top", o.p_top,
      {.unit = "Pa", .meaning = "pressure on top of the column at rest, for eos and viscosity by melt fraction"});
  schema.add(g, "pressure", o.pressure,
             {.choices = {"eulerian", "lagrangian"}, .meaning = "rate of pressure at a place, or along the flow"});
  schema.add(g, "scheme", o.scheme,
             {.choices = {"consistent", "plain"},
              .meaning = "plain: unless given, operator = 'sum', pressure = 'lagrangian', no diffusion of "
                         "pressure and of the remapped temperature, and target = 'transient'"});
  schema.add(
      g, "operator", o.operators,
      {.choices = {"sum", "trace", "consistent", "corrected"},
       .meaning = "sum: plain sums, without curvature at walls; Laplacian with the sum of the second moments right, or "
                  "all of them; that with the deferred correction"});
  schema.add(g, "lagging", o.lagging,
             {.choices = {"auto", "step", "evaluation", "extrapolated"},
              .meaning = "what the derivatives keep (deferred correction, tensor, gradients of the noise term, "
                         "curvatures at walls) is that of the start of the step, of the evaluation before, or "
                         "extrapolated to the middle of the step (rkl2, rkc2); auto: extrapolated where it can be, "
                         "else step"});
  schema.add(g, "pressure_diffusion", o.pressure_diffusion,
             {.minimum = 0.0,
              .maximum = 1.0,
              .meaning = "delta of the term that smooths the pressure's noise; not given: target transient 0.4, steady "
                         "0.2, with a relaxed viscous response 0.02"});
  schema.add(g, "remap_diffusion", o.remap_diffusion,
             {.minimum = 0.0,
              .maximum = 10.0,
              .meaning = "of the noise in temperature and velocity, times the speed with which particles are spread"});
  schema.add(g, "shifting", o.shifting,
             {.minimum = 0.0, .maximum = 10.0, .meaning = "strength of the particles' spreading"});
  schema.add(g, "line_forces", o.line_forces,
             {.choices = {"auto", "equal", "isotropic"},
              .meaning = "viscosity that varies: all lines between particles alike, or (2-D only, there the choice of "
                         "'auto') weighted so that the viscosity is the same in all directions"});
  schema.add(
      g, "viscosity_law", o.viscosity_law,
      {.choices = {"constant", "blankenbach_2a", "blankenbach_2b", "exponential", "table", "melt"},
       .meaning = "nu = nu_0 exp(-b (T - T_top)/DeltaT + c depth/L); 2a: b = ln 1000, 2b: b = ln 16384, c = ln 64; of "
                  "viscosity_file; or by melt fraction between the mantle's solidus and liquidus at the pressure of a "
                  "column at rest (temperatures are absolute then); a Rayleigh number given scales the last two"});
  schema.add(g, "viscosity_file", o.viscosity_file,
             {.meaning = "law 'table': temperature (K), depth (m), viscosity (Pa s), a line for each pair, ascending, "
                         "depth fastest; ln nu is bilinear between"});
  schema.add(g, "composition", o.composition,
             {.choices = {"peridotitic", "chondritic"}, .meaning = "law 'melt': of the liquidus above 20 GPa"});
  const auto limit = [&](const char* key, double& value, const char* meaning) {
    schema.add(g, key, value, {.unit = "Pa s", .minimum = 0.0, .exclusive_minimum = true, .meaning = meaning});
  };
  limit("viscosity_min", o.viscosity_min, "law 'melt': the viscosity is not below this");
  limit("viscosity_max", o.viscosity_max, "law 'melt': nor above this");
  schema.add(g, "temperature_exponent", o.temperature_exponent, {.meaning = "b of the exponential law"});
  schema.add(g, "depth_exponent", o.depth_exponent, {.meaning = "c of the exponential law"});
  schema.add(
      g, "viscosity_ramp", o.viscosity_ramp,
      {.unit = "s",
       .minimum = 0.0,
       .meaning = "the exponents grow from zero over this time; not given: with a relaxed viscous response and one "
                  "viscosity, 0.033 L^2/kappa for each power of ten that the viscosity falls by, else 0"});
  schema.add(g, "viscosity_start", o.viscosity_start,
             {.minimum = 0.0,
              .maximum = 1e9,
              .exclusive_minimum = true,
              .meaning = "at the start the viscosity is so many times as high; this goes over viscosity_ramp as well; "
                         "not given: with a relaxed viscous response so many that Ra is 1000, else 1"});
  schema.add(g, "viscous_heating", o.viscous_heating, {.meaning = "heat from friction, 2 nu e:e"});
  schema.add(g, "adiabatic_heating", o.adiabatic_heating,
             {.meaning = "cooling of what rises, alpha g v_y T; temperatures are absolute then"});
  schema.add(g, "heating", o.heating, {.unit = "W/kg", .meaning = "from inside, uniform"});
}

// Whether the expansivity says more than how strongly heat drives the flow: how much heat friction and compression make
// (alpha g L/c_p), which density an equation of state has; or the viscosity is a law's, up to a factor.
bool expansivity_is_bound(const convection_options& c) {
  return c.viscous_heating || c.adiabatic_heating || c.gravity_density == "equation_of_state" ||
         c.viscosity_law == "table" || c.viscosity_law == "melt";
}

// Values that a Rayleigh or Prandtl number overrides; the number that is not given stays that of the input's values.
void make_consistent(const options& o, relaxation::material_options& m, double dT) {
  const auto& c = o.convection;
  const double kappa = m.conductivity / (m.density * m.heat_capacity), L = o.physics.domain.length[1];
  const double drive = o.physics.g * dT * L * L * L / kappa;  // Ra = alpha drive/nu
  const double Ra = c.rayleigh.value_or(m.expansivity * drive / (m.viscosity / m.density));
  if (c.prandtl) m.viscosity = *c.prandtl * kappa * m.density;
  if (c.prandtl || (c.rayleigh && !expansivity_is_bound(c)))
    m.expansivity = Ra * (m.viscosity / m.density) / drive;
  else if (c.rayleigh)
    m.viscosity = m.expansivity * drive / Ra * m.density;
}

// The density that gravity weighs, if it is that of an equation of state.
void weigh(const namelist::schema& schema, const options& o, parameters& p) {
  const auto& c = o.convection;
  const auto& f = p.fluid;
  const double c_p = o.physics.material.heat_capacity;
  p.dissipation_number = f.alpha * f.g * f.L / c_p;
  if (c.gravity_density != "equation_of_state") {
    // As written by --describe and in resolved.nml they say nothing.
    const auto refuse = [&](const char* key, bool differs) {
      if (differs) schema.fail("convection", key, "is for gravity_density = 'equation_of_state'");
    };
    refuse("eos", c.eos != "linear");
    refuse("eos_dynamic_pressure", !c.eos_dynamic_pressure);
    refuse("p_top", c.p_top != 0.0 && c.viscosity_law != "melt");
    return;
  }
  const double T_top = o.temperature_top(), T_bottom = o.temperature_bottom();
  if (!(T_top > 0.0))
    schema.fail("convection", "gravity_density",
                "an equation of state needs absolute temperatures: that of the top must be above 0 K");
  eos::material_options wanted;
  wanted.name = c.eos;
  if (c.eos == "linear") {
    wanted.reference_pressure = c.p_top;
    wanted.reference_density = f.rho;
    wanted.reference_temperature = T_top;
    wanted.bulk_modulus = f.K;
    wanted.thermal_expansivity = f.alpha;
    wanted.heat_capacity = c_p;
  }
  const auto material = schema.placed("convection", "eos", [&] { return eos::make(wanted); });
  p.weighed = schema.placed("convection", "eos", [&] {
    return std::make_shared<gravity_density>(material,
                                             gravity_density::layer{f.L, f.g, f.rho, c.p_top, T_top, T_bottom});
  });
  const auto& w = *p.weighed;
  constexpr int n = 100;
  double mean = 0.0;
  for (int k = 0; k < n; ++k) {
    const double y = f.L * (k + 0.5) / n;
    mean += w.slope(y, w.temperature(y)) / n;
  }
  p.dissipation_number = mean * f.L / c_p;
  double least = c_p, most = c_p;  // of the heat capacity
  for (int k = 0; k <= n && c.adiabatic_heating; ++k)
    for (const double T : {T_top, 0.5 * (T_top + T_bottom), T_bottom}) {
      const double here = c_p + w.heat_capacity_change(f.L * k / n, T);
      least = std::min(least, here), most = std::max(most, here);
    }
  if (!(least > 0.0))
    schema.fail(
        "convection", "eos",
        fmt::format("with this equation of state the heat capacity would fall to {:.4g} J/(kg K): give a larger "
                    "heat_capacity, or leave adiabatic_heating",
                    least));
  p.lines.push_back(fmt::format(
      "gravity feels the density of {}: at rest {:.4g} to {:.4g} kg/m3, {:.4g} to {:.4g} Pa, adiabat {:.4g} to {:.4g} "
      "K, expansivity {:.3g} to {:.3g} 1/K from top to bottom; heat capacity {:.4g} to {:.4g} J/(kg K); dissipation "
      "number {:.4g}",
      eos::about(material).name, w.density(f.L), w.density(0.0), w.pressure(f.L), w.pressure(0.0), w.temperature(f.L),
      w.temperature(0.0), w.expansivity(f.L), w.expansivity(0.0), least, most, p.dissipation_number));
}

// Pressure of a column at rest, Pa.
double pressure_at(const options& o, const parameters& p, double depth) {
  if (p.weighed) return p.weighed->pressure(p.fluid.L - depth);
  return o.convection.p_top + p.fluid.rho * p.fluid.g * depth;
}

std::vector<double> evenly(double first, double last, std::size_t steps) {
  std::vector<double> all;
  for (std::size_t k = 0; k <= steps; ++k)
    all.push_back(std::lerp(first, last, static_cast<double>(k) / static_cast<double>(steps)));
  return all;
}

// Melt fraction f between solidus and liquidus, a suspension (melting/melting.hpp).
viscosity_table by_melt(const options& o, const parameters& p) {
  const auto& c = o.convection;
  const auto kind =
      c.composition == "chondritic" ? melting::composition::chondritic : melting::composition::peridotitic;
  const double T_top = o.temperature_top(), T_bottom = o.temperature_bottom();
  const double beyond = 0.1 * std::abs(T_bottom - T_top);
  const double coldest = std::max(std::min(T_top, T_bottom) - beyond, 1.0),
               hottest = std::max(T_top, T_bottom) + beyond;
  return {evenly(coldest, hottest, 512), evenly(0.0, p.fluid.L, 256), [&](double T, double depth) {
            const double P = pressure_at(o, p, depth);
            const double f = melting::melt_fraction(T, melting::solidus(P), melting::liquidus(kind, P));
            return std::clamp(melting::suspension_viscosity(T, f), c.viscosity_min, c.viscosity_max);
          }};
}

viscosity_table from_file(const namelist::schema& schema, const options& o, double L) {
  const auto& c = o.convection;
  if (c.viscosity_file.empty())
    schema.fail("convection", "viscosity_file", "viscosity_law = 'table' needs the name of its file");
  auto table = schema.placed("convection", "viscosity_file", [&] { return viscosity_table::read(c.viscosity_file); });
  for (const double T : {o.temperature_top(), o.temperature_bottom()})
    for (const double depth : {0.0, L})
      if (!table.covers(T, depth))
        schema.fail("convection", "viscosity_file",
                    fmt::format("'{}' has {} to {} K and {} to {} m; the layer has {} K and a depth of {} m",
                                c.viscosity_file, table.temperatures().front(), table.temperatures().back(),
                                table.depths().front(), table.depths().back(), T, depth));
  return table;
}

// The laws without exponents: reference and middle, the latter of the conductive state.
void follow_table(const namelist::schema& schema, const options& o, parameters& p) {
  const auto& c = o.convection;
  const convection_options initially;
  const bool table = c.viscosity_law == "table", melt = c.viscosity_law == "melt";
  const auto only_for = [&](const char* key, bool differs, bool used, const char* law) {
    if (differs && !used) schema.fail("convection", key, fmt::format("is for viscosity_law = '{}'", law));
  };
  only_for("viscosity_file", !c.viscosity_file.empty(), table, "table");
  only_for("composition", c.composition != initially.composition, melt, "melt");
  only_for("viscosity_min", c.viscosity_min != initially.viscosity_min, melt, "melt");
  only_for("viscosity_max", c.viscosity_max != initially.viscosity_max, melt, "melt");
  if (!table && !melt) return;
  if (melt && !(std::min(o.temperature_top(), o.temperature_bottom()) > 0.0))
    schema.fail("convection", "viscosity_law", "'melt' needs absolute temperatures: those of top and bottom above 0 K");
  if (c.viscosity_max < c.viscosity_min) schema.fail("convection", "viscosity_max", "is below viscosity_min");
  auto& f = p.fluid;
  p.tabulated = std::make_shared<viscosity_table>(
      table ? from_file(schema, o, f.L) : schema.placed("convection", "viscosity_law", [&] { return by_melt(o, p); }));
  p.log_reference = p.tabulated->log(o.temperature_top(), 0.0);
  if (!c.rayleigh && !c.prandtl) f.nu = std::exp(p.log_reference) / f.rho;
  constexpr int n = 100;
  double least = p.log_reference, most = least;
  for (int k = 0; k < n; ++k) {
    const double s = (k + 0.5) / n,
                 here = p.tabulated->log(std::lerp(o.temperature_top(), o.temperature_bottom(), s), s * f.L);
    p.log_middle += (here - p.log_reference) / n;
    least = std::min(least, here), most = std::max(most, here);
  }
  p.lines.push_back(fmt::format(
      "viscosity by {}: {:.4g} to {:.4g} Pa s in the conductive state{}; Rayleigh number and xi are those of the top's "
      "viscosity, {:.4g} Pa s",
      table ? "'" + c.viscosity_file + "'" : "melt fraction", f.rho * f.nu * std::exp(least - p.log_reference),
      f.rho * f.nu * std::exp(most - p.log_reference),
      c.rayleigh || c.prandtl ? fmt::format(" (scaled by {:.4g} to the Rayleigh number asked for)",
                                            f.rho * f.nu / std::exp(p.log_reference))
                              : "",
      f.rho * f.nu));
}

// Of the viscosity that answers at once: viscous and sonic limits of the step then agree; below kappa nothing is
// gained. Where the viscosity varies, compression counts three times.
double sonic_share(const convection_options& c) { return c.viscosity_law == "constant" ? 0.35 : 0.12; }
// Waves of compression then travel at 1.22 c_eff.
double shear_share(const convection_options& c) { return c.viscosity_law == "constant" ? 0.7 : 0.4; }
// Buoyancy of noise at the spacing, k, makes velocities k/(k_0 shear_damping) times those of the Stokes flow before
// they are damped: where ν is low at the bottom those are large.
double shear_damping(const convection_options& c) {
  return c.shear_damping.value_or(c.viscosity_law == "constant" ? 1.0 : 10.0);
}
// The viscous response is relaxed: `length` (m) is the way of a wave of shear in the time of relaxation.
void relax_shear(const convection_options& c, double length, parameters& p) {
  p.sonic_share = sonic_share(c);
  p.shear_share = shear_share(c);
  p.compression = c.viscosity_law == "constant" ? 1.0 : std::numbers::sqrt3;
  p.relaxation_length = length;
}
bool relaxes(const convection_options& c) {
  if (c.operators == "sum") return false;
  if (c.viscous_response != "auto") return c.viscous_response == "relaxed";
  return c.viscosity_law == "constant";
}

void choose_slowing(const namelist::schema& schema, const options& o, parameters& p) {
  const auto& c = o.convection;
  const auto& f = p.fluid;
  auto wanted = relaxation::wanted(o.physics.relaxation);
  const auto given = [&](const char* key, double here, std::optional<double>& there) {
    if (here == 0.0) return;
    if (there) schema.fail("convection", key, std::string("is given in &relaxation too: keep one of them"));
    there = here;
  };
  given("zeta", c.zeta, wanted.zeta);
  given("xi", c.xi, wanted.xi);
  for (const auto& [key, value] : {std::pair{"zeta", c.zeta}, {"xi", c.xi}})
    if (value != 0.0 && value < 1.0)
      schema.fail("convection", key,
                  fmt::format("expected 0 (recommended) or at least 1, found {}: below 1 sound or "
                              "inertia would grow",
                              value));
  const bool viscous = relaxation::reached_balance(f, wanted.boundary_layers) == relaxation::balance::viscous;
  p.steady = c.target == "steady" || (c.target == "auto" && viscous);
  const double c_0 = relaxation::sound_speed(f);
  const double dx = f.L / static_cast<double>(o.physics.domain.particles[1]);
  p.lines.push_back(fmt::format("Ra {:.6g}, Pr {:.6g}, M_th {:.4g}, {} balances buoyancy", relaxation::rayleigh(f),
                                relaxation::prandtl(f), relaxation::thermal_mach(f),
                                viscous ? "viscosity" : "inertia"));
  if (p.steady && !wanted.zeta && !wanted.xi) {
    // At the viscosity of the middle: the reference is that of the cold top.
    auto middle = f;
    middle.nu *= std::exp(p.log_middle);
    p.c_eff = p.c_end = relaxation::stokes_speed(middle, true) / c.steady_mach;
    p.sonic_share = sonic_share(c);
    if (relaxes(c)) {
      // With shear_damping 1 as long as shear takes over 1/k, k = √2 π/L that of a roll as wide as high: its waves are
      // damped by half of what would stop their swinging.
      relax_shear(c, f.L / (std::numbers::sqrt2 * std::numbers::pi * shear_damping(c)), p);
    } else {
      p.c_end = 0.0;
    }
    p.slowing = relaxation::recommend(f, wanted);
    p.slowing.how = relaxation::method::rsst_vim;
    p.slowing.zeta_rule = p.slowing.xi_rule = "steady state";
    p.slowing.c_eff = p.c_eff;
    p.slowing.mach = p.slowing.speed / p.c_eff;
    follow(p, dx);
    p.lines.push_back(fmt::format(
        "slowed for the steady state: xi {:.4g} (Pr_eff {:.4g}{} max({} c_eff dx/kappa, 1)), zeta {:.4g} (c_eff "
        "{:.4g} m/s, {:.4g} kappa/L: Mach {:.3g} by Ra^(2/3) kappa/L); the way there is not a history",
        p.slowing.xi, p.nu_eff / f.kappa, p.shear_speed > 0.0 ? ", at once" : " =", p.sonic_share, p.slowing.zeta,
        p.c_eff, p.c_eff * f.L / f.kappa, c.steady_mach));
  } else {
    p.slowing = relaxation::recommend(f, wanted);
    p.c_eff = c_0 / (p.slowing.zeta * p.slowing.xi);
    p.nu_eff = f.nu / (p.slowing.xi * p.slowing.xi);
    p.lines.push_back(
        fmt::format("slowed by {}: zeta {:.4g} ({}), xi {:.4g} ({}): c_eff {:.4g} m/s ({:.4g} kappa/L), Pr_eff {:.4g}, "
                    "expected Mach "
                    "number {:.3g}{}",
                    relaxation::name(p.slowing.how), p.slowing.zeta, p.slowing.zeta_rule, p.slowing.xi,
                    p.slowing.xi_rule, p.c_eff, p.c_eff * f.L / f.kappa, p.nu_eff / f.kappa, p.slowing.speed / p.c_eff,
                    p.steady ? "; inertia vanishes in the steady state: the way there is not a history" : ""));
    if (p.steady && c.viscous_response == "relaxed") {
      const double at_once = std::max(sonic_share(c) * p.c_eff * dx, f.kappa);
      if (p.nu_eff <= at_once)
        schema.fail("convection", "viscous_response",
                    "with this zeta and xi all of the viscosity can answer at once: choose 'instant'");
      relax_shear(c, (p.nu_eff - at_once) / (shear_share(c) * p.c_eff), p);
      follow(p, dx);
    }
  }
  if (p.shear_speed > 0.0)
    p.lines.push_back(fmt::format(
        "viscous force of a velocity that relaxes in {:.4g} s ({:.3g} L^2/kappa): waves of shear at {:.3g} "
        "c_eff, {:.3g} "
        "of the viscosity answers at once; the flow answers buoyancy late by {:.2g} of the time L/(Ra^(2/3) kappa/L)",
        p.relaxation_time, p.relaxation_time * f.kappa / (f.L * f.L), p.shear_speed / p.c_eff, p.instant_share,
        p.slowing.speed * f.L / (2.0 * std::numbers::pi * std::numbers::pi * p.nu_eff)));
}

// A flow that has no inertia answers the start at once, with all the buoyancy of the first, unresolved roll: it begins
// where that is as slow as slowed sound allows, and slowed sound follows.
void choose_ramp(const options& o, parameters& p) {
  const auto& c = o.convection;
  const auto& f = p.fluid;
  const double first = relaxation::rayleigh(f) / 1000.0;  // of the top's viscosity
  const bool follows = p.c_end > 0.0 && first > 1.0 && c.steady_tolerance > 0.0;
  p.start = c.viscosity_start.value_or(follows && c.viscosity_ramp.value_or(1.0) > 0.0 ? first : 1.0);
  const double of_decade = c.viscosity_law == "constant" ? 0.033 * f.L * f.L / f.kappa : 0.0;
  p.ramp = c.viscosity_ramp.value_or(follows ? of_decade * std::log10(p.start) : 0.0);
  if (p.ramp == 0.0) p.start = 1.0;
  if (p.start != 1.0)
    p.lines.push_back(fmt::format("the viscosity falls from {:.4g} times over {:.4g} s ({:.3g} L^2/kappa){}", p.start,
                                  p.ramp, p.ramp * f.kappa / (f.L * f.L),
                                  p.c_end > 0.0 ? ", slowed sound follows" : ""));
}

// Coarser lattices that still resolve the steady flow: a spacing not above the thermal boundary layer L/(2 Nu), with
// Nu = 0.25 Ra^(1/3) of free slip, and 24 particles in any case.
std::int64_t levels_that_resolve(const options& o, const parameters& p) {
  const auto& c = o.convection;
  if (!p.steady || c.viscosity_law != "constant" || c.steady_tolerance == 0.0) return 0;
  const double least = std::max(24.0, 2.0 * 0.25 * std::cbrt(relaxation::rayleigh(p.fluid)));
  const auto& d = o.physics.domain;
  for (std::int64_t level = 0;; ++level) {
    const std::int64_t halved = std::int64_t{2} << level;
    for (std::size_t a = 0; a < static_cast<std::size_t>(d.dimension); ++a)
      if (d.particles[a] % halved != 0) return level;
    if (static_cast<double>(d.particles[1] / halved) < least) return level;
  }
}

// 'auto' stays in the input: a restart may have another method.
void choose_lagging(const namelist::schema& schema, const options& o, parameters& p) {
  auto& chosen = p.lagging = o.convection.lagging;
  const auto& method = o.common.time.method;
  const bool stabilised = method == "rkl2" || method == "rkc2", plain = o.convection.operators == "sum";
  if (chosen == "auto") chosen = stabilised && !plain ? "extrapolated" : "step";
  const auto refuse = [&](const char* choice, bool when, const char* why) {
    if (chosen == choice && when) schema.fail("convection", "lagging", why);
  };
  refuse("extrapolated", plain, "the plain sums keep nothing");
  refuse("evaluation", plain, "the plain sums keep nothing");
  refuse("extrapolated", !stabilised, "'extrapolated' is for time.method = 'rkl2' and 'rkc2'");
  refuse("evaluation", stabilised, "with rkl2 and rkc2 what lags by a stage feeds the roughest waves");
  refuse("evaluation", method == "adaptive", "a step tried again would have the memory of the one that failed");
  refuse("evaluation", method == "euler" || method == "ab2", "with one evaluation a step it is the same as 'step'");
}

}  // namespace

void declare(namelist::schema& schema, options& o) {
  relaxation::declare(schema, o.physics);
  run::declare(schema, o.ranks_x);
  declare(schema, o.convection);
  schema.group("initial", "start: conduction, at rest, with a disturbance");
  schema.add("initial", "perturbation", o.initial.perturbation,
             {.minimum = -1.0,
              .maximum = 1.0,
              .meaning = "a of T = T_conductive + a DeltaT cos(half_waves pi x/length_x) sin(pi y/L)"});
  schema.add("initial", "half_waves", o.initial.half_waves, {.minimum = 0, .maximum = 1000, .meaning = "along x"});
  auto& sides = o.walls.sides;
  o.walls.slip = "free_slip";
  sides[2].thermal = sides[3].thermal = "fixed";
  sides[2].temperature = 1000.0;
  sides[3].temperature = 0.0;
  walls::declare(schema, {.flux = true}, o.walls);
  o.common.kernel.skin = 0.6;  // a particle moves by a sixth of its spacing and more in one step of slowed sound
  run::declare(schema, o.common, {.keeps_rate = true});
}

std::array<std::int64_t, 3> particles_of_level(const options& o, std::int64_t level) {
  auto n = o.physics.domain.particles;
  for (auto& along : n) along >>= level;
  return n;
}

void follow(parameters& p, double dx, double higher) {
  if (p.sonic_share == 0.0) return;
  const auto& f = p.fluid;
  if (p.c_end > 0.0) p.c_eff = p.c_end * std::pow(higher, -2.0 / 3.0);
  p.shear_speed = p.shear_share * p.c_eff;
  p.relaxation_time = p.shear_share > 0.0 ? p.relaxation_length / p.shear_speed : 0.0;
  const double at_once = std::max(p.sonic_share * p.c_eff * dx, f.kappa);
  p.nu_eff = at_once + p.relaxation_length * p.shear_speed;
  p.instant_share = at_once / p.nu_eff;
  p.slowing.xi = std::sqrt(f.nu / p.nu_eff);
  p.slowing.zeta = relaxation::sound_speed(f) / (p.c_eff * p.slowing.xi);
  p.slowing.Pr_eff = p.nu_eff / f.kappa;
  p.slowing.viscous_share = p.instant_share;
  p.slowing.wave_share = std::hypot(1.0, p.compression * p.shear_share);
  p.slowing.reynolds = p.slowing.speed * f.L / p.nu_eff;
}

double expected_particles(const options& o) {
  return run::lattice_particles(o.physics.domain.dimension, o.physics.domain.particles);
}

namespace {

// The coarsest lattice must hold the kernel, and the fit of the heat through a wall (measures.hpp).
void check_lattices(const namelist::schema& schema, const options& o) {
  const auto& d = o.physics.domain;
  run::check_number(schema, {d.dimension, d.length, d.particles, d.periodic}, expected_particles(o));
  const auto coarsest = particles_of_level(o, o.convection.levels);
  const double dx = d.length[1] / static_cast<double>(coarsest[1]);
  const double support = std::max(run::support_over_dx(o.common.kernel), fit_radius) * dx;
  run::check_widths(schema, {d.dimension, d.length, coarsest, d.periodic}, support + o.common.kernel.skin * dx,
                    support);
}

}  // namespace

parameters resolve(const namelist::schema& schema, options& o) {
  run::resolve(schema, o.common);
  run::resolve(schema, o.ranks_x);
  auto& c = o.convection;
  const auto& d = o.physics.domain;
  const auto unless_given = [&](const char* key, auto& value, auto of_plain) {
    if (c.scheme == "plain" && !schema.given("convection", key)) value = of_plain;
  };
  unless_given("operator", c.operators, "sum");
  unless_given("pressure", c.pressure, "lagrangian");
  unless_given("target", c.target, "transient");
  unless_given("pressure_diffusion", c.pressure_diffusion, 0.0);
  unless_given("remap_diffusion", c.remap_diffusion, 0.0);
  const bool weighted = c.viscosity_law != "constant" && o.physics.domain.dimension == 2;
  if (c.line_forces == "isotropic" && !weighted)
    schema.fail("convection", "line_forces", "'isotropic' is for a viscosity that varies, in two dimensions");
  if (c.line_forces == "auto") c.line_forces = weighted ? "isotropic" : "equal";
  if (c.operators == "sum" && c.viscosity_law != "constant")
    schema.fail("convection", "viscosity_law", "the plain sums are for one viscosity");
  if (c.operators == "sum" && (c.pressure_diffusion != 0.0 || c.remap_diffusion != 0.0))
    schema.fail("convection", "pressure_diffusion",
                "the plain sums have no gradients for it: give 0, remap_diffusion too");
  if (d.periodic[1])
    schema.fail("domain", "periodic_y", "heat comes from the bottom and leaves at the top: these are walls");
  const double dT = o.temperature_bottom() - o.temperature_top();
  parameters p{};
  p.instant_share = 1.0;
  p.fluid = relaxation::layer(schema, o.physics, o.temperature_bottom(), o.temperature_top());
  auto material = o.physics.material;
  make_consistent(o, material, dT);
  p.fluid.nu = material.viscosity / material.density;
  p.fluid.alpha = material.expansivity;
  const bool exponents = c.viscosity_law != "constant" && c.viscosity_law != "table" && c.viscosity_law != "melt";
  if (!exponents && (c.temperature_exponent != 0.0 || c.depth_exponent != 0.0))
    schema.fail("convection", "viscosity_law", "exponents belong to the 'exponential' law");
  const auto follow_law = [&](const char* law, double of_temperature, double of_depth) {
    if (c.viscosity_law != law) return;
    const auto set = [&](const char* key, double& value, double wanted) {
      if (schema.given("convection", key) && std::abs(value - wanted) > 1e-12 * (1.0 + wanted))
        schema.fail("convection", key,
                    fmt::format("viscosity_law = '{}' has {} here: choose 'exponential'", law, wanted));
      value = wanted;
    };
    set("temperature_exponent", c.temperature_exponent, of_temperature);
    set("depth_exponent", c.depth_exponent, of_depth);
  };
  follow_law("blankenbach_2a", std::log(1000.0), 0.0);
  follow_law("blankenbach_2b", std::log(16384.0), std::log(64.0));
  if (c.viscosity_start && *c.viscosity_start != 1.0 && c.viscosity_ramp.value_or(0.0) == 0.0)
    schema.fail("convection", "viscosity_start", "needs a viscosity_ramp, the time over which it goes");
  weigh(schema, o, p);
  p.log_middle = 0.5 * (c.depth_exponent - c.temperature_exponent);
  follow_table(schema, o, p);
  choose_slowing(schema, o, p);
  choose_ramp(o, p);
  choose_lagging(schema, o, p);
  // Divergence that it makes goes with 1/ξ²: a tenth is as much where the response is relaxed. In a transient flow
  // viscosity may be too low to damp what the lagged correction feeds.
  if (c.operators != "sum" && !schema.given("convection", "pressure_diffusion"))
    c.pressure_diffusion = p.shear_share > 0.0 ? 0.02 : p.steady ? 0.2 : 0.4;
  if (c.viscous_response == "relaxed" && (!p.steady || c.operators == "sum"))
    schema.fail("convection", "viscous_response", "relaxed: for target = 'steady' with consistent operators");
  if (c.shear_damping && (p.shear_share == 0.0 || p.c_end == 0.0))
    schema.fail("convection", "shear_damping",
                "is for the relaxed viscous response, where zeta and xi are not given (they would say it)");
  if (c.levels < 0) c.levels = levels_that_resolve(o, p);
  if (c.levels > 0 && c.steady_tolerance == 0.0)
    schema.fail("convection", "levels",
                "coarser particles on the way to a steady state; without a steady_tolerance the history is the aim");
  for (std::size_t a = 0; a < static_cast<std::size_t>(d.dimension); ++a)
    if (d.particles[a] % (std::int64_t{1} << c.levels) != 0)
      schema.fail("convection", "levels",
                  fmt::format("{} particles cannot be halved {} times", d.particles[a], c.levels));
  check_lattices(schema, o);
  p.compressibility = c.gravity_density == "separated"      ? 1.0
                      : p.weighed                           ? (c.eos_dynamic_pressure ? 1.0 : 0.0)
                      : c.gravity_density == "conventional" ? p.slowing.zeta * p.slowing.zeta
                                                            : 0.0;
  if (!o.common.time.t_end)
    o.common.time.t_end = static_cast<double>(1 + c.levels) * p.fluid.L * p.fluid.L / p.fluid.kappa;
  run::check_output(schema, o.common);
  return p;
}

}  // namespace tetsuame::boussinesq
