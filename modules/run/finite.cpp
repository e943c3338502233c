#include <algorithm>
#include <array>
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
  const std::size_t blocks = (n + block - 1) / block;
  bool finite = true;
#pragma omp parallel for schedule(static) reduction(&& : finite) if (n > foundation::values_worth_threads)
  for (std::size_t b = 0; b < blocks; ++b)
    for (const double* values : arrays)
      finite = finite && are_finite(values + b * block, std::min(block, n - b * block));
  return finite;
}

}  // namespace tetsuame::run
