// Wall particles of bodies that stand still, and what of the fluid may come to them or has entered them
// (docs/theory/water_and_bodies.md).
#pragma once

#include <output/groups.hpp>
#include <rigid/box.hpp>
#include <run/lists.hpp>

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

// Of this rank: wall particles of solids on this lattice, or such that fit them, and their markers. The solids' numbers
// in the problem are given.
template <int D>
void place_walls(run::state<D>& box, const std::vector<solids::body<D>>& solid, const std::vector<std::size_t>& number,
                 const solids::lattice<D>& of, bool fitted) {
  const auto cell = box.w.d.cell();
  const auto made = solids::fill_with_wall_particles<D>(solid, of, box.w.support(), {cell.lower, cell.upper}, fitted);
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
