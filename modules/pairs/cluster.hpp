// Particles i of a sum over neighbours, one a lane, and which of them a sum is for.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cells/neighbour_list.hpp>
#include <cstddef>
#include <cstdint>
#include <foundation/lanes.hpp>
#include <utility>
#include <vector>

namespace tetsuame::pairs {

namespace stdx = std::experimental;
using foundation::lanes, foundation::real;

// Particles first + n; bit n of `chosen` says that the sum is for it. Lanes of others hold anything, and are not
// written.
struct cluster {
  static constexpr std::uint32_t all = (1U << lanes) - 1U;
  std::size_t first;
  std::uint32_t chosen = all;

  // Each member's value. No branches for clusters of which all are chosen: the compiler would fuse multiplications and
  // additions here and not there, and sums would depend on who else is in the cluster.
  real operator()(const double* a) const { return foundation::load_where<real>(chosen, a + first); }
  void set(double* a, const real& value) const { foundation::store_where(chosen, a + first, value); }
  void add(double* a, const real& value) const { set(a, (*this)(a) + value); }
  // f(particle, of) for every chosen one; of(value) is its lane's.
  template <class F>
  void each(F&& f) const {
    for (std::uint32_t left = chosen; left != 0; left &= left - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(left));
      f(first + lane, [lane](const real& value) { return static_cast<double>(value[lane]); });
    }
  }
};

// Rows of sum_over: the particles [first, last), whose neighbours are all in [seen_first, seen_last). `first` begins a
// cluster, `last` ends one, or is behind the last particle of the list.
struct stretch {
  std::size_t first, last, seen_first, seen_last;

  std::size_t clusters() const { return (last - first + lanes - 1) / lanes; }
  cluster operator[](std::size_t r) const {
    const std::size_t at = first + r * lanes;
    return {at, at + lanes <= last ? cluster::all : (1U << (last - at)) - 1U};
  }

  // What is packed: those seen.
  struct seen {
    std::size_t first, count;
    std::size_t size() const { return count; }
    std::size_t operator[](std::size_t k) const { return first + k; }
  };
  seen packed() const { return {seen_first, seen_last - seen_first}; }
};

// Some particles, and those that are one of them or in their lists: only these are packed.
struct chosen {
  std::vector<std::size_t> rows, seen;
  std::vector<cluster> of_rows;

  std::size_t clusters() const { return of_rows.size(); }
  const cluster& operator[](std::size_t r) const { return of_rows[r]; }
  const std::vector<std::size_t>& packed() const { return seen; }
};

// Of `total` particles.
inline chosen choose(const cells::neighbour_list& list, std::vector<std::size_t> rows, std::size_t total) {
  std::vector<std::uint32_t> bits(list.rows(), 0);
  for (const std::size_t i : rows) bits[i / lanes] |= 1U << i % lanes;
  chosen c{std::move(rows), {}, {}};
  std::vector<char> needed(total, 0);
  for (std::size_t r = 0; r < bits.size(); ++r) {
    if (bits[r] == 0) continue;
    c.of_rows.push_back({r * lanes, bits[r]});
    for (std::size_t i = r * lanes; i < std::min(total, (r + 1) * lanes); ++i) needed[i] = 1;
    list.for_each(r, [&](std::uint32_t j, std::uint32_t) { needed[j] = 1; });
  }
  for (std::size_t i = 0; i < total; ++i)
    if (needed[i] != 0) c.seen.push_back(i);
  return c;
}

}  // namespace tetsuame::pairs
