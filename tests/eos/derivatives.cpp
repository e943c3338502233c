// K_T, alpha and the speed of sound against differences of the pressure, and the inverse.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <foundation/error.hpp>
#include <limits>

#include "materials.hpp"

namespace eos = tetsuame::eos;
namespace foundation = tetsuame::foundation;

namespace {

// Five points; error h^4 f^(5)/30.
template <class F>
double derivative(F f, double h) {
  return (8.0 * (f(h) - f(-h)) - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h);
}

}  // namespace

// In ln rho with h = 1e-3: the pressures vary like powers up to about the 8th of rho, so the
// formula's error is below 1e-12 * 8^5/30 = 1e-9 of p ~ K_T, the rounding 1e-16/1e-3 = 1e-13.
// The table of Tillotson's isentrope has continuous first derivatives only: there the step
// meets a jump of the second derivative, which leaves about 1e-8.
BOOST_AUTO_TEST_CASE(K_T_is_rho_dp_drho) {
  for (const sample& s : samples())
    for_each_state(s, [&](double rho, double T) {
      const double K = derivative([&](double d) { return eos::pressure(s.material, rho * std::exp(d), T); }, 1e-3);
      const eos::properties state = eos::evaluate(s.material, rho, T);
      BOOST_REQUIRE_MESSAGE(std::abs(state.K_T / K - 1.0) < 3e-8,
                            s.label << " at " << rho << ", " << T << ": " << state.K_T << ", " << K);
      BOOST_REQUIRE_MESSAGE(state.K_T > 0.0, s.label << " is not stable at " << rho << ", " << T);
    });
}

BOOST_AUTO_TEST_CASE(alpha_K_T_is_dp_dT) {
  for (const sample& s : samples())
    for_each_state(s, [&](double rho, double T) {
      const double slope = derivative([&](double d) { return eos::pressure(s.material, rho, T + d); }, 1e-3 * T);
      const eos::properties state = eos::evaluate(s.material, rho, T);
      // Pressure and K_T are up to 1e3 times alpha K_T T, so 1e-16 * 1e3/1e-3 of rounding.
      BOOST_REQUIRE_MESSAGE(std::abs(state.alpha * state.K_T / slope - 1.0) < 1e-8,
                            s.label << " at " << rho << ", " << T << ": " << state.alpha * state.K_T << ", " << slope);
    });
}

// c^2 = dp/drho for a material that is compressed with d ln T = gamma_th d ln rho, as the
// temperature equation does it. Central difference with d = 1e-4 along the tangent: the error
// is d^2 times third derivatives, 1e-8 * 100.
BOOST_AUTO_TEST_CASE(speed_of_sound_is_that_of_the_adiabat) {
  for (const sample& s : samples()) {
    if (s.label.starts_with("tillotson")) continue;  // its adiabat is in (rho, u): tillotson.cpp
    for_each_state(s, [&](double rho, double T) {
      const eos::properties state = eos::evaluate(s.material, rho, T);
      const double gamma = state.alpha * state.K_T / (rho * state.c_V), d = 1e-4;
      const double up = eos::pressure(s.material, rho * std::exp(d), T * std::exp(gamma * d));
      const double down = eos::pressure(s.material, rho * std::exp(-d), T * std::exp(-gamma * d));
      const double c2 = (up - down) / (2.0 * d * rho);
      BOOST_REQUIRE_MESSAGE(
          std::abs(state.sound_speed * state.sound_speed / c2 - 1.0) < 1e-6,
          s.label << " at " << rho << ", " << T << ": " << state.sound_speed << ", " << std::sqrt(c2));
    });
  }
}

// The inverse stops where a step in ln rho is at rounding level; the pressure itself has a
// rounding error of a few 1e-16 K_T (terms that cancel), which is one of 1e-15 in density.
BOOST_AUTO_TEST_CASE(density_inverts_the_pressure) {
  for (const sample& s : samples())
    for_each_state(s, [&](double rho, double T) {
      const double again = eos::density(s.material, eos::pressure(s.material, rho, T), T);
      BOOST_REQUIRE_MESSAGE(std::abs(again / rho - 1.0) < 2e-14,
                            s.label << " at " << rho << ", " << T << ": " << again);
    });
}

BOOST_AUTO_TEST_CASE(impossible_pressures_are_told) {
  const auto tells_the_pressure = [](const foundation::error& e) {
    return e.status() == foundation::exit_status::calculation_failed &&
           std::string(e.what()).find("p = -3e+11 Pa at T = 2000 K") != std::string::npos;
  };
  for (const sample& s : samples())
    BOOST_CHECK_EXCEPTION(eos::density(s.material, -3e11, 2000.0), foundation::error, tells_the_pressure);

  const auto fails = [](const foundation::error& e) {
    return e.status() == foundation::exit_status::calculation_failed;
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  for (const sample& s : samples()) {
    BOOST_CHECK_EXCEPTION(eos::density(s.material, nan, 2000.0), foundation::error, fails);
    BOOST_CHECK_EXCEPTION(eos::density(s.material, 1e9, nan), foundation::error, fails);
  }
  for (const char* name : {"liquid_iron", "liquid_iron_isentrope", "liquid_silicate", "tillotson"})
    BOOST_CHECK_EXCEPTION(eos::density(material(name), 1e16, 2000.0), foundation::error, fails);
}

// The stable branch ends where K_T = 0: just above that pressure there is a density, just
// below none, and the message names it.
BOOST_AUTO_TEST_CASE(the_inverse_reaches_the_spinodal) {
  const eos::any iron = material("liquid_iron");
  double unstable = 0.5 * 7030.0, stable = 7030.0;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (unstable + stable);
    (eos::evaluate(iron, middle, 3000.0).K_T > 0.0 ? stable : unstable) = middle;
  }
  const double least = eos::pressure(iron, stable, 3000.0);
  BOOST_TEST(least < 0.0);
  const double near = eos::density(iron, least + 1e3, 3000.0);
  // dp ~ K_T' drho^2/2: 1e3 Pa above the minimum is 1e-4 in density.
  BOOST_TEST(std::abs(near / stable - 1.0) < 1e-3);
  BOOST_TEST(near > stable);
  BOOST_CHECK_THROW(eos::density(iron, least - 1e3, 3000.0), foundation::error);
}
