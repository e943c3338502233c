#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <namelist/text.hpp>
#include <regions/region.hpp>

namespace tetsuame::regions {

namespace {

const std::vector<std::string> variable_names{"x", "y", "z", "length_x", "length_y", "length_z", "spacing", "T"};

struct named_value {
  const char *key, *unit;
  bool above_0;
};
constexpr std::array<named_value, number_of_values> value_names{{{"temperature", "K", true},
                                                                 {"density", "kg/m^3", true},
                                                                 {"pressure", "Pa", false},
                                                                 {"energy", "J/kg", false},
                                                                 {"velocity_x", "m/s", false},
                                                                 {"velocity_y", "m/s", false},
                                                                 {"velocity_z", "m/s", false}}};

std::array<const std::vector<std::string>*, number_of_values> lists_of(const options& o) {
  return {&o.temperature, &o.density, &o.pressure, &o.energy, &o.velocity[0], &o.velocity[1], &o.velocity[2]};
}

std::string of(const std::vector<std::string>& texts, std::size_t n) {
  return n < texts.size() ? texts[n] : std::string();
}

// "file:line" of a key that the input gives.
std::string place_of(const namelist::schema& schema, const abilities& of_problem) {
  std::vector<const char*> keys{"name", "shape", "condition"};
  if (of_problem.has_materials()) keys.push_back("material");
  if (of_problem.temperature) keys.push_back("temperature");
  if (of_problem.velocity) keys.insert(keys.end(), {"velocity_x", "velocity_y", "velocity_z"});
  if (of_problem.density) keys.push_back("density");
  if (of_problem.pressure) keys.push_back("pressure");
  for (const char* key : keys)
    if (schema.given("region", key)) return schema.where("region", key);
  return schema.where("region", "shape");
}

// Of the material that piece n names.
std::int32_t number_of(const namelist::schema& schema, const abilities& of_problem, const std::string& name,
                       std::size_t n) {
  const auto& known = of_problem.materials;
  const auto found = std::ranges::find(known, namelist::lower(name), [](const auto& k) { return namelist::lower(k); });
  if (found == known.end())
    schema.fail_at("region", "material", n,
                   fmt::format("there is no material {}; expected one of '{}', or a further {}; the nearest is {}",
                               namelist::quote(namelist::excerpt(name)), fmt::join(known, "', '"), of_problem.named_by,
                               namelist::quote(namelist::nearest(name, known))));
  return static_cast<std::int32_t>(found - known.begin());
}

// Pieces without a name are regions by themselves; the others' lists are made as long.
void complete(options& o) {
  const std::size_t n = o.pieces_given();
  auto& p = o.pieces;
  p.body.resize(n);
  p.shape.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    if (p.body[k].empty()) p.body[k] = fmt::format("region {}", k + 1);
    if (p.shape[k].empty()) p.shape[k] = "everywhere";
  }
}

}  // namespace

all::all(const namelist::schema& schema, const abilities& of_problem, options o, int dimension,
         const std::array<double, 3>& box, double spacing)
    : box_(box), spacing_(spacing), above_0_(of_problem.above_0) {
  const auto constants = named(schema, o, variable_names);
  if (!o.any()) return;
  complete(o);
  where_ = place_of(schema, of_problem);
  if (dimension == 1 && std::ranges::any_of(o.pieces.shape, [](const auto& s) { return s != "everywhere"; }))
    schema.fail("region", "shape", "shapes have two or three dimensions: expected a condition");
  const solids::words words{"region", "name", "side"};
  std::vector<solids::body<2>> flat;
  std::vector<solids::body<3>> deep;
  if (dimension == 3)
    deep = solids::make_bodies<3>(schema, o.pieces, words);
  else
    flat = solids::make_bodies<2>(schema, o.pieces, words);
  for (std::size_t n = 0; n < std::max(flat.size(), deep.size()); ++n) {
    auto& r = regions_.emplace_back();
    if (dimension == 3)
      r.deep = std::move(deep[n]);
    else
      r.flat = std::move(flat[n]);
    r.name = dimension == 3 ? r.deep->name() : r.flat->name();
  }
  const auto lists = lists_of(o);
  for (std::size_t n = 0; n < o.pieces.body.size(); ++n) {
    auto& r = *std::ranges::find(regions_, o.pieces.body[n], &region::name);
    const auto read = [&](const char* key, const std::string& text) {
      return schema.placed("region", key, [&] {
        try {
          return expression(text, variable_names, constants);
        } catch (const foundation::error& e) {
          foundation::fail_input(fmt::format("of '{}': {}", r.name, e.what()));
        }
      });
    };
    if (const auto text = of(o.condition, n); !text.empty()) r.conditions.push_back(read("condition", text));
    if (const auto name = of(o.material, n); !name.empty()) r.material = number_of(schema, of_problem, name, n);
    for (std::size_t k = 0; k < lists.size(); ++k) {
      const auto text = of(*lists[k], n);
      if (text.empty()) continue;
      if (static_cast<what>(k) == what::velocity_z && dimension < 3)
        schema.fail("region", "velocity_z", fmt::format("of '{}': there is no z", r.name));
      r.value[k] = read(value_names[k].key, text);
    }
  }
  for (const auto& r : regions_)
    if (!r.material && std::ranges::none_of(r.value, [](const auto& v) { return v.has_value(); }))
      schema.fail("region", "shape", fmt::format("'{}' says nothing of what is there", r.name));
}

bool all::give_material(std::int32_t material) const {
  return std::ranges::any_of(regions_, [&](const region& r) { return r.material == material; });
}
bool all::give(what w) const {
  return std::ranges::any_of(regions_,
                             [&](const region& r) { return r.value[static_cast<std::size_t>(w)].has_value(); });
}

std::vector<double> all::variables(const place& x, double T) const {
  return {x[0], x[1], x[2], box_[0], box_[1], box_[2], spacing_, T};
}

bool all::holds(const region& r, const place& x, const std::vector<double>& of) const {
  if (r.flat && !r.flat->solid({{x[0], x[1]}})) return false;
  if (r.deep && !r.deep->solid({{x[0], x[1], x[2]}})) return false;
  return std::ranges::all_of(r.conditions, [&](const expression& c) {
    const double value = c.at(of);
    if (std::isnan(value))
      fail(r, fmt::format("the condition '{}' is {} at ({:.6g}) m", c.text(), value, fmt::join(x, ", ")));
    return value != 0.0;
  });
}

values all::at(const place& x, double T, std::vector<std::int64_t>& counts) const {
  values v;
  counts.resize(regions_.size(), 0);
  for (std::size_t n = 0; n < regions_.size(); ++n) {
    const auto& r = regions_[n];
    const auto variables_here = variables(x, v.temperature.value_or(T));
    if (!holds(r, x, variables_here)) continue;
    ++counts[n];
    if (r.material) v.material = r.material;
    const std::array<std::optional<double>*, number_of_values> to{
        &v.temperature, &v.density, &v.pressure, &v.energy, &v.velocity[0], &v.velocity[1], &v.velocity[2]};
    for (std::size_t k = 0; k < to.size(); ++k) {
      if (!r.value[k]) continue;
      const double value = r.value[k]->at(variables_here);
      const bool above_0 = value_names[k].above_0 && (above_0_ || static_cast<what>(k) != what::temperature);
      if (!std::isfinite(value) || (above_0 && !(value > 0.0)))
        fail(r, fmt::format("its {} is {:.6g} {} at ({:.6g}) m{}", value_names[k].key, value, value_names[k].unit,
                            fmt::join(x, ", "), above_0 ? ", and not above 0" : ""));
      *to[k] = value;
    }
  }
  return v;
}

void all::expect_used(const std::vector<std::int64_t>& counts) const {
  for (std::size_t n = 0; n < regions_.size(); ++n)
    if (counts[n] == 0) fail(regions_[n], "no particle of the start lies in it; lengths are in m");
}

void all::fail(const region& r, const std::string& message) const {
  foundation::fail_input(fmt::format("{}: &region '{}': {}", where_, r.name, message));
}

}  // namespace tetsuame::regions
