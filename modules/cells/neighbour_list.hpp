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
  std::uint32_t* expand(std::size_t r, std::uint32_t* out) const;
  // The same, in a buffer that serves again.
  template <std::uint32_t Stride = 1>
  std::span<const std::uint32_t> row(std::size_t r, std::vector<std::uint32_t>& buffer) const {
    buffer.resize(std::max(buffer.size(), room()));
    return {buffer.data(), expand<Stride>(r, buffer.data())};
  }
  // Adds a row behind the last one.
  void append(std::span<const std::uint32_t> entries);
};

// Writes a row out, each entry times Stride, a run a step.
template <std::uint32_t Stride>
class row_writer {
 public:
  row_writer(const neighbour_list& list, std::size_t r, std::uint32_t* out)
      : null_(static_cast<std::uint32_t>(list.null) * Stride),
        at_(list.runs.data() + list.start[r]),
        last_(list.runs.data() + list.start[r + 1]),
        begin_(out),
        out_(out) {}

  [[gnu::always_inline]] void step() {
    if (at_ == last_) return;
    out_ = foundation::append_run<Stride>(out_, at_->first, at_->chosen);
    ++at_;
  }
  // What is left, and the padding; returns the end.
  std::uint32_t* finish() {
    while (at_ != last_) step();
    for (std::size_t lane = 0; lane < neighbour_list::lanes; ++lane) out_[lane] = null_;
    return begin_ + (static_cast<std::size_t>(out_ - begin_) + neighbour_list::lanes - 1) / neighbour_list::lanes *
                        neighbour_list::lanes;
  }

 private:
  std::uint32_t null_;
  const run *at_, *last_;
  std::uint32_t *begin_, *out_;
};

template <std::uint32_t Stride>
std::uint32_t* neighbour_list::expand(std::size_t r, std::uint32_t* out) const {
  return row_writer<Stride>(*this, r, out).finish();
}

// Adds the particles first + n, for every bit n of `chosen`, behind `out`; returns the end.
inline run* add_runs(run* out, std::uint32_t first, std::uint64_t chosen) {
  while (chosen != 0) {
    const int skipped = std::countr_zero(chosen);
    first += static_cast<std::uint32_t>(skipped);
    chosen >>= skipped;
    *out++ = {first, static_cast<std::uint32_t>(chosen)};
    first += 32;
    chosen >>= 32;
  }
  return out;
}

inline void neighbour_list::append(std::span<const std::uint32_t> entries) {
  if (start.empty()) start.push_back(0);
  for (const std::uint32_t j : entries) {
    run* const last = runs.size() > start.back() ? &runs.back() : nullptr;
    // In the last run, where it reaches so far and holds nothing behind.
    if (last != nullptr && j - last->first < 32 && last->chosen >> (j - last->first) == 0)
      last->chosen |= 1U << (j - last->first);
    else
      runs.push_back({j, 1});
  }
  start.push_back(runs.size());
  pairs += entries.size();
  longest = std::max(longest, entries.size());
}

// Accepts all but row r's own particle, r.
struct others {};

// Adds those of members[k, k + 64) whose bit is set and which row r accepts behind `out`; returns the end.
template <int D, class Accept>
run* add_members(run* out, const grid<D>& g, std::uint32_t k, std::uint64_t near, std::size_t r, const Accept& accept) {
  for (std::uint32_t left = 64; near != 0;) {
    const std::uint32_t j = g.members[k], n = std::min(left, g.run_end[k] - k);
    std::uint64_t chosen = near & ~std::uint64_t{0} >> (64 - n);
    if constexpr (std::is_same_v<Accept, others>) {
      if (const std::size_t own = r - j; own < 64) chosen &= ~(std::uint64_t{1} << own);
    } else {
      for (std::uint64_t bits = chosen; bits != 0; bits &= bits - 1)
        if (!accept(r, j + static_cast<std::uint32_t>(std::countr_zero(bits)))) chosen &= ~(bits & (~bits + 1));
    }
    out = add_runs(out, j, chosen);
    if (n == left) break;
    near >>= n;
    left -= n;
    k += n;
  }
  return out;
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
          run* row_end = made.data() + count;
          for_each_near<D>(g, centre(r), reach_of(r), [&](std::uint32_t k, std::uint64_t near) {
            const auto used = static_cast<std::size_t>(row_end - made.data());
            if (used + 64 > made.size()) {
              made.resize(2 * (used + 64));
              row_end = made.data() + used;
            }
            row_end = add_members(row_end, g, k, near, r, accept);
          });
          std::size_t entries = 0;
          for (const run* at = made.data() + count; at != row_end; ++at)
            entries += static_cast<std::size_t>(std::popcount(at->chosen));
          pairs += entries;
          longest = std::max(longest, entries);
          count = static_cast<std::size_t>(row_end - made.data());
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
