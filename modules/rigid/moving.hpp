// Bodies that move in the fluid, as their motion says or as forces move them (docs/theory/water_and_bodies.md): where
// they, their wall particles and markers are, and how fast.
//
// Wall particles of a body that moves stand on the fluid's lattice where the body is at rest, and keep their places in
// the body. Their markers are found anew with each list, in all that is solid then, and move with the body until the
// next one.
#pragma once

#include <fmt/format.h>

#include <rigid/bodies.hpp>

namespace tetsuame::rigid {

// ---- free bodies: their state is integrated with the fluid's ------------------------------------------

// Rank 0 has the state; every rank the poses and velocities that follow. Collective.
template <int D>
void take_free_state(bodies<D>& set) {
  if (set.free.empty()) return;
  constexpr std::size_t N = free_bodies<D>::components;
  std::vector<double> all(N * set.free.number);
  if (set.state.w.d.ranks.rank == 0)
    for (std::size_t k = 0; k < N; ++k) std::ranges::copy(set.free.state[k], all.begin() + k * set.free.number);
  MPI_Bcast(all.data(), static_cast<int>(all.size()), MPI_DOUBLE, 0, set.state.w.d.ranks.comm);
  std::size_t n = 0;
  for (auto& b : set.moving) {
    if (!b.free) continue;
    const auto value = [&](std::size_t k) { return all[k * set.free.number + n]; };
    b.set(value);
    ++n;
  }
}

// ---- where bodies are ----------------------------------------------------------------------------------

// Collective. All bodies as they are at this time; free ones by their state.
template <int D>
void set_bodies_at(bodies<D>& set, double t) {
  for (auto& b : set.moving) {
    if (b.free) continue;
    b.now = b.course.at(t);
    b.rate = b.course.rate_at(t);
  }
  take_free_state(set);
}

// m, at most, that a point of the body has moved since the lists were made; of all that move, that of the farthest.
template <int D>
double body_moved(const moving_body<D>& b) {
  double turned = 0.0;  // squared
  for (std::size_t a = 0; a < D; ++a) {
    const auto by = b.now.turned[a] - b.at_lists.turned[a];
    turned += foundation::dot(by, by);
  }
  return solids::norm<D>(b.now.shift - b.at_lists.shift) + std::sqrt(turned) * b.radius;
}
template <int D>
double bodies_moved(const bodies<D>& set) {
  double most = 0.0;
  for (const auto& b : set.moving) most = std::max(most, body_moved(b));
  return most;
}

// m/s, at most.
template <int D>
double bodies_speed(const bodies<D>& set) {
  double most = 0.0;
  for (const auto& b : set.moving)
    most = std::max(
        most, solids::norm<D>(b.rate.velocity) + std::sqrt(foundation::dot(b.rate.angular, b.rate.angular)) * b.radius);
  return most;
}

// A body that moves, at a pose of it, with its images across periodic sides.
template <int D>
solids::body<D> placed_at(const bodies<D>& set, const moving_body<D>& b, const solids::pose<D>& pose) {
  return solids::repeated<D>(solids::placed<D>(set.given[b.body], pose), period_of(set.in_box));
}

// All that is solid, with what moves at pose(body).
template <int D, class Pose>
solids::body<D> solid_with(const bodies<D>& set, const Pose& pose) {
  auto all = set.given;
  for (const auto& b : set.moving) all[b.body] = placed_at(set, b, pose(b));
  return solid_of<D>(set.in_box, std::move(all));
}

// m, of its surface or that of its image.
template <int D>
double distance_from(const bodies<D>& set, const moving_body<D>& b, const solids::point<D>& x) {
  return std::abs(set.given[b.body].level(b.now.to_body(x - set.image_at(b.body, x))));
}

// The body, of those that move, that this place is in or the nearest to; none: it is one that stands still.
template <int D>
const moving_body<D>* mover_at(const bodies<D>& set, const solids::point<D>& x) {
  const moving_body<D>* nearest = nullptr;
  if (set.moving.empty()) return nearest;
  double least = std::abs(set.solid_at_rest.level(x));
  for (const auto& b : set.moving)
    if (const double away = distance_from(set, b, x); away < least) {
      least = away;
      nearest = &b;
    }
  return nearest;
}

// ---- wall particles --------------------------------------------------------------------------------------

template <int D>
[[noreturn]] void fail_at(const bodies<D>& set, const moving_body<D>& b, const solids::point<D>& x, const char* what) {
  foundation::fail_calculation(
      fmt::format("body '{}' {} at {}", set.given[b.body].name(), what, solids::place_text<D>(x)));
}

// Whether a wall particle there is one: beyond the sides, and in what is solid already, it is hidden. Nothing but water
// acts on free bodies: they must not come so far.
template <int D>
bool is_hidden(const bodies<D>& set, const moving_body<D>& b, const std::vector<solids::body<D>>& others,
               const solids::point<D>& x) {
  for (std::size_t a = 0; a < D; ++a) {
    const double length = set.in_box.lattice.length[a];
    const bool inside = x[a] >= 0.0 && (x[a] < length || (a == 1 && set.in_box.open_top));
    if (inside) continue;
    if (set.in_box.lattice.periodic[a]) continue;
    if (b.free) fail_at(set, b, x, "has run into a side of the box, and nothing that would hold it is calculated,");
    return true;
  }
  const bool covered = std::ranges::any_of(others, [&](const auto& s) { return s.solid(x); });
  if (covered && b.free) fail_at(set, b, x, "has run into another body, and nothing that would hold it is calculated,");
  return covered;
}

// When cuts have moved. Those of what moves are placed anew with the lists. Collective.
template <int D>
void hand_over_walls(bodies<D>& set) {
  auto& walls = set.state.walls.bodies;
  if (!walls.any()) return;
  walls.places.resize(set.resting);
  walls::hand_over<D>(set.state.w.d, walls.places);
  set.resting = walls.places.size();
}

// Wall particles of all that moves, at the poses of the lists, behind those of what does not: of each those whose
// marker is in this rank's cell.
template <int D>
void place_moving_walls(bodies<D>& set) {
  if (set.moving.empty()) return;
  auto& walls = set.state.walls.bodies;
  const auto& box = set.state.w.d.region;
  const auto into_box = [&](const solids::point<D>& x) {
    return solids::shift_into<D>(x, solids::point<D>{box.length}, box.periodic);
  };
  const auto cell = set.state.w.d.cell();
  walls.places.resize(set.resting);
  set.in_body.assign(set.resting, {});
  std::vector<solids::body<D>> before{set.solid_at_rest};
  for (const auto& b : set.moving) {
    const auto& pose = b.at_lists;
    std::vector<std::optional<solids::marked<D>>> marks(b.rest.size());
    std::vector<solids::point<D>> places(b.rest.size());
    std::vector<bool> hidden;
    for (std::size_t n = 0; n < b.rest.size(); ++n) {
      const auto x = pose.to_space(b.rest[n]);
      places[n] = x + into_box(x);
      hidden.push_back(is_hidden(set, b, before, places[n]));
    }
    foundation::for_all(b.rest.size(), [&](std::size_t n) {
      if (!hidden[n]) marks[n] = solids::mark<D>(set.solid, places[n], set.state.w.support());
    });
    for (std::size_t n = 0; n < marks.size(); ++n) {
      if (!marks[n]) continue;
      const auto& m = *marks[n];
      const auto shift = into_box(m.marker);  // a wall particle stands where its marker is in the box
      const auto x = places[n] + shift, marker = m.marker + shift;
      const auto image = into_box(pose.to_space(b.rest[n])) + shift;
      if (!set.state.w.d.within(cell, marker.c)) continue;
      const double reflection_ratio = m.height > 0.0 ? m.depth / m.height : 1.0;
      walls.places.push_back({x.c, marker.c, m.normal.c, m.height, reflection_ratio,
                              b.first_number + static_cast<std::int64_t>(n), static_cast<std::int32_t>(b.body)});
      set.in_body.push_back(
          {b.rest[n], pose.to_body(marker - image), solids::turn_back<D>(pose.turned, m.normal), image});
    }
    before.push_back(placed_at(set, b, pose));
  }
}

// Where the box is periodic a body must be able to stand as it has come to; where its images are.
template <int D>
void find_images(bodies<D>& set) {
  const auto period = period_of(set.in_box);
  if (!period.any()) return;
  for (auto& b : set.moving) {
    const auto here = solids::placed<D>(set.given[b.body], b.at_lists);
    if (const auto fault = solids::fault_across<D>(here, period, 1.0); !fault.empty())
      foundation::fail_calculation(fault);
    const auto where = solids::bounds_of<D>(here);
    b.middle = b.at_lists.to_body(solids::point<D>::of(
        [&](std::size_t a) { return where.ends(a) ? 0.5 * (where.low[a] + where.high[a]) : 0.5 * period.length[a]; }));
  }
}

// Before lists are made: from where bodies are now, or as_they_were when they were made last.
template <int D>
void place_bodies_for_lists(bodies<D>& set, bool as_they_were) {
  if (set.moving.empty()) return;
  if (!as_they_were)
    for (auto& b : set.moving) b.at_lists = b.now;
  find_images(set);
  set.solid = solid_with(set, [](const auto& b) { return b.at_lists; });
  place_moving_walls(set);
}

// Wall particles of this rank, and their markers, to where their bodies are; then its ghosts.
template <int D>
void move_walls(bodies<D>& set) {
  if (set.moving.empty()) return;
  auto& w = set.state.w;
  auto& bodies = set.state.walls.bodies;
  foundation::for_all(bodies.places.size(), [&](std::size_t r) {
    auto& place = bodies.places[r];
    const auto* b = set.mover(place.body);
    if (b == nullptr) return;
    place.x = (b->now.to_space(set.in_body[r].x) + set.in_body[r].image).c;
    place.marker = (b->now.to_space(set.in_body[r].marker) + set.in_body[r].image).c;
    place.normal = solids::turn<D>(b->now.turned, set.in_body[r].normal).c;
    for (std::size_t a = 0; a < D; ++a) w.s.x[a][w.s.first_wall() + r] = place.x[a];
  });
  domain::exchange<D>(w.d.ranks, w.d.wall_halo, {}, &w.s.x);
}

// ---- checkpoints -------------------------------------------------------------------------------------------

// Poses of all that moves when lists were made, and the state of free bodies, which rank 0 has: the other ranks' is not
// written.
template <int D>
std::vector<double> saved_bodies(const bodies<D>& set) {
  std::vector<double> all;
  for (const auto& b : set.moving) {
    for (const auto& row : b.at_lists.turned) all.insert(all.end(), row.c.begin(), row.c.end());
    all.insert(all.end(), b.at_lists.shift.c.begin(), b.at_lists.shift.c.end());
  }
  for (const auto& component : set.free.state) all.insert(all.end(), component.begin(), component.end());
  return all;
}
template <int D>
void restore_bodies(bodies<D>& set, const std::vector<double>& saved, double t) {
  auto from = saved.begin();
  for (auto& b : set.moving) {
    for (auto& row : b.at_lists.turned)
      for (auto& value : row.c) value = *from++;
    for (auto& value : b.at_lists.shift.c) value = *from++;
  }
  if (set.state.w.d.ranks.rank == 0)
    for (auto& component : set.free.state)
      for (auto& value : component) value = *from++;
  set_bodies_at(set, t);
}

}  // namespace tetsuame::rigid
