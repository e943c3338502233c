// Signed distances of bodies: against known ones, and against a cloud of points of the surface.
#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "scene.hpp"

using namespace tetsuame;
using namespace tetsuame::solids;
namespace tt = boost::test_tools;

namespace {

template <int D>
point<D> random_point(std::mt19937_64& bits, double half) {
  std::uniform_real_distribution<double> along(-half, half);
  return point<D>::of([&](std::size_t) { return along(bits); });
}

// Points of the surface on random lines through a cube: where the level changes its sign, halved down.
template <int D>
std::vector<point<D>> cloud(const body<D>& b, double half, std::size_t lines) {
  std::mt19937_64 bits(7);
  std::vector<point<D>> all;
  constexpr int steps = 60;
  for (std::size_t n = 0; n < lines; ++n) {
    const auto from = random_point<D>(bits, half), to = random_point<D>(bits, half);
    const auto on_line = [&](double t) { return from + t * (to - from); };
    for (int k = 0; k < steps; ++k) {
      double low = static_cast<double>(k) / steps, high = static_cast<double>(k + 1) / steps;
      const bool begins = b.solid(on_line(low));
      if (b.solid(on_line(high)) == begins) continue;
      for (int half_way = 0; half_way < 45; ++half_way) {
        const double middle = 0.5 * (low + high);
        (b.solid(on_line(middle)) == begins ? low : high) = middle;
      }
      all.push_back(on_line(0.5 * (low + high)));
    }
  }
  return all;
}

template <int D>
double to_cloud(const std::vector<point<D>>& all, const point<D>& x) {
  double least = 1e300;
  for (const auto& p : all) least = std::min(least, foundation::dot(p - x, p - x));
  return std::sqrt(least);
}

// What every signed distance obeys. A point of the surface that is nearer than the distance would be a candidate that
// was missed; a nearest point away from the cloud would be none of the surface.
template <int D>
void check_distance(const body<D>& b, double half, std::size_t lines) {
  const auto surface = cloud(b, 1.3 * half, lines);
  BOOST_TEST_REQUIRE(surface.size() > lines / 4);
  std::mt19937_64 bits(11);
  auto last = random_point<D>(bits, half);
  double last_distance = b.at(last).distance, missed = 0.0, apart = 0.0, stretched = 0.0, slope = 0.0, length = 0.0;
  double bound = 0.0;
  int wrong_signs = 0, not_found = 0;
  for (int k = 0; k < 300; ++k) {
    const auto x = random_point<D>(bits, half);
    const auto f = b.at(x);
    not_found += !f.found;
    wrong_signs += (f.distance < 0.0) != b.solid(x);
    missed = std::max(missed, std::abs(f.distance) - to_cloud(surface, x));
    apart = std::max(apart, to_cloud(surface, f.nearest));
    bound = std::max(bound, std::abs(b.level(x)) - std::abs(f.distance));
    stretched = std::max(stretched, std::abs(f.distance - last_distance) - norm<D>(x - last));
    length = std::max(length, std::abs(norm<D>(f.normal) - 1.0));
    // Half the way towards the surface is half the distance, along the gradient.
    slope = std::max(slope, std::abs(b.at(x - (0.5 * f.distance) * f.normal).distance - 0.5 * f.distance));
    last = x;
    last_distance = f.distance;
  }
  BOOST_TEST(not_found == 0);
  BOOST_TEST(wrong_signs == 0);
  BOOST_TEST(missed < 1e-9);
  BOOST_TEST(bound < 1e-9);
  BOOST_TEST(stretched < 1e-9);
  BOOST_TEST(slope < 1e-8);
  BOOST_TEST(length < 1e-9);
  // The cloud's own density: in two dimensions a line of points, in three a sheet of them.
  BOOST_TEST(apart < (D == 2 ? 0.05 : 0.35) * half);
}

constexpr auto unite = operation::unite, subtract = operation::subtract, intersect = operation::intersect;

}  // namespace

BOOST_AUTO_TEST_CASE(known_distances) {
  const auto b = of_one<3>("box", box<3>({{2.0, 4.0, 6.0}}));
  BOOST_TEST(b.at({{4.0, 0.0, 0.0}}).distance == 3.0, tt::tolerance(1e-12));
  BOOST_TEST(b.at({{4.0, 6.0, 0.0}}).distance == 5.0, tt::tolerance(1e-12));
  BOOST_TEST(b.at({{3.0, 4.0, 4.0}}).distance == 3.0, tt::tolerance(1e-12));
  BOOST_TEST(b.at({{0.25, 0.0, 0.0}}).distance == -0.75, tt::tolerance(1e-12));
  const auto s = of_one<2>("disc", sphere<2>(1.5), {{1.0, 0.0}});
  BOOST_TEST(s.at({{4.0, 4.0}}).distance == 3.5, tt::tolerance(1e-12));
  const auto c = of_one<3>("cylinder", cylinder<3>(1.0, 2.0));
  BOOST_TEST(c.at({{4.0, 0.0, 5.0}}).distance == 5.0, tt::tolerance(1e-12));
  BOOST_TEST(c.at({{0.0, 0.0, 0.5}}).distance == -0.5, tt::tolerance(1e-12));
  const auto k = of_one<3>("cone", cone<3>(1.0, 1.0));
  BOOST_TEST(k.at({{0.0, 0.0, 3.0}}).distance == 2.0, tt::tolerance(1e-12));
  BOOST_TEST(k.at({{1.0, 0.0, 1.0}}).distance == std::sqrt(0.5), tt::tolerance(1e-12));
  BOOST_TEST(k.at({{4.0, 0.0, -4.0}}).distance == 5.0, tt::tolerance(1e-12));
  const auto bowl_of = of_one<3>("bowl", bowl<3>(1.0, 0.5));
  BOOST_TEST(bowl_of.at({{0.0, 0.0, -0.25}}).distance == 0.75, tt::tolerance(1e-12));
  BOOST_TEST(bowl_of.at({{0.0, 0.0, -1.2}}).distance == -0.2, tt::tolerance(1e-12));
  BOOST_TEST(bowl_of.at({{0.0, 0.0, 0.0}}).distance == 1.0, tt::tolerance(1e-12));
  // On the surface itself normals point into the fluid, of a hollow too.
  BOOST_TEST(norm<3>(bowl_of.at({{0.0, 0.0, -1.0}}).normal - unit<3>(2)) < 1e-9);
  BOOST_TEST(norm<3>(bowl_of.at({{0.0, 0.0, -1.5}}).normal + unit<3>(2)) < 1e-9);
}

BOOST_AUTO_TEST_CASE(shapes_in_two_dimensions) {
  check_distance(of_one<2>("box", box<2>({{1.0, 0.6}}), {{0.1, 0.0}}, {0.0, 0.0, 20.0}), 1.0, 4000);
  check_distance(of_one<2>("disc", sphere<2>(0.7)), 1.0, 4000);
  check_distance(of_one<2>("cone", cone<2>(0.5, 0.9), {{0.0, -0.4}}), 1.0, 4000);
  check_distance(of_one<2>("bowl", bowl<2>(0.5, 0.2), {{0.0, 0.3}}), 1.0, 4000);
  check_distance(of_one<2>("tank", box<2>({{1.2, 1.0}}), {{0.0, 0.0}}, {0.0, 0.0, -35.0}, true), 1.0, 4000);
  check_distance(of_one<2>("cylinder", cylinder<2>(0.3, 1.0)), 1.0, 4000);
  check_distance(of_one<2>("plane", plane<2>(), {{0.0, 0.1}}, {0.0, 0.0, 30.0}), 1.0, 4000);
}

BOOST_AUTO_TEST_CASE(shapes_in_three_dimensions) {
  check_distance(of_one<3>("box", box<3>({{1.0, 0.6, 0.8}}), {{0.1, 0.0, 0.0}}, {10.0, 20.0, 30.0}), 1.0, 3000);
  check_distance(of_one<3>("cylinder", cylinder<3>(0.5, 0.9), {{0.0, 0.1, 0.0}}, {40.0, 0.0, 0.0}), 1.0, 3000);
  check_distance(of_one<3>("cone", cone<3>(0.6, 0.9), {{0.0, 0.0, -0.4}}, {0.0, 25.0, 0.0}), 1.0, 3000);
  check_distance(of_one<3>("bowl", bowl<3>(0.6, 0.2), {{0.0, 0.0, 0.3}}), 1.0, 3000);
}

// Seams inside of unions, edges and corners where faces of several pieces meet.
BOOST_AUTO_TEST_CASE(unions_and_differences) {
  // Two boxes that touch: no surface between them.
  const body<2> slab("slab", {made<2>(unite, box<2>({{0.8, 0.4}}), {{-0.4, 0.0}}),
                              made<2>(unite, box<2>({{0.8, 0.4}}), {{0.4, 0.0}})});
  BOOST_TEST(slab.at({{0.01, 0.05}}).distance == -0.15, tt::tolerance(1e-12));
  check_distance(slab, 1.0, 4000);
  check_distance<2>({"cross",
                     {made<2>(unite, box<2>({{1.6, 0.4}}), {{0.0, 0.0}}),
                      made<2>(unite, box<2>({{0.5, 1.4}}), {{0.1, 0.0}}, {0.0, 0.0, 15.0})}},
                    1.0, 4000);
  check_distance<2>(
      {"bitten",
       {made<2>(unite, box<2>({{1.4, 1.0}}), {{0.0, 0.0}}), made<2>(subtract, sphere<2>(0.45), {{0.1, 0.5}})}},
      1.0, 4000);
  check_distance<2>(
      {"lens", {made<2>(unite, sphere<2>(0.8), {{-0.4, 0.0}}), made<2>(intersect, sphere<2>(0.8), {{0.4, 0.0}})}}, 1.0,
      4000);
  check_distance<3>({"hollow",
                     {made<3>(unite, box<3>({{1.6, 1.6, 1.0}}), {{0.0, 0.0, -0.3}}),
                      made<3>(subtract, sphere<3>(0.6), {{0.0, 0.0, 0.2}})}},
                    1.0, 3000);
  check_distance<3>({"pillars",
                     {made<3>(unite, box<3>({{1.8, 1.8, 0.4}}), {{0.0, 0.0, -0.7}}),
                      made<3>(unite, cylinder<3>(0.3, 1.2), {{0.4, 0.1, -0.1}}),
                      made<3>(unite, box<3>({{0.4, 0.4, 0.9}}), {{-0.4, 0.0, -0.3}}, {0.0, 0.0, 30.0})}},
                    1.0, 3000);
}

BOOST_AUTO_TEST_CASE(reach_of_a_search) {
  const auto b = of_one<2>("box", box<2>({{1.0, 1.0}}));
  BOOST_TEST(b.at({{0.0, 0.4}}, 0.2).found);
  const auto far = b.at({{3.0, 3.0}}, 0.2);
  BOOST_TEST(!far.found);
  BOOST_TEST(far.distance > 0.2);
  BOOST_TEST(b.at({{0.0, 0.1}}, 0.2).distance < 0.0);
}

BOOST_AUTO_TEST_CASE(rotations) {
  // z by 90° takes x to y; x before z.
  const auto z = turn<3>(turned_by<3>({0.0, 0.0, 90.0}), unit<3>(0));
  BOOST_TEST(norm<3>(z - unit<3>(1)) < 1e-15);
  const auto both = turn<3>(turned_by<3>({90.0, 0.0, 90.0}), unit<3>(1));
  BOOST_TEST(norm<3>(both - unit<3>(2)) < 1e-15);
  std::mt19937_64 bits(3);
  const auto R = turned_by<3>({17.0, -40.0, 130.0});
  for (int k = 0; k < 20; ++k) {
    const auto a = random_point<3>(bits, 1.0);
    BOOST_TEST(norm<3>(turn<3>(R, a)) == norm<3>(a), tt::tolerance(1e-14));
    BOOST_TEST(norm<3>(turn_back<3>(R, turn<3>(R, a)) - a) < 1e-14);
  }
  // A body turned and moved measures as the body itself from the place turned back.
  const auto itself = of_one<3>("cone", cone<3>(0.6, 0.9));
  const auto moved = of_one<3>("cone", cone<3>(0.6, 0.9), {{0.3, 0.2, -0.4}}, {17.0, -40.0, 130.0});
  for (int k = 0; k < 20; ++k) {
    const auto x = random_point<3>(bits, 1.0);
    const auto f = moved.at(x), g = itself.at(turn_back<3>(R, x - point<3>{{0.3, 0.2, -0.4}}));
    BOOST_TEST(std::abs(f.distance - g.distance) < 1e-10);
    BOOST_TEST(norm<3>(f.normal - turn<3>(R, g.normal)) < 1e-9);
  }
}
