// The velocity of mirror images: across a wall odd, along it even where the fluid slips and odd where it does not.
#pragma once

#include <walls/mirror.hpp>

namespace tetsuame::walls {

template <int D>
void reflect_velocities(const wall_set<D>& set, particles::particles<D>& s) {
  foundation::for_all(set.source.size(), [&](std::size_t r) {
    const std::size_t i = s.first_wall() + r, j = set.source[r];
    for (std::size_t a = 0; a < D; ++a) s.v[a][i] = s.v[a][j];
    for_each_mirror(set, r, [&](const side<D>& wall) {
      for (std::size_t a = 0; a < D; ++a)
        if (wall.no_slip || a == wall.axis) s.v[a][i] = -s.v[a][i];
    });
  });
}

}  // namespace tetsuame::walls
