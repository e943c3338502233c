#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <gauges/options.hpp>
#include <namelist/text.hpp>
#include <output/groups.hpp>

namespace tetsuame::gauges {

namespace {

constexpr std::size_t most_points = 256;

std::string described(const std::vector<std::string>& names, std::size_t n) {
  return names.empty() ? fmt::format("gauge {}", n + 1) : fmt::format("gauge '{}'", names[n]);
}

// Columns are called by them.
void check_names(const namelist::schema& schema, const options& o) {
  if (o.name.empty()) return;
  if (o.name.size() != o.number())
    schema.fail("gauges", "point",
                fmt::format("expected {} names, one a point of point_x, found {}", o.number(), o.name.size()));
  for (auto name = o.name.begin(); name != o.name.end(); ++name) {
    if (name->empty() || !std::ranges::all_of(*name, namelist::is_name_character))
      schema.fail("gauges", "point",
                  fmt::format("expected names of letters, digits and '_', found {}",
                              namelist::quote(namelist::excerpt(*name))));
    if (std::find(o.name.begin(), name, *name) != name)
      schema.fail("gauges", "point", fmt::format("two gauges are called '{}'", *name));
  }
}

// Those of `known` that points can read: numbers of particles that change from place to place.
std::vector<std::string> readable(const std::vector<std::string>& known) {
  std::vector<std::string> all;
  for (const auto& name : known)
    if (name != "ParticleIDs" && name != "Coordinates" && output::find_quantity(name, 3)) all.push_back(name);
  return all;
}

void check_fields(const namelist::schema& schema, options& o, const std::vector<std::string>& known) {
  const auto all = readable(known);
  for (auto name = o.fields.begin(); name != o.fields.end(); ++name) {
    const auto meant = namelist::nearest(*name, all);
    if (namelist::lower(*name) != namelist::lower(meant))
      schema.fail("gauges", "point_fields",
                  fmt::format("{} is no field that gauges of this run can read; the nearest is {}; there are {}",
                              namelist::quote(namelist::excerpt(*name)), namelist::quote(meant), fmt::join(all, ", ")));
    *name = meant;
    if (std::find(o.fields.begin(), name, meant) != name)
      schema.fail("gauges", "point_fields", fmt::format("{} is there twice", namelist::quote(meant)));
  }
}

// SmoothingLength: smoothing_length.
std::string column_name(const std::string& field) {
  const auto is_capital = [](char c) { return c >= 'A' && c <= 'Z'; };
  std::string name;
  for (std::size_t k = 0; k < field.size(); ++k) {
    if (k > 0 && is_capital(field[k]) && !is_capital(field[k - 1])) name += '_';
    name += field[k];
  }
  return namelist::lower(name);
}

}  // namespace

std::string along(const std::string& what, std::size_t axis) {
  constexpr std::array<const char*, 3> axis_names{"x", "y", "z"};
  return what + axis_names[axis];
}

void check_places(const namelist::schema& schema, const domain::options& box, const std::string& what, const places& of,
                  std::initializer_list<std::size_t> axes, const std::vector<std::string>& names) {
  for (const std::size_t a : axes) {
    const std::string key = along(what, a);
    const std::size_t expected = a < box.axes() ? of[0].size() : 0;
    if (of[a].size() != expected)
      schema.fail("gauges", key, fmt::format("expected {} numbers, one a gauge, found {}", expected, of[a].size()));
    for (std::size_t n = 0; n < of[a].size() && !box.open[a]; ++n) {
      const double x = of[a][n];
      if (x >= 0.0 && x <= box.length[a] * (1.0 + 1e-12)) continue;
      schema.fail("gauges", key,
                  fmt::format("{} is outside the box: {} m, where the box {} at {} m", described(names, n), x,
                              x < 0.0 ? "begins" : "ends", x < 0.0 ? 0.0 : box.length[a]));
    }
  }
}

void declare(namelist::schema& schema, options& o) {
  schema.group("gauges", "points of the fluid that are read on the way");
  schema.add("gauges", "point", o.name,
             {.maximum_size = most_points, .meaning = "names of points, one each; none: their numbers"});
  for (std::size_t a = 0; a < 3; ++a)
    schema.add("gauges", along("point_", a), o.place[a],
               {.unit = "m",
                .maximum_size = most_points,
                .meaning = std::string("where the points are") + (a == 2 ? " (3-D only)" : "")});
  schema.add("gauges", "point_fields", o.fields,
             {.meaning = "of snapshots, by name: each has a column of history.csv at each point"});
}

void resolve(const namelist::schema& schema, options& o, const domain::options& box,
             const std::vector<std::string>& known) {
  check_names(schema, o);
  check_places(schema, box, "point_", o.place, {0, 1, 2}, o.name);
  check_fields(schema, o, known);
  if (o.any() && o.fields.empty())
    schema.fail("gauges", "point_fields",
                fmt::format("expected what the points read: {}", fmt::join(readable(known), ", ")));
  if (!o.any() && !o.fields.empty()) schema.fail("gauges", "point_x", "point_fields are named, and no points");
}

void refuse_points(const namelist::schema& schema, const options& o,
                   const std::function<std::string(const std::array<double, 3>& place)>& why) {
  for (std::size_t n = 0; n < o.number(); ++n) {
    const auto x = o.at(n);
    if (const std::string fault = why(x); !fault.empty())
      schema.fail("gauges", "point_x",
                  fmt::format("{} at ({:.6g}, {:.6g}, {:.6g}) m {}", described(o.name, n), x[0], x[1], x[2], fault));
  }
}

std::vector<output::history_column> columns(const options& o, int dimension) {
  std::vector<output::history_column> all;
  for (std::size_t n = 0; n < o.number(); ++n)
    for (const auto& field : o.fields) {
      const auto quantity = *output::find_quantity(field, dimension);
      const std::string name = column_name(field) + "_" + o.name_of(n);
      for (std::size_t a = 0; quantity.vector && a < static_cast<std::size_t>(dimension); ++a)
        all.push_back({along(name + "_", a), quantity.unit});
      if (!quantity.vector) all.push_back({name, quantity.unit});
    }
  return all;
}

}  // namespace tetsuame::gauges
