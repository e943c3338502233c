#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <free_surface/gauges.hpp>
#include <free_surface/input.hpp>
#include <tables/table.hpp>

namespace tetsuame::free_surface {

using namelist::positive;

namespace {

// What is 1 in the file of measured curves.
void declare_units(namelist::schema& schema, gauge_options& o) {
  schema.add("gauges", "time_unit", o.time_unit, namelist::for_expert(positive("s", "what is 1 in the file's times")));
  schema.add("gauges", "length_unit", o.length_unit,
             namelist::for_expert(positive("m", "what is 1 in the file's lengths")));
  schema.add("gauges", "stress_unit", o.stress_unit,
             namelist::for_expert(positive("Pa", "what is 1 in the file's pressures")));
  schema.add("gauges", "force_unit", o.force_unit, namelist::for_expert(positive("N", "what is 1 in its forces")));
  schema.add("gauges", "moment_unit", o.moment_unit, namelist::for_expert(positive("N m", "what is 1 in its moments")));
}

}  // namespace

void declare_gauges(namelist::schema& schema, gauge_options& o) {
  schema.group("gauges", "what gauges.csv holds, and measurements to compare it with");
  schema.add("gauges", "interval", o.interval,
             {.unit = "s", .minimum = 0.0, .meaning = "time between readings; 0: every step"});
  schema.add("gauges", "front", o.front, {.meaning = "how far along x the water has come"});
  for (const std::size_t a : {0, 2})
    schema.add("gauges", along("height_", a), o.height[a],
               {.unit = "m",
                .minimum = 0.0,
                .meaning = std::string("where the depth of the water is read") + (a == 2 ? " (3-D only)" : "")});
  for (std::size_t a = 0; a < 3; ++a)
    schema.add("gauges", along("pressure_", a), o.pressure[a],
               {.unit = "m",
                .minimum = 0.0,
                .meaning = std::string("points, of walls or of the water, whose pressure is read") +
                           (a == 2 ? " (3-D only)" : "")});
  schema.add("gauges", "discharge_x", o.discharge,
             {.unit = "m",
              .minimum = 0.0,
              .expert = true,
              .meaning = "sections across x through which the flow of volume along x is read"});
  schema.add("gauges", "force", o.force, {.meaning = "bodies of &solids: force and moment of the water on each"});
  for (std::size_t a = 0; a < 3; ++a)
    schema.add("gauges", along("moment_", a), o.moment[a],
               {.unit = "m",
                .expert = true,
                .meaning = std::string("points about which the moments are taken, one a force; not given: the bodies' "
                                       "centres") +
                           (a == 2 ? " (3-D only)" : "")});
  schema.add("gauges", "motion", o.motion, {.meaning = "bodies of &solids: displacement and angle of each"});
  schema.add("gauges", "file", o.file,
             {.file = namelist::file_of::run,
              .meaning = "measured curves, a table with named columns, the times in the first"});
  schema.add("gauges", "front_column", o.front_column, {.meaning = "of the file, for the front"});
  schema.add("gauges", "height_columns", o.height_columns, {.meaning = "for the depths, '' for none"});
  schema.add("gauges", "pressure_columns", o.pressure_columns, {.meaning = "for the pressures, '' for none"});
  schema.add("gauges", "discharge_columns", o.discharge_columns,
             {.expert = true,
              .meaning = "for the discharges, in length_unit to the power of the box's dimension each "
                         "time_unit, '' for none"});
  schema.add("gauges", "force_columns", o.force_columns,
             {.expert = true, .meaning = "for forces and moments, one a column of gauges.csv, '' for none"});
  declare_units(schema, o);
  schema.add("gauges", "arrival", o.arrival,
             {.unit = "Pa", .minimum = 0.0, .meaning = "the water has arrived where the pressure is above this"});
  schema.add("gauges", "impulse_from", o.impulse_from,
             {.unit = "s",
              .minimum = 0.0,
              .stays_open = true,
              .expert = true,
              .meaning = "impulses begin; not given: at the arrival"});
  schema.add("gauges", "impulse_until", o.impulse_until,
             {.unit = "s",
              .minimum = 0.0,
              .stays_open = true,
              .expert = true,
              .meaning = "impulses end; not given: with the run"});
}

namespace {

// What is 1 in a column, in a unit of SI.
struct scale {
  const char* unit;
  double factor;
};

series column_of(const namelist::schema& schema, const std::string& key, const tables::table& t,
                 const std::string& name, double time_unit, const scale& of) {
  if (name.empty()) return {};
  const auto place = t.column(name);
  if (!place || *place == 0)
    schema.fail("gauges", key,
                t.headings().empty()
                    ? fmt::format("{} has no line with the names of its columns", t.name())
                    : fmt::format("the file has no column '{}': it has {}", name, fmt::join(t.headings(), ", ")));
  return schema.placed("gauges", "file", [&] {
    t.expect_unit(0, "s", time_unit);
    t.expect_unit(*place, of.unit, of.factor);
    series s{t.ascending(0, "time"), t.numbers(*place)};
    for (double& time : s.time) time *= time_unit;
    for (double& value : s.value) value *= of.factor;
    return s;
  });
}

std::vector<series> curves_of(const namelist::schema& schema, const options& o, const std::string& key,
                              const tables::table& t, const std::vector<std::string>& names,
                              const std::vector<scale>& of) {
  const std::size_t number = of.size();
  std::vector<series> all(number);
  if (names.empty()) return all;
  if (names.size() != number)
    schema.fail("gauges", key, fmt::format("expected {} names, one a gauge, found {}", number, names.size()));
  for (std::size_t n = 0; n < number; ++n) all[n] = column_of(schema, key, t, names[n], o.gauges.time_unit, of[n]);
  return all;
}

}  // namespace

void resolve_gauges(const namelist::schema& schema, options& o, parameters& p) {
  auto& g = o.gauges;
  if (g.impulse_from && g.impulse_until && *g.impulse_until <= *g.impulse_from)
    schema.fail(
        "gauges", "impulse_until",
        fmt::format("expected a time behind impulse_from, {} s, found {} s", *g.impulse_from, *g.impulse_until));
  gauges::check_places(schema, o.domain, "height_", g.height, {0, 2}, {});
  gauges::check_places(schema, o.domain, "pressure_", g.pressure, {0, 1, 2}, {});
  gauges::check_places(schema, o.domain, "discharge_", {g.discharge, {}, {}}, {0}, {});
  p.measured.discharge.resize(g.discharge.size());
  p.measured.height.resize(g.height[0].size());
  p.measured.pressure.resize(g.pressure[0].size());
  const auto forces = force_names(g.force.size(), static_cast<int>(o.domain.dimension));
  p.measured.force.resize(forces.size());
  const bool named = !g.front_column.empty() || !g.height_columns.empty() || !g.pressure_columns.empty() ||
                     !g.discharge_columns.empty() || !g.force_columns.empty();
  if (named && g.file.empty()) schema.fail("gauges", "file", "columns are named, and no file");
  if (!named && !g.file.empty()) schema.fail("gauges", "file", "none of its columns is named");
  if (!named) return;
  if (!g.front_column.empty() && !g.front)
    schema.fail("gauges", "front_column", "front = .true. reads what this is compared with");
  const auto t = schema.placed("gauges", "file", [&] {
    auto read = tables::table::read(g.file);
    if (read.rows() < 2) read.fail("expected two lines of numbers at least");
    return read;
  });
  const auto number = [](const std::vector<double>& places, const scale& of) {
    return std::vector<scale>(places.size(), of);
  };
  const scale length{"m", g.length_unit};
  std::vector<scale> of_forces;
  for (const auto& name : forces)
    of_forces.push_back(name.starts_with("force") ? scale{"N", g.force_unit} : scale{"N m", g.moment_unit});
  p.measured.front = column_of(schema, "front_column", t, g.front_column, g.time_unit, length);
  p.measured.height = curves_of(schema, o, "height_columns", t, g.height_columns, number(g.height[0], length));
  p.measured.pressure =
      curves_of(schema, o, "pressure_columns", t, g.pressure_columns, number(g.pressure[0], {"Pa", g.stress_unit}));
  const bool flat = o.domain.dimension == 2;
  p.measured.discharge = curves_of(
      schema, o, "discharge_columns", t, g.discharge_columns,
      number(g.discharge, {flat ? "m^2/s" : "m^3/s", std::pow(g.length_unit, flat ? 2.0 : 3.0) / g.time_unit}));
  p.measured.force = curves_of(schema, o, "force_columns", t, g.force_columns, of_forces);
}

}  // namespace tetsuame::free_surface
