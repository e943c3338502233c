#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <granular/options.hpp>
#include <gravity/options.hpp>
#include <limits>
#include <namelist/lists.hpp>
#include <namelist/refuse.hpp>
#include <numbers>
#include <output/units.hpp>
#include <solids/extents.hpp>

namespace tetsuame::granular {

namespace {

using namelist::between, namelist::element_of, namelist::for_expert, namelist::longest, namelist::positive;

constexpr domain::demands demands_of_box{.lattice = false};
constexpr std::array<const char*, 6> side_names{"left", "right", "bottom", "top", "back", "front"};
constexpr std::array<const char*, 3> axis_names{"x", "y", "z"};

std::string along(const char* what, std::size_t axis) { return fmt::format("{}_{}", what, axis_names[axis]); }

void declare_materials(namelist::schema& schema, options& o) {
  const auto list = [](namelist::key_info one) { return namelist::one_each(std::move(one), most_materials); };
  auto& m = o.materials_given;
  schema.group("material", "of grains and walls; may stand several times");
  schema.add("material", "name", m.name, list({.meaning = "of the material"}));
  schema.add("material", "density", m.density, list(positive("kg/m^3", "of a grain; not given: 2500")));
  schema.add("material", "young_modulus", m.young_modulus, list(positive("Pa", "of Hertz's contact; not given: 1e7")));
  schema.add("material", "poisson_ratio", m.poisson_ratio, list(between(0.0, 0.5, "not given: 0.25")));
  schema.add("material", "restitution", m.restitution,
             list(between(0.01, 1.0,
                          "speed after over speed before a head-on impact; not given: the other material's, or 0.9")));
  schema.add("material", "friction", m.friction,
             list(between(0.0, 10.0, "Coulomb's coefficient; not given: the other material's, or 0.5")));
  schema.add("material", "rolling_friction", m.rolling_friction,
             list(between(0.0, 10.0, "coefficient of rolling resistance; not given: the other material's, or 0")));
  schema.add("material", "adhesion", m.adhesion,
             list({.unit = "J/m^2",
                   .minimum = 0.0,
                   .meaning = "work of adhesion (JKR) of two such surfaces; not given: the other material's, or 0"}));
  auto& p = o.pairs_given;
  schema.group("pair", "the contact of two materials; may stand several times. Without it the smaller value of both");
  schema.add("pair", "first", p.first, list({.meaning = "name of a material"}));
  schema.add("pair", "second", p.second, list({.meaning = "name of the other"}));
  schema.add("pair", "restitution", p.restitution, list(between(0.01, 1.0, "not given: the smaller value of both")));
  schema.add("pair", "friction", p.friction, list(between(0.0, 10.0, "not given: the smaller value of both")));
  schema.add("pair", "rolling_friction", p.rolling_friction,
             list(between(0.0, 10.0, "not given: the smaller value of both")));
  schema.add("pair", "adhesion", p.adhesion,
             list({.unit = "J/m^2", .minimum = 0.0, .meaning = "not given: the smaller value of both"}));
}

void declare_grains(namelist::schema& schema, options& o) {
  const auto of = [](std::size_t most) {
    return [most](namelist::key_info one) { return namelist::one_each(std::move(one), most); };
  };
  const auto single = of(most_grains), packed = of(most_packings);
  auto& g = o.grains_given;
  schema.group("grain", "a single grain; may stand several times, or as lists");
  schema.add("grain", "material", g.material, single({.meaning = "by name; not given: the first one"}));
  schema.add("grain", "radius", g.radius, single(positive("m", "of the sphere")));
  for (std::size_t a = 0; a < 3; ++a)
    schema.add("grain", axis_names[a], g.place[a], single({.unit = "m", .meaning = "of its centre"}));
  for (std::size_t a = 0; a < 3; ++a)
    schema.add("grain", along("velocity", a), g.velocity[a], single({.unit = "m/s", .meaning = "at the start"}));
  for (std::size_t a = 0; a < 3; ++a)
    schema.add("grain", along("spin", a), g.spin[a],
               single({.unit = "1/s", .meaning = a < 2 ? "angular velocity (3-D only)" : "angular velocity"}));
  auto& p = o.packings_given;
  schema.group("packing",
               "a part of the box that is filled with grains on a lattice; may stand several times. With "
               "neither it nor &grain the box is filled with radius = 0.02");
  schema.add("packing", "material", p.material, packed({.meaning = "by name; not given: the first one"}));
  schema.add("packing", "radius", p.radius, packed(positive("m", "of the spheres")));
  schema.add("packing", "radius_max", p.radius_max,
             packed(positive("m", "radii are spread evenly from radius to this; not given: all alike")));
  for (std::size_t a = 0; a < 3; ++a)
    schema.add("packing", along("low", a), p.low[a],
               packed({.unit = "m", .meaning = "begin of the part; not given: 0"}));
  for (std::size_t a = 0; a < 3; ++a)
    schema.add("packing", along("high", a), p.high[a],
               packed({.unit = "m", .meaning = "its end; not given: that of the box"}));
  schema.add("packing", "spacing", p.spacing,
             packed(between(1.0, 100.0, "edge of a cell over the largest diameter; not given: 1")));
  schema.add("packing", "jitter", p.jitter,
             packed(between(0.0, 1.0, "grains start off the middle of their cells, by up to this part of the room")));
  for (std::size_t a = 0; a < 3; ++a)
    schema.add("packing", along("velocity", a), p.velocity[a], packed({.unit = "m/s", .meaning = "at the start"}));
  schema.add("packing", "random_velocity", p.random_velocity,
             packed({.unit = "m/s", .minimum = 0.0, .meaning = "each component differs by up to this"}));
}

void declare_walls(namelist::schema& schema, options& o) {
  schema.group("walls", "sides of the box that are not periodic, and bodies");
  for (std::size_t n = 0; n < 6; ++n)
    schema.add(
        "walls", side_names[n], o.boundary[n],
        {.choices = {"wall", "open"},
         .meaning = n < 4 ? "a plane wall; or grains may leave" : "a plane wall; or grains may leave (3-D only)"});
  schema.add("walls", "material", o.wall_material,
             {.meaning = "of sides and bodies, by name; not given: the first one"});
  solids::declare(schema, o.solids, o.motions);
  schema.group("gate", "a body that moves off once all grains are at rest");
  schema.add("gate", "body", o.gate_body, {.meaning = "name of a body of &solids; not given: there is no gate"});
  for (std::size_t a = 0; a < 3; ++a)
    schema.add("gate", along("velocity", a), o.gate_velocity[a], {.unit = "m/s", .meaning = "once it is open"});
  schema.add("gate", "distance", o.gate_distance,
             positive("m", "it stops after so far; not given: the sum of the box's edges"));
  schema.add("gate", "rest_speed", o.gate_rest, positive("m/s", "it opens when no grain is faster"));
}

std::size_t find(const namelist::schema& schema, const options& o, const char* group, const char* key, std::size_t n,
                 const std::string& name) {
  const auto& all = o.table.materials;
  if (name.empty()) return 0;
  for (std::size_t k = 0; k < all.size(); ++k)
    if (all[k].name == name) return k;
  std::string known;
  for (const auto& m : all) known += (known.empty() ? "'" : ", '") + m.name + "'";
  schema.fail_at(group, key, n, fmt::format("there is no material '{}'; there are {}", name, known));
}

std::vector<dem::material> materials_of(const namelist::schema& schema, const options& o) {
  const auto& m = o.materials_given;
  std::vector<dem::material> all(
      std::max<std::size_t>(1, longest(m.name, m.density, m.young_modulus, m.poisson_ratio, m.restitution, m.friction,
                                       m.rolling_friction, m.adhesion)));
  for (std::size_t n = 0; n < all.size(); ++n) {
    auto& one = all[n];
    one.name = element_of(m.name, n);
    if (one.name.empty()) one.name = fmt::format("material {}", n + 1);
    for (std::size_t k = 0; k < n; ++k)
      if (all[k].name == one.name) schema.fail_at("material", "name", n, fmt::format("'{}' is given twice", one.name));
    const auto take = [&](const std::vector<double>& given, double& value) {
      value = element_of(given, n).value_or(value);
    };
    take(m.density, one.density);
    take(m.young_modulus, one.young_modulus);
    take(m.poisson_ratio, one.poisson_ratio);
    take(m.restitution, one.restitution);
    take(m.friction, one.friction);
    take(m.rolling_friction, one.rolling_friction);
    take(m.adhesion, one.adhesion);
  }
  return all;
}

void make_table(const namelist::schema& schema, options& o) {
  o.table.materials = materials_of(schema, o);
  const auto& p = o.pairs_given;
  std::vector<dem::pair_rule> rules;
  for (std::size_t n = 0; n < longest(p.first, p.second, p.restitution, p.friction, p.rolling_friction, p.adhesion);
       ++n) {
    for (const auto& [key, list] : {std::pair("first", &p.first), std::pair("second", &p.second)})
      if (element_of(*list, n).empty()) schema.fail("pair", key, "must be given of each pair");
    dem::pair_rule rule{find(schema, o, "pair", "first", n, p.first[n]),
                        find(schema, o, "pair", "second", n, p.second[n]),
                        0.0,
                        0.0,
                        0.0,
                        0.0};
    const auto &a = o.table.materials[rule.first], &b = o.table.materials[rule.second];
    rule.restitution =
        element_of(p.restitution, n).value_or(dem::smaller_of(a.restitution, b.restitution, dem::default_restitution));
    rule.friction = element_of(p.friction, n).value_or(dem::smaller_of(a.friction, b.friction, dem::default_friction));
    rule.rolling_friction =
        element_of(p.rolling_friction, n)
            .value_or(dem::smaller_of(a.rolling_friction, b.rolling_friction, dem::default_rolling_friction));
    rule.adhesion = element_of(p.adhesion, n).value_or(dem::smaller_of(a.adhesion, b.adhesion, dem::default_adhesion));
    rules.push_back(rule);
  }
  dem::contact_rules how;
  how.model = o.contact == "hooke" ? dem::contact_model::hooke : dem::contact_model::hertz_mindlin;
  how.rolling = o.rolling == "none"              ? dem::rolling_model::none
                : o.rolling == "constant_torque" ? dem::rolling_model::constant_torque
                                                 : dem::rolling_model::spring;
  how.stiffness = o.stiffness;
  how.tangential_part = o.tangential_part;
  how.rolling_damping = o.rolling_damping;
  o.table = dem::contact_table(how, o.table.materials, rules);
  if (how.model == dem::contact_model::hooke && o.table.adheres())
    schema.fail("material", "adhesion", "belongs to contact = 'hertz_mindlin'");
}

template <int D>
dem::wall_set<D> walls_of(const namelist::schema& schema, const options& o) {
  dem::wall_set<D> all;
  for (std::size_t a = 0; a < D; ++a)
    for (std::size_t end = 0; end < 2; ++end)
      if (!o.domain.periodic[a] && o.boundary[2 * a + end] == "wall")
        all.sides.push_back({a, end == 0 ? 0.0 : o.domain.length[a], end == 0 ? 1.0 : -1.0});
  all.bodies = solids::make_bodies<D>(schema, o.solids);
  all.motions = solids::make_motions<D>(schema, o.motions, all.bodies);
  std::vector<std::string> names;
  for (const auto& b : all.bodies) names.push_back(b.name());
  for (const auto& free : solids::make_free(schema, o.motions, D, names))
    if (free) schema.fail("motions", "kind", "bodies of this program move as prescribed: grains do not push them");
  all.materials.assign(all.size(), o.material_of_walls);
  if (o.gate_body.empty()) return all;
  const auto found = std::ranges::find(names, o.gate_body);
  if (found == names.end()) schema.fail("gate", "body", fmt::format("there is no body '{}' in &solids", o.gate_body));
  dem::gate<D> gate;
  gate.body = static_cast<std::size_t>(found - names.begin());
  gate.at_rest = o.gate_rest;
  for (std::size_t a = 0; a < D; ++a) gate.velocity[a] = o.gate_velocity[a];
  if (!(solids::norm<D>(gate.velocity) > 0.0))
    schema.fail("gate", "velocity_y", "the gate stands still: give it a velocity");
  double far = o.gate_distance.value_or(0.0);
  for (std::size_t a = 0; a < D && !o.gate_distance; ++a) far += o.domain.length[a];
  gate.seconds = far / solids::norm<D>(gate.velocity);
  all.gate = gate;
  return all;
}

void check_grains(const namelist::schema& schema, const options& o) {
  const auto& g = o.grains_given;
  for (std::size_t n = 0; n < g.number(); ++n) {
    find(schema, o, "grain", "material", n, element_of(g.material, n));
    if (!element_of(g.radius, n)) schema.fail("grain", "radius", fmt::format("must be given of grain {}", n + 1));
    for (std::size_t a = 0; a < o.domain.axes(); ++a)
      if (!element_of(g.place[a], n))
        schema.fail("grain", axis_names[a], fmt::format("must be given of grain {}", n + 1));
  }
  const auto& p = o.packings_given;
  for (std::size_t n = 0; n < p.number(); ++n) {
    find(schema, o, "packing", "material", n, element_of(p.material, n));
    if (!element_of(p.radius, n)) schema.fail("packing", "radius", fmt::format("must be given of packing {}", n + 1));
    if (element_of(p.radius_max, n).value_or(p.radius[n]) < p.radius[n])
      schema.fail_at("packing", "radius_max", n, "is less than radius");
    for (std::size_t a = 0; a < o.domain.axes(); ++a)
      if (!(element_of(p.low[a], n).value_or(0.0) < element_of(p.high[a], n).value_or(o.domain.length[a])))
        schema.fail("packing", along("high", a), fmt::format("packing {} ends where it begins, or before", n + 1));
  }
  const std::int64_t number = number_of_grains(o);
  if (number == 0)
    schema.fail("packing", "radius", "there are no grains: give &grain, or a &packing that is wider than a grain");
  if (number > 1'000'000'000'000) schema.fail("packing", "radius", "expected at most 1e12 grains");
}

// Of Rayleigh's wave; of springs a quarter of the shortest contact. Dashpots take velocities that lag behind their own
// forces: a bed comes to rest with steps up to some 0.08/α of either (docs/studies/2026-11-29_grains.md).
void find_step_limit(options& o) {
  o.step_limit = std::numeric_limits<double>::infinity();
  double lightest = o.step_limit;
  for_each_grain(o, [&](const grain& one) {
    const auto& m = o.table.materials[static_cast<std::size_t>(one.material)];
    o.largest_radius = std::max(o.largest_radius, one.radius);
    const double mass = 4.0 / 3.0 * std::numbers::pi * m.density * std::pow(one.radius, 3);
    lightest = std::min(lightest, mass);
    if (o.contact == "hertz_mindlin") o.step_limit = std::min(o.step_limit, dem::rayleigh_time(m, one.radius));
  });
  o.step_limit_is = "Rayleigh's wave";
  if (o.contact == "hooke") {
    o.step_limit = 0.25 * std::numbers::pi * std::sqrt(0.5 * lightest / o.stiffness);
    o.step_limit_is = "a contact";
  }
  constexpr double light = 0.3;  // α
  if (const double damping = o.table.largest_damping(); damping > light) {
    o.step_limit *= light / damping;
    o.step_limit_is = "dashpots";
  }
}

}  // namespace

void declare(namelist::schema& schema, options& o) {
  o.common.time.method = "kdk";
  o.common.time.cfl = 0.2;
  o.common.time.t_end = 1.0;
  o.common.kernel.name = "wendland_c2";
  o.common.kernel.h_over_dx = 0.5;  // its support is a diameter of the largest grain
  o.common.kernel.skin = 0.1;
  o.common.output.history_interval = 100;
  domain::declare(schema, demands_of_box, o.domain);
  schema.group("granular", "grains and their contacts");
  schema.add("granular", "contact", o.contact,
             {.choices = {"hertz_mindlin", "hooke"},
              .meaning = "Hertz's and Mindlin's spheres; or linear springs and dashpots"});
  schema.add("granular", "stiffness", o.stiffness,
             {.unit = "N/m", .minimum = 0.0, .meaning = "'hooke': of the normal spring"});
  schema.add("granular", "tangential_part", o.tangential_part,
             between(0.0, 1.0, "'hooke': stiffness of the tangential spring, over the normal one's"));
  schema.add("granular", "rolling", o.rolling,
             {.choices = {"none", "constant_torque", "spring"},
              .meaning = "resistance to rolling: none; a torque of constant size; an elastic-plastic spring with a "
                         "dashpot (Ai et al. 2011, A and C)"});
  schema.add("granular", "rolling_damping", o.rolling_damping,
             for_expert(between(0.0, 1.0, "'spring': of its dashpot, over critical damping")));
  schema.add("granular", "overlap_limit", o.overlap_limit,
             for_expert(between(0.0, 0.5, "grains may overlap so much at the start, in radii of the smaller one")));
  schema.add("granular", "rest_speed", o.rest_speed,
             {.unit = "m/s",
              .minimum = 0.0,
              .meaning = "the run is complete when no grain is faster, and any gate is open; 0: it goes on to t_end"});
  schema.add("granular", "flux_height", o.flux_height,
             {.unit = "m", .minimum = 0.0, .meaning = "discharge_rate is of grains that fall below this y; 0: none"});
  schema.add("granular", "seed", o.seed, between(0.0, 1e9, "of the random radii, places and velocities of &packing"));
  schema.group("gravity", "uniform gravity");
  gravity::declare(schema, "gravity", "g", o.g);
  schema.add(
      "gravity", "incline", o.incline,
      {.unit = "degrees", .minimum = -180.0, .maximum = 180.0, .meaning = "by which it is turned from -y towards x"});
  declare_materials(schema, o);
  declare_grains(schema, o);
  declare_walls(schema, o);
  run::declare(schema, o.common,
               {.methods = {"kdk"},
                .has_kernel = false,
                .diffuses = false,
                .limits_diffusion = false,
                .cfl_is = "dt over the time of Rayleigh's wave through half a grain; of 'hooke', over a quarter of the "
                          "shortest contact; over less where restitution is low"});
}

void resolve(const namelist::schema& schema, options& o) {
  run::resolve(schema, o.common);
  domain::resolve(schema, demands_of_box, o.domain);
  if (o.contact == "hooke" && !(o.stiffness > 0.0))
    schema.fail("granular", "stiffness", "contact = 'hooke' needs the stiffness of its springs");
  if (o.contact == "hooke")
    namelist::refuse(schema, "material", {"young_modulus", "poisson_ratio"}, "belongs to contact = 'hertz_mindlin'");
  else
    namelist::refuse(schema, "granular", {"stiffness", "tangential_part"}, "belongs to contact = 'hooke'");
  make_table(schema, o);
  double friction = 0.0;
  for (const auto& m : o.table.materials) friction = std::fmax(friction, std::isnan(m.friction) ? 1.0 : m.friction);
  if (o.contact == "hooke" && o.tangential_part == 0.0 && friction > 0.0)
    schema.fail("granular", "tangential_part", "friction needs a tangential spring: expected more than 0");
  if (o.rolling != "spring") namelist::refuse(schema, "granular", {"rolling_damping"}, "belongs to rolling = 'spring'");
  o.material_of_walls = find(schema, o, "walls", "material", 0, o.wall_material);
  for (std::size_t n = 0; n < 2 * o.domain.axes(); ++n)
    if (o.domain.periodic[n / 2] && schema.changed("walls", side_names[n]))
      schema.fail("walls", side_names[n], fmt::format("the box is periodic along {}", axis_names[n / 2]));
  if (o.grains_given.number() + o.packings_given.number() == 0) o.packings_given.radius = {0.02};
  if (o.domain.dimension == 2)
    for (const auto& [group, keys] :
         {std::pair<std::string, std::vector<std::string>>{"grain", {"z", "velocity_z", "spin_x", "spin_y"}},
          {"packing", {"low_z", "high_z", "velocity_z"}},
          {"walls", {"back", "front"}},
          {"gate", {"velocity_z"}}})
      namelist::refuse(schema, group, keys, "belongs to dimension = 3");
  check_grains(schema, o);
  find_step_limit(o);
  const double diameter = 2.0 * o.largest_radius;
  for (std::size_t a = 0; a < o.domain.axes(); ++a) {
    o.domain.particles[a] = std::max<std::int64_t>(1, std::llround(o.domain.length[a] / diameter));
    if (o.domain.length[a] < (o.domain.periodic[a] ? 3.0 : 1.0) * diameter)
      schema.fail("domain", along("length", a),
                  fmt::format("expected at least {} m, {} diameters of the largest grain",
                              (o.domain.periodic[a] ? 3.0 : 1.0) * diameter, o.domain.periodic[a] ? 3 : 1));
  }
  if (o.domain.dimension == 2)
    o.flat = walls_of<2>(schema, o);
  else
    o.deep = walls_of<3>(schema, o);
  if (o.gate_body.empty())
    namelist::refuse(schema, "gate", {"velocity_x", "velocity_y", "velocity_z", "distance", "rest_speed"},
                     "there is no gate: body is not given");
  if (o.common.time.dt && *o.common.time.dt > o.step_limit)
    schema.fail("time", "dt",
                fmt::format("expected at most {:.4g} s, the limit by {}: here dt is {:.3g} times that", o.step_limit,
                            o.step_limit_is, *o.common.time.dt / o.step_limit));
  if (*o.common.time.cfl > 1.0) schema.fail("time", "cfl", "expected at most 1, the limit by " + o.step_limit_is);
  run::check_output(schema, o.common, o.domain,
                    {"Radius", o.domain.dimension == 2 ? "AngularVelocity" : "Spin", "CoordinationNumber"});
}

}  // namespace tetsuame::granular
