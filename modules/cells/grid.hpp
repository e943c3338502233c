// Linked cells as sorted cells: the particles of a cell stand together, and a row of cells along the last axis is one
// range of memory, in which particles are sorted along that axis; where they are level, along those before it. A
// particle and its image may have the same ID.
//
// Cells are anchored at the origin of the domain, not of the rank, and ordered along
// the axes: which neighbours a particle has, and in which order they are summed, does
// not depend on the decomposition.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
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

template <int D>
using index = std::array<std::int64_t, D>;

// Local indices of particles, large arrays that are written at once.
using indices = foundation::unfilled<std::uint32_t>;

// Of a cell that holds no particle.
inline constexpr std::size_t no_cell = SIZE_MAX;

namespace detail {

// Finds the number of a 64-bit key: an open-addressing hash table.
class key_table {
 public:
  // Room for n keys.
  explicit key_table(std::size_t n = 0) : slots_(std::bit_ceil(2 * n + 2), {0, empty}) {}

  const std::uint32_t* find(std::uint64_t key) const {
    const auto& s = slots_[slot(key)];
    return s.number == empty ? nullptr : &s.number;
  }
  // Its number, which is `number` where the key is new.
  std::uint32_t insert(std::uint64_t key, std::uint32_t number) {
    auto& s = slots_[slot(key)];
    if (s.number == empty) s = {key, number};
    return s.number;
  }

 private:
  static constexpr std::uint32_t empty = UINT32_MAX;
  struct entry {
    std::uint64_t key;
    std::uint32_t number;
  };
  std::size_t slot(std::uint64_t key) const {
    std::size_t at = key * 0x9e3779b97f4a7c15U >> 20 & (slots_.size() - 1);
    while (slots_[at].number != empty && slots_[at].key != key) at = (at + 1) & (slots_.size() - 1);
    return at;
  }
  std::vector<entry> slots_;
};

}  // namespace detail

// The cells are stored densely, all those of the bounding box of the particles, where these are not many more than
// particles; else sparsely, those that hold a particle. The order of the particles is the same.
template <int D>
struct grid {
  double size = 0.0;                 // m, edge of a cell
  index<D> first{}, extent{};        // of the bounding box of the cells that hold a particle
  std::vector<std::uint32_t> start;  // per stored cell, into `members`; one more at the end
  indices members;                   // local particle indices, by cell, there along the last axis, then ID
  // m, their positions; behind the last of them a register's worth far away, so that lanes may read on
  std::array<foundation::unfilled<double>, D> sorted;

  // Of a sparse grid: the key of each stored cell, ascending. A column is a row of cells along the last axis that holds
  // a particle; the stored cells of column k are [columns[k], columns[k + 1]).
  bool sparse = false;
  std::vector<std::uint64_t> keys;
  std::vector<std::uint32_t> columns;
  detail::key_table column_of;

  index<D> cell(const std::array<double, D>& x) const {
    index<D> c;
    for (std::size_t a = 0; a < D; ++a) c[a] = static_cast<std::int64_t>(std::floor(x[a] / size));
    return c;
  }
  // Ascending in the order of cells; of a cell in the bounding box.
  std::uint64_t key(const index<D>& c) const {
    std::uint64_t n = 0;
    for (std::size_t a = 0; a < D; ++a)
      n = n * static_cast<std::uint64_t>(extent[a]) + static_cast<std::uint64_t>(c[a] - first[a]);
    return n;
  }
  // The cell of a key.
  index<D> cell_of_key(std::uint64_t n) const {
    index<D> c;
    for (std::size_t a = D; a-- > 0;) {
      const auto width = static_cast<std::uint64_t>(extent[a]);
      c[a] = first[a] + static_cast<std::int64_t>(n % width);
      n /= width;
    }
    return c;
  }

  std::size_t cells() const { return start.size() - 1; }  // stored
  std::uint64_t key_of(std::size_t stored) const { return sparse ? keys[stored] : stored; }
  // Where a cell is stored; no_cell where it is not.
  std::size_t stored(const index<D>& c) const {
    for (std::size_t a = 0; a < D; ++a)
      if (c[a] < first[a] || c[a] >= first[a] + extent[a]) return no_cell;
    if (!sparse) return key(c);
    const auto found = std::lower_bound(keys.begin(), keys.end(), key(c));
    return found == keys.end() || *found != key(c) ? no_cell : static_cast<std::size_t>(found - keys.begin());
  }
  // The members [first, second) of the cells from c to that with the index `to` along the last axis, both in the
  // bounding box.
  std::pair<std::uint32_t, std::uint32_t> members_in_row(const index<D>& c, std::int64_t to) const {
    const std::uint64_t from = key(c), end = from + static_cast<std::uint64_t>(to - c[D - 1]) + 1;
    if (!sparse) return {start[from], start[end]};
    const auto* column = column_of.find(from / static_cast<std::uint64_t>(extent[D - 1]));
    if (column == nullptr) return {0, 0};
    const auto at = [&](std::size_t k) { return keys.begin() + static_cast<std::ptrdiff_t>(k); };
    const auto low = std::lower_bound(at(columns[*column]), at(columns[*column + 1]), from);
    const auto high = std::lower_bound(low, at(columns[*column + 1]), end);
    return {start[static_cast<std::size_t>(low - keys.begin())], start[static_cast<std::size_t>(high - keys.begin())]};
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

// Cells of the bounding box, which are no more than 64 bits can number.
template <int D>
std::uint64_t cells_of_box(const index<D>& extent) {
  std::uint64_t cells = 1;
  for (const std::int64_t width : extent)
    if (width <= 0 || __builtin_mul_overflow(cells, static_cast<std::uint64_t>(width), &cells))
      foundation::fail_calculation(
          "particles lie so far apart that 64 bits cannot number the cells of the neighbour search between them: a "
          "particle has left all others behind, or the spacing is too small for the box");
  return cells;
}

// Numbers the cells that hold a particle, in their order, and writes the number of each particle's.
template <int D>
void number_occupied_cells(grid<D>& g, const std::array<particles::array, D>& x, indices& cell_of) {
  const std::size_t n = cell_of.size();
  std::vector<std::uint64_t> key(n);
  foundation::for_all(n, [&](std::size_t i) { key[i] = g.key(g.cell(particles::position<D>(x, i))); });
  // By first appearance: particles that follow each other in memory are often in one cell.
  key_table numbers(n);
  for (std::size_t i = 0; i < n; ++i) {
    cell_of[i] = i > 0 && key[i] == key[i - 1] ? cell_of[i - 1]
                                               : numbers.insert(key[i], static_cast<std::uint32_t>(g.keys.size()));
    if (cell_of[i] == g.keys.size()) g.keys.push_back(key[i]);
  }
  std::vector<std::uint32_t> order(g.keys.size()), place(g.keys.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return g.keys[a] < g.keys[b]; });
  for (std::size_t k = 0; k < order.size(); ++k) place[order[k]] = static_cast<std::uint32_t>(k);
  std::sort(g.keys.begin(), g.keys.end());
  foundation::for_all(n, [&](std::size_t i) { cell_of[i] = place[cell_of[i]]; });
  const auto width = static_cast<std::uint64_t>(g.extent[D - 1]);
  for (std::size_t k = 0; k < g.keys.size(); ++k)
    if (k == 0 || g.keys[k] / width != g.keys[k - 1] / width) g.columns.push_back(static_cast<std::uint32_t>(k));
  g.column_of = key_table(g.columns.size());
  for (std::size_t k = 0; k < g.columns.size(); ++k)
    g.column_of.insert(g.keys[g.columns[k]] / width, static_cast<std::uint32_t>(k));
  g.columns.push_back(static_cast<std::uint32_t>(g.keys.size()));
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

// `start` and `members`, these in no order within a cell. Returns the number of stored cells.
template <int D>
std::size_t store_cells(grid<D>& g, const std::array<particles::array, D>& x, std::size_t n) {
  // A full box has a cell for 4 or 8 particles; one that is filled to a tenth is still faster with all of its cells.
  const std::uint64_t all = n > 0 ? cells_of_box<D>(g.extent) : 0, worth_storing = 8 * n + 4096;
  g.sparse = all > worth_storing;
  indices cell_of(n);
  if (g.sparse)
    number_occupied_cells<D>(g, x, cell_of);
  else
    foundation::for_all(n, [&](std::size_t i) {
      cell_of[i] = static_cast<std::uint32_t>(g.key(g.cell(particles::position<D>(x, i))));
    });
  g.start.assign((g.sparse ? g.keys.size() : all) + 1, 0);
  g.members.resize(n);
  sort_by_cell(cell_of, g.start, g.members);
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
    g.first[a] = static_cast<std::int64_t>(std::floor(low[a] / size));
    last[a] = static_cast<std::int64_t>(std::floor(high[a] / size));
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
  const auto visit_row = [&](index<D> c, double left2) {
    const auto [from, to] = along(D - 1, std::sqrt(left2) * rounding);
    if (from > to) return;
    c[D - 1] = from;
    const auto [begin, end] = g.members_in_row(c, to);
    if (begin != end) f(begin, end);
  };
  // Columns one by one where they are fewer than those that the box would meet if all were there.
  if (g.sparse) {
    double met = 1.0;
    for (std::size_t a = 0; a + 1 < D; ++a) {
      const auto [from, to] = along(a, std::sqrt(reach2) * rounding);
      met *= static_cast<double>(std::max<std::int64_t>(to - from + 1, 0));
    }
    if (met > static_cast<double>(g.columns.size())) {
      for (std::size_t k = 0; k + 1 < g.columns.size(); ++k) {
        const index<D> c = g.cell_of_key(g.keys[g.columns[k]]);
        double left = reach2;
        for (std::size_t a = 0; a + 1 < D; ++a) left -= gap2(a, c[a]);
        if (left > 0.0) visit_row(c, left);
      }
      return;
    }
  }
  const auto descend = [&](const auto& self, std::size_t a, index<D> c, double left2) -> void {
    if (a + 1 == D) return visit_row(c, left2);
    const auto [from, to] = along(a, std::sqrt(left2) * rounding);
    for (c[a] = from; c[a] <= to; ++c[a])
      if (const double left = left2 - gap2(a, c[a]); left > 0.0) self(self, a + 1, c, left);
  };
  descend(descend, 0, index<D>{}, reach2);
}

// f(k, near) for up to 64 `members` from k on, in the order of the grid: bit n of `near` is set where member k + n is
// nearer to the box from `low` to `high` than `reach`, a rounding more or less. Not called where none is.
template <int D, class F>
void for_each_near(const grid<D>& g, const std::array<double, D>& low, const std::array<double, D>& high, double reach,
                   F&& f) {
  using foundation::lanes, foundation::real, foundation::greater;
  const real reach2(reach * reach * (1.0 + 1e-12));
  for_each_stretch<D>(g, low, high, reach, [&](std::uint32_t first, std::uint32_t last) {
    for (std::uint32_t k = first; k < last; k += 64) {
      const std::uint32_t n = std::min(last - k, 64U);
      std::uint64_t near = 0;
      for (std::uint32_t c = 0; c < n; c += lanes) {
        real r2(0.0);
        for (std::size_t a = 0; a < D; ++a) {
          const real x(g.sorted[a].data() + k + c, std::experimental::element_aligned);
          const real gap = greater(greater(real(low[a] - x), real(x - high[a])), real(0.0));
          r2 += gap * gap;
        }
        near |= static_cast<std::uint64_t>(foundation::bits_of_less(r2, reach2)) << c;
      }
      near &= ~std::uint64_t{0} >> (64 - n);
      if (near != 0) f(k, near);
    }
  });
}

}  // namespace tetsuame::cells
