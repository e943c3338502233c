// Pairs in single precision, compiled as programs are, which fuse products with sums: what one end of a pair gets the
// other loses to the bit, and sums of that lose nothing.
#include <boost/test/unit_test.hpp>
#include <diffusion/conduction.hpp>
#include <gradient/pattern_1.hpp>
#include <gradient/pattern_2.hpp>
#include <numeric>
#include <schemes/godunov.hpp>
#include <schemes/viscous.hpp>

#include "cloud.hpp"

using namespace tetsuame;

namespace {

constexpr double rounding = 0x1p-24;  // of single numbers, of themselves at most

// A generator that every use of begins anew.
double number_of(std::size_t seed, double low, double high) {
  std::mt19937 random(static_cast<std::uint32_t>(seed));
  random.discard(2);
  return std::uniform_real_distribution<double>(low, high)(random);
}

template <int D>
void change_velocities(cloud<D>& g, double factor) {
  for (auto& v : g.v)
    for (double& one : v) one *= factor;
}

// Disorder in which no force is so large that sums begin with a smaller number (pairs/long_sum.hpp).
template <int D>
cloud<D> mild_disorder(std::uint32_t seed, std::size_t count) {
  cloud<D> g = disorder<D>(seed, count);
  change_velocities(g, 0.1);
  for (std::size_t i = 0; i < g.n; ++i) {
    g.m[i] = 0.7 + 0.3 * g.m[i];
    g.u[i] = 2.0 + 0.2 * g.u[i];
    g.S[i] = 0.3 + 0.2 * g.S[i];
  }
  return g;
}

// C of a neighbourhood on all sides in the place of the cloud's, which may lie on one, with forces as large as they
// like.
template <int D>
void give_tensors(cloud<D>& g) {
  for (std::size_t b = 0; b < D; ++b)
    for (std::size_t c = b; c < D; ++c)
      for (std::size_t i = 0; i < g.n; ++i)
        g.integral[operators::symmetric_place(b, c, D)][i] =
            (b == c ? 10.0 : 0.0) / (g.S[i] * g.S[i]) + number_of(7 * i + b + c, -2.0, 2.0);
}

// f(g, term, name) for each scheme that has single precision, its fields as in a run.
template <int D, class Kernel>
void for_each_scheme(cloud<D>& g, const Kernel& unit, const auto& f) {
  prepare(g, unit, weigh::mass, true, false);
  f(g, schemes::ssph<D, Kernel>{unit, g.fields()}, "ssph");
  prepare(g, unit, weigh::mass, false, false);
  f(g, schemes::gsph<D, Kernel>{unit, g.fields(), 2.0, false}, "gsph");
  for (const bool number : {false, true}) {
    prepare(g, unit, weigh::energy, true, number);
    f(g, schemes::disph<D, Kernel>{unit, g.fields()}, "disph");
    prepare(g, unit, weigh::energy, false, number);
    f(g, schemes::gdisph<D, Kernel>{unit, g.fields(), 2.0, false}, "gdisph");
  }
  prepare_density_based(g, unit);
  give_tensors(g);
  for_each_density_based(g, unit, 1.0, [&](const auto& term, const char* name) { f(g, term, name); });
}

// f(seed, g): two particles, a part of the box from each other. The nearer, the larger are the f_i of a lonely pair.
template <int D>
void for_each_pair(double part, const auto& f) {
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    cloud<D> g = mild_disorder<D>(seed, 2);
    for (std::size_t a = 0; a < D; ++a) g.x[a][1] = g.x[a][0] + part * (g.x[a][1] - 0.5);
    g.gamma[1] = 5.0 / 3.0;
    BOOST_TEST_CONTEXT("pair " << seed << " in " << D << "-D") f(seed, g);
  }
}

void in_single(auto& g, const auto& term) {
  g.see_all(2);
  g.sum_single(term);
  g.see_all(1);
}

template <int D, class Kernel>
void gas_is_opposite(const Kernel& unit) {
  for_each_pair<D>(0.3, [&](std::uint32_t seed, auto& g) {
    for_each_scheme(g, unit, [&](auto& h, const auto& term, const char* name) {
      for (std::size_t k = 0; k < h.gradient.size(); ++k)
        for (std::size_t i = 0; i < 2; ++i) h.gradient[k][i] = number_of(100 * seed + 2 * k + i, -1.0, 1.0);
      in_single(h, term);
      for (std::size_t a = 0; a < D; ++a) BOOST_TEST(h.force[a][0] == -h.force[a][1], name);
    });
  });
}

// n = 30 pairs in either half of a sum, whose rest rounds off 64 n² u² at most of the pressure on one side.
template <int D, class Kernel>
void gas_keeps_momentum(const Kernel& unit) {
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    cloud<D> g = mild_disorder<D>(seed, 60);
    for_each_scheme(g, unit, [&](auto& h, const auto& term, const char* name) {
      in_single(h, term);
      for (std::size_t a = 0; a < D; ++a) {
        const auto& force = h.force[a];
        const double all = std::accumulate(force.begin(), force.end(), 0.0);
        const double size =
            std::accumulate(force.begin(), force.end(), 0.0, [](double s, double f) { return s + std::abs(f); });
        BOOST_TEST(std::abs(all) <= 64.0 * std::pow(30.0 * rounding, 2) * size, name);
      }
    });
  }
}

// Slow pairs, nearer than half their supports S, by a kernel without differences of its own: sums and products of
// positive numbers only. Roundings then add up: of the kernel's slope 5 for each of the 3 to t = 1 - r/S >= 1/2, which
// t^5 (1 + 5 r/S) makes 5/t times as large, and 15 else; 25 in the star pressure, 20 in factors and fields; and a step
// of the positions, of r.
template <int D, class Kernel>
void gas_is_near_double(const Kernel& unit) {
  for_each_pair<D>(0.1, [&](std::uint32_t, auto& g) {
    change_velocities(g, 0.15);
    for_each_scheme(g, unit, [&](auto& h, const auto& term, const char* name) {
      h.sum(term);
      std::array<array, D> want;
      for (std::size_t a = 0; a < D; ++a) want[a] = h.force[a];
      in_single(h, term);
      double r2 = 0.0, miss2 = 0.0, size2 = 0.0;
      for (std::size_t a = 0; a < D; ++a) {
        r2 += std::pow(h.x[a][0] - h.x[a][1], 2);
        miss2 += std::pow(h.force[a][0] - want[a][0], 2);
        size2 += std::pow(want[a][0], 2);
      }
      BOOST_TEST(std::sqrt(miss2 / size2) <= 90.0 * rounding + 2.0 * 0x1p-28 * std::sqrt(D / r2), name);
    });
  });
}

// What liquids exchange: p ΔV² in two forms, friction, heat.
template <int D>
void liquid_is_opposite() {
  const kernels::quintic_spline<D> kernel(0.4);
  for_each_pair<D>(0.1, [&](std::uint32_t seed, auto& g) {
    const auto force = g.force.data();
    const auto v = pairs::pointers<D>(g.v);
    for (std::size_t i = 0; i < 2; ++i) {
      g.p[i] = number_of(10 * seed + i, 1.0, 3.0);
      g.dV[i] = number_of(10 * seed + 2 + i, 0.01, 0.02);
      g.eta[i] = number_of(10 * seed + 4 + i, 1.0, 9.0);
    }
    const auto check = [&](const auto& term, const char* name) {
      for (std::size_t a = 0; a < D; ++a) std::fill(g.force[a].begin(), g.force[a].end(), 0.0);
      std::fill(g.power.begin(), g.power.end(), 0.0);
      g.see_all(2);
      pairs::sum_in<D>(pairs::unit<pairs::single>(1.0), pairs::row_range{0, 2, 0, 2}, g.list, pairs::pointers<D>(g.x),
                       kernel, term);
      for (std::size_t a = 0; a < D; ++a) BOOST_TEST(g.force[a][0] == -g.force[a][1], name);
    };
    check(gradient::pattern_1::term<D>{v, g.p.data(), g.dV.data(), {force, g.power.data()}}, "pattern 1");
    BOOST_TEST(std::abs(g.force[0][0]) > 0.0);
    BOOST_TEST(g.power[0] == g.power[1]);
    check(gradient::pattern_2::term<D>{v, g.p.data(), g.dV.data(), {force, g.power.data()}}, "pattern 2");
    BOOST_TEST(g.power[0] == g.power[1]);
    check(diffusion::viscosity<D>{v, g.eta.data(), g.dV.data(), force, g.power.data()}, "friction");
    BOOST_TEST(g.power[0] == g.power[1]);
    check(diffusion::uniform_viscosity<D>{v, 3.0, g.dV.data(), force, g.power.data()}, "one viscosity");
    BOOST_TEST(g.power[0] == g.power[1]);
    check(diffusion::conduction<D>{g.u.data(), g.eta.data(), g.dV.data(), g.power.data()}, "heat");
    BOOST_TEST(g.power[0] == -g.power[1]);
  });
}

}  // namespace

BOOST_AUTO_TEST_CASE(gas) {
  gas_is_opposite<2>(kernels::quintic_spline<2>(1.0));
  gas_is_opposite<3>(kernels::wendland_c4<3>(1.0));
}
BOOST_AUTO_TEST_CASE(sums_of_gas) {
  gas_keeps_momentum<2>(kernels::quintic_spline<2>(1.0));
  gas_keeps_momentum<3>(kernels::wendland_c4<3>(1.0));
}
BOOST_AUTO_TEST_CASE(rounding_of_gas) { gas_is_near_double<3>(kernels::wendland_c4<3>(1.0)); }
BOOST_AUTO_TEST_CASE(liquids) { liquid_is_opposite<2>(); }
