#include <fmt/format.h>
#include <gravity/options.hpp>

#include <algorithm>
#include <eos/keys.hpp>
#include <hydrostatic/profile.hpp>
#include <walls/treatments.hpp>

namespace tetsuame::hydrostatic {

namespace {

const domain::demands demands{};

void declare(namelist::schema& schema, initial_options& o) {
  schema.group("initial", "start state");
  schema.add("initial", "temperature", o.temperature, namelist::positive("K", "everywhere"));
  schema.add("initial", "pressure", o.pressure,
             namelist::positive("Pa", "everywhere, or at the top where the profile is hydrostatic"));
  schema.add(
      "initial", "profile", o.profile,
      {.choices = {"hydrostatic", "uniform"},
       .meaning = "of pressure and density; hydrostatic: exact for the equation of state, uniform without gravity"});
}

void declare(namelist::schema& schema, material_options& o) {
  schema.group("material", "equation of state and transport");
  std::vector<std::string> choices;
  for (const auto name : eos::names()) choices.emplace_back(name);
  schema.add("material", "eos", o.eos.name,
             {.choices = choices, .meaning = "equation of state; its parameters default to the material's own"});
  schema.add("material", "curve", o.eos.curve, {.meaning = "of liquid_silicate: vinet or birch_murnaghan"});
  schema.add("material", "tillotson", o.eos.tillotson, {.meaning = "of tillotson: iron, granite or basalt"});
  schema.add("material", "table", o.eos.table, namelist::for_expert(eos::key_of_table()));
  for (const auto& p : eos::parameters) {
    namelist::key_info info = eos::key_of(p);
    for (const auto rare : {"bulk_modulus_second_derivative", "gruneisen", "gruneisen_exponent",
                            "electronic_coefficient", "electronic_exponent", "gamma", "p_infinity", "debye_temperature",
                            "nonlinear_modulus", "tillotson_a", "tillotson_b", "tillotson_energy", "incipient_energy",
                            "complete_energy", "tillotson_alpha", "tillotson_beta"})
      info.expert = info.expert || p.key == rare;
    if (p.key == "reference_pressure") info.meaning += "; of linear: the initial pressure unless given";
    schema.add("material", std::string(p.key), o.eos.*p.member, info);
  }
  schema.add("material", "viscosity", o.viscosity, {.unit = "Pa s", .minimum = 0.0, .meaning = "dynamic viscosity"});
  schema.add("material", "conductivity", o.conductivity,
             {.unit = "W/(m K)", .minimum = 0.0, .meaning = "thermal conductivity"});
}

void check_box(const namelist::schema& schema, const options& o) {
  const auto& d = o.domain;
  for (std::size_t a = 0; a < d.axes(); ++a)
    if (d.periodic[a] && 2.0 * o.support() > d.length[a])
      schema.fail("domain", std::string("particles_") + "xyz"[a],
                  fmt::format("the kernel's support, {} m across, is wider than the periodic box, {} m along {}: use "
                              "more particles or a smaller h_over_dx",
                              2.0 * o.support(), d.length[a], "xyz"[a]));
  const bool filled =
      o.walls.treatment == "virtual_marker" || o.walls.treatment == "frozen" || o.walls.treatment == "mirror";
  domain::check_widths(schema, d, o.halo() + o.kernel.skin * d.dx(), filled ? o.support() : 0.0);
}

}  // namespace

double options::support() const { return run::support_over_dx(kernel) * domain.dx(); }

double options::halo() const { return support() * std::max(1.0, walls::radius_factor(walls)); }

void declare(namelist::schema& schema, options& o) {
  domain::declare(schema, demands, o.domain);
  declare(schema, o.initial);
  schema.group("gravity", "uniform gravity");
  gravity::declare(schema, "gravity", "g", o.g);
  declare(schema, o.material);
  walls::declare(schema, {.treatments = walls::names}, o.walls);
  volume::declare(schema, o.scheme);
  regions::declare(schema, of_regions, o.of_regions);
  sources::declare(schema, {}, o.of_sources);
  run::declare(schema, o, {.single_pairs = true, .diffuses = false, .starts_from_file = true, .settles = true});
}

void resolve(const namelist::schema& schema, options& o) {
  run::resolve(schema, o);
  domain::resolve(schema, demands, o.domain);
  check_box(schema, o);
  volume::resolve(schema, o.scheme, false);
  if (o.g == 0.0) o.initial.profile = "uniform";
  if (o.initial.profile == "hydrostatic" && o.domain.periodic[1])
    schema.fail("domain", "periodic_y",
                "a hydrostatic profile needs walls at the bottom and the top: set periodic_y = .false.");
  if (o.material.eos.name == "linear" && !o.material.eos.reference_pressure)
    o.material.eos.reference_pressure = o.initial.pressure;
  o.material.eos = schema.placed("material", "eos", [&] { return eos::resolve(o.material.eos); });
  const auto material = schema.placed("material", "eos", [&] { return eos::make(o.material.eos); });
  schema.placed("material", o.material.eos.table.empty() ? "bulk_modulus" : "table",
                [&] { profile(o, material).pressure(0.0); });
  const int dimension = static_cast<int>(o.domain.dimension);
  o.regions = regions::all(schema, of_regions, o.of_regions, dimension, o.domain.length, o.domain.dx());
  if (o.regions.any() && !o.start.file.empty())
    schema.fail("initial", "file", "a snapshot says what is where, and so does &region");
  for (const auto w : {regions::what::velocity_x, regions::what::velocity_y, regions::what::velocity_z})
    if (o.start.settles() && o.regions.give(w))
      schema.fail("initial", "settle", "the start moves: &region gives velocities");
  o.sources = sources::all(schema, o.of_sources, o.of_regions, dimension, o.domain.length, o.domain.dx());
  if (o.scheme.energy.internal()) o.sources.refuse_temperature(schema, "&energy variable is the internal energy");
  run::check_output(schema, o, o.domain,
                    {"Weight", "InternalEnergyGain", "Viscosity", "PressureEOS", "SoundSpeed", "PressureReference",
                     "DensityReference", "Displacement"});
}

}  // namespace tetsuame::hydrostatic
