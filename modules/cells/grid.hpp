// Linked cells as sorted cells: the particles of a cell stand together, by ID, and a
// row of cells along the last axis is one stretch of memory.
//
// Cells are anchored at the origin of the domain, not of the rank, and ordered along
// the axes: which neighbours a particle has, and in which order they are summed, does
// not depend on the decomposition.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <foundation/lanes.hpp>
#include <foundation/threads.hpp>
#include <limits>
#include <particles/particles.hpp>
#include <vector>

namespace tetsuame::cells {

template <int D>
using index = std::array<std::int64_t, D>;

template <int D>
struct grid {
  double size = 0.0;                   // m, edge of a cell
  index<D> first{}, extent{};          // of the cells that hold a particle
  std::vector<std::uint32_t> start;    // per cell, into `members`; one more at the end
  std::vector<std::uint32_t> members;  // local particle indices, by cell, then ID
  // m, their positions; behind the last of them a register's worth far away, so that lanes may read on
  std::array<particles::array, D> sorted;

  index<D> cell(const std::array<double, D>& x) const {
    index<D> c;
    for (std::size_t a = 0; a < D; ++a) c[a] = static_cast<std::int64_t>(std::floor(x[a] / size));
    return c;
  }
  std::size_t linear(const index<D>& c) const {
    std::size_t n = 0;
    for (std::size_t a = 0; a < D; ++a)
      n = n * static_cast<std::size_t>(extent[a]) + static_cast<std::size_t>(c[a] - first[a]);
    return n;
  }
};

template <int D>
std::array<double, D> position(const std::array<particles::array, D>& x, std::size_t i) {
  std::array<double, D> point;
  for (std::size_t a = 0; a < D; ++a) point[a] = x[a][i];
  return point;
}

// m, edge of the cells for neighbours within `reach`: small enough that a particle's neighbours are for the most part
// those of the one before it, and few beyond the reach are looked at.
template <int D>
double cell_edge(double reach) {
  return reach / (D == 3 ? 3.0 : 2.0);
}

// Sorts particles [0, n) into cells of the given edge.
template <int D>
grid<D> make_grid(const std::array<particles::array, D>& x, const std::vector<std::int64_t>& id, std::size_t n,
                  double size) {
  using foundation::values_worth_threads;
  grid<D> g;
  g.size = size;
  index<D> last;
  g.first.fill(INT64_MAX);
  last.fill(INT64_MIN);
  for (std::size_t a = 0; a < D; ++a) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
#pragma omp parallel for schedule(static) reduction(min : low) reduction(max : high) if (n > values_worth_threads)
    for (std::size_t i = 0; i < n; ++i) {
      low = std::min(low, x[a][i]);
      high = std::max(high, x[a][i]);
    }
    if (n == 0) continue;
    g.first[a] = static_cast<std::int64_t>(std::floor(low / size));
    last[a] = static_cast<std::int64_t>(std::floor(high / size));
  }
  std::size_t cells = n > 0 ? 1 : 0;
  for (std::size_t a = 0; a < D && n > 0; ++a) {
    g.extent[a] = last[a] - g.first[a] + 1;
    cells *= static_cast<std::size_t>(g.extent[a]);
  }
  std::vector<std::uint32_t> cell_of(n);
  foundation::for_all(
      n, [&](std::size_t i) { cell_of[i] = static_cast<std::uint32_t>(g.linear(g.cell(position<D>(x, i)))); });
  g.start.assign(cells + 1, 0);
  for (std::size_t i = 0; i < n; ++i) ++g.start[cell_of[i] + 1];
  for (std::size_t c = 0; c < cells; ++c) g.start[c + 1] += g.start[c];
  g.members.resize(n);
  {
    auto next = g.start;
    for (std::size_t i = 0; i < n; ++i) g.members[next[cell_of[i]]++] = static_cast<std::uint32_t>(i);
  }
  for (auto& component : g.sorted) component.resize(n + foundation::lanes);
#pragma omp parallel for schedule(static) if (n > values_worth_threads)
  for (std::size_t c = 0; c < cells; ++c) {
    std::sort(g.members.begin() + g.start[c], g.members.begin() + g.start[c + 1],
              [&](std::uint32_t i, std::uint32_t j) { return id[i] < id[j]; });
    for (std::uint32_t k = g.start[c]; k < g.start[c + 1]; ++k)
      for (std::size_t a = 0; a < D; ++a) g.sorted[a][k] = x[a][g.members[k]];
  }
  for (auto& component : g.sorted) std::fill_n(component.end() - foundation::lanes, foundation::lanes, 1e60);
  return g;
}

// f(first, last) for every stretch of `members` in the cells that a ball of radius `reach` about
// `point` meets, in the order of cells.
template <int D, class F>
void for_each_stretch(const grid<D>& g, const std::array<double, D>& point, double reach, F&& f) {
  if (g.members.empty()) return;
  auto low = point, high = point;
  for (std::size_t a = 0; a < D; ++a) low[a] -= reach, high[a] += reach;
  auto from = g.cell(low), to = g.cell(high);
  for (std::size_t a = 0; a < D; ++a) {
    from[a] = std::max(from[a], g.first[a]);
    to[a] = std::min(to[a], g.first[a] + g.extent[a] - 1);
    if (from[a] > to[a]) return;
  }
  // Odometer over all axes but the last, whose cells are one stretch.
  auto row = from;
  while (true) {
    auto row_end = row;
    row_end[D - 1] = to[D - 1];
    f(g.start[g.linear(row)], g.start[g.linear(row_end) + 1]);
    int a = D - 2;
    for (; a >= 0; --a) {
      const auto axis = static_cast<std::size_t>(a);
      if (++row[axis] <= to[axis]) break;
      row[axis] = from[axis];
    }
    if (a < 0) return;
  }
}

// f(j) for every particle nearer to `point` than `reach`, in the order of cells, then IDs.
template <int D, class F>
void for_each_near(const grid<D>& g, const std::array<double, D>& point, double reach, F&& f) {
  using foundation::lanes, foundation::real;
  const double reach2 = reach * reach;
  for_each_stretch<D>(g, point, reach, [&](std::uint32_t first, std::uint32_t last) {
    for (std::uint32_t k = first; k < last; k += lanes) {
      real r2(0.0);
      for (std::size_t a = 0; a < D; ++a) {
        const real x_ij = point[a] - real(g.sorted[a].data() + k, std::experimental::element_aligned);
        r2 += x_ij * x_ij;
      }
      std::uint32_t near = foundation::bits_of_less(r2, real(reach2));
      if (last - k < lanes) near &= (1U << (last - k)) - 1U;
      for (; near != 0; near &= near - 1U) f(g.members[k + static_cast<std::uint32_t>(std::countr_zero(near))]);
    }
  });
}

}  // namespace tetsuame::cells
