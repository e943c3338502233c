// The parts of SSPH, DISPH, GSPH and Godunov DISPH: limiter, interface, viscosity, gradients, supports, and what a
// right-hand side of random particles conserves.
#include <boost/test/unit_test.hpp>
#include <numeric>
#include <schemes/godunov.hpp>
#include <schemes/remix.hpp>
#include <schemes/viscous.hpp>

#include "cloud.hpp"
#include "conservation.hpp"

using namespace tetsuame;
using pairs::real;

namespace {

template <int D, class Kernel>
void all_schemes_conserve(const Kernel& unit) {
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    cloud<D> g = disorder<D>(seed);
    prepare(g, unit, weigh::mass, true, false);
    g.sum(schemes::ssph<D, Kernel>{unit, g.fields()});
    check_conservation(g, "ssph");
    prepare(g, unit, weigh::mass, false, false);
    g.sum(schemes::gsph<D, Kernel>{unit, g.fields(), 2.0, false});
    check_conservation(g, "gsph");
    for (const bool number : {false, true}) {
      prepare(g, unit, weigh::energy, true, number);
      g.sum(schemes::disph<D, Kernel>{unit, g.fields()});
      check_conservation(g, "disph");
      prepare(g, unit, weigh::energy, false, number);
      g.sum(schemes::gdisph<D, Kernel>{unit, g.fields(), 2.0, false});
      check_conservation(g, "gdisph");
      for (std::size_t k = 0; k < g.gradient.size(); ++k) std::fill(g.gradient[k].begin(), g.gradient[k].end(), 0.0);
      g.sum(schemes::gdisph<D, Kernel>{unit, g.fields(), 2.0, true});
      check_conservation(g, "gdisph, first order, exact");
    }
  }
}

// As a run of REMIX does, with densities, viscosity and diffusion among particles of two materials.
template <int D, class Kernel>
void prepare_remix(cloud<D>& g, const Kernel& unit) {
  prepare(g, unit, weigh::mass, true, false);
  for (std::size_t i = 0; i < g.n; ++i) {
    g.rho[i] = 0.5 + static_cast<double>(i % 5);
    g.dV[i] = g.m[i] / g.rho[i];
    g.kind[i] = static_cast<double>(i % 3 == 0);
    g.dissipation[i] = static_cast<double>(i % 7) / 6.0;
  }
  g.find_corrections(unit);
  g.find_gradients(unit);
}
double limited(double difference, double slope, double theta) {
  return schemes::limited(real(difference), real(slope), theta)[0];
}

// The star pressure that particle i sees.
struct star_pressure : schemes::godunov<1, kernels::quintic_spline<1>> {
  double* star;
  struct me {
    real p;
  };
  auto reads() const { return read_with(); }
  me begin(const pairs::cluster<>&) const { return {real(0.0)}; }
  void add(me& a, const auto& ij) const {
    real p = star_of(ij).p;
    pairs::stdx::where(ij.r > 1e10, p) = 0.0;  // the particle itself
    a.p += p;
  }
  void end(const pairs::cluster<>& i, const me& a) const { i.set(star, a.p); }
};

}  // namespace

BOOST_AUTO_TEST_CASE(conservation_on_a_line) { all_schemes_conserve<1>(kernels::quintic_spline<1>(1.0)); }
BOOST_AUTO_TEST_CASE(conservation_in_the_plane) {
  all_schemes_conserve<2>(kernels::quintic_spline<2>(1.0));
  all_schemes_conserve<2>(kernels::wendland_c4<2>(1.0));
}

template <int D, class Kernel>
void remix_conserves(const Kernel& unit) {
  for (const std::uint32_t seed : {1U, 2U}) {
    cloud<D> g = disorder<D>(seed);
    prepare_remix(g, unit);
    g.sum(schemes::remix<D, Kernel>{unit, g.fields(), 3.6});
    check_conservation(g, "remix");
  }
}
BOOST_AUTO_TEST_CASE(remix_keeps_momentum_and_energy) {
  remix_conserves<1>(kernels::quintic_spline<1>(1.0));
  remix_conserves<2>(kernels::wendland_c4<2>(1.0));
}

// The sums of a field linear in x with W^R and its gradient give the field and its slope, on any arrangement: evaluated
// here from A, B and their gradients, and these gradients against differences of A and B at a place moved.
BOOST_AUTO_TEST_CASE(linear_fields_are_reproduced) {
  const kernels::wendland_c4<2> unit(1.0);
  const std::size_t at = 11;
  cloud<2> g = disorder<2>(6);
  for (std::size_t i = 0; i < g.n; ++i) {
    g.S[i] += 0.4;
    g.dV[i] = 0.01 + 0.02 * static_cast<double>(i % 4);
    g.per_S[i] = 1.0 / g.S[i];
  }
  const auto corrections = [&](double dx, double dy) {
    const auto place = std::array{g.x[0][at], g.x[1][at]};
    g.x[0][at] += dx;
    g.x[1][at] += dy;
    g.find_corrections(unit);
    g.x[0][at] = place[0];
    g.x[1][at] = place[1];
    std::array<double, 10> all;
    for (std::size_t k = 0; k < all.size(); ++k) all[k] = g.reproducing[k][at];
    return all;
  };
  // Of A, B_x, B_y at a place moved by little. The particle's own share of the sums stays where the particle was.
  const auto here = corrections(0.0, 0.0);
  const auto [m0, A, Bx, By, Ax, Ay, Bxx, Bxy, Byx, Byy] = here;
  double one = 0.0, x = 0.0, y = 0.0, one_x = 0.0, x_x = 0.0, y_x = 0.0, one_y = 0.0, x_y = 0.0, y_y = 0.0;
  for (std::size_t j = 0; j < g.n; ++j) {
    const double dx = g.x[0][at] - g.x[0][j], dy = g.x[1][at] - g.x[1][j], r = std::hypot(dx, dy), V = g.dV[j];
    double W = 0.0, F = 0.0;
    for (const double S : {g.S[at], g.S[j]}) {
      W += 0.5 * unit.value(r / S) / (S * S);
      if (r > 0.0) F += 0.5 * unit.gradient_over_r(r / S) / (S * S * S * S);
    }
    const double linear = 1.0 + Bx * dx + By * dy, WR = A * linear * W;
    const double WR_x = (Ax * linear + A * (Bx + Bxx * dx + Byx * dy)) * W + A * linear * F * dx;
    const double WR_y = (Ay * linear + A * (By + Bxy * dx + Byy * dy)) * W + A * linear * F * dy;
    one += V * WR, x += V * WR * dx, y += V * WR * dy;
    one_x += V * WR_x, x_x += V * WR_x * g.x[0][j], y_x += V * WR_x * g.x[1][j];
    one_y += V * WR_y, x_y += V * WR_y * g.x[0][j], y_y += V * WR_y * g.x[1][j];
  }
  BOOST_TEST(std::abs(m0 * A - 1.0) > 0.01);  // there is something to correct
  for (const auto& [got, want] : {std::pair{one, 1.0},
                                  {x, 0.0},
                                  {y, 0.0},
                                  {one_x, 0.0},
                                  {one_y, 0.0},
                                  {x_x, 1.0},
                                  {y_x, 0.0},
                                  {x_y, 0.0},
                                  {y_y, 1.0}})
    BOOST_TEST(std::abs(got - want) <= 1e-11);
}

// Between particles of two materials nothing diffuses, and nothing at all acts between those at rest at one pressure
// whose gradients cancel: on a lattice.
BOOST_AUTO_TEST_CASE(remix_at_rest_on_a_lattice) {
  const kernels::quintic_spline<2> unit(1.0);
  constexpr std::size_t edge = 11;
  cloud<2> g(edge * edge);
  for (std::size_t i = 0; i < g.n; ++i) {
    const std::size_t row = i / edge;
    g.x[0][i] = static_cast<double>(i % edge);
    g.x[1][i] = static_cast<double>(row);
    g.rho[i] = i % edge < 5 ? 4.0 : 1.0;
    g.m[i] = g.rho[i];
    g.p[i] = 2.5;
    g.u[i] = 2.5 / (0.4 * g.rho[i]);
    g.c[i] = 1.0;
    g.S[i] = 2.4;
    g.per_S[i] = 1.0 / 2.4;
    g.dV[i] = 1.0;
  }
  g.find_corrections(unit);
  g.find_gradients(unit);
  g.sum(schemes::remix<2, kernels::quintic_spline<2>>{unit, g.fields(), 3.6});
  // Particles whose neighbours have all of theirs
  for (std::size_t i = 0; i < g.n; ++i) {
    if (i % edge < 5 || i % edge > 5 || i / edge < 5 || i / edge > 5) continue;
    for (const double value : {g.force[0][i], g.force[1][i], g.power[i], g.density_rate[i]})
      BOOST_TEST(std::abs(value) <= 1e-12);
  }
}

// Morris and Monaghan's α: decays to the least in h/(0.2 c), rises at the rate of compression towards the most, and gas
// that expands does nothing.
BOOST_AUTO_TEST_CASE(alpha_in_time) {
  using schemes::alpha_rate;
  const double c = 2.0, h = 0.1;
  BOOST_TEST(std::abs(alpha_rate(0.6, 0.1, 1.0, 0.0, c, h) + 0.5 * 0.2 * c / h) <= 1e-14);
  BOOST_TEST(alpha_rate(0.6, 0.1, 1.0, 3.0, c, h) == alpha_rate(0.6, 0.1, 1.0, 0.0, c, h));
  BOOST_TEST(std::abs(alpha_rate(0.6, 0.1, 1.0, -3.0, c, h) - alpha_rate(0.6, 0.1, 1.0, 0.0, c, h) - 3.0 * 0.4) <=
             1e-14);
  // Steady compression: α settles where both cancel, (D α_max + R α_min)/(D + R), D = -∇·v, R = 0.2 c/h.
  double alpha = 0.1;
  for (int k = 0; k < 20000; ++k) alpha += 1e-3 * alpha_rate(alpha, 0.1, 1.0, -12.0, c, h);
  BOOST_TEST(std::abs(alpha - (12.0 * 1.0 + 4.0 * 0.1) / 16.0) <= 1e-12);
}

// Balsara's factor of flows whose ∇·v and ∇×v are known, by the sums that a run makes.
BOOST_AUTO_TEST_CASE(balsara_of_flows) {
  const kernels::quintic_spline<2> unit(1.0);
  constexpr std::size_t edge = 9;
  const auto factor = [&](double compression, double rotation) {
    cloud<2> g(edge * edge);
    for (std::size_t i = 0; i < g.n; ++i) {
      const std::size_t row = i / edge;
      g.x[0][i] = static_cast<double>(i % edge);
      g.x[1][i] = static_cast<double>(row);
      g.v[0][i] = -0.5 * compression * g.x[0][i] - 0.5 * rotation * g.x[1][i];
      g.v[1][i] = -0.5 * compression * g.x[1][i] + 0.5 * rotation * g.x[0][i];
      g.m[i] = g.weight[i] = 1.0;
      g.S[i] = 3.6;
    }
    g.find_densities(unit);
    const std::size_t middle = g.n / 2;
    BOOST_TEST(std::abs(g.divergence[middle] + compression) <= 0.01 * compression);
    BOOST_TEST(std::abs(g.curl[middle] - rotation) <= 0.01 * rotation);
    return schemes::balsara_factor(g.divergence[middle], g.curl[middle], 1e-6, 1.2);
  };
  BOOST_TEST(factor(1.0, 0.0) > 0.999);
  BOOST_TEST(factor(0.0, 1.0) < 0.001);
  BOOST_TEST(std::abs(factor(1.0, 3.0) - 0.25) < 0.01);
}

// By its definition: minmod(θΔ, d, θ(2d - Δ)), and never further than either neighbour's value.
BOOST_AUTO_TEST_CASE(limiter) {
  const auto minmod = [](double a, double b, double c) {
    if (a > 0.0 && b > 0.0 && c > 0.0) return std::min({a, b, c});
    if (a < 0.0 && b < 0.0 && c < 0.0) return std::max({a, b, c});
    return 0.0;
  };
  for (const double theta : {1.0, 2.0})
    for (int i = -12; i <= 12; ++i)
      for (int k = -12; k <= 12; ++k) {
        const double difference = 0.25 * i, d = 0.5 * k, is = limited(difference, d, theta);
        BOOST_TEST(is == minmod(theta * difference, d, theta * (2.0 * d - difference)));
        BOOST_TEST((0.5 * is * difference >= 0.0 && std::abs(0.5 * is) <= std::abs(difference)));
      }
  BOOST_TEST(limited(1.0, 1.0, 1.0) == 1.0);  // a linear field's slope is kept
}

// Exact on any arrangement.
BOOST_AUTO_TEST_CASE(gradients_of_linear_fields) {
  const kernels::quintic_spline<2> unit(1.0);
  cloud<2> g = disorder<2>(5);
  for (std::size_t i = 0; i < g.n; ++i) {
    g.S[i] = 0.8;
    g.weight[i] = g.m[i];
  }
  g.find_densities(unit);
  const auto p_at = [](double x, double y) { return 3.0 + 0.5 * x - 0.25 * y; };
  for (std::size_t i = 0; i < g.n; ++i) {
    const double x = g.x[0][i], y = g.x[1][i];
    g.dV[i] = 1.0 / g.number[i];
    g.p[i] = p_at(x, y);
    g.rho[i] = 2.0 - 0.3 * x + 0.1 * y;
    g.v[0][i] = 0.2 * x - 0.4 * y;
    g.v[1][i] = 0.7 * x + 0.1 * y;
  }
  g.find_gradients(unit);
  const std::array<double, 8> want{0.5, -0.25, -0.3, 0.1, 0.2, -0.4, 0.7, 0.1};
  for (std::size_t k = 0; k < want.size(); ++k)
    for (std::size_t i = 0; i < g.n; ++i) BOOST_TEST(std::abs(g.gradient[k][i] - want[k]) < 1e-11);
}

// Of two particles on a line with the slope of their difference, times `steep`, in p and ρ: the star pressure. With a
// linear field both sides meet in the middle, where there is no jump; without slopes, or with slopes against the
// difference, the Riemann problem is that of the particles.
BOOST_AUTO_TEST_CASE(interface_states) {
  const auto star = [](double steep, double gamma_l, double stiffness_l, bool exact) {
    cloud<1> g(2);
    g.x[0] = {0.0, 0.1, 1e60};
    g.p = {1.0, 1.5, 1.0};
    g.rho = {1.0, 1.2, 1.0};
    g.gamma[0] = gamma_l;
    g.stiffness[0] = stiffness_l;
    for (std::size_t i = 0; i < 2; ++i) {
      g.c[i] = std::sqrt(g.gamma[i] * (g.p[i] + g.stiffness[i]) / g.rho[i]);
      g.gradient[0][i] = steep * 0.5 / 0.1;
      g.gradient[1][i] = steep * 0.2 / 0.1;
    }
    array is(2);
    g.sum(star_pressure{{{kernels::quintic_spline<1>(1.0), g.fields()}, 2.0, exact}, is.data()});
    BOOST_TEST(std::abs(is[0] - is[1]) <= 4.0 * epsilon);  // seen from either end
    return is[0];
  };
  const auto of_ends = [](double gamma_l, double stiffness_l) {
    return riemann::solve(riemann::side<double>{1.0, 0.0, 1.0, gamma_l, stiffness_l},
                          riemann::side<double>{1.2, 0.0, 1.5, adiabatic, 0.0})
        .p;
  };
  for (const bool exact : {false, true}) {
    BOOST_TEST(std::abs(star(1.0, adiabatic, 0.0, exact) - 1.25) <= 4.0 * epsilon);
    for (const auto& [gamma_l, stiffness_l] : {std::pair{adiabatic, 0.0}, std::pair{4.0, 3.0}})
      for (const double steep : {0.0, -1.0}) {
        const double miss = std::abs(star(steep, gamma_l, stiffness_l, exact) - of_ends(gamma_l, stiffness_l));
        BOOST_TEST(miss <= (exact ? 1e-9 : 0.05 * 0.5));  // HLLC is approximate: a twentieth of the jump
      }
  }
}

// Artificial viscosity: nothing between particles that part, and antisymmetric heating that is never cooling.
BOOST_AUTO_TEST_CASE(viscosity_of_closing_pairs) {
  const kernels::quintic_spline<1> unit(1.0);
  for (const double w : {-1.0, 1.0}) {
    cloud<1> g(2);
    g.x[0] = {0.0, 0.1, 1e60};
    g.v[0] = {-0.5 * w, 0.5 * w, 0.0};
    for (std::size_t i = 0; i < 2; ++i) {
      g.m[i] = g.u[i] = 1.0;
      g.S[i] = 0.36;
    }
    prepare(g, unit, weigh::mass, true, false);
    const auto rate = [&](double alpha) {
      for (std::size_t i = 0; i < 2; ++i) g.dissipation[i] = alpha;
      g.sum(schemes::ssph<1, kernels::quintic_spline<1>>{unit, g.fields()});
      return std::array{g.force[0][0], g.power[0]};
    };
    const auto without = rate(0.0), with = rate(1.0);
    if (w > 0.0) {
      BOOST_TEST((with == without));
    } else {
      // Π = -½ α v_sig w/ρ, force m² Π W' [J. J. Monaghan, J. Comput. Phys. 136, 298 (1997)], half the work on either
      // end
      const double r = 0.1, signal = 2.0 * g.c[0] + 3.0,
                   W_slope = unit.gradient_over_r(r / 0.36) * r / std::pow(0.36, 3);
      const double force = 0.5 * signal / g.rho[0] * W_slope;  // towards -x, as W' < 0
      BOOST_TEST(std::abs(with[0] - without[0] - force) <= 1e-13 * std::abs(force));
      BOOST_TEST(std::abs(with[1] - without[1] + 0.5 * force) <= 1e-13 * std::abs(force));
      BOOST_TEST(with[1] > without[1]);
    }
  }
}

// f is for supports with y S^D fixed, z for n S^D fixed: the change of y that a small motion makes, supports following,
// is f times that at fixed supports, or that of the sum with w_j + z. Supports by bisection, changes by central
// differences.
BOOST_AUTO_TEST_CASE(terms_of_supports_that_vary) {
  const kernels::quintic_spline<2> unit(1.0);
  cloud<2> g = disorder<2>(8);
  for (std::size_t i = 0; i < g.n; ++i) g.weight[i] = g.m[i];
  const std::size_t at = 7;
  const auto sums = [&](double S, double time) {  // y, n of particle `at`
    double y = g.weight[at] * unit.self(), n = unit.self();
    for (std::size_t j = 0; j < g.n; ++j) {
      if (j == at) continue;
      double r2 = 0.0;
      for (std::size_t a = 0; a < 2; ++a) {
        const double d = g.x[a][at] - g.x[a][j] + time * (g.v[a][at] - g.v[a][j]);
        r2 += d * d;
      }
      const double W = unit.value(std::sqrt(r2) / S);
      y += g.weight[j] * W;
      n += W;
    }
    return std::array{y / (S * S), n / (S * S)};
  };
  const double S0 = g.S[at], step = 1e-5;
  const auto following = [&](std::size_t which, double time) {
    const double target = sums(S0, 0.0)[which] * S0 * S0;
    double low = 0.8 * S0, high = 1.25 * S0;
    for (int k = 0; k < 200; ++k) {
      const double S = 0.5 * (low + high);
      (sums(S, time)[which] * S * S < target ? low : high) = S;
    }
    return sums(0.5 * (low + high), time)[0];
  };
  g.find_densities(unit);
  double fixed = 0.0, of_number = 0.0;  // rates of y: sums of (w_j and 1) v·∇W
  for (std::size_t j = 0; j < g.n; ++j) {
    if (j == at) continue;
    double r2 = 0.0, vx = 0.0;
    for (std::size_t a = 0; a < 2; ++a) {
      const double d = g.x[a][at] - g.x[a][j];
      r2 += d * d;
      vx += d * (g.v[a][at] - g.v[a][j]);
    }
    const double slope = unit.gradient_over_r(std::sqrt(r2) / S0) / std::pow(S0, 4) * vx;
    fixed += g.weight[j] * slope;
    of_number += slope;
  }
  const auto rate = [&](std::size_t which) {
    return (following(which, step) - following(which, -step)) / (2.0 * step);
  };
  const double by_weight = rate(0), by_number = rate(1), size = std::abs(fixed);
  BOOST_TEST(std::abs(g.f[at] * fixed - by_weight) <= 1e-6 * size);
  BOOST_TEST(std::abs(fixed + g.z[at] * of_number - by_number) <= 1e-6 * size);
  BOOST_TEST(std::abs(by_weight - by_number) > 1e-3 * size);  // the two differ here
}
