// Each kernel in each dimension: normalisation, gradient, knots, support.
#include <boost/math/quadrature/gauss.hpp>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <foundation/error.hpp>
#include <limits>
#include <numbers>

#include "all_kernels.hpp"

using namespace tetsuame::kernels;
using namespace tetsuame::kernels::test;

namespace {

template <class Kernel>
double integral(const Kernel& kernel) {
  constexpr int D = Kernel::dimension;
  const auto shell = [&](double r) {
    const double area = D == 1 ? 2.0 : D == 2 ? 2.0 * std::numbers::pi * r : 4.0 * std::numbers::pi * r * r;
    return area * kernel.value(r);
  };
  double sum = 0.0;
  for (int k = 0; k < 6; ++k) sum += boost::math::quadrature::gauss<double, 10>::integrate(shell, knot(k), knot(k + 1));
  return sum;
}

}  // namespace

// Gauss' formula with 10 points is exact up to degree 19, the integrands have at most 13:
// only rounding is left.
BOOST_AUTO_TEST_CASE_TEMPLATE(integrates_to_one, Kernel, all_kernels) {
  BOOST_TEST(std::abs(integral(Kernel(support)) - 1.0) < 1e-13);
}

// The constant 3/(358 pi h^3) printed in the note would make this 1.00559.
BOOST_AUTO_TEST_CASE(the_quintic_in_3d_has_the_exact_constant) {
  const double h = support / 3.0;
  const double printed = 66.0 * 3.0 / (358.0 * std::numbers::pi * h * h * h);
  BOOST_TEST(std::abs(printed / quintic_spline<3>(support).self() - 360.0 / 358.0) < 1e-14);
}

// Five-point differences with a step of 1e-3 S: the error of the formula is (1e-3)^4 / 30
// times a fifth derivative, at most about 1e5 W(0)/S^5 here: 4e-9; points stay clear of the knots.
BOOST_AUTO_TEST_CASE_TEMPLATE(gradient_is_the_derivative, Kernel, all_kernels) {
  const Kernel kernel(support);
  const double d = 1e-3 * support;
  for (int k = 1; k < 60; ++k) {
    const double r = support * (k + 0.5) / 60.0;
    const double difference =
        (8.0 * (kernel.value(r + d) - kernel.value(r - d)) - kernel.value(r + 2.0 * d) + kernel.value(r - 2.0 * d)) /
        (12.0 * d);
    BOOST_TEST(std::abs(kernel.gradient_over_r(r) * r - difference) < 1e-8 * kernel.self() / support);
    BOOST_TEST(kernel.gradient_over_r(r) < 0.0);
  }
}

// Across a knot nothing may jump by more than the slope times the distance of two
// neighbouring doubles, and rounding.
BOOST_AUTO_TEST_CASE_TEMPLATE(continuous_at_the_knots, Kernel, all_kernels) {
  const Kernel kernel(support);
  for (int k = 1; k <= 6; ++k) {
    const double below = std::nextafter(knot(k), 0.0), above = std::nextafter(knot(k), 2.0 * support);
    BOOST_TEST(std::abs(kernel.value(above) - kernel.value(below)) < 1e-13 * kernel.self());
    BOOST_TEST(std::abs(kernel.gradient_over_r(above) - kernel.gradient_over_r(below)) <
               1e-12 * kernel.self() / (support * support));
  }
}

BOOST_AUTO_TEST_CASE_TEMPLATE(vanishes_beyond_its_support, Kernel, all_kernels) {
  const Kernel kernel(support);
  for (const double r : {support * (1.0 + 1e-15), 1.01 * support, 10.0 * support, 1e60 * support}) {
    BOOST_TEST(kernel.value(r) == 0.0);
    BOOST_TEST(kernel.gradient_over_r(r) == 0.0);
  }
  BOOST_TEST(kernel.value(0.99 * support) > 0.0);
  BOOST_TEST(kernel.gradient_over_r(0.99 * support) < 0.0);
}

BOOST_AUTO_TEST_CASE_TEMPLATE(is_finite_at_the_origin, Kernel, all_kernels) {
  const Kernel kernel(support);
  BOOST_TEST(kernel.value(0.0) == kernel.self());
  for (const double r : {0.0, 5e-324, 1e-300, 1e-20, 1e-12, 1e-6}) {
    const double f = kernel.gradient_over_r(r);
    BOOST_TEST(std::isfinite(f));
    // |f| may not exceed its limit at 0 by more than a rounding error blown up by 1e9.
    BOOST_TEST(std::abs(f) < 200.0 * kernel.self() / (support * support));
  }
}

// The limits named in the headers, reached where the bracket is not yet lost in rounding:
// the next order is r/S ~ 1e-5, the rounding error 1e-14/1e-5 ~ 1e-9.
BOOST_AUTO_TEST_CASE(limits_of_the_gradient_at_the_origin) {
  const double r = 1e-6 * support;
  const auto in_h_at = [](const auto& kernel, double at) {
    const double h = support / kernel.support_over_h;
    return kernel.gradient_over_r(at) / kernel.self() * h * h;
  };
  const auto in_h = [&](const auto& kernel) { return in_h_at(kernel, r); };
  BOOST_TEST(std::abs(in_h(quintic_spline<2>(support)) + 120.0 / 66.0) < 1e-4);
  BOOST_TEST(std::abs(in_h(cubic_spline<3>(support)) + 12.0 / 4.0) < 1e-4);
  // A few roundings of the pieces, some 1e-14, over the least r, 1e-9 h.
  BOOST_TEST(std::abs(in_h_at(quintic_spline<3>(support), 0.0)) < 1e-4);
  BOOST_TEST(std::abs(in_h_at(cubic_spline<1>(support), 0.0)) < 1e-4);
}

// W and W'(r)/r from powers in common. The quintic's terms, the largest, are 4 W(0) and 22 W(0)/(S r), rounded some ten
// times in either way. Nothing beyond the support, and where the pair loop puts neighbours that a particle has not.
BOOST_AUTO_TEST_CASE_TEMPLATE(both_in_common_are_the_same_functions, Kernel, all_kernels) {
  const Kernel kernel(support);
  const in_common<Kernel> common(kernel);
  constexpr double rounding = 0.5 * std::numeric_limits<double>::epsilon();
  double w, f;
  for (int k = 0; k <= 300; ++k) {
    const double r = std::max(support * k / 300.0, kernel.smallest_r());
    common.both(r, 1.0 / r, w, f);
    BOOST_TEST(std::abs(w - kernel.value(r)) < 4.0 * 20 * rounding * kernel.self());
    BOOST_TEST(std::abs(f - kernel.gradient_over_r(r)) < 22.0 * 20 * rounding * kernel.self() / (support * r));
  }
  for (const double r : {support * (1.0 + 1e-15), 1.01 * support, 1e60 * support}) {
    common.both(r, 1.0 / r, w, f);
    BOOST_TEST(w == 0.0);
    BOOST_TEST(f == 0.0);
  }
}

BOOST_AUTO_TEST_CASE(by_name) {
  for (const entry& line : table) {
    const double h = 1.7;
    std::visit(
        [&](const auto& kernel) {
          BOOST_TEST(kernel.name == line.name);
          BOOST_TEST(std::abs(kernel.support() - line.support_over_h * h) < 1e-15 * h);
          BOOST_TEST(kernel.default_h_over_dx == line.default_h_over_dx);
        },
        make<3>(line.name, h));
  }
}

BOOST_AUTO_TEST_CASE(bad_input_is_refused) {
  const auto names_the_choices = [](const tetsuame::foundation::error& e) {
    return e.status() == tetsuame::foundation::exit_status::bad_input &&
           std::string(e.what()).find("wendland_c6") != std::string::npos;
  };
  BOOST_CHECK_EXCEPTION(make<2>("septic", 1.0), tetsuame::foundation::error, names_the_choices);
}
