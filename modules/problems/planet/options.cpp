#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <eos/caloric.hpp>
#include <eos/keys.hpp>
#include <gravity/options.hpp>
#include <namelist/lists.hpp>
#include <nlohmann/json.hpp>
#include <planet/options.hpp>

namespace tetsuame::planet {

namespace {

using namelist::between, namelist::element_of, namelist::for_expert, namelist::positive;

constexpr std::size_t most_layers = 8;
const char* const group = layer_group;

namelist::key_info list(namelist::key_info of_one) { return namelist::one_each(std::move(of_one), most_layers); }

std::size_t given(const layer_options& l) {
  std::size_t most = namelist::longest(l.name, l.eos, l.curve, l.tillotson, l.table, l.metal, l.fraction, l.viscosity);
  for (const auto& values : l.parameters) most = std::max(most, values.size());
  return most;
}

void declare_layers(namelist::schema& schema, layer_options& l) {
  schema.group(group,
               "a layer of the planet, from the centre outwards: the first &layer is the core; once to eight times");
  std::vector<std::string> equations;
  for (const auto& name : eos::names()) equations.emplace_back(name);
  const auto add = [&](const char* key, auto& to, const namelist::key_info& info) {
    schema.add(group, key, to, list(info));
  };
  add("name", l.name, {.meaning = "letters, digits and _"});
  add("fraction", l.fraction, namelist::up_to(1.0, "of the planet's mass; where &planet radius is given it follows"));
  add("viscosity", l.viscosity,
      {.unit = "Pa s", .minimum = 0.0, .meaning = "of this layer; not given: &planet viscosity"});
  add("eos", l.eos, {.choices = equations, .meaning = "equation of state; its parameters follow"});
  add("curve", l.curve, {.meaning = "of eos = 'liquid_silicate': vinet or birch_murnaghan"});
  add("tillotson", l.tillotson, {.meaning = "of eos = 'tillotson': iron, granite or basalt; not given: iron"});
  add("table", l.table, eos::key_of_table());
  add("metal", l.metal,
      {.choices = {"auto", "yes", "no"},
       .expert = true,
       .meaning = "does not melt by &melting, and takes up &element; auto: an equation of state of iron"});
  for (std::size_t k = 0; k < eos::parameters.size(); ++k)
    schema.add(group, std::string(eos::parameters[k].key), l.parameters[k], list(eos::key_of(eos::parameters[k])));
}

void resolve_layers(const namelist::schema& schema, options& o) {
  const std::size_t number = given(o.layer);
  if (number == 0) foundation::fail_input("&layer: a planet has one layer at least");
  for (std::size_t n = 0; n < number; ++n) {
    auto name = element_of(o.layer.name, n);
    if (name.empty())
      name = number == 1 ? "body" : n == 0 ? "core" : number == 2 ? "mantle" : fmt::format("layer_{}", n + 1);
    const auto eos = element_of(o.layer.eos, n);
    if (eos.empty()) schema.fail_at(group, "eos", n, fmt::format("layer '{}' has no equation of state", name));
    eos::material_options m;
    m.name = eos;
    m.curve = element_of(o.layer.curve, n);
    m.tillotson = element_of(o.layer.tillotson, n);
    m.table = element_of(o.layer.table, n);
    if (!m.tillotson.empty() && m.name != "tillotson") schema.fail_at(group, "tillotson", n, "is of eos = 'tillotson'");
    if (!m.curve.empty() && m.name != "liquid_silicate")
      schema.fail_at(group, "curve", n, "is of eos = 'liquid_silicate'");
    if (!m.table.empty() && m.name != "table") schema.fail_at(group, "table", n, "is of eos = 'table'");
    for (std::size_t k = 0; k < eos::parameters.size(); ++k)
      if (const auto value = element_of(o.layer.parameters[k], n)) m.*eos::parameters[k].member = *value;
    o.names.push_back(name);
    o.materials.push_back(m);
    o.viscosities.push_back(element_of(o.layer.viscosity, n).value_or(o.viscosity));
  }
}

double fraction_of(const namelist::schema& schema, const options& o, std::size_t n) {
  const auto value = element_of(o.layer.fraction, n);
  if (!value) schema.fail_at(group, "fraction", n, fmt::format("layer '{}' has no fraction of the mass", o.names[n]));
  return *value;
}

void resolve_structure(const namelist::schema& schema, options& o) {
  structure_input in{{}, *o.mass, o.surface_pressure, o.surface_temperature};
  in.law = o.temperature_law == "power"       ? temperature_law::power
           : o.temperature_law == "adiabatic" ? temperature_law::adiabatic
                                              : temperature_law::isothermal;
  in.exponent = o.temperature_exponent;
  in.form.dimension = static_cast<int>(o.dimension);
  if (o.temperature_exponent != 0.0 && o.temperature_law != "power")
    schema.fail("planet", "temperature_exponent", "belongs to temperature_law = 'power'");
  const std::size_t number = o.materials.size();
  for (std::size_t n = 0; n < number; ++n)
    in.layers.push_back({o.names[n], schema.placed("planet", "mass", [&] { return eos::make(o.materials[n]); }), 1.0});
  if (o.radius) {
    if (number != 2)
      schema.fail("planet", "radius", "with a radius the fraction of the core follows, which needs two of &layer");
    for (std::size_t n = 0; n < number; ++n)
      if (element_of(o.layer.fraction, n))
        schema.fail_at(group, "fraction", n, "follows from &planet radius: leave one out");
    o.structure = schema.placed("planet", "radius", [&] { return structure_of_radius(in, *o.radius); });
    return;
  }
  double sum = 0.0;
  for (std::size_t n = 0; n < number; ++n)
    sum += in.layers[n].fraction =
        number == 1 ? element_of(o.layer.fraction, n).value_or(1.0) : fraction_of(schema, o, n);
  if (std::abs(sum - 1.0) > 1e-9)
    schema.fail_at(group, "fraction", number - 1,
                   fmt::format("the fractions of the layers add up to {:.10g}: expected 1", sum));
  o.structure = schema.placed("planet", "mass", [&] { return structure_of_mass(in); });
}

// A state of the layer's material, which sets its largest stiffness and slowest sound: in the middle of the layer, or
// of the particle of median density of two bodies.
std::pair<double, double> typical_state(const options& o, std::size_t n) {  // kg/m³, K
  if (o.structure) {
    const auto& levels = o.structure->layers()[n].levels;
    const level& middle = levels[levels.size() / 2];
    return {middle.rho, middle.T};
  }
  std::vector<std::pair<double, double>> of_material;
  for (const auto* b : {&o.impact_of->target, &o.impact_of->impactor})
    for (const auto& p : b->particles)
      if (p.now.material == o.material_of(n)) of_material.emplace_back(p.now.rho, *p.now.energy);
  const eos::caloric material(eos::make(o.materials[n]));
  const auto middle = of_material.begin() + static_cast<std::ptrdiff_t>(of_material.size() / 2);
  std::ranges::nth_element(of_material, middle);
  return {middle->first, material.temperature(middle->first, middle->second)};
}

// What the engine of gas takes.
void fill_engine(options& o) {
  auto& g = o.gas;
  auto& s = g.shock;
  s.scheme = o.scheme;
  s.weight = "volume";
  s.tension = false;
  s.molecular.viscosity = *std::ranges::max_element(o.viscosities);
  if (g.melting.viscosity_varies()) s.molecular.viscosity = std::max(s.molecular.viscosity, g.melting.viscosity_max);
  s.molecular.bulk_viscosity = 5.0 / 3.0 * s.molecular.viscosity;
  g.materials.resize(o.materials.size());
  for (std::size_t n = 0; n < o.materials.size(); ++n) {
    auto& side = g.materials[static_cast<std::size_t>(o.material_of(n))];
    side.eos = o.materials[n].name;
    side.tillotson = o.materials[n].tillotson;
    side.table = o.materials[n].table;
    side.parameters = o.materials[n];
    const auto [rho, T] = typical_state(o, n);
    side.rho = rho;
    side.temperature = T;
    side.viscosity = o.viscosities[n];
    side.metal = o.metals[n];
  }
  auto& d = g.domain;
  const shape form = o.structure ? o.structure->form() : shape{};
  double L = 0.0, R3 = 0.0;
  if (o.structure) {
    const double R = o.structure->radius();
    L = 2.0 * R, R3 = form.power(R);
  } else {
    const auto& [target, impactor, start] = *o.impact_of;
    L = 2.0 * (target.radius + impactor.radius + std::hypot(start.place[0], start.place[1]));
    R3 = std::pow(target.radius, 3) + std::pow(impactor.radius, 3);
  }
  const double dx = form.root(form.volume() / static_cast<double>(o.number_of_particles()) * R3);
  d.dimension = form.dimension;
  for (std::size_t a = 0; a < 3; ++a) {
    const bool is_axis = a < static_cast<std::size_t>(d.dimension);
    d.open[a] = is_axis;
    d.particles[a] = is_axis ? std::llround(L / dx) : 0;
    d.length[a] = is_axis ? L : 0.0;
  }
  gravity::tree_options tree;
  tree.gravitational_constant = G;
  tree.opening = o.opening;
  tree.tolerance = o.tolerance;
  g.self_gravity = tree;
}

}  // namespace

namespace {

void declare_structure(namelist::schema& schema, options& o) {
  schema.group("planet", "a sphere, or a cylinder, of layers in hydrostatic equilibrium under its own gravity");
  schema.add("planet", "dimension", o.dimension,
             between(2, 3, "3: a sphere; 2: a cylinder without ends, whose masses are per metre"));
  schema.add("planet", "mass", o.mass, positive("kg", "of the planet; of a cylinder kg/m"));
  schema.add("planet", "radius", o.radius,
             positive("m", "of the planet: the fractions of two layers follow; not given: it follows from them"));
  schema.add("planet", "surface_pressure", o.surface_pressure, positive("Pa", "at the surface"));
  schema.add("planet", "surface_temperature", o.surface_temperature, positive("K", "at the surface"));
  schema.add("planet", "temperature_law", o.temperature_law,
             {.choices = {"adiabatic", "isothermal", "power"},
              .meaning = "inwards, T on each layer's adiabat, the same throughout, or proportional to "
                         "density^temperature_exponent in each layer; continuous where layers meet"});
  schema.add("planet", "temperature_exponent", o.temperature_exponent,
             between(-10.0, 10.0, "temperature_law = 'power': exponent of the density"));
  schema.add("planet", "spin_period", o.spin_period,
             positive("s", "of a rotation about the z axis, in which the start settles; not given: none"));
  schema.add(
      "planet", "expansion", o.expansion,
      for_expert({.unit = "1/s", .meaning = "radial velocity over radius that the settled planet is given: it rings"}));
}

// Particles, forces and dissipation.
void declare_particles(namelist::schema& schema, options& o) {
  schema.add("planet", "particles", o.particles, between(100, 1e9, "of equal mass, about so many"));
  schema.add("planet", "scheme", o.scheme,
             {.choices = {"ssph", "disph", "remix"},
              .meaning = "standard; density-independent with the volume as weight; or kernels that reproduce linear "
                         "fields, with a density that follows from continuity"});
  gravity::declare_softening(schema, "planet", o.gas.softening, "self-gravity: ");
  gas::declare_largest_support(schema, "planet", o.gas.largest_support);
  schema.add("planet", "opening", o.opening,
             for_expert(namelist::up_to(0.99, "self-gravity: largest opening angle of the tree")));
  schema.add("planet", "tolerance", o.tolerance,
             for_expert({.minimum = 0.0,
                         .maximum = 0.1,
                         .exclusive_minimum = true,
                         .meaning = "self-gravity: error of multipoles, of a lower bound of the field"}));
  schema.add(
      "planet", "substeps", o.gas.common.time.substeps,
      for_expert(between(1, 16, "method = 'kdk': of pressure and friction in a step, at whose ends gravity acts")));
  schema.add("planet", "viscosity", o.viscosity,
             {.unit = "Pa s",
              .minimum = 0.0,
              .meaning = "mu of layers without one of their own, beside the artificial viscosity; the bulk viscosity "
                         "is 5/3 of it, with which "
                         "the forces of pairs are central and angular momentum is conserved"});
  schema.add("planet", "alpha", o.gas.shock.alpha, between(0.0, 10.0, "of the artificial viscosity"));
}

void check_rotation(const namelist::schema& schema, const options& o) {
  const auto& start = o.gas.common.start;
  if (!start.file.empty() && !start.settles())
    for (const char* key : {"spin_period", "expansion"})
      if (schema.changed("planet", key))
        schema.fail("planet", key, "is that of a start which settles: the snapshot has a motion of its own");
  if (!o.spin_period) return;
  const double R = o.structure->radius(), M = o.structure->mass();
  const double shortest = o.structure->form().is_sphere() ? 2.0 * pi * std::sqrt(R * R * R / (G * M))
                                                          : 2.0 * pi * R / std::sqrt(2.0 * G * M);
  if (*o.spin_period < shortest)
    schema.fail(
        "planet", "spin_period",
        fmt::format("at the equator the planet would leave its surface: expected more than {:.6g} s", shortest));
}

}  // namespace

void declare(namelist::schema& schema, options& o) {
  auto& common = o.gas.common;
  common.time.method = "kdk";
  common.time.substeps = 2;
  common.time.rtol = 0.02;
  common.kernel.name = "wendland_c4";
  common.kernel.h_over_dx = 1.8;  // some 200 neighbours [W. Dehnen, H. Aly, MNRAS 425, 1068 (2012)]
  common.kernel.skin = 0.5;
  common.kernel.precision = "single";
  common.start.settle = 6.0;
  o.gas.largest_support = 2.0;
  const gravity::tree_options tree;
  o.opening = tree.opening;
  o.tolerance = tree.tolerance;
  declare_structure(schema, o);
  declare_particles(schema, o);
  declare_mode(schema, o);
  declare_layers(schema, o.layer);
  melting::declare(schema, "of layers that are not metal", o.gas.melting);
  elements::declare(schema, o.gas.element);
  declare_regions(schema, o);
  declare_impact(schema, o.impact);
  schema.group("domain", "who has which particles");
  schema.add(
      "domain", "ranks_x", o.gas.domain.ranks_x.number,
      namelist::changing(between(
          0, 1e6, "MPI ranks side by side along x, a divisor of their number; 0: as the planet's shape suggests")));
  run::declare(schema, common,
               {.single_pairs = true,
                .keeping = {"kdk"},
                .kernels = {"quintic", "wendland_c4"},
                .diffuses = false,
                .starts_from_file = true,
                .settles = true,
                .reads = "places, velocities, densities, masses, materials and internal energies"});
}

void resolve(const namelist::schema& schema, options& o) {
  auto& g = o.gas;
  gas::choose_cfl(g.common.time);
  auto& time = g.common.time;
  // Raised inertia divides gravity as well, by what changes from step to step.
  if (const bool raised = g.melting.inertia_viscosity > 0.0; raised || time.method != "kdk") {
    if (schema.given("planet", "substeps") && time.substeps != 1)
      schema.fail("planet", "substeps",
                  raised ? "with inertia_viscosity gravity acts in each step: expected 1"
                         : "is of the method 'kdk': the others take gravity in each of their stages");
    time.substeps = 1;
  }
  auto& kernel = g.common.kernel;
  if (!schema.given("kernel", "h_over_dx")) {
    if (kernel.name != "wendland_c4") kernel.h_over_dx = 0.0;
    // Of fewer neighbours the rings resist the flow as a lattice does (docs/theory/layered_cylinder.md).
    else if (o.dimension == 2)
      kernel.h_over_dx = 2.2;
  }
  run::resolve(schema, g.common);
  resolve_layers(schema, o);
  resolve_melting(schema, o);
  if (o.impact.is_asked_for()) {
    if (o.dimension != 3) schema.fail("planet", "dimension", "two bodies meet in three dimensions");
    resolve_impact(schema, o);
  } else {
    if (!o.mass) schema.fail("planet", "mass", "must be given, or the two bodies of &impact");
    resolve_structure(schema, o);
    expect_melting_range(schema, o);
    check_rotation(schema, o);
    resolve_mode(schema, o);
  }
  fill_engine(o);
  resolve_regions(schema, o);
  gas::choose_precision(schema, g);
  g.domain.ranks_x.place = schema.where("domain", "ranks_x") + ": &domain ranks_x: ";
  if (!g.common.time.has_end()) schema.fail("time", "t_end", "must be given, or else steps and dt");
  std::vector<std::string> fields{"InternalEnergy", "GravitationalPotential"};
  if (g.has_alpha()) fields.emplace_back("ArtificialViscosity");
  if (g.element.any()) fields.emplace_back("Concentration");
  if (g.melting.melts()) fields.emplace_back("MeltFraction");
  if (g.melting.viscosity_varies()) fields.emplace_back("Viscosity");
  run::check_output(schema, g.common, g.domain, fields);
}

std::string summary(const options& o) {
  if (o.impact_of) {
    const auto& [target, impactor, start] = *o.impact_of;
    const auto text = [](const body& b) {
      return fmt::format("{} particles, {:.6g} kg, radius {:.6g} m", b.particles.size(), b.mass, b.radius);
    };
    return fmt::format(
        "target: {}\nimpactor: {}\nimpact: {:.6g} m/s at contact, mutual escape velocity {:.6g} m/s; at the "
        "start {:.6g} m apart\n",
        text(target), text(impactor), start.contact_speed, start.escape_velocity,
        std::hypot(start.place[0], start.place[1]));
  }
  const profile& p = *o.structure;
  const auto core = p.layers().size() < 2 ? std::string()
                                          : fmt::format("; {} to {:.6g} m, {:.6g} of the mass", o.names[0],
                                                        p.layers()[0].outer().r, p.layers()[0].outer().m / p.mass());
  const auto mode =
      o.mode ? fmt::format("mode of degree {}: growth rate {:.6g} 1/s, {:.6g} m at the contact at {:.6g} m\n", o.degree,
                           o.mode->growth_rate(), o.mode->amplitude(), o.mode->radius())
             : std::string();
  return fmt::format("planet: radius {:.6g} m, in the centre {:.6g} Pa and {:.6g} kg/m3{}\n{}", p.radius(),
                     p.centre().p, p.centre().rho, core, mode);
}

std::string describe(const options& o) {
  const profile& p = *o.structure;
  const auto& layers = p.layers();
  nlohmann::ordered_json j{{"mass", p.mass()},
                           {"radius", p.radius()},
                           {"central_pressure", p.centre().p},
                           {"central_density", p.centre().rho},
                           {"central_temperature", p.centre().T}};
  if (layers.size() > 1) {
    const level &inside = layers[0].outer(), &outside = layers[1].inner();
    j["core_radius"] = inside.r;
    j["core_fraction"] = inside.m / p.mass();
    j["contact_pressure"] = inside.p;
    j["contact_temperature"] = inside.T;
    j["contact_density_below"] = inside.rho;
    j["contact_density_above"] = outside.rho;
  }
  if (const auto rates = growth_rates(o); !rates.empty()) j["growth_rates"] = rates;
  std::vector<double> r, rho, pressure, T, m;
  std::vector<std::string> layer;
  for (std::size_t n = 0; n < layers.size(); ++n)
    for (auto l = layers[n].levels.rbegin(); l != layers[n].levels.rend(); ++l) {
      r.push_back(l->r), rho.push_back(l->rho), pressure.push_back(l->p), T.push_back(l->T), m.push_back(l->m);
      layer.push_back(o.names[n]);
    }
  j["r"] = r, j["density"] = rho, j["pressure"] = pressure, j["temperature"] = T, j["mass_inside"] = m;
  j["layer"] = layer;
  return j.dump(1) + "\n";
}

}  // namespace tetsuame::planet
