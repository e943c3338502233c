// Prescribed motions and free bodies.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <foundation/error.hpp>
#include <numbers>
#include <solids/motion.hpp>

#include "scene.hpp"

using namespace tetsuame;
using namespace tetsuame::solids;
namespace tt = boost::test_tools;

namespace {

// The velocity of a point of the body is how fast its place changes, its acceleration how fast that does.
template <int D>
void check_velocity(const prescribed<D>& motion, const point<D>& X, double from, double to) {
  for (int k = 1; k < 20; ++k) {
    const double t = from + (to - from) * k / 20.0, dt = 1e-5;
    const auto before = motion.at(t - dt).to_space(X), after = motion.at(t + dt).to_space(X);
    const auto v = motion.rate_at(t).at(motion.at(t).to_space(X));
    BOOST_TEST(norm<D>((0.5 / dt) * (after - before) - v) < 1e-6);
    const auto gained = motion.rate_at(t + dt).at(after) - motion.rate_at(t - dt).at(before);
    const auto a = motion.rate_at(t).acceleration_at(motion.at(t).to_space(X));
    BOOST_TEST(norm<D>((0.5 / dt) * gained - a) < 1e-6);
    BOOST_TEST(norm<D>(motion.at(t).to_body(motion.at(t).to_space(X)) - X) < 1e-13);
  }
}

const char* const rows =
    "t, x, y, z, angle\n# a comment\n0, 0, 0, 0, 0\n1, 0.1, 0, 0, 20\n2, 0.4, 0.1, 0, 30\n3, 0.5, 0.2, 0.1, 30\n";

}  // namespace

BOOST_AUTO_TEST_CASE(harmonic_motion) {
  check_velocity<2>({{{0.3, 0.4}}, {{1.0}}, {2.0, 0.3, {{0.1, -0.2}}, 0.5}}, {{1.0, 0.7}}, 0.0, 3.0);
  const about<3> axis{{0.6, 0.0, 0.8}};
  const prescribed<3> motion({{0.3, 0.4, 0.1}}, axis, prescribed<3>::harmonic{1.5, 0.0, {{0.1, 0.0, 0.2}}, 0.4});
  check_velocity<3>(motion, {{1.0, 0.7, -0.2}}, 0.0, 3.0);
  // At t = 0, without a phase, the body is where it was made.
  BOOST_TEST(norm<3>(motion.at(0.0).to_space({{1.0, 0.7, -0.2}}) - point<3>{{1.0, 0.7, -0.2}}) < 1e-15);
  const prescribed<2> still;
  BOOST_TEST(!still.moves());
  BOOST_TEST(norm<2>(still.rate_at(1.0).at({{1.0, 2.0}})) == 0.0);
}

BOOST_AUTO_TEST_CASE(distance_from_a_moving_body) {
  const auto b = of_one<2>("box", box<2>({{0.4, 0.2}}), {{0.5, 0.5}});
  // Turned by 90° about its centre, and moved.
  const prescribed<2> motion({{0.5, 0.5}}, {{1.0}},
                             prescribed<2>::harmonic{4.0, 0.0, {{0.3, 0.0}}, std::numbers::pi / 2.0});
  const auto f = at(b, motion.at(1.0), point<2>{{0.8, 0.9}});
  BOOST_TEST(f.distance == 0.2, tt::tolerance(1e-12));
  BOOST_TEST(norm<2>(f.normal - point<2>{{0.0, 1.0}}) < 1e-12);
  BOOST_TEST(norm<2>(f.nearest - point<2>{{0.8, 0.7}}) < 1e-12);
  // As a body that was given there.
  const auto moved = placed<2>(b, motion.at(0.7));
  for (const point<2> x : {point<2>{{0.8, 0.9}}, point<2>{{0.65, 0.5}}, point<2>{{0.3, 0.55}}}) {
    BOOST_TEST(moved.level(x) == b.level(motion.at(0.7).to_body(x)), tt::tolerance(1e-12));
    BOOST_TEST(norm<2>(moved.at(x).nearest - at(b, motion.at(0.7), x).nearest) < 1e-12);
  }
}

BOOST_AUTO_TEST_CASE(rotation_vectors) {
  const about<3> by{{0.3, -0.7, 0.4}};
  BOOST_TEST(norm<3>(rotation_vector<3>(rotation_by<3>(by)) - by) < 1e-14);
  BOOST_TEST(rotation_vector<2>(rotation_by<2>({{-2.5}}))[0] == -2.5, tt::tolerance(1e-14));
  const double angle = norm<3>(by), part = std::sin(0.5 * angle) / angle;
  const auto R = rotation_of({2.0 * std::cos(0.5 * angle), 2.0 * part * by[0], 2.0 * part * by[1], 2.0 * part * by[2]});
  BOOST_TEST(norm<3>(rotation_vector<3>(R) - by) < 1e-14);
}

BOOST_AUTO_TEST_CASE(motion_by_a_table) {
  const auto table = read_motion({rows, "wall.csv"}, 3);
  const prescribed<3> motion({{0.0, 0.0, 0.0}}, {{0.0, 0.0, 1.0}}, table);
  check_velocity<3>(motion, {{1.0, 0.7, -0.2}}, 0.0, 3.0);
  BOOST_TEST(norm<3>(motion.at(2.0).shift - point<3>{{0.4, 0.1, 0.0}}) < 1e-14);
  BOOST_TEST(norm<3>(motion.at(9.0).shift - point<3>{{0.5, 0.2, 0.1}}) < 1e-14);
  BOOST_TEST(norm<3>(motion.rate_at(9.0).velocity) == 0.0);
  const auto fails = [](const std::string& text, const std::string& part) {
    BOOST_CHECK_EXCEPTION(read_motion({text, "wall.csv"}, 3), foundation::error, [&](const foundation::error& e) {
      return e.status() == foundation::exit_status::bad_input && std::string(e.what()).find(part) != std::string::npos;
    });
  };
  fails("0, 0, 0, 0, 0\n", "holds 1 rows");
  const std::string three = "1, 0, 0, 0, 0\n2, 0, 0, 0, 0\n3, 0, 0, 0, 0\n";
  fails("1, 0, 0, 0, 0\n" + three, "wall.csv:2: column 1: time 1 does not lie behind");
  fails("0, 0, 0, 0\n", "wall.csv: expected the columns t, x, y, z, angle");
  fails("0, 0, 0, 0, 0, 0\n", "wall.csv: expected the columns t, x, y, z, angle");
  fails("0, 0, 0, inf, 0\n" + three, "wall.csv:1: column 4: expected a finite number, found 'inf'");
  fails("0, 0, 0, 1x, 0\n" + three, "wall.csv:1: column 4: expected a finite number, found '1x'");
  fails("t,x,y,z,w\n0,0,0,0,0\n" + three, "wall.csv: expected the columns t, x, y, z, angle");
  fails("t,x,y,z,angle\ns,mm,m,m,degrees\n0,0,0,0,0\n" + three, "wall.csv: column 2 ('x') is in mm");
}

// At its first time a body goes on as the table says: it does not begin its way at rest.
BOOST_AUTO_TEST_CASE(velocity_at_the_first_time) {
  const prescribed<2> motion(
      {{0.0, 0.0}}, {{1.0}},
      read_motion({"0,0,0,0,0\n0.1,0,0.453,0,0\n0.2,0,0.906,0,0\n0.3,0,1.359,0,0\n", "gate"}, 2));
  BOOST_TEST(motion.rate_at(0.0).velocity[1] == 4.53, boost::test_tools::tolerance(1e-9));
  BOOST_TEST(motion.rate_at(1e-9).velocity[1] == 4.53, boost::test_tools::tolerance(1e-9));
  BOOST_TEST(motion.rate_at(-1e-9).velocity[1] == 0.0);
  BOOST_TEST(motion.rate_at(0.3).velocity[1] == 0.0);
}

// Columns are found by their names, and what is not used may be anything.
BOOST_AUTO_TEST_CASE(columns_of_a_motion) {
  const auto by_name =
      read_motion({"Time [s];angle;z;y;x;by\n0;1;2;3;4;me\n1;1;2;3;4;\n2;1;2;3;4;\n3;1;2;3;4;nan\n", "m"}, 3);
  BOOST_TEST((by_name.shift[0][2] == 4.0 && by_name.shift[2][2] == 2.0 && by_name.angle[0] == 1.0));
  const auto flat = read_motion({"t x y z angle\n0 4 3 nan 1\n1 4 3 - 1\n2 4 3 9 1\n3 4 3 9 1\n", "m"}, 2);
  BOOST_TEST((flat.shift[0][3] == 4.0 && flat.shift[2][3] == 0.0));
  const auto unnamed = read_motion({"a b c d e\n0 4 3 2 1\n1 4 3 2 1\n2 4 3 2 1\n3 4 3 2 1\n", "m"}, 3);
  BOOST_TEST((unnamed.shift[0][3] == 4.0 && unnamed.angle[3] == 1.0));
}

BOOST_AUTO_TEST_CASE(free_bodies_conserve_momentum) {
  const auto b = of_one<3>("brick", box<3>({{0.4, 0.2, 0.12}}), {{0.5, 0.5, 0.5}});
  auto body = filled<3>(b, 500.0, bounds_of(b), 0.02);
  BOOST_TEST(body.mass == 500.0 * 0.0096, tt::tolerance(1e-9));
  BOOST_TEST(norm<3>(body.now.pivot - point<3>{{0.5, 0.5, 0.5}}) < 1e-12);
  const double exact = body.mass / 12.0 * (0.2 * 0.2 + 0.12 * 0.12);
  BOOST_TEST(body.inertia[0][0] == exact, tt::tolerance(1e-9));
  body.momentum = {{1.0, 2.0, 3.0}};
  body.angular_momentum = {{0.02, 0.5, 0.03}};  // about the middle axis: it tumbles
  const auto start = body;
  const auto drift = [&](int steps) {
    auto moved = start;
    for (int k = 0; k < steps; ++k) advance<3>(moved, {{0.0, 0.0, 0.0}}, {{0.0, 0.0, 0.0}}, 1.0 / steps);
    BOOST_TEST(norm<3>(moved.momentum - start.momentum) == 0.0);
    BOOST_TEST(norm<3>(moved.angular_momentum - start.angular_momentum) == 0.0);
    BOOST_TEST(norm<3>(moved.now.shift - (1.0 / start.mass) * start.momentum) < 1e-12);
    for (const auto& row : moved.now.turned) BOOST_TEST(std::abs(norm<3>(row) - 1.0) < 1e-12);
    return std::abs(moved.kinetic_energy() / start.kinetic_energy() - 1.0);
  };
  const double coarse = drift(400), fine = drift(800);
  BOOST_TEST(fine < 1e-4);
  BOOST_TEST(fine < 0.3 * coarse + 1e-12);
}

BOOST_AUTO_TEST_CASE(free_bodies_take_what_acts) {
  // A pendulum of a disc: torque −k θ. Its period is 2π √(I/k).
  const auto disc = of_one<2>("disc", sphere<2>(0.1), {{0.5, 0.5}});
  auto body = filled<2>(disc, 1000.0, bounds_of(disc), 0.002);
  BOOST_TEST(body.mass == 1000.0 * std::numbers::pi * 0.01, tt::tolerance(1e-5));
  BOOST_TEST(body.inertia[0][0] == 0.5 * body.mass * 0.01, tt::tolerance(3e-5));
  const double k = 2.0, period = 2.0 * std::numbers::pi * std::sqrt(body.inertia[0][0] / k);
  body.now.turned = rotation_by<2>({{0.3}});
  const auto angle = [&] { return std::atan2(body.now.turned[1][0], body.now.turned[0][0]); };
  const int steps = 1000;
  for (int n = 0; n < steps; ++n) advance<2>(body, {{0.0, -9.81 * body.mass}}, {{-k * angle()}}, period / steps);
  BOOST_TEST(angle() == 0.3, tt::tolerance(0.02));
  BOOST_TEST(body.momentum[1] == -9.81 * body.mass * period, tt::tolerance(1e-9));
  // Its fall, ½ g t².
  BOOST_TEST(body.now.shift[1] == -0.5 * 9.81 * period * period, tt::tolerance(1e-6));
}
