// The walls of a box as the input gives them: treatment, interpolation, and for each
// side slip, heat and the wall's own velocity.
#pragma once

#include <array>
#include <cstddef>
#include <domain/decomposition.hpp>
#include <namelist/schema.hpp>
#include <string>
#include <vector>

namespace tetsuame::walls {

struct side_options {
  std::string slip = "inherit";  // 'inherit': as &walls slip
  std::string thermal = "inherit";
  double temperature = 300.0;  // K, where thermal is 'fixed'
  double velocity = 0.0;       // m/s, along the wall (x for bottom and top, y for left and right)
};

struct options {
  std::string treatment;  // the program's own unless the input says otherwise
  std::string interpolation = "mls";
  std::string slip = "no_slip";
  std::string thermal = "adiabatic";
  double marker_radius = 0.0;         // in kernel supports; 0: 1, and 1.35 for mls2
  double repulsion_range = 1.0;       // in particle spacings
  std::array<side_options, 6> sides;  // left, right, bottom, top, back, front
};

inline constexpr std::array<const char*, 6> side_names{"left", "right", "bottom", "top", "back", "front"};

// Declares group &walls; `dimension` decides how many sides there are.
void declare(namelist::schema& schema, int dimension, options& o);

// One plane wall: the fluid is where (x - position) * inward > 0 along the axis.
template <int D>
struct side {
  std::size_t axis;
  double position;  // m
  double inward;    // +1 at the low end, -1 at the high end
  bool no_slip;
  bool fixed_temperature;
  double temperature;                // K
  std::array<double, D> velocity{};  // m/s
};

// The walls of the box: one side at each end of every axis that is not periodic.
template <int D>
std::vector<side<D>> make_sides(const options& o, const domain::box<D>& box) {
  std::vector<side<D>> all;
  for (std::size_t axis = 0; axis < D; ++axis) {
    if (box.periodic[axis]) continue;
    for (const std::size_t end : {0, 1}) {
      const auto& given = o.sides[2 * axis + end];
      side<D> s;
      s.axis = axis;
      s.position = end == 0 ? 0.0 : box.length[axis];
      s.inward = end == 0 ? 1.0 : -1.0;
      s.no_slip = (given.slip == "inherit" ? o.slip : given.slip) == "no_slip";
      s.fixed_temperature = (given.thermal == "inherit" ? o.thermal : given.thermal) == "fixed";
      s.temperature = given.temperature;
      s.velocity[axis == 0 ? 1 : 0] = given.velocity;
      all.push_back(s);
    }
  }
  return all;
}

}  // namespace tetsuame::walls
