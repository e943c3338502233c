// Bodies that move in the water, as their motion says or as forces move them (docs/theory/water_and_bodies.md): where
// they, their wall particles and markers are, and how fast.
//
// Wall particles of a body that moves stand on the water's lattice where the body is at rest, and keep their places in
// the body. Their markers are found anew with each list, in all that is solid then, and move with the body until the
// next one.
#pragma once

#include <fmt/format.h>

#include <free_surface/water.hpp>

namespace tetsuame::free_surface {

template <int D>
solids::point<D> of_solids(const point& x) {
  return solids::point<D>::of([&](std::size_t a) { return x[a]; });
}

// ---- free bodies: their state is integrated with the water's ------------------------------------------

// Rank 0 has the state; every rank the poses and velocities that follow. Collective.
template <int D>
void take_free_state(water<D>& f) {
  if (f.free.empty()) return;
  constexpr std::size_t N = free_bodies<D>::components;
  std::vector<double> all(N * f.free.number);
  if (f.ranks().rank == 0)
    for (std::size_t k = 0; k < N; ++k) std::ranges::copy(f.free.state[k], all.begin() + k * f.free.number);
  MPI_Bcast(all.data(), static_cast<int>(all.size()), MPI_DOUBLE, 0, f.ranks().comm);
  std::size_t n = 0;
  for (auto& b : f.moving) {
    if (!b.free) continue;
    const auto value = [&](std::size_t k) { return all[k * f.free.number + n]; };
    b.set(value);
    ++n;
  }
}

// ---- where bodies are ----------------------------------------------------------------------------------

// Collective. All bodies as they are at this time; free ones by their state.
template <int D>
void set_bodies_at(water<D>& f, double t) {
  for (auto& b : f.moving) {
    if (b.free) continue;
    b.now = b.course.at(t);
    b.rate = b.course.rate_at(t);
  }
  take_free_state(f);
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
double bodies_moved(const water<D>& f) {
  double most = 0.0;
  for (const auto& b : f.moving) most = std::max(most, body_moved(b));
  return most;
}

// m/s, at most.
template <int D>
double bodies_speed(const water<D>& f) {
  double most = 0.0;
  for (const auto& b : f.moving)
    most = std::max(
        most, solids::norm<D>(b.rate.velocity) + std::sqrt(foundation::dot(b.rate.angular, b.rate.angular)) * b.radius);
  return most;
}

// A body that moves, at a pose of it, with its images across periodic sides.
template <int D>
solids::body<D> placed_at(const water<D>& f, const moving_body<D>& b, const solids::pose<D>& pose) {
  return solids::repeated<D>(solids::placed<D>(f.p.template bodies_in<D>()[b.body], pose),
                             rigid::period_of(box_of<D>(f.o)));
}

// All that is solid, with what moves at pose(body).
template <int D, class Pose>
solids::body<D> solid_with(const water<D>& f, const Pose& pose) {
  auto all = f.p.template bodies_in<D>();
  for (const auto& b : f.moving) all[b.body] = placed_at(f, b, pose(b));
  return rigid::solid_of<D>(box_of<D>(f.o), std::move(all));
}

// m, of its surface or that of its image.
template <int D>
double distance_from(const water<D>& f, const moving_body<D>& b, const solids::point<D>& x) {
  return std::abs(f.p.template bodies_in<D>()[b.body].level(b.now.to_body(x - f.image_at(b.body, x))));
}

// The body, of those that move, that this place is in or the nearest to; none: it is one that stands still.
template <int D>
const moving_body<D>* mover_at(const water<D>& f, const solids::point<D>& x) {
  const moving_body<D>* nearest = nullptr;
  if (f.moving.empty()) return nearest;
  double least = std::abs(f.solid_at_rest.level(x));
  for (const auto& b : f.moving)
    if (const double away = distance_from(f, b, x); away < least) {
      least = away;
      nearest = &b;
    }
  return nearest;
}

// ---- wall particles --------------------------------------------------------------------------------------

template <int D>
[[noreturn]] void fail_at(const water<D>& f, const moving_body<D>& b, const solids::point<D>& x, const char* what) {
  foundation::fail_calculation(
      fmt::format("body '{}' {} at {}", f.p.template bodies_in<D>()[b.body].name(), what, solids::place_text<D>(x)));
}

// Whether a wall particle there is one: beyond the sides, and in what is solid already, it is hidden. Nothing but water
// acts on free bodies: they must not come so far.
template <int D>
bool is_hidden(const water<D>& f, const moving_body<D>& b, const std::vector<solids::body<D>>& others,
               const solids::point<D>& x) {
  for (std::size_t a = 0; a < D; ++a) {
    const double length = f.o.domain.length[a];
    const bool inside = x[a] >= 0.0 && (x[a] < length || (a == 1 && f.o.open_top()));
    if (inside) continue;
    if (f.o.domain.periodic[a]) continue;
    if (b.free) fail_at(f, b, x, "has run into a side of the box, and nothing that would hold it is calculated,");
    return true;
  }
  const bool covered = std::ranges::any_of(others, [&](const auto& s) { return s.solid(x); });
  if (covered && b.free) fail_at(f, b, x, "has run into another body, and nothing that would hold it is calculated,");
  return covered;
}

// When cuts have moved. Those of what moves are placed anew with the lists. Collective.
template <int D>
void hand_over_walls(water<D>& f) {
  auto& walls = f.world.walls.bodies;
  if (!walls.any()) return;
  walls.places.resize(f.resting);
  walls::hand_over<D>(f.world.w.d, walls.places);
  f.resting = walls.places.size();
}

// Wall particles of all that moves, at the poses of the lists, behind those of what does not: of each those whose
// marker is in this rank's cell.
template <int D>
void place_moving_walls(water<D>& f) {
  if (f.moving.empty()) return;
  auto& walls = f.world.walls.bodies;
  const auto& box = f.world.w.d.region;
  const auto into_box = [&](const solids::point<D>& x) {
    return solids::shift_into<D>(x, solids::point<D>{box.length}, box.periodic);
  };
  const auto cell = f.world.w.d.cell();
  walls.places.resize(f.resting);
  f.in_body.assign(f.resting, {});
  std::vector<solids::body<D>> before{f.solid_at_rest};
  for (const auto& b : f.moving) {
    const auto& pose = b.at_lists;
    std::vector<std::optional<solids::marked<D>>> marks(b.rest.size());
    std::vector<solids::point<D>> places(b.rest.size());
    std::vector<bool> hidden;
    for (std::size_t n = 0; n < b.rest.size(); ++n) {
      const auto x = pose.to_space(b.rest[n]);
      places[n] = x + into_box(x);
      hidden.push_back(is_hidden(f, b, before, places[n]));
    }
    foundation::for_all(b.rest.size(), [&](std::size_t n) {
      if (!hidden[n]) marks[n] = solids::mark<D>(f.solid, places[n], f.world.w.support());
    });
    for (std::size_t n = 0; n < marks.size(); ++n) {
      if (!marks[n]) continue;
      const auto& m = *marks[n];
      const auto shift = into_box(m.marker);  // a wall particle stands where its marker is in the box
      const auto x = places[n] + shift, marker = m.marker + shift;
      const auto image = into_box(pose.to_space(b.rest[n])) + shift;
      if (!f.world.w.d.within(cell, marker.c)) continue;
      const double reflection_ratio = m.height > 0.0 ? m.depth / m.height : 1.0;
      walls.places.push_back({x.c, marker.c, m.normal.c, m.height, reflection_ratio,
                              b.first_number + static_cast<std::int64_t>(n), static_cast<std::int32_t>(b.body)});
      f.in_body.push_back(
          {b.rest[n], pose.to_body(marker - image), solids::turn_back<D>(pose.turned, m.normal), image});
    }
    before.push_back(placed_at(f, b, pose));
  }
}

// Where the box is periodic a body must be able to stand as it has come to; where its images are.
template <int D>
void find_images(water<D>& f) {
  const auto period = rigid::period_of(box_of<D>(f.o));
  if (!period.any()) return;
  for (auto& b : f.moving) {
    const auto here = solids::placed<D>(f.p.template bodies_in<D>()[b.body], b.at_lists);
    if (const auto fault = solids::fault_across<D>(here, period, 1.0); !fault.empty())
      foundation::fail_calculation(fault);
    const auto where = solids::bounds_of<D>(here);
    b.middle = b.at_lists.to_body(solids::point<D>::of(
        [&](std::size_t a) { return where.ends(a) ? 0.5 * (where.low[a] + where.high[a]) : 0.5 * period.length[a]; }));
  }
}

// Before lists are made: from where bodies are now, or as_they_were when they were made last.
template <int D>
void place_bodies_for_lists(water<D>& f, bool as_they_were) {
  if (f.moving.empty()) return;
  if (!as_they_were)
    for (auto& b : f.moving) b.at_lists = b.now;
  find_images(f);
  f.solid = solid_with(f, [](const auto& b) { return b.at_lists; });
  place_moving_walls(f);
}

// Wall particles of this rank, and their markers, to where their bodies are; then its ghosts.
template <int D>
void move_walls(water<D>& f) {
  if (f.moving.empty()) return;
  auto& w = f.world.w;
  auto& bodies = f.world.walls.bodies;
  foundation::for_all(bodies.places.size(), [&](std::size_t r) {
    auto& place = bodies.places[r];
    const auto* b = f.mover(place.body);
    if (b == nullptr) return;
    place.x = (b->now.to_space(f.in_body[r].x) + f.in_body[r].image).c;
    place.marker = (b->now.to_space(f.in_body[r].marker) + f.in_body[r].image).c;
    place.normal = solids::turn<D>(b->now.turned, f.in_body[r].normal).c;
    for (std::size_t a = 0; a < D; ++a) w.s.x[a][w.s.first_wall() + r] = place.x[a];
  });
  domain::exchange<D>(w.d.ranks, w.d.wall_halo, {}, &w.s.x);
}

// ---- checkpoints -------------------------------------------------------------------------------------------

// Poses of all that moves when lists were made, and the state of free bodies, which rank 0 has: the other ranks' is not
// written.
template <int D>
std::vector<double> saved_bodies(const water<D>& f) {
  std::vector<double> all;
  for (const auto& b : f.moving) {
    for (const auto& row : b.at_lists.turned) all.insert(all.end(), row.c.begin(), row.c.end());
    all.insert(all.end(), b.at_lists.shift.c.begin(), b.at_lists.shift.c.end());
  }
  for (const auto& component : f.free.state) all.insert(all.end(), component.begin(), component.end());
  return all;
}
template <int D>
void restore_bodies(water<D>& f, const std::vector<double>& saved, double t) {
  auto from = saved.begin();
  for (auto& b : f.moving) {
    for (auto& row : b.at_lists.turned)
      for (auto& value : row.c) value = *from++;
    for (auto& value : b.at_lists.shift.c) value = *from++;
  }
  if (f.ranks().rank == 0)
    for (auto& component : f.free.state)
      for (auto& value : component) value = *from++;
  set_bodies_at(f, t);
}

// ---- the start ---------------------------------------------------------------------------------------------

// Places of the lattice in a body at rest, as deep as the kernel reaches, where it ever comes into the box.
template <int D>
std::vector<solids::point<D>> lattice_in(const water<D>& f, std::size_t body) {
  const auto& of = f.p.template bodies_in<D>()[body];
  const auto where = ever_in_box<D>(f.o, of, f.p.template motions_in<D>()[body]);
  std::array<std::int64_t, D> first, number;
  std::int64_t all = 1;
  for (std::size_t a = 0; a < D; ++a) {
    // Centres of cells within these bounds.
    first[a] = static_cast<std::int64_t>(std::ceil(where.low[a] / f.dx() - 0.5 - 1e-9));
    const auto end = static_cast<std::int64_t>(std::ceil(where.high[a] / f.dx() - 0.5 - 1e-9));
    all *= number[a] = std::max<std::int64_t>(0, end - first[a]);
  }
  std::vector<solids::point<D>> places;
  for (std::int64_t n = 0; n < all; ++n) {
    std::int64_t rest = n;
    const auto x = solids::point<D>::of([&](std::size_t a) {
      const auto row = first[a] + rest % number[a];
      rest /= number[a];
      return (static_cast<double>(row) + 0.5) * f.dx();
    });
    if (solids::mark<D>(of, x, f.world.w.support())) places.push_back(x);
  }
  return places;
}

// The bodies that move, where they begin.
template <int D>
void set_up_moving(water<D>& f) {
  const auto& bodies = f.p.template bodies_in<D>();
  const auto& motions = f.p.template motions_in<D>();
  f.mover_of.assign(bodies.size() + 1, moving_body<D>::none);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!motions[b].moves()) continue;
    f.mover_of[b] = f.moving.size();
    moving_body<D> m;
    m.body = b;
    m.course = motions[b].course;
    m.free = motions[b].free;
    m.rest = lattice_in(f, b);
    m.first_number = f.world.walls.bodies.numbers;
    f.world.walls.bodies.numbers += static_cast<std::int64_t>(m.rest.size());
    m.now = m.free ? m.free->now : m.course.at(0.0);
    for (const auto& x : m.rest) m.radius = std::max(m.radius, solids::norm<D>(x - m.now.pivot));
    if (m.free) {
      const auto start = m.state();
      for (std::size_t k = 0; k < start.size(); ++k)
        if (f.ranks().rank == 0) f.free.state[k].push_back(start[k]);
      ++f.free.number;
    }
    f.moving.push_back(std::move(m));
  }
  f.world.walls.bodies.move = !f.moving.empty();
  set_bodies_at(f, 0.0);
  for (auto& b : f.moving) b.at_lists = b.now;
}

}  // namespace tetsuame::free_surface
