// Neighbour lists with a skin: valid until some particle has moved half of it.
//
// Entries are local indices in the order of the grid (cells, then IDs), so every sum over
// a list has the same bits on any number of ranks and threads. Each list is padded with
// the null particle to a multiple of `lanes`.
#pragma once

#include <algorithm>
#include <cells/grid.hpp>
#include <cstddef>
#include <cstdint>
#include <foundation/lanes.hpp>
#include <foundation/threads.hpp>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

namespace tetsuame::cells {

// A vector with it leaves new values as they are: large arrays that are written at once are not filled before.
template <class T>
struct uninitialised : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = uninitialised<U>;
  };
  template <class U>
  void construct(U* at) {
    ::new (static_cast<void*>(at)) U;
  }
  template <class U, class... Arguments>
  void construct(U* at, Arguments&&... arguments) {
    ::new (static_cast<void*>(at)) U(std::forward<Arguments>(arguments)...);
  }
};

struct neighbour_list {
  // Values in one SIMD register: a row is padded to a multiple of it.
  static constexpr std::size_t lanes = foundation::lanes;

  std::vector<std::size_t> start;  // per row, into `neighbours`; one more at the end
  std::vector<std::int32_t, uninitialised<std::int32_t>> neighbours;
  std::size_t pairs = 0;             // entries without padding
  std::size_t null = 0;              // the null particle's index, the largest there is
  mutable particles::array records;  // scratch of the pair loop: what it reads of the neighbours, packed

  std::size_t rows() const { return start.empty() ? 0 : start.size() - 1; }
};

// Accepts all but row r's own particle, r.
struct others {};

// Moves those of [begin, end) that row r accepts together, in their order; returns their end.
template <class Accept>
std::int32_t* keep(std::int32_t* begin, std::int32_t* end, std::size_t r, const Accept& accept) {
  if constexpr (std::is_same_v<Accept, others>) {
    std::int32_t* const self = std::find(begin, end, static_cast<std::int32_t>(r));
    return self == end ? end : std::copy(self + 1, end, self);
  } else {
    return std::remove_if(begin, end, [&](std::int32_t j) { return !accept(r, static_cast<std::uint32_t>(j)); });
  }
}

// Row r lists the particles j with |centre(r) - x_j| < reach, or reach(r), and accept(r, j). The list's memory serves
// again.
//
// Threads make blocks of rows in stores that stay in their caches, and copy each to its place as soon as the lengths of
// those before it are known. Where the memory does not suffice, the first sweep finds out how much is needed.
template <int D, class Reach, class Centre, class Accept>
void make_list(neighbour_list& list, const grid<D>& g, std::size_t rows, const Reach& reach, std::size_t null,
               Centre&& centre, const Accept& accept) {
  constexpr std::size_t block = 256;  // rows
  list.null = null;
  list.start.resize(rows + 1);
  list.start[0] = 0;
  list.neighbours.resize(list.neighbours.capacity());
  std::size_t pairs = 0, end = 0;
  const auto reach_of = [&](std::size_t r) -> double {
    if constexpr (std::is_invocable_v<Reach, std::size_t>)
      return reach(r);
    else
      return reach;
  };
  const auto sweep = [&] {
    pairs = end = 0;
#pragma omp parallel reduction(+ : pairs) if (rows > foundation::rows_worth_threads)
    {
      std::vector<std::int32_t> made;
#pragma omp for ordered schedule(dynamic, 1)
      for (std::size_t first = 0; first < rows; first += block) {
        const std::size_t last = std::min(rows, first + block);
        std::size_t count = 0;
        for (std::size_t r = first; r < last; ++r) {
          const std::size_t row = count;
          append_near<D>(g, centre(r), reach_of(r), made, count);
          if (made.size() < count + neighbour_list::lanes) made.resize(count + neighbour_list::lanes);
          std::int32_t* const begin = made.data() + row;
          std::int32_t* end_of_row = keep(begin, made.data() + count, r, accept);
          pairs += static_cast<std::size_t>(end_of_row - begin);
          while ((end_of_row - begin) % neighbour_list::lanes != 0) *end_of_row++ = static_cast<std::int32_t>(null);
          count = static_cast<std::size_t>(end_of_row - made.data());
          list.start[r + 1] = count;  // from the block's begin
        }
        std::size_t begin;
#pragma omp ordered
        {
          begin = end;
          end += count;
        }
        for (std::size_t r = first; r < last; ++r) list.start[r + 1] += begin;
        if (begin + count <= list.neighbours.size())
          std::copy_n(made.begin(), count, list.neighbours.begin() + static_cast<std::ptrdiff_t>(begin));
      }
    }
  };
  sweep();
  if (end > list.neighbours.size()) {
    list.neighbours.clear();
    list.neighbours.shrink_to_fit();         // before the new memory is taken
    list.neighbours.resize(end + end / 32);  // a little to spare
    sweep();
  }
  list.neighbours.resize(end);
  list.pairs = pairs;
}

}  // namespace tetsuame::cells
