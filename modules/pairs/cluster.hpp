// Particles i of a sum over neighbours, one a lane, and which of them a sum is for.
//
// R is what pairs are computed in: `real`, doubles in SI units, or `single`, whose lengths are in a power of two of
// metres near the kernel's support, so that products of volumes, pressures and kernels stay within its range. A field
// that is proportional to m^n says so where it is read or written; other units are as they are.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cells/neighbour_list.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <foundation/lanes.hpp>
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
  std::uint32_t chosen;
};

// Lanes of those not chosen hold anything, and are not written.
template <class R = real>
struct cluster {
  std::size_t first;
  std::uint32_t chosen;
  [[no_unique_address]] unit<R> lengths;

  // Each member's value, in m^n, times a factor. No branches for clusters of which all are chosen: the compiler would
  // fuse multiplications and additions here and not there, and sums would depend on who else is in the cluster.
  R operator()(const double* a, int n = 0, double factor = 1.0) const {
    if constexpr (std::is_same_v<R, real>) {
      return foundation::load_where<real>(chosen, a + first) * factor;
    } else {
      const double scale = lengths.to(-n) * factor;
      const auto h = load(a);
      return foundation::narrow({real(h.low * scale), real(h.high * scale)});
    }
  }
  void set(double* a, const R& value, int n = 0) const {
    if constexpr (std::is_same_v<R, real>)
      foundation::store_where(chosen, a + first, value);
    else
      store(a, scaled(value, n));
  }
  void add(double* a, const R& value, int n = 0) const {
    if constexpr (std::is_same_v<R, real>) {
      set(a, (*this)(a) + value);
    } else {
      const auto h = load(a), more = scaled(value, n);
      store(a, {h.low + more.low, h.high + more.high});
    }
  }
  // f(particle, of) for every chosen one; of(value, n) is its lane's, n as above.
  template <class F>
  void each(F&& f) const {
    for (std::uint32_t left = chosen; left != 0; left &= left - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(left));
      f(first + lane, [&, lane](const R& value, int n = 0) {
        if constexpr (std::is_same_v<R, real>)
          return static_cast<double>(value[lane]);
        else
          return static_cast<double>(value[lane]) * lengths.to(n);
      });
    }
  }
  // f(doubles, of) for those members at once that a register of doubles takes, a cluster of their own; of(value, n) are
  // their lanes, n as above.
  template <class F>
  void in_doubles(F&& f) const {
    if constexpr (std::is_same_v<R, real>) {
      f(*this, [](const R& value, int = 0) { return value; });
    } else {
      f(cluster<real>{first, chosen & half, {}}, [&](const R& value, int n = 0) { return scaled(value, n).low; });
      f(cluster<real>{first + lanes, chosen >> lanes, {}},
        [&](const R& value, int n = 0) { return scaled(value, n).high; });
    }
  }

 private:
  static constexpr std::uint32_t half = (1U << lanes) - 1U;

  foundation::halves load(const double* a) const {
    return {foundation::load_where<real>(chosen & half, a + first),
            foundation::load_where<real>(chosen >> lanes, a + first + lanes)};
  }
  foundation::halves scaled(const R& value, int n) const {
    const double scale = lengths.to(n);
    const auto h = foundation::widen(value);
    return {real(h.low * scale), real(h.high * scale)};
  }
  void store(double* a, const foundation::halves& h) const {
    foundation::store_where(chosen & half, a + first, h.low);
    foundation::store_where(chosen >> lanes, a + first + lanes, h.high);
  }
};

// Rows of sum_over: the particles [first, last), whose neighbours are all in [seen_first, seen_last). `first` begins a
// cluster, `last` ends one, or is behind the last particle of the list.
struct stretch {
  std::size_t first, last, seen_first, seen_last;

  // Clusters of so many members.
  std::size_t clusters(std::size_t width) const { return (last - first + width - 1) / width; }
  members cluster(std::size_t r, std::size_t width) const {
    const std::size_t at = first + r * width;
    return {at, (1U << std::min(width, last - at)) - 1U};
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
  std::vector<members> of_rows;

  std::size_t clusters(std::size_t) const { return of_rows.size(); }
  const members& cluster(std::size_t r, std::size_t) const { return of_rows[r]; }
  const std::vector<std::size_t>& packed() const { return seen; }
};

// Of `total` particles.
inline chosen choose(const cells::neighbour_list& list, std::vector<std::size_t> rows, std::size_t total) {
  std::vector<std::uint32_t> bits(list.rows(), 0);
  for (const std::size_t i : rows) bits[i / list.width] |= 1U << i % list.width;
  chosen c{std::move(rows), {}, {}};
  std::vector<char> needed(total, 0);
  for (std::size_t r = 0; r < bits.size(); ++r) {
    if (bits[r] == 0) continue;
    const std::size_t first = r * list.width;
    c.of_rows.push_back({first, bits[r]});
    for (std::size_t i = first; i < std::min(total, first + list.width); ++i) needed[i] = 1;
    list.for_each(r, [&](std::uint32_t j, std::uint32_t) { needed[j] = 1; });
  }
  for (std::size_t i = 0; i < total; ++i)
    if (needed[i] != 0) c.seen.push_back(i);
  return c;
}

}  // namespace tetsuame::pairs
