#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <regions/options.hpp>

namespace tetsuame::regions {

namespace {

const solids::words words{"region", "name", "side"};

namelist::key_info formula(std::string unit, std::string meaning) {
  return {.unit = std::move(unit),
          .maximum_size = solids::most_pieces,
          .sparse = true,
          .formula = true,
          .meaning = std::move(meaning)};
}

}  // namespace

std::size_t options::pieces_given() const {
  std::size_t most = 0;
  const auto look = [&](const auto&... lists) { ((most = std::max(most, lists.size())), ...); };
  const auto& p = pieces;
  look(p.body, p.shape, p.operation, p.solid, p.file, p.radius, p.height, p.thickness, p.scale, condition, material,
       temperature, density, pressure, energy);
  for (std::size_t k = 0; k < 3; ++k) look(p.centre[k], p.length[k], p.angle[k], velocity[k]);
  return most;
}

void declare(namelist::schema& schema, constants& o) {
  schema.group("constants", "names for numbers in expressions");
  schema.add("constants", "name", o.names, {.maximum_size = 256, .meaning = "letters, digits and _"});
  schema.add("constants", "value", o.values, {.maximum_size = 256, .meaning = "of each, in SI units"});
}

std::map<std::string, double> named(const namelist::schema& schema, const constants& o,
                                    const std::vector<std::string>& variables) {
  if (o.names.size() != o.values.size())
    schema.fail("constants", o.names.empty() ? "value" : "name",
                fmt::format("{} names and {} values: expected as many", o.names.size(), o.values.size()));
  std::map<std::string, double> all;
  for (std::size_t n = 0; n < o.names.size(); ++n) {
    if (std::ranges::find(variables, o.names[n]) != variables.end() || o.names[n] == "pi")
      schema.fail("constants", "name", fmt::format("'{}' has a meaning already", o.names[n]));
    if (!all.emplace(o.names[n], o.values[n]).second)
      schema.fail("constants", "name", fmt::format("'{}' is given twice", o.names[n]));
  }
  return all;
}

void declare(namelist::schema& schema, const abilities& of_problem, options& o) {
  declare(schema, static_cast<constants&>(o));
  schema.group(
      "region",
      fmt::format("what the start is somewhere; may stand several times. Values are numbers, or expressions of "
                  "x, y, z{}, length_x, length_y, length_z, spacing (m), T (K, before), pi and &constants; a "
                  "later one overrides",
                  of_problem.origin));
  std::vector<std::string> shapes{"everywhere"};
  shapes.insert(shapes.end(), solids::shapes.begin(), solids::shapes.end());
  solids::declare_pieces(schema, words, shapes, o.pieces);
  schema.add("region", "condition", o.condition, formula("", "where this is true as well, as 'y > 0.5*length_y'"));
  if (of_problem.has_materials()) {
    std::vector<std::string> choices{""};
    choices.insert(choices.end(), of_problem.materials.begin(), of_problem.materials.end());
    schema.add("region", "material", o.material,
               {.choices = of_problem.more_materials ? std::vector<std::string>{} : choices,
                .maximum_size = solids::most_pieces,
                .sparse = true,
                .meaning = (!of_problem.more_materials ? "by name"
                            : of_problem.materials.empty()
                                ? fmt::format("the name of a {}", of_problem.named_by)
                                : fmt::format("'{}' or the name of a {}", fmt::join(of_problem.materials, "', '"),
                                              of_problem.named_by)) +
                           "; empty: as it was"});
  }
  const auto add = [&](bool has, const char* key, std::vector<std::string>& to, const char* unit, const char* meaning) {
    if (has) schema.add("region", key, to, formula(unit, meaning));
  };
  add(of_problem.temperature, "temperature", o.temperature, "K", "not given: as it was");
  for (std::size_t k = 0; k < 3; ++k)
    add(of_problem.velocity, std::array{"velocity_x", "velocity_y", "velocity_z"}[k], o.velocity[k], "m/s",
        "not given: as it was");
  add(of_problem.density, "density", o.density, "kg/m^3", "not given: by pressure and temperature, or as it was");
  add(of_problem.pressure, "pressure", o.pressure, "Pa", "not given: as it was, or by what lies above");
  add(of_problem.energy, "energy", o.energy, "J/kg", "internal; not given: as it was");
}

}  // namespace tetsuame::regions
