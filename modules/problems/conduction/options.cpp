#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <conduction/options.hpp>

namespace tetsuame::conduction {

namespace {

const domain::demands demands{.least_particles = 4,
                              .walls_below_and_above = "a body that cools from its top has a bottom and a top"};

}  // namespace

void declare(namelist::schema& schema, options& o) {
  o.walls.sides[2] = {.thermal = "fixed", .temperature = 1.0};
  o.walls.sides[3] = {.thermal = "fixed", .temperature = 0.0};
  o.common.time.method = "euler";
  o.common.time.t_end = 1e4;
  o.common.output.history_interval = 50;

  domain::declare(schema, demands, o.domain);
  schema.group("conduction", "a body that cools from its top");
  schema.add("conduction", "diffusivity", o.kappa, namelist::positive("m^2/s", "kappa, thermal"));
  schema.add("conduction", "temperature", o.start, {.unit = "K", .meaning = "at the start"});
  schema.add("conduction", "reference", o.reference,
             {.choices = {"plate", "half_space"}, .meaning = "exact solution the errors are against"});
  if (o.by_program) {
    o.scheme = "sum";
    schema.pass_over("conduction", {"operator"});
    o.common.kernel.name = "quintic";
    walls::declare(schema, {.treatments = {"virtual_marker", "none", "mirror"}, .slips = false, .moving = false},
                   o.walls);
  } else {
    schema.add("conduction", "operator", o.scheme,
               {.choices = {"sum", "consistent", "corrected"},
                .meaning = "Laplacian: the slides' sum; with right second moments; that with the deferred correction"});
    walls::declare(schema, {.slips = false, .moving = false}, o.walls);
  }
  schema.add("conduction", "heat_capacity", o.heat_capacity,
             namelist::positive("J/(kg K)", "by which heating of &sources warms"));
  regions::declare(schema, of_regions, o.of_regions);
  sources::declare(schema, {.force = false}, o.of_sources);
  run::declare(
      schema, o.common,
      {.single_pairs = true, .lists_change = false, .starts_from_file = true, .reads = "places and temperatures"});
}

void resolve(const namelist::schema& schema, options& o) {
  if (!schema.passed().empty())
    o.lines.push_back(fmt::format("note: passed over, as this program has a scheme of its own: {}",
                                  fmt::join(schema.passed(), ", ")));
  run::resolve(schema, o.common);
  domain::resolve(schema, demands, o.domain);
  run::check_output(schema, o.common, o.domain, {});
  o.regions = regions::all(schema, of_regions, o.of_regions, static_cast<int>(o.domain.dimension), o.domain.length,
                           o.domain.dx());
  o.sources = sources::all(schema, o.of_sources, o.of_regions, static_cast<int>(o.domain.dimension), o.domain.length,
                           o.domain.dx());
  if (o.regions.any() && !o.common.start.file.empty())
    schema.fail("initial", "file", "a snapshot says what is where, and so does &region");
  const double dx = o.domain.dx(), support = run::support_over_dx(o.common.kernel) * dx;
  domain::check_widths(schema, o.domain, std::max(support, o.halo()) + o.common.kernel.skin * dx, support);
  const auto& sides = o.walls.sides;
  if (sides[3].thermal != "fixed")
    schema.fail("walls", "thermal_top", "the exact solutions are of a top at a fixed temperature");
  if (sides[3].temperature == o.start)
    schema.fail("conduction", "temperature", "the body must start at another temperature than its top's");
  if (o.reference == "plate" && (sides[2].thermal != "fixed" || sides[2].temperature != o.start))
    schema.fail("walls", "temperature_bottom", "the plate's bottom is kept at the temperature it starts with");
  if (o.reference == "half_space" && o.common.time.end() > 0.0) {
    // The exact solution must not have met the bottom.
    const double reached = std::erfc(o.domain.length[1] / (2.0 * std::sqrt(o.kappa * o.common.time.end())));
    if (reached > 1e-4)
      schema.fail(
          "time", "t_end",
          fmt::format("the cooling reaches the bottom: there the half space has lost {:.2g} of its difference in "
                      "temperature; stop earlier or take a deeper box",
                      reached));
  }
}

}  // namespace tetsuame::conduction
