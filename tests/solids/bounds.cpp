// How far bodies reach, bodies across periodic sides, and what bodies weigh.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <numbers>
#include <solids/motion.hpp>

#include "scene.hpp"

using namespace tetsuame;
using namespace tetsuame::solids;
namespace tt = boost::test_tools;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr auto unite = operation::unite, subtract = operation::subtract, intersect = operation::intersect;

template <int D>
void expect_bounds(const body<D>& of, const point<D>& low, const point<D>& high) {
  const auto b = bounds_of(of);
  for (std::size_t a = 0; a < D; ++a) {
    BOOST_TEST_CONTEXT(of.name() << " along " << a) {
      const auto same = [](double x, double y) { return x == y || std::abs(x - y) < 1e-9; };
      BOOST_TEST(same(b.low[a], low[a]), b.low[a] << " for " << low[a]);
      BOOST_TEST(same(b.high[a], high[a]), b.high[a] << " for " << high[a]);
    }
  }
}

}  // namespace

BOOST_AUTO_TEST_CASE(bounds_of_shapes) {
  const double r = std::numbers::sqrt2 / 2.0;
  expect_bounds<2>(of_one<2>("box", box<2>({{1.0, 1.0}}), {{3.0, 2.0}}, {0.0, 0.0, 45.0}), {{3.0 - r, 2.0 - r}},
                   {{3.0 + r, 2.0 + r}});
  expect_bounds<2>(of_one<2>("cone", cone<2>(0.5, 2.0), {{3.0, 2.0}}), {{2.5, 2.0}}, {{3.5, 4.0}});
  expect_bounds<2>(of_one<2>("bowl", bowl<2>(0.5, 0.1), {{3.0, 2.0}}), {{2.4, 1.4}}, {{3.6, 2.0}});
  expect_bounds<2>(of_one<2>("floor", plane<2>(), {{3.0, 2.0}}), {{-infinity, -infinity}}, {{infinity, 2.0}});
  expect_bounds<2>(of_one<2>("slope", plane<2>(), {{3.0, 2.0}}, {0.0, 0.0, 10.0}), {{-infinity, -infinity}},
                   {{infinity, infinity}});
  expect_bounds<2>(of_one<2>("tank", box<2>({{1.0, 1.0}}), {{3.0, 2.0}}, {}, true), {{-infinity, -infinity}},
                   {{infinity, infinity}});
  expect_bounds<3>(of_one<3>("ball", sphere<3>(0.3), {{1e3, 2.0, -1.0}}), {{1e3 - 0.3, 1.7, -1.3}},
                   {{1e3 + 0.3, 2.3, -0.7}});
  expect_bounds<3>(of_one<3>("pillar", cylinder<3>(0.3, 5.0), {{1.0, 2.0, 3.0}}), {{0.7, 1.7, 0.5}}, {{1.3, 2.3, 5.5}});
  expect_bounds<3>(of_one<3>("log", cylinder<3>(0.3, 5.0), {{1.0, 2.0, 3.0}}, {90.0, 0.0, 0.0}), {{0.7, -0.5, 2.7}},
                   {{1.3, 4.5, 3.3}});
  expect_bounds<3>(of_one<3>("cone", cone<3>(0.5, 2.0), {{1.0, 2.0, 3.0}}), {{0.5, 1.5, 3.0}}, {{1.5, 2.5, 5.0}});
  expect_bounds<3>(
      {"mixed",
       {made<3>(unite, box<3>({{1.0, 2.0, 3.0}}), {{0.0, 0.0, 0.0}}), made<3>(unite, sphere<3>(0.5), {{2.0, 0.0, 0.0}}),
        made<3>(subtract, sphere<3>(0.2), {{0.0, 0.0, 0.0}}),
        made<3>(intersect, box<3>({{9.0, 1.0, 9.0}}), {{0.0, 0.0, 0.0}})}},
      {{-0.5, -0.5, -1.5}}, {{2.5, 0.5, 1.5}});
}

BOOST_AUTO_TEST_CASE(images_across_periodic_sides) {
  const period<2> box2{{{1.0, 1.0}}, {true, false}, 0.1, 1e-5};
  // The surface is that of an endless row, wherever one of the bodies is given.
  for (const double x : {0.0, 0.95, 1.0, -3.0, 7.9}) {
    const auto one = of_one<2>("ball", sphere<2>(0.2), {{x, 0.5}});
    BOOST_TEST(fault_across<2>(one, box2, 1.0) == "");
    const auto row = repeated<2>(one, box2);
    for (const double at : {0.01, 0.3, 0.55, 0.99}) {
      const double away = std::abs(at - x - std::round(at - x));
      BOOST_TEST(row.level({{at, 0.6}}) == std::hypot(away, 0.1) - 0.2, tt::tolerance(1e-9));
    }
  }
  // What stays away from the sides, and what runs through them, has none.
  const auto within = of_one<2>("ball", sphere<2>(0.2), {{0.5, 0.5}});
  const auto floor = of_one<2>("floor", plane<2>(), {{0.3, 0.2}});
  const auto channel = of_one<2>("channel", box<2>({{5.0, 0.6}}), {{0.5, 0.5}}, {}, true);
  for (const auto& b : {within, floor, channel}) {
    BOOST_TEST(goes_on<2>(b, box2, 0));
    BOOST_TEST(repeated<2>(b, box2).pieces().size() == 1U);
    BOOST_TEST(runs_through<2>(b, box2, 0) == (b.name() != "ball"));
  }
  // A bar that is longer than the box runs through wherever its ends are.
  for (const double x : {0.5, 1.3}) {
    const auto bar = of_one<2>("bar", box<2>({{1.2, 0.3}}), {{x, 0.5}});
    BOOST_TEST(runs_through<2>(bar, box2, 0));
    BOOST_TEST(fault_across<2>(bar, box2, 1.0) == "");
    auto where = bounds_of(bar);
    keep_one_period<2>(where, bar, box2, 0);
    BOOST_TEST(where.low[0] == x - 0.6, tt::tolerance(1e-12));
    BOOST_TEST(where.high[0] == x + 0.4, tt::tolerance(1e-12));
    for (const double at : {0.0, 0.3, 0.7, 0.95})
      BOOST_TEST(repeated<2>(bar, box2).at({{at, 0.4}}).distance == -0.05, tt::tolerance(1e-9));
  }
  BOOST_TEST(!runs_through<2>(of_one<2>("short", box<2>({{0.9, 0.3}}), {{0.5, 0.5}}), box2, 0));
  // Boxes as long as the period make one wall without seams.
  const auto wall = repeated<2>(of_one<2>("wall", box<2>({{1.0, 0.4}}), {{0.3, 0.2}}), box2);
  for (const double x : {0.0, 0.2, 0.8, 0.999}) {
    const auto foot = wall.at({{x, 0.35}});
    BOOST_TEST(foot.distance == -0.05, tt::tolerance(1e-12));
    BOOST_TEST(foot.normal[1] == 1.0, tt::tolerance(1e-12));
  }
  // Neither of these can be repeated.
  const auto says = [&](const body<2>& b, double most, const std::string& part) {
    BOOST_TEST(fault_across<2>(b, box2, most).find(part) != std::string::npos, fault_across<2>(b, box2, most));
  };
  says(of_one<2>("slope", plane<2>(), {{0.5, 0.3}}, {0.0, 0.0, 5.0}), 4.0, "'slope' has no end along x");
  says(of_one<2>("side", plane<2>(), {{0.5, 0.3}}, {0.0, 0.0, -90.0}), 4.0, "'side' has no end along x");
  says(of_one<2>("log", box<2>({{1.5, 0.2}}), {{0.5, 0.3}}, {0.0, 0.0, 5.0}), 1.0, "'log' is 1.512 m long along x");
  BOOST_TEST(fault_across<2>(of_one<2>("log", box<2>({{1.5, 0.2}}), {{0.5, 0.3}}, {0.0, 0.0, 5.0}), box2, 4.0) == "");

  // In a corner of two periodic directions there are three more.
  const period<3> box3{{{1.0, 1.0, 0.5}}, {true, false, true}, 0.1, 1e-5};
  const auto four = repeated<3>(of_one<3>("ball", sphere<3>(0.2), {{0.02, 0.5, 0.49}}), box3);
  for (const double x : {0.02, 1.02})
    for (const double z : {0.49, -0.01}) BOOST_TEST(four.level({{x, 0.5, z}}) == -0.2, tt::tolerance(1e-9));
}

BOOST_AUTO_TEST_CASE(weights) {
  const double pi = std::numbers::pi;
  const auto of_all = [](const auto& b, double spacing) { return filled(b, 2.0, bounds_of(b), spacing); };
  // Boxes to rounding, wherever they stand and however coarse the cells.
  const auto brick = of_all(of_one<3>("brick", box<3>({{0.4, 0.23, 0.12}}), {{-7.13, 0.517, 3.1}}), 0.1);
  BOOST_TEST(brick.mass == 2.0 * 0.4 * 0.23 * 0.12, tt::tolerance(1e-9));
  BOOST_TEST(norm<3>(brick.now.pivot - point<3>{{-7.13, 0.517, 3.1}}) < 1e-9);
  BOOST_TEST(brick.inertia[0][0] == brick.mass / 12.0 * (0.23 * 0.23 + 0.12 * 0.12), tt::tolerance(1e-8));
  BOOST_TEST(std::abs(brick.inertia[0][1]) < 1e-9 * brick.mass);
  const auto turned = of_all(of_one<2>("box", box<2>({{0.4, 0.1}}), {{0.5, 0.5}}, {0.0, 0.0, 31.0}), 0.1);
  BOOST_TEST(turned.mass == 2.0 * 0.04, tt::tolerance(1e-4));
  BOOST_TEST(turned.inertia[0][0] == turned.mass / 12.0 * 0.17, tt::tolerance(1e-4));
  // Round ones by small cells that the surface cuts.
  const auto disc = of_all(of_one<2>("disc", sphere<2>(0.1), {{0.5, 9.5}}), 0.1);
  BOOST_TEST(disc.mass == 2.0 * pi * 0.01, tt::tolerance(1e-5));
  BOOST_TEST(disc.inertia[0][0] == 0.5 * disc.mass * 0.01, tt::tolerance(3e-5));
  const auto ball = of_all(of_one<3>("ball", sphere<3>(0.1), {{0.5, 0.5, 0.5}}), 0.1);
  BOOST_TEST(ball.mass == 2.0 * 4.0 / 3.0 * pi * 1e-3, tt::tolerance(1e-3));
  BOOST_TEST(ball.inertia[2][2] == 0.4 * ball.mass * 0.01, tt::tolerance(3e-3));
  const auto cup = of_all(of_one<3>("bowl", bowl<3>(0.3, 0.1), {{0.0, 0.0, 0.0}}), 0.1);
  BOOST_TEST(cup.mass == 2.0 * 2.0 / 3.0 * pi * (0.064 - 0.027), tt::tolerance(1e-3));
  const auto top = of_all(of_one<3>("cone", cone<3>(0.3, 0.4), {{0.0, 0.0, 0.0}}), 0.1);
  BOOST_TEST(top.mass == 2.0 / 3.0 * pi * 0.09 * 0.4, tt::tolerance(1e-3));
  BOOST_TEST(top.now.pivot[2] == 0.1, tt::tolerance(1e-3));
  // Pieces that touch, and that overlap.
  const body<2> two{
      "two",
      {made<2>(unite, box<2>({{0.3, 0.2}}), {{0.15, 0.1}}), made<2>(unite, box<2>({{0.6, 0.2}}), {{0.6, 0.1}}),
       made<2>(unite, box<2>({{0.5, 0.1}}), {{0.3, 0.15}})}};
  BOOST_TEST(of_all(two, 0.1).mass == 2.0 * 0.18, tt::tolerance(1e-6));
  BOOST_TEST(of_all(two, 0.1).now.pivot[0] == 0.45, tt::tolerance(1e-6));
  // Of a body without an end, what lies within bounds.
  const auto floor = of_one<2>("floor", plane<2>(), {{0.0, 0.25}});
  BOOST_TEST(filled<2>(floor, 2.0, {{{0.0, 0.0}}, {{1.0, 0.7}}}, 0.1).mass == 0.5, tt::tolerance(1e-9));
}

BOOST_AUTO_TEST_CASE(poses_of_a_motion) {
  const prescribed<2> swing({{0.5, 0.0}}, {{1.0}}, {3.0, 0.7, {{0.2, -0.1}}, 0.4});
  double least = 0.0, most = 0.0, widest = 0.0, last = -0.4;
  for (const auto& p : swing.poses()) {
    const double angle = rotation_vector<2>(p.turned)[0];
    least = std::min(least, p.shift[0]);
    most = std::max(most, p.shift[0]);
    widest = std::max(widest, angle - last);
    last = angle;
  }
  BOOST_TEST(least == -0.2, tt::tolerance(1e-12));
  BOOST_TEST(most == 0.2, tt::tolerance(1e-12));
  BOOST_TEST(widest < 0.06);
  const prescribed<2> lift({{0.0, 0.0}}, {{1.0}},
                           read_motion({"0,0,0,0,0\n1,0,0.1,0,90\n2,0,0.7,0,0\n3,0,0.2,0,0\n", "lift.csv"}, 2));
  most = 0.0;
  for (const auto& p : lift.poses()) most = std::max(most, p.shift[1]);
  BOOST_TEST(most == 0.7, tt::tolerance(1e-12));
}
