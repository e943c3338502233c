// The cells that hold a particle, where these are few of those in the box around all particles: a tree with a level for
// each axis, whose leaves are the cells in their order. Its memory goes with the number of these cells, however far
// apart they are, and a row of cells is found in it about as fast as in an array of all.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <foundation/threads.hpp>
#include <utility>
#include <vector>

namespace tetsuame::cells {

template <int D>
using index = std::array<std::int64_t, D>;

// Of a cell that is not stored.
inline constexpr std::size_t no_cell = SIZE_MAX;

// A node of level a stands for the cells that share their indices along the axes up to a. Nodes of a level are numbered
// in their order; those of one parent whose indices follow each other are a run. Runs go over small gaps, whose nodes
// are empty.
template <int D>
class sparse_cells {
 public:
  // Of cells in ascending order.
  void append(const index<D>& c) {
    const bool first = leaves() == 0;
    std::size_t a = 0;
    while (!first && a < D && c[a] == last_[a]) ++a;
    if (a == D) return;
    for (bool beside_last = !first; a < D; ++a, beside_last = false) {
      const std::int64_t gap = beside_last ? c[a] - last_[a] - 1 : largest_gap + 1;
      if (gap > largest_gap) levels_[a].runs.push_back({c[a], levels_[a].nodes});
      const std::uint32_t more = gap > largest_gap ? 1U : static_cast<std::uint32_t>(gap) + 1U;
      levels_[a].nodes += more;
      if (a + 1 < D) {
        auto& below = levels_[a + 1];
        below.first_run.resize(below.first_run.size() + more, static_cast<std::uint32_t>(below.runs.size()));
      }
    }
    last_ = c;
  }
  // After the last one; before anything is looked up.
  void finish() {
    levels_[0].first_run = {0};
    for (auto& level : levels_) {
      level.first_run.push_back(static_cast<std::uint32_t>(level.runs.size()));
      level.runs.push_back({0, level.nodes});
      level.runs.shrink_to_fit();
      level.first_run.shrink_to_fit();
    }
  }

  std::size_t leaves() const { return levels_[D - 1].nodes; }

  // f(index, node) for the nodes of level a, children of this parent, with an index from `from` to `to`. The parent of
  // level 0 is 0.
  template <class F>
  void for_each(std::size_t a, std::size_t parent, std::int64_t from, std::int64_t to, F&& f) const {
    const auto& level = levels_[a];
    const run* const end = level.runs.data() + level.first_run[parent + 1];
    for (const run* r = level.first_reaching(parent, from); r != end && r->first <= to; ++r) {
      const std::int64_t last = std::min(to, r->last());
      for (std::int64_t c = std::max(from, r->first); c <= last; ++c) f(c, r->node(c));
    }
  }
  // The leaves [first, second) of a parent with an index from `from` to `to`.
  std::pair<std::size_t, std::size_t> leaves_between(std::size_t parent, std::int64_t from, std::int64_t to) const {
    const auto& level = levels_[D - 1];
    const run* const end = level.runs.data() + level.first_run[parent + 1];
    const run* r = level.first_reaching(parent, from);
    if (r == end || r->first > to) return {0, 0};
    const std::size_t first = r->node(std::max(from, r->first));
    if (end - r > 1) r = std::partition_point(r + 1, end, [&](const run& other) { return other.first <= to; }) - 1;
    return {first, r->node(std::min(to, r->last())) + 1};
  }
  // The leaf of a cell; no_cell where it is not stored.
  std::size_t find(const index<D>& c) const {
    std::size_t node = 0;
    for (std::size_t a = 0; a < D; ++a) {
      const auto& level = levels_[a];
      const run* const r = level.first_reaching(node, c[a]);
      if (r == level.runs.data() + level.first_run[node + 1] || r->first > c[a]) return no_cell;
      node = r->node(c[a]);
    }
    return node;
  }

  std::size_t bytes() const {
    std::size_t all = 0;
    for (const auto& level : levels_)
      all += level.runs.capacity() * sizeof(run) + level.first_run.capacity() * sizeof(std::uint32_t);
    return all;
  }

 private:
  // A run takes as much memory as four leaves.
  static constexpr std::int64_t largest_gap = 3;

  // Behind it stands the next run of its level, of whatever parent, or the level's end.
  struct run {
    std::int64_t first;   // index
    std::uint32_t begin;  // its node

    std::size_t node(std::int64_t c) const { return begin + static_cast<std::size_t>(c - first); }
    std::int64_t last() const { return first + static_cast<std::int64_t>(this[1].begin - begin) - 1; }
  };
  struct nodes_of_level {
    std::vector<run> runs;                 // one more at the end
    std::vector<std::uint32_t> first_run;  // of each parent; one more at the end
    std::uint32_t nodes = 0;

    // The first of the parent's runs that does not end before this index; where there is none, the end of its runs.
    const run* first_reaching(std::size_t parent, std::int64_t from) const {
      const run* const first = runs.data() + first_run[parent];
      return std::partition_point(first, runs.data() + first_run[parent + 1],
                                  [&](const run& r) { return r.last() < from; });
    }
  };
  std::array<nodes_of_level, D> levels_;
  index<D> last_{};
};

namespace detail {

// Particles that follow each other in memory, [begin, end), and are in one cell.
template <int D>
struct particles_of_cell {
  index<D> cell;
  std::uint32_t begin, end;
};

// In a few instructions, where std::array's operator calls a function.
template <int D>
bool same_cell(const index<D>& a, const index<D>& b) {
  std::int64_t different = 0;
  for (std::size_t n = 0; n < D; ++n) different |= a[n] ^ b[n];
  return different == 0;
}

// Of particles [0, n), cell_of(i) each. Particles that were sorted some time ago are few stretches.
template <int D, class CellOf>
std::vector<particles_of_cell<D>> stretches_of(std::size_t n, const CellOf& cell_of) {
  using stretches = std::vector<particles_of_cell<D>>;
  std::vector<stretches> made(static_cast<std::size_t>(omp_get_max_threads()));
#pragma omp parallel if (n > foundation::values_worth_threads)
  {
    const auto threads = static_cast<std::size_t>(omp_get_num_threads()),
               thread = static_cast<std::size_t>(omp_get_thread_num());
    const std::size_t first = n * thread / threads, last = n * (thread + 1) / threads;
    stretches own;
    own.reserve((last - first) / 4);
    for (std::size_t i = first; i < last; ++i) {
      const index<D> c = cell_of(i);
      if (i == first || !same_cell<D>(own.back().cell, c))
        own.push_back({c, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(i + 1)});
      else
        ++own.back().end;
    }
    made[thread] = std::move(own);
  }
  stretches all = std::move(made.front());
  for (std::size_t t = 1; t < made.size(); ++t) all.insert(all.end(), made[t].begin(), made[t].end());
  return all;
}

// In the order of cells, all of which are in the box that begins at `first`; of one cell in the order in which they
// were: a radix sort from the last axis to the first.
template <int D>
void sort_by_cell(std::vector<particles_of_cell<D>>& all, const index<D>& first, const index<D>& extent) {
  const auto before = [](const auto& a, const auto& b) { return a.cell < b.cell; };
  if (std::is_sorted(all.begin(), all.end(), before)) return;
  constexpr int bits = 11;
  constexpr std::uint64_t digits = std::uint64_t{1} << bits;
  std::vector<particles_of_cell<D>> sorted(all.size());
  for (std::size_t a = D; a-- > 0;)
    for (int shift = 0; shift < 64 && static_cast<std::uint64_t>(extent[a] - 1) >> shift != 0; shift += bits) {
      std::array<std::uint32_t, digits + 1> next{};
      const auto digit = [&](const auto& s) {
        return static_cast<std::uint64_t>(s.cell[a] - first[a]) >> shift & (digits - 1);
      };
      for (const auto& s : all) ++next[digit(s) + 1];
      for (std::size_t d = 0; d < digits; ++d) next[d + 1] += next[d];
      for (const auto& s : all) sorted[next[digit(s)]++] = s;
      std::swap(all, sorted);
    }
}

}  // namespace detail

}  // namespace tetsuame::cells
