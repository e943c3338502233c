// Particles i of a sum over neighbours, one a lane, and which of them a sum is for.
//
// R is what pairs are computed in: `real`, doubles in SI units, or `single`, whose lengths are in a power of two of
// metres near the kernel's support, so that products of volumes, pressures and kernels stay within its range. A field
// that is proportional to m^n says so where it is read or written; other units are as they are.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cells/neighbour_list.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <foundation/lanes.hpp>
#include <foundation/threads.hpp>
#include <type_traits>
#include <utility>
#include <vector>

namespace tetsuame::pairs {

namespace stdx = std::experimental;
using foundation::lanes, foundation::real, foundation::single;

// What lengths are in.
template <class R>
struct unit {
  static constexpr double to(int) { return 1.0; }
};
template <>
struct unit<single> {
  int exponent;  // of two, in m

  explicit unit(double near)  // m
      : exponent(static_cast<int>(std::floor(std::log2(near)))) {}
  // m^n; exact, by its bits: no call of a function, in front of which all registers would be saved.
  double to(int n) const { return std::bit_cast<double>(static_cast<std::uint64_t>(1023 + n * exponent) << 52U); }
};

// Particles first + n; bit n of `chosen` says that the sum is for it.
struct members {
  std::size_t first;
  std::uint32_t mask;
};

// Lanes of those not chosen hold anything, and are not written.
template <class R = real>
struct cluster {
  std::size_t first;
  std::uint32_t mask;
  [[no_unique_address]] unit<R> lengths;

  // Each member's value less a number, in m^n, times a factor; of `single`, in both halves. No branches for clusters of
  // which all are chosen: the compiler would fuse multiplications and additions here and not there, and sums would
  // depend on who else is in the cluster.
  R operator()(const double* a, int n = 0, double factor = 1.0, double less = 0.0) const {
    const real values = foundation::load_where<real>(mask, a + first) - less;
    if constexpr (std::is_same_v<R, real>)
      return values * factor;
    else
      return foundation::duplicate_halves(real(values * (lengths.to(-n) * factor)));
  }
  // A value of the members in doubles and SI units, which goes with m^n.
  real in_doubles(const R& value, int n = 0) const {
    if constexpr (std::is_same_v<R, real>)
      return value;
    else
      return foundation::lower_half(value) * lengths.to(n);
  }
  void set(double* a, const R& value, int n = 0) const {
    foundation::store_where(mask, a + first, in_doubles(value, n));
  }
  // Of what is in doubles, and these lengths, already.
  void set_doubles(double* a, const real& value, int n = 0) const {
    foundation::store_where(mask, a + first, real(value * lengths.to(n)));
  }
  void add(double* a, const R& value, int n = 0) const { add_doubles(a, in_doubles(value, n)); }
  void add_doubles(double* a, const real& value, int n = 0) const {
    foundation::store_where(mask, a + first,
                            real(foundation::load_where<real>(mask, a + first) + value * lengths.to(n)));
  }
  // f(particle, of) for every chosen one; of(value, n) is its lane's, n as above.
  template <class F>
  void each(F&& f) const {
    for (std::uint32_t left = mask; left != 0; left &= left - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(left));
      f(first + lane, [&, lane](const R& value, int n = 0) {
        if constexpr (std::is_same_v<R, real>)
          return static_cast<double>(value[lane]);
        else
          return static_cast<double>(value[lane]) * lengths.to(n);
      });
    }
  }
  // f(doubles, of) for all members at once: a cluster of doubles; of(value, n) are its members', n as above.
  template <class F>
  void with_doubles(F&& f) const {
    f(cluster<real>{first, mask, {}}, [&](const R& value, int n = 0) { return in_doubles(value, n); });
  }
};

// Rows of sum_over: the particles [first, last), whose neighbours are all in [seen_first, seen_last). `first` begins a
// cluster, `last` ends one, or is behind the last particle of the list.
struct row_range {
  std::size_t first, last, seen_first, seen_last;

  std::size_t clusters() const { return (last - first + lanes - 1) / lanes; }
  members cluster(std::size_t r) const {
    const std::size_t at = first + r * lanes;
    return {at, (1U << std::min(lanes, last - at)) - 1U};
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
struct row_subset {
  std::vector<std::size_t> rows, seen;
  std::vector<members> of_rows;

  std::size_t clusters() const { return of_rows.size(); }
  const members& cluster(std::size_t r) const { return of_rows[r]; }
  const std::vector<std::size_t>& packed() const { return seen; }
};

// Those of a row range that are not among some others.
struct remainder {
  row_range of;
  std::vector<members> of_rows;

  remainder() = default;
  remainder(const row_range& rows, const row_subset& others) : of(rows) {
    auto other = others.of_rows.begin();
    for (std::size_t r = 0; r < rows.clusters(); ++r) {
      members m = rows.cluster(r);
      while (other != others.of_rows.end() && other->first < m.first) ++other;
      if (other != others.of_rows.end() && other->first == m.first) m.mask &= ~other->mask;
      if (m.mask != 0) of_rows.push_back(m);
    }
  }
  std::size_t clusters() const { return of_rows.size(); }
  const members& cluster(std::size_t r) const { return of_rows[r]; }
  row_range::seen packed() const { return of.packed(); }
};

// Of `total` particles.
inline row_subset choose(const cells::neighbour_list& list, std::vector<std::size_t> rows, std::size_t total) {
  std::vector<std::uint32_t> bits(list.rows(), 0);
  for (const std::size_t i : rows) bits[i / lanes] |= 1U << i % lanes;
  row_subset c{std::move(rows), {}, {}};
  for (std::size_t r = 0; r < bits.size(); ++r)
    if (bits[r] != 0) c.of_rows.push_back({r * lanes, bits[r]});
  std::vector<char> needed(total, 0);
  // Threads that need the same particle write the same.
  const auto need = [&](std::size_t j) { std::atomic_ref<char>(needed[j]).store(1, std::memory_order_relaxed); };
  constexpr std::size_t chunk = 32;  // clusters
  foundation::for_chunks(c.of_rows.size(), chunk, c.of_rows.size() > foundation::rows_worth_threads / lanes,
                         [&](std::size_t from, std::size_t to) {
                           for (std::size_t k = from; k < to; ++k) {
                             const std::size_t first = c.of_rows[k].first;
                             for (std::size_t i = first; i < std::min(total, first + lanes); ++i) need(i);
                             list.for_each(first / lanes, [&](std::uint32_t j, auto...) { need(j); });
                           }
                         });
  c.seen = foundation::indices_where<std::size_t>(total, [&](std::size_t i) { return needed[i] != 0; });
  return c;
}

}  // namespace tetsuame::pairs
