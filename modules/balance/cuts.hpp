// The slice grid: the box cut into N_x columns, each column cut by itself into N_y cells, and in
// 3-D each of these into N_z boxes [Furuichi & Nishiura, Comput. Phys. Commun. 219, 135 (2017)]. A rank
// owns one cell; every rank knows all cuts.
//
//   rank = (i_x N_y + i_y) N_z + i_z
//
// A level's cuts stand one group after another: at[0] has one group of N_x + 1 cuts, at[1] N_x
// groups of N_y + 1, at[2] N_x N_y groups of N_z + 1. The first and last cut of a group are the box's
// borders, where particles outside (walls) belong to the outermost cells. Two cuts may
// coincide: the cell between them is empty.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace tetsuame::balance {

template <int D>
struct cuts {
  std::array<int, D> counts{};              // N_x, N_y, …
  std::array<std::vector<double>, D> at{};  // m

  int ranks() const {
    int n = 1;
    for (const int c : counts) n *= c;
    return n;
  }
  // Groups of cuts at a level: the cells of the levels before.
  std::size_t groups(std::size_t axis) const {
    std::size_t n = 1;
    for (std::size_t a = 0; a < axis; ++a) n *= static_cast<std::size_t>(counts[a]);
    return n;
  }
  const double* group(std::size_t axis, std::size_t g) const {
    return at[axis].data() + g * static_cast<std::size_t>(counts[axis] + 1);
  }
  double* group(std::size_t axis, std::size_t g) {
    return at[axis].data() + g * static_cast<std::size_t>(counts[axis] + 1);
  }

  // The group of cuts along this axis that a point is in: the cell of the axes before. A point on a cut belongs to the
  // cell above it.
  std::size_t group_of(const std::array<double, D>& x, std::size_t axis) const {
    std::size_t cell = 0;
    for (std::size_t a = 0; a < axis; ++a) {
      const double* c = group(a, cell);
      const auto above = std::upper_bound(c + 1, c + counts[a], x[a]);
      cell = cell * static_cast<std::size_t>(counts[a]) + static_cast<std::size_t>(above - (c + 1));
    }
    return cell;
  }
  // The rank that owns a point.
  int owner(const std::array<double, D>& x) const { return static_cast<int>(group_of(x, D)); }

  struct bounds {
    std::array<double, D> lower{}, upper{};  // m; infinite at the outermost cells' outer sides
  };
  // The cell of a rank, open towards the outside of the box.
  bounds cell(int rank) const {
    bounds b;
    std::array<std::size_t, D> i{};
    auto rest = static_cast<std::size_t>(rank);
    for (std::size_t a = D; a-- > 0;) {
      i[a] = rest % static_cast<std::size_t>(counts[a]);
      rest /= static_cast<std::size_t>(counts[a]);
    }
    std::size_t g = 0;
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (std::size_t a = 0; a < D; ++a) {
      const double* c = group(a, g);
      b.lower[a] = i[a] == 0 ? -infinity : c[i[a]];
      b.upper[a] = i[a] + 1 == static_cast<std::size_t>(counts[a]) ? infinity : c[i[a] + 1];
      g = g * static_cast<std::size_t>(counts[a]) + i[a];
    }
    return b;
  }
};

// Cells of equal size.
template <int D>
cuts<D> equal_cuts(const std::array<int, D>& counts, const std::array<double, D>& length) {
  cuts<D> c;
  c.counts = counts;
  for (std::size_t a = 0; a < D; ++a)
    for (std::size_t g = 0; g < c.groups(a); ++g)
      for (int n = 0; n <= counts[a]; ++n) c.at[a].push_back(length[a] * n / counts[a]);
  return c;
}

// What cells copy from around them.
template <int D>
struct halo_shape {
  double width = 0.0;              // m; 0: thin
  std::array<bool, D> periodic{};  // images count
};

// What the halo of a cell of equal cells costs, for a cell with as many neighbours as there can be: its volume (m^D),
// of which images of the rank's own particles, copied without a message, count half; and for each other rank in it
// 4 width^D, which stands for the latency of a message (about 60 particles in 2-D, 200 in 3-D).
template <int D>
double halo_cost(const std::array<int, D>& n, const std::array<double, D>& length, const halo_shape<D>& halo) {
  double w = halo.width, cell = 1.0, with_images = 1.0, with_all = 1.0, ranks = 1.0;
  if (!(w > 0.0)) w = 1e-3 * *std::min_element(length.begin(), length.end());
  double message = 4.0;
  for (std::size_t a = 0; a < D; ++a) {
    const double edge = length[a] / n[a];
    const int sides = n[a] > 2 || halo.periodic[a] ? 2 : n[a] - 1;  // with something beyond
    cell *= edge;
    with_images *= edge + (n[a] > 1 ? 0 : sides) * w;
    with_all *= edge + sides * w;
    ranks *= std::min(static_cast<double>(n[a]), 1.0 + 2.0 * std::ceil(w / edge));
    message *= w;
  }
  return with_all - 0.5 * (with_images + cell) + message * (ranks - 1.0);
}

// N_x × N_y (× N_z) = ranks with the least cost of a halo, for cells of equal size; of equals, the one
// with most cuts along x. A positive ranks_x is kept where it divides `ranks`.
template <int D>
std::array<int, D> choose_counts(int ranks, const std::array<double, D>& length, int ranks_x = 0,
                                 const halo_shape<D>& halo = {}) {
  std::array<int, D> best{}, now{};
  double least = std::numeric_limits<double>::infinity();
  const auto try_axis = [&](auto&& self, std::size_t axis, int rest) -> void {
    if (axis + 1 == D) {
      now[axis] = rest;
      const double cost = halo_cost<D>(now, length, halo);
      if (cost < least * (1.0 - 1e-9)) least = cost, best = now;
      return;
    }
    for (int n = rest; n >= 1; --n) {
      if (rest % n != 0 || (axis == 0 && ranks_x > 0 && n != ranks_x)) continue;
      now[axis] = n;
      self(self, axis + 1, rest / n);
    }
  };
  try_axis(try_axis, 0, ranks);
  return best;
}

}  // namespace tetsuame::balance
