// Melting at a contact: heat is conserved, pieces join, and limits that are known.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <foundation/error.hpp>
#include <melting/melting.hpp>
#include <numbers>
#include <theory/stefan.hpp>

using namespace tetsuame;
namespace tt = boost::test_tools;

namespace {

constexpr theory::half_space metal{7000.0, 800.0, 1e4, 4000.0}, mantle{3000.0, 1200.0, 2e4, 1500.0};

// J/m2 that x > 0 gained, by the trapezoidal rule over the temperature and its heat content.
double gained(const theory::stefan_solution& s, double t) {
  const auto& p = s.problem;
  const melting::heat_content h{p.cold.heat_capacity, p.latent_heat, p.solidus, p.liquidus};
  const double depth = 12.0 * std::sqrt(p.cold.conductivity / (p.cold.density * p.cold.heat_capacity) * t);
  constexpr int n = 20000;
  double sum = 0.0;
  for (int k = 0; k < n; ++k)
    sum += h.enthalpy(s.temperature((k + 0.5) * depth / n, t)) - h.enthalpy(p.cold.temperature);
  return p.cold.density * sum * depth / n;
}

double lost(const theory::stefan_solution& s, double t) {
  const auto& h = s.problem.hot;
  return 2.0 * (h.temperature - s.contact) *
         std::sqrt(h.conductivity * h.density * h.heat_capacity * t / std::numbers::pi);
}

}  // namespace

BOOST_AUTO_TEST_CASE(melting_contact_conserves_heat) {
  // Liquid, mush and solid; mush and solid; solid alone.
  for (const double hot : {4000.0, 2500.0, 1700.0}) {
    auto warm = metal;
    warm.temperature = hot;
    const auto s = theory::solve({warm, mantle, 1661.0, 1982.0, 4e5});
    for (const double t : {1.0, 7.0}) BOOST_TEST(gained(s, t) == lost(s, t), tt::tolerance(1e-6));
    BOOST_TEST(s.temperature(1e3, 1.0) == mantle.temperature, tt::tolerance(1e-12));
    BOOST_TEST(s.temperature(1e-9, 1.0) == s.temperature(-1e-9, 1.0), tt::tolerance(1e-6));
    // k dT/dx is continuous at the contact and where pieces meet.
    const auto flux = [&](double x) {
      const double dx = 1e-6;
      return (x < 0.0 ? metal : mantle).conductivity * (s.temperature(x + dx, 1.0) - s.temperature(x - dx, 1.0)) / dx;
    };
    BOOST_TEST(flux(-2e-6) == flux(2e-6), tt::tolerance(1e-4));
    for (const auto& piece : s.pieces)
      if (piece.from > 0.0)
        BOOST_TEST(flux(2.0 * piece.from - 3e-6) == flux(2.0 * piece.from + 3e-6), tt::tolerance(1e-3));
  }
}

BOOST_AUTO_TEST_CASE(melting_contact_limits) {
  // Nothing latent: the contact is at the mean of both temperatures weighted by sqrt(k rho c).
  const auto weight = [](const theory::half_space& h) {
    return std::sqrt(h.conductivity * h.density * h.heat_capacity);
  };
  const double mean =
      (weight(metal) * metal.temperature + weight(mantle) * mantle.temperature) / (weight(metal) + weight(mantle));
  BOOST_TEST(theory::solve({metal, mantle, 1661.0, 1982.0, 0.0}).contact == mean, tt::tolerance(1e-12));
  // One melting temperature, the solid at it: Neumann's condition for the depth 2 lambda sqrt(kappa t) of the front,
  // sqrt(pi) lambda exp(lambda^2) erf(lambda) = c (T_contact - T_m)/L.
  auto warm = mantle;
  warm.temperature = 1661.0;
  const auto s = theory::solve({metal, warm, 1661.0, 1661.0 + 1e-4, 4e5});
  const double kappa = mantle.conductivity / (mantle.density * mantle.heat_capacity);
  const double lambda = s.melt_thickness(3.0) / (2.0 * std::sqrt(kappa * 3.0));
  BOOST_TEST(std::sqrt(std::numbers::pi) * lambda * std::exp(lambda * lambda) * std::erf(lambda) ==
                 mantle.heat_capacity * (s.contact - 1661.0) / 4e5,
             tt::tolerance(1e-5));
  BOOST_TEST(s.melt_thickness(12.0) == 2.0 * s.melt_thickness(3.0), tt::tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(heat_content_and_back) {
  const melting::heat_content h{1200.0, 4e5, 1661.0, 1982.0};
  for (const double T : {300.0, 1661.0, 1700.0, 1981.0, 1982.0, 3000.0}) {
    const auto s = h.at(h.enthalpy(T));
    BOOST_TEST(s.temperature == T, tt::tolerance(1e-14));
    BOOST_TEST(s.melt_fraction == std::clamp((T - 1661.0) / 321.0, 0.0, 1.0), tt::tolerance(1e-12));
  }
  BOOST_TEST(h.enthalpy(1982.0) - h.enthalpy(1661.0) == 1200.0 * 321.0 + 4e5, tt::tolerance(1e-14));
}
