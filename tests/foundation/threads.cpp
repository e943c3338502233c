// Loops whose chunks threads take from each other: each index once, whatever their number.
#include <omp.h>

#include <boost/test/unit_test.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <foundation/threads.hpp>
#include <limits>
#include <vector>

using namespace tetsuame::foundation;

namespace {

constexpr std::size_t sizes[] = {0, 1, 255, 8192, 8193, 100'003};

template <class F>
void with_threads(const F& f) {
  const int before = omp_get_max_threads();
  for (const int threads : {1, 2, 3, 16}) {
    omp_set_num_threads(threads);
    for (const std::size_t n : sizes) f(n);
  }
  omp_set_num_threads(before);
}

}  // namespace

BOOST_AUTO_TEST_CASE(every_index_comes_once) {
  with_threads([](std::size_t n) {
    std::vector<int> times(n, 0);
    for_all(n, [&](std::size_t i) { ++times[i]; });
    for_chunks(n, 7, n > 100, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) ++times[i];
    });
    BOOST_TEST(times == std::vector<int>(n, 2));
  });
}

BOOST_AUTO_TEST_CASE(chosen_indices_ascend) {
  const auto chosen = [](std::size_t i) { return i % 7 == 3 || i % 1000 < 20; };
  with_threads([&](std::size_t n) {
    std::vector<std::uint32_t> expected;
    for (std::size_t i = 0; i < n; ++i)
      if (chosen(i)) expected.push_back(static_cast<std::uint32_t>(i));
    BOOST_TEST(indices_where<std::uint32_t>(n, chosen) == expected);
  });
}

// What is not a number counts as none, as std::max has it.
BOOST_AUTO_TEST_CASE(extremes_are_those_of_one_thread) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  const auto value = [](std::size_t i) {
    return i % 5 == 2 ? none : std::sin(static_cast<double>(i * 2654435761U % 1000003U));
  };
  with_threads([&](std::size_t n) {
    double largest = -0.5, smallest = 0.5;
    for (std::size_t i = 0; i < n; ++i) {
      largest = std::max(largest, value(i));
      smallest = std::min(smallest, value(i));
    }
    BOOST_TEST(largest_of(n, -0.5, value) == largest);
    BOOST_TEST(smallest_of(n, 0.5, value) == smallest);
  });
}
