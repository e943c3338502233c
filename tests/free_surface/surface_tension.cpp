// Surface tension of water: how much surface there is, curvatures, forces that balance a uniform pressure, periods.
#include <boost/test/unit_test.hpp>
#include <free_surface/measures.hpp>
#include <free_surface/tension.hpp>
#include <numbers>
#include <run/passes.hpp>

#include "scene.hpp"

using namespace tetsuame;
using namespace tetsuame::free_surface;
namespace tt = boost::test_tools;

namespace {

constexpr double sigma = 0.5;  // N/m

// Twenty by twenty spacings of 0.05 m in the middle of the tank.
std::string square(const std::string& more) {
  return tank("low_x = 0.5 high_x = 1.5 low_y = 0.5 high_y = 1.5 gravity = 0.0 sound_speed = 20.0 " + more);
}

// The square's particles as a round drop of the same area: evenly on a spiral by the golden angle.
void make_round(scene<2>& scene) {
  auto& s = scene.particles();
  constexpr double all = 400.0;
  const double radius = std::sqrt(1.0 / std::numbers::pi), angle = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const double n = static_cast<double>(s.id[i]) + 0.5, r = radius * std::sqrt(n / all);
    s.x[0][i] = 1.0 + r * std::cos(angle * n);
    s.x[1][i] = 1.0 + r * std::sin(angle * n);
  }
  scene.rebuild();
}

const std::string narrow = " &kernel name = 'wendland_c2' h_over_dx = 1.5 /";

}  // namespace

// Σ 2 |G| V is the length of a level surface to 0.3 %, where walls mirror it too.
BOOST_AUTO_TEST_CASE(length_of_a_level_surface) {
  scene<2> scene(tank("high_y = 1.0 gravity = 0.0 sound_speed = 20.0 surface_tension = 0.5") + narrow);
  BOOST_TEST(surface_energy(*scene.f) == sigma * 2.0, tt::tolerance(0.003));
  scene.rates();
  // It is level: nothing pulls. G is 0.4/Δx at the surface, and curvatures are of its rounding.
  const auto& s = scene.particles();
  for (std::size_t i = 0; i < s.fluid; ++i) {
    BOOST_TEST(std::abs(scene.f->tension[0][i]) < 1e-12);
    BOOST_TEST(std::abs(scene.f->tension[1][i]) < 1e-12);
  }
}

// A uniform pressure pushes by -2 p V G, whatever the arrangement: what surface tension of the same curvature
// everywhere takes.
BOOST_AUTO_TEST_CASE(uniform_pressure_is_balanced) {
  scene<2> scene(square("surface_tension = 0.5"));
  make_round(scene);
  scene.rates();
  auto& s = scene.particles();
  auto& w = scene.f->world.w;
  std::fill(s.p.begin(), s.p.end(), 3.0);
  std::ranges::fill(s.v[0], 0.0);
  std::ranges::fill(s.v[1], 0.0);
  std::array<particles::array, 2> G{particles::array(s.total() + 1), particles::array(s.total() + 1)};
  sum_over_neighbours(*scene.f, w.fluid());
  w.sum(w.fluid(), inward<2>{s.dV.data(), {G[0].data(), G[1].data()}});
  for (std::size_t i = 0; i < s.fluid; ++i)
    for (const std::size_t a : {0, 1})
      BOOST_TEST(std::abs(scene.f->force[a][i] + 2.0 * 3.0 * s.dV[i] * G[a][i]) < 1e-12);
}

// Eleven spacings a radius: the pressure that the forces of a round drop hold, ½ Σ f·x over the area, is σ/R but for
// what the curvature is stronger 0.8 spacings within, 7 per cent; and all forces together are none.
BOOST_AUTO_TEST_CASE(laplace_pressure_of_a_round_drop) {
  scene<2> scene(square("surface_tension = 0.5") + narrow);
  make_round(scene);
  scene.rates();
  const auto& s = scene.particles();
  const auto& force = scene.f->tension;
  const double radius = std::sqrt(1.0 / std::numbers::pi);
  const auto inwards =
      scene.sum([&](std::size_t i) { return force[0][i] * (1.0 - s.x[0][i]) + force[1][i] * (1.0 - s.x[1][i]); });
  const auto size = scene.sum([&](std::size_t i) { return std::hypot(force[0][i], force[1][i]); });
  BOOST_TEST(0.5 * inwards == sigma / radius, tt::tolerance(0.08));
  for (const std::size_t a : {0, 1})
    BOOST_TEST(std::abs(scene.sum([&](std::size_t i) { return force[a][i]; })) < 0.01 * size);
  BOOST_TEST(surface_energy(*scene.f) == sigma * 2.0 * std::numbers::pi * radius, tt::tolerance(0.05));
}

// Ten spacings a radius, as the lattice makes it: within its steps the same.
BOOST_AUTO_TEST_CASE(laplace_pressure_of_a_ball) {
  scene<3> scene(
      "&domain dimension = 3 length_x = 2.0 length_y = 2.0 length_z = 2.0 particles_x = 26 particles_y = 26 "
      "particles_z = 26 / &flow start = 'drop' low_x = 0.230769230769230769 high_x = 1.769230769230769231 "
      "low_y = 0.230769230769230769 high_y = 1.769230769230769231 low_z = 0.230769230769230769 "
      "high_z = 1.769230769230769231 gravity = 0.0 sound_speed = 20.0 surface_tension = 0.5 / &kernel name = "
      "'wendland_c2' h_over_dx = 1.5 "
      "/ "
      "&time t_end = 1.0 /");
  scene.rates();
  const auto& s = scene.particles();
  const auto& force = scene.f->tension;
  const double inwards = scene.sum([&](std::size_t i) {
    double sum = 0.0;
    for (std::size_t a = 0; a < 3; ++a) sum += force[a][i] * (1.0 - s.x[a][i]);
    return sum;
  });
  const auto drop = round_drop_of(*scene.f);
  const double volume = 4.0 / 3.0 * std::numbers::pi * std::pow(drop.radius, 3);
  BOOST_TEST(drop.radius == 0.7692, tt::tolerance(0.02));
  BOOST_TEST(inwards / (3.0 * volume) == 2.0 * sigma / drop.radius, tt::tolerance(0.15));
  BOOST_TEST(surface_energy(*scene.f) == sigma * 4.0 * std::numbers::pi * std::pow(drop.radius, 2), tt::tolerance(0.1));
}

// Places off by 0.1 Δx at most make normals of some hundredths of 1/h deep in the water, which are no surface: there is
// no force, by which the pressure would not even them out. Six rows within, beside the largest force on the surface.
BOOST_AUTO_TEST_CASE(disorder_within_is_no_surface) {
  scene<2> scene("&domain length_x = 2.0 length_y = 2.0 particles_x = 40 particles_y = 40 jitter = 0.1 / "
                 "&flow low_x = 0.5 high_x = 1.5 low_y = 0.5 high_y = 1.5 gravity = 0.0 sound_speed = 20.0 "
                 "surface_tension = 0.5 / &time t_end = 1.0 /" +
                 narrow);
  scene.rates();
  const auto& s = scene.particles();
  const auto& force = scene.f->tension;
  double deep = 0.0, most = 0.0, normal = 0.0;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const double size = std::hypot(force[0][i], force[1][i]);
    const bool within = std::max(std::abs(s.x[0][i] - 1.0), std::abs(s.x[1][i] - 1.0)) < 0.2;
    (within ? deep : most) = std::max(within ? deep : most, size);
    if (within) normal = std::max(normal, length_of<2>(scene.f->normal_within, i) * scene.f->p.smoothing_length);
  }
  const auto& ranks = scene.f->ranks();
  BOOST_TEST(ranks.maximum(normal) > 0.01);
  BOOST_TEST(ranks.maximum(deep) < 0.02 * ranks.maximum(most));
}

// Numbers by hand.
BOOST_AUTO_TEST_CASE(periods) {
  // Without viscosity; with hardly any, where the part of the layer under the surface is 0.6 per cent at z = 270.
  for (const auto& [dimension, period, decay] : {std::tuple{2, 9.5597e-3, 4.0}, std::tuple{3, 8.2790e-3, 5.0}}) {
    const round_drop drop{dimension, 1e-3, 7.2e-5};
    BOOST_TEST(*period_of(drop.rate(0.0)) == period, tt::tolerance(1e-4));
    BOOST_TEST(-drop.rate(1e-8).real() == 0.01 * decay, tt::tolerance(0.01));
    // Thick as honey it creeps back without a swing.
    BOOST_TEST(!period_of(drop.rate(1e-2)).has_value());
  }
  // 17 mm: both restore by as much, where the water is deep.
  const double k = std::sqrt(9.81 / 7.2e-5);
  BOOST_TEST((standing_wave{k, 1.0, 9.81, 1e-4, 7.2e-5}.frequency()) == std::sqrt(2.0 * 9.81 * k),
             tt::tolerance(1e-10));
}
