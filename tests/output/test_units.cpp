// Units as texts: what they mean, and what is none.
#include <output/units.hpp>

#include "scratch.hpp"

using namespace tetsuame::output;

BOOST_AUTO_TEST_CASE(texts_of_units) {
  struct expected {
    const char* text;
    double factor;
    std::array<int, 4> powers;
  };
  for (const auto& e : {expected{"m", 1.0, {1, 0, 0, 0}},          expected{"km", 1e3, {1, 0, 0, 0}},
                        expected{"mm", 1e-3, {1, 0, 0, 0}},        expected{"Mm", 1e6, {1, 0, 0, 0}},
                        expected{"\xc2\xb5m", 1e-6, {1, 0, 0, 0}}, expected{"m/s", 1.0, {1, 0, -1, 0}},
                        expected{"cm s-1", 1e-2, {1, 0, -1, 0}},   expected{"km.s-1", 1e3, {1, 0, -1, 0}},
                        expected{"kg/m^3", 1.0, {-3, 1, 0, 0}},    expected{"g cm**-3", 1e3, {-3, 1, 0, 0}},
                        expected{"g/cm3", 1e3, {-3, 1, 0, 0}},     expected{"kg/m", 1.0, {-1, 1, 0, 0}},
                        expected{"1000 kg", 1e3, {0, 1, 0, 0}},    expected{"K", 1.0, {0, 0, 0, 1}},
                        expected{"GPa", 1e9, {-1, 1, -2, 0}},      expected{"J/kg", 1.0, {2, 0, -2, 0}},
                        expected{"erg/g", 1e-4, {2, 0, -2, 0}},    expected{"W/(m K)", 1.0, {1, 1, -3, -1}},
                        expected{"W/m/K", 1.0, {1, 1, -3, -1}},    expected{"min", 60.0, {0, 0, 1, 0}},
                        expected{"Myr", 3.15576e13, {0, 0, 1, 0}}, expected{"1", 1.0, {}},
                        expected{"dimensionless", 1.0, {}},        expected{"1/s", 1.0, {0, 0, -1, 0}}}) {
    const auto found = unit_of(e.text);
    BOOST_REQUIRE_MESSAGE(found, e.text);
    BOOST_TEST(found->factor == e.factor, boost::test_tools::tolerance(1e-14));
    BOOST_TEST((found->powers == e.powers), e.text);
  }
  for (const char* text :
       {"", "knots", "code_length", "kg//m", "m^", "m/", "(m", "m)", "m^x", "degC", "kpc/h", "0 m", "m s^99"})
    BOOST_TEST(!unit_of(text), text);
}

BOOST_AUTO_TEST_CASE(names_of_units) {
  for (const char* text : {"kg/m^3", "m/s", "K", "kg", "kg/m", "m", "1", "m^2/(s K)"})
    BOOST_TEST(name_of(unit_of(text)->powers) == text);
}
