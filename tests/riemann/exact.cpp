// Star states and profiles in double, against published numbers and the conservation laws.
#include <boost/test/unit_test.hpp>
#include <foundation/error.hpp>
#include <fstream>
#include <random>
#include <riemann/approximate.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "ideal_gas.hpp"

using namespace tetsuame::riemann;
namespace foundation = tetsuame::foundation;

namespace {

struct printed {
  double value, unit;  // unit of the last digit
};

printed parse(const std::string& text) {
  const std::size_t point = text.find('.');
  const double digits = point == std::string::npos ? 0.0 : static_cast<double>(text.size() - point - 1);
  return {std::stod(text), std::pow(10.0, -digits)};
}

struct tube {
  std::string name;
  side<double> l, r;
  printed p, u, rho_l, rho_r;
};

// Tests 1 to 5 of E. F. Toro, Riemann Solvers and Numerical Methods for Fluid Dynamics, 3rd ed.
// (2009), tables 4.1 to 4.3, gamma 1.4; the first three with one or two digits more.
std::vector<tube> tubes() {
  std::ifstream file(TETSUAME_SOURCE_DIR "/tests/riemann/tubes.csv");
  std::vector<tube> all;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    std::vector<printed> x;
    std::string name, cell;
    std::getline(cells, name, ',');
    while (std::getline(cells, cell, ',')) x.push_back(parse(cell));
    all.push_back({name, ideal_gas(x.at(0).value, x.at(1).value, x.at(2).value, 1.4),
                   ideal_gas(x.at(3).value, x.at(4).value, x.at(5).value, 1.4), x.at(6), x.at(7), x.at(8), x.at(9)});
  }
  BOOST_REQUIRE(all.size() == 5);
  return all;
}

bool close(double a, double b, double relative) { return std::abs(a - b) <= relative * std::abs(b); }

// Sides of all kinds, each with a gas of its own.
struct random_sides {
  std::mt19937_64 engine{20240501};
  side<double> operator()() {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const auto wide = [&] { return std::pow(10.0, 4.0 * unit(engine) - 2.0); };
    const double rho = wide(), p = wide(), p_inf = unit(engine) < 0.5 ? 0.0 : wide();
    return {rho, 4.0 * unit(engine) - 2.0, p, 1.1 + 4.0 * unit(engine), p_inf};
  }
};

// Mass, momentum and energy in a unit volume; energy of the gas that `s` is made of.
std::array<double, 3> conserved(const primitive& w, const side<double>& s) {
  const double e = w.rho > 0.0 ? (w.p + s.gamma * s.p_infinity) / (s.gamma - 1.0) : 0.0;
  return {w.rho, w.rho * w.u, 0.5 * w.rho * w.u * w.u + e};
}

std::array<double, 3> flux(const side<double>& s) {
  const std::array<double, 3> q = conserved({s.rho, s.u, s.p}, s);
  return {q[0] * s.u, q[1] * s.u + s.p, (q[2] + s.p) * s.u};
}

}  // namespace

// Within a unit of the last printed digit; Toro's input of the collision is itself rounded.
BOOST_AUTO_TEST_CASE(published_star_states) {
  for (const tube& t : tubes()) {
    const star<double> s = solve(t.l, t.r);
    BOOST_TEST(!s.vacuum);
    const auto check = [&](double value, const printed& want, const char* what) {
      BOOST_TEST(std::abs(value - want.value) <= want.unit, t.name << ' ' << what << ' ' << value);
    };
    check(s.p, t.p, "p");
    check(s.u, t.u, "u");
    check(s.rho_l, t.rho_l, "rho_l");
    check(s.rho_r, t.rho_r, "rho_r");
  }
}

// Integrals over [-x, x] at t = 1 change by the fluxes of the outer states. The middle-point rule
// with n points is off by at most a jump times a cell for each of three waves, and less in fans.
BOOST_AUTO_TEST_CASE(profiles_conserve_mass_momentum_and_energy) {
  random_sides draw;
  int vacua = 0;
  for (int k = 0; k < 40; ++k) {
    side<double> l = draw(), r = draw();
    if (k % 8 == 7) {  // ideal gases far apart
      l.p_infinity = r.p_infinity = 0.0;
      l.u = -40.0 * sound_speed(l);
      r.u = 40.0 * sound_speed(r);
    }
    const star<double> s = solve(l, r);
    vacua += s.vacuum;
    // A shock is slower than its star gas is faster than sound: a generous end.
    const double fastest = 4.0 * (std::abs(l.u) + std::abs(r.u) + sound_speed(l) + sound_speed(r) + std::abs(s.u) +
                                  std::sqrt(std::abs(s.p) / std::min(l.rho, r.rho)));
    constexpr int n = 40000;
    const double dx = 2.0 * fastest / n;
    std::array<double, 3> sum{}, size{};
    for (int i = 0; i < n; ++i) {
      const double x = -fastest + (i + 0.5) * dx;
      const std::array<double, 3> q = conserved(sample(l, r, s, x), x < s.u ? l : r);
      for (std::size_t c = 0; c < 3; ++c) {
        sum[c] += q[c] * dx;
        size[c] = std::max(size[c], std::abs(q[c]));
      }
    }
    const std::array<double, 3> f_l = flux(l), f_r = flux(r), q_l = conserved({l.rho, l.u, l.p}, l),
                                q_r = conserved({r.rho, r.u, r.p}, r);
    for (std::size_t c = 0; c < 3; ++c) {
      const double expected = fastest * (q_l[c] + q_r[c]) + f_l[c] - f_r[c];
      BOOST_TEST(std::abs(sum[c] - expected) <= 3.0 * size[c] * dx, k << ' ' << c << ' ' << sum[c] << ' ' << expected);
    }
  }
  BOOST_TEST(vacua >= 5);
}

// 2 (c_l + c_r)/(gamma - 1) is the speed of parting from where there is a vacuum [Toro (4.40)].
BOOST_AUTO_TEST_CASE(vacuum_opens_where_it_has_to) {
  const side<double> l = ideal_gas(1.0, 0.0, 1.0, 1.4);
  side<double> r = ideal_gas(0.3, 0.0, 2.0, 1.4);
  const double limit = 5.0 * (sound_speed(l) + sound_speed(r));
  r.u = limit * (1.0 - 1e-3);
  const star<double> before = solve(l, r);
  BOOST_TEST(!before.vacuum);
  BOOST_TEST(before.p > 0.0);
  BOOST_TEST(std::abs(detail::problem<double>(l, r).at(before.p).f) < 1e-12 * limit);
  r.u = limit * (1.0 + 1e-3);
  const star<double> after = solve(l, r);
  BOOST_TEST(after.vacuum);
  BOOST_TEST(after.p == 0.0);
  BOOST_TEST(close(after.u_l, 5.0 * sound_speed(l), 1e-14));
  BOOST_TEST(close(after.u_r, r.u - 5.0 * sound_speed(r), 1e-14));
  BOOST_TEST(sample(l, r, after, 0.5 * (after.u_l + after.u_r)).rho == 0.0);
}

// Gases with one p_inf are ideal gases in p + p_inf.
BOOST_AUTO_TEST_CASE(stiffened_gas_is_ideal_gas_in_shifted_pressure) {
  const double p_inf = 600.0;
  for (const tube& t : tubes()) {
    side<double> l = t.l, r = t.r;
    l.p -= p_inf;
    r.p -= p_inf;
    l.p_infinity = r.p_infinity = p_inf;
    const star<double> a = solve(t.l, t.r), b = solve(l, r);
    BOOST_TEST(std::abs(a.p - p_inf - b.p) < 1e-11 * (p_inf + a.p));
    BOOST_TEST(std::abs(a.u - b.u) < 1e-9);
  }
}

BOOST_AUTO_TEST_CASE(mirror_and_moving_observer) {
  random_sides draw;
  for (int k = 0; k < 200; ++k) {
    const side<double> l = draw(), r = draw();
    side<double> l2 = r, r2 = l;
    const double speed = 3.0;
    l2.u = speed - r.u;
    r2.u = speed - l.u;
    const star<double> a = solve(l, r), b = solve(l2, r2);
    BOOST_TEST(a.vacuum == b.vacuum);
    const double P = std::max({l.p, r.p, l.p_infinity, r.p_infinity, a.p});
    BOOST_TEST(std::abs(a.p - b.p) < 1e-12 * P);
    // u* = u_K -+ f(p*): its rounding error is that of p* over the slope of f
    BOOST_TEST(std::abs(a.u - (speed - b.u)) < 1e-10 * (1.0 + sound_speed(l) + sound_speed(r)));
  }
}

BOOST_AUTO_TEST_CASE(states_that_are_no_gas_are_refused) {
  const side<double> good = ideal_gas(1.0, 0.0, 1.0, 1.4);
  for (const side<double>& bad : {ideal_gas(0.0, 0.0, 1.0, 1.4), ideal_gas(1.0, 0.0, -1.0, 1.4),
                                  ideal_gas(1.0, 0.0, 1.0, 1.0), ideal_gas(1.0, std::nan(""), 1.0, 1.4)}) {
    BOOST_CHECK_THROW(solve(bad, good), foundation::error);
    BOOST_CHECK_THROW(solve(good, bad), foundation::error);
  }
}

// Acoustics to second order in weak waves, exact where equal cold gases collide, p >= 0 in a vacuum, a contact as it
// is, and the same seen from the other side.
BOOST_AUTO_TEST_CASE(hllc_contact_of_two_gases) {
  const auto contact = [](const side<double>& l, const side<double>& r) {
    return tetsuame::riemann::hllc_contact(l, r, sound_speed(l), sound_speed(r));
  };
  const side<double> a = ideal_gas(1.0, 1e-3, 1.0, 1.4), b = ideal_gas(2.0, 0.0, 1.0, 1.4);
  const auto weak = contact(a, b);
  const auto right = solve(a, b);
  BOOST_TEST(std::abs(weak.p - right.p) < 1e-3 * std::abs(right.p - 1.0));
  BOOST_TEST(std::abs(weak.u - right.u) < 1e-3 * std::abs(right.u));
  const side<double> in = ideal_gas(1.0, 1.0, 1e-9, 5.0 / 3.0), out = ideal_gas(1.0, -1.0, 1e-9, 5.0 / 3.0);
  BOOST_TEST(std::abs(contact(in, out).p / solve(in, out).p - 1.0) < 1e-3);
  const auto moving = contact(ideal_gas(1.0, 0.7, 3.0, 1.4), ideal_gas(9.0, 0.7, 3.0, 1.6));
  BOOST_TEST(close(moving.p, 3.0, 1e-15));
  BOOST_TEST(close(moving.u, 0.7, 1e-15));
  BOOST_TEST(contact(ideal_gas(1.0, -50.0, 1.0, 1.4), ideal_gas(1.0, 50.0, 1.0, 1.4)).p == 0.0);
  const side<double> c = ideal_gas(3.0, 0.4, 5.0, 1.4), d = ideal_gas(1.0, -0.3, 0.2, 1.4);
  const side<double> c_back = ideal_gas(3.0, -0.4, 5.0, 1.4), d_back = ideal_gas(1.0, 0.3, 0.2, 1.4);
  BOOST_TEST(std::abs(contact(c, d).p - contact(d_back, c_back).p) < 1e-14);
  BOOST_TEST(std::abs(contact(c, d).u + contact(d_back, c_back).u) < 1e-14);
}
