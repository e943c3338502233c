// The exact solutions of the cooling plate and half space, by quadrature of the heat kernel.
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <conduction/exact.hpp>
#include <numbers>

using namespace tetsuame;
namespace tt = boost::test_tools;

namespace {

// Green's function of the line, odd images about y = 0 and y = L, on the start T1 of the excess over the steady state.
double plate_by_quadrature(double T0, double T1, double kappa, double L, double depth, double t) {
  const double width = std::sqrt(4.0 * kappa * t);
  const auto kernel = [&](double a) {
    return std::exp(-a * a / (width * width)) / (width * std::sqrt(std::numbers::pi));
  };
  const auto integrand = [&](double s) {
    double g = 0.0;
    for (int k = -20; k <= 20; ++k) g += kernel(depth - s - 2.0 * k * L) - kernel(depth + s - 2.0 * k * L);
    return g * (T1 - (T0 + (T1 - T0) * s / L));
  };
  using rule = boost::math::quadrature::gauss_kronrod<double, 61>;
  return T0 + (T1 - T0) * depth / L + rule::integrate(integrand, 0.0, L, 12, 1e-12);
}

}  // namespace

BOOST_AUTO_TEST_CASE(plate) {
  // Both forms of the series, and where they meet at kappa t/L^2 = 0.02.
  for (const double t : {100.0, 799.0, 801.0, 4000.0, 40000.0})
    for (const double depth : {0.01, 0.07, 0.15, 0.199})
      BOOST_TEST(conduction::plate(300.0, 1300.0, 1e-6, 0.2, depth, t) ==
                     plate_by_quadrature(300.0, 1300.0, 1e-6, 0.2, depth, t),
                 tt::tolerance(1e-10));
  BOOST_TEST(conduction::plate(0.0, 1.0, 1e-6, 0.2, 0.0, 500.0) == 0.0, tt::tolerance(1e-14));
  BOOST_TEST(conduction::plate(0.0, 1.0, 1e-6, 0.2, 0.2, 5000.0) == 1.0, tt::tolerance(1e-12));
  BOOST_TEST(conduction::plate(0.0, 1.0, 1e-6, 0.2, 0.1, 0.0) == 1.0);
}

BOOST_AUTO_TEST_CASE(half_space) {
  // A plate that has not felt its bottom.
  for (const double depth : {0.001, 0.01, 0.05})
    BOOST_TEST(
        conduction::half_space(0.0, 1.0, 1e-6, depth, 100.0) == conduction::plate(0.0, 1.0, 1e-6, 0.2, depth, 100.0),
        tt::tolerance(1e-12));
  BOOST_TEST(conduction::half_space(5.0, 1.0, 1e-6, 0.0, 0.0) == 5.0);
  BOOST_TEST(conduction::half_space(5.0, 1.0, 1e-6, 0.1, 0.0) == 1.0);
}
