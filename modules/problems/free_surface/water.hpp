// Water with a free surface: what a run holds, as plain data.
#pragma once

#include <free_surface/options.hpp>
#include <run/start.hpp>

namespace tetsuame::free_surface {

template <int D>
struct water {
  const options& o;
  const parameters& p;
  run::state<D> world = {};

  solids::body<D> solid = {};  // all bodies and, beyond the sides, the tank; without pieces where there are no bodies
  std::vector<std::uint32_t> beside_bodies = {};  // fluid that may come to them before the next lists
  bool sticks = false;                            // a wall is one of no slip

  // Filled by evaluations, with room for every particle.
  std::array<particles::array, D> viscous_velocity = {};  // m/s, where a wall sticks: of images as they are dragged
  std::array<particles::array, D> force = {};             // N, but for gravity
  particles::array density_rate = {};                     // kg/(m3 s)

  // Filled by what looks at the surface (surface.hpp).
  std::array<particles::array, D> slope = {}, normal = {};          // 1/m; of length 1
  particles::array eigenvalue = {}, least_near = {}, covered = {};  // λ, the least of the neighbourhood; 1 or 0

  water(const options& of_input, const parameters& that_follow) : o(of_input), p(that_follow) {}

  void make_room() {
    std::vector<particles::array*> all{&density_rate, &eigenvalue, &least_near, &covered};
    for (auto* vectors : {&force, &slope, &normal})
      for (auto& a : *vectors) all.push_back(&a);
    if (sticks)
      for (auto& a : viscous_velocity) all.push_back(&a);
    for (auto* a : all) a->assign(world.w.s.total() + 1, 0.0);
  }

  const domain::communicator& ranks() const { return world.w.d.ranks; }
  double gravity() const { return o.flow.gravity; }
  double dx() const { return world.w.dx; }
  point place(std::size_t i) const {
    point x{};
    for (std::size_t a = 0; a < D; ++a) x[a] = world.w.s.x[a][i];
    return x;
  }
  double speed2(std::size_t i) const {
    double v2 = 0.0;
    for (std::size_t a = 0; a < D; ++a) v2 += world.w.s.v[a][i] * world.w.s.v[a][i];
    return v2;
  }
};

}  // namespace tetsuame::free_surface
