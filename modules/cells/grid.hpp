// Linked cells as sorted cells: the particles of a cell stand together, and a row of cells along the last axis is one
// range of memory, in which particles are sorted along that axis; where they are level, along those before it. A
// particle and its image may have the same ID.
//
// Cells are anchored at the origin of the domain, not of the rank, and ordered along
// the axes: which neighbours a particle has, and in which order they are summed, does
// not depend on the decomposition.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cells/sparse_cells.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <foundation/error.hpp>
#include <foundation/lanes.hpp>
#include <foundation/threads.hpp>
#include <foundation/unfilled.hpp>
#include <limits>
#include <mutex>
#include <numeric>
#include <particles/particles.hpp>
#include <utility>
#include <vector>

namespace tetsuame::cells {

// Local indices of particles, large arrays that are written at once.
using indices = foundation::unfilled<std::uint32_t>;

// The cells are stored densely, all those of the bounding box of the particles, where these are not many more than
// particles; else sparsely, those that hold a particle and some beside them. The order of the particles is the same.
template <int D>
struct grid {
  double size = 0.0;                 // m, edge of a cell
  index<D> first{}, extent{};        // of the bounding box of the cells that hold a particle
  std::vector<std::uint32_t> start;  // per stored cell, into `members`; one more at the end
  indices members;                   // local particle indices, by cell, there along the last axis, then ID
  // m, their positions; behind the last of them a register's worth far away, so that lanes may read on
  std::array<foundation::unfilled<double>, D> sorted;

  bool sparse = false;
  sparse_cells<D> tree;  // of a sparse grid: its leaves are the stored cells

  index<D> cell(const std::array<double, D>& x) const {
    index<D> c;
    for (std::size_t a = 0; a < D; ++a) c[a] = static_cast<std::int64_t>(std::floor(x[a] / size));
    return c;
  }
  // Of a dense grid: where a cell of the bounding box is stored.
  std::uint64_t key(const index<D>& c) const {
    std::uint64_t n = 0;
    for (std::size_t a = 0; a < D; ++a)
      n = n * static_cast<std::uint64_t>(extent[a]) + static_cast<std::uint64_t>(c[a] - first[a]);
    return n;
  }

  std::size_t cells() const { return start.size() - 1; }  // stored
  // Where a cell is stored; no_cell where it is not.
  std::size_t stored(const index<D>& c) const {
    if (sparse) return tree.find(c);
    for (std::size_t a = 0; a < D; ++a)
      if (c[a] < first[a] || c[a] >= first[a] + extent[a]) return no_cell;
    return key(c);
  }
  // A stored cell that holds a particle.
  index<D> cell_of_members(std::size_t at) const {
    std::array<double, D> x;
    for (std::size_t a = 0; a < D; ++a) x[a] = sorted[a][start[at]];
    return cell(x);
  }
  double bytes() const {
    std::size_t all = (start.capacity() + members.capacity()) * sizeof(std::uint32_t) + tree.bytes();
    for (const auto& component : sorted) all += component.capacity() * sizeof(double);
    return static_cast<double>(all);
  }
};

using particles::position;

// m, edge of the cells of particles with this spacing, sorted along the last axis: clusters of eight are then nearly as
// long as wide, so that their members have most neighbours in common.
inline double cell_edge(double spacing) { return 2.0 * spacing; }

namespace detail {

// `start`, of zeros, one more than cells, and `members`, in no order within a cell.
inline void sort_by_cell(const indices& cell_of, std::vector<std::uint32_t>& start, indices& members) {
  const std::size_t n = cell_of.size(), cells = start.size() - 1;
  const auto at = [&](std::size_t cell) { return std::atomic_ref<std::uint32_t>(start[cell]); };
  foundation::for_all(n, [&](std::size_t i) { at(cell_of[i]).fetch_add(1, std::memory_order_relaxed); });
  // The end of each cell's members, which are put there from the last one on: at last it is their begin.
  for (std::size_t c = 0; c < cells; ++c) start[c + 1] += start[c];
  foundation::for_all(n, [&](std::size_t i) {
    members[at(cell_of[i]).fetch_sub(1, std::memory_order_relaxed) - 1] = static_cast<std::uint32_t>(i);
  });
}

// Cells of the bounding box, no more than 64 bits number.
template <int D>
std::uint64_t cells_of_box(const index<D>& extent) {
  std::uint64_t cells = 1;
  for (const std::int64_t width : extent)
    if (__builtin_mul_overflow(cells, static_cast<std::uint64_t>(width), &cells)) return UINT64_MAX;
  return cells;
}

// The index of the cell that a coordinate (m) is in.
inline std::int64_t index_along(double x, double size) {
  constexpr double most = 0x1p61;  // so that differences are numbers, too
  const double c = std::floor(x / size);
  if (!(std::abs(c) < most))
    foundation::fail_calculation(fmt::format(
        "a particle is at {:.3g} m, so far away that 64 bits cannot number the cells of the neighbour search, {:.3g} m "
        "wide, up to there: it has left all others behind, or the spacing is too small for the box",
        x, size));
  return static_cast<std::int64_t>(c);
}

// The least and the largest coordinates.
template <int D>
std::pair<std::array<double, D>, std::array<double, D>> bounding_box(const std::array<particles::array, D>& x,
                                                                     std::size_t n) {
  std::array<double, D> low, high;
  low.fill(std::numeric_limits<double>::infinity());
  high.fill(-std::numeric_limits<double>::infinity());
  std::mutex one_at_a_time;
  foundation::for_chunks(n, 4096, n > foundation::values_worth_threads, [&](std::size_t first, std::size_t last) {
    std::array<double, D> least, most;
    for (std::size_t a = 0; a < D; ++a) {
      least[a] = most[a] = x[a][first];
      for (std::size_t i = first; i < last; ++i) {
        least[a] = std::min(least[a], x[a][i]);
        most[a] = std::max(most[a], x[a][i]);
      }
    }
    const std::lock_guard lock(one_at_a_time);
    for (std::size_t a = 0; a < D; ++a) {
      low[a] = std::min(low[a], least[a]);
      high[a] = std::max(high[a], most[a]);
    }
  });
  return {low, high};
}

// `start` and `members`, these in no order within a cell, of the cells that hold a particle.
template <int D>
void store_sparsely(grid<D>& g, const std::array<particles::array, D>& x, std::size_t n) {
  auto all = stretches_of<D>(n, [&](std::size_t i) { return g.cell(particles::position<D>(x, i)); });
  sort_by_cell<D>(all, g.first, g.extent);
  g.members.resize(n);
  std::uint32_t at = 0;
  for (const auto& s : all) {
    g.tree.append(s.cell);
    g.start.resize(g.tree.leaves(), at);
    std::iota(g.members.begin() + at, g.members.begin() + at + (s.end - s.begin), s.begin);
    at += s.end - s.begin;
  }
  g.start.push_back(at);
  g.start.shrink_to_fit();
  g.tree.finish();
}

// The same of all cells of the bounding box.
template <int D>
void store_densely(grid<D>& g, const std::array<particles::array, D>& x, std::size_t n, std::uint64_t cells) {
  indices cell_of(n);
  foundation::for_all(
      n, [&](std::size_t i) { cell_of[i] = static_cast<std::uint32_t>(g.key(g.cell(particles::position<D>(x, i)))); });
  g.start.assign(cells + 1, 0);
  g.members.resize(n);
  sort_by_cell(cell_of, g.start, g.members);
}

// Returns the number of stored cells.
template <int D>
std::size_t store_cells(grid<D>& g, const std::array<particles::array, D>& x, std::size_t n) {
  // A full box has a cell for 4 or 8 particles; one that is filled to a tenth is still faster with all of its cells.
  const std::uint64_t all = n > 0 ? cells_of_box<D>(g.extent) : 0, worth_storing = 8 * n + 4096;
  g.sparse = all > worth_storing;
  if (g.sparse)
    store_sparsely<D>(g, x, n);
  else
    store_densely<D>(g, x, n, all);
  return g.cells();
}

}  // namespace detail

// Sorts particles [0, n) into cells of the given edge.
template <int D>
grid<D> make_grid(const std::array<particles::array, D>& x, const std::vector<std::int64_t>& id, std::size_t n,
                  double size) {
  grid<D> g;
  g.size = size;
  index<D> last;
  g.first.fill(INT64_MAX);
  last.fill(INT64_MIN);
  const auto [low, high] = detail::bounding_box<D>(x, n);
  for (std::size_t a = 0; a < D && n > 0; ++a) {
    g.first[a] = detail::index_along(low[a], size);
    last[a] = detail::index_along(high[a], size);
  }
  for (std::size_t a = 0; a < D && n > 0; ++a) g.extent[a] = last[a] - g.first[a] + 1;
  const std::size_t cells = detail::store_cells<D>(g, x, n);
  for (auto& component : g.sorted) component.resize(n + foundation::lanes);
  const auto sort_cell = [&](std::size_t c) {
    std::sort(g.members.begin() + g.start[c], g.members.begin() + g.start[c + 1],
              [&](std::uint32_t i, std::uint32_t j) {
                for (std::size_t a = D; a-- > 0;)
                  if (x[a][i] != x[a][j]) return x[a][i] < x[a][j];
                return id[i] < id[j];
              });
    for (std::uint32_t k = g.start[c]; k < g.start[c + 1]; ++k)
      for (std::size_t a = 0; a < D; ++a) g.sorted[a][k] = x[a][g.members[k]];
  };
  constexpr std::size_t chunk = 256;  // cells
  foundation::for_chunks(cells, chunk, n > foundation::values_worth_threads, [&](std::size_t from, std::size_t to) {
    for (std::size_t c = from; c < to; ++c) sort_cell(c);
  });
  for (auto& component : g.sorted) std::fill_n(component.end() - foundation::lanes, foundation::lanes, 1e60);
  return g;
}

// f(first, last) for every range of `members` in the cells that are within `reach` of the box from `low` to `high`,
// in the order of cells.
template <int D, class F>
void for_each_stretch(const grid<D>& g, const std::array<double, D>& low, const std::array<double, D>& high,
                      double reach, F&& f) {
  if (g.members.empty()) return;
  constexpr double rounding = 1.0 + 1e-9;  // of what decides which cells are met: rather one more than one too few
  const double reach2 = reach * reach * rounding;
  // Along each axis but the last, the cells met and the squared distance from the box to each of them.
  const auto cell_at = [&](double x) { return static_cast<std::int64_t>(std::floor(x / g.size)); };
  const auto gap2 = [&](std::size_t a, std::int64_t c) {
    const double edge = static_cast<double>(c) * g.size, gap = std::max({edge - high[a], low[a] - edge - g.size, 0.0});
    return gap * gap;
  };
  const auto along = [&](std::size_t a, double half) {
    return std::pair{std::max(cell_at(low[a] - half), g.first[a]),
                     std::min(cell_at(high[a] + half), g.first[a] + g.extent[a] - 1)};
  };
  // The last axis' cells are one range.
  const auto row = [&](double left2) { return along(D - 1, std::sqrt(left2) * rounding); };
  const auto visit = [&](std::size_t from_cell, std::size_t to_cell) {
    const std::uint32_t begin = g.start[from_cell], end = g.start[to_cell];
    if (begin != end) f(begin, end);
  };
  if (g.sparse) {
    const auto descend = [&](const auto& self, std::size_t a, std::size_t parent, double left2) -> void {
      const auto [from, to] = a + 1 == D ? row(left2) : along(a, std::sqrt(left2) * rounding);
      if (a + 1 == D) {
        const auto [first, end] = g.tree.leaves_between(parent, from, to);
        return visit(first, end);
      }
      g.tree.for_each(a, parent, from, to, [&](std::int64_t c, std::size_t node) {
        if (const double left = left2 - gap2(a, c); left > 0.0) self(self, a + 1, node, left);
      });
    };
    return descend(descend, 0, 0, reach2);
  }
  const auto descend = [&](const auto& self, std::size_t a, index<D> c, double left2) -> void {
    if (a + 1 == D) {
      const auto [from, to] = row(left2);
      if (from > to) return;
      c[a] = from;
      const std::uint64_t first = g.key(c);
      return visit(first, first + static_cast<std::uint64_t>(to - from) + 1);
    }
    const auto [from, to] = along(a, std::sqrt(left2) * rounding);
    for (c[a] = from; c[a] <= to; ++c[a])
      if (const double left = left2 - gap2(a, c[a]); left > 0.0) self(self, a + 1, c, left);
  };
  descend(descend, 0, index<D>{}, reach2);
}

// Bit n is set where member k + n of `count`, at most 64, is nearer to the box from `low` to `high` than the root of
// `reach2` (m2).
template <int D>
std::uint64_t near_box(const grid<D>& g, std::uint32_t k, std::uint32_t count, const std::array<double, D>& low,
                       const std::array<double, D>& high, double reach2) {
  using foundation::lanes, foundation::real, foundation::greater;
  std::uint64_t near = 0;
  for (std::uint32_t c = 0; c < count; c += lanes) {
    real r2(0.0);
    for (std::size_t a = 0; a < D; ++a) {
      const real x(g.sorted[a].data() + k + c, std::experimental::element_aligned);
      const real gap = greater(greater(real(low[a] - x), real(x - high[a])), real(0.0));
      r2 += gap * gap;
    }
    near |= static_cast<std::uint64_t>(foundation::bits_of_less(r2, real(reach2))) << c;
  }
  return near & ~std::uint64_t{0} >> (64 - count);
}

// f(k, near) for up to 64 `members` from k on, in the order of the grid: bit n of `near` is set where member k + n is
// nearer to the box from `low` to `high` than `reach`, a rounding more or less. Not called where none is.
template <int D, class F>
void for_each_near(const grid<D>& g, const std::array<double, D>& low, const std::array<double, D>& high, double reach,
                   F&& f) {
  const double reach2 = reach * reach * (1.0 + 1e-12);
  for_each_stretch<D>(g, low, high, reach, [&](std::uint32_t first, std::uint32_t last) {
    for (std::uint32_t k = first; k < last; k += 64)
      if (const std::uint64_t near = near_box<D>(g, k, std::min(last - k, 64U), low, high, reach2); near != 0)
        f(k, near);
  });
}

}  // namespace tetsuame::cells
