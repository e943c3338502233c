// The contact in a liquid that is hardly compressed, against the exact one of the stiffened gas that such a liquid is.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <riemann/acoustic.hpp>

using namespace tetsuame::riemann;

namespace {

// Water of p = B [(rho/1000)^7 - 1] with sound at 20 m/s.
constexpr double c0 = 20.0, rho0 = 1000.0, B = c0 * c0 * rho0 / 7.0;
liquid_side<double> water(double u, double p) { return {rho0 * std::pow(1.0 + p / B, 1.0 / 7.0), u, p}; }
side<double> gas(const liquid_side<double>& s) { return {s.rho, s.u, s.p, 7.0, B}; }

}  // namespace

// Without the limiter's restraint, waves of size a are missed by a²: ten times weaker, a hundred times less.
BOOST_AUTO_TEST_CASE(acoustics_of_weak_waves) {
  double last_p = 0.0, last_u = 0.0;
  for (const double a : {1e-2, 1e-3}) {
    const auto l = water(0.7 * a * c0, 0.5 * a * rho0 * c0 * c0), r = water(-0.4 * a * c0, -0.3 * a * rho0 * c0 * c0);
    const auto found = acoustic_contact(l, r, c0, 1e30);
    const auto exact = solve(gas(l), gas(r));
    const double miss_p = std::abs(found.p - exact.p) / (rho0 * c0 * c0), miss_u = std::abs(found.u - exact.u) / c0;
    BOOST_TEST(miss_p < 4.0 * a * a);
    BOOST_TEST(miss_u < 4.0 * a * a);
    if (last_p > 0.0) {
      BOOST_TEST(miss_p < 0.02 * last_p);
      BOOST_TEST(miss_u < 0.02 * last_u);
    }
    last_p = miss_p;
    last_u = miss_u;
  }
}

// Sides that part have the mean pressure; those that meet slowly a part of the acoustic rise, fast ones all of it.
BOOST_AUTO_TEST_CASE(limiter) {
  const auto contact = [](double u) { return acoustic_contact(water(u, 300.0), water(-u, 100.0), c0); };
  BOOST_TEST(contact(-1.0).p == 200.0);
  BOOST_TEST(contact(0.0).p == 200.0);
  const double rho = 0.5 * (water(0.0, 300.0).rho + water(0.0, 100.0).rho);
  BOOST_TEST(std::abs(contact(0.1).p - (200.0 + 0.5 * rho * 3.0 * 0.2 * 0.2)) < 1e-9);
  BOOST_TEST(std::abs(contact(5.0).p - (200.0 + 0.5 * rho * c0 * 10.0)) < 1e-9);
  BOOST_TEST(std::abs(contact(0.1).u - 100.0 / (rho * c0)) < 1e-15);
}

// The same seen from the other side, to the bit: what one particle gets the other loses.
BOOST_AUTO_TEST_CASE(from_either_side) {
  const auto l = water(0.31, 123.0), r = water(-0.17, 456.0), l_back = water(0.17, 456.0), r_back = water(-0.31, 123.0);
  const auto there = acoustic_contact(l, r, c0), back = acoustic_contact(l_back, r_back, c0);
  BOOST_TEST(there.p == back.p);
  BOOST_TEST(there.u == -back.u);
}
