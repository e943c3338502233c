// The mode of the start of a cylinder, by linear theory: its keys, and the growth rates that --profile tells.
#include <fmt/format.h>

#include <algorithm>
#include <planet/options.hpp>

namespace tetsuame::planet {

using namelist::between, namelist::positive;

void declare_mode(namelist::schema& schema, options& o) {
  schema.add("planet", "degree", o.degree,
             between(0, 32,
                     "of the growing mode at the start of a cylinder with a dense layer over a lighter one: its "
                     "displacement and velocity, as cos(degree theta); 0: none"));
  schema.add(
      "planet", "amplitude", o.amplitude,
      positive("m",
               "of that mode at the contact that is displaced most; not given: 0.01 of its radius over the degree"));
}

void resolve_mode(const namelist::schema& schema, options& o) {
  if (o.degree == 0) {
    if (o.amplitude) schema.fail("planet", "amplitude", "is of a mode: give its degree");
    return;
  }
  const auto fail = [&](const std::string& why) { schema.fail("planet", "degree", why); };
  if (o.dimension != 2) fail("is of a cylinder: dimension = 2");
  if (std::ranges::min(o.viscosities) <= 0.0)
    fail("needs a viscosity of each layer, &planet viscosity or that of &layer");
  if (o.gas.common.start.is_read()) fail("is that of a planet by its profile: the snapshot has a motion of its own");
  if (o.gas.common.start.settles()) fail("is that of the start, which is not to settle then: &expert settle = 0");
  const auto layers = layers_of(*o.structure, o.viscosities);
  auto mode = schema.placed("planet", "viscosity",
                            [&] { return theory::growing_mode(layers, static_cast<std::size_t>(o.degree)); });
  if (mode.growth_rate == 0.0) fail("no layer lies over a less dense one far enough for this degree to grow");
  const double R = layers.layers[mode.fastest].outer_radius,
               amplitude = o.amplitude.value_or(0.01 * R / static_cast<double>(o.degree));
  if (amplitude > 0.1 * R)
    schema.fail("planet", "amplitude",
                fmt::format("is {:.6g} m: linear theory holds far below the radius of the contact, expected at most a "
                            "tenth of {:.6g} m",
                            amplitude, R));
  o.mode.emplace(layers, std::move(mode), amplitude);
}

nlohmann::ordered_json growth_rates(const options& o) {
  nlohmann::ordered_json rates;
  if (o.structure->form().is_sphere() || std::ranges::min(o.viscosities) <= 0.0) return rates;
  const auto layers = layers_of(*o.structure, o.viscosities);
  for (std::size_t degree = 1; degree <= 8; ++degree) {
    try {
      rates.push_back(theory::growing_mode(layers, degree).growth_rate);
    } catch (const foundation::error&) {
      rates.push_back(nullptr);
    }
  }
  return rates;
}

}  // namespace tetsuame::planet
