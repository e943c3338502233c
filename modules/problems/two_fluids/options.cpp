#include <fmt/format.h>
#include <gravity/options.hpp>

#include <cmath>
#include <kernels/kernel.hpp>
#include <two_fluids/groups.hpp>

namespace tetsuame::two_fluids {

namespace {

const domain::demands demands{.least_particles = 4, .walls_below_and_above = "gravity needs a floor and a lid"};

void check_domain(const namelist::schema& schema, options& o, parameters& p) {
  domain::resolve(schema, demands, o.domain);
  p.dx = o.domain.dx();
  const double support = run::support_over_dx(o.common.kernel) * p.dx;
  p.halo = o.by_program ? support * walls::radius_factor(o.walls) : support;
  domain::check_widths(schema, o.domain, std::max(p.halo, support) + o.common.kernel.skin * p.dx, support);
}

void make_materials(const namelist::schema& schema, problem_kind kind, const options& o, parameters& p) {
  const char* group = group_of(kind);
  p.material = std::make_unique<std::vector<eos::any>>(2);
  p.material->reserve(o.material.size());  // others point to them
  for (const std::size_t n : {0, 1}) {
    const auto& m = o.material[n];
    const std::string which = names_of(kind)[n];
    if (m.eos != "linear")
      refuse(schema, group, {"density_" + which}, "is of the linear equation of state; '" + m.eos + "' has its own");
    else
      for (const auto& key : eos::parameters)
        if (m.parameters.*key.member)
          schema.fail(group, own_key(key, which), "'linear' has density_" + which + " and bulk_modulus_" + which);
    if (m.eos != "table") refuse(schema, group, {"table_" + which}, "is of eos_" + which + " = 'table'");
    if (m.eos != "tillotson") refuse(schema, group, {"tillotson_" + which}, "is of eos_" + which + " = 'tillotson'");
    (*p.material)[n] = schema.placed(group, "eos_" + which, [&] { return make(o, n); });
  }
  make_more_materials(schema, o, p);
}

// Heights of the contacts, on edges between rows, and the column at rest.
void find_layers(const namelist::schema& schema, problem_kind kind, options& o, parameters& p) {
  const char* group = group_of(kind);
  const double height = o.domain.length[1];
  const bool adiabatic = o.temperature_law == "adiabatic";
  if (kind == problem_kind::rayleigh_taylor) {
    if (!o.interface) o.interface = 0.5 * height;
    const double rows = std::floor(*o.interface / p.dx + 0.5 + 1e-9);  // with their centres not above it
    p.interface = rows * p.dx;
    if (!(rows >= 1.0 && rows < static_cast<double>(o.domain.particles[1])))
      schema.fail(group, "interface", "leaves no row of particles on one side");
  } else {
    p.interface = height;
  }
  p.pond_top = height;
  if (o.pond_top) {
    p.pond_top = std::floor(*o.pond_top / p.dx + 0.5 + 1e-9) * p.dx;
    if (!(p.pond_top > p.interface && p.pond_top < height))
      schema.fail(group, "pond_top", "must leave rows of particles to the pond and to what covers it");
  }
  const std::size_t top = kind == problem_kind::drop ? 0 : 1;
  const auto at_rest = [&](std::size_t n) { return barotropic{&(*p.material)[n], o.p_top, o.temperature, adiabatic}; };
  p.base = schema.placed(group, "p_top", [&] {
    return std::make_unique<column>(at_rest(0), at_rest(top), p.interface, height, o.gravity,
                                    o.pond_top ? std::optional(p.pond_top) : std::nullopt);
  });
}

[[noreturn]] void refuse_conduction(const namelist::schema& schema, problem_kind kind, const options& o) {
  const std::string why = "there is nothing to conduct at one temperature";
  if (o.conductivity > 0.0) schema.fail(group_of(kind), "conductivity", why);
  for (std::size_t n = 0;; ++n)
    if (o.conductivity_of(n) > 0.0) {
      if (n > 1) schema.fail_at("material", "conductivity", n - 2, why);
      schema.fail(group_of(kind), std::string("conductivity_") + names_of(kind)[n], why);
    }
}

}  // namespace

slips slips_of(const options& o) {
  slips s{walls::slip_of(o.walls, 2), walls::slip_of(o.walls, 3), ""};
  for (const std::size_t n : {0, 1, 4, 5}) {
    if (o.domain.periodic[n / 2] || n / 2 >= o.domain.axes()) continue;
    const auto& slip = walls::slip_of(o.walls, n);
    if (!s.sides.empty() && s.sides != slip) return {s.floor, s.lid, "different"};
    s.sides = slip;
  }
  return s;
}

void declare(namelist::schema& schema, problem_kind kind, options& o) {
  const char* group = group_of(kind);
  const auto names = names_of(kind);
  o.common.kernel.name = o.by_program ? "quintic" : "wendland_c6";
  o.common.kernel.skin = 0.4;
  // What it changes is a tenth of any answer's error at most: docs/studies/2026-11-24_single_precision.md
  if (!o.by_program) o.common.kernel.precision = "single";
  o.common.output.history_interval = 10;
  o.common.time.t_end = 3000.0;
  domain::declare(schema, demands, o.domain);
  schema.group(group, kind == problem_kind::drop ? "a drop that sinks in a box" : "a dense layer over a light one");
  for (const std::size_t n : {1, 0}) declare(schema, group, names[n], o.material[n]);
  schema.add(group, "bulk_modulus", o.bulk_modulus, positive("Pa", "K of p = K (rho/rho0 - 1), of both"));
  gravity::declare(schema, group, "gravity", o.gravity, kind != problem_kind::drop);
  schema.add(group, "p_top", o.p_top, {.unit = "Pa", .meaning = "pressure at the top of the start column"});
  schema.add(group, "temperature", o.temperature, positive("K", "at the top of the start column"));
  schema.add(
      group, "temperature_law", o.temperature_law,
      {.choices = {"isothermal", "adiabatic", "enthalpy"},
       .meaning = "one temperature for ever; adiabats at the start and temperature by compression, friction, "
                  "conduction; or heat content by friction and conduction, and melting (linear equations of state)"});
  schema.add(group, "conductivity", o.conductivity,
             not_negative("W/(m K)", "thermal, of both, not of the isothermal law"));
  schema.add(group, "surface_tension", o.surface_tension,
             not_negative("N/m",
                          "between the two materials; walls are neutral (90 degrees). Pairs are in double precision "
                          "then, unless &kernel precision is given"));
  for (const std::size_t n : {1, 0})
    schema.add(group, std::string("temperature_") + names[n], o.material[n].temperature,
               for_expert(positive("K", "at the start, enthalpy law; not given: temperature")));
  if (kind == problem_kind::drop)
    declare_drops(schema, group, o);
  else
    declare_waves(schema, group, o);
  if (o.by_program)
    schema.pass_over(group, {"volume", "pressure", "gradient", "volume_element", "reference_pressure", "supports",
                             "normalise", "delta", "viscous_order", "stress", "rows"});
  else
    declare(schema, group, o.scheme);
  declare(schema, kind, o.slowing);
  declare(schema, o.more);
  melting::declare(schema, "of the lower (outer) material, where temperature_law is 'enthalpy'", o.melting);
  elements::declare(schema, o.element);
  o.walls.slip = "free_slip";
  o.walls.sides[2].slip = o.walls.sides[3].slip = "no_slip";
  walls::abilities behind{.moving = false, .heat = false, .free_surface = true, .bodies = true};
  o.walls.slip_of_bodies = "no_slip";
  if (o.by_program) behind.treatments = {"virtual_marker", "none", "repulsion", "mirror"};
  walls::declare(schema, behind, o.walls);
  schema.also_known("walls", "floor", "slip_bottom");
  schema.also_known("walls", "lid", "slip_top");
  schema.also_known("walls", "sides", "slip");
  solids::declare(schema, o.solids);
  regions::declare(schema, regions_of(kind, o), o.regions);
  sources::declare(schema, {}, o.sources);
  if (o.by_program) {
    schema.pass_over("walls", {"pressure"});
    volume::declare(schema, o.liquid);
  } else {  // one input for all programs
    schema.pass_over("walls", {"treatment"});
    schema.pass_over("volume");
    schema.pass_over("viscosity");
  }
  run::declare(schema, o.common, {.single_pairs = true, .starts_from_file = true, .settles = true});
}

parameters resolve(const namelist::schema& schema, problem_kind kind, options& o) {
  const char* group = group_of(kind);
  run::resolve(schema, o.common);
  std::vector<std::string> fields{"Volume", "DensityReference"};
  if (o.element.any()) fields.emplace_back("Concentration");
  if (o.temperature_law == "enthalpy") fields.insert(fields.end(), {"Viscosity", "MeltFraction"});
  parameters p{};
  const auto& kernel = o.common.kernel;
  if (const double own = kernels::find(kernel.name).default_h_over_dx; kernel.h_over_dx > 2.0 * own)
    p.lines.push_back(
        fmt::format("note: kernel '{}' with h_over_dx = {:.4g} reaches {:.4g} spacings; its own is {:.4g}", kernel.name,
                    kernel.h_over_dx, run::support_over_dx(kernel), own));
  check_domain(schema, o, p);
  run::check_output(schema, o.common, o.domain, fields);
  read_materials(schema, kind, o);
  find_heat(schema, kind, o, p);
  p.melting = melting_by_material(o);
  choose_scheme(schema, group, o, p);
  check_slowing(schema, kind, o);
  elements::check(schema, o.element);
  find_elasticity(o, p);
  if (o.conducts() && o.temperature_law == "isothermal") refuse_conduction(schema, kind, o);
  make_materials(schema, kind, o, p);
  find_layers(schema, kind, o, p);
  if (kind == problem_kind::rayleigh_taylor) {
    p.density_difference = p.base->at(p.interface).density - p.base->at(p.interface * (1.0 - 1e-12)).density;
    find_lattices(schema, o, p);
    find_waves(schema, o, p);
    tell_slowing(o, p);
    warn_of_tension(o, p, p.interface);
    if (o.melting.curve != "none") schema.placed("melting", "curve", [&] { find_melt(o, p); });
  } else {
    find_fall(schema, o, p);
  }
  resolve_bodies(schema, kind, o, p);
  resolve_regions(schema, kind, o, p);
  expect_places(schema, o, p);
  check_settling(schema, kind, o, p);
  return p;
}

double particles_at_start(const options& o, const parameters& p) {
  if (o.masses != "equal_mass") return o.domain.lattice_particles();
  double all = 0.0;
  for (const auto& layer : p.layers) {
    double of_layer = 1.0;
    for (std::size_t a = 0; a < o.domain.axes(); ++a) of_layer *= static_cast<double>(layer.number[a]);
    all += of_layer;
  }
  return all;
}

std::string theory_text(problem_kind kind, const options& o, const parameters& p) {
  if (kind == problem_kind::drop)
    return p.theory_fall
               ? fmt::format("{}\ndrop less surroundings {:.6g} kg/m3 at y = {:.6g} m\nfall velocity {:.9g} m/s\n",
                             p.theory_about, p.density_difference, o.measure_at * o.domain.length[1], *p.theory_fall)
               : p.theory_about + "\n";
  if (p.melt_conducted)
    return fmt::format("{}\nmelt fraction {:.6g} of the lower material at t = {:.6g} s, by conduction at rest\n",
                       p.theory_about, *p.melt_conducted, o.common.time.end());
  if (!p.growth) return p.theory_about + "\n";
  const std::string slowed =
      p.growth_slowed ? fmt::format("growth rate {:.9g} 1/s (with slowed sound and inertia)\n", *p.growth_slowed) : "";
  return fmt::format(
      "interface {:.9g} m above the floor, density above less below {:.6g} kg/m3 there\n"
      "wave number {:.9g} 1/m, {} floor, {} lid\n"
      "growth rate {:.9g} 1/s (as run: compressible, {} stress)\n"
      "growth rate {:.9g} 1/s (incompressible)\n{}",
      p.interface, p.density_difference, std::hypot(p.k_x, p.k_z), slips_of(o).floor, slips_of(o).lid, *p.growth,
      p.symmetric_stress ? "symmetric" : "laplacian", *p.growth_incompressible, slowed);
}

}  // namespace tetsuame::two_fluids
