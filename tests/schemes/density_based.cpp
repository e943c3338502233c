// Gradients by an integral, forces with geometric densities and artificial conductivity: what they reproduce and
// conserve.
#include <boost/test/unit_test.hpp>

#include "cloud.hpp"
#include "conservation.hpp"

using namespace tetsuame;
using pairs::real;

namespace {

// -Σ_j V_j (a_i - a_j) A_ij(h_i), a = p.
template <int D, class Kernel>
struct gradient_by_integral {
  Kernel unit;
  schemes::fields<D> g;
  std::array<double*, D> out;
  struct me {
    pairs::vec<real, D> sum;
  };
  auto reads() const {
    using namespace schemes;
    return g.read(of_volume, of_pressure, of_per_support, of_integral);
  }
  me begin(const pairs::cluster<>&) const { return {foundation::zero<real, D>()}; }
  void add(me& a, const auto& ij) const {
    using namespace schemes;
    const real per_S = ij.own(of_per_support);
    const auto k = kernel_of_end<D>(unit, ij, per_S);
    const real weight = ij(of_volume) * ij.difference(of_pressure);
    a.sum -= weight * integral_gradient<D>(ij.own(of_integral), ij.x_ij, real(power<D>(per_S) * k.W));
  }
  void end(const pairs::cluster<>& i, const me& a) const {
    for (std::size_t k = 0; k < D; ++k) i.set(out[k], a.sum[k]);
  }
};

template <int D, class Kernel>
void linear_fields_have_their_slope(const Kernel& unit) {
  const std::array<double, 3> slope{0.5, -0.25, 2.0};
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    cloud<D> g = disorder<D>(seed);
    for (std::size_t i = 0; i < g.n; ++i) g.S[i] += 0.4;
    prepare_density_based(g, unit);
    for (std::size_t i = 0; i < g.n; ++i) {
      g.p[i] = 3.0;
      for (std::size_t a = 0; a < D; ++a) g.p[i] += slope[a] * g.x[a][i];
    }
    std::array<array, D> is;
    std::array<double*, D> out;
    for (std::size_t a = 0; a < D; ++a) {
      is[a].resize(g.n);
      out[a] = is[a].data();
    }
    g.sum(gradient_by_integral<D, Kernel>{unit, g.fields(), out});
    // Sums of 59 terms, solved with moments whose condition is below 1e3 here.
    for (std::size_t a = 0; a < D; ++a)
      for (std::size_t i = 0; i < g.n; ++i) BOOST_TEST(std::abs(is[a][i] - slope[a]) <= 60.0 * 1e3 * epsilon);
  }
}

// Of two particles at rest at 0 and r: power of the first with this α_u, less that with none.
template <bool Geometric, bool Integral>
std::array<double, 2> conducted(double p_i, double p_j, double u_i, double u_j) {
  using kernel = kernels::quintic_spline<1>;
  const kernel unit(1.0);
  cloud<1> g(2);
  g.x[0] = {0.0, 0.1, 1e60};
  for (std::size_t i = 0; i < 2; ++i) {
    g.m[i] = i == 0 ? 1.0 : 0.5;
    g.u[i] = 1.0;
    g.S[i] = i == 0 ? 0.36 : 0.3;
  }
  prepare_density_based(g, unit);
  g.rho[0] = 2.0, g.rho[1] = 3.0;
  g.p[0] = p_i, g.p[1] = p_j;
  g.u[0] = u_i, g.u[1] = u_j;
  std::array<double, 2> power{};
  for (const double alpha_u : {0.0, 0.7}) {
    g.sum(schemes::density_based<1, kernel, Geometric, Integral>{{unit, g.fields()}, alpha_u});
    for (std::size_t i = 0; i < 2; ++i) power[i] = g.power[i] - power[i];
  }
  return power;
}

}  // namespace

BOOST_AUTO_TEST_CASE(slopes_of_linear_fields) {
  linear_fields_have_their_slope<1>(kernels::quintic_spline<1>(1.0));
  linear_fields_have_their_slope<2>(kernels::quintic_spline<2>(1.0));
  linear_fields_have_their_slope<2>(kernels::wendland_c4<2>(1.0));
  linear_fields_have_their_slope<3>(kernels::wendland_c4<3>(1.0));
}

// Neighbours on a line: C has the trace's part, and nothing is infinite; alone: nothing.
BOOST_AUTO_TEST_CASE(too_few_neighbours) {
  const kernels::quintic_spline<2> unit(1.0);
  cloud<2> g(4);
  for (std::size_t i = 0; i < 4; ++i) {
    g.x[0][i] = i == 3 ? 50.0 : 0.1 * static_cast<double>(i);
    g.m[i] = g.u[i] = 1.0;
    g.S[i] = 0.36;
  }
  prepare_density_based(g, unit);
  double trace = 0.0;
  for (const std::size_t j : {0, 2}) {
    const double r = std::abs(g.x[0][1] - g.x[0][j]);
    trace += g.dV[j] * r * r * unit.value(r / 0.36) / (0.36 * 0.36);
  }
  BOOST_TEST(std::abs(g.integral[0][1] * trace / 2.0 - 1.0) <= 1e-13);
  BOOST_TEST(g.integral[1][1] == 0.0);
  BOOST_TEST(g.integral[2][1] == g.integral[0][1]);
  for (std::size_t k = 0; k < 3; ++k) BOOST_TEST(g.integral[k][3] == 0.0);
  BOOST_TEST(g.factor[3] == 1.0);
}

template <int D, class Kernel>
void density_based_conserve(const Kernel& unit) {
  for (const std::uint32_t seed : {1U, 2U, 3U})
    for (const double conductivity : {0.0, 1.0}) {
      cloud<D> g = disorder<D>(seed);
      prepare_density_based(g, unit);
      for_each_density_based(g, unit, conductivity, [&](const auto& term, const char* name) {
        g.sum(term);
        check_conservation(g, name);
      });
    }
}
BOOST_AUTO_TEST_CASE(momentum_and_energy) {
  density_based_conserve<1>(kernels::quintic_spline<1>(1.0));
  density_based_conserve<2>(kernels::quintic_spline<2>(1.0));
  density_based_conserve<3>(kernels::wendland_c4<3>(1.0));
}

// With the kernel's gradients and no conductivity the standard form is ssph.
BOOST_AUTO_TEST_CASE(standard_form_is_ssph) {
  using kernel = kernels::quintic_spline<2>;
  const kernel unit(1.0);
  cloud<2> g = disorder<2>(4);
  prepare_density_based(g, unit);
  g.sum(schemes::ssph<2, kernel>{unit, g.fields()});
  const array force = g.force[0], power = g.power;
  g.sum(schemes::density_based<2, kernel, false, false>{{unit, g.fields()}, 0.0});
  double size = 0.0;
  for (std::size_t i = 0; i < g.n; ++i) size = std::max({size, std::abs(force[i]), std::abs(power[i])});
  for (std::size_t i = 0; i < g.n; ++i) {
    BOOST_TEST(std::abs(g.force[0][i] - force[i]) <= 100.0 * epsilon * size);
    BOOST_TEST(std::abs(g.power[i] - power[i]) <= 100.0 * epsilon * size);
  }
}

// g as published, by loops of its own; with the supports' factor -D/Σ V r W'.
BOOST_AUTO_TEST_CASE(factor_of_geometric_densities) {
  const kernels::wendland_c4<2> unit(1.0);
  cloud<2> g = disorder<2>(7);
  for (const bool supports_vary : {false, true}) {
    prepare_density_based(g, unit, supports_vary);
    for (std::size_t i = 0; i < g.n; ++i) {
      double of_mass = 0.0, of_volume = 0.0;
      for (std::size_t j = 0; j < g.n; ++j) {
        const double r = std::hypot(g.x[0][i] - g.x[0][j], g.x[1][i] - g.x[1][j]), S = g.S[i];
        if (j == i) continue;
        const double slope = unit.gradient_over_r(r / S) * r * r / std::pow(S, 4);  // r W'
        of_mass += g.m[j] / g.rho[i] * slope;
        of_volume += g.m[j] / g.rho[j] * slope;
      }
      const double want = (supports_vary ? -2.0 : of_mass) / of_volume;
      BOOST_TEST(std::abs(g.factor[i] / want - 1.0) <= 1e-12);
    }
  }
}

// At one pressure forces know the volumes alone: masses and densities in the same ratio change nothing.
BOOST_AUTO_TEST_CASE(geometric_forces_at_one_pressure) {
  using kernel = kernels::quintic_spline<2>;
  const kernel unit(1.0);
  cloud<2> g = disorder<2>(9);
  prepare_density_based(g, unit);
  for (std::size_t i = 0; i < g.n; ++i) {
    g.p[i] = 2.5;
    g.dissipation[i] = 0.0;
  }
  const schemes::density_based<2, kernel, true, true> term{{unit, g.fields()}, 0.0};
  g.sum(term);
  const array force = g.force[1];
  for (std::size_t i = 0; i < g.n; ++i) {
    const double heavier = i % 2 == 0 ? 8.0 : 0.5;
    g.m[i] *= heavier, g.rho[i] *= heavier;
  }
  g.sum(term);
  for (std::size_t i = 0; i < g.n; ++i) BOOST_TEST(g.force[1][i] == force[i]);
}

// Price's term of a pair by its formula; from hot to cold, so that the entropy of both together, Σ m ln u, grows; and
// none at one pressure or one energy.
BOOST_AUTO_TEST_CASE(conductivity_of_a_pair) {
  const kernels::quintic_spline<1> unit(1.0);
  const auto slope = [&](double S) { return unit.gradient_over_r(0.1 / S) * 0.1 / (S * S * S); };  // W'
  const double density = 2.5, v = std::sqrt((4.0 - 1.0) / density);
  for (const double u_j : {0.2, 5.0}) {
    const double want = 1.0 * 0.5 * 0.7 * v * (1.0 - u_j) / density * 0.5 * (slope(0.36) + slope(0.3));
    for (const auto& [of_i, of_j] :
         {conducted<false, false>(1.0, 4.0, 1.0, u_j), conducted<false, true>(1.0, 4.0, 1.0, u_j),
          conducted<true, false>(1.0, 4.0, 1.0, u_j), conducted<true, true>(1.0, 4.0, 1.0, u_j)}) {
      BOOST_TEST(std::abs(of_i / want - 1.0) <= 1e-12);
      BOOST_TEST(std::abs(of_i + of_j) <= 1e-14 * std::abs(of_i));
      BOOST_TEST(of_i / 1.0 + of_j / u_j > 0.0);
    }
  }
  for (const auto& [of_i, of_j] :
       {conducted<false, false>(4.0, 4.0, 1.0, 5.0), conducted<true, true>(1.0, 4.0, 2.0, 2.0)}) {
    BOOST_TEST(of_i == 0.0);
    BOOST_TEST(of_j == 0.0);
  }
}
