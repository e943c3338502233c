// Closed forms against the equations they solve and the values of the standard tests.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <exact/flows.hpp>

namespace exact = tetsuame::exact;
namespace riemann = tetsuame::riemann;

namespace {

bool close(double a, double b, double relative) { return std::abs(a - b) <= relative * std::abs(b); }

}  // namespace

// Sod's tube at t = 0.2: the waves' places from the published star state, u* = 0.927453, shock at
// 1.752156 [Toro (2009), test 1].
BOOST_AUTO_TEST_CASE(sod_profile) {
  const exact::shock_tube sod(riemann::side<double>{1.0, 0.0, 1.0, 1.4, 0.0},
                              riemann::side<double>{0.125, 0.0, 0.1, 1.4, 0.0});
  const double t = 0.2, contact = 0.927453 * t, shock = 1.752156 * t;
  BOOST_TEST(close(sod.at(contact - 1e-6, t).rho, 0.426319, 2e-6));
  BOOST_TEST(close(sod.at(contact + 1e-6, t).rho, 0.265574, 2e-6));
  BOOST_TEST(close(sod.at(shock - 1e-6, t).p, 0.303130, 2e-6));
  BOOST_TEST(sod.at(shock + 1e-6, t).p == 0.1);
  // In the fan u - c = x/t and u + 5 c = 5 c_l, so u = (c_l + x/t)/1.2.
  const exact::primitive fan = sod.at(-0.5 * t, t);
  BOOST_TEST(close(fan.u, (std::sqrt(1.4) - 0.5) / 1.2, 1e-14));
  BOOST_TEST(close(std::sqrt(1.4 * fan.p / fan.rho), fan.u + 0.5, 1e-13));
  BOOST_TEST(close(fan.p, std::pow(fan.rho, 1.4), 1e-13));
  BOOST_TEST(sod.at(-1e-9, 0.0).rho == 1.0);
}

// gamma 5/3: 4, 16, 64 times the density behind the shock, which is at t/3; ahead (1 + t/r)^(D-1). Mass
// within r < 1 has to be what was there and what flowed in through r = 1.
BOOST_AUTO_TEST_CASE(noh_implosion) {
  double factor = 1.0;
  for (int D = 1; D <= 3; ++D) {
    factor *= 4.0;
    const exact::noh n{D, 5.0 / 3.0, 1.0, 1.0};
    const double t = 0.6, r_s = n.shock_radius(t);
    BOOST_TEST(close(r_s, 0.2, 1e-14));
    BOOST_TEST(close(n.at(0.1, t).rho, factor, 1e-13));
    BOOST_TEST(close(n.at(0.1, t).p, factor / 3.0, 1e-13));
    BOOST_TEST(n.at(0.3, t).rho == std::pow(3.0, D - 1));
    double mass = factor * std::pow(r_s, D) / D;
    constexpr int cells = 2000;  // middle points: error (0.8/2000)^2
    for (int i = 0; i < cells; ++i) {
      const double r = r_s + (i + 0.5) * (1.0 - r_s) / cells;
      mass += n.at(r, t).rho * std::pow(r, D - 1) * (1.0 - r_s) / cells;
    }
    // The gas now within r = 1 was within 1 + t.
    BOOST_TEST(close(mass, std::pow(1.0 + t, D) / D, 1e-6));
    // Rankine-Hugoniot in the frame of the shock.
    const exact::primitive a = n.at(r_s * (1.0 + 1e-12), t), b = n.at(0.5 * r_s, t);
    const double s = r_s / t;
    BOOST_TEST(close(a.rho * (a.u - s), b.rho * (b.u - s), 1e-9));
    BOOST_TEST(close(a.rho * (a.u - s) * (a.u - s), b.p + b.rho * s * s, 1e-9));
  }
}

BOOST_AUTO_TEST_CASE(gresho_vortex_is_in_balance) {
  const exact::gresho g;
  BOOST_TEST(close(g.velocity(0.2), 1.0, 1e-14));
  BOOST_TEST(close(g.velocity(0.1), 0.5, 1e-14));
  BOOST_TEST(g.velocity(0.5) == 0.0);
  // as it is usually written: 9 + 12.5 r^2 - 20 r + 4 ln(5 r), and 3 + 4 ln 2 outside
  BOOST_TEST(close(g.pressure(0.3), 9.0 + 12.5 * 0.09 - 6.0 + 4.0 * std::log(1.5), 1e-14));
  BOOST_TEST(close(g.pressure(0.7), 3.0 + 4.0 * std::log(2.0), 1e-14));
  const exact::gresho other{3.0, 2.0, 5.0, 100.0};
  for (const double r : {0.5, 2.9, 3.1, 5.0, 5.9, 6.1}) {
    const double d = 1e-4, slope = (other.pressure(r + d) - other.pressure(r - d)) / (2.0 * d);
    BOOST_TEST(std::abs(slope - 5.0 * other.velocity(r) * other.velocity(r) / r) < 1e-6);
  }
}
