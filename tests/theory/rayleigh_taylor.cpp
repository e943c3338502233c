// Growth rates against closed forms, published values, a determinant of exponentials written
// here on its own, and a step of the flow's own equations by finite differences.
#include <Eigen/Dense>
#include <foundation/error.hpp>
#include <limits>
#include <numbers>
#include <theory/rayleigh_taylor.hpp>

#include "close.hpp"

namespace theory = tetsuame::theory;
using theory::boundary;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();

theory::two_layers layers(double rho_lower, double rho_upper, double b_lower, double b_upper, double eta_lower,
                          double eta_upper, double K = infinity, double top_pressure = 0.0) {
  return {{b_lower, eta_lower, theory::linear_barotrope(rho_lower, K)},
          {b_upper, eta_upper, theory::linear_barotrope(rho_upper, K)},
          10.0,
          top_pressure};
}

// The note's box: metal over silicate, 1500 km square.
theory::two_layers metal_over_silicate(double eta, double K) {
  return layers(3000.0, 7000.0, 0.75e6, 0.75e6, eta, eta, K, 1e5);
}
constexpr double k1 = 2.0 * pi / 1.5e6;

// Incompressible layers of uniform viscosity: v = combination of e^(+-ky), e^(+-qy), q^2 = k^2 + growth rho/eta, four
// for each layer; zero of the determinant of the eight conditions [after S. Chandrasekhar (1961), sect. 94]. Each
// exponential is one at the end of the layer towards which it grows. Walls: no slip or free slip.
double determinant(const theory::two_layers& flow, double rho_l, double rho_u, double k, double growth) {
  struct basis {
    double rate, at;  // e^(rate (y - at))
  };
  const double rho[2] = {rho_l, rho_u}, eta[2] = {flow.lower.viscosity, flow.upper.viscosity};
  const double far[2] = {-flow.lower.thickness, flow.upper.thickness};
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(8, 8);
  for (int s = 0; s < 2; ++s) {
    const double q = std::sqrt(k * k + growth * rho[s] / eta[s]);
    const double high = s == 0 ? 0.0 : far[1], low = s == 0 ? far[0] : 0.0;
    const basis functions[4] = {{k, high}, {-k, low}, {q, high}, {-q, low}};
    for (int c = 0; c < 4; ++c) {
      const double r = functions[c].rate, sign = s == 0 ? -1.0 : 1.0;
      const double wall = std::exp(r * (far[s] - functions[c].at)), here = std::exp(r * (0.0 - functions[c].at));
      const int column = 4 * s + c;
      // k u = -v'; shear/eta = u' - k v; from the x balance k p = growth rho u - eta (u'' - k^2 u)
      const double u = -r / k;
      const double p = (growth * rho[s] * u - eta[s] * (r * r - k * k) * u) / k;
      A(2 * s, column) = wall;
      A(2 * s + 1, column) = ((s == 0 ? flow.floor : flow.lid) == boundary::no_slip ? r / k : r * r / (k * k)) * wall;
      A(4, column) = sign * here;
      A(5, column) = sign * u * here;
      A(6, column) = sign * eta[s] * (u * r - k) / ((eta[0] + eta[1]) * k) * here;
      A(7, column) = sign * (2.0 * eta[s] * r - p) / ((eta[0] + eta[1]) * k) * here;
      if (s == 1) {
        A(7, column) -=
            (flow.surface_tension * k * k - (rho_u - rho_l) * flow.gravity) / growth / ((eta[0] + eta[1]) * k) * here;
      }
    }
  }
  return A.determinant();
}

void check_determinant(const theory::two_layers& flow, double rho_l, double rho_u, double k) {
  const double growth = theory::growth_rate(flow, k);
  BOOST_TEST_CONTEXT("growth " << growth) {
    const double below = determinant(flow, rho_l, rho_u, k, growth * (1.0 - 1e-7));
    const double above = determinant(flow, rho_l, rho_u, k, growth * (1.0 + 1e-7));
    BOOST_TEST(below * above < 0.0);
  }
}

}  // namespace

// Incompressible values by the determinant above, compressible ones by a two-domain Chebyshev method for
// the generalised eigenproblem with the force eta lap v, both computed apart from this code; digits as recorded.
BOOST_AUTO_TEST_CASE(the_notes_box) {
  const struct {
    double eta, incompressible, compressible, last_digit;
  } table[] = {{1e11, 0.00341109486, 0.00344235, 1e-8},
               {6e11, 0.00219887196, 0.00229303, 1e-8},
               {6e12, 0.000354901085, 0.000389908, 1e-9}};
  for (const auto& row : table) {
    BOOST_TEST(close(theory::growth_rate(metal_over_silicate(row.eta, infinity), k1), row.incompressible, 4e-9));
    theory::two_layers flow = metal_over_silicate(row.eta, 5e11);
    flow.lower.bulk_viscosity = flow.upper.bulk_viscosity = -row.eta / 3.0;
    BOOST_TEST(std::abs(theory::growth_rate(flow, k1) - row.compressible) < 0.51 * row.last_digit);
  }
}

BOOST_AUTO_TEST_CASE(determinant_of_exponentials) {
  for (const boundary floor : {boundary::no_slip, boundary::free_slip}) {
    for (const boundary lid : {boundary::no_slip, boundary::free_slip}) {
      theory::two_layers flow = layers(3.0, 7.0, 0.7, 1.3, 0.4, 0.05);
      flow.floor = floor;
      flow.lid = lid;
      check_determinant(flow, 3.0, 7.0, 2.5);
      flow.surface_tension = 4.0;
      check_determinant(flow, 3.0, 7.0, 2.5);
    }
  }
}

// Creeping, both layers of thickness b and viscosity eta between no-slip walls [D. L. Turcotte and G. Schubert,
// Geodynamics, sect. 6.12]: growth = (drho g b/4 eta) [tanh kb/(kb)^2 - 1/(sinh kb cosh kb)]/[1/kb + 1/(sinh kb cosh
// kb)].
double creeping_growth_rate(double density_difference, double eta, double b, double g, double k) {
  const double kb = k * b, q = 1.0 / (std::sinh(kb) * std::cosh(kb));
  return density_difference * g * b / (4.0 * eta) * (std::tanh(kb) / (kb * kb) - q) / (1.0 / kb + q);
}

BOOST_AUTO_TEST_CASE(creeping_flow) {
  // Two layers alike, and the fastest wave length, 2.568 b [Turcotte and Schubert].
  for (const double kb : {0.3, 2.0 * pi / 2.568, 8.0}) {
    theory::two_layers flow = layers(3000.0, 3300.0, 1e5, 1e5, 1e21, 1e21);
    flow.inertia = false;
    BOOST_TEST(
        close(theory::growth_rate(flow, kb / 1e5), creeping_growth_rate(300.0, 1e21, 1e5, 10.0, kb / 1e5), 1e-9));
    // Inertia is negligible here.
    flow.inertia = true;
    BOOST_TEST(
        close(theory::growth_rate(flow, kb / 1e5), creeping_growth_rate(300.0, 1e21, 1e5, 10.0, kb / 1e5), 1e-9));
  }
  BOOST_TEST(close(creeping_growth_rate(1.0, 1.0, 1.0, 1.0, 2.0 * pi / 2.568), 1.0 / 13.04, 1e-3));
  // P. E. van Keken et al., J. Geophys. Res. 102, 22477 (1997): box 0.9142 x 1, lower layer 0.2, half a wave.
  theory::two_layers flow = layers(1000.0, 1010.0, 0.2, 0.8, 100.0, 100.0);
  flow.inertia = false;
  BOOST_TEST(close(theory::growth_rate(flow, pi / 0.9142), 0.0109402, 5e-6));
}

BOOST_AUTO_TEST_CASE(inviscid_limit) {
  const double k = 2.0;
  for (const double sigma : {0.0, 1.0}) {
    // [S. Chandrasekhar (1961), sect. 92, with walls]
    const double exact =
        std::sqrt((20.0 * k - sigma * k * k * k) / (3.0 / std::tanh(k * 1.1) + 1.0 / std::tanh(k * 0.8)));
    // The viscous layers at the interface take a part a sqrt(eta) + b eta.
    double growth[2];
    for (int i = 0; i < 2; ++i) {
      const double eta = i == 0 ? 1e-3 : 2.5e-4;
      theory::two_layers flow = layers(1.0, 3.0, 0.8, 1.1, eta, eta);
      flow.floor = flow.lid = boundary::free_slip;
      flow.surface_tension = sigma;
      growth[i] = theory::growth_rate(flow, k);
      BOOST_TEST(growth[i] < exact);
      BOOST_TEST(growth[i] > 0.98 * exact);
    }
    BOOST_TEST(close(2.0 * growth[1] - growth[0], exact, 3e-4));
  }
}

// Deep layers of one kinematic viscosity nu [S. Chandrasekhar (1961), sect. 94, eq. 113 without tension]:
// the dispersion relation, solved by hand as the zero of the expression, at k of the fastest growth and beside.
BOOST_AUTO_TEST_CASE(deep_viscous_layers) {
  const double nu = 0.01, g = 10.0, rho_1 = 1.0, rho_2 = 3.0, a1 = 0.25, a2 = 0.75;
  for (const double k : {5.0, 23.0, 60.0}) {
    const theory::two_layers flow = layers(rho_1, rho_2, 30.0 / k, 30.0 / k, rho_1 * nu, rho_2 * nu);
    const double n = theory::growth_rate(flow, k);
    const auto relation = [&](double s) {
      const double q = std::sqrt(k * k + s / nu);
      return -(g * k / (s * s) * (a1 - a2) + 1.0) * (a2 * q + a1 * q - k) - 4.0 * k * a1 * a2 +
             4.0 * k * k * nu / s * (a1 - a2) * ((a2 * q - a1 * q) + k * (a1 - a2)) +
             4.0 * k * k * k * nu * nu / (s * s) * (a1 - a2) * (a1 - a2) * (q - k) * (q - k);
    };
    BOOST_TEST(relation(n * (1.0 - 1e-7)) * relation(n * (1.0 + 1e-7)) < 0.0);
  }
}

BOOST_AUTO_TEST_CASE(incompressible_limit) {
  const double incompressible = theory::growth_rate(metal_over_silicate(6e11, infinity), k1);
  double last = 1.0;
  for (const double K : {5e12, 5e13, 5e14}) {
    const double excess = theory::growth_rate(metal_over_silicate(6e11, K), k1) / incompressible - 1.0;
    BOOST_TEST(excess > 0.0);
    BOOST_TEST(excess < 0.12 * last);
    last = excess;
  }
  BOOST_TEST(last < 1e-4);
}

BOOST_AUTO_TEST_CASE(stable_interfaces) {
  BOOST_TEST(theory::growth_rate(layers(3.0, 2.0, 1.0, 1.0, 1.0, 1.0), 2.0) == 0.0);
  theory::two_layers flow = layers(1.0, 2.0, 1.0, 1.0, 1e-3, 1e-3);
  flow.surface_tension = 10.0 / 4.0 * 1.0001;  // sigma k^2 just above drho g
  BOOST_TEST(theory::growth_rate(flow, 2.0) == 0.0);
  BOOST_CHECK_THROW(theory::eigenmode(flow, 2.0), tetsuame::foundation::error);
  flow.surface_tension = 10.0 / 4.0 * 0.9;
  BOOST_TEST(theory::growth_rate(flow, 2.0) > 0.0);
}

// A boundary layer of 1e-6 of the layer is beyond any resolution here, and said so.
BOOST_AUTO_TEST_CASE(too_thin_a_boundary_layer) {
  BOOST_CHECK_THROW(theory::growth_rate(layers(1.0, 2.0, 1.0, 1.0, 1e-12, 1e-12), 1.0), tetsuame::foundation::error);
}

// A deep upper layer does not know whether its lid is free.
BOOST_AUTO_TEST_CASE(free_surface) {
  theory::two_layers flow = layers(1.0, 2.0, 1.0, 6.0, 0.3, 0.3);
  const double closed = theory::growth_rate(flow, 3.0);
  flow.lid = boundary::free_surface;
  BOOST_TEST(close(theory::growth_rate(flow, 3.0), closed, 1e-9));
  // A shallow one does: less hindered than under free slip, where the lid holds v = 0.
  flow = layers(1.0, 2.0, 1.0, 0.3, 0.3, 0.3);
  flow.lid = boundary::free_slip;
  const double slip = theory::growth_rate(flow, 3.0);
  flow.lid = boundary::free_surface;
  BOOST_TEST(theory::growth_rate(flow, 3.0) > 1.1 * slip);
}

// The compressible equations themselves at points inside the layers, with derivatives by finite differences of the
// returned mode, about the closed form of the base state's density. With slowed sound and inertia too: zeta^2, xi^2 of
// the lower and the upper layer.
void check_the_equations(double softness, double heavy_lower, double heavy_upper) {
  const double K = 5e11, g = 10.0, b = 0.75e6;
  theory::two_layers flow = metal_over_silicate(6e11, K);
  flow.upper.viscosity = 2e12;
  flow.lower.bulk_viscosity = 3e11;
  flow.softness = softness;
  flow.lower.inertia = heavy_lower;
  flow.upper.inertia = heavy_upper;
  const theory::mode m = theory::eigenmode(flow, k1);
  const double growth = m.growth_rate, k = m.k;
  const double p_middle = 1e5 + (K + 1e5) * std::expm1(7000.0 * g * b / K);
  const auto check = [&](double y, double rho0, double top, double p_top, double eta, double lambda, double heavy) {
    const double h = 3e-4 * b;
    const auto v = [&](double at) { return theory::at(m, at); };
    const theory::mode_values c = v(y), up = v(y + h), down = v(y - h), up2 = v(y + 2 * h), down2 = v(y - 2 * h);
    const auto first = [&](auto f) { return (8.0 * (f(up) - f(down)) - (f(up2) - f(down2))) / (12.0 * h); };
    const auto second = [&](auto f) {
      return (16.0 * (f(up) + f(down)) - (f(up2) + f(down2)) - 30.0 * f(c)) / (12.0 * h * h);
    };
    const auto U = [&](const theory::mode_values& q) { return growth * q.displacement_x; };
    const auto V = [&](const theory::mode_values& q) { return growth * q.displacement_y; };
    const auto P = [](const theory::mode_values& q) { return q.pressure; };
    const double rho = rho0 * (1.0 + p_top / K) * std::exp(rho0 * g * (top - y) / K), sound2 = K / rho0,
                 density = c.pressure / sound2;
    // growth zeta^2 rho' + v drho/dy + rho div = 0
    const double div = first(V) + k * U(c);
    BOOST_TEST(std::abs(growth * softness * density - rho0 * g / K * rho * V(c) + rho * div) <
               1e-6 * rho * std::abs(first(V)));
    // growth xi^2 rho (u, v) = -grad p' + rho' g + eta lap (u, v) + (eta + lambda) grad div
    const double ddiv = second(V) + k * first(U);
    const double x =
        -growth * heavy * rho * U(c) + k * c.pressure + eta * (second(U) - k * k * U(c)) - k * (eta + lambda) * div;
    const double z = -growth * heavy * rho * V(c) - first(P) - density * g + eta * (second(V) - k * k * V(c)) +
                     (eta + lambda) * ddiv;
    BOOST_TEST(std::abs(x) < 1e-5 * growth * heavy * rho * std::abs(V(c)));
    BOOST_TEST(std::abs(z) < 1e-5 * growth * heavy * rho * std::abs(V(c)));
  };
  for (const double f : {0.2, 0.5, 0.9}) {
    check(f * b, 7000.0, b, 1e5, 2e12, -2.0 / 3.0 * 2e12, heavy_upper);
    check(-f * b, 3000.0, 0.0, p_middle, 6e11, 3e11 - 2.0 / 3.0 * 6e11, heavy_lower);
  }
  // Interface and walls.
  const theory::mode_values above = theory::at(m, 0.0), below = theory::at(m, -1e-9 * b);
  BOOST_TEST(close(above.displacement_y, 1.0, 1e-9));
  BOOST_TEST(close(below.displacement_x, above.displacement_x, 1e-6));
  BOOST_TEST(close(below.displacement_y, above.displacement_y, 1e-6));
  for (const double wall : {-b, b}) {
    BOOST_TEST(std::abs(theory::at(m, wall).displacement_x) < 1e-12);
    BOOST_TEST(std::abs(theory::at(m, wall).displacement_y) < 1e-12);
  }
  BOOST_CHECK_THROW(theory::at(m, 1.001 * b), tetsuame::foundation::error);
}

BOOST_AUTO_TEST_CASE(mode_obeys_the_equations) {
  check_the_equations(1.0, 1.0, 1.0);
  check_the_equations(2.25, 4.0, 1.69);
}

// Softer, it grows faster; heavier, slower; both by little where dynamic pressure and inertia are small.
BOOST_AUTO_TEST_CASE(slowed_growth) {
  theory::two_layers flow = layers(3000.0, 7000.0, 500.0, 500.0, 1e13, 1e13, 5e11, 1e5);
  const double k = 2.0 * pi / 1000.0, growth = theory::growth_rate(flow, k);
  flow.softness = 100.0;  // of a dynamic pressure of 4e-5 K
  const double softer = theory::growth_rate(flow, k);
  BOOST_TEST(softer > growth * (1.0 + 1e-4));
  BOOST_TEST(softer < growth * 1.01);
  flow.softness = 1.0;
  flow.lower.inertia = flow.upper.inertia = 1e-3 * 1e13 * k * k / (growth * 5000.0);  // a share of 1e-3
  const double heavier = theory::growth_rate(flow, k);
  BOOST_TEST(heavier < growth * (1.0 - 1e-4));
  BOOST_TEST(heavier > growth * 0.998);
}
