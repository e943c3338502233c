// Forces of the water on bodies: what the water's own sums lose when the wall particles of a body have no volume, with
// the sign reversed, so that what a body gains the water loses, to rounding.
//
// The images of a body in the sides are its own wall particles as the images of the water see them: what such an image
// does to the water, a particle of the body does to the image of that water. So its reaction belongs to the body,
// mirrored. Along a side the two are the same, so that no momentum is lost there.
//
// What holds water that lies on a body (rigid/contact.hpp) has its reaction, too.
#pragma once

#include <free_surface/sums.hpp>
#include <free_surface/tension.hpp>
#include <map>
#include <tuple>
#include <utility>

namespace tetsuame::free_surface {

// With new lists: wall particles by their bodies.
template <int D>
void group_walls(water<D>& f) {
  if (!f.asks_loads) return;
  const auto& w = f.world.w;
  const auto& s = w.s;
  const auto& walls = f.world.walls;
  const std::size_t first = s.first_wall(), behind = first + walls.body_particles;
  std::map<std::tuple<std::size_t, std::uint32_t, std::array<double, D>>, std::vector<std::size_t>> found;
  const auto add = [&](std::size_t i, std::uint32_t mirrored) {
    const auto body = static_cast<std::size_t>(s.material[i]);
    found[{body, mirrored, f.image_at(body, of_solids<D>(f.place(i))).c}].push_back(i);
  };
  for (std::size_t i = first; i < behind; ++i) add(i, 0);
  for (std::size_t r = walls.images_of_fluid; r < walls.source.size(); ++r) add(behind + r, walls.mirrored[r]);
  f.groups.clear();
  for (auto& [of, members] : found)
    f.groups.push_back({std::get<0>(of), std::get<1>(of), {std::get<2>(of)}, std::move(members)});
}

// The sums of the water beside bodies as if these wall particles had no volume, to force_without.
template <int D>
void sum_without(water<D>& f, const wall_group<D>& group) {
  auto& V = f.world.w.s.dV;
  std::vector<double> volumes;
  for (const std::size_t i : group.members) volumes.push_back(std::exchange(V[i], 0.0));
  const auto exchange_results = [&] {
    for (std::size_t a = 0; a < D; ++a) std::swap(f.force[a], f.force_without[a]);
    std::swap(f.density_rate, f.density_rate_without);
  };
  exchange_results();
  sum_over_neighbours(f, f.rows_near_bodies);
  exchange_results();
  for (std::size_t k = 0; k < volumes.size(); ++k) V[group.members[k]] = volumes[k];
}

// What the water at x (m) does to images of a body, in these sides, as the water's image does it to the body.
template <int D>
void mirror_load(const water<D>& f, const wall_group<D>& group, solids::point<D>& x, solids::point<D>& by) {
  for (std::size_t k = 0; k < f.world.walls.sides.size(); ++k) {
    if ((group.mirrored >> k & 1U) == 0) continue;
    const auto& side = f.world.walls.sides[k];
    x[side.axis] = 2.0 * side.position - x[side.axis];
    by[side.axis] = -by[side.axis];
  }
}

// Collective, after the water's sums. What it does to each of these bodies; about[n]: m, of the moment on bodies[n].
template <int D>
std::vector<load<D>> loads_on(water<D>& f, const std::vector<std::size_t>& bodies,
                              const std::vector<solids::point<D>>& about) {
  constexpr std::size_t T = D == 2 ? 1 : 3;
  std::vector<std::array<foundation::exact_sum, D + T>> sums(bodies.size());
  const auto add = [&](std::size_t n, const solids::point<D>& x, const solids::point<D>& by) {
    const auto moment = solids::moment<D>(x - about[n], by);
    for (std::size_t a = 0; a < D; ++a) sums[n][a].add(by[a]);
    for (std::size_t a = 0; a < T; ++a) sums[n][D + a].add(moment[a]);
  };
  for (const auto& push : f.pushes)
    for (std::size_t n = 0; n < bodies.size(); ++n)
      if (bodies[n] == push.body) add(n, push.x - push.image, -1.0 * push.momentum);
  for (const auto& group : f.groups) {
    if (std::ranges::find(bodies, group.body) == bodies.end()) continue;
    sum_without(f, group);
    for (const std::size_t i : f.rows_near_bodies.rows) {
      auto x = of_solids<D>(f.place(i)) - group.image;
      auto by = solids::point<D>::of([&](std::size_t a) { return f.force_without[a][i] - f.force[a][i]; });
      mirror_load(f, group, x, by);
      for (std::size_t n = 0; n < bodies.size(); ++n)
        if (bodies[n] == group.body) add(n, x, by);
    }
  }
  std::vector<load<D>> all(bodies.size());
  for (std::size_t n = 0; n < all.size(); ++n) {
    const auto total = f.ranks().exact(std::span(sums[n]));
    for (std::size_t a = 0; a < D; ++a) all[n].force[a] = total[a];
    for (std::size_t a = 0; a < T; ++a) all[n].moment[a] = total[D + a];
  }
  return all;
}

}  // namespace tetsuame::free_surface
