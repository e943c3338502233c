// Mirror images of the fluid behind plane walls: what stands beyond a wall is the fluid itself, seen in it.
// Parities then hold exactly, on any arrangement of particles, without interpolation:
//
//   free slip       u_n odd, u_t even                      fixed temperature   T - T_w odd
//   no slip         u_g = 2 u_w - u_s + d² ∇²u_s           given flux q        T_g = T_s + 2 d q/k (adiabatic: even)
//
// with d the distance of the source s from the wall. The no-slip image is odd but for its last term: u(-d) =
// -u(d) + d² u_nn, and u_nn = ∇²u at a wall along which u does not change. Behind an edge or a corner one mirror
// follows the other. Images stand in the particle arrays' block of walls; each rank makes those of its fluid and
// of its ghosts, so they need no traffic.
#pragma once

#include <cstdint>
#include <foundation/threads.hpp>
#include <vector>
#include <walls/wall_set.hpp>

namespace tetsuame::walls {

// f(side) for each mirror of the image r, in the order of the axes.
template <int D, class F>
void for_each_mirror(const wall_set<D>& set, std::size_t r, F&& f) {
  for (std::size_t k = 0; k < set.sides.size(); ++k)
    if ((set.mirrored[r] >> k & 1U) != 0) f(set.sides[k]);
}

// Positions of the images from those of their sources.
template <int D>
void move_images(const wall_set<D>& set, particles::particles<D>& s) {
  foundation::for_all(set.source.size(), [&](std::size_t r) {
    const std::size_t i = s.first_wall() + set.body_particles + r, j = set.source[r];
    for (std::size_t a = 0; a < D; ++a) s.x[a][i] = s.x[a][j];
    for_each_mirror(set, r, [&](const side<D>& wall) { s.x[wall.axis][i] = 2.0 * wall.position - s.x[wall.axis][i]; });
  });
}

// Images of all fluid, ghosts included, nearer to a wall than `reach` (m), and of what bodies have in the block of
// walls. IDs follow the fluid's, and those of bodies: the same on any number of ranks.
template <int D>
void make_images(wall_set<D>& set, particles::particles<D>& s, std::int64_t fluid_total, double reach) {
  set.source.clear();
  set.mirrored.clear();
  std::vector<std::int64_t> ids;
  const std::size_t n = s.first_wall() + s.walls + s.wall_ghosts;
  set.body_particles = s.walls + s.wall_ghosts;
  set.images_of_fluid = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (i == s.first_wall()) set.images_of_fluid = ids.size();
    // Of each axis: no mirror, or one of its walls that is near.
    std::uint32_t near = 0;
    for (std::size_t k = 0; k < set.sides.size(); ++k)
      if (set.sides[k].distance(s.x[set.sides[k].axis][i]) < reach) near |= 1U << k;
    if (near == 0) continue;
    for (std::uint32_t chosen = near; chosen != 0; chosen = (chosen - 1) & near) {
      std::array<int, D> mirrors{};
      for (std::size_t k = 0; k < set.sides.size(); ++k) mirrors[set.sides[k].axis] += (chosen >> k & 1U) != 0 ? 1 : 0;
      bool once = true;  // no image of an image in the opposite wall
      for (const int m : mirrors) once = once && m <= 1;
      if (!once) continue;
      set.source.push_back(static_cast<std::uint32_t>(i));
      set.mirrored.push_back(chosen);
      const std::int64_t apart = i < s.first_wall() ? fluid_total : set.bodies.numbers;
      ids.push_back(s.id[i] + apart * static_cast<std::int64_t>(chosen));
    }
  }
  if (set.body_particles == 0) set.images_of_fluid = ids.size();
  // With bodies the owned walls are theirs, on ranks that have none too.
  if (set.bodies.any())
    particles::allocate(s, s.fluid, s.fluid_ghosts, s.walls, s.wall_ghosts + ids.size());
  else
    particles::allocate(s, s.fluid, s.fluid_ghosts, ids.size(), 0);
  const std::size_t first = s.first_wall() + set.body_particles;
  for (std::size_t r = 0; r < ids.size(); ++r) {
    s.id[first + r] = ids[r];
    s.material[first + r] = s.material[set.source[r]];
  }
  move_images(set, s);
}

}  // namespace tetsuame::walls
