// The solver on lanes does what the one for double does, lane by lane.
#include <array>
#include <boost/test/unit_test.hpp>
#include <riemann/approximate.hpp>

#include "ideal_gas.hpp"

using namespace tetsuame::riemann;
namespace stdx = std::experimental;

namespace {

using real = stdx::native_simd<double>;

real lane_values(const std::vector<double>& v, std::size_t first) {
  return real([&](auto lane) { return v[(first + lane) % v.size()]; });
}

// Shocks, fans, both, a vacuum, nothing at all: different neighbours for every start.
const std::vector<double> rho_l{1, 1, 1, 1, 2, 1, 1}, u_l{0, -2, 0, -9, 0.5, 0, 1}, p_l{1, 0.4, 1000, 0.4, 1, 1, 1e-9},
    rho_r{0.125, 1, 1, 1, 3, 1, 1}, u_r{0, 2, 0, 9, 0.5, 0.01, -1}, p_r{0.1, 0.4, 0.01, 0.4, 1, 1, 1e-9},
    p_inf{0, 0, 0, 0, 5, 2, 0};

}  // namespace

// libmvec's pow is within 4 ulp, which the exponents of p* and rho multiply.
BOOST_AUTO_TEST_CASE(lanes_equal_scalars) {
  for (std::size_t first = 0; first < rho_l.size(); ++first) {
    const auto at = [&](const std::vector<double>& v) { return lane_values(v, first); };
    const side<real> l{at(rho_l), at(u_l), at(p_l), real(1.4), at(p_inf)};
    const side<real> r{at(rho_r), at(u_r), at(p_r), real(5.0 / 3.0), at(p_inf)};
    const star<real> s = solve(l, r, 8);
    const contact<real> h = hllc_contact(l, r, sound_speed(l), sound_speed(r));
    for (std::size_t k = 0; k < real::size(); ++k) {
      const side<double> a{l.rho[k], l.u[k], l.p[k], 1.4, l.p_infinity[k]};
      const side<double> b{r.rho[k], r.u[k], r.p[k], 5.0 / 3.0, r.p_infinity[k]};
      const star<double> want = solve(a, b);
      BOOST_TEST(s.vacuum[k] == want.vacuum);
      const auto close = [](double x, double y, double scale) { return std::abs(x - y) <= 1e-13 * scale; };
      BOOST_TEST(close(s.p[k], want.p, std::abs(want.p) + a.p_infinity), first << ' ' << k << ' ' << s.p[k]);
      BOOST_TEST(close(s.u_l[k], want.u_l, sound_speed(a) + sound_speed(b)));
      BOOST_TEST(close(s.u_r[k], want.u_r, sound_speed(a) + sound_speed(b)));
      BOOST_TEST(close(s.rho_l[k], want.rho_l, want.rho_l));
      BOOST_TEST(close(s.rho_r[k], want.rho_r, want.rho_r));
      const contact<double> one = hllc_contact(a, b, sound_speed(a), sound_speed(b));
      BOOST_TEST(close(h.p[k], one.p, std::abs(one.p) + a.p + b.p));
      BOOST_TEST(close(h.u[k], one.u, sound_speed(a) + sound_speed(b)));
    }
  }
}

BOOST_AUTO_TEST_CASE(not_a_number_stays_in_its_lane) {
  real p(1.0);
  p[0] = std::nan("");
  const star<real> s =
      solve(ideal_gas(real(1.0), real(0.0), p, real(1.4)), ideal_gas(real(0.125), real(0.0), real(0.1), real(1.4)), 6);
  BOOST_TEST(std::isnan(s.p[0]));
  for (std::size_t k = 1; k < real::size(); ++k) BOOST_TEST(std::abs(s.p[k] - 0.303130178050647) < 1e-14);
}

// The figures that solve() states for a fixed number of steps.
BOOST_AUTO_TEST_CASE(steps_converge_quadratically) {
  const side<double> l = ideal_gas(1.0, 0.0, 1000.0, 1.4), r = ideal_gas(1.0, 0.0, 0.01, 1.4);
  const double p = solve(l, r).p;
  const auto error = [&](int steps) { return std::abs(solve<double>(l, r, steps).p / p - 1.0); };
  BOOST_TEST(error(1) < 1e-2);
  BOOST_TEST(error(2) < 3e-5);
  BOOST_TEST(error(3) < 1e-9);
}
