// Bodies and gauges at sides of the box: across periodic ones all is as it is in the middle; what stands or comes from
// beyond the others is whole.
#include <fmt/format.h>
#include <boost/test/unit_test.hpp>
#include <free_surface/loads.hpp>
#include <free_surface/measures.hpp>
#include <free_surface/traction.hpp>
#include <numbers>

#include "scene.hpp"

using namespace tetsuame;
using namespace tetsuame::free_surface;
namespace tt = boost::test_tools;

namespace {

// What a body and its surroundings feel, of water whose state is a function of the place beside the body.
template <int D>
struct felt {
  load<D> of_body;                    // moments about its centre
  double squares = 0.0, walls = 0.0;  // of the water's rates; number of wall particles
  std::vector<double> accelerations;  // of a free body, on rank 0
};

template <int D>
felt<D> felt_at(const std::string& input, const point& body) {
  scene<D> scene(input);
  auto& f = *scene.f;
  auto& s = scene.particles();
  if (!f.free.empty() && f.ranks().rank == 0) f.free.state[3 * D - 1 + (D == 2 ? 0 : 2)].back() = 0.7;
  set_bodies_at(f, 0.0);
  scene.rebuild();
  const auto wave = [&](std::size_t i, double phase) {
    double sum = phase;
    for (std::size_t a = 0; a < D; ++a)
      sum += std::cos(2.0 * std::numbers::pi * (s.x[a][i] - body[a]) / f.o.domain.length[a] +
                      phase * (1.0 + static_cast<double>(a)));
    return std::sin(sum);
  };
  for (std::size_t i = 0; i < s.fluid; ++i) {
    s.rho[i] = 1000.0 * (1.02 + 0.01 * wave(i, 0.3));
    s.m[i] = 1000.0 * std::pow(f.dx(), D);
    for (std::size_t a = 0; a < D; ++a) s.v[a][i] = 0.5 * wave(i, 1.0 + static_cast<double>(a));
  }
  scene.rebuild();
  const auto rate = scene.rates();
  felt<D> all;
  for (std::size_t a = 0; a < D; ++a)
    all.squares += scene.sum([&](std::size_t i) { return rate[D + a][i] * rate[D + a][i]; });
  all.walls = static_cast<double>(f.ranks().sum(static_cast<std::int64_t>(f.world.walls.bodies.places.size())));
  all.of_body = read_loads(f).front();
  if (!f.free.empty() && f.ranks().rank == 0)
    for (std::size_t k = 3 * D + 1; k < rate.size(); ++k) all.accelerations.push_back(rate[k][0]);
  return all;
}

template <int D>
void expect_same(const felt<D>& a, const felt<D>& b) {
  const double rounding = 1e-8;
  BOOST_TEST(a.walls == b.walls);
  BOOST_TEST(a.squares == b.squares, tt::tolerance(rounding));
  const double force = solids::norm<D>(b.of_body.force);
  BOOST_TEST(force > 1.0);
  BOOST_TEST(solids::norm<D>(a.of_body.force - b.of_body.force) < rounding * force);
  for (std::size_t k = 0; k < (D == 2 ? 1 : 3); ++k)
    BOOST_TEST(std::abs(a.of_body.moment[k] - b.of_body.moment[k]) < rounding * force);
  for (std::size_t k = 0; k < a.accelerations.size(); ++k)
    BOOST_TEST(std::abs(a.accelerations[k] - b.accelerations[k]) < 1e-7 * (1.0 + std::abs(b.accelerations[k])));
}

std::string row_of_boxes(double x, const std::string& motion) {
  return fmt::format(
      "&domain length_x = 1.5 length_y = 1.0 particles_x = 30 particles_y = 20 periodic_x = .true. /"
      "&flow high_y = 0.9 around_bodies = .true. sound_factor = 20.0 viscosity = 3.0 /"
      "&solids body = 'box', 'box' shape = 'box', 'sphere' centre_x = {}, {} centre_y = 0.5, 0.55 length_x(1) = 0.4"
      " length_y(1) = 0.3 angle_z(1) = 20 radius(2) = 0.2 /"
      "{} &gauges force = 'box' / &walls slip = 'no_slip' slip_top = 'free_surface' / &time t_end = 1.0 /",
      x, x + 0.1, motion);
}

std::string balls(double x, double z, const std::string& motion, const char* also) {
  return fmt::format(
      "&domain dimension = 3 length_x = 1.0 length_y = 1.0 length_z = 1.2 particles_x = 10 particles_y = 10 particles_z"
      " = 12 periodic_x = .true. periodic_z = {} / &kernel name = 'wendland_c2' h_over_dx = 1.2 skin = 0.3 /"
      "&flow high_y = 0.9 around_bodies = .true. sound_factor = 20.0 viscosity = 3.0 /"
      "&solids body = 'ball', 'ball' shape = 'box', 'sphere' centre_x = {}, {} centre_y = 0.5, 0.5 centre_z = {}, {}"
      " length_x(1) = 0.35 length_y(1) = 0.4 length_z(1) = 0.35 angle_x(1) = 15 angle_z(1) = 20 radius(2) = 0.22 /"
      "{} &gauges force = 'ball' / &walls slip = 'no_slip' slip_top = 'free_surface' / &time t_end = 1.0 /",
      also, x, x + 0.05, z, z - 0.05, motion);
}

constexpr const char* swings =
    "&motions body = '{}' kind = 'harmonic' period = 2.0 amplitude_y = 0.1 amplitude_angle = 15 pivot_x = {} pivot_y = "
    "0.7 /";

}  // namespace

// At rest, on a motion and free; the whole number of spacings keeps the lattice.
BOOST_AUTO_TEST_CASE(a_body_across_a_periodic_side) {
  for (const std::string motion : {"", "swing", "&motions body = 'box' kind = 'free' density = 700 /"}) {
    const auto at = [&](double x) {
      const auto how = motion == "swing" ? fmt::format(fmt::runtime(swings), "box", x - 0.2) : motion;
      return felt_at<2>(row_of_boxes(x, how), {x, 0.5, 0.0});
    };
    const auto middle = at(0.75);
    for (const double x : {0.0, 0.2, 1.3, 1.5, 4.5})
      BOOST_TEST_CONTEXT(motion << " at " << x) expect_same(at(x), middle);
  }
}

// On one pair of periodic sides, and in the corner of two.
BOOST_AUTO_TEST_CASE(a_body_across_periodic_sides_in_three_dimensions) {
  for (const std::string motion : {"", "&motions body = 'ball' kind = 'free' density = 700 /"}) {
    const auto at = [&](double x, double z, const char* also) {
      return felt_at<3>(balls(x, z, motion, also), {x, 0.5, z});
    };
    const auto middle = at(0.5, 0.6, ".true.");
    for (const auto& [x, z] : {std::pair{0.0, 0.6}, {0.5, 1.2}, {1.0, 0.0}, {0.1, 1.1}})
      BOOST_TEST_CONTEXT(motion << " at " << x << ", " << z) expect_same(at(x, z, ".true."), middle);
    BOOST_TEST_CONTEXT(motion << " beside walls") expect_same(at(1.0, 0.6, ".false."), at(0.5, 0.6, ".false."));
  }
}

BOOST_AUTO_TEST_CASE(gauges_at_periodic_sides) {
  scene<2> flat(
      "&domain length_x = 1.2 length_y = 1.0 particles_x = 24 particles_y = 20 periodic_x = .true. /"
      "&flow high_y = 0.7 sound_factor = 100.0 / &walls slip_top = 'free_surface' / &time t_end = 1.0 /");
  refresh(*flat.f);
  for (const double x : {0.0, 0.03, 1.15, 1.2}) {
    BOOST_TEST(depth_at(*flat.f, {x, 0.0, 0.0}) == 0.7, tt::tolerance(1e-12));
    for (const double y : {0.0, 0.3})
      BOOST_TEST(pressure_at(*flat.f, {x, y, 0.0}) == pressure_at(*flat.f, {0.6, y, 0.0}), tt::tolerance(1e-2));
  }
  scene<3> deep(
      "&domain dimension = 3 length_x = 0.4 length_y = 0.6 length_z = 0.5 particles_x = 8 particles_y = 12 "
      "particles_z = 10 periodic_x = .true. periodic_z = .true. / &flow high_y = 0.4 sound_factor = 100.0 /"
      "&time t_end = 1.0 /");
  refresh(*deep.f);
  for (const point place : {point{0.0, 0.0, 0.0}, point{0.4, 0.0, 0.25}, point{0.2, 0.0, 0.5}}) {
    BOOST_TEST(depth_at(*deep.f, place) == 0.4, tt::tolerance(1e-12));
    BOOST_TEST(pressure_at(*deep.f, place) == pressure_at(*deep.f, {0.2, 0.0, 0.25}), tt::tolerance(1e-2));
  }
}

// Above an open top there is no air: all of a body weighs.
BOOST_AUTO_TEST_CASE(weight_above_an_open_top) {
  for (const double above : {0.0, 0.1, 0.45}) {
    scene<2> scene(
        fmt::format("&domain length_x = 2.0 length_y = 1.0 particles_x = 40 particles_y = 20 /"
                    "&flow high_y = 0.6 around_bodies = .true. / &solids body = 'log' shape = 'sphere'"
                    " centre_x = 1.0 centre_y = {} radius = 0.4 / &motions body = 'log' kind = 'free' density ="
                    " 300 / &walls slip_top = 'free_surface' / &time t_end = 1.0 /",
                    0.6 + above));
    const auto& b = *scene.f->moving.front().free;
    BOOST_TEST(b.mass == 300.0 * std::numbers::pi * 0.16, tt::tolerance(1e-4));
    BOOST_TEST(b.now.pivot[1] == 0.6 + above, tt::tolerance(1e-6));
    BOOST_TEST(b.inertia[0][0] == 0.5 * b.mass * 0.16, tt::tolerance(1e-4));
  }
}

// A body that stands in the box now has the same wall particles wherever it stood at rest.
BOOST_AUTO_TEST_CASE(a_body_that_came_from_outside) {
  const auto scene_of = [](double rest_x, double rest_y) {
    return fmt::format(
        "&domain length_x = 1.5 length_y = 1.0 particles_x = 30 particles_y = 20 /"
        "&flow high_y = 0.6 around_bodies = .true. / &solids body = 'block' shape = 'box' centre_x = {}"
        " centre_y = {} length_x = 0.8 length_y = 0.5 / &motions body = 'block' kind = 'harmonic' period = "
        "1.0 phase = 90 amplitude_x = {} amplitude_y = {} / &gauges force = 'block' / &walls slip_top ="
        " 'free_surface' / &time t_end = 1.0 /",
        rest_x, rest_y, 0.1 - rest_x, 0.15 - rest_y);
  };
  std::int64_t inside = 0;
  for (const auto& [x, y] : {std::pair{0.1, 0.2}, {-0.9, 0.15}, {0.1, -0.85}, {-7.4, 9.15}}) {
    scene<2> scene(scene_of(x, y));
    auto& f = *scene.f;
    const auto walls = f.ranks().sum(static_cast<std::int64_t>(f.world.walls.bodies.places.size()));
    if (inside == 0) inside = walls;
    BOOST_TEST(walls == inside);
    BOOST_TEST(walls > 30);
  }
}
