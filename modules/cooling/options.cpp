#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cooling/options.hpp>

namespace tetsuame::cooling {

void declare(namelist::schema& schema, options& o) {
  constexpr std::array<const char*, 3> axis_names{"x", "y", "z"};
  o.walls.sides[2] = {.thermal = "fixed", .temperature = 1.0};
  o.walls.sides[3] = {.thermal = "fixed", .temperature = 0.0};
  o.common.time.method = "euler";
  o.common.time.t_end = 1e4;
  o.common.output.history_interval = 50;

  schema.group("domain", "the box and the start lattice");
  schema.add("domain", "dimension", o.dimension, {.minimum = 2, .maximum = 3, .meaning = "of space; y is up"});
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string axis = axis_names[a], only = a == 2 ? " (3-D only)" : "";
    schema.add(
        "domain", "length_" + axis, o.box.length[a],
        {.unit = "m", .minimum = 0.0, .exclusive_minimum = true, .meaning = "edge of the box along " + axis + only});
    schema.add("domain", "particles_" + axis, o.box.particles[a],
               {.minimum = 4, .maximum = 1e6, .meaning = "particles along " + axis + only});
    if (a != 1)
      schema.add("domain", "periodic_" + axis, o.box.periodic[a],
                 {.meaning = "the two sides across " + axis + " are one, or else walls" + only});
  }
  run::declare(schema, o.box.ranks_x);
  schema.add("domain", "jitter", o.jitter,
             {.minimum = 0.0,
              .maximum = 0.3,
              .meaning = "particles are moved off the lattice by up to so many spacings along each axis"});
  schema.group("conduction", "a body that cools from its top");
  schema.add("conduction", "diffusivity", o.kappa,
             {.unit = "m^2/s", .minimum = 0.0, .exclusive_minimum = true, .meaning = "kappa, thermal"});
  schema.add("conduction", "temperature", o.start, {.unit = "K", .meaning = "at the start"});
  schema.add("conduction", "reference", o.reference,
             {.choices = {"plate", "half_space"}, .meaning = "exact solution the errors are against"});
  if (o.by_program) {
    o.scheme = "sum";
    schema.pass_over("conduction", {"operator"});
    o.common.kernel.name = "quintic";
    walls::declare(schema, {.treatments = {"virtual_marker", "none", "mirror"}, .moving = false}, o.walls);
  } else {
    schema.add("conduction", "operator", o.scheme,
               {.choices = {"sum", "consistent", "corrected"},
                .meaning = "Laplacian: the slides' sum; with right second moments; that with the deferred correction"});
    walls::declare(schema, {.moving = false}, o.walls);
  }
  run::declare(schema, o.common, {.lists_change = false});
}

double expected_particles(const options& o) { return run::lattice_particles(o.dimension, o.box.particles); }

void resolve(const namelist::schema& schema, options& o) {
  if (!schema.passed().empty())
    o.lines.push_back(fmt::format("note: passed over, as this program has a scheme of its own: {}",
                                  fmt::join(schema.passed(), ", ")));
  run::resolve(schema, o.common);
  run::check_output(schema, o.common);
  run::resolve(schema, o.box.ranks_x);
  const double dx = o.dx();
  for (std::size_t a = 0; a < static_cast<std::size_t>(o.dimension); ++a)
    if (const double spacing = o.box.length[a] / static_cast<double>(o.box.particles[a]);
        std::abs(spacing - dx) > 1e-9 * dx)
      schema.fail(
          "domain", a == 0 ? "particles_x" : "particles_z",
          fmt::format("the particle spacing must be the same along all axes: here {} m, along y {} m", spacing, dx));
  const run::box_of_particles box{o.dimension, o.box.length, o.box.particles, o.box.periodic};
  const double support = run::support_over_dx(o.common.kernel) * dx;
  run::check_number(schema, box, expected_particles(o));
  run::check_widths(schema, box, std::max(support, o.halo()) + o.common.kernel.skin * dx, support);
  const auto& sides = o.walls.sides;
  if (sides[3].thermal != "fixed")
    schema.fail("walls", "thermal_top", "the exact solutions are of a top at a fixed temperature");
  if (sides[3].temperature == o.start)
    schema.fail("conduction", "temperature", "the body must start at another temperature than its top's");
  if (o.reference == "plate" && (sides[2].thermal != "fixed" || sides[2].temperature != o.start))
    schema.fail("walls", "temperature_bottom", "the plate's bottom is kept at the temperature it starts with");
  if (o.reference == "half_space" && *o.common.time.t_end > 0.0) {
    // The exact solution must not have met the bottom.
    const double reached = std::erfc(o.box.length[1] / (2.0 * std::sqrt(o.kappa * *o.common.time.t_end)));
    if (reached > 1e-4)
      schema.fail(
          "time", "t_end",
          fmt::format("the cooling reaches the bottom: there the half space has lost {:.2g} of its difference in "
                      "temperature; stop earlier or take a deeper box",
                      reached));
  }
}

}  // namespace tetsuame::cooling
