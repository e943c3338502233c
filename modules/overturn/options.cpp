#include <fmt/format.h>

#include <cmath>
#include <overturn/groups.hpp>

namespace tetsuame::overturn {

namespace {

constexpr std::array<double, 2> default_density{3000.0, 7000.0};  // kg/m3, of lower or outside, upper or drop

void declare(namelist::schema& schema, domain_options& o) {
  schema.group("domain", "the box and the start lattice");
  schema.add("domain", "dimension", o.dimension, {.minimum = 2, .maximum = 3, .meaning = "of space; y is up"});
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string axis = axis_names[a], only = a == 2 ? " (3-D only)" : "";
    schema.add("domain", "length_" + axis, o.length[a], positive("m", "edge of the box along " + axis + only));
    schema.add("domain", "particles_" + axis, o.particles[a],
               {.minimum = 4, .maximum = 1e6, .meaning = "particles along " + axis + only});
    if (a != 1)
      schema.add("domain", "periodic_" + axis, o.periodic[a],
                 {.meaning = "the two sides across " + axis + " are one, or else walls" + only});
  }
  run::declare(schema, o.ranks_x);
}

void check_domain(const namelist::schema& schema, options& o, parameters& p) {
  const auto& d = o.domain;
  p.dx = d.length[1] / static_cast<double>(d.particles[1]);
  for (std::size_t a = 0; a < static_cast<std::size_t>(d.dimension); ++a)
    if (const double spacing = d.length[a] / static_cast<double>(d.particles[a]);
        std::abs(spacing - p.dx) > 1e-9 * p.dx)
      schema.fail(
          "domain", std::string("particles_") + axis_names[a],
          fmt::format("the particle spacing must be the same along all axes: here {} m, along y {} m", spacing, p.dx));
  const std::array<bool, 3> periodic{d.periodic[0], false, d.periodic[2]};
  const run::box_of_particles box{d.dimension, d.length, d.particles, periodic};
  const double support = run::support_over_dx(o.common.kernel) * p.dx;
  p.halo = o.by_program ? support * walls::radius_factor(o.behind_walls) : support;
  run::check_number(schema, box, expected_particles(o));
  run::check_widths(schema, box, std::max(p.halo, support) + o.common.kernel.skin * p.dx, support);
  run::resolve(schema, o.domain.ranks_x);
}

void make_materials(const namelist::schema& schema, problem_kind kind, const options& o, parameters& p) {
  const char* group = group_of(kind);
  p.material = std::make_unique<std::array<eos::any, 2>>();
  for (const std::size_t n : {0, 1}) {
    const auto& m = o.material[n];
    const std::string which = names_of(kind)[n];
    if (m.eos != "linear") {
      const std::string density = "density_" + which, modulus = "bulk_modulus_" + which;
      refuse(schema, group, {{density.c_str(), m.density == default_density[n]}, {modulus.c_str(), !m.bulk_modulus}},
             "is of the linear equation of state; '" + m.eos + "' has its own");
    }
    (*p.material)[n] = schema.placed(group, "eos_" + which, [&] { return make(o, n); });
  }
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
    return o.pond_top ? std::make_unique<column>(at_rest(0), at_rest(1), at_rest(0), p.interface, p.pond_top, height,
                                                 o.gravity)
                      : std::make_unique<column>(at_rest(0), at_rest(top), p.interface, height, o.gravity);
  });
}

}  // namespace

box_of_drops box_of(const domain_options& d) {
  return {static_cast<int>(d.dimension), d.length, {d.periodic[0], false, d.dimension == 3 && d.periodic[2]}};
}

void declare(namelist::schema& schema, problem_kind kind, options& o) {
  const char* group = group_of(kind);
  const auto names = names_of(kind);
  o.common.kernel.name = o.by_program ? "quintic" : "wendland_c6";
  o.common.kernel.skin = 0.4;
  o.common.output.history_interval = 10;
  o.common.time.t_end = 3000.0;
  for (const std::size_t n : {0, 1}) o.material[n].density = default_density[n];
  declare(schema, o.domain);
  schema.group(group, kind == problem_kind::drop ? "a drop that sinks in a box" : "a dense layer over a light one");
  for (const std::size_t n : {1, 0}) declare(schema, group, names[n], o.material[n]);
  schema.add(group, "bulk_modulus", o.bulk_modulus, positive("Pa", "K of p = K (rho/rho0 - 1), of both"));
  schema.add(group, "gravity", o.gravity, positive("m/s^2", "towards -y"));
  schema.add(group, "p_top", o.p_top, {.unit = "Pa", .meaning = "pressure at the top of the start column"});
  schema.add(group, "temperature", o.temperature, positive("K", "at the top of the start column"));
  schema.add(
      group, "temperature_law", o.temperature_law,
      {.choices = {"isothermal", "adiabatic", "enthalpy"},
       .meaning = "one temperature for ever; adiabats at the start and temperature by compression, friction, "
                  "conduction; or heat content by friction and conduction, and melting (linear equations of state)"});
  schema.add(group, "conductivity", o.conductivity,
             {.unit = "W/(m K)", .minimum = 0.0, .meaning = "thermal, not of the isothermal law"});
  schema.add(group, "surface_tension", o.surface_tension,
             {.unit = "N/m", .minimum = 0.0, .meaning = "between the two materials; walls are neutral (90 degrees)"});
  for (const std::size_t n : {1, 0})
    schema.add(group, std::string("temperature_") + names[n], o.start_heat[n],
               positive("K", "at the start, enthalpy law; not given: temperature"));
  if (kind == problem_kind::drop)
    declare_drops(schema, group, o);
  else
    declare_waves(schema, group, o);
  if (o.by_program)
    schema.pass_over(group, {"volume", "pressure", "gradient", "volume_element", "reference_pressure", "supports",
                             "normalise", "delta", "viscous_order", "stress", "rows"});
  else
    declare(schema, group, o.scheme);
  declare(schema, o.melting);
  declare(schema, o.element);
  schema.group("walls", "sides of the box that are not periodic");
  schema.add("walls", "floor", o.walls.floor,
             {.choices = {"no_slip", "free_slip"}, .meaning = "velocity at the floor"});
  schema.add("walls", "lid", o.walls.lid,
             {.choices = {"no_slip", "free_slip", "free_surface"}, .meaning = "velocity at the lid, or none there"});
  schema.add("walls", "sides", o.walls.sides,
             {.choices = {"no_slip", "free_slip"}, .meaning = "velocity at the sides"});
  if (o.by_program) {
    schema.pass_over("walls", {"pressure"});
    walls::declare_treatment(schema, {"virtual_marker", "none", "repulsion", "mirror"}, o.behind_walls);
    liquid::declare(schema, o.liquid);
    run::declare(schema, o.common, {});
    return;
  }
  schema.add(
      "walls", "pressure", o.walls.pressure,
      {.choices = {"hydrostatic", "mirrored"}, .meaning = "behind floor and lid: continued with rho g, or as inside"});
  run::declare(schema, o.common, {});
}

double expected_particles(const options& o) { return run::lattice_particles(o.domain.dimension, o.domain.particles); }

parameters resolve(const namelist::schema& schema, problem_kind kind, options& o) {
  const char* group = group_of(kind);
  run::resolve(schema, o.common);
  run::check_output(schema, o.common);
  parameters p{};
  check_domain(schema, o, p);
  find_heat(schema, kind, o, p);
  choose_scheme(schema, group, o, p);
  check_element(schema, o.element);
  find_elasticity(o, p);
  if (o.conductivity > 0.0 && o.temperature_law == "isothermal")
    schema.fail(group, "conductivity", "there is nothing to conduct at one temperature");
  make_materials(schema, kind, o, p);
  find_layers(schema, kind, o, p);
  if (kind == problem_kind::rayleigh_taylor) {
    p.density_difference = p.base->at(p.interface).density - p.base->at(p.interface * (1.0 - 1e-12)).density;
    find_waves(schema, o, p);
    warn_of_tension(o, p, p.interface);
    if (o.melting.curve != "none" && !o.pond_top) schema.placed("melting", "liquidus", [&] { find_melt(o, p); });
  } else {
    find_fall(schema, o, p);
  }
  return p;
}

std::string theory_text(problem_kind kind, const options& o, const parameters& p) {
  if (kind == problem_kind::drop)
    return p.theory_fall
               ? fmt::format("{}\ndrop less surroundings {:.6g} kg/m3 at y = {:.6g} m\nfall velocity {:.9g} m/s\n",
                             p.theory_about, p.density_difference, o.measure_at * o.domain.length[1], *p.theory_fall)
               : p.theory_about + "\n";
  if (p.melt_conducted)
    return fmt::format("{}\nmelt fraction {:.6g} of the lower material at t = {:.6g} s, by conduction at rest\n",
                       p.theory_about, *p.melt_conducted, *o.common.time.t_end);
  if (!p.growth) return p.theory_about + "\n";
  return fmt::format(
      "interface {:.9g} m above the floor, density above less below {:.6g} kg/m3 there\n"
      "wave number {:.9g} 1/m, {} floor, {} lid\n"
      "growth rate {:.9g} 1/s (as run: compressible, {} stress)\n"
      "growth rate {:.9g} 1/s (incompressible)\n",
      p.interface, p.density_difference, std::hypot(p.k_x, p.k_z), o.walls.floor, o.walls.lid, *p.growth,
      o.scheme.stress, *p.growth_incompressible);
}

}  // namespace tetsuame::overturn
