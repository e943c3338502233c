// The viscous force where the viscosity varies, on the lattice and in disorder.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <convection/graded_viscosity.hpp>
#include <convection/pass.hpp>
#include <functional>
#include <liquid/passes.hpp>
#include <run/lists.hpp>
#include <run/start.hpp>

#include "../support/scene.hpp"

namespace tt = boost::test_tools;
using namespace tetsuame;
using namespace tetsuame::convection;
using tetsuame::test::alone;

namespace {

using place = std::array<double, 2>;
using vector_field = std::function<place(place)>;

constexpr std::int64_t side = 32;  // particles, spacing 1

run::state<2> box(double jitter) {
  run::state<2> scene;
  domain::options o;
  for (std::size_t a = 0; a < 2; ++a) {
    o.length[a] = static_cast<double>(side);
    o.particles[a] = side;
    o.periodic[a] = true;
  }
  o.jitter = jitter;
  run::set_up<2>(scene, alone(), o, {}, {"wendland_c2", 1.3, 0.1}, 0.0);
  run::rebuild(scene, false);
  return scene;
}

struct forces {
  std::array<particles::array, 2> plain, corrected;  // over nu
  std::array<particles::array, 2> slope;             // of ln nu
};

// Of velocities and viscosities given wherever there are particles; what lags comes from `passes` evaluations.
forces force_of(const run::state<2>& scene, const vector_field& v, const std::function<double(double)>& nu,
                bool isotropic, int passes) {
  constexpr std::size_t N = angular_terms;
  const auto& s = scene.w.s;
  const auto filled = [&](double value) { return particles::array(s.total() + 1, value); };
  std::array<particles::array, 2> velocity{filled(0.0), filled(0.0)}, force = velocity, P = velocity;
  particles::array root = filled(1.0);
  for (std::size_t i = 0; i < s.total(); ++i) {
    const auto x = cells::position<2>(s.x, i);
    for (std::size_t a = 0; a < 2; ++a) velocity[a][i] = v(x)[a];
    root[i] = std::sqrt(nu(x[1]));
  }
  std::array<particles::array, N> angular, next;
  for (std::size_t k = 0; k < N; ++k) next[k] = angular[k] = filled(0.0);
  const double beta = operators::lattice_beta<2>(scene.w.kernel, scene.w.dx);
  bool singular = false;
  operators::consistent<2, 2, false, 0U> gradients{{}, {}, {}, 1.0, beta, {}, &singular};
  graded_viscosity<2> viscous{};
  viscous.root = root.data();
  viscous.beta = beta * 4.0 / 6.0;
  std::array<std::array<particles::array, 2>, 2> gradient;
  forces out;
  for (std::size_t a = 0; a < 2; ++a) {
    out.plain[a] = out.corrected[a] = out.slope[a] = filled(0.0);
    viscous.slope[a] = out.slope[a].data();
    gradients.f[a] = velocity[a].data();
    gradients.P[a] = P[a].data();
    viscous.force[a] = force[a].data();
    viscous.out[a] = out.corrected[a].data();
    viscous.plain[a] = out.plain[a].data();
    for (std::size_t b = 0; b < 2; ++b) {
      gradient[a][b] = filled(0.0);
      gradients.out.gradient[a][b] = gradient[a][b].data();
      viscous.gradient[a][b] = gradient[a][b].data();
    }
  }
  for (std::size_t k = 0; k < N; ++k) {
    viscous.angular[k] = angular[k].data();
    viscous.next_angular[k] = next[k].data();
  }
  for (int pass = 0; pass < passes; ++pass) {
    scene.w.sum(scene.w.fluid(), gradients, viscous);
    auto w = scene.w;
    for (std::size_t a = 0; a < 2; ++a) {
      for (std::size_t i = 0; i < s.fluid; ++i) force[a][i] = root[i] * root[i] * out.plain[a][i];
      w.exchange_fluid({force[a].data()});
    }
    for (std::size_t k = 0; k < N && isotropic; ++k) {
      std::copy_n(next[k].begin(), s.fluid, angular[k].begin());
      w.exchange_fluid({angular[k].data()});
    }
  }
  BOOST_TEST(!singular);
  return out;
}

// Root mean square of the error over particles at least eight spacings from the box's border, over that of `exact`.
double error(const run::state<2>& scene, const std::array<particles::array, 2>& f, const vector_field& exact) {
  double sum = 0.0, all = 0.0;
  for (std::size_t i = 0; i < scene.w.s.fluid; ++i) {
    const auto x = cells::position<2>(scene.w.s.x, i);
    if (std::max(std::abs(x[0] - 16.0), std::abs(x[1] - 16.0)) > 8.0) continue;
    const auto e = exact(x);
    for (std::size_t a = 0; a < 2; ++a) {
      sum += (f[a][i] - e[a]) * (f[a][i] - e[a]);
      all += e[a] * e[a];
    }
  }
  return std::sqrt(sum / all);
}

// A shear stress sin(k y) across nu = exp(g (y - 16)): u' = sin(k y)/nu.
struct shear {
  double g, k;
  double nu(double y) const { return std::exp(g * (y - 16.0)); }
  place velocity(place x) const {
    return {-(g * std::sin(k * x[1]) + k * std::cos(k * x[1])) / ((g * g + k * k) * nu(x[1])), 0.0};
  }
  place force(place x) const { return {k * std::cos(k * x[1]) / nu(x[1]), 0.0}; }
};

}  // namespace

// On the lattice, along its rows. What is left with one viscosity is of fourth order; where it varies, Simpson's rule
// is 2 % off for the longest lines at g = 1.2, Δ = 3 (docs/theory/convection_viscosity.md).
BOOST_AUTO_TEST_CASE(shear_across_an_exponential_viscosity) {
  const auto scene = box(0.0);
  for (const double g : {0.0, 0.6, 1.2}) {
    const shear flow{g, 0.3};
    const auto v = [&](place x) { return flow.velocity(x); };
    const auto exact = [&](place x) { return flow.force(x); };
    const auto nu = [&](double y) { return flow.nu(y); };
    const auto lame = force_of(scene, v, nu, false, 1), right = force_of(scene, v, nu, true, 8);
    const double without = error(scene, lame.plain, exact), plain = error(scene, right.plain, exact),
                 corrected = error(scene, right.corrected, exact);
    BOOST_TEST_MESSAGE("g " << g << ": error " << without << " with s = 1, " << plain << " isotropic, " << corrected
                            << " corrected");
    BOOST_TEST(without > 0.15);  // the lattice's rows shear by 0.83 of the viscosity
    BOOST_TEST(corrected < (g == 0.0 ? 0.2 * plain : plain));
    BOOST_TEST(corrected < 0.01 + 0.02 * g);
  }
}

// In disorder, with one viscosity: isotropic weights take most of the scatter away.
BOOST_AUTO_TEST_CASE(shear_in_disorder) {
  const auto scene = box(0.1);
  const shear flow{0.0, 0.3};
  const auto v = [&](place x) { return flow.velocity(x); };
  const auto exact = [&](place x) { return flow.force(x); };
  const auto nu = [](double) { return 1.0; };
  const double without = error(scene, force_of(scene, v, nu, false, 1).plain, exact),
               isotropic = error(scene, force_of(scene, v, nu, true, 12).plain, exact);
  BOOST_TEST_MESSAGE("error " << without << " with s = 1, " << isotropic << " isotropic");
  BOOST_TEST(isotropic < 0.7 * without);
}

// Right for a smooth viscosity, and bounded where it jumps: the chain rule would give a hundred.
BOOST_AUTO_TEST_CASE(slope_of_the_logarithm) {
  const auto at_rest = [](place) { return place{0.0, 0.0}; };
  const auto in_middle = [](const run::state<2>& scene, const particles::array& f, const auto& check) {
    for (std::size_t i = 0; i < scene.w.s.fluid; ++i)
      if (std::abs(scene.w.s.x[1][i] - 16.0) < 8.0) check(f[i]);
  };
  for (const double jitter : {0.0, 0.1}) {
    const auto scene = box(jitter);
    for (const double g : {-0.6, 0.1, 0.6}) {
      const auto f = force_of(
          scene, at_rest, [&](double y) { return std::exp(g * (y - 16.0)); }, true, 2);
      const double share = jitter == 0.0 ? 0.02 : 0.25;
      in_middle(scene, f.slope[1], [&](double slope) { BOOST_TEST(std::abs(slope - g) < share * std::abs(g)); });
    }
    const auto jump = force_of(
        scene, at_rest, [](double y) { return y < 16.0 ? 1.0 : 1e40; }, true, 2);
    in_middle(scene, jump.slope[1], [](double slope) {
      BOOST_TEST(slope > -0.2);
      BOOST_TEST(slope < 6.0);
    });
  }
}

BOOST_AUTO_TEST_CASE(stiffness_of_a_contrast) {
  const auto scene = box(0.0);
  const auto& s = scene.w.s;
  const double g = 0.8, reach = scene.w.support();
  particles::array root(s.total() + 1, 1.0), own(s.total() + 1, 1.0), viscous(s.total() + 1, 0.0), coupled = viscous;
  const auto sum = [&] {
    scene.w.sum(scene.w.fluid(), contrast{root.data(), own.data(), viscous.data(), coupled.data()});
  };
  sum();
  BOOST_TEST(viscous[0] == 1.0, tt::tolerance(1e-14));
  BOOST_TEST(coupled[0] == 1.0, tt::tolerance(1e-14));
  for (std::size_t i = 0; i < s.total(); ++i) {
    own[i] = std::exp(g * (s.x[1][i] - 16.0));
    root[i] = std::sqrt(own[i]);
  }
  sum();
  // The same over the lattice's places, by hand.
  std::array<double, 4> by_hand{};
  std::visit(
      [&](const auto& k) {
        for (int a = -3; a <= 3; ++a)
          for (int b = -3; b <= 3; ++b) {
            const double r = std::hypot(a, b);
            if (r == 0.0 || r >= reach) continue;
            const double F = k.gradient_over_r(r), up = std::exp(g * b);
            by_hand[0] += F;
            by_hand[1] += F * 6.0 * up / (1.0 + 4.0 * std::sqrt(up) + up);
            by_hand[2] += F * r;
            by_hand[3] += F * r * up;
          }
      },
      scene.w.kernel);
  for (std::size_t i = 0; i < s.fluid; ++i) {
    if (std::abs(s.x[1][i] - 16.0) > 8.0) continue;
    BOOST_TEST(viscous[i] == by_hand[1] / by_hand[0], tt::tolerance(1e-12));
    BOOST_TEST(coupled[i] == by_hand[3] / by_hand[2], tt::tolerance(1e-12));
  }
}
