// Sums of doubles without rounding: a fixed-point number as wide as the range of
// double, so a sum has the same bits in any order and over any split into ranks
// and threads. [R. M. Neal, "Fast exact summation using small and large
// superaccumulators", arXiv:1505.05571 (2015): the small superaccumulator.]
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace tetsuame::foundation {

// The value is the sum of chunk[k] * 2^(32 k - 1074); a chunk has 64 bits, of which
// neighbouring chunks overlap by 32, so about 2^30 additions fit before carrying.
class exact_sum {
 public:
  static constexpr std::size_t chunks = 67;

  // Inline and without a branch on sign or size: a sum over particles calls it once a value.
  void add(double value) {
    constexpr std::int64_t low_32 = 0xffffffff;
    const auto bits = std::bit_cast<std::uint64_t>(value);
    const auto biased = static_cast<std::uint32_t>(bits >> 52) & 0x7ff;
    if (biased == 0x7ff) [[unlikely]] {
      add_special(value);
      return;
    }
    // value = +-mantissa * 2^(shift - 1074); a subnormal has no leading one and the shift of biased = 1
    const std::uint32_t normal = biased != 0;
    const std::uint64_t mantissa = (bits & ((std::uint64_t{1} << 52) - 1)) | (std::uint64_t{normal} << 52);
    const std::uint32_t shift = biased - normal;
    const std::uint32_t k = shift / 32, s = shift % 32;
    const auto sign = -static_cast<std::int64_t>(bits >> 63);  // 0 or -1: (x ^ sign) - sign is +-x
    const auto low = static_cast<std::int64_t>(mantissa << s) & low_32;
    const auto middle = static_cast<std::int64_t>(mantissa >> (32 - s)) & low_32;
    const auto high = static_cast<std::int64_t>((mantissa >> 32) >> (32 - s));
    data_[k] += (low ^ sign) - sign;
    data_[k + 1] += (middle ^ sign) - sign;
    data_[k + 2] += (high ^ sign) - sign;
    if (++pending_ == additions_before_carry) [[unlikely]]
      normalise();
  }
  void add(const exact_sum& other);
  // Carries so that every chunk but the top one lies in [0, 2^32): needed before
  // the chunks of several ranks are added together as integers.
  void normalise();
  // Nearest double, ties to even; not-a-number or infinity if one was added.
  double value() const;

  // For a reduction over ranks: normalise(), sum element by element as 64-bit integers.
  std::array<std::int64_t, chunks + 3>& raw() { return data_; }

 private:
  // An addition changes a chunk by less than 2^32: this many fit beside a carried value.
  static constexpr std::uint32_t additions_before_carry = 1U << 30;

  void add_special(double value);

  // chunks, then counts of +inf, -inf, nan
  std::array<std::int64_t, chunks + 3> data_{};
  std::uint32_t pending_ = 0;
};

}  // namespace tetsuame::foundation
