#include <algorithm>
#include <walls/options.hpp>

namespace tetsuame::walls {

using namelist::between, namelist::for_expert, namelist::up_to;

namespace {

void declare_side(namelist::schema& schema, const abilities& of_problem, std::size_t n,
                  const std::vector<std::string>& heats, side_options& s) {
  const std::string name = side_names[n], only = n > 3 ? " (3-D only)" : "";
  auto choices = heats;
  choices.insert(choices.begin(), "inherit");
  const bool rare = name != "bottom" && name != "top";
  std::vector<std::string> slips{"inherit", "no_slip", "free_slip"};
  const bool may_be_none = of_problem.free_surface && name == "top";
  if (may_be_none) slips.emplace_back("free_surface");
  if (of_problem.slips)
    schema.add("walls", "slip_" + name, s.slip,
               {.choices = slips,
                .expert = rare || !of_problem.free_surface,
                .meaning = std::string("velocity at this side; inherit: as slip") +
                           (may_be_none ? "; free_surface: there is no wall" : "") + only});
  if (of_problem.moving)
    schema.add("walls", "velocity_" + name, s.velocity,
               {.unit = "m/s", .expert = true, .meaning = "of the side along itself" + only});
  if (!of_problem.heat) return;
  schema.add("walls", "thermal_" + name, s.thermal,
             {.choices = choices, .expert = rare, .meaning = "heat at this side; inherit: as thermal" + only});
  schema.add("walls", "temperature_" + name, s.temperature,
             {.unit = "K",
              .minimum = 0.0,
              .expert = rare,
              .meaning = "temperature of the side where thermal is fixed" + only});
  if (of_problem.flux)
    schema.add("walls", "flux_" + name, s.flux,
               {.unit = "W/m^2",
                .expert = true,
                .meaning = "heat into the fluid through the side where thermal is flux" + only});
}

void declare_treatment(namelist::schema& schema, const std::vector<std::string>& all, options& o) {
  if (all.size() < 2) return;
  schema.add("walls", "treatment", o.treatment, {.choices = all, .meaning = "what stands beyond a wall"});
  if (std::find(all.begin(), all.end(), "virtual_marker") == all.end()) return;
  schema.add("walls", "interpolation", o.interpolation,
             {.choices = {"mls", "mls2", "shepard"},
              .meaning = "at the virtual markers: moving least squares of first or second order, or Shepard's mean"});
  schema.add("walls", "marker_radius", o.marker_radius,
             for_expert(between(0.0, 3.0, "reach of a marker in kernel supports; 0: 1, and 1.35 for mls2")));
  schema.add("walls", "repulsion_range", o.repulsion_range,
             for_expert(up_to(10.0, "distance from the wall, in particle spacings, at which the repulsion ends")));
}

}  // namespace

void declare(namelist::schema& schema, const abilities& of_problem, options& o) {
  std::vector<std::string> heats{"adiabatic", "fixed"};
  if (of_problem.flux) heats.emplace_back("flux");
  schema.group("walls", "sides of the box that are not periodic");
  declare_treatment(schema, of_problem.treatments, o);
  if (of_problem.slips)
    schema.add("walls", "slip", o.slip, {.choices = {"no_slip", "free_slip"}, .meaning = "velocity at the walls"});
  if (of_problem.bodies)
    schema.add("walls", "slip_bodies", o.slip_of_bodies,
               {.choices = {"inherit", "no_slip", "free_slip"},
                .expert = true,
                .meaning = "velocity at the bodies of &solids; inherit: as slip"});
  if (of_problem.heat) schema.add("walls", "thermal", o.thermal, {.choices = heats, .meaning = "heat at the walls"});
  for (std::size_t n = 0; n < side_names.size(); ++n) declare_side(schema, of_problem, n, heats, o.sides[n]);
}

}  // namespace tetsuame::walls
