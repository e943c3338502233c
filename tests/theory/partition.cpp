#include <theory/partition.hpp>

#include "close.hpp"

namespace theory = tetsuame::theory;

BOOST_AUTO_TEST_CASE(partition_coefficients) {
  const auto exchange_coefficient = [](const theory::exchange_law& law, double p, double T) {
    return theory::partition_coefficient(law, p, T, 1.0);
  };
  // By hand: 1.06 + 1553/2500 - 98*10/2500 = 1.2892
  BOOST_TEST(close(exchange_coefficient(theory::nickel, 10e9, 2500.0), std::pow(10.0, 1.2892), 1e-12));
  BOOST_TEST(
      close(theory::partition_coefficient(theory::nickel, 10e9, 2500.0, 12.0), 12.0 * std::pow(10.0, 1.2892), 1e-12));
  // Less siderophile with depth, nickel more so than cobalt: they meet, as in the mantle, at tens of GPa.
  const auto ratio = [&](double p, double T) {
    return exchange_coefficient(theory::nickel, p, T) / exchange_coefficient(theory::cobalt, p, T);
  };
  BOOST_TEST(ratio(1e5, 2000.0) > 4.0);
  BOOST_TEST(ratio(50e9, 3500.0) < 0.6 * ratio(1e5, 2000.0));
  BOOST_CHECK_THROW(theory::partition_coefficient(theory::nickel, 1e9, 0.0, 1.0), tetsuame::foundation::error);
}
