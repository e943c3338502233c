#include <theory/layered_cylinder.hpp>

#include <cmath>
#include <foundation/error.hpp>
#include <numbers>
#include <theory/growth_fit.hpp>

#include "close.hpp"

namespace theory = tetsuame::theory;
using theory::growing_mode;

namespace {

constexpr double pi = std::numbers::pi, G = 6.67408e-11;

// Rock, metal over it, rock outside.
theory::layered_cylinder metal_over_rock(double inside, double metal, double outside) {
  return {{{2e5, 3000.0, inside}, {3e5, 7500.0, metal}, {4.5e5, 2800.0, outside}}, G};
}
theory::layered_cylinder two_layers(double viscosity, double R = 2e6) {
  return {{{1e6, 3000.0, viscosity}, {R, 4000.0, viscosity}}, G};
}

}  // namespace

// The same equations by collocation: docs/figures/layered_cylinder.py.
BOOST_AUTO_TEST_CASE(growth_rates_beside_collocation) {
  const double rates[3][4] = {{2.30600894e-4, 2.11132876e-4, 1.82077729e-4, 1.54345619e-4},
                              {2.57758273e-5, 2.19604159e-5, 1.85772809e-5, 1.56155358e-5},
                              {5.45532202e-5, 1.18049567e-5, 6.11616877e-6, 4.05723142e-6}};
  const theory::layered_cylinder all[] = {metal_over_rock(1e11, 1e11, 1e11), metal_over_rock(1e12, 1e12, 1e12),
                                          metal_over_rock(1e13, 1e11, 1e12)};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t m = 1; m <= 4; ++m) BOOST_TEST(close(growing_mode(all[k], m).growth_rate, rates[k][m - 1], 1e-6));
}

// Of high degree the contact is flat, and no boundary is near: g Δρ/(4 μ k) with much viscosity; without any
// ((g + 2πG Δρ/k) k Δρ/Σρ)^½ with the displaced mass's own field, from which it departs by what boundary layers are
// thick, times k.
BOOST_AUTO_TEST_CASE(limits) {
  const double g = 2.0 * pi * G * 3000.0 * 1e6;
  for (const std::size_t m : {20, 40}) {
    const double k = static_cast<double>(m) / 1e6, curvature = 1.0 / static_cast<double>(m);
    BOOST_TEST(close(growing_mode(two_layers(1e15), m).growth_rate, 1000.0 * g / (4e15 * k), curvature));
  }
  const double inertial = std::sqrt((g + 2.0 * pi * G * 1000.0 / 4e-6) * 4e-6 * 1000.0 / 7000.0);
  BOOST_TEST(growing_mode(two_layers(1e9, 3e6), 4).growth_rate > 0.99 * inertial);
  BOOST_TEST(growing_mode(two_layers(1e9, 3e6), 4).growth_rate < inertial);
  // Creeping: inversely proportional to the viscosity.
  for (const std::size_t m : {1, 2, 5})
    BOOST_TEST(close(growing_mode(two_layers(1e17), m).growth_rate,
                     1e-4 * growing_mode(two_layers(1e13), m).growth_rate, 1e-2));
}

// Nothing grows where densities fall outwards, and no contact moves the body as a whole.
BOOST_AUTO_TEST_CASE(what_does_not_grow) {
  const theory::layered_cylinder sorted{{{2e5, 7500.0, 1e12}, {3e5, 3000.0, 1e12}, {4e5, 2800.0, 1e12}}, G};
  for (const std::size_t m : {1, 2, 3, 10}) BOOST_TEST(growing_mode(sorted, m).growth_rate == 0.0);
  for (const double viscosity : {1e11, 1e15, 1e19}) {
    const auto c = metal_over_rock(viscosity, viscosity, viscosity);
    const auto mode = growing_mode(c, 1);
    double momentum = 0.0, scale = 0.0;
    for (std::size_t n = 0; n < 3; ++n) {
      const double jump = c.layers[n].density - (n < 2 ? c.layers[n + 1].density : 0.0),
                   part = jump * std::pow(c.layers[n].outer_radius, 2) * mode.displacement[n];
      momentum += part;
      scale += std::abs(part);
    }
    BOOST_TEST(std::abs(momentum) < 1e-6 * scale);
  }
}

// The velocity is continuous, without divergence, 1 at the contact, and finite on the axis.
BOOST_AUTO_TEST_CASE(the_flow_of_a_mode) {
  for (const std::size_t m : {1, 2, 4}) {
    const auto mode = growing_mode(metal_over_rock(1e13, 1e11, 1e12), m);
    BOOST_TEST(mode.fastest == 0U);
    BOOST_TEST(close(mode.at(2e5).radial, 1.0, 1e-9));
    for (const double r : {2e5, 3e5}) {
      BOOST_TEST(close(mode.at(r * (1.0 - 1e-9)).radial, mode.at(r * (1.0 + 1e-9)).radial, 1e-6));
      BOOST_TEST(close(mode.at(r * (1.0 - 1e-9)).tangential, mode.at(r * (1.0 + 1e-9)).tangential, 1e-6));
    }
    for (const double r : {5e4, 1.5e5, 2.4e5, 4e5}) {
      const double d = 1e-4 * r;
      const double slope = (mode.at(r + d).radial - mode.at(r - d).radial) / (2.0 * d);
      const auto here = mode.at(r);
      const double divergence = slope + (here.radial + static_cast<double>(m) * here.tangential) / r;
      BOOST_TEST(std::abs(divergence) * r < 1e-5 * (std::abs(here.radial) + std::abs(here.tangential)));
    }
    if (m > 1) BOOST_TEST(std::abs(mode.at(0.0).radial) < 1e-9);
  }
}

BOOST_AUTO_TEST_CASE(viscosities_that_are_too_low) {
  BOOST_CHECK_THROW(growing_mode(two_layers(1.0), 2), tetsuame::foundation::error);
}

BOOST_AUTO_TEST_CASE(growth_of_an_exponential) {
  std::vector<double> t, x;
  for (int k = 0; k <= 100; ++k) {
    t.push_back(0.1 * k);
    x.push_back(3.0 * (k < 10 ? 1.0 : std::exp(0.7 * 0.1 * (k - 10))));  // a start that does not grow is left out
  }
  const auto fit = theory::fit_growth(t, x, 1.6, 20.0);
  BOOST_REQUIRE(fit.has_value());
  BOOST_TEST(fit->rate == 0.7, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(fit->uncertainty < 1e-12);
  BOOST_TEST(!theory::fit_growth({0.0, 1.0, 2.0}, {1.0, 1.1, 1.2}, 1.6, 20.0).has_value());
}
