// How far apart particles come: what all have in common counts where nothing stands still, and numbers that are none
// do.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <run/apart.hpp>

#include "../support/mpi.hpp"

using namespace tetsuame;
using run::apart, run::apart_of;

namespace {

using test::mpi_environment;
BOOST_TEST_GLOBAL_FIXTURE(mpi_environment);

using vectors = std::vector<std::array<double, 2>>;

apart of(const vectors& all, const std::array<bool, 2>& drifts) {
  return apart_of<2>(all.size(), drifts, [&](std::size_t a, std::size_t i) { return all[i][a]; });
}

}  // namespace

BOOST_AUTO_TEST_CASE(a_common_part_counts_where_something_stands) {
  const vectors all{{9.0, 1.0}, {11.0, -1.0}, {10.0, 0.5}};
  BOOST_TEST(of(all, {false, false}).length() == std::sqrt(122.0));
  BOOST_TEST(of(all, {true, false}).length() == 1.2 * std::sqrt(2.0));
  BOOST_TEST(of(all, {true, true}).length() == 1.2 * std::sqrt(2.0));
  const auto middle = of(all, {true, true}).middle<2>();
  BOOST_TEST(middle[0] == 10.0);
  BOOST_TEST(middle[1] == 0.0);
  BOOST_TEST(of(all, {false, true}).length() == std::sqrt(122.0));  // along x it counts
}

// With little in common the longest vector is the measure: to the bit what it is where nothing drifts.
BOOST_AUTO_TEST_CASE(little_in_common_is_none) {
  const vectors all{{3.0, 0.1}, {-2.9, 0.3}, {0.0, -0.2}};
  BOOST_TEST(of(all, {true, true}).length() == of(all, {false, false}).length());
  BOOST_TEST(of({{0.0, 0.0}, {0.0, 0.0}}, {true, true}).length() == 0.0);
}

BOOST_AUTO_TEST_CASE(what_else_moves_counts_with_them) {
  auto some = of({{1.0, 0.0}, {1.0, 0.0}}, {true, true});
  BOOST_TEST(some.length() == 0.0);
  some.numbers[apart::at_least] = 0.25;
  BOOST_TEST(some.length() == 0.25);
}

// As on ranks of which some have no particles.
BOOST_AUTO_TEST_CASE(none_are_no_part_of_the_largest) {
  auto some = of({{9.0, 1.0}, {11.0, -1.0}}, {true, true});
  const auto none = of({}, {true, true});
  BOOST_TEST(none.length() == 0.0);
  for (std::size_t k = 0; k < some.numbers.size(); ++k) some.numbers[k] = std::max(some.numbers[k], none.numbers[k]);
  BOOST_TEST(some.length() == 1.2 * std::sqrt(2.0));
}

// A step that ended within its lists may go on, however short, as the bound grows with the vectors alone.
BOOST_AUTO_TEST_CASE(no_jumps) {
  const auto at = [](double common) { return of({{common + 1.0, 0.3}, {common - 1.0, -0.3}}, {true, true}).length(); };
  constexpr double step = 1e-3;
  for (double common = 0.0; common < 2.0; common += step) {
    BOOST_TEST(at(common + step) >= at(common) * (1.0 - 1e-14));
    BOOST_TEST(at(common + step) - at(common) <= 1.01 * step);
  }
}

// On few particles and on as many as threads share: wherever the lost one stands.
BOOST_AUTO_TEST_CASE(nan_is_kept) {
  for (const std::size_t n : {std::size_t{5}, std::size_t{40000}})
    for (const bool drifts : {false, true})
      for (const std::size_t lost : {std::size_t{0}, n / 2, n - 1}) {
        vectors all(n, {100.0, 0.0});
        all[n / 2] = {103.0, -4.0};
        BOOST_TEST(of(all, {drifts, drifts}).length() <= std::hypot(103.0, 4.0));
        all[lost][1] = std::nan("");
        BOOST_TEST(std::isnan(of(all, {drifts, drifts}).length()));
      }
}
