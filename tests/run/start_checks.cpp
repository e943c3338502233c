// Neighbourhoods of a start: how near, how full; and pairs at one place.
#include <algorithm>
#include <array>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <run/start_checks.hpp>

using namespace tetsuame::run;
namespace tt = boost::test_tools;

namespace {

constexpr double dx = 0.1;  // m

// n cells along each axis, from a corner.
std::vector<double> lattice(int dimension, int n, double corner = 0.0) {
  std::vector<double> x;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < (dimension > 1 ? n : 1); ++j)
      for (int k = 0; k < (dimension > 2 ? n : 1); ++k)
        for (std::size_t a = 0; a < static_cast<std::size_t>(dimension); ++a)
          x.push_back(corner + (std::array{i, j, k}[a] + 0.5) * dx);
  return x;
}

neighbourhoods around(int dimension, const std::vector<double>& x, double length, bool periodic,
                      double reach = 2.5 * dx) {
  const std::size_t n = x.size() / static_cast<std::size_t>(dimension);
  return find_neighbourhoods({dimension, {length, length, length}, {periodic, periodic, periodic}}, x,
                             std::vector<double>(n, std::pow(dx, dimension)), std::vector<double>(n, reach));
}

}  // namespace

// The sum of the kernel over its lattice is 1 to the error of a quadrature with 2.5 points to the support.
BOOST_AUTO_TEST_CASE(a_lattice_is_full_once) {
  for (const int dimension : {1, 2, 3}) {
    const auto found = around(dimension, lattice(dimension, 8), 8 * dx, true);
    for (const double filled : found.filled) BOOST_TEST(filled == 1.0, tt::tolerance(0.03));
    for (const double nearest : found.nearest) BOOST_TEST(nearest == dx, tt::tolerance(1e-12));
    const auto open = around(dimension, lattice(dimension, 8), 8 * dx, false);
    BOOST_TEST(open.filled.front() < 0.8);  // at a corner
    BOOST_TEST(*std::ranges::max_element(open.filled) < 1.03);
  }
}

BOOST_AUTO_TEST_CASE(two_lattices_are_full_twice) {
  for (const int dimension : {1, 2, 3}) {
    auto x = lattice(dimension, 8);
    const auto other = lattice(dimension, 4, 2.4 * dx);
    x.insert(x.end(), other.begin(), other.end());
    const auto found = around(dimension, x, 8 * dx, true);
    BOOST_TEST(*std::ranges::max_element(found.filled) > 1.8);
  }
}

BOOST_AUTO_TEST_CASE(alone) {
  auto x = lattice(2, 3);
  x.insert(x.end(), {0.75, 0.75});  // the nearest at (0.25, 0.25): 0.707 m; across the border 0.424 m
  BOOST_TEST(std::isinf(around(2, x, 0.9, false, 0.7).nearest.back()));
  BOOST_TEST(around(2, x, 0.9, false, 0.71).nearest.back() == 0.5 * std::sqrt(2.0), tt::tolerance(1e-12));
  BOOST_TEST(around(2, x, 0.9, true, 0.7).nearest.back() == std::hypot(0.2, 0.2), tt::tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(at_one_place) {
  auto x = lattice(2, 4);
  const start_region box{2, {4 * dx, 4 * dx, 0.0}, {true, false, false}};
  BOOST_TEST(!find_coincident(box, x, 1e-6 * dx).has_value());
  x.insert(x.end(), {x[0] + 1e-8 * dx, x[1]});
  const auto pair = find_coincident(box, x, 1e-6 * dx);
  BOOST_TEST(pair.has_value());
  BOOST_TEST(std::min(pair->first, pair->second) == 0U);
  BOOST_TEST(std::max(pair->first, pair->second) == 16U);
  const std::vector<double> across{1e-9 * dx, 0.1, 4 * dx - 1e-9 * dx, 0.1};
  BOOST_TEST(find_coincident(box, across, 1e-6 * dx).has_value());
  BOOST_TEST(!find_coincident({2, {4 * dx, 4 * dx, 0.0}, {false, false, false}}, across, 1e-6 * dx).has_value());
}
