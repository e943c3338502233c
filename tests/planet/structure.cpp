// The structure of planets against solutions in closed form and another code's, and the particles on shells.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <foundation/error.hpp>
#include <numbers>
#include <planet/shells.hpp>

using namespace tetsuame;
using planet::structure_input, planet::temperature_law, planet::profile;

namespace {

using planet::G, planet::pi;

eos::any tillotson(const char* material, double heat_capacity) {
  eos::material_options m{.name = "tillotson", .tillotson = material};
  m.reference_temperature = 1e-6;  // energies from the cold curve
  m.heat_capacity = heat_capacity;
  return eos::make(m);
}

// Iron below basalt, T ∝ ρ²; the mass and the radius of the Earth.
structure_input earth() {
  return {{{"core", tillotson("iron", 449.0), 0.0}, {"mantle", tillotson("basalt", 790.0), 1.0}},
          5.9724e24,
          1e5,
          1000.0,
          temperature_law::power,
          2.0};
}

// p = K (ρ/ρ0 - 1), of one temperature.
eos::any linear(double K, double rho0) {
  eos::material_options m{.name = "linear"};
  m.bulk_modulus = K;
  m.reference_density = rho0;
  m.thermal_expansivity = 0.0;
  return eos::make(m);
}

}  // namespace

// An independent integration, converged to 1e-6, of G = 6.67408e-11: its digits.
BOOST_AUTO_TEST_CASE(earth_of_iron_and_basalt) {
  const profile p = planet::structure_of_radius(earth(), 6.371e6);
  const auto &below = p.layers()[0].outer(), &above = p.layers()[1].inner();
  BOOST_TEST(below.r / 6.371e6 == 0.602813, boost::test_tools::tolerance(2e-6));
  BOOST_TEST(below.m / p.mass() == 0.490244, boost::test_tools::tolerance(2e-6));
  BOOST_TEST(p.centre().p == 4.732416e11, boost::test_tools::tolerance(5e-6));
  BOOST_TEST(p.centre().rho == 15001.5, boost::test_tools::tolerance(5e-6));
  BOOST_TEST(below.p == 1.09687e11, boost::test_tools::tolerance(5e-6));
  BOOST_TEST(below.rho == 10402.0, boost::test_tools::tolerance(5e-6));
  BOOST_TEST(above.rho == 4925.8, boost::test_tools::tolerance(1e-5));
  BOOST_TEST(above.p == below.p, boost::test_tools::tolerance(1e-9));
  BOOST_TEST(above.T == below.T, boost::test_tools::tolerance(1e-12));
}

// Radius to fraction and fraction to radius are inverse to each other.
BOOST_AUTO_TEST_CASE(fractions_and_radius) {
  auto in = earth();
  for (const double radius : {6.0e6, 6.371e6, 6.9e6}) {
    const profile p = planet::structure_of_radius(in, radius);
    const double core = p.layers()[0].outer().m / p.mass();
    in.layers[0].fraction = core;
    in.layers[1].fraction = 1.0 - core;
    BOOST_TEST(planet::structure_of_mass(in).radius() == radius, boost::test_tools::tolerance(1e-9));
  }
}

// K so large that the density is ρ0 to 1e-6: p_c = (2π/3) G ρ² R² + p_s, p = p_c - (2π/3) G ρ² r².
BOOST_AUTO_TEST_CASE(incompressible_ball) {
  const double rho = 3000.0, R = 1e6, M = 4.0 * pi / 3.0 * rho * R * R * R, p0 = 2.0 * pi / 3.0 * G * rho * rho * R * R;
  const profile p =
      planet::structure_of_mass({{{"body", linear(1e15, rho), 1.0}}, M, 1e5, 300.0, temperature_law::isothermal});
  BOOST_TEST(p.radius() == R, boost::test_tools::tolerance(3e-6));
  BOOST_TEST(p.centre().p == p0 + 1e5, boost::test_tools::tolerance(5e-6));
  BOOST_TEST(p.at(0.5 * R, 0).p == 0.75 * p0 + 1e5, boost::test_tools::tolerance(1e-4));
}

// Compressed by 0.1 to 4 % in the centre. Squeezed further such a line has a second branch, of planets
// that collapse, whose centre is not reached.
BOOST_AUTO_TEST_CASE(nearly_incompressible_balls) {
  const double rho = 3000.0, R = 1e6, M = 4.0 * pi / 3.0 * rho * R * R * R, p0 = 2.0 * pi / 3.0 * G * rho * rho * R * R;
  for (const double K : {1e11, 3e10, 1e12}) {
    const profile p =
        planet::structure_of_mass({{{"body", linear(K, rho), 1.0}}, M, 1e5, 300.0, temperature_law::isothermal});
    // ρ = ρ0 (1 + p/K), p = p0 (1 - r²/R²) to the first order: the mean of it over the ball is 2/5 p0
    BOOST_TEST(p.radius() == R * (1.0 - 2.0 / 15.0 * p0 / K),
               boost::test_tools::tolerance(2.0 * p0 * p0 / K / K + 1e-5));
    BOOST_TEST(p.centre().p > p0);
    BOOST_TEST(p.centre().p == p0, boost::test_tools::tolerance(3.0 * p0 / K));
  }
}

// A cylinder of one density: p_c = π G ρ² R² + p_s, and the same law of r².
BOOST_AUTO_TEST_CASE(incompressible_cylinder) {
  const double rho = 3000.0, R = 1e6, M = pi * rho * R * R, p0 = pi * G * rho * rho * R * R;
  const profile p = planet::structure_of_mass(
      {{{"body", linear(1e15, rho), 1.0}}, M, 1e5, 300.0, temperature_law::isothermal, 0.0, {2}});
  BOOST_TEST(p.radius() == R, boost::test_tools::tolerance(5e-6));
  BOOST_TEST(p.centre().p == p0 + 1e5, boost::test_tools::tolerance(1e-5));
  BOOST_TEST(p.at(0.5 * R, 0).p == 0.75 * p0 + 1e5, boost::test_tools::tolerance(1e-4));
  BOOST_TEST(p.at_mass(0.25 * M, 0).r == 0.5 * R, boost::test_tools::tolerance(1e-5));
}

// p = K ρ² in a cylinder: ρ = ρ_c J0(k r), k² = 2π G/K [J. P. Ostriker, Astrophys. J. 140, 1056 (1964)]. A gas of
// γ = 2 on its adiabat, as far out as it still has a four-hundredth of the central density.
BOOST_AUTO_TEST_CASE(polytrope_in_a_cylinder) {
  const double R = 6e6, x = 2.40, K = 2.0 * pi * G * R * R / (x * x), rho_c = 2000.0;
  const double surface = rho_c * std::cyl_bessel_j(0, x), T = K * surface / 1000.0;  // p = ρ c_V T
  eos::material_options gas;
  gas.name = "stiffened_gas";
  gas.gamma = 2.0;
  gas.p_infinity = 0.0;
  gas.heat_capacity = 1000.0;
  const double M = 2.0 * pi * rho_c * R * R * std::cyl_bessel_j(1, x) / x;
  const profile p = planet::structure_of_mass(
      {{{"gas", eos::make(gas), 1.0}}, M, K * surface * surface, T, temperature_law::adiabatic, 0.0, {2}});
  BOOST_TEST(p.radius() == R, boost::test_tools::tolerance(1e-5));
  BOOST_TEST(p.centre().rho == rho_c, boost::test_tools::tolerance(1e-5));
  for (const double r : {0.2, 0.5, 0.9})
    BOOST_TEST(p.at(r * R, 0).rho == rho_c * std::cyl_bessel_j(0, x * r), boost::test_tools::tolerance(1e-4));
}

// Hydrostatic equilibrium and the mass of shells between levels, to the second order of their distance.
BOOST_AUTO_TEST_CASE(equilibrium_between_levels) {
  const profile p = planet::structure_of_radius(earth(), 6.371e6);
  for (const auto& layer : p.layers())
    for (std::size_t k = 1; k + 1 < layer.levels.size(); ++k) {
      const auto &a = layer.levels[k - 1], &b = layer.levels[k], &c = layer.levels[k + 1];
      if (c.r < 0.02 * p.radius() || a.p < 1e9) continue;
      const double h1 = b.r - a.r, h2 = c.r - b.r;
      const double slope = (h1 / h2 * (c.p - b.p) + h2 / h1 * (b.p - a.p)) / (h1 + h2);
      BOOST_TEST(slope == -G * b.m * b.rho / (b.r * b.r), boost::test_tools::tolerance(2e-3));
      const auto shell = [](const auto& out, const auto& in) {
        return 2.0 / 3.0 * pi * (out.rho + in.rho) * (std::pow(out.r, 3) - std::pow(in.r, 3));
      };
      BOOST_TEST(shell(a, b) + shell(b, c) == a.m - c.m, boost::test_tools::tolerance(1e-3));
    }
}

// The work of pressure along the adiabat, by the trapezoidal rule.
BOOST_AUTO_TEST_CASE(adiabatic_temperature) {
  auto in = earth();
  in.law = temperature_law::adiabatic;
  in.layers[0].fraction = 0.3;
  in.layers[1].fraction = 0.7;
  const profile p = planet::structure_of_mass(in);
  const auto material = tillotson("iron", 449.0);
  const auto& levels = p.layers()[0].levels;
  double work = 0.0;
  for (std::size_t k = 1; k < levels.size(); ++k) {
    const auto &a = levels[k - 1], &b = levels[k];
    work += 0.5 * (a.p / (a.rho * a.rho) + b.p / (b.rho * b.rho)) * (b.rho - a.rho);
  }
  const auto& iron = std::get<eos::tillotson>(material);
  const double gained = iron.internal_energy(levels.back().rho, levels.back().T) -
                        iron.internal_energy(levels.front().rho, levels.front().T);
  BOOST_TEST(gained == work, boost::test_tools::tolerance(1e-5));
  BOOST_TEST(levels.back().T > levels.front().T);
}

BOOST_AUTO_TEST_CASE(refusals) {
  const auto says = [](const char* what) {
    return [what](const foundation::error& e) { return std::string(e.what()).find(what) != std::string::npos; };
  };
  BOOST_CHECK_EXCEPTION(planet::structure_of_radius(earth(), 2e7), foundation::error, says("mantle alone"));
  BOOST_CHECK_EXCEPTION(planet::structure_of_radius(earth(), 3e6), foundation::error, says("core alone"));
  // Five times its density at zero pressure is where the isentrope of Tillotson's equation ends.
  for (const double mass : {1e26, 1e27, 1e30})
    BOOST_CHECK_EXCEPTION(
        planet::structure_of_mass(
            {{{"moon", tillotson("basalt", 790.0), 1.0}}, mass, 1e5, 300.0, temperature_law::isothermal}),
        foundation::error, says("layer 'moon' would be compressed"));
}

// Equal masses, all of each layer's mass, the radii of the profile, and directions without a preference.
BOOST_AUTO_TEST_CASE(particles_on_shells) {
  const profile p = planet::structure_of_radius(earth(), 6.371e6);
  for (const std::int64_t number : {100, 10000}) {
    const auto all = planet::on_shells(p, {"core", "mantle"}, number);
    BOOST_TEST(std::abs(static_cast<double>(all.size()) - static_cast<double>(number)) <= 1.0);
    double mass = 0.0, core = 0.0, most = 0.0, least = 1e99, inertia = 0.0, inside = 0.0;
    std::array<double, 3> moment{};
    for (const auto& one : all) {
      mass += one.mass;
      if (one.layer == 0) core += one.mass;
      most = std::max(most, one.mass);
      least = std::min(least, one.mass);
      double r2 = 0.0;
      for (std::size_t a = 0; a < 3; ++a) {
        moment[a] += one.mass * one.x[a];
        r2 += one.x[a] * one.x[a];
      }
      inertia += one.mass * r2;
      if (std::sqrt(r2) < p.layers()[0].outer().r) inside += one.mass;
    }
    BOOST_TEST(mass == p.mass(), boost::test_tools::tolerance(1e-12));
    BOOST_TEST(core == p.layers()[0].outer().m, boost::test_tools::tolerance(1e-12));
    BOOST_TEST(inside == core, boost::test_tools::tolerance(1e-12));
    BOOST_TEST(most < least * (1.0 + 4.0 / static_cast<double>(number)));
    double expected = 0.0;
    for (const auto& layer : p.layers())
      for (std::size_t k = 1; k < layer.levels.size(); ++k)
        expected += (layer.levels[k - 1].m - layer.levels[k].m) * 0.5 *
                    (std::pow(layer.levels[k - 1].r, 2) + std::pow(layer.levels[k].r, 2));
    BOOST_TEST(inertia == expected, boost::test_tools::tolerance(number == 100 ? 0.05 : 0.003));
    for (const double m : moment) BOOST_TEST(std::abs(m) < 0.5 * p.mass() * 6.371e6 / static_cast<double>(number));
  }
}

// The same on rings: evenly spaced, so that low moments vanish.
BOOST_AUTO_TEST_CASE(particles_on_rings) {
  auto in = earth();
  in.mass = 1e17;
  in.form = {2};
  in.layers[0].fraction = 0.3;
  in.layers[1].fraction = 0.7;
  const profile p = planet::structure_of_mass(in);
  const auto all = planet::on_shells(p, {"core", "mantle"}, 2000);
  double mass = 0.0, core = 0.0, inertia = 0.0, inside = 0.0;
  std::array<double, 2> moment{};
  for (const auto& one : all) {
    mass += one.mass;
    if (one.layer == 0) core += one.mass;
    const double r = std::hypot(one.x[0], one.x[1]);
    BOOST_TEST(one.x[2] == 0.0);
    inertia += one.mass * r * r;
    for (std::size_t a = 0; a < 2; ++a) moment[a] += one.mass * one.x[a];
    inside += one.mass * (r < p.layers()[0].outer().r);
  }
  BOOST_TEST(mass == in.mass, boost::test_tools::tolerance(1e-9));
  BOOST_TEST(core == 0.3 * in.mass, boost::test_tools::tolerance(1e-9));
  BOOST_TEST(inside == core, boost::test_tools::tolerance(1e-9));
  double exact = 0.0;  // ∫ r² dm
  for (const auto& layer : p.layers())
    for (std::size_t k = 1; k < layer.levels.size(); ++k) {
      const auto &a = layer.levels[k - 1], &b = layer.levels[k];
      exact += 0.5 * (a.r * a.r + b.r * b.r) * (a.m - b.m);
    }
  BOOST_TEST(inertia == exact, boost::test_tools::tolerance(3e-3));
  for (const double one : moment) BOOST_TEST(std::abs(one) < 1e-3 * mass * p.radius());
}
