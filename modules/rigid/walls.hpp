// Wall particles of bodies that stand still, what of the fluid may come to them, and what has entered them all the same
// (docs/theory/water_and_bodies.md).
#pragma once

#include <output/groups.hpp>
#include <rigid/box.hpp>
#include <run/lists.hpp>
#include <walls/boundary_force.hpp>

namespace tetsuame::rigid {

template <int D>
solids::point<D> place_of(const particles::particles<D>& s, std::size_t i) {
  return solids::point<D>::of([&](std::size_t a) { return s.x[a][i]; });
}

// How many places a lattice has.
template <int D>
std::int64_t places_of(const solids::lattice<D>& of) {
  std::int64_t all = 1;
  for (std::size_t a = 0; a < D; ++a) all *= std::llround(of.length[a] / of.spacing);
  return all;
}

// Of this rank: wall particles of solids on this lattice, whose numbers in the problem are given, and their markers.
template <int D>
void place_walls(run::state<D>& box, const std::vector<solids::body<D>>& solid, const std::vector<std::size_t>& number,
                 const solids::lattice<D>& of) {
  const auto cell = box.w.d.cell();
  const auto made = solids::fill_with_wall_particles<D>(solid, of, box.w.support(), {cell.lower, cell.upper});
  // On the surface itself both are 0.
  const auto reflection_ratio = [&](std::size_t n) {
    return made.height[n] > 0.0 ? made.depth[n] / made.height[n] : 1.0;
  };
  for (std::size_t n = 0; n < made.x.size(); ++n)
    box.walls.bodies.places.push_back({made.x[n].c, made.marker[n].c, made.normal[n].c, made.height[n],
                                       reflection_ratio(n), made.place[n],
                                       static_cast<std::int32_t>(number[made.body[n]])});
}

// Whether the particle i is of a body, or an image of one.
template <int D>
bool is_of_body(const run::state<D>& box, std::size_t i) {
  const std::size_t first = box.w.s.first_wall(), behind = first + box.walls.body_particles;
  return (i >= first && i < behind) || (i >= behind + box.walls.images_of_fluid && i < box.w.s.null());
}

// Owned fluid nearer to what is solid than this, m.
template <int D>
std::vector<std::uint32_t> fluid_beside(const run::state<D>& box, const solids::body<D>& solid, double near) {
  std::vector<std::uint32_t> all;
  for (std::size_t i = 0; i < box.w.s.fluid; ++i)
    if (solid.level(place_of(box.w.s, i)) < near) all.push_back(static_cast<std::uint32_t>(i));
  return all;
}

// Of a place within a body its mirror image outside.
template <int D>
solids::point<D> put_out(const solids::foot<D>& surface) {
  return surface.nearest - surface.distance * surface.normal;
}
// And of a velocity towards the surface, relative to it, the part across it is reversed.
template <int D>
void turn_back(const solids::point<D>& normal, solids::point<D>& u) {
  if (const double outwards = foundation::dot(u, normal); outwards < 0.0) u -= 2.0 * outwards * normal;
}

// ---- bodies that all stand still --------------------------------------------------------------------

template <int D>
struct bodies_at_rest_in_box {
  solids::body<D> all{}, solid{};       // as one; they and the tank about the box
  std::vector<std::uint32_t> beside{};  // fluid that may come to them before the next lists
};

// Wall particles of this rank.
template <int D>
void set_up(bodies_at_rest_in_box<D>& b, run::state<D>& box, const rigid::box<D>& of,
            std::vector<solids::body<D>> bodies, bool no_slip) {
  box.walls.bodies.no_slip = no_slip;
  box.walls.bodies.numbers = places_of(of.lattice);
  b.all = solids::joined(bodies);
  b.solid = solid_of(of, bodies);
  std::vector<std::size_t> number(bodies.size() + 1);  // the tank comes last
  for (std::size_t n = 0; n < number.size(); ++n) number[n] = n;
  bodies.push_back(tank_of(of));
  place_walls(box, bodies, number, of.lattice);
}

// With new lists. Particles move half of the skin about where these found them.
template <int D>
void find_beside(bodies_at_rest_in_box<D>& b, const run::state<D>& box) {
  b.beside = fluid_beside(box, b.all, 1.5 * box.skin);
}

// How deep the particle i is in a body (m), and the normal of the surface there; 0 outside. A spring as stiff as the
// boundary force of the sides (walls/boundary_force.hpp) pushes it out. It begins at the surface itself, and not 0.3 Δx
// before it: particles of the start lattice stand as near to a body as its shape has it, and are at rest there.
template <int D>
struct depth_in_body {
  double depth = 0.0;
  solids::point<D> normal = foundation::zero<double, D>();
};
template <int D>
depth_in_body<D> depth_of(const bodies_at_rest_in_box<D>& b, const particles::particles<D>& s, std::size_t i) {
  const auto x = place_of(s, i);
  if (!b.all.solid(x)) return {};
  const auto surface = b.all.at(x);
  if (!surface.found) return {};
  return {-surface.distance, surface.normal};
}

// The last guard, after a step: what is deeper in a body than this (m) is put back to its mirror image, with its
// velocity towards the body reversed. How many were put back.
template <int D>
std::int64_t put_out_of(const bodies_at_rest_in_box<D>& b, particles::particles<D>& s, double deepest) {
  std::int64_t crossings = 0;
  for (const std::uint32_t i : b.beside) {
    const auto x = place_of(s, i);
    if (!b.solid.solid(x)) continue;
    const auto surface = b.solid.at(x);
    if (!surface.found || surface.distance > -deepest) continue;
    auto u = solids::point<D>::of([&](std::size_t a) { return s.v[a][i]; });
    turn_back(surface.normal, u);
    const auto to = put_out(surface);
    for (std::size_t a = 0; a < D; ++a) {
      s.x[a][i] = to[a];
      s.v[a][i] = u[a];
    }
    ++crossings;
  }
  return crossings;
}

// Wall particles of bodies, for pictures; whoever fills them has their pressure. h: m.
template <int D>
output::particle_group group_of_walls(const run::state<D>& box, double h, std::vector<particles::array>& extra) {
  const auto& s = box.w.s;
  const std::size_t first = s.first_wall(), n = box.walls.bodies.places.size();
  auto g = output::group_of(s, 1, first, n);
  output::add_quantity(g, "Pressure", {s.p.data() + first});
  output::add_quantity(g, "SmoothingLength", {output::make_array(extra, n, [&](auto) { return h; })});
  return g;
}

}  // namespace tetsuame::rigid
