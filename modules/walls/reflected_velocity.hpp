// The velocity of mirror images: across a wall odd; along it even, or odd at a wall where the fluid sticks.
#pragma once

#include <walls/mirror.hpp>

namespace tetsuame::walls {

// m/s, of the image r of a source with this velocity. sticks: at walls of no slip; else they count as slippery ones.
template <int D>
std::array<double, D> reflected_velocity(const wall_set<D>& set, std::size_t r, std::array<double, D> v, bool sticks) {
  for_each_mirror(set, r, [&](const side<D>& wall) {
    for (std::size_t a = 0; a < D; ++a)
      if (a == wall.axis || (sticks && wall.no_slip)) v[a] = -v[a];
  });
  return v;
}

}  // namespace tetsuame::walls
