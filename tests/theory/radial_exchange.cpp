// Exchange of a round body with its surroundings, against exact series and what must be conserved.
#include <boost/math/special_functions/bessel.hpp>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <numbers>
#include <theory/radial_exchange.hpp>

using namespace tetsuame;
namespace tt = boost::test_tools;

namespace {

// Surroundings that diffuse so fast that they are well stirred.
theory::radial_exchange stirred(int dimension, double partition) {
  return {dimension, 1.0, 3.0, 2.0, 1.0, 1.0, 1e5, 0.0, 1.0, [=](double) { return partition; }};
}

// Uptake over that at infinite time of a sphere whose well-stirred surroundings lose what it gains; time is D t/a^2,
// alpha (volume outside)/(volume of the sphere)/(concentration inside over outside at equilibrium) [J. Crank, The
// Mathematics of Diffusion, 2nd ed., Oxford (1975), (6.30)].
double limited_uptake(double fourier, double alpha) {
  // tan q = 3 q/(3 + alpha q^2) has one root in each (n pi, n pi + pi/2).
  const auto excess = [&](double q) { return std::sin(q) * (3.0 + alpha * q * q) - 3.0 * q * std::cos(q); };
  double sum = 0.0;
  for (int n = 1; n <= 100; ++n) {
    double low = n * std::numbers::pi, high = low + 0.5 * std::numbers::pi;
    const bool rises = excess(high) > 0.0;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      ((excess(middle) > 0.0) == rises ? high : low) = middle;
    }
    const double q = 0.5 * (low + high);
    sum += 6.0 * alpha * (1.0 + alpha) * std::exp(-q * q * fourier) / (9.0 + 9.0 * alpha + q * q * alpha * alpha);
  }
  return 1.0 - sum;
}

}  // namespace

// A sphere in well-stirred surroundings of limited volume.
BOOST_AUTO_TEST_CASE(sphere_in_stirred_surroundings) {
  const double P = 5.0;
  const std::vector<double> times{0.02, 0.1, 0.4};
  const auto p = stirred(3, P);
  const double alpha = (std::pow(p.shell, 3) - 1.0) * p.density_outside / (P * p.density_inside);
  const auto mean = theory::mean_inside(p, times);
  for (std::size_t k = 0; k < times.size(); ++k)
    BOOST_TEST(mean[k] == P * alpha / (1.0 + alpha) * limited_uptake(times[k], alpha), tt::tolerance(1e-3));
}

// A cylinder whose surface hardly changes: 1 - Σ 4/j² exp(-j² t), j the zeros of J0 [Crank (5.23)].
BOOST_AUTO_TEST_CASE(cylinder_in_much) {
  auto p = stirred(2, 1.0);
  p.density_outside = 1e5;
  const std::vector<double> times{0.05, 0.2};
  const auto mean = theory::mean_inside(p, times);
  // In double: where long double has 113 bits (ARM), Boost 1.74 has no number for the third zero.
  constexpr boost::math::policies::policy<boost::math::policies::promote_double<false>> in_double;
  for (std::size_t k = 0; k < times.size(); ++k) {
    double left = 0.0;
    for (int n = 1; n < 40; ++n) {
      const double j = boost::math::cyl_bessel_j_zero(0.0, n, in_double);
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
