#include <walls/options.hpp>

namespace tetsuame::walls {

void declare(namelist::schema& schema, int dimension, options& o) {
  schema.group("walls", "sides of the box that are not periodic");
  schema.add("walls", "treatment", o.treatment,
             {.choices = {"virtual_marker", "none", "frozen", "repulsion"},
              .meaning = "what stands beyond a wall; default: the program's own"});
  schema.add("walls", "interpolation", o.interpolation,
             {.choices = {"mls", "mls2", "shepard"},
              .meaning = "at the virtual markers: moving least squares of first or second order, or Shepard's mean"});
  schema.add("walls", "slip", o.slip, {.choices = {"no_slip", "free_slip"}, .meaning = "velocity at the walls"});
  schema.add("walls", "thermal", o.thermal, {.choices = {"adiabatic", "fixed"}, .meaning = "heat at the walls"});
  schema.add(
      "walls", "marker_radius", o.marker_radius,
      {.minimum = 0.0, .maximum = 3.0, .meaning = "reach of a marker in kernel supports; 0: 1, and 1.35 for mls2"});
  schema.add("walls", "repulsion_range", o.repulsion_range,
             {.minimum = 0.0,
              .maximum = 10.0,
              .exclusive_minimum = true,
              .meaning = "distance from the wall, in particle spacings, at which the repulsion ends"});
  for (std::size_t n = 0; n < static_cast<std::size_t>(2 * dimension); ++n) {
    const std::string name = side_names[n];
    side_options& s = o.sides[n];
    schema.add("walls", "slip_" + name, s.slip,
               {.choices = {"inherit", "no_slip", "free_slip"}, .meaning = "velocity at this side; inherit: as slip"});
    schema.add("walls", "thermal_" + name, s.thermal,
               {.choices = {"inherit", "adiabatic", "fixed"}, .meaning = "heat at this side; inherit: as thermal"});
    schema.add("walls", "temperature_" + name, s.temperature,
               {.unit = "K", .minimum = 0.0, .meaning = "temperature of the side where thermal is fixed"});
    schema.add("walls", "velocity_" + name, s.velocity, {.unit = "m/s", .meaning = "of the side along itself"});
  }
}

}  // namespace tetsuame::walls
