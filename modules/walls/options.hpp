// The walls of a box as the input gives them: what stands behind them, and for each side slip, heat and the wall's own
// velocity.
#pragma once

#include <array>
#include <cstddef>
#include <domain/decomposition.hpp>
#include <namelist/schema.hpp>
#include <string>
#include <vector>

namespace tetsuame::walls {

struct side_options {
  std::string slip = "inherit";  // 'inherit': as &walls slip; 'free_surface', of the top: there is no wall
  std::string thermal = "inherit";
  double temperature = 300.0;  // K, where thermal is 'fixed'
  double flux = 0.0;           // W/m2 into the fluid, where thermal is 'flux'
  double velocity = 0.0;       // m/s, along the wall (x for bottom and top, y for left and right)
};

struct options {
  std::string treatment = "mirror";
  std::string interpolation = "mls";
  std::string slip = "no_slip";
  std::string thermal = "adiabatic";
  double marker_radius = 0.0;    // in kernel supports; 0: 1, and 1.35 for mls2
  double repulsion_range = 1.0;  // in particle spacings
  std::string slip_of_bodies = "inherit";
  std::array<side_options, 6> sides;  // left, right, bottom, top, back, front
};

inline constexpr std::array<const char*, 6> side_names{"left", "right", "bottom", "top", "back", "front"};

// What the walls of a problem may be, and so what is declared.
struct abilities {
  std::vector<std::string> treatments = {"mirror"};  // one: there is no choice
  bool slips = true;                                 // the fluid moves
  bool moving = true;                                // and so may the sides, along themselves
  bool heat = true;                                  // they keep a temperature
  bool flux = false;                                 // heat may be given to the fluid
  bool free_surface = false;                         // there may be nothing at the top
  bool bodies = false;                               // stand in the box
};
// Declares group &walls, with a default treatment in `o`.
void declare(namelist::schema& schema, const abilities& of_problem, options& o);
// Of a side by its number in side_names.
inline const std::string& slip_of(const options& o, std::size_t n) {
  return o.sides[n].slip == "inherit" ? o.slip : o.sides[n].slip;
}
inline const std::string& thermal_of(const options& o, std::size_t n) {
  return o.sides[n].thermal == "inherit" ? o.thermal : o.sides[n].thermal;
}
inline const std::string& slip_of_bodies(const options& o) {
  return o.slip_of_bodies == "inherit" ? o.slip : o.slip_of_bodies;
}

// Radius of a marker's interpolation in kernel supports.
inline double radius_factor(const options& how) {
  if (how.marker_radius > 0.0) return how.marker_radius;
  return how.interpolation == "mls2" ? 1.35 : 1.0;
}

enum class heat { fixed_temperature, given_flux };  // adiabatic is a flux of zero

// One plane wall: the fluid is where (x - position) * inward > 0 along the axis.
template <int D>
struct side {
  std::size_t axis = 0;
  double position = 0.0;  // m
  double inward = 1.0;    // +1 at the low end, -1 at the high end
  bool no_slip = true;
  heat thermal = heat::given_flux;
  double temperature = 0.0;          // K
  double flux = 0.0;                 // W/m2
  std::array<double, D> velocity{};  // m/s

  double distance(double x) const { return (x - position) * inward; }  // m, from the wall into the fluid
};

// The walls of the box: one side at each end of every axis that is not periodic, where the box is not open.
template <int D>
std::vector<side<D>> make_sides(const options& o, const domain::box<D>& box) {
  std::vector<side<D>> all;
  for (std::size_t axis = 0; axis < D; ++axis) {
    if (box.periodic[axis]) continue;
    for (const std::size_t end : {0, 1}) {
      const auto& given = o.sides[2 * axis + end];
      if (given.slip == "free_surface" || box.open[axis][end]) continue;
      const std::string& thermal = thermal_of(o, 2 * axis + end);
      side<D> s;
      s.axis = axis;
      s.position = end == 0 ? 0.0 : box.length[axis];
      s.inward = end == 0 ? 1.0 : -1.0;
      s.no_slip = slip_of(o, 2 * axis + end) == "no_slip";
      s.thermal = thermal == "fixed" ? heat::fixed_temperature : heat::given_flux;
      s.temperature = given.temperature;
      s.flux = thermal == "flux" ? given.flux : 0.0;
      s.velocity[axis == 0 && D > 1 ? 1 : 0] = given.velocity;
      all.push_back(s);
    }
  }
  return all;
}

}  // namespace tetsuame::walls
