// Forces of the water on bodies: what the water's own sums lose when the wall particles of a body have no volume, with
// the sign reversed, so that what a body gains the water loses, to rounding.
//
// The images of a body in the sides are its own wall particles as the images of the water see them: what such an image
// does to the water, a particle of the body does to the image of that water. So its reaction belongs to the body,
// mirrored. Along a side the two are the same, so that no momentum is lost there.
#pragma once

#include <free_surface/right_hand_side.hpp>
#include <free_surface/tension.hpp>
#include <map>
#include <tuple>
#include <utility>

namespace tetsuame::free_surface {

template <int D>
struct load {
  solids::point<D> force = foundation::zero<double, D>();                    // N; N/m in two dimensions
  solids::about<D> moment = foundation::zero < double, D == 2 ? 1 : 3 > ();  // N m, about a point
};

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
    std::swap(f.force, f.force_without);
    std::swap(f.density_rate, f.density_rate_without);
  };
  exchange_results();
  sum_over_neighbours(f, f.beside);
  exchange_results();
  for (std::size_t k = 0; k < volumes.size(); ++k) V[group.members[k]] = volumes[k];
}

// Collective, after the water's sums. What it does to each of these bodies; about[n]: m, of the moment on bodies[n].
template <int D>
std::vector<load<D>> loads_on(water<D>& f, const std::vector<std::size_t>& bodies,
                              const std::vector<solids::point<D>>& about) {
  constexpr std::size_t T = D == 2 ? 1 : 3;
  std::vector<std::array<foundation::exact_sum, D + T>> sums(bodies.size());
  for (const auto& group : f.groups) {
    if (std::ranges::find(bodies, group.body) == bodies.end()) continue;
    sum_without(f, group);
    for (const std::size_t i : f.beside.rows) {
      auto x = of_solids<D>(f.place(i)) - group.image;
      auto by = solids::point<D>::of([&](std::size_t a) { return f.force_without[a][i] - f.force[a][i]; });
      for (std::size_t k = 0; k < f.world.walls.sides.size(); ++k)
        if ((group.mirrored >> k & 1U) != 0) {
          const auto& side = f.world.walls.sides[k];
          x[side.axis] = 2.0 * side.position - x[side.axis];
          by[side.axis] = -by[side.axis];
        }
      for (std::size_t n = 0; n < bodies.size(); ++n) {
        if (bodies[n] != group.body) continue;
        const auto moment = solids::moment<D>(x - about[n], by);
        for (std::size_t a = 0; a < D; ++a) sums[n][a].add(by[a]);
        for (std::size_t a = 0; a < T; ++a) sums[n][D + a].add(moment[a]);
      }
    }
  }
  std::vector<load<D>> all(bodies.size());
  for (std::size_t n = 0; n < all.size(); ++n) {
    for (std::size_t a = 0; a < D; ++a) all[n].force[a] = f.ranks().exact(sums[n][a]);
    for (std::size_t a = 0; a < T; ++a) all[n].moment[a] = f.ranks().exact(sums[n][D + a]);
  }
  return all;
}

// ---- free bodies ------------------------------------------------------------------------------------------

// What runs through periodic sides turns about their axis alone: of its moment that is left.
template <int D>
solids::about<D> moment_that_turns(const water<D>& f, std::size_t body, solids::about<D> moment) {
  const auto& through = f.p.template motions_in<D>()[body].images.through;
  for (std::size_t a = 0; a < D; ++a)
    for (std::size_t k = 0; through[a] && k < moment.c.size(); ++k)
      if (D == 2 || k != a) moment[k] = 0.0;
  return moment;
}

// Collective, after the water's sums. Forces on the free bodies, about their centres of mass.
template <int D>
std::vector<load<D>> loads_on_free_bodies(water<D>& f) {
  std::vector<std::size_t> bodies;
  std::vector<solids::point<D>> about;
  for (const auto& b : f.moving)
    if (b.free) {
      bodies.push_back(b.body);
      about.push_back(b.rate.centre);
    }
  auto loads = loads_on(f, bodies, about);
  for (std::size_t n = 0; n < loads.size(); ++n) loads[n].moment = moment_that_turns(f, bodies[n], loads[n].moment);
  return loads;
}

// Collective, after the water's sums, for which free bodies had no acceleration: their acceleration, which the pressure
// of their wall particles depends on, and the sums of the water beside bodies with it. What remains falls by about a
// spacing over the draught at rest, and mostly by more, with each round.
template <int D>
std::vector<load<D>> accelerate_free_bodies(water<D>& f) {
  constexpr int rounds = 3;
  auto loads = loads_on_free_bodies(f);
  for (int round = 0; round < rounds; ++round) {
    std::size_t n = 0;
    for (auto& b : f.moving)
      if (b.free) {
        const auto& by = loads[n++];
        b.rate.acceleration =
            solids::point<D>::of([&](std::size_t a) { return by.force[a] / b.free->mass + f.world.w.g[a]; });
        b.rate.angular_acceleration = b.free->angular_acceleration(b.now.turned, by.moment);
      }
    mirror(f);
    sum_over_neighbours(f, f.beside);
    loads = loads_on_free_bodies(f);
  }
  return loads;
}
template <int D>
void forget_accelerations(water<D>& f) {
  for (auto& b : f.moving)
    if (b.free) b.rate.acceleration = {}, b.rate.angular_acceleration = {};
}

// Rates of the free bodies' state, on rank 0, an array a component.
template <int D>
void find_rates_of_bodies(const water<D>& f, const std::vector<load<D>>& loads, std::span<double* const> rate) {
  if (f.ranks().rank != 0) return;
  constexpr std::size_t angles = moving_body<D>::angles, turns = moving_body<D>::turns;
  std::size_t n = 0;
  for (const auto& b : f.moving) {
    if (!b.free) continue;
    for (std::size_t a = 0; a < D; ++a) {
      rate[a][n] = b.rate.velocity[a];
      rate[D + a][n] = loads[n].force[a] / b.free->mass + f.world.w.g[a];
    }
    const auto& w = b.rate.angular;
    if constexpr (D == 2) {
      rate[2 * D][n] = w[0];
    } else {  // q' = (0, ω) q/2
      const auto q = [&](std::size_t k) { return f.free.state[2 * D + k][n]; };
      rate[2 * D][n] = -0.5 * (w[0] * q(1) + w[1] * q(2) + w[2] * q(3));
      rate[2 * D + 1][n] = 0.5 * (w[0] * q(0) + w[1] * q(3) - w[2] * q(2));
      rate[2 * D + 2][n] = 0.5 * (w[1] * q(0) + w[2] * q(1) - w[0] * q(3));
      rate[2 * D + 3][n] = 0.5 * (w[2] * q(0) + w[0] * q(2) - w[1] * q(1));
    }
    for (std::size_t a = 0; a < turns; ++a) rate[2 * D + angles + a][n] = loads[n].moment[a] / b.spin_scale();
    ++n;
  }
}

// ---- evaluations ------------------------------------------------------------------------------------------

// Collective. Of those bodies whose force a gauge reads, at the state in the arrays.
template <int D>
std::vector<load<D>> read_loads(water<D>& f) {
  forget_accelerations(f);
  refresh(f);
  sum_over_neighbours(f, f.beside);
  if (!f.free.empty()) accelerate_free_bodies(f);
  std::vector<std::size_t> bodies;
  std::vector<solids::point<D>> about;
  for (const auto& g : f.p.force) {
    const auto* b = f.mover(static_cast<std::int32_t>(g.body));
    const auto centre = of_solids<D>(g.centre);
    bodies.push_back(g.body);
    about.push_back(g.about ? of_solids<D>(*g.about) : b != nullptr ? b->now.to_space(centre) : centre);
  }
  return loads_on(f, bodies, about);
}

// Collective. Rates of x, v, ρ, and of the free bodies' state.
template <int D>
void evaluate(water<D>& f, std::span<double* const> rate) {
  auto& w = f.world.w;
  forget_accelerations(f);
  begin_motion(f);
  find_own(f, 0, w.s.fluid);
  sum_over_neighbours(f, w.interior());
  end_motion(f);
  sum_over_neighbours(f, w.at_border());
  if (f.has_tension()) find_tension(f);
  if (!f.free.empty()) find_rates_of_bodies(f, accelerate_free_bodies(f), rate.subspan(2 * D + 1));
  find_rates(f, rate.first(2 * D + 1));
}

}  // namespace tetsuame::free_surface
