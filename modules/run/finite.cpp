#include <algorithm>
#include <array>
#include <atomic>
#include <foundation/threads.hpp>
#include <run/finite.hpp>

namespace tetsuame::run {

namespace {

// 0 times a finite number is 0, times any other it is none; a sum keeps that. Several sums, for wide registers.
bool are_finite(const double* values, std::size_t n) {
  std::array<double, 16> zeros{};
  std::size_t i = 0;
  for (; i + zeros.size() <= n; i += zeros.size())
    for (std::size_t k = 0; k < zeros.size(); ++k) zeros[k] += 0.0 * values[i + k];
  double sum = 0.0;
  for (; i < n; ++i) sum += 0.0 * values[i];
  for (const double zero : zeros) sum += zero;
  return sum == 0.0;
}

}  // namespace

bool all_finite(std::span<const double* const> arrays, std::size_t n) {
  constexpr std::size_t block = 2048;  // values, which are read where the rates' loop left them in the cache
  std::atomic<bool> finite{true};
  foundation::for_chunks(n, block, n > foundation::values_worth_threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t begin = first; begin < last; begin += block)
      for (const double* values : arrays)
        if (!are_finite(values + begin, std::min(block, last - begin))) finite = false;
  });
  return finite;
}

}  // namespace tetsuame::run
