// The group &impact: its keys, and the bodies that they name.
#include <fmt/format.h>

#include <algorithm>
#include <namelist/lists.hpp>
#include <planet/options.hpp>

namespace tetsuame::planet {

using namelist::element_of, namelist::for_expert, namelist::positive;

void declare_impact(namelist::schema& schema, impact_options& i) {
  schema.group("impact",
               "two bodies that meet, in place of a planet: snapshots of this program, with the materials of &layer");
  const auto file = [](const char* what) {
    return namelist::key_info{.may_change = true, .file = namelist::file_of::start, .meaning = what};
  };
  schema.add("impact", "target", i.target, file("snapshot of the body that is met"));
  schema.add("impact", "impactor", i.impactor, file("snapshot of the other one"));
  schema.add("impact", "speed", i.speed, namelist::up_to(100.0, "at contact, of the mutual escape velocity"));
  schema.add("impact", "impact_parameter", i.impact_parameter,
             namelist::between(0.0, 1.0, "sine of the angle between the velocity and the line of centres, at contact"));
  schema.add("impact", "time_before_contact", i.time_before_contact,
             {.unit = "s", .minimum = 0.0, .meaning = "at which the run begins, on the orbit of two point masses"});
  schema.add("impact", "target_radius", i.target_radius,
             for_expert(positive(
                 "m", "not given: the mean distance of the outermost hundredth of its particles, and half a spacing")));
  schema.add("impact", "impactor_radius", i.impactor_radius, for_expert(positive("m", "likewise")));
}

// Reads both snapshots and finds where the bodies begin.
void resolve_impact(const namelist::schema& schema, options& o) {
  auto& i = o.impact;
  for (const auto& [key, path] : {std::pair("target", &i.target), std::pair("impactor", &i.impactor)})
    if (path->empty()) schema.fail("impact", key, "must be given: an impact is of two bodies");
  for (const char* key : {"mass", "radius", "surface_pressure", "surface_temperature", "temperature_law",
                          "temperature_exponent", "spin_period", "expansion", "degree", "amplitude", "particles"})
    if (schema.changed("planet", key)) schema.fail("planet", key, "follows from the bodies of &impact: leave it out");
  for (std::size_t n = 0; n < o.materials.size(); ++n)
    if (element_of(o.layer.fraction, n))
      schema.fail_at(layer_group, "fraction", n, "follows from the bodies of &impact: leave it out");
  auto& start = o.gas.common.start;
  if (!start.file.empty()) schema.fail("initial", "file", "the start is that of &impact: give one of them");
  if (!schema.given("initial", "settle")) start.settle = 0.0;
  if (start.settles()) schema.fail("initial", "settle", "bodies that meet move; let each settle in a run of its own");
  const auto number = static_cast<std::int32_t>(o.materials.size());
  const auto place = [&](const char* key) { return schema.where("impact", key) + ": &impact " + key + ": "; };
  auto target = read_body(i.target, place("target"), number),
       impactor = read_body(i.impactor, place("impactor"), number);
  if (i.target_radius) target.radius = *i.target_radius;
  if (i.impactor_radius) impactor.radius = *i.impactor_radius;
  const auto e = schema.placed("impact", "time_before_contact", [&] { return before_contact(i, target, impactor); });
  for (std::size_t n = 0; n < o.materials.size(); ++n) {
    const auto is_of_it = [&](const gas::placed& p) { return p.now.material == o.material_of(n); };
    if (std::ranges::none_of(target.particles, is_of_it) && std::ranges::none_of(impactor.particles, is_of_it))
      schema.fail_at(layer_group, "eos", n, fmt::format("no particle of the two bodies is of layer '{}'", o.names[n]));
  }
  o.impact_of.emplace(std::move(target), std::move(impactor), e);
}

}  // namespace tetsuame::planet
