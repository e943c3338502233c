#include <foundation/exact_sum.hpp>

#include <cmath>
#include <limits>

namespace tetsuame::foundation {

namespace {

__extension__ using uint128 = unsigned __int128;

constexpr std::int64_t low_32 = 0xffffffff;
constexpr std::size_t plus_infinity = exact_sum::chunks;
constexpr std::size_t minus_infinity = exact_sum::chunks + 1;
constexpr std::size_t not_a_number = exact_sum::chunks + 2;

}  // namespace

void exact_sum::add_special(double value) {
  ++data_[std::isnan(value) ? not_a_number : value < 0 ? minus_infinity : plus_infinity];
}

void exact_sum::add(const exact_sum& other) {
  exact_sum carried = other;
  carried.normalise();
  for (std::size_t k = 0; k < data_.size(); ++k) data_[k] += carried.data_[k];
  if (++pending_ == additions_before_carry) normalise();
}

void exact_sum::normalise() {
  for (std::size_t k = 0; k + 1 < chunks; ++k) {
    data_[k + 1] += data_[k] >> 32;
    data_[k] &= low_32;
  }
  pending_ = 0;
}

double exact_sum::value() const {
  if (data_[not_a_number] > 0 || (data_[plus_infinity] > 0 && data_[minus_infinity] > 0))
    return std::numeric_limits<double>::quiet_NaN();
  if (data_[plus_infinity] > 0) return std::numeric_limits<double>::infinity();
  if (data_[minus_infinity] > 0) return -std::numeric_limits<double>::infinity();

  exact_sum magnitude = *this;
  magnitude.normalise();
  const bool negative = magnitude.data_[chunks - 1] < 0;
  if (negative) {
    for (std::size_t k = 0; k < chunks; ++k) magnitude.data_[k] = -magnitude.data_[k];
    magnitude.normalise();
  }
  std::size_t top = chunks;
  while (top > 0 && magnitude.data_[top - 1] == 0) --top;
  if (top == 0) return 0.0;
  --top;

  // The leading 65 to 128 bits, and one sticky bit for all that lies below, so that
  // the conversion's own rounding is that of the whole number.
  const auto chunk = [&](std::ptrdiff_t k) {
    return k >= 0 ? static_cast<uint128>(magnitude.data_[static_cast<std::size_t>(k)]) : static_cast<uint128>(0);
  };
  const auto k = static_cast<std::ptrdiff_t>(top);
  uint128 leading = (chunk(k) << 64) | (chunk(k - 1) << 32) | chunk(k - 2);
  for (std::ptrdiff_t below = k - 3; below >= 0; --below)
    if (magnitude.data_[static_cast<std::size_t>(below)] != 0) {
      leading |= 1;
      break;
    }
  const double result = std::ldexp(static_cast<double>(leading), static_cast<int>(32 * (k - 2)) - 1074);
  return negative ? -result : result;
}

}  // namespace tetsuame::foundation
