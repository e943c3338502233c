// The gradient of temperature at a wall of fixed temperature, from the particles near a place of it: least squares of
//   T - T_w = y (a + b·t + t·c t) + y³ (d + e·t) + y⁵ f
// with y the distance from the wall and t the way along it from the place; a is the gradient. Only odd powers of y: the
// temperature less the wall's is odd about it as far as ∇²T = 0 there.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace tetsuame::convection {

inline constexpr double fit_radius = 3.5;  // spacings

struct near_wall {
  double y;                 // m, from the wall
  std::array<double, 2> t;  // m, coordinates along it (2-D: the second is 0)
  double excess;            // K, T - T_w
  std::int64_t id;
};

// Sorts the samples; the result then depends on neither their order nor on ranks.
void sort(std::vector<near_wall>& samples);

// K/m, at `place` along the wall, from samples (sorted) within `radius` of it, weighted by (1 - r²/radius²)². dimension
// 2 or 3. Not-a-number where too few are near.
double wall_gradient(const std::vector<near_wall>& samples, const std::array<double, 2>& place, double radius,
                     int dimension);

}  // namespace tetsuame::convection
