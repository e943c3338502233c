// The structure of a shock with friction and conduction: fluxes through it are the same everywhere.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <exact/viscous_shock.hpp>

namespace exact = tetsuame::exact;

namespace {

bool close(double a, double b, double relative) { return std::abs(a - b) <= relative * std::abs(b); }

}  // namespace

// Mass, momentum p + rho w^2 - mu_L w' and energy w (rho e + p + rho w^2/2 - mu_L w) - k T', with k = mu_L c_p: fluxes
// in the frame of the shock, derivatives by central differences.
BOOST_AUTO_TEST_CASE(viscous_shock_conserves) {
  for (const double gamma : {1.4, 5.0 / 3.0})
    for (const double behind : {1.3, 6.0, 500.0}) {
      const double rho = 0.7, p = 1.1, friction = 0.03, d = 1e-5;
      const exact::viscous_shock shock(rho, p, gamma, behind * p, friction);
      const double s = shock.speed(), width = shock.width();
      for (double x = -3.0; x <= 3.0; x += 0.25) {
        const auto at = [&](double y) { return shock.at(y * width, 0.0); };
        const auto here = at(x), before = at(x - d), behind_it = at(x + d);
        const double w = s - here.u, slope = -(behind_it.u - before.u) / (2.0 * d * width);
        const double T_slope =
            (behind_it.p / behind_it.rho - before.p / before.rho) / (2.0 * d * width);  // times c_p - c_v
        const double c_p = gamma / (gamma - 1.0);                                       // over c_p - c_v
        BOOST_TEST(close(here.rho * w, rho * s, 1e-12));
        BOOST_TEST(close(here.p + here.rho * w * w + friction * slope, p + rho * s * s, 1e-7));
        const double enthalpy = c_p * here.p / here.rho + 0.5 * w * w;
        const double conducted = friction * c_p * T_slope + friction * w * slope;
        BOOST_TEST(close(here.rho * w * enthalpy + conducted, rho * s * (c_p * p / rho + 0.5 * s * s), 1e-7));
      }
      const auto far = shock.at(-60.0 * width, 0.0), ahead = shock.at(60.0 * width, 0.0);
      BOOST_TEST(close(far.p, behind * p, 1e-9));
      BOOST_TEST(close(far.rho, shock.density_behind(), 1e-9));
      BOOST_TEST(close(ahead.p, p, 1e-9));
      BOOST_TEST(std::abs(ahead.u) <= 1e-9 * s);
      // It moves as a whole; its middle has half the change, and the width is that over the slope.
      BOOST_TEST(close(shock.at(0.3 + s * 0.2, 0.2).rho, shock.at(0.3, 0.0).rho, 1e-12));
      BOOST_TEST(close(shock.at(0.0, 0.0).u, 0.5 * shock.flow_behind(), 1e-12));
      double steepest = 0.0;
      for (double x = -1.0; x <= 1.0; x += 1e-3)
        steepest =
            std::max(steepest, (shock.at(x * width, 0.0).u - shock.at((x + 1e-3) * width, 0.0).u) / (1e-3 * width));
      BOOST_TEST(close(steepest, shock.flow_behind() / width, 1e-4));
    }
}
