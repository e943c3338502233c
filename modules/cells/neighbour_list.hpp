// Neighbour lists with a skin: valid until some particle has moved half of it.
//
// Neighbours are local indices in the order of the grid (cells, then IDs), so every sum over
// a list has the same bits on any number of ranks and threads. Particles of a column of cells follow each other in
// memory too: a row is kept as runs of them, 8 B for up to 32 neighbours, and written out when it is summed over,
// padded with the null particle to a multiple of `lanes`.
#pragma once

#include <algorithm>
#include <bit>
#include <cells/grid.hpp>
#include <cstddef>
#include <cstdint>
#include <foundation/lanes.hpp>
#include <foundation/threads.hpp>
#include <memory>
#include <span>
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

// Neighbours first + n, for every bit n of `chosen`.
struct run {
  std::uint32_t first, chosen;
};

struct neighbour_list {
  // Values in one SIMD register: a row is padded to a multiple of it.
  static constexpr std::size_t lanes = foundation::lanes;

  std::vector<std::size_t> start;  // per row, into `runs`; one more at the end
  std::vector<run, uninitialised<run>> runs;
  std::size_t pairs = 0;             // entries without padding
  std::size_t longest = 0;           // entries of the longest row
  std::size_t null = 0;              // the null particle's index, the largest there is
  mutable particles::array records;  // scratch of the pair loop: what it reads of the neighbours, packed

  std::size_t rows() const { return start.empty() ? 0 : start.size() - 1; }
  // Entries of row r, with the padding.
  std::size_t length(std::size_t r) const {
    std::size_t n = 0;
    for (std::size_t k = start[r]; k < start[r + 1]; ++k) n += static_cast<std::size_t>(std::popcount(runs[k].chosen));
    return (n + lanes - 1) / lanes * lanes;
  }
  double bytes() const {
    return static_cast<double>(start.capacity() * sizeof(start[0]) + runs.capacity() * sizeof(runs[0]));
  }
  // What a row written out needs: a run and a register's worth are written behind its end.
  std::size_t room() const { return longest + 32 + lanes; }
  // Row r with its padding, each entry times Stride, written to `out`; returns its end.
  template <std::uint32_t Stride>
  std::uint32_t* expand(std::size_t r, std::uint32_t* out) const {
    std::uint32_t* end = out;
    for (std::size_t k = start[r]; k < start[r + 1]; ++k)
      end = foundation::append_run<Stride>(end, runs[k].first, runs[k].chosen);
    for (std::size_t lane = 0; lane < lanes; ++lane) end[lane] = static_cast<std::uint32_t>(null) * Stride;
    return out + (static_cast<std::size_t>(end - out) + lanes - 1) / lanes * lanes;
  }
  // The same, in a buffer that serves again.
  template <std::uint32_t Stride = 1>
  std::span<const std::uint32_t> row(std::size_t r, std::vector<std::uint32_t>& buffer) const {
    buffer.resize(std::max(buffer.size(), room()));
    return {buffer.data(), expand<Stride>(r, buffer.data())};
  }
  // Adds a row behind the last one.
  void append(std::span<const std::uint32_t> entries);
};

// Makes the runs of one row, one behind the other from `out` on, where there is room for one an entry and one more.
struct run_maker {
  run* out;
  std::uint32_t first = 0, chosen = 0;  // of the run that is being made
  std::size_t entries = 0;

  // first + n of a register's worth, for every bit n that is set.
  void add(std::uint32_t from, std::uint32_t bits) {
    entries += static_cast<std::size_t>(std::popcount(bits));
    const std::uint32_t n = from - first;
    if (n < 32 && n + static_cast<std::uint32_t>(std::bit_width(bits)) <= 32 && chosen >> n == 0) {
      chosen |= bits << n;
      return;
    }
    end();
    const auto skipped = static_cast<std::uint32_t>(std::countr_zero(bits));
    first = from + skipped;
    chosen = bits >> skipped;
  }
  run* end() {
    if (chosen != 0) *out++ = {first, chosen};
    return out;
  }
};

inline void neighbour_list::append(std::span<const std::uint32_t> entries) {
  if (start.empty()) start.push_back(0);
  runs.resize(start.back() + entries.size() + 1);
  run_maker row{runs.data() + start.back()};
  for (const std::uint32_t j : entries) row.add(j, 1);
  start.push_back(static_cast<std::size_t>(row.end() - runs.data()));
  runs.resize(start.back());
  pairs += entries.size();
  longest = std::max(longest, entries.size());
}

// Accepts all but row r's own particle, r.
struct others {};

// Adds those of members[k, k + lanes) whose bit is set and which row r accepts.
template <class Accept>
void add_members(run_maker& row, const std::vector<std::uint32_t>& members, std::size_t k, std::uint32_t bits,
                 std::size_t r, const Accept& accept) {
  if constexpr (std::is_same_v<Accept, others>) {
    const std::uint32_t from = members[k];
    if ((bits & ~foundation::bits_of_successive(members.data() + k, members.size() - k)) == 0) {
      if (const std::size_t own = r - from; own < neighbour_list::lanes) bits &= ~(1U << own);
      if (bits != 0) row.add(from, bits);
      return;
    }
  }
  for (; bits != 0; bits &= bits - 1U) {
    const std::uint32_t j = members[k + static_cast<std::size_t>(std::countr_zero(bits))];
    if constexpr (std::is_same_v<Accept, others>) {
      if (j != r) row.add(j, 1);
    } else {
      if (accept(r, j)) row.add(j, 1);
    }
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
  list.runs.resize(list.runs.capacity());
  std::size_t pairs = 0, longest = 0, end = 0;
  const auto reach_of = [&](std::size_t r) -> double {
    if constexpr (std::is_invocable_v<Reach, std::size_t>)
      return reach(r);
    else
      return reach;
  };
  const auto sweep = [&] {
    pairs = longest = end = 0;
#pragma omp parallel reduction(+ : pairs) reduction(max : longest) if (rows > foundation::rows_worth_threads)
    {
      std::vector<run, uninitialised<run>> made;
#pragma omp for ordered schedule(dynamic, 1)
      for (std::size_t first = 0; first < rows; first += block) {
        const std::size_t last = std::min(rows, first + block);
        std::size_t count = 0;
        for (std::size_t r = first; r < last; ++r) {
          run_maker row{made.data() + count};
          for_each_near<D>(g, centre(r), reach_of(r), [&](std::uint32_t k, std::uint32_t near) {
            const auto used = static_cast<std::size_t>(row.out - made.data());
            if (const std::size_t most = used + neighbour_list::lanes + 1; most > made.size()) {
              made.resize(2 * most);
              row.out = made.data() + used;
            }
            add_members(row, g.members, k, near, r, accept);
          });
          pairs += row.entries;
          longest = std::max(longest, row.entries);
          count = static_cast<std::size_t>(row.end() - made.data());
          list.start[r + 1] = count;  // from the block's begin
        }
        std::size_t begin;
#pragma omp ordered
        {
          begin = end;
          end += count;
        }
        for (std::size_t r = first; r < last; ++r) list.start[r + 1] += begin;
        if (begin + count <= list.runs.size())
          std::copy_n(made.begin(), count, list.runs.begin() + static_cast<std::ptrdiff_t>(begin));
      }
    }
  };
  sweep();
  if (end > list.runs.size()) {
    list.runs.clear();
    list.runs.shrink_to_fit();         // before the new memory is taken
    list.runs.resize(end + end / 32);  // a little to spare
    sweep();
  }
  list.runs.resize(end);
  list.pairs = pairs;
  list.longest = longest;
}

}  // namespace tetsuame::cells
