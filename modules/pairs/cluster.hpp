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

  // Each member's value.
  real operator()(const double* a) const {
    if (chosen == all) return real(a + first, stdx::element_aligned);
    return real([&](auto lane) { return (chosen >> lane & 1U) != 0 ? a[first + lane] : 0.0; });
  }
  void set(double* a, const real& value) const {
    if (chosen == all) return value.copy_to(a + first, stdx::element_aligned);
    each([&](std::size_t i, const auto& of) { a[i] = of(value); });
  }
  void add(double* a, const real& value) const {
    if (chosen == all) return real(real(a + first, stdx::element_aligned) + value).copy_to(a + first, stdx::element_aligned);
    each([&](std::size_t i, const auto& of) { a[i] += of(value); });
  }
  // f(particle, of) for every chosen one; of(value) is its lane's.
  template <class F>
  void each(F&& f) const {
    for (std::uint32_t left = chosen; left != 0; left &= left - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(left));
      f(first + lane, [lane](const real& value) { return static_cast<double>(value[lane]); });
    }
  }

  // The lane of particle j, or the number of lanes.
  std::size_t lane_of(std::uint32_t j) const {
    return std::min<std::size_t>(j - static_cast<std::uint32_t>(first), lanes);
  }
};

// The least r² of a pair, m2; a member and itself are out of every reach.
struct least_r2 {
  std::array<real, lanes + 1> of_lane;
  explicit least_r2(double nearest) {
    of_lane.fill(real(nearest * nearest));
    for (std::size_t lane = 0; lane < lanes; ++lane) of_lane[lane][lane] = 1e120;
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
    for (const std::uint32_t j : list.row(r)) needed[j] = 1;
  }
  for (std::size_t i = 0; i < total; ++i)
    if (needed[i] != 0) c.seen.push_back(i);
  return c;
}

}  // namespace tetsuame::pairs
