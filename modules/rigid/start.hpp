// Bodies at the start of a run: their wall particles, those of what moves in the body at rest.
#pragma once

#include <rigid/moving.hpp>
#include <solids/fit.hpp>

namespace tetsuame::rigid {

// Places of the lattice in a body at rest, or such that fit it, as deep as the kernel reaches, where it ever comes into
// the box.
template <int D>
std::vector<solids::point<D>> lattice_in(const bodies<D>& set, std::size_t body) {
  const auto& of = set.given[body];
  const auto where = ever_in_box<D>(set.in_box, of, set.motions[body]);
  std::array<std::int64_t, D> first, number;
  std::int64_t all = 1;
  for (std::size_t a = 0; a < D; ++a) {
    // Centres of cells within these bounds.
    first[a] = static_cast<std::int64_t>(std::ceil(where.low[a] / set.spacing() - 0.5 - 1e-9));
    const auto end = static_cast<std::int64_t>(std::ceil(where.high[a] / set.spacing() - 0.5 - 1e-9));
    all *= number[a] = std::max<std::int64_t>(0, end - first[a]);
  }
  std::vector<solids::point<D>> places;
  solids::fit<D> fit_to(of, set.spacing());
  const double deepest = set.state.w.support();
  for (std::int64_t n = 0; n < all; ++n) {
    std::int64_t rest = n;
    const auto on_lattice = solids::point<D>::of([&](std::size_t a) {
      const auto row = first[a] + rest % number[a];
      rest /= number[a];
      return (static_cast<double>(row) + 0.5) * set.spacing();
    });
    const auto x = set.fitted ? fit_to.place(on_lattice, deepest) : on_lattice;
    if (solids::mark<D>(of, x, deepest)) places.push_back(x);
  }
  return places;
}

// The bodies that move, where they begin.
template <int D>
void set_up_moving(bodies<D>& set) {
  set.mover_of.assign(set.given.size() + 1, moving_body<D>::none);
  for (std::size_t b = 0; b < set.given.size(); ++b) {
    if (!set.motions[b].moves()) continue;
    set.mover_of[b] = set.moving.size();
    moving_body<D> m;
    m.body = b;
    m.course = set.motions[b].course;
    m.free = set.motions[b].free;
    m.rest = lattice_in(set, b);
    m.first_number = set.state.walls.bodies.numbers;
    set.state.walls.bodies.numbers += static_cast<std::int64_t>(m.rest.size());
    m.now = m.free ? m.free->now : m.course.at(0.0);
    for (const auto& x : m.rest) m.radius = std::max(m.radius, solids::norm<D>(x - m.now.pivot));
    if (m.free) {
      const auto start = m.state();
      for (std::size_t k = 0; k < start.size(); ++k)
        if (set.state.w.d.ranks.rank == 0) set.free.state[k].push_back(start[k]);
      ++set.free.number;
    }
    set.moving.push_back(std::move(m));
  }
  set.state.walls.bodies.move = !set.moving.empty();
  set_bodies_at(set, 0.0);
  for (auto& b : set.moving) b.at_lists = b.now;
}

// The lattice of the box; where its top is open as high above that as bodies reach which do not move, at most twice as
// high: water that rises there finds them.
template <int D>
solids::lattice<D> lattice_of_resting(const bodies<D>& set) {
  auto lattice = set.in_box.lattice;
  if (!set.in_box.open_top) return lattice;
  double rows = 0.0;  // above the top
  for (std::size_t b = 0; b < set.given.size(); ++b)
    if (!set.motions[b].moves())
      rows =
          std::max(rows, std::ceil((solids::bounds_of<D>(set.given[b]).high[1] - lattice.length[1]) / set.spacing()));
  lattice.length[1] += std::min(rows * set.spacing(), lattice.length[1]);
  return lattice;
}

// Wall particles of the bodies, and their markers.
template <int D>
void set_up_bodies(bodies<D>& set, bool no_slip) {
  if (set.given.empty()) return;
  auto& walls = set.state.walls.bodies;
  walls.no_slip = no_slip;
  const auto lattice = lattice_of_resting(set);
  walls.numbers = places_of(lattice);
  set_up_moving(set);
  set.all = solids::joined(set.given);
  set.solid = solid_with(set, [](const auto& b) { return b.now; });
  std::vector<solids::body<D>> resting;
  std::vector<std::size_t> number;
  for (std::size_t b = 0; b < set.given.size(); ++b)
    if (set.mover_of[b] == moving_body<D>::none) {
      resting.push_back(set.given[b]);
      number.push_back(b);
    }
  number.push_back(set.given.size());  // the tank, whose wall particles lie outside the box
  set.solid_at_rest = solid_of(set.in_box, resting);
  resting.push_back(tank_of(set.in_box));
  place_walls(set.state, resting, number, lattice, set.fitted);
  set.resting = walls.places.size();
}

}  // namespace tetsuame::rigid
