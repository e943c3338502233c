// What this rank computes, place by place, and the cuts about it where the box is open: what a load balance goes by.
#pragma once

#include <algorithm>
#include <array>
#include <balance/balancer.hpp>
#include <limits>
#include <numeric>
#include <run/lists.hpp>
#include <utility>
#include <vector>

namespace tetsuame::run {

// Of a body's marker and fluid, beside one in a cluster: what goes by registers takes so much less (measured of water
// in the bowl: 58 ns a step, and 9.1 ns).
inline constexpr double pair_of_a_body = 6.0;

// Pairs that are evaluated: of the fluid's clusters, and of the walls' and the bodies' markers.
template <int D>
double pairs_of(const state<D>& box) {
  return static_cast<double>(box.w.list.all.size() * cells::neighbour_list::width + box.walls.read.near.all.size()) +
         pair_of_a_body * static_cast<double>(box.walls.bodies.near.all.size());
}

// Pairs of the fluid, and of markers.
template <int D>
struct load {
  std::array<double, D> x;  // m
  double cost;
};
template <int D>
std::vector<load<D>> loads_of(const state<D>& box) {
  std::vector<load<D>> all;
  for (std::size_t i = 0; i < box.w.s.fluid; ++i)
    all.push_back({cells::position<D>(box.w.s.x, i), static_cast<double>(box.w.list.row_of(i).size())});
  const auto& markers = box.walls.read;
  for (std::size_t k = 0; k < markers.near.rows(); ++k)
    all.push_back(
        {cells::position<D>(box.walls.marker, markers.of[k]), static_cast<double>(markers.near.row(k).size())});
  const auto& bodies = box.walls.bodies;
  for (std::size_t k = 0; k < bodies.near.rows(); ++k)
    all.push_back({bodies.places[k].marker, pair_of_a_body * static_cast<double>(bodies.near.row(k).size())});
  return all;
}

// Collective. m: between the two lies all of the loads along an axis but this part at either end, to a 256th of their
// distance.
template <int D>
std::pair<double, double> bulk_along(const domain::communicator& ranks, std::size_t axis,
                                     const std::vector<load<D>>& loads, double beyond) {
  constexpr std::size_t parts = 256, most_looks = 16;
  std::array<double, 2> ends{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const auto& l : loads) ends = {std::max(ends[0], -l.x[axis]), std::max(ends[1], l.x[axis])};
  ranks.maximum(ends);
  balance::window at{0, -ends[0], ends[1]};
  for (std::size_t look = 0; look < most_looks && at.lower < at.upper; ++look) {
    std::vector<double> along(parts, 0.0);
    for (const auto& l : loads) along[at.part(l.x[axis], parts)] += l.cost;
    ranks.sum(along);
    const double left_out = beyond * std::accumulate(along.begin(), along.end(), 0.0);
    std::size_t first = 0, last = parts;
    for (double sum = along[0]; first + 1 < last && sum <= left_out; sum += along[first]) ++first;
    for (double sum = along[last - 1]; first + 1 < last && sum <= left_out; sum += along[last - 1]) --last;
    const double width = (at.upper - at.lower) / static_cast<double>(parts);
    at = {0, at.lower + width * static_cast<double>(first), at.lower + width * static_cast<double>(last)};
    if (last - first > parts / 4) break;  // a closer look would tell little
  }
  return {at.lower, at.upper};
}

// Collective. The cuts as they are; where the box is open, the outermost ones lie about nearly all of the loads,
// however far particles have gone, so that the others can be placed between them.
template <int D>
balance::cuts<D> cuts_about(const state<D>& box, const std::vector<load<D>>& loads) {
  auto cuts = box.w.d.cuts;
  const auto& region = box.w.d.region;
  for (std::size_t a = 0; a < D; ++a) {
    const auto count = static_cast<std::size_t>(cuts.counts[a]);
    if (region.periodic[a] || count == 1 || !(region.open[a][0] || region.open[a][1])) continue;
    // Beyond stands less than a tenth of a slab's load.
    const auto [low, high] = bulk_along<D>(box.w.d.ranks, a, loads, 0.1 / static_cast<double>(count));
    if (!(low < high)) continue;
    for (std::size_t g = 0; g < cuts.groups(a); ++g) {
      double* c = cuts.group(a, g);
      if (region.open[a][0]) c[0] = std::min(low, c[1]);
      if (region.open[a][1]) c[count] = std::max(high, c[count - 1]);
    }
  }
  return cuts;
}

}  // namespace tetsuame::run
