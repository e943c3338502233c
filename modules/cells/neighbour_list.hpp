// Neighbour lists with a skin: valid until some particle has moved half of it.
//
// Entries are local indices in the order of the grid (cells, then IDs), so every sum over
// a list has the same bits on any number of ranks and threads. Each list is padded with
// the null particle to a multiple of `lanes`.
#pragma once

#include <omp.h>

#include <algorithm>
#include <cells/grid.hpp>
#include <cstddef>
#include <cstdint>
#include <foundation/lanes.hpp>
#include <foundation/threads.hpp>
#include <span>
#include <vector>

namespace tetsuame::cells {

struct neighbour_list {
  // Values in one SIMD register: a row is padded to a multiple of it.
  static constexpr std::size_t lanes = foundation::lanes;

  std::vector<std::size_t> start;  // per row, into `neighbours`; one more at the end
  std::vector<std::int32_t> neighbours;
  std::size_t pairs = 0;             // entries without padding
  std::size_t null = 0;              // the null particle's index, the largest there is
  mutable particles::array records;  // scratch of the pair loop: what it reads of the neighbours, packed

  std::size_t rows() const { return start.empty() ? 0 : start.size() - 1; }
};

// Row r lists the particles j with |centre(r) - x_j| < reach and accept(r, j).
template <int D, class Centre, class Accept>
neighbour_list make_list(const grid<D>& g, std::size_t rows, double reach, std::size_t null, Centre&& centre,
                         Accept&& accept) {
  neighbour_list list;
  list.null = null;
  list.start.assign(rows + 1, 0);
  // Each thread makes its share of rows in a store of its own; then all stand one behind the other.
  const int threads = rows > foundation::rows_worth_threads ? omp_get_max_threads() : 1;
  std::vector<std::vector<std::int32_t>> shares(static_cast<std::size_t>(threads));
  std::size_t pairs = 0;
#pragma omp parallel num_threads(threads) reduction(+ : pairs)
  {
    const auto share = static_cast<std::size_t>(omp_get_thread_num()),
               all = static_cast<std::size_t>(omp_get_num_threads());
    auto& mine = shares[share];
    const std::size_t first = rows * share / all, last = rows * (share + 1) / all;
    for (std::size_t r = first; r < last; ++r) {
      const std::size_t begin = mine.size();
      for_each_near<D>(g, centre(r), reach, [&](std::uint32_t j) {
        if (accept(r, j)) mine.push_back(static_cast<std::int32_t>(j));
      });
      pairs += mine.size() - begin;
      while (mine.size() % neighbour_list::lanes != 0) mine.push_back(static_cast<std::int32_t>(null));
      list.start[r + 1] = mine.size() - begin;  // lengths first
      constexpr std::size_t sample = 64;        // rows that tell how long the others will be
      if (r + 1 == first + sample) mine.reserve(mine.size() / sample * (last - first + sample) / 16 * 17);
    }
#pragma omp barrier
#pragma omp single
    {
      for (std::size_t r = 0; r < rows; ++r) list.start[r + 1] += list.start[r];
      if (all > 1) list.neighbours.resize(list.start[rows]);
    }
    if (all > 1) {
      std::copy(mine.begin(), mine.end(), list.neighbours.begin() + static_cast<std::ptrdiff_t>(list.start[first]));
      std::vector<std::int32_t>().swap(mine);
    } else {
      list.neighbours = std::move(mine);
    }
  }
  list.pairs = pairs;
  return list;
}

}  // namespace tetsuame::cells
