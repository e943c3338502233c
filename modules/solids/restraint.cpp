#include <fmt/format.h>

#include <numbers>
#include <solids/restraint.hpp>

namespace tetsuame::solids {

namespace {

constexpr std::array<const char*, 4> components{"x", "y", "z", "angle"};

struct numbers_of {
  const char* name;
  const std::array<std::vector<double>, 3>& along;
  const std::vector<double>& turning;

  std::string key(std::size_t component) const { return fmt::format("{}_{}", name, components[component]); }
  double at(std::size_t component, std::size_t n) const {
    const auto& values = component < 3 ? along[component] : turning;
    return n < values.size() ? values[n] : 0.0;
  }
};
std::array<numbers_of, 3> all_of(const restraint_options& o) {
  return {{{"stiffness", o.stiffness, o.stiffness_angle},
           {"damping", o.damping, o.damping_angle},
           {"rest", o.rest, o.rest_angle}}};
}
std::string freedom_of(const restraint_options& o, std::size_t n) {
  return n < o.freedom.size() && !o.freedom[n].empty() ? o.freedom[n] : "all";
}

}  // namespace

void declare(namelist::schema& schema, std::size_t most, const list_of_numbers& list, restraint_options& o) {
  schema.add("motions", "freedom", o.freedom,
             {.choices = {"all", "x", "y", "z", "xy", "xz", "yz", "xyz", "turn"},
              .maximum_size = most,
              .sparse = true,
              .meaning = "how a free body moves: in any way, along these axes without turning, or about its centre of "
                         "mass, or its pivot, alone"});
  const auto add = [&](const char* name, auto& along, auto& turning, const char* unit, const char* of_angle,
                       const char* meaning, double minimum) {
    for (std::size_t k = 0; k < 3; ++k)
      schema.add("motions", fmt::format("{}_{}", name, components[k]), along[k], list(unit, meaning, minimum));
    schema.add("motions", fmt::format("{}_angle", name), turning, list(of_angle, meaning, minimum));
  };
  add("stiffness", o.stiffness, o.stiffness_angle, "N/m", "N m",
      "of a linear spring on a free body, for each metre of depth in 2-D; angle: a radian, 2-D", 0.0);
  add("damping", o.damping, o.damping_angle, "N s/m", "N m s", "of a linear damper on a free body, as stiffness", 0.0);
  add("rest", o.rest, o.rest_angle, "m", "degrees",
      "displacement of a free body from its start at which the spring is relaxed", -1e300);
}

template <int D>
restraint<D> restraint_of(const restraint_options& o, std::size_t n, const fail_at_key& fail) {
  constexpr std::size_t N = restraint<D>::components;
  restraint<D> r;
  const auto freedom = freedom_of(o, n);
  if (D == 2 && freedom.find('z') != std::string::npos) fail("freedom", "there is no z in two dimensions");
  if (freedom != "all")
    for (std::size_t k = 0; k < N; ++k)
      r.held[k] = k < D ? freedom == "turn" || freedom.find(*components[k]) == std::string::npos : freedom != "turn";
  const auto [stiffness, damping, rest] = all_of(o);
  constexpr double degree = std::numbers::pi / 180.0;
  for (std::size_t c = 0; c < components.size(); ++c) {
    const bool there = c < D || (D == 2 && c == 3);
    const std::size_t k = c < D ? c : D;
    for (const auto* numbers : {&stiffness, &damping, &rest}) {
      if (numbers->at(c, n) == 0.0) continue;
      if (!there) fail(numbers->key(c), fmt::format("there is none in {} dimensions", D == 2 ? "two" : "three"));
      if (r.held[k]) fail(numbers->key(c), fmt::format("a body of freedom '{}' does not move so", freedom));
    }
    if (!there) continue;
    if (rest.at(c, n) != 0.0 && stiffness.at(c, n) == 0.0)
      fail(rest.key(c), fmt::format("belongs to a spring: {}", stiffness.key(c)));
    r.stiffness[k] = stiffness.at(c, n);
    r.damping[k] = damping.at(c, n);
    r.rest[k] = rest.at(c, n) * (c == 3 ? degree : 1.0);
  }
  return r;
}
template restraint<2> restraint_of<2>(const restraint_options&, std::size_t, const fail_at_key&);
template restraint<3> restraint_of<3>(const restraint_options&, std::size_t, const fail_at_key&);

void expect_unrestrained(const restraint_options& o, std::size_t n, const fail_at_key& fail) {
  if (freedom_of(o, n) != "all") fail("freedom", "is of a free body");
  for (const auto& numbers : all_of(o))
    for (std::size_t c = 0; c < components.size(); ++c)
      if (numbers.at(c, n) != 0.0) fail(numbers.key(c), "is of a free body");
}

}  // namespace tetsuame::solids
