// Wall particles inside of bodies, their markers, and bodies that are refused.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <foundation/error.hpp>
#include <solids/wall_particles.hpp>

#include "scene.hpp"

using namespace tetsuame;
using namespace tetsuame::solids;
namespace tt = boost::test_tools;

namespace {

constexpr auto unite = operation::unite, subtract = operation::subtract;

bool says(const foundation::error& e, const std::string& part) {
  const bool right =
      e.status() == foundation::exit_status::bad_input && std::string(e.what()).find(part) != std::string::npos;
  if (!right) BOOST_TEST_MESSAGE("message: " << e.what());
  return right;
}

template <class Work>
void expect_message(Work&& work, const std::string& part) {
  BOOST_CHECK_EXCEPTION(work(), foundation::error, [&](const auto& e) { return says(e, part); });
}

template <int D>
void check_markers(const std::vector<body<D>>& bodies, const wall_particles<D>& w, double depth) {
  double difference = 0.0, aside = 0.0, deepest = 0.0;
  std::size_t dry = 0, wet = 0, twice = 0, shorter = 0;
  const auto b = joined(bodies);
  for (std::size_t r = 0; r < w.x.size(); ++r) {
    dry += b.solid(w.x[r]);
    wet += !b.solid(w.marker[r]);
    const auto f = b.at(w.x[r]);
    deepest = std::max(deepest, w.depth[r]);
    difference =
        std::max({difference, std::abs(f.distance + w.depth[r]),
                  std::abs(norm<D>(w.marker[r] - f.nearest) - w.height[r]), b.at(w.marker[r]).distance - w.height[r]});
    shorter += w.height[r] < w.depth[r];
    // Through the nearest point of the surface to the other side.
    if (w.height[r] == w.depth[r]) aside = std::max(aside, norm<D>(w.marker[r] + w.x[r] - 2.0 * f.nearest));
    twice += r > 0 && w.place[r] <= w.place[r - 1];
  }
  BOOST_TEST(dry == w.x.size());
  BOOST_TEST(wet == w.x.size());
  BOOST_TEST(twice == 0U);
  BOOST_TEST(shorter == w.shortened);
  BOOST_TEST(deepest <= depth);
  BOOST_TEST(difference < 1e-9);
  BOOST_TEST(aside < 1e-9);
}

}  // namespace

BOOST_AUTO_TEST_CASE(a_sphere_in_water) {
  const std::vector<body<3>> bodies{of_one<3>("ball", sphere<3>(0.3), {{0.5, 0.5, 0.5}})};
  const double dx = 0.05, depth = 0.15;
  const auto w = fill_with_wall_particles<3>(bodies, {{{1.0, 1.0, 1.0}}, dx}, depth);
  check_markers(bodies, w, depth);
  BOOST_TEST(w.shortened == 0U);
  // As many as the shell has volume, within a layer's rounding.
  const double volume = 4.0 / 3.0 * 3.14159265 * (0.027 - 0.003375);
  BOOST_TEST(static_cast<double>(w.x.size()) * dx * dx * dx == volume, tt::tolerance(0.05));
  for (std::size_t r = 0; r < w.x.size(); ++r) BOOST_TEST_REQUIRE(w.height[r] == w.depth[r]);
}

BOOST_AUTO_TEST_CASE(a_bowl) {
  const std::vector<body<3>> bodies{{"bowl",
                                     {made<3>(unite, box<3>({{1.0, 1.0, 0.6}}), {{0.5, 0.5, 0.3}}),
                                      made<3>(subtract, sphere<3>(0.4), {{0.5, 0.5, 0.6}})}}};
  const lattice<3> box{{{1.0, 1.0, 1.0}}, 0.05};
  const auto w = fill_with_wall_particles<3>(bodies, box, 0.1);
  BOOST_TEST(w.x.size() > 500U);
  check_markers(bodies, w, 0.1);
  expect_thick<3>(bodies, box, 0.1);
  expect_in_box<3>(bodies, box);
}

// A tank with right angles: markers as the plane sides of a box have them, in the corner the image in both.
BOOST_AUTO_TEST_CASE(markers_of_a_rectangular_tank) {
  const double dx = 0.1;
  const std::vector<body<2>> tank{of_one<2>("tank", box<2>({{1.0, 1.0}}), {{1.0, 1.0}}, {}, true)};
  const auto w = fill_with_wall_particles<2>(tank, {{{2.0, 2.0}}, dx}, 0.44);
  check_markers(tank, w, 0.44);
  std::size_t corners = 0;
  for (std::size_t r = 0; r < w.x.size(); ++r) {
    point<2> image = w.x[r];
    int mirrors = 0;
    for (std::size_t a = 0; a < 2; ++a) {
      if (image[a] < 0.5) image[a] = 1.0 - image[a];
      if (image[a] > 1.5) image[a] = 3.0 - image[a];
      mirrors += image[a] != w.x[r][a];
    }
    BOOST_TEST(norm<2>(image - w.marker[r]) < 1e-9);
    corners += mirrors == 2;
  }
  // Along a side 10 times 4 layers (0.05, 0.15, 0.25, 0.35), and in a corner those of 16 within 0.44: 15.
  BOOST_TEST(corners == 4U * 15U);
  BOOST_TEST(w.x.size() == 4U * 40U + corners);
}

BOOST_AUTO_TEST_CASE(acute_corner_of_the_fluid) {
  // Two walls that enclose 40°: markers of one fall into the other, and stay in the fluid all the same.
  const std::vector<body<2>> wedge{
      {"wedge",
       {made<2>(unite, plane<2>(), {{0.5, 0.5}}), made<2>(unite, plane<2>(), {{0.5, 0.5}}, {0.0, 0.0, 140.0})}}};
  const auto w = fill_with_wall_particles<2>(wedge, {{{2.0, 2.0}}, 0.02}, 0.1);
  BOOST_TEST(w.shortened > 0U);
  check_markers(wedge, w, 0.1);
}

BOOST_AUTO_TEST_CASE(bodies_that_touch) {
  // A box on the floor: what stands below it has no fluid before it.
  const std::vector<body<2>> bodies{of_one<2>("floor", plane<2>(), {{0.0, 0.3}}),
                                    of_one<2>("box", box<2>({{0.5, 0.5}}), {{1.0, 0.55}})};
  const lattice<2> box{{{2.0, 1.5}}, 0.05};
  const auto w = fill_with_wall_particles<2>(bodies, box, 0.15);
  check_markers(bodies, w, 0.15);
  expect_thick<2>(bodies, box, 0.15);
  // The floor below the box has particles as far as its edges are near, by the point of the edge, and no others.
  const auto all = joined(bodies);
  std::size_t below = 0;
  for (std::size_t r = 0; r < w.x.size(); ++r)
    if (w.x[r][1] < 0.3 && std::abs(w.x[r][0] - 1.0) < 0.25) {
      ++below;
      const auto foot = all.at(w.x[r]).nearest;
      BOOST_TEST(std::abs(foot[1] - 0.3) < 1e-9);
      BOOST_TEST(std::abs(std::abs(foot[0] - 1.0) - 0.25) < 1e-9);
    }
  BOOST_TEST(below == 2U * 8U);
  BOOST_TEST(all.at({{1.0, 0.29}}).distance == -std::hypot(0.25, 0.01), tt::tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(too_thin) {
  const lattice<2> box{{{2.0, 2.0}}, 0.05};
  const double reach = 0.15;
  const std::vector<body<2>> plate{of_one<2>("plate", solids::box<2>({{0.1, 1.0}}), {{1.0, 1.0}})};
  expect_message([&] { expect_thick<2>(plate, box, reach); }, "body 'plate' is 0.1 m thick at (");
  const std::vector<body<2>> two{of_one<2>("a", solids::box<2>({{0.4, 1.0}}), {{0.7, 1.0}}),
                                 of_one<2>("b", solids::box<2>({{0.4, 1.0}}), {{1.2, 1.0}})};
  expect_message([&] { expect_thick<2>(two, box, reach); }, "gap between body 'a' and body 'b' at (");
  const std::vector<body<2>> thick{of_one<2>("a", solids::box<2>({{0.4, 1.0}}), {{0.7, 1.0}}),
                                   of_one<2>("b", solids::box<2>({{0.4, 1.0}}), {{1.3, 1.0}})};
  expect_thick<2>(thick, box, reach);
  // Corners, and the tip of a cone, are neither gaps nor thin.
  const std::vector<body<2>> pointed{
      of_one<2>("cone", cone<2>(0.5, 0.5), {{1.0, 0.5}}),
      of_one<2>("tank", solids::box<2>({{1.7, 1.7}}), {{1.0, 1.0}}, {0.0, 0.0, 10.0}, true)};
  expect_thick<2>(pointed, box, reach);
}

BOOST_AUTO_TEST_CASE(outside_of_the_box_and_in_the_water) {
  const lattice<2> box{{{1.0, 1.0}}, 0.05};
  const std::vector<body<2>> away{of_one<2>("ball", sphere<2>(0.2), {{0.5, 0.5}}),
                                  of_one<2>("far", sphere<2>(0.2), {{2.5, 0.5}})};
  expect_message([&] { expect_in_box<2>(away, box); }, "piece 1 of body 'far' lies outside the box");
  const std::vector<body<2>> full{of_one<2>("floor", plane<2>(), {{0.0, 3.0}})};
  expect_message([&] { expect_in_box<2>(full, box); }, "fill the whole box");
  const std::vector<body<2>> gone{
      {"gone", {made<2>(unite, sphere<2>(0.2), {{0.5, 0.5}}), made<2>(subtract, sphere<2>(0.3), {{0.5, 0.5}})}}};
  expect_message([&] { expect_in_box<2>(gone, box); }, "'gone' has no solid");
  const std::vector<body<2>> ball{away.front()};
  expect_in_box<2>(ball, box);
  expect_dry<2>(ball, {{{0.1, 0.1}}, {{0.5, 0.75}}});
  expect_message(
      [&] {
        expect_dry<2>(ball, {{{0.1, 0.1}}, {{0.5, 0.6}}, {{0.5, 0.5}}});
      },
      "2 particles of the fluid start inside a wall, the first at (0.5, 0.6), 0.1 m deep in body 'ball'");
}

// Rows along the faces of a box begin half a spacing below them, wherever these lie on the lattice, and none is lost;
// in the box's corners too, where two displacements meet.
BOOST_AUTO_TEST_CASE(rows_that_fit_faces) {
  const double dx = 0.05, depth = 0.15;
  for (const double up : {0.0, 0.001, 0.013, 0.025, 0.031, 0.049}) {
    const std::vector<body<2>> bodies{of_one<2>("box", box<2>({{0.8, 0.8}}), {{1.0 + up, 1.0 + up}})};
    const lattice<2> box{{{2.0, 2.0}}, dx};
    const auto w = fill_with_wall_particles<2>(bodies, box, depth, {}, true);
    check_markers(bodies, w, depth);
    std::size_t first = 0;
    double off = 0.0;
    for (std::size_t r = 0; r < w.x.size(); ++r) {
      const bool corner = std::abs(w.x[r][0] - 1.0 - up) > 0.2 && std::abs(w.x[r][1] - 1.0 - up) > 0.2;
      if (corner) continue;
      const double rows = w.depth[r] / dx - 0.5;
      off = std::max(off, std::abs(rows - std::round(rows)));
      first += std::round(rows) == 0.0;
    }
    BOOST_TEST(off < 1e-9);
    BOOST_TEST(first == 4U * 8U);
    // Corners have no weight in a face's rows; their own are where both faces have theirs, but for what λ takes of
    // the one that is not their own (fit.hpp).
    double outermost = 1.0;
    for (std::size_t r = 0; r < w.x.size(); ++r)
      outermost = std::min(outermost, std::hypot(w.x[r][0] - (1.4 + up - 0.5 * dx), w.x[r][1] - (1.4 + up - 0.5 * dx)));
    BOOST_TEST(outermost < 0.1335 * dx);
  }
}

// What is inclined to the lattice has places too many here and too few there: they stay where they are. On a ball those
// below its flat parts move, by half a spacing at most, and the density of wall particles stays what it is.
BOOST_AUTO_TEST_CASE(places_that_fit_on_average) {
  const double dx = 0.05, depth = 0.15;
  const lattice<3> box{{{2.0, 2.0, 2.0}}, dx};
  const auto farthest = [&](const std::vector<body<3>>& bodies) {
    const auto fitted = fill_with_wall_particles<3>(bodies, box, depth, {}, true);
    check_markers(bodies, fitted, depth);
    const auto plain = fill_with_wall_particles<3>(bodies, box, depth);
    double most = 0.0;
    std::size_t both = 0;
    for (std::size_t r = 0, n = 0; r < fitted.x.size(); ++r) {
      while (n < plain.x.size() && plain.place[n] < fitted.place[r]) ++n;
      if (n == plain.x.size() || plain.place[n] != fitted.place[r]) continue;
      ++both;
      most = std::max(most, norm<3>(fitted.x[r] - plain.x[n]));
    }
    BOOST_TEST(static_cast<double>(both) > 0.95 * static_cast<double>(plain.x.size()));
    return most / dx;
  };
  BOOST_TEST(farthest({of_one<3>("ball", sphere<3>(0.6), {{1.01, 1.02, 1.03}})}) < 0.4);  // on its axes it is flat
  BOOST_TEST(farthest({of_one<3>("floor", plane<3>(), {{1.0, 1.0, 1.0}}, {20.0, 30.0, 0.0})}) == 0.0);
}
