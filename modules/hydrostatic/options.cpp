#include <algorithm>
#include <cmath>
#include <hydrostatic/options.hpp>
#include <kernels/kernel.hpp>
#include <walls/treatments.hpp>

namespace tetsuame::hydrostatic {

namespace {

constexpr std::array<const char*, 3> axis_names{"x", "y", "z"};

void declare(namelist::schema& schema, domain_options& o) {
  schema.group("domain", "the box and the start lattice");
  schema.add("domain", "dimension", o.dimension, {.minimum = 2, .maximum = 3, .meaning = "of space; y is up"});
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string axis = axis_names[a];
    const std::string only = a == 2 ? " (3-D only)" : "";
    schema.add(
        "domain", "length_" + axis, o.length[a],
        {.unit = "m", .minimum = 0.0, .exclusive_minimum = true, .meaning = "edge of the box along " + axis + only});
    schema.add("domain", "particles_" + axis, o.particles[a],
               {.minimum = 1, .maximum = 1e9, .meaning = "fluid particles along " + axis + only});
    schema.add("domain", "periodic_" + axis, o.periodic[a],
               {.meaning = "the two sides across " + axis + " are one, or else walls" + only});
  }
  run::declare(schema, o.ranks_x);
}

void declare(namelist::schema& schema, initial_options& o) {
  schema.group("initial", "start state");
  schema.add("initial", "temperature", o.temperature,
             {.unit = "K", .minimum = 0.0, .exclusive_minimum = true, .meaning = "everywhere"});
  schema.add("initial", "pressure", o.pressure,
             {.unit = "Pa",
              .minimum = 0.0,
              .exclusive_minimum = true,
              .meaning = "everywhere, or at the top where the profile is hydrostatic"});
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
  for (const auto& p : eos::parameters) {
    const bool positive = p.allowed == eos::parameter::range::positive;
    namelist::key_info info{.unit = std::string(p.unit), .meaning = std::string(p.meaning)};
    if (positive || p.allowed == eos::parameter::range::not_negative) info.minimum = 0.0;
    if (p.allowed == eos::parameter::range::above_one) info.minimum = 1.0;
    info.exclusive_minimum = positive || p.allowed == eos::parameter::range::above_one;
    if (p.key == "reference_pressure") info.meaning += "; of linear: the initial pressure unless given";
    schema.add("material", std::string(p.key), o.eos.*p.member, info);
  }
  schema.add("material", "viscosity", o.viscosity, {.unit = "Pa s", .minimum = 0.0, .meaning = "dynamic viscosity"});
  schema.add("material", "conductivity", o.conductivity,
             {.unit = "W/(m K)", .minimum = 0.0, .meaning = "thermal conductivity"});
}

void check_box(const namelist::schema& schema, const options& o) {
  const auto& d = o.domain;
  const run::box_of_particles box{d.dimension, d.length, d.particles, d.periodic};
  run::check_number(schema, box, expected_particles(o));
  const double dx = o.dx();
  for (std::size_t a = 1; a < static_cast<std::size_t>(d.dimension); ++a) {
    const double spacing = d.length[a] / static_cast<double>(d.particles[a]);
    if (std::abs(spacing - dx) > 1e-9 * dx)
      schema.fail("domain", std::string("particles_") + axis_names[a],
                  "the particle spacing must be the same along x and " + std::string(axis_names[a]) + ": " +
                      std::to_string(dx) + " m and " + std::to_string(spacing) + " m; change particles_" +
                      axis_names[a] + " or length_" + axis_names[a]);
  }
  for (std::size_t a = 0; a < static_cast<std::size_t>(d.dimension); ++a)
    if (d.periodic[a] && 2.0 * o.support() > d.length[a])
      schema.fail("domain", std::string("particles_") + axis_names[a],
                  "the kernel's support, " + std::to_string(2.0 * o.support()) +
                      " m across, is wider than the periodic box, " + std::to_string(d.length[a]) + " m along " +
                      axis_names[a] + ": use more particles or a smaller h_over_dx");
  const bool filled =
      o.walls.treatment == "virtual_marker" || o.walls.treatment == "frozen" || o.walls.treatment == "mirror";
  run::check_widths(schema, box, o.halo_width(), filled ? o.support() : 0.0);
}

}  // namespace

double options::support() const { return run::support_over_dx(kernel) * dx(); }

double options::halo_width() const {
  return support() * std::max(1.0, walls::radius_factor(walls)) + kernel.skin * dx();
}

double expected_particles(const options& o) { return run::lattice_particles(o.domain.dimension, o.domain.particles); }

void declare(namelist::schema& schema, options& o) {
  declare(schema, o.domain);
  declare(schema, o.initial);
  schema.group("gravity", "uniform gravity");
  schema.add("gravity", "g", o.g, {.unit = "m/s^2", .minimum = 0.0, .meaning = "acceleration, towards -y"});
  declare(schema, o.material);
  walls::declare(schema, {.treatments = walls::names}, o.walls);
  volume::declare(schema, o.smoothing);
  volume::declare(schema, o.hosono);
  run::declare(schema, o, {.diffuses = false, .ends_by_steps = true});
}

void resolve(const namelist::schema& schema, options& o) {
  run::resolve(schema, o);
  run::resolve(schema, o.domain.ranks_x);
  check_box(schema, o);
  if (o.g == 0.0) o.initial.profile = "uniform";
  if (o.initial.profile == "hydrostatic" && o.domain.periodic[1])
    schema.fail("domain", "periodic_y",
                "a hydrostatic profile needs walls at the bottom and the top: set periodic_y = .false.");
  if (o.material.eos.name == "linear" && !o.material.eos.reference_pressure)
    o.material.eos.reference_pressure = o.initial.pressure;
  o.material.eos = schema.placed("material", "eos", [&] { return eos::resolve(o.material.eos); });
  run::check_interval(schema, o.output, o.time.end());
}

}  // namespace tetsuame::hydrostatic
