// The Riemann problem of any two equations of state: stiffened gases have the exact solver's answer; liquids keep mass,
// momentum and energy over a shock and entropy in a rarefaction.
#include <boost/test/unit_test.hpp>
#include <riemann/general.hpp>

namespace eos = tetsuame::eos;
using namespace tetsuame::riemann;

namespace {

eos::caloric gas(double gamma, double p_infinity, double c_V) {
  eos::material_options o;
  o.name = "stiffened_gas";
  o.gamma = gamma;
  o.p_infinity = p_infinity;
  o.heat_capacity = c_V;
  return eos::caloric(eos::make(o));
}
eos::caloric liquid(const char* name) {
  eos::material_options o;
  o.name = name;
  return eos::caloric(eos::make(o));
}

}  // namespace

// Shock and rarefaction, two shocks, two rarefactions; profile at places in all its parts.
BOOST_AUTO_TEST_CASE(stiffened_gases) {
  const eos::caloric a = gas(1.4, 0.0, 2.0), b = gas(3.0, 2.0, 1.5);
  struct tube {
    double v_l, T_l, v_r, T_r;
  };
  for (const auto& [v_l, T_l, v_r, T_r] :
       {tube{0.0, 5.0, 0.0, 1.0}, tube{1.0, 1.0, -1.0, 2.0}, tube{-0.3, 2.0, 0.3, 2.0}}) {
    const double p_l = 0.4 * 1.3 * 2.0 * T_l, p_r = 2.0 * 2.0 * 1.5 * T_r - 2.0;
    const side<double> l{1.3, v_l, p_l, 1.4, 0.0}, r{2.0, v_r, p_r, 3.0, 2.0};
    const star<double> exact = solve(l, r);
    const general_tube general({&a, 1.3, v_l, T_l}, {&b, 2.0, v_r, T_r});
    BOOST_TEST(std::abs(general.star_l().p / exact.p - 1.0) < 1e-7);
    BOOST_TEST(std::abs(general.star_r().p / exact.p - 1.0) < 1e-7);
    BOOST_TEST(std::abs(general.star_l().v - exact.u) < 1e-7);
    BOOST_TEST(std::abs(general.star_r().v - exact.u) < 1e-7);
    for (double xi = -4.0; xi < 5.0; xi += 0.0625) {
      const primitive want = sample(l, r, exact, xi);
      const general_state got = general.at(xi);
      BOOST_TEST(std::abs(got.rho - want.rho) < 1e-6);
      BOOST_TEST(std::abs(got.v - want.u) < 1e-6);
      BOOST_TEST(std::abs(got.p - want.p) < 1e-6);
    }
  }
}

// Iron at 60 GPa beside silicate at 10: shock right, rarefaction left.
BOOST_AUTO_TEST_CASE(iron_and_silicate) {
  const eos::caloric iron = liquid("liquid_iron_isentrope"), silicate = liquid("liquid_silicate");
  const double rho_l = eos::density(iron.material(), 6e10, 3500.0),
               rho_r = eos::density(silicate.material(), 1e10, 3000.0);
  const general_tube tube({&iron, rho_l, 0.0, 3500.0}, {&silicate, rho_r, 0.0, 3000.0});
  const general_state &l = tube.star_l(), &r = tube.star_r();
  BOOST_TEST(std::abs(l.p / r.p - 1.0) < 1e-9);
  BOOST_TEST(std::abs(l.v / r.v - 1.0) < 1e-9);
  // Where the shock stands in the profile: bisection. Then mass, momentum, energy across it.
  double low = r.v, high = 3e4;
  while (high - low > 1e-9 * high) {
    const double xi = 0.5 * (low + high);
    (tube.at(xi).rho == rho_r ? high : low) = xi;
  }
  const double s = high, u_r = silicate.internal_energy(rho_r, 3000.0), p_r = 1e10;
  const double flux = rho_r * s;
  BOOST_TEST(std::abs(r.rho * (s - r.v) / flux - 1.0) < 1e-6);
  BOOST_TEST(std::abs((r.p - p_r) / (flux * r.v) - 1.0) < 1e-6);
  BOOST_TEST(std::abs((r.p * r.v) / (flux * (r.u - u_r + 0.5 * r.v * r.v)) - 1.0) < 1e-6);
  // Isentropes of this iron are known: T - T_S(rho) falls as T_S itself, both follow Grueneisen's parameter.
  const auto T_S = [](double rho) { return 1811.0 * std::exp(1.735 / 0.2 * (1.0 - std::pow(7019.0 / rho, 0.2))); };
  for (const double xi : {-8000.0, -5200.0, -4900.0, 0.0}) {
    const general_state w = tube.at(xi);
    BOOST_TEST(std::abs(iron.temperature(w.rho, w.u) * T_S(rho_l) / (T_S(w.rho) * 3500.0) - 1.0) < 1e-6);
  }
  const double head = -iron.at(rho_l, iron.internal_energy(rho_l, 3500.0)).c, tail = l.v - iron.at(l.rho, l.u).c;
  const general_state middle = tube.at(0.5 * (head + tail));
  BOOST_TEST(middle.rho < rho_l);
  BOOST_TEST(middle.rho > l.rho);
  BOOST_TEST(std::abs(middle.v - iron.at(middle.rho, middle.u).c - 0.5 * (head + tail)) < 1e-6 * -head);
}
