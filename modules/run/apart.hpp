// A bound of how far, or how fast, particles move with respect to each other: what they have in common along an axis
// where all may drift together counts for nothing. The bound is the same in all frames of reference if the vectors are
// given in the frame that moves with the particles (pairs::workspace::frame).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <domain/communicator.hpp>
#include <foundation/threads.hpp>
#include <limits>
#include <mutex>
#include <particles/particles.hpp>

namespace tetsuame::run {

// Of vectors on this rank; maxima over the ranks of `numbers` are those of all.
struct apart {
  static constexpr std::size_t longest = 0, at_least = 1, largest = 2, least = 5;
  // The longest vector's length, not a number where one is none; what moves beside the particles; along each axis the
  // largest component, and the least one, times -1.
  std::array<double, 8> numbers{};
  std::array<bool, 3> drifts{};  // the axes along which nothing stands still

  // A bound: 1.2 times that of the vectors less that in the middle, which is at most √D times the length of the longest
  // of these; or the longest vector's own length where that is shorter, as where little is in common. It has no jumps,
  // at which a step would fail however short it is.
  double length() const {
    constexpr double in_common = 1.2;
    double square = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double up = numbers[largest + a], down = numbers[least + a];
      const double half = drifts[a] ? 0.5 * (up + down) : std::max(up, down);
      square += half * half;
    }
    const double around = std::sqrt(square), all = numbers[longest];
    return std::max(in_common * around < all ? in_common * around : all, numbers[at_least]);
  }

  // In the middle between the largest component and the least, along the axes that drift; zero where that is rounding.
  template <std::size_t D>
  std::array<double, D> middle() const {
    std::array<double, D> all{};
    for (std::size_t a = 0; a < D; ++a)
      if (const double m = 0.5 * (numbers[largest + a] - numbers[least + a]);
          drifts[a] && std::abs(m) > 1e-9 * numbers[longest])
        all[a] = m;
    return all;
  }
};

// value(axis, i) of n particles.
template <int D, class Value>
apart apart_of(std::size_t n, const std::array<bool, D>& drifts, const Value& value) {
  apart found;
  std::copy_n(drifts.begin(), D, found.drifts.begin());
  struct largest_values {
    double square = 0.0;
    std::array<double, D> up = all(-std::numeric_limits<double>::infinity()), down = up;
    bool known = true;  // a maximum would drop NaN

    static std::array<double, D> all(double value) {
      std::array<double, D> a;
      a.fill(value);
      return a;
    }
    void include(const largest_values& other) {
      square = std::max(square, other.square);
      for (std::size_t a = 0; a < D; ++a) {
        up[a] = std::max(up[a], other.up[a]);
        down[a] = std::max(down[a], other.down[a]);
      }
      known = known && other.known;
    }
  } most;
  std::mutex one_at_a_time;
  foundation::for_chunks(n, 4096, n > foundation::values_worth_threads, [&](std::size_t first, std::size_t last) {
    largest_values mine;
    for (std::size_t i = first; i < last; ++i) {
      double r2 = 0.0;
      for (std::size_t a = 0; a < D; ++a) {
        const double along = value(a, i);
        r2 += along * along;
        mine.up[a] = std::max(mine.up[a], along);
        mine.down[a] = std::max(mine.down[a], -along);
      }
      mine.known = mine.known && r2 == r2;
      mine.square = std::max(mine.square, r2);
    }
    const std::lock_guard lock(one_at_a_time);
    most.include(mine);
  });
  found.numbers[apart::longest] = most.known ? std::sqrt(most.square) : std::numeric_limits<double>::quiet_NaN();
  std::copy_n(most.up.begin(), D, found.numbers.begin() + apart::largest);
  std::copy_n(most.down.begin(), D, found.numbers.begin() + apart::least);
  return found;
}

// Collective.
inline apart on_all(const domain::communicator& ranks, apart of) {
  ranks.maximum(of.numbers);
  return of;
}

}  // namespace tetsuame::run
