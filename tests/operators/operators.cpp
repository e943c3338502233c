// Gradients and Laplacians: what they are exact for, and their order with the deferred correction.
#include <algorithm>
#include <functional>
#include <liquid/passes.hpp>
#include <numbers>
#include <operators/consistent.hpp>
#include <run/lists.hpp>
#include <run/start.hpp>

#include "../support/scene.hpp"

using namespace tetsuame;
using namespace tetsuame::test;

namespace {

template <int D>
run::state<D> make(std::int64_t n, double jitter, bool periodic, const char* kernel = "wendland_c2",
                   const char* precision = "double") {
  run::state<D> scene;
  domain::options box;
  for (std::size_t a = 0; a < D; ++a) {
    box.length[a] = 1.0;
    box.particles[a] = n;
    box.periodic[a] = periodic;
  }
  box.jitter = jitter;
  run::set_up<D>(scene, alone(), box, {}, {kernel, kernels::find(kernel).default_h_over_dx, 0.1, precision}, 0.0);
  run::rebuild(scene, false);
  return scene;
}

template <int D>
struct derivatives {
  std::array<particles::array, D> gradient;
  particles::array laplacian;
};

// Of f, given wherever there are particles, walls' images included. passes: B and the correction lag one behind.
template <int D, bool skewed = false>
derivatives<D> differentiate(const run::state<D>& scene, const std::function<double(std::array<double, D>)>& f,
                             bool whole_tensor, double beta, int passes = 1) {
  constexpr std::size_t S = operators::symmetric_terms(D);
  const auto& s = scene.w.s;
  particles::array value(s.total() + 1, 0.0), P(s.total() + 1, 0.0), plain(s.fluid);
  for (std::size_t i = 0; i < s.total(); ++i) value[i] = f(cells::position<D>(s.x, i));
  std::array<particles::array, S> B, next;
  for (std::size_t k = 0; k < S; ++k) next[k] = B[k] = particles::array(s.total() + 1, 0.0);
  for (std::size_t a = 0; a < D; ++a)
    std::fill(B[operators::symmetric_place(a, a, D)].begin(), B[operators::symmetric_place(a, a, D)].end(), 1.0);
  derivatives<D> out;
  out.gradient.fill(particles::array(s.fluid));
  out.laplacian.resize(s.fluid);
  bool singular = false;
  operators::consistent<D, 1, true, ~0U, skewed> term{{value.data()}, {P.data()}, {},       std::pow(scene.w.dx, D),
                                                      beta,           {},         &singular};
  for (std::size_t a = 0; a < D; ++a) term.out.gradient[0][a] = out.gradient[a].data();
  for (std::size_t k = 0; k < S; ++k) {
    term.B[k] = whole_tensor ? B[k].data() : nullptr;
    term.out.next_B[k] = next[k].data();
  }
  term.out.laplacian[0] = out.laplacian.data();
  term.out.plain[0] = plain.data();
  for (int pass = 0; pass < passes; ++pass) {
    scene.w.sum(scene.w.fluid(), term);
    if (whole_tensor)
      for (std::size_t k = 0; k < S; ++k) std::copy_n(next[k].begin(), s.fluid, B[k].begin());
    std::copy_n(plain.begin(), s.fluid, P.begin());
    auto w = scene.w;  // ghosts of a periodic box
    w.exchange_fluid({P.data()});
  }
  BOOST_TEST(!singular);
  return out;
}

template <int D>
double largest(const run::state<D>& scene, const particles::array& a,
               const std::function<double(std::array<double, D>)>& exact) {
  double e = 0.0;
  for (std::size_t i = 0; i < scene.w.s.fluid; ++i)
    e = std::max(e, std::abs(a[i] - exact(cells::position<D>(scene.w.s.x, i))));
  return e;
}

}  // namespace

BOOST_AUTO_TEST_CASE(symmetric_systems) {
  std::array<std::array<double, 3>, 3> A{{{4, 0, 0}, {2, 5, 0}, {1, 3, 6}}};  // lower half
  BOOST_TEST(operators::factorise(A));
  const auto x = operators::solve(A, {4 + 4 + 3.0, 2 + 10 + 9.0, 1 + 6 + 18.0});  // of (1, 2, 3)
  for (std::size_t k = 0; k < 3; ++k)
    BOOST_TEST(x[k] == static_cast<double>(k + 1), boost::test_tools::tolerance(1e-14));
  std::array<std::array<double, 2>, 2> singular{{{1, 0}, {1, 1}}};
  BOOST_TEST(!operators::factorise(singular));
  BOOST_TEST(operators::symmetric_place(1, 0, 3) == 1U);
  BOOST_TEST(operators::symmetric_place(1, 2, 3) == 4U);
  BOOST_TEST(operators::symmetric_place(2, 2, 3) == 5U);
}

// A matrix a lane, one of which is singular.
BOOST_AUTO_TEST_CASE(symmetric_systems_in_lanes) {
  using foundation::real;
  const auto at = [](std::size_t lane) { return static_cast<double>(lane); };
  std::array<std::array<real, 2>, 2> A;
  std::array<real, 2> b;
  for (std::size_t lane = 0; lane < foundation::lanes; ++lane) {
    A[0][0][lane] = 4.0 + at(lane);
    A[1][0][lane] = lane == 1 ? A[0][0][lane] : 2.0;
    A[1][1][lane] = lane == 1 ? A[0][0][lane] : 5.0;
    b[0][lane] = A[0][0][lane] + at(lane) * A[1][0][lane];  // of (1, lane)
    b[1][lane] = A[1][0][lane] + at(lane) * A[1][1][lane];
  }
  const auto definite = operators::factorise(A);
  BOOST_TEST(foundation::bits_of(definite) == ((1U << foundation::lanes) - 1U) - 2U);
  const auto x = operators::solve(A, b);
  for (std::size_t lane = 0; lane < foundation::lanes; ++lane) {
    if (lane == 1) continue;
    BOOST_TEST(std::abs(x[0][lane] - 1.0) < 1e-13);
    BOOST_TEST(std::abs(x[1][lane] - at(lane)) < 1e-13);
  }
}

// What pairs are computed in changes no more than its rounding, with the correction and at the last particles too.
BOOST_AUTO_TEST_CASE(single_precision) {
  const std::function<double(std::array<double, 2>)> wave = [](auto x) { return std::sin(3.0 * x[0] + 2.0 * x[1]); };
  const auto in_double = make<2>(13, 0.1, false), in_single = make<2>(13, 0.1, false, "wendland_c2", "single");
  const double beta = operators::lattice_beta<2>(in_double.w.kernel, in_double.w.dx);
  const auto d = differentiate<2>(in_double, wave, true, beta, 2), f = differentiate<2>(in_single, wave, true, beta, 2);
  double of_gradient = 0.0, of_laplacian = 0.0;
  const auto& ids = in_single.w.s.id;  // clusters of another width lie in another order
  for (std::size_t i = 0; i < in_double.w.s.fluid; ++i) {
    const auto k = static_cast<std::size_t>(std::ranges::find(ids, in_double.w.s.id[i]) - ids.begin());
    of_gradient = std::max(of_gradient, std::abs(d.gradient[1][i] - f.gradient[1][k]));
    of_laplacian = std::max(of_laplacian, std::abs(d.laplacian[i] - f.laplacian[k]));
  }
  BOOST_TEST(of_gradient > 0.0);
  BOOST_TEST(of_gradient < 2e-5);
  BOOST_TEST(of_laplacian < 2e-3);
}

// Skewed: neighbourhoods need not be symmetric. Without, what is left of a Laplacian of 7 is second order in the
// jitter.
BOOST_AUTO_TEST_CASE(quadratic_fields_on_any_particles) {
  const std::function<double(std::array<double, 2>)> flat = [](auto x) {
    return 1.0 + 2.0 * x[0] - x[1] + 3.0 * x[0] * x[0] - 2.0 * x[0] * x[1] + 0.5 * x[1] * x[1];
  };
  const auto disordered = make<2>(14, 0.2, false);
  const auto off = [](auto) { return 7.0; };
  BOOST_TEST(largest<2>(disordered, differentiate<2, true>(disordered, flat, true, 0.0, 2).laplacian, off) < 1e-9);
  BOOST_TEST(largest<2>(disordered, differentiate<2>(disordered, flat, true, 0.0, 2).laplacian, off) > 1e-3);
  const std::function<double(std::array<double, 3>)> deep = [](auto x) {
    return x[0] * x[0] - 3.0 * x[1] * x[1] + 2.0 * x[2] * x[2] + x[0] * x[2] - 4.0 * x[1] * x[2] + x[1];
  };
  const auto box = make<3>(8, 0.15, false);
  const auto none = [](auto) { return 0.0; };
  BOOST_TEST(largest<3>(box, differentiate<3, true>(box, deep, true, 0.0, 2).laplacian, none) < 1e-9);
}

BOOST_AUTO_TEST_CASE(linear_fields_on_any_particles) {
  const auto check = [](auto scene, auto f, auto slope, int n) {
    constexpr int D = std::tuple_size_v<decltype(slope)>;
    for (const bool whole : {false, true}) {
      const auto d = differentiate<D>(scene, f, whole, 0.0, 2);
      for (std::size_t a = 0; a < D; ++a)
        BOOST_TEST(largest<D>(scene, d.gradient[a], [&](auto) { return slope[a]; }) < 1e-12);
      BOOST_TEST(largest<D>(scene, d.laplacian, [](auto) { return 0.0; }) < 1e-11 * n * n);
    }
  };
  check(
      make<2>(12, 0.2, false), [](std::array<double, 2> x) { return 1.0 + 2.0 * x[0] - 3.0 * x[1]; },
      std::array{2.0, -3.0}, 12);
  check(
      make<3>(8, 0.2, false), [](std::array<double, 3> x) { return x[0] - 2.0 * x[1] + 0.5 * x[2]; },
      std::array{1.0, -2.0, 0.5}, 8);
}

BOOST_AUTO_TEST_CASE(quadratic_fields_on_the_lattice) {
  const auto scene = make<2>(12, 0.0, false);
  const std::function<double(std::array<double, 2>)> xx = [](auto x) { return x[0] * x[0]; },
                                                     xy = [](auto x) { return x[0] * x[1]; };
  BOOST_TEST(largest<2>(scene, differentiate<2>(scene, xx, false, 0.0).laplacian, [](auto) { return 2.0; }) < 1e-10);
  BOOST_TEST(largest<2>(scene, differentiate<2>(scene, xx, true, 0.0, 2).laplacian, [](auto) { return 2.0; }) < 1e-10);
  BOOST_TEST(largest<2>(scene, differentiate<2>(scene, xy, true, 0.0, 2).laplacian, [](auto) { return 0.0; }) < 1e-10);
}

BOOST_AUTO_TEST_CASE(quadratic_fields_in_disorder) {
  const auto scene = make<2>(16, 0.1, false);
  const std::function<double(std::array<double, 2>)> saddle = [](auto x) { return x[0] * x[0] - x[1] * x[1]; };
  const double trace =
      largest<2>(scene, differentiate<2>(scene, saddle, false, 0.0).laplacian, [](auto) { return 0.0; });
  const double whole =
      largest<2>(scene, differentiate<2>(scene, saddle, true, 0.0, 2).laplacian, [](auto) { return 0.0; });
  BOOST_TEST_MESSAGE("error of the Laplacian of x^2 - y^2: " << trace << " by the trace, " << whole
                                                             << " by the tensor");
  // The second moments of a disordered neighbourhood are wrong by about the disorder; what is left is of its square.
  BOOST_TEST(trace > 0.2);
  BOOST_TEST(whole < 0.25 * trace);
}

BOOST_AUTO_TEST_CASE(deferred_correction) {
  const auto check = []<int D>(std::integral_constant<int, D>, std::int64_t coarse) {
    const double k = 2.0 * std::numbers::pi;
    const std::function<double(std::array<double, D>)> wave = [k](auto x) {
      return std::sin(k * x[0]) * std::cos(k * x[1]);
    };
    std::array<double, 2> gradient, laplacian, plain;
    for (std::size_t n = 0; n < 2; ++n) {
      const auto scene = make<D>(coarse * static_cast<std::int64_t>(n + 1), 0.0, true);
      const double beta = operators::lattice_beta<D>(scene.w.kernel, scene.w.dx);
      const auto d = differentiate<D>(scene, wave, true, beta, 3);
      gradient[n] =
          largest<D>(scene, d.gradient[0], [k](auto x) { return k * std::cos(k * x[0]) * std::cos(k * x[1]); });
      const std::function<double(std::array<double, D>)> exact = [&](auto x) { return -2.0 * k * k * wave(x); };
      laplacian[n] = largest<D>(scene, d.laplacian, exact);
      plain[n] = largest<D>(scene, differentiate<D>(scene, wave, true, 0.0, 2).laplacian, exact);
    }
    BOOST_TEST_MESSAGE(D << "-D: errors fall by " << gradient[0] / gradient[1] << " (gradient), "
                         << laplacian[0] / laplacian[1] << " (Laplacian), without correction by "
                         << plain[0] / plain[1]);
    BOOST_TEST(plain[0] / plain[1] < 4.5);        // second order
    BOOST_TEST(gradient[0] / gradient[1] > 6.0);  // better: fourth order but for the lattice's anisotropy
    BOOST_TEST(laplacian[0] < 0.3 * plain[0]);
    BOOST_TEST(laplacian[1] < 0.3 * plain[1]);
  };
  check(std::integral_constant<int, 2>{}, 16);
  check(std::integral_constant<int, 3>{}, 10);
}
