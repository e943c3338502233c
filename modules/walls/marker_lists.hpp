// Which wall particles the fluid reads, and lists of the fluid near their markers.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cells/grid.hpp>
#include <cmath>
#include <foundation/threads.hpp>
#include <foundation/unfilled.hpp>
#include <limits>
#include <mutex>
#include <walls/turned.hpp>
#include <walls/wall_set.hpp>

namespace tetsuame::walls::detail {

// m, how far a wall particle is from fluid that is nowhere nearer to its walls than so far.
template <int D>
double least_distance(const particles::particles<D>& s, const wall_set<D>& set, std::size_t r,
                      const std::vector<double>& nearest) {
  double sum = 0.0;
  for (std::size_t k = 0; k < set.sides.size(); ++k) {
    if ((set.mirrored[r] >> k & 1U) == 0) continue;
    const double along = nearest[k] - set.sides[k].distance(s.x[set.sides[k].axis][s.first_wall() + r]);
    sum += along * along;
  }
  return std::sqrt(sum);
}

// m, how near the fluid, ghosts included, comes to each side, from within.
template <int D>
std::vector<double> nearest_to_sides(const particles::particles<D>& s, const wall_set<D>& set) {
  std::vector<double> nearest;
  std::mutex one_at_a_time;
  for (const auto& wall : set.sides) {
    double least = std::numeric_limits<double>::max();
    foundation::for_chunks(s.first_wall(), 4096, s.first_wall() > foundation::values_worth_threads,
                           [&](std::size_t first, std::size_t last) {
                             double mine = std::numeric_limits<double>::max();
                             for (std::size_t i = first; i < last; ++i)
                               mine = std::min(mine, wall.distance(s.x[wall.axis][i]));
                             const std::lock_guard lock(one_at_a_time);
                             least = std::min(least, mine);
                           });
    nearest.push_back(std::max(0.0, least));
  }
  return nearest;
}

// Of each wall particle of this rank: whether fluid, owned or ghost, may be nearer to it than `reach`. What is as near
// to the wall particle is as near to its marker, and so among this rank's ghosts at least. Those whom a lattice would
// come near count as read, without a search.
template <int D>
std::vector<char> find_read(const particles::particles<D>& s, const wall_set<D>& set, const cells::grid<D>& grid,
                            double reach, double dx) {
  const std::vector<double> nearest = nearest_to_sides(s, set), lattice(set.sides.size(), dx);
  std::vector<char> read(s.walls, 0);
  const auto find = [&](std::size_t r) {
    read[r] = least_distance(s, set, r, lattice) < reach ? 1 : 0;
    if (read[r] != 0 || least_distance(s, set, r, nearest) > reach * (1.0 + 1e-9)) return;
    const auto x = cells::position<D>(s.x, s.first_wall() + r);
    cells::for_each_near<D>(grid, x, x, reach, [&](std::uint32_t k, std::uint64_t near) {
      for (; near != 0; near &= near - 1)
        if (grid.members[k + static_cast<std::uint32_t>(std::countr_zero(near))] < s.first_wall()) read[r] = 1;
    });
  };
  constexpr std::size_t chunk = 64;  // wall particles
  foundation::for_chunks(s.walls, chunk, s.walls > foundation::rows_worth_threads,
                         [&](std::size_t first, std::size_t last) {
                           for (std::size_t r = first; r < last; ++r) find(r);
                         });
  return read;
}

// `listed`: all that some marker sees; from then on the list counts in it. Rows were filled up with `null`.
inline void count_in_listed(marker_rows& rows, std::size_t null) {
  constexpr std::uint32_t unseen = 0xffffffff;
  foundation::unfilled<std::uint32_t> place(null + 1);
  foundation::for_all(place.size(), [&](std::size_t i) { place[i] = unseen; });
  place[null] = 0;
  auto& near = rows.near.all;
  // Threads that see the same particle write the same.
  foundation::for_all(near.size(), [&](std::size_t k) {
    std::atomic_ref<std::uint32_t>(place[near[k]]).store(0, std::memory_order_relaxed);
  });
  rows.listed =
      foundation::indices_where<std::uint32_t>(place.size(), [&](std::size_t i) { return place[i] != unseen; });
  foundation::for_all(rows.listed.size(),
                      [&](std::size_t n) { place[rows.listed[n]] = static_cast<std::uint32_t>(n); });
  foundation::for_all(near.size(), [&](std::size_t k) { near[k] = place[near[k]]; });
}

// m, the depth below a wall, or more where otherwise clusters would stand partly within it: these cost as much as whole
// ones, and would be summed over once more for their other members. Cells have an edge of two spacings, and particles
// of a row of cells are sorted along the last axis.
template <int D>
double to_whole_clusters(double depth, const side<D>& wall, double dx) {
  const double length = dx * (wall.axis + 1 == D ? std::max(2.0, static_cast<double>(lanes >> (D - 1))) : 2.0);
  const double end = wall.position + wall.inward * depth, cluster = std::floor(end / length) * length;
  const double within = wall.inward > 0.0 ? end - cluster : cluster + length - end;
  return within > 0.5 * dx ? depth + length - within : depth;
}

// The owned fluid that one of these markers, on whichever rank, may see until it has moved so far (m), and all that may
// see a wall particle; without some that is known. Collective.
template <int D>
pairs::row_subset choose_near_wall(const pairs::workspace<D>& w, const wall_set<D>& set,
                                   const std::vector<std::uint32_t>& markers, double moved,
                                   const std::vector<std::size_t>& without) {
  const auto& s = w.s;
  double depth = 0.0;
  for (const std::uint32_t r : markers)
    for (std::size_t k = 0; k < set.sides.size(); ++k)
      if ((set.mirrored[r] >> k & 1U) != 0)
        depth = std::max(depth, set.sides[k].distance(set.marker[set.sides[k].axis][r]));
  depth = std::max(w.d.ranks.maximum(depth) + set.reach, w.support()) + moved;
  std::vector<double> depths;
  for (const auto& wall : set.sides) depths.push_back(to_whole_clusters(depth, wall, w.dx));
  auto near = foundation::indices_where<std::size_t>(s.fluid, [&](std::size_t i) {
    for (std::size_t k = 0; k < depths.size(); ++k)
      if (set.sides[k].distance(s.x[set.sides[k].axis][i]) < depths[k]) return true;
    return false;
  });
  std::erase_if(near, [&](std::size_t i) { return std::binary_search(without.begin(), without.end(), i); });
  return pairs::choose(w.list, std::move(near), s.total());
}

// Lists of the fluid near some markers, valid until it has moved so far (m), and of what fluid that may be, without
// some that is known. Collective.
template <int D>
void list_fluid(const pairs::workspace<D>& w, const wall_set<D>& set, const cells::grid<D>& grid, double moved,
                marker_rows& rows, const std::vector<std::size_t>& known = {}) {
  const auto& s = w.s;
  cells::make_list_of_points<D>(
      rows.near, grid, rows.of.size(), set.reach + moved, static_cast<std::uint32_t>(s.null()),
      w.single_pairs() ? foundation::single::size() : lanes,
      [&](std::size_t k) { return cells::position<D>(set.marker, rows.of[k]); },
      [&](std::uint32_t j) { return j < s.first_wall(); });
  count_in_listed(rows, s.null());
  if (w.single_pairs())
    rows.phi.singles.resize(rows.near.all.size());
  else
    rows.phi.doubles.resize(rows.near.all.size());
  rows.scale.assign(rows.of.size(), 1.0);
  rows.near_wall = choose_near_wall(w, set, rows.of, moved, known);
}

// Which wall particles the fluid near the walls has for neighbours, and what fluid stands apart.
template <int D>
void list_walls(const pairs::workspace<D>& w, wall_set<D>& set) {
  const std::size_t first_wall = w.s.first_wall();
  std::vector<char> near(w.list.rows(), 0);
  for (const auto& m : set.read.near_wall.of_rows) near[m.first / lanes] = 1;
  std::vector<std::uint32_t> lanes_near_walls(near.size(), 0);
  set.wall_neighbours.interleave = w.list.interleave;
  cells::make_rows(set.wall_neighbours, near.size(),
                   [&, row = cells::row_of_clusters()](std::size_t r, auto& made) mutable {
                     std::size_t pairs = 0;
                     lanes_near_walls[r] = 0;
                     if (near[r] != 0)
                       w.list.for_each(r, [&](std::uint32_t j, std::uint32_t of_lanes, std::size_t sequence) {
                         if (j < first_wall) return;
                         row.add(sequence, j, of_lanes);
                         lanes_near_walls[r] |= of_lanes;
                         pairs += static_cast<std::size_t>(std::popcount(of_lanes));
                       });
                     row.write(w.list.interleave, made);
                     return pairs;
                   });
  std::vector<std::size_t> rows;
  for (std::size_t r = 0; r < lanes_near_walls.size(); ++r)
    for (std::uint32_t left = lanes_near_walls[r]; left != 0; left &= left - 1)
      rows.push_back(r * lanes + static_cast<std::size_t>(std::countr_zero(left)));
  set.rows_near_walls = pairs::choose(set.wall_neighbours, std::move(rows), w.s.total());
  set.interior_apart = {w.interior(), set.read.near_wall};
  set.border_apart = {w.at_border(), set.read.near_wall};
}

// With new lists of the fluid: which wall particles these read, and what fluid is near their markers. Collective.
template <int D>
void prepare_markers(pairs::workspace<D>& w, wall_set<D>& set, const cells::grid<D>& grid, double skin) {
  auto& s = w.s;
  set.reach = radius_factor(set.how) * w.support();
  set.declare_fields(s);
  particles::clear_derived(s);
  set.clear_rows(s.walls);
  // Repulsion acts on all fluid near a wall, whichever of the markers are read.
  const bool all = set.how.treatment == "repulsion";
  // Lists end when some fluid has moved half the skin. Markers and wall particles do not move.
  const double moved = 0.5 * skin;
  const auto is_read = all ? std::vector<char>(s.walls, 1) : find_read(s, set, grid, w.support() + moved, w.dx);
  set.unread.reset();
  set.read.of.clear();
  for (std::size_t r = 0; r < s.walls; ++r)
    if (is_read[r] != 0) set.read.of.push_back(static_cast<std::uint32_t>(r));
  list_fluid(w, set, grid, moved, set.read);
  list_walls(w, set);
}

// The other markers, for this evaluation alone. Collective.
template <int D>
void find_unread(const pairs::workspace<D>& w, wall_set<D>& set) {
  const auto& s = w.s;
  set.unread.emplace();
  std::size_t next = 0;
  for (std::uint32_t r = 0; r < s.walls; ++r)
    if (next < set.read.of.size() && set.read.of[next] == r)
      ++next;
    else
      set.unread->of.push_back(r);
  const auto grid = cells::make_grid<D>(s.x, s.id, s.first_wall(), cells::cell_edge(w.dx));
  list_fluid(w, set, grid, 0.0, *set.unread, set.read.near_wall.rows);
}

// f(marker_rows) for those of this evaluation.
template <int D, class F>
void for_all_rows(wall_set<D>& set, F&& f) {
  f(set.read);
  if (set.unread) f(*set.unread);
}

}  // namespace tetsuame::walls::detail
