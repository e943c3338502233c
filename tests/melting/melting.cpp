#include <boost/test/unit_test.hpp>
#include <cmath>
#include <foundation/error.hpp>
#include <melting/melting.hpp>

namespace melting = tetsuame::melting;
using melting::composition;

// The published pieces meet; Fiquet et al.'s solidus of peridotite, 4180 +- 150 K, and
// Andrault et al.'s solidus and liquidus, 4150 +- 150 and 4725 +- 150 K, at 135 GPa.
BOOST_AUTO_TEST_CASE(curves) {
  BOOST_TEST(std::abs(melting::solidus(135e9) - 4165.0) < 135.0);
  BOOST_TEST(std::abs(melting::liquidus(composition::chondritic, 135e9) - 4725.0) < 150.0);
  const double p = melting::transition, above = p * (1.0 + 1e-12);
  BOOST_TEST(std::abs(melting::solidus(p) - melting::solidus(above)) < 2.0);
  for (const composition c : {composition::peridotitic, composition::chondritic}) {
    BOOST_TEST(std::abs(melting::liquidus(c, p) - melting::liquidus(c, above)) < 2.0);
    for (double q = 0.0; q <= 140e9; q += 1e9) BOOST_TEST(melting::liquidus(c, q) > melting::solidus(q) + 50.0);
  }
  BOOST_TEST(melting::liquidus(composition::peridotitic, 135e9) >
             melting::liquidus(composition::chondritic, 135e9) + 500.0);
  // Hirschmann's fit (2000) to peridotite, 1120.661 + 132.899 P - 5.104 P^2 (C, GPa), at 3 GPa.
  BOOST_TEST(std::abs(melting::solidus(3e9) - 1746.572) < 300.0);
  BOOST_CHECK_THROW(melting::solidus(-2e9), tetsuame::foundation::error);
}

BOOST_AUTO_TEST_CASE(fraction) {
  BOOST_TEST(melting::melt_fraction(1500.0, 1600.0, 2000.0) == 0.0);
  BOOST_TEST(melting::melt_fraction(1700.0, 1600.0, 2000.0) == 0.25);
  BOOST_TEST(melting::melt_fraction(2100.0, 1600.0, 2000.0) == 1.0);
  BOOST_CHECK_THROW(melting::melt_fraction(1.0, 2.0, 2.0), tetsuame::foundation::error);
}

// By hand: 2.4e-4 e^4.6 = 0.0238763 at 2000 K; 3.8e9 e^(3.5e5/(8.314463*2000)) = 3.8e9 e^21.04766 = 5.2564e18.
BOOST_AUTO_TEST_CASE(viscosity) {
  const double T = 2000.0;
  BOOST_TEST(std::abs(melting::liquid_viscosity(T) / 0.0238763 - 1.0) < 1e-5);
  BOOST_TEST(std::abs(melting::solid_viscosity(T) / 5.2564e18 - 1.0) < 1e-3);
  BOOST_TEST(melting::suspension_viscosity(T, 1.0) == melting::liquid_viscosity(T));
  BOOST_TEST(melting::suspension_viscosity(T, 0.4) == melting::solid_viscosity(T));
  BOOST_TEST(melting::suspension_viscosity(T, 0.4 + 1e-12) == melting::solid_viscosity(T));  // capped
  // At f = 0.7 the crystals fill half of what locks them: 0.5^-2.5.
  BOOST_TEST(std::abs(melting::suspension_viscosity(T, 0.7) / melting::liquid_viscosity(T) - std::pow(2.0, 2.5)) <
             1e-9);
  const double middle = std::sqrt(melting::liquid_viscosity(T) * melting::solid_viscosity(T));
  BOOST_TEST(std::abs(melting::blended_viscosity(T, 0.4) / middle - 1.0) < 1e-12);
  double last = 2.0 * melting::solid_viscosity(T);
  for (double f = 0.0; f <= 1.0; f += 0.05) {
    BOOST_TEST(melting::blended_viscosity(T, f) < last);
    last = melting::blended_viscosity(T, f);
  }
  BOOST_CHECK_THROW(melting::liquid_viscosity(900.0), tetsuame::foundation::error);
}
