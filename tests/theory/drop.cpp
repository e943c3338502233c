#include <foundation/error.hpp>
#include <limits>
#include <numbers>
#include <theory/drop.hpp>
#include <theory/free_slip_box.hpp>
#include <theory/stokes_box.hpp>

#include "close.hpp"

namespace theory = tetsuame::theory;
using theory::sides;

namespace {
constexpr double pi = std::numbers::pi;
constexpr double rigid = std::numeric_limits<double>::infinity();
}  // namespace

BOOST_AUTO_TEST_CASE(one_sphere) {
  const theory::drop solid{0.01, 4000.0, 10.0, 100.0, rigid};
  BOOST_TEST(close(theory::hadamard_rybczynski(solid), 2.0 / 9.0 * 4000.0 * 10.0 * 1e-4 / 100.0, 1e-14));
  theory::drop bubble = solid;
  bubble.drop_viscosity = 0.0;
  BOOST_TEST(close(theory::hadamard_rybczynski(bubble) / theory::hadamard_rybczynski(solid), 1.5, 1e-14));
  bubble.drop_viscosity = 100.0;  // equal: (2/3)(1 + 1)/(2 + 3)
  BOOST_TEST(close(theory::hadamard_rybczynski(bubble), 4.0 / 15.0 * 4000.0 * 10.0 * 1e-4 / 100.0, 1e-14));
}

// A drop's far field is its force: the first term is the rigid one's times the drag.
BOOST_AUTO_TEST_CASE(cubic_array) {
  for (const double kappa : {0.0, 1.0, 30.0}) {
    const auto loss = [](double ratio) { return 1.0 - theory::cubic_array_factor(1e-9, ratio); };
    BOOST_TEST(close(loss(kappa) / loss(rigid), (2.0 + 3.0 * kappa) / (3.0 + 3.0 * kappa), 1e-3));
  }
}

// Iron in magma: sigma = 1 N/m, drho = 3700 kg/m^3, g = 10 give capillary length 5.2 mm, so drops up to a centimetre.
BOOST_AUTO_TEST_CASE(size) { BOOST_TEST(close(theory::largest_radius(1.0, 3700.0, 10.0), 1.03975e-2, 1e-4)); }

BOOST_AUTO_TEST_CASE(hindered) {
  const auto exponent = [](double reynolds) {
    return std::log(theory::hindered_settling_factor(0.1, reynolds)) / std::log(0.9);
  };
  BOOST_TEST(close(exponent(0.01), 4.65, 1e-13));
  BOOST_TEST(close(exponent(1e4), 2.39, 1e-13));
  for (const double at : {0.2, 1.0, 500.0})  // the published pieces meet within 3 %
    BOOST_TEST(close(exponent(at * 0.999), exponent(at * 1.001), 0.03));
}

// Equal viscosities between free-slip walls: the force's sine series is the solution's, term by term,
// V = (drho g/eta) sum of kx^2/(kx^2 + ky^2)^2 times the square of the drop's mean of sin kx x sin ky y times 4/(L H)
// times its area, the mean being 2 J1(ka)/(ka) sin kx x0 sin ky y0.
BOOST_AUTO_TEST_CASE(free_slip_box) {
  const double L = 1.0, H = 1.25, a = 0.15, x0 = 0.5, y0 = 0.7;
  double sum = 0.0;
  for (int m = 1; m <= 300; ++m) {
    for (int n = 1; n <= 300; ++n) {
      // v ~ cos(m pi x/L) sin(n pi y/H)
      const double kx = m * pi / L, ky = n * pi / H, k2 = kx * kx + ky * ky, ka = std::sqrt(k2) * a;
      const double mean = 2.0 * std::cyl_bessel_j(1.0, ka) / ka * std::cos(kx * x0) * std::sin(ky * y0);
      sum += kx * kx / (k2 * k2) * mean * mean * 4.0 / (L * H) * pi * a * a;
    }
  }
  const theory::drop_in_box box{L, H, a, x0, y0, 2.0, 2.0, 3.0, 10.0, sides::free_slip, sides::free_slip};
  BOOST_TEST(close(theory::fall_velocity_extrapolated(box, 40), sum * 3.0 * 10.0 / 2.0, 1e-3));
}

// V = c drho g L^2/eta of a drop of radius 0.1 L in a no-slip square, equal viscosities, from another
// finite-difference code, extrapolated.
BOOST_AUTO_TEST_CASE(no_slip_square) {
  const struct { double y, c; } table[] = {{0.7, 2.147e-3}, {0.6, 2.344e-3}, {0.5, 2.392e-3}};
  for (const auto& row : table) {
    const theory::drop_in_box box{1.0, 1.0, 0.1, 0.5, row.y, 1.0, 1.0, 1.0, 1.0};
    BOOST_TEST(close(theory::fall_velocity_extrapolated(box, 40), row.c, 3e-3));
  }
}

// Unequal viscosities: the array's closed form, whose error is of order c^2, 2.4e-3.
BOOST_AUTO_TEST_CASE(square_array) {
  const double a = 0.125, c = pi * a * a;
  for (const double kappa : {0.1, 1.0, 10.0}) {
    const theory::drop_in_box box{1.0, 1.0, a, 0.5, 0.5, 1.0, kappa, 1.0, 1.0, sides::periodic, sides::periodic};
    BOOST_TEST(close(theory::fall_velocity_extrapolated(box, 48), a * a * theory::square_array_velocity(c, kappa),
                     kappa == 1.0 ? 2e-3 : 6e-3));
  }
}

// Fourier series against finite differences, which share nothing: walls and periodic sides, off the middle, in two
// dimensions.
BOOST_AUTO_TEST_CASE(fourier_series_and_finite_differences) {
  for (const double y : {0.5, 0.7})
    for (const bool periodic : {false, true}) {
      const theory::drop_among_free_slip series{
          2, {1.0, 1.0, 1.0}, {periodic, false, false}, 0.1, {0.3, y, 0.5}, 1.0, 1.0, 1.0, 1.0};
      const theory::drop_in_box box{
          1.0, 1.0, 0.1, 0.3, y, 1.0, 1.0, 1.0, 1.0, periodic ? sides::periodic : sides::free_slip, sides::free_slip};
      BOOST_TEST(close(theory::fall_velocity(series), theory::fall_velocity_extrapolated(box, 60), 1e-3));
    }
}

// Of several drops: one as before; two that lie half a periodic box apart are one in a box of half the width; two side
// by side between walls, mirror images of each other, are one with a wall between them.
BOOST_AUTO_TEST_CASE(several_drops_as_a_fourier_series) {
  using places = std::vector<std::array<double, 3>>;
  for (const int dimension : {2, 3}) {
    const bool deep = dimension == 3;
    const auto box = [&](double width, bool periodic) {
      return theory::drop_among_free_slip{
          dimension, {width, 1.0, 0.8}, {periodic, false, deep && periodic}, 0.1, {0.3, 0.6, 0.35}, 1.5, 1.5, 2.0,
          10.0};
    };
    for (const bool periodic : {false, true}) {
      const auto one = box(0.7, periodic);
      const double alone = theory::fall_velocity(one);
      BOOST_TEST(close(theory::mean_fall_velocity(one, places{one.centre}), alone, deep ? 1e-3 : 1e-9));
      const double second = periodic ? 0.3 + 0.7 : 1.4 - 0.3;
      BOOST_TEST(close(theory::mean_fall_velocity(box(1.4, periodic), places{one.centre, {second, 0.6, 0.35}}), alone,
                       deep ? 1e-3 : 1e-9));
    }
  }
}

// In three dimensions: Hadamard's and Rybczynski's velocity less the walls' part, which goes as radius over length.
BOOST_AUTO_TEST_CASE(fourier_series_of_three_dimensions) {
  const double alone = theory::hadamard_rybczynski({0.1, 1.0, 1.0, 1.0, 1.0});
  const auto lost = [&](double L) {
    const theory::drop_among_free_slip box{
        3, {L, L, L}, {true, false, true}, 0.1, {0.5 * L, 0.5 * L, 0.5 * L}, 1.0, 1.0, 1.0, 1.0};
    return 1.0 - theory::fall_velocity(box) / alone;
  };
  const double near = lost(0.8), far = lost(1.6);
  BOOST_TEST(far > 0.0);
  BOOST_TEST(close(near / far, 2.0, 0.02));  // the next term goes as the cube
}

// Rayleigh's and Lamb's frequencies: the textbook's free drop (outside massless), omega^2 = n(n-1)(n+2) sigma/(rho
// R^3), and the bubble, (n-1)(n+1)(n+2); a jet's cross section, n(n^2-1).
BOOST_AUTO_TEST_CASE(oscillating_drops) {
  for (const int n : {2, 3, 5}) {
    const auto squared = [&](int d, double in, double out) {
      return std::pow(theory::oscillation_frequency(n, d, 2.0, 0.5, in, out), 2) * 0.125 / 2.0;
    };
    BOOST_TEST(close(squared(3, 4.0, 0.0), n * (n - 1.0) * (n + 2.0) / 4.0, 1e-13));
    BOOST_TEST(close(squared(3, 0.0, 4.0), (n - 1.0) * (n + 1.0) * (n + 2.0) / 4.0, 1e-13));
    BOOST_TEST(close(squared(2, 4.0, 0.0), n * (n * n - 1.0) / 4.0, 1e-13));
    BOOST_TEST(close(squared(2, 3.0, 1.0), squared(2, 1.0, 3.0), 1e-13));
  }
}
