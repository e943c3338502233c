// Exchange of a round body with its surroundings, against exact series and what must be conserved.
#include <boost/math/special_functions/bessel.hpp>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <theory/radial_exchange.hpp>
#include <theory/sphere_uptake.hpp>

using namespace tetsuame;
namespace tt = boost::test_tools;

namespace {

// Surroundings that diffuse so fast that they are well stirred.
theory::radial_exchange stirred(int dimension, double partition) {
  return {dimension, 1.0, 3.0, 2.0, 1.0, 1.0, 1e5, 0.0, 1.0, [=](double) { return partition; }};
}

}  // namespace

// A sphere in well-stirred surroundings of limited volume [Crank (6.30), theory/sphere_uptake.hpp].
BOOST_AUTO_TEST_CASE(sphere_in_stirred_surroundings) {
  const double P = 5.0;
  const std::vector<double> times{0.02, 0.1, 0.4};
  const auto p = stirred(3, P);
  const double alpha = (std::pow(p.shell, 3) - 1.0) * p.density_outside / (P * p.density_inside);
  const auto mean = theory::mean_inside(p, times);
  for (std::size_t k = 0; k < times.size(); ++k)
    BOOST_TEST(mean[k] == P * alpha / (1.0 + alpha) * theory::limited_uptake(times[k], alpha), tt::tolerance(1e-3));
}

// A cylinder whose surface hardly changes: 1 - Σ 4/j² exp(-j² t), j the zeros of J0 [Crank (5.23)].
BOOST_AUTO_TEST_CASE(cylinder_in_much) {
  auto p = stirred(2, 1.0);
  p.density_outside = 1e5;
  const std::vector<double> times{0.05, 0.2};
  const auto mean = theory::mean_inside(p, times);
  for (std::size_t k = 0; k < times.size(); ++k) {
    double left = 0.0;
    for (int n = 1; n < 40; ++n) {
      const double j = boost::math::cyl_bessel_j_zero(0.0, n);
      left += 4.0 / (j * j) * std::exp(-j * j * times[k]);
    }
    BOOST_TEST(mean[k] == 1.0 - left, tt::tolerance(1e-3));
  }
}

// Equilibrium is kept, and reached: what is inside and outside then follows from P and the masses.
BOOST_AUTO_TEST_CASE(equilibrium) {
  for (const int d : {2, 3}) {
    theory::radial_exchange p{d, 1.0, 2.0, 2.0, 1.0, 0.3, 0.7, 4.0, 0.5, [](double) { return 8.0; }};
    for (const double c : theory::mean_inside(p, std::vector{0.1, 3.0})) BOOST_TEST(c == 4.0, tt::tolerance(1e-12));
    p.start_inside = 0.0;
    const double shell = (std::pow(2.0, d) - 1.0) * p.density_outside;
    BOOST_TEST(theory::mean_inside(p, std::vector{1e3})[0] == 8.0 * 0.5 * shell / (8.0 * p.density_inside + shell),
               tt::tolerance(1e-6));
  }
}
