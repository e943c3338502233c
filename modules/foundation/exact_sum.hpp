// Sums of doubles without rounding: a fixed-point number as wide as the range of
// double, so a sum has the same bits in any order and over any split into ranks
// and threads. [R. M. Neal, "Fast exact summation using small and large
// superaccumulators", arXiv:1505.05571 (2015): the small superaccumulator.]
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace tetsuame::foundation {

// The value is the sum of chunk[k] * 2^(32 k - 1074); a chunk has 64 bits, of which
// neighbouring chunks overlap by 32, so about 2^30 additions fit before carrying.
class exact_sum {
 public:
  static constexpr std::size_t chunks = 67;

  void add(double value);
  void add(const exact_sum& other);
  // Carries so that every chunk but the top one lies in [0, 2^32): needed before
  // the chunks of several ranks are added together as integers.
  void normalise();
  // Nearest double, ties to even; not-a-number or infinity if one was added.
  double value() const;

  // For a reduction over ranks: normalise(), sum element by element as 64-bit integers.
  std::array<std::int64_t, chunks + 3>& raw() { return data_; }

 private:
  // chunks, then counts of +inf, -inf, nan
  std::array<std::int64_t, chunks + 3> data_{};
  std::uint32_t pending_ = 0;
};

}  // namespace tetsuame::foundation
