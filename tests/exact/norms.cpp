// Norms and orders of made-up errors.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <exact/norms.hpp>
#include <foundation/error.hpp>
#include <vector>

namespace exact = tetsuame::exact;
namespace foundation = tetsuame::foundation;

BOOST_AUTO_TEST_CASE(norms_by_hand) {
  const std::vector<double> value{1.0, 2.0, 5.0}, want{1.0, 4.0, 2.0}, weight{1.0, 2.0, 3.0};
  const exact::error_norms plain = exact::norms(value, want), weighted = exact::norms(value, want, weight);
  BOOST_TEST(plain.l1 == 5.0 / 3.0);
  BOOST_TEST(plain.l2 == std::sqrt(13.0 / 3.0));
  BOOST_TEST(plain.maximum == 3.0);
  BOOST_TEST(weighted.l1 == 13.0 / 6.0);
  BOOST_TEST(weighted.l2 == std::sqrt(35.0 / 6.0));
  const std::vector<double> broken{std::nan(""), 2.0, 5.0};
  BOOST_TEST(std::isnan(exact::norms(broken, want).maximum));
  BOOST_TEST(std::isnan(exact::norms(broken, want).l1));
  BOOST_CHECK_THROW(exact::norms(value, {}), foundation::error);
}

BOOST_AUTO_TEST_CASE(order_of_a_power) {
  std::vector<double> spacing, error;
  for (const double h : {0.1, 0.05, 0.02}) {
    spacing.push_back(h);
    error.push_back(7.0 * std::pow(h, 1.5));
  }
  const exact::order_fit fit = exact::fit_order(spacing, error);
  BOOST_TEST(std::abs(fit.order - 1.5) < 1e-13);
  BOOST_TEST(std::abs(fit.intercept - std::log(7.0)) < 1e-12);
  BOOST_CHECK_THROW(exact::fit_order(std::vector{0.1, 0.1}, std::vector{1.0, 2.0}), foundation::error);
  BOOST_CHECK_THROW(exact::fit_order(std::vector{0.1, 0.2}, std::vector{1.0, 0.0}), foundation::error);
}
