// Neighbour lists with a skin: valid until some particle has moved half of it.
//
// Entries are local indices in the order of the grid (cells, then IDs), so every sum over
// a list has the same bits on any number of ranks and threads. Each list is padded with
// the null particle to a multiple of `lanes`.
#pragma once

#include <cells/grid.hpp>
#include <cstddef>
#include <cstdint>
#include <experimental/simd>
#include <foundation/threads.hpp>
#include <span>
#include <vector>

namespace tetsuame::cells {

struct neighbour_list {
  // Values in one SIMD register: a row is padded to a multiple of it.
  static constexpr std::size_t lanes = std::experimental::native_simd<double>::size();

  std::vector<std::size_t> start;  // per row, into `neighbours`; one more at the end
  std::vector<std::int32_t> neighbours;
  std::size_t pairs = 0;             // entries without padding
  std::size_t null = 0;              // the null particle's index, the largest there is
  mutable particles::array records;  // scratch of the pair loop: what it reads of the neighbours, packed

  std::size_t rows() const { return start.empty() ? 0 : start.size() - 1; }
};

// Row r lists the particles j with |centre(r) - x_j| < reach and accept(r, j).
template <int D, class Centre, class Accept>
neighbour_list make_list(const grid<D>& g, const std::array<particles::array, D>& x, std::size_t rows, double reach,
                         std::size_t null, Centre&& centre, Accept&& accept) {
  neighbour_list list;
  list.null = null;
  std::vector<std::uint32_t> count(rows, 0);
  const double reach2 = reach * reach;
  const auto visit = [&](std::size_t r, auto&& take) {
    const std::array<double, D> point = centre(r);
    for_each_near<D>(g, point, reach, [&](std::uint32_t j) {
      double r2 = 0.0;
      for (std::size_t a = 0; a < D; ++a) r2 += (point[a] - x[a][j]) * (point[a] - x[a][j]);
      if (r2 < reach2 && accept(r, j)) take(j);
    });
  };
#pragma omp parallel for schedule(static) if (rows > foundation::rows_worth_threads)
  for (std::size_t r = 0; r < rows; ++r) visit(r, [&](std::uint32_t) { ++count[r]; });
  list.start.resize(rows + 1);
  list.start[0] = 0;
  for (std::size_t r = 0; r < rows; ++r) {
    const std::size_t padded = (count[r] + neighbour_list::lanes - 1) / neighbour_list::lanes * neighbour_list::lanes;
    list.start[r + 1] = list.start[r] + padded;
    list.pairs += count[r];
  }
  list.neighbours.resize(list.start[rows]);
#pragma omp parallel for schedule(static) if (rows > foundation::rows_worth_threads)
  for (std::size_t r = 0; r < rows; ++r) {
    std::size_t k = list.start[r];
    visit(r, [&](std::uint32_t j) { list.neighbours[k++] = static_cast<std::int32_t>(j); });
    for (; k < list.start[r + 1]; ++k) list.neighbours[k] = static_cast<std::int32_t>(null);
  }
  return list;
}

}  // namespace tetsuame::cells
