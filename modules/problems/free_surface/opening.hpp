// Sections of the box's sides through which water enters or leaves (docs/theory/inflow_and_outflow.md). Within the box,
// before such a section, lies a zone as long as the kernel reaches, whose particles the section moves (openings.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <regions/expression.hpp>
#include <string>
#include <vector>

namespace tetsuame::free_surface {

// Of groups &inflow and &outflow, one element a section.
struct opening_options {
  std::vector<std::string> side;                 // by name, as of &walls
  std::array<std::vector<double>, 3> low, high;  // m, along the side; not a number: the box's edge
  std::vector<double> level;                     // m; not a number: not given
  std::vector<std::string> velocity;             // m/s, of inflows
};

struct opening {
  bool enters = true;
  std::size_t axis = 0;
  double position = 0.0, inward = 1.0;               // m, of the side; the box lies where (x - position) * inward > 0
  double length = 0.0;                               // m, of the zone
  std::array<double, 3> low{}, high{};               // m, of the zone
  std::optional<double> level = {};                  // m, of the surface by whose weight the zone has its pressure
  std::optional<regions::expression> velocity = {};  // m/s, inwards: of entering water
  std::string text = {};                             // of it
  std::array<double, 3> box{};                       // m, edges
  double spacing = 0.0;                              // m

  // m, from the side into the box.
  double distance(const std::array<double, 3>& x) const { return (x[axis] - position) * inward; }
  bool holds(const std::array<double, 3>& x) const;
  // m/s, at a place of the zone and a time (s): that where the water leaves the zone. It may be below 0, or not finite.
  // By one thread at a time.
  double speed(const std::array<double, 3>& x, double t) const;
  bool changes_with_time() const { return velocity && velocity->uses({"t"}); }
};

}  // namespace tetsuame::free_surface
