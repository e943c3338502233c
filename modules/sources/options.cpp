#include <fmt/format.h>

#include <sources/options.hpp>

namespace tetsuame::sources {

namespace {

const std::vector<std::string> variables{"x",        "y",        "z",        "t",       "material",
                                         "length_x", "length_y", "length_z", "spacing", "T"};
constexpr std::array<const char*, all::number> keys{"force_x", "force_y", "force_z", "heating"};

std::array<std::string, all::number> texts_of(const options& o) {
  return {o.force[0], o.force[1], o.force[2], o.heating};
}

}  // namespace

void declare(namelist::schema& schema, const abilities& of_problem, options& o) {
  o.temperature = of_problem.temperature;
  schema.group(
      "sources",
      fmt::format(
          "forces and heat from outside: numbers, or expressions of x, y, z (m), t (s), material (0, 1, ..., as "
          "in snapshots), {}length_x, length_y, length_z, spacing (m), pi and &constants",
          o.temperature ? "T (K), " : ""));
  for (std::size_t a = 0; a < 3 && of_problem.force; ++a)
    schema.add("sources", keys[a], o.force[a],
               {.unit = "m/s^2",
                .formula = true,
                .meaning = "acceleration K beside gravity, of all that has mass; empty: none"});
  if (of_problem.heating)
    schema.add("sources", keys[all::heat], o.heating,
               {.unit = "W/kg", .formula = true, .meaning = "heat J supplied; empty: none"});
}

all::all(const std::array<std::string, number>& texts, const std::map<std::string, double>& constants,
         const std::array<double, 3>& box, double spacing)
    : text_(texts), constants_(constants), box_(box), spacing_(spacing) {
  for (std::size_t k = 0; k < number; ++k) {
    if (texts[k].empty()) continue;
    value_[k].emplace(texts[k], variables, constants);
    uniform_[k] = !value_[k]->uses({"x", "y", "z", "material", "T"});
  }
}

all::all(const namelist::schema& schema, const options& o, const regions::constants& named, int dimension,
         const std::array<double, 3>& box, double spacing) {
  const auto texts = texts_of(o);
  if (std::ranges::all_of(texts, &std::string::empty)) return;
  const auto constants = regions::named(schema, named, variables);
  for (std::size_t k = 0; k < number; ++k) {
    if (texts[k].empty()) continue;
    if (k < heat && static_cast<int>(k) >= dimension)
      schema.fail("sources", keys[k], fmt::format("there is no {}", "xyz"[k]));
    const auto value =
        schema.placed("sources", keys[k], [&] { return regions::expression(texts[k], variables, constants); });
    if (!o.temperature && value.uses({"T"}))
      schema.fail("sources", keys[k], "this problem has no equation of the temperature");
  }
  *this = all(texts, constants, box, spacing);
}

bool all::by_temperature() const {
  return std::ranges::any_of(value_, [](const auto& value) { return value && value->uses({"T"}); });
}

void all::refuse_temperature(const namelist::schema& schema, const std::string& why) const {
  for (std::size_t k = 0; k < number; ++k)
    if (value_[k] && value_[k]->uses({"T"}))
      schema.fail("sources", keys[k], "T is found after forces and heat: " + why);
}

double all::at(std::size_t component, const std::array<double, 3>& x, double material, double temperature,
               double t) const {
  if (!value_[component]) return 0.0;
  const std::array<double, 10> values{x[0], x[1], x[2], t, material, box_[0], box_[1], box_[2], spacing_, temperature};
  return value_[component]->at(values);
}

std::string all::describe(std::size_t component) const {
  return fmt::format("&sources {} = '{}'", keys[component], text_[component]);
}

}  // namespace tetsuame::sources
