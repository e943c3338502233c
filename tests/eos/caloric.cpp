// Density and internal energy: the first and second law, and that T and c come back.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <eos/caloric.hpp>

using namespace tetsuame::eos;

namespace {

caloric of(const char* name) {
  material_options o;
  o.name = name;
  return caloric(make(o));
}

struct place {
  const char* name;
  double rho, T;
};
constexpr place places[] = {
    {"linear", 7300.0, 3100.0},          {"liquid_iron", 9000.0, 1811.0},  {"liquid_iron_isentrope", 9000.0, 4000.0},
    {"liquid_silicate", 3800.0, 3500.0}, {"ideal_gas", 1.2, 400.0},        {"stiffened_gas", 1050.0, 350.0},
    {"iron_hcp", 12000.0, 5000.0},       {"bridgmanite", 5000.0, 150.0},   {"post_perovskite", 6000.0, 4000.0},
    {"liquid_mgsio3", 4500.0, 4000.0},   {"liquid_mgsio3", 2600.0, 2200.0}};

}  // namespace

// (du/drho)_T = [p - T (dp/dT)_rho]/rho^2 and (du/dT)_rho = c_V: without these two the energy is not that of the
// pressure. liquid_iron: on T0 only (eos.md).
BOOST_AUTO_TEST_CASE(laws_of_thermodynamics) {
  for (const auto& [name, rho, T] : places) BOOST_TEST_CONTEXT(name) {
      const caloric m = of(name);
      const double d = 1e-4;
      const properties s = evaluate(m.material(), rho, T);
      const double by_rho =
          (m.internal_energy(rho * (1.0 + d), T) - m.internal_energy(rho * (1.0 - d), T)) / (2.0 * d * rho);
      const double want = (s.p - T * s.alpha * s.K_T) / (rho * rho);
      BOOST_TEST(std::abs(by_rho - want) <= 1e-6 * s.K_T / (rho * rho));
      const double by_T =
          (m.internal_energy(rho, T * (1.0 + d)) - m.internal_energy(rho, T * (1.0 - d))) / (2.0 * d * T);
      BOOST_TEST(std::abs(by_T / s.c_V - 1.0) <= 1e-6);
    }
}

BOOST_AUTO_TEST_CASE(state_of_energy) {
  for (const auto& [name, rho, T] : places) BOOST_TEST_CONTEXT(name) {
      const caloric m = of(name);
      const properties s = evaluate(m.material(), rho, T);
      const double u = m.internal_energy(rho, T);
      const caloric_state back = m.at(rho, u);
      BOOST_TEST(std::abs(back.T / T - 1.0) <= 1e-12);
      BOOST_TEST(std::abs(m.temperature(rho, u) / T - 1.0) <= 1e-12);
      BOOST_TEST(std::abs(back.p - s.p) <= 1e-12 * s.K_T);
      BOOST_TEST(std::abs(back.c / s.sound_speed - 1.0) <= 1e-7);
    }
}

// Off T0 too: c by the change of p along du = p/rho^2 drho.
BOOST_AUTO_TEST_CASE(sound_of_liquid_iron) {
  const caloric m = of("liquid_iron");
  const double rho = 9000.0, T = 4000.0, u = m.internal_energy(rho, T), d = 1e-4;
  const auto neighbour = [&](double step) {
    const double middle = m.at(rho * (1.0 + 0.5 * step), u + 0.5 * step * m.at(rho, u).p / rho).p;
    return m.at(rho * (1.0 + step), u + middle / rho * step / ((1.0 + 0.5 * step) * (1.0 + 0.5 * step))).p;
  };
  const double c2 = (neighbour(d) - neighbour(-d)) / (2.0 * d * rho);
  BOOST_TEST(std::abs(m.at(rho, u).c / std::sqrt(c2) - 1.0) <= 1e-6);
}

// On the isentrope of Anderson and Ahrens K_S' is that of Birch and Murnaghan's curve: 4.66 at rho0. Of a gas: gamma.
BOOST_AUTO_TEST_CASE(slopes_of_the_bulk_modulus) {
  const caloric iron = of("liquid_iron_isentrope"), air = of("ideal_gas");
  BOOST_TEST(std::abs(iron.stiffening(7019.0, iron.internal_energy(7019.0, 1811.0)) / 4.66 - 1.0) <= 1e-5);
  BOOST_TEST(std::abs(air.stiffening(1.2, air.internal_energy(1.2, 300.0)) / 1.4 - 1.0) <= 1e-6);
}

// Energy along the reference isentrope is the integral of p/rho^2, and T follows Grueneisen's parameter: both are in
// the formulas of isentropic_liquid, and here come from u.
BOOST_AUTO_TEST_CASE(adiabat_of_liquid_iron) {
  const caloric iron = of("liquid_iron_isentrope");
  constexpr int n = 2000;
  const double from = 7019.0, to = 9800.0, d = std::log(to / from) / n;
  double u = iron.internal_energy(from, 1811.0);
  for (int k = 0; k < n; ++k) {
    const double rho = from * std::exp((k + 0.5) * d);
    const double T_S = 1811.0 * std::exp(1.735 / 0.2 * (1.0 - std::pow(7019.0 / rho, 0.2)));
    u += pressure(iron.material(), rho, T_S) / rho * d;
  }
  const double T_S = 1811.0 * std::exp(1.735 / 0.2 * (1.0 - std::pow(7019.0 / to, 0.2)));
  BOOST_TEST(std::abs(iron.temperature(to, u) / T_S - 1.0) <= 1e-6);
}
