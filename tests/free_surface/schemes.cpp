// Schemes of water beside the default one: what they exchange between particles, and what they dissipate.
#include <boost/test/unit_test.hpp>

#include "scene.hpp"

using namespace tetsuame;
using namespace tetsuame::free_surface;

namespace {

// Twenty by ten spacings of 0.05 m far from all walls.
std::string block_in_the_middle(const std::string& more) {
  return tank("low_x = 0.5 high_x = 1.5 low_y = 0.75 high_y = 1.25 gravity = 0.0 sound_speed = 20.0 " + more,
              "jitter = 0.3 ");
}

}  // namespace

// Forces come in pairs along the line between two particles.
BOOST_AUTO_TEST_CASE(riemann_momentum) {
  scene<2> scene(block_in_the_middle("scheme = 'riemann' viscosity = 3.0"));
  auto& s = scene.particles();
  disturb(scene);
  const auto rate = scene.rates();
  const auto scale = scene.sum([&](std::size_t i) { return s.m[i] * std::hypot(rate[2][i], rate[3][i]); });
  BOOST_TEST(scale > 100.0);
  for (const std::size_t a : {2, 3})
    BOOST_TEST(std::abs(scene.sum([&](std::size_t i) { return s.m[i] * rate[a][i]; })) < 1e-13 * scale);
  const auto torque =
      scene.sum([&](std::size_t i) { return s.m[i] * (s.x[0][i] * rate[3][i] - s.x[1][i] * rate[2][i]); });
  BOOST_TEST(std::abs(torque) < 1e-12 * scale);
}

// What motion and densities lose together is, pair by pair, V_i V_j |F| r [β ρ̄ w² + (p_i - p_j)²/(ρ̄ c)], with the
// speed w at which the two meet.
BOOST_AUTO_TEST_CASE(riemann_dissipation) {
  scene<2> scene(block_in_the_middle("scheme = 'riemann'"));
  auto& s = scene.particles();
  const auto& w = scene.f->world.w;
  disturb(scene);
  const auto rate = scene.rates();
  const double gained = scene.sum([&](std::size_t i) {
    return s.m[i] * (s.v[0][i] * rate[2][i] + s.v[1][i] * rate[3][i] + s.p[i] / (s.rho[i] * s.rho[i]) * rate[4][i]);
  });
  const auto sum_of_pairs = [&](auto&& loss) {  // loss(i, j, w)
    return scene.sum([&](std::size_t i) {
      double lost = 0.0;
      for (std::size_t j = 0; j < s.total(); ++j) {
        const double x = s.x[0][i] - s.x[0][j], y = s.x[1][i] - s.x[1][j], r = std::hypot(x, y);
        if (i == j || !(r < w.support())) continue;
        const double meet = std::max(0.0, -((s.v[0][i] - s.v[0][j]) * x + (s.v[1][i] - s.v[1][j]) * y) / r);
        lost -= 0.5 * s.dV[i] * s.dV[j] *
                std::visit([&](const auto& kernel) { return kernel.gradient_over_r(r); }, w.kernel) * r *
                loss(i, j, meet);
      }
      return lost;
    });
  };
  const auto mean = [&](std::size_t i, std::size_t j) { return 0.5 * (s.rho[i] + s.rho[j]); };
  const double met = sum_of_pairs(
      [&](std::size_t i, std::size_t j, double meet) { return std::min(3.0 * meet, 20.0) * mean(i, j) * meet * meet; });
  const double smoothed = sum_of_pairs([&](std::size_t i, std::size_t j, double) {
    return (s.p[i] - s.p[j]) * (s.p[i] - s.p[j]) / (mean(i, j) * 20.0);
  });
  BOOST_TEST(met > 10.0);
  BOOST_TEST(smoothed > 10.0);
  BOOST_TEST(std::abs(gained + met + smoothed) < 1e-9 * (met + smoothed));
}

// What turns as a whole in a pressure that is hydrostatic has no Riemann problems: nothing is compressed, on any
// arrangement and at the surface too, and forces are those of the default scheme without viscosity.
BOOST_AUTO_TEST_CASE(riemann_at_rest) {
  std::array<std::vector<double>, 2> force;
  for (const bool riemann : {false, true}) {
    scene<2> scene(tank(
        "high_y = 1.5 sound_factor = 20.0 " + std::string(riemann ? "scheme = 'riemann'" : "alpha = 0.0 delta = 0.0"),
        "jitter = 0.3 "));
    auto& s = scene.particles();
    refresh(*scene.f);
    for (std::size_t i = 0; i < s.total(); ++i) {
      s.v[0][i] = 0.3 - 2.0 * s.x[1][i];
      s.v[1][i] = -0.1 + 2.0 * s.x[0][i];
      s.rho[i] = 1000.0;
      s.p[i] = 9810.0 * (3.0 - s.x[1][i]);
      s.dV[i] = 0.0025;
    }
    sum_over_neighbours(*scene.f, scene.f->world.w.fluid());
    double size = 0.0;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      BOOST_TEST(std::abs(scene.f->density_rate[i]) < 1e-8);  // rounding of 1000 · 2 1/s
      for (std::size_t a = 0; a < 2; ++a) {
        if (!riemann)
          force[a].push_back(scene.f->force[a][i]);
        else
          BOOST_TEST(std::abs(scene.f->force[a][i] - force[a][i]) < 1e-9);
        size = std::max(size, std::abs(scene.f->force[a][i]));
      }
    }
    BOOST_TEST(size > 10.0);  // N
  }
}

// In the default scheme forces and the rates of volumes know volumes and pressures alone: whatever the densities of two
// particles with the same volumes and pressures, as of liquids in contact, they stay the same.
BOOST_AUTO_TEST_CASE(forces_know_no_densities) {
  scene<2> scene(tank("high_x = 1.0 high_y = 0.75 delta = 0.0", "jitter = 0.3 "));
  auto& f = *scene.f;
  auto& s = scene.particles();
  disturb(scene);
  refresh(f);
  const auto sums = [&] {
    sum_over_neighbours(f, f.world.w.fluid());
    std::vector<double> all(f.force[0].begin(), f.force[0].begin() + static_cast<std::ptrdiff_t>(s.fluid));
    for (std::size_t i = 0; i < s.fluid; ++i) all.push_back(f.density_rate[i] / s.rho[i]);
    return all;
  };
  const auto water = sums();
  for (std::size_t i = 0; i < s.total(); ++i) s.rho[i] *= 1.0 + 0.9 * noise(static_cast<std::int64_t>(i), 11);
  const auto mixture = sums();
  for (std::size_t k = 0; k < water.size(); ++k)
    BOOST_TEST(std::abs(mixture[k] - water[k]) <= 1e-12 * std::abs(water[k]));
}
