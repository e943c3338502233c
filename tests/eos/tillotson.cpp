// Tillotson's equation: branches, blend, derivatives and the temperature put beside it.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <eos/tillotson.hpp>

#include "materials.hpp"

namespace eos = tetsuame::eos;

namespace {

const char* const names[] = {"iron", "granite", "basalt"};

double p(const eos::tillotson_parameters& m, double rho, double u) { return eos::tillotson_pressure(m, rho, u).p; }

}  // namespace

// Values worked out by hand from the equations.
BOOST_AUTO_TEST_CASE(hand_values) {
  const eos::tillotson_parameters& iron = eos::find_tillotson("iron");
  BOOST_TEST(p(iron, 7800.0, 0.0) == 0.0);
  // eta 1.1, u 1e6: omega = 1 + 1e6/(9.5e6 * 1.21) = 1.08699434536; (0.5 + 1.5/omega) * 8580e6
  // + 12.8e9 + 1.05e9
  BOOST_TEST(std::abs(p(iron, 8580.0, 1e6) / 29.97998e9 - 1.0) < 1e-5);
  // eta 0.5, u 1e7 > E_cv: z = 1; omega = 1 + 1e7/(9.5e6/4) = 5.21052632
  const double omega = 1.0 + 1e7 / 2.375e6;
  const double expected = 0.5 * 3900e7 + (1.5 * 3900e7 / omega - 64e9 * std::exp(-5.0)) * std::exp(-5.0);
  BOOST_TEST(std::abs(p(iron, 3900.0, 1e7) / expected - 1.0) < 1e-14);
}

// Continuous across rho0 at any u and across E_iv and E_cv at any rho: neighbouring doubles
// may differ by the slope times their distance, some 1e-16 of A.
BOOST_AUTO_TEST_CASE(branches_meet) {
  for (const char* name : names) {
    const eos::tillotson_parameters& m = eos::find_tillotson(name);
    for (int k = 0; k < 30; ++k) {
      const double u = m.E_cv * k / 15.0;
      BOOST_TEST(std::abs(p(m, std::nextafter(m.rho0, 0.0), u) - p(m, m.rho0, u)) < 1e-13 * m.A);
      const double rho = m.rho0 * (k + 1) / 20.0;
      for (const double edge : {m.E_iv, m.E_cv})
        BOOST_TEST(std::abs(p(m, rho, std::nextafter(edge, 0.0)) - p(m, rho, std::nextafter(edge, 1e99))) <
                   1e-13 * m.A);
    }
  }
}

BOOST_AUTO_TEST_CASE(the_blend_is_linear_in_energy) {
  const eos::tillotson_parameters& m = eos::find_tillotson("granite");
  // The condensed pressure at E_iv and the vapour's at E_cv are the ends only for the terms
  // free of u; so compare with the two formulas at the same u.
  const double rho = 0.7 * m.rho0, u = 0.5 * (m.E_iv + m.E_cv);
  eos::tillotson_parameters cold = m, hot = m;
  cold.E_iv = 2.0 * u;  // never expands
  hot.E_iv = hot.E_cv = 0.0;
  BOOST_TEST(std::abs(p(m, rho, u) - 0.5 * (p(cold, rho, u) + p(hot, rho, u))) < 1e-14 * m.A);
}

// Relative steps of 1e-5 in the condensed, mixed and expanded regions; error d^2 f'''.
BOOST_AUTO_TEST_CASE(derivatives_in_density_and_energy) {
  for (const char* name : names) {
    const eos::tillotson_parameters& m = eos::find_tillotson(name);
    for (const double eta : {0.3, 0.6, 0.9, 0.98, 1.02, 1.5, 3.0})
      for (const double u : {0.3 * m.E_iv, 0.9 * m.E_iv, 0.5 * (m.E_iv + m.E_cv), 1.3 * m.E_cv, 5.0 * m.E_cv}) {
        const double rho = eta * m.rho0, d = 1e-5;
        const eos::tillotson_state s = eos::tillotson_pressure(m, rho, u);
        const double by_rho = (p(m, rho * (1.0 + d), u) - p(m, rho * (1.0 - d), u)) / (2.0 * d * rho);
        const double by_u = (p(m, rho, u * (1.0 + d)) - p(m, rho, u * (1.0 - d))) / (2.0 * d * u);
        BOOST_TEST(std::abs(s.p_rho - by_rho) < 1e-7 * (std::abs(by_rho) + m.A / m.rho0));
        BOOST_TEST(std::abs(s.p_u - by_u) < 1e-7 * rho);
      }
  }
}

// The speed of sound is Tillotson's own, along du = p/rho^2 drho.
BOOST_AUTO_TEST_CASE(speed_of_sound_along_the_adiabat) {
  for (const sample& s : samples()) {
    const auto* t = std::get_if<eos::tillotson>(&s.material);
    if (t == nullptr) continue;
    for_each_state(s, [&](double rho, double T) {
      const double u = t->internal_energy(rho, T), d = 1e-5 * rho;
      const double du = eos::pressure(s.material, rho, T) / (rho * rho) * d;
      const double c2 = (p(t->material, rho + d, u + du) - p(t->material, rho - d, u - du)) / (2.0 * d);
      const double c = eos::evaluate(s.material, rho, T).sound_speed;
      // Where a difference straddles no branch its error is 1e-10 times third derivatives.
      BOOST_REQUIRE_MESSAGE(std::abs(c * c / c2 - 1.0) < 1e-6, s.label << " at " << rho << ", " << T);
    });
  }
}

BOOST_AUTO_TEST_CASE(temperature_and_energy_are_inverse) {
  const auto iron = std::get<eos::tillotson>(tillotson("iron"));
  for (const double rho : {10.0, 4000.0, 7800.0, 9000.0, 30000.0})
    for (const double T : {300.0, 5000.0, 50000.0})
      BOOST_TEST(std::abs(iron.temperature(rho, iron.internal_energy(rho, T)) / T - 1.0) < 1e-13);
  BOOST_TEST(iron.internal_energy(7800.0, 300.0) == 0.0);
  BOOST_TEST(std::abs(iron.evaluate(7800.0, 300.0).p) < 1e-3);
}

// On the isentrope through the reference state the temperature equation and the first law
// must lead to the same place: start there, follow d ln T = gamma_th d ln rho, and compare u
// with the integral of p/rho^2. Midpoint rule with 2000 steps: 1e-7.
BOOST_AUTO_TEST_CASE(the_isentrope_is_one_of_both_equations) {
  for (const char* name : names) {
    const auto t = std::get<eos::tillotson>(tillotson(name));
    double rho = t.material.rho0, T = t.T0, u = 0.0;
    const double d = std::log(2.0) / 2000.0;
    for (int k = 0; k < 2000; ++k) {
      const auto gamma = [&](double r, double temperature) {
        const eos::properties s = t.evaluate(r, temperature);
        return s.alpha * s.K_T / (r * s.c_V);
      };
      const double half = rho * std::exp(0.5 * d);
      const double T_half = T * std::exp(0.5 * d * gamma(rho, T));
      u += d * t.evaluate(half, T_half).p / half;
      T *= std::exp(d * gamma(half, T_half));
      rho *= std::exp(d);
    }
    BOOST_TEST(std::abs(u / t.internal_energy(rho, T) - 1.0) < 1e-6);
    BOOST_TEST(std::abs(T / t.temperature(rho, u) - 1.0) < 1e-5);
    BOOST_TEST(T > 300.0);
  }
}

// Beyond the table there is no result rather than a wrong one; the batch loop must not throw.
BOOST_AUTO_TEST_CASE(beyond_the_table) {
  const auto iron = std::get<eos::tillotson>(tillotson("iron"));
  BOOST_TEST(std::isfinite(iron.evaluate(4.999 * 7800.0, 1000.0).p));
  BOOST_TEST(std::isnan(iron.evaluate(5.001 * 7800.0, 1000.0).p));
  BOOST_TEST(std::isnan(iron.evaluate(1e6, 1000.0).p));
}

// Hot vapour: the expanded branch tends to an ideal gas of gamma = 1 + a.
BOOST_AUTO_TEST_CASE(thin_vapour_is_an_ideal_gas) {
  const eos::tillotson_parameters& m = eos::find_tillotson("basalt");
  const double rho = 1e-3 * m.rho0, u = 3.0 * m.E_cv;
  BOOST_TEST(std::abs(p(m, rho, u) / (m.a * rho * u) - 1.0) < 1e-12);
}
