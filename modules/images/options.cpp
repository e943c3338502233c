#include <images/options.hpp>

namespace tetsuame::images {

void declare(namelist::schema& schema, int dimension, bool moving, options& o) {
  constexpr std::array<const char*, 6> names{"left", "right", "bottom", "top", "back", "front"};
  std::vector<std::string> heats{"adiabatic", "fixed"};
  if (moving) heats.emplace_back("flux");
  schema.group("walls", "sides of the box that are not periodic");
  if (moving)
    schema.add("walls", "slip", o.slip, {.choices = {"no_slip", "free_slip"}, .meaning = "velocity at the walls"});
  schema.add("walls", "thermal", o.thermal, {.choices = heats, .meaning = "heat at the walls"});
  auto of_side = heats;
  of_side.insert(of_side.begin(), "inherit");
  for (std::size_t n = 0; n < static_cast<std::size_t>(2 * dimension); ++n) {
    const std::string name = names[n], only = n > 3 ? " (3-D only)" : "";
    const bool rare = name != "bottom" && name != "top";
    side_options& s = o.sides[n];
    if (moving)
      schema.add("walls", "slip_" + name, s.slip,
                 {.choices = {"inherit", "no_slip", "free_slip"},
                  .expert = true,
                  .meaning = "velocity at this side; inherit: as slip" + only});
    schema.add("walls", "thermal_" + name, s.thermal,
               {.choices = of_side, .expert = rare, .meaning = "heat at this side; inherit: as thermal" + only});
    schema.add("walls", "temperature_" + name, s.temperature,
               {.unit = "K", .expert = rare, .meaning = "temperature of the side where thermal is fixed" + only});
    if (moving)
      schema.add("walls", "flux_" + name, s.flux,
                 {.unit = "W/m^2",
                  .expert = true,
                  .meaning = "heat into the fluid through the side where thermal is flux" + only});
    if (moving)
      schema.add("walls", "velocity_" + name, s.velocity,
                 {.unit = "m/s", .expert = true, .meaning = "of the side along itself" + only});
  }
}

}  // namespace tetsuame::images
