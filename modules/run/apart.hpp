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
#include <particles/particles.hpp>

namespace tetsuame::run {

// Of vectors on this rank; maxima over the ranks of `numbers` are those of all.
struct apart {
  static constexpr std::size_t longest = 0, at_least = 1, largest = 2, least = 5;
  // The longest vector's length, not a number where one is none; what moves beside the particles; along each axis the
  // largest component, and the least one, times -1.
  std::array<double, 8> numbers{};
  std::array<bool, 3> drifts{};  // the axes along which nothing stands still

  // A bound, of the vectors less that in the middle. It is at most √D times the length of the longest of these. Where
  // little more is in common than the frame's motion it is the longest vector's own length.
  double length() const {
    constexpr double in_common = 1.2;
    double square = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double up = numbers[largest + a], down = numbers[least + a];
      const double half = drifts[a] ? 0.5 * (up + down) : std::max(up, down);
      square += half * half;
    }
    const double around = std::sqrt(square), all = numbers[longest];
    return std::max(in_common * around < all ? around : all, numbers[at_least]);
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
  double square = 0.0, up[D], down[D];
  std::fill_n(up, D, -std::numeric_limits<double>::infinity());
  std::copy_n(up, D, down);
  bool known = true;  // OpenMP's max would drop NaN
#pragma omp parallel for schedule(static) reduction(max : square, up, down) reduction(&& : known) if (n > foundation::values_worth_threads)
  for (std::size_t i = 0; i < n; ++i) {
    double r2 = 0.0;
    for (std::size_t a = 0; a < D; ++a) {
      const double along = value(a, i);
      r2 += along * along;
      up[a] = std::max(up[a], along);
      down[a] = std::max(down[a], -along);
    }
    known = known && r2 == r2;
    square = std::max(square, r2);
  }
  found.numbers[apart::longest] = known ? std::sqrt(square) : std::numeric_limits<double>::quiet_NaN();
  std::copy_n(up, D, found.numbers.begin() + apart::largest);
  std::copy_n(down, D, found.numbers.begin() + apart::least);
  return found;
}

// Collective.
inline apart on_all(const domain::communicator& ranks, apart of) {
  ranks.maximum(of.numbers);
  return of;
}

}  // namespace tetsuame::run
