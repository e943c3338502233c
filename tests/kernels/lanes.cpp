// Each kernel in each dimension gives lanes the bits that it gives doubles.
#include <bit>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "all_kernels.hpp"

namespace stdx = std::experimental;
using namespace tetsuame::kernels;
using namespace tetsuame::kernels::test;

BOOST_AUTO_TEST_CASE_TEMPLATE(lanes_give_the_bits_of_doubles, Kernel, all_kernels) {
  const Kernel kernel(support);
  std::vector<double> distances{0.0, 1e-300, 1e-12, support, std::nextafter(support, 0.0), 2.0 * support};
  for (int k = 0; k <= 6; ++k) distances.push_back(knot(k));
  for (int k = 0; k < 300; ++k) distances.push_back(support * std::fmod(0.5 + k * std::numbers::phi, 1.2));

  const auto check = [&]<class Lanes>(Lanes) {
    for (std::size_t start = 0; start < distances.size(); ++start) {
      const auto at = [&](std::size_t lane) { return distances[(start + 7 * lane) % distances.size()]; };
      const Lanes r([&](auto lane) { return at(lane); });
      Lanes w, f;
      kernel.both(r, w, f);
      const Lanes value = kernel.value(r), gradient = kernel.gradient_over_r(r);
      for (std::size_t lane = 0; lane < Lanes::size(); ++lane) {
        const auto same = [](double a, double b) {
          return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
        };
        BOOST_REQUIRE(same(w[lane], kernel.value(at(lane))));
        BOOST_REQUIRE(same(f[lane], kernel.gradient_over_r(at(lane))));
        BOOST_REQUIRE(same(value[lane], w[lane]) && same(gradient[lane], f[lane]));
      }
    }
  };
  check(stdx::native_simd<double>());
  check(stdx::fixed_size_simd<double, 8>());
}
