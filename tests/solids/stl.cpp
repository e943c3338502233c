// Surfaces of triangles: files as a program writes them, faults in them, and distances from them.
#include "stl.hpp"

#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <filesystem>
#include <foundation/error.hpp>
#include <fstream>
#include <random>
#include <solids/extents.hpp>
#include <solids/options.hpp>

#include "scene.hpp"

using namespace tetsuame;
using namespace tetsuame::solids;
namespace tt = boost::test_tools;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

template <class Work>
void expect_message(Work&& work, const std::string& part) {
  BOOST_CHECK_EXCEPTION(work(), foundation::error, [&](const foundation::error& e) {
    const bool right =
        e.status() == foundation::exit_status::bad_input && std::string(e.what()).find(part) != std::string::npos;
    if (!right) BOOST_TEST_MESSAGE("message: " << e.what());
    return right;
  });
}

body<3> body_of(const triangles& surface) {
  return of_one<3>("surface", triangulated(std::make_shared<const mesh>(surface, "surface.stl")));
}

boost::test_tools::assertion_result has_cgal(boost::unit_test::test_unit_id) { return reads_triangles(); }
boost::test_tools::assertion_result lacks_cgal(boost::unit_test::test_unit_id) { return !reads_triangles(); }

}  // namespace

BOOST_AUTO_TEST_CASE(closed_surfaces) {
  BOOST_CHECK_NO_THROW(expect_closed(cube(), "cube.stl"));
  BOOST_CHECK_NO_THROW(expect_closed(ball(3), "ball.stl"));
}

BOOST_AUTO_TEST_CASE(faults_are_named) {
  auto hole = cube();
  hole.corners.pop_back();
  expect_message([&] { expect_closed(hole, "cube.stl"); },
                 "cube.stl: the surface has a hole: 3 of its edges belong to one triangle alone, the first from (");
  auto flipped = cube();
  std::swap(flipped.corners[4][0], flipped.corners[4][1]);
  expect_message(
      [&] { expect_closed(flipped, "cube.stl"); },
      "normals of 1 triangles point the other way than those of their neighbours, the first of facet 5, about (");
  auto inwards = cube();
  for (auto& c : inwards.corners) std::swap(c[0], c[1]);
  expect_message([&] { expect_closed(inwards, "cube.stl"); }, "normals point inwards");
  auto twice = cube();
  twice.corners.push_back(twice.corners.front());
  expect_message([&] { expect_closed(twice, "cube.stl"); }, "3 triangles meet at the edge");
  auto flat = cube();
  flat.corners[2][1] = flat.corners[2][0];
  expect_message([&] { expect_closed(flat, "cube.stl"); }, "facet 3 has no area, at (");
  auto line = cube();
  line.points.push_back({0.5, 0.0, 0.0});
  line.corners.push_back({0, 8, 1});
  expect_message([&] { expect_closed(line, "cube.stl"); }, "facet 13 has no area");
  auto endless = cube();
  endless.points[3][1] = NAN;
  expect_message([&] { expect_closed(endless, "cube.stl"); }, "a corner is at nan");
  expect_message([&] { expect_closed({}, "cube.stl"); }, "no triangles");
}

BOOST_AUTO_TEST_CASE(without_the_library, *boost::unit_test::precondition(lacks_cgal)) {
  expect_message([&] { mesh(cube(), "cube.stl"); }, "built without CGAL");
}

BOOST_AUTO_TEST_CASE(read_as_written) {
  for (const auto& bytes : {ascii(cube()), binary(cube())}) {
    const auto read = read_stl(bytes, "cube.stl");
    BOOST_TEST(read.points.size() == 8U);
    BOOST_TEST(read.corners.size() == 12U);
    expect_closed(read, "cube.stl");
  }
  expect_closed(read_stl(binary(ball(2)), "ball.stl"), "ball.stl");
}

BOOST_AUTO_TEST_CASE(distances_from_triangles, *boost::unit_test::precondition(has_cgal)) {
  // A cube of triangles is the box.
  const auto of_triangles = body_of(cube());
  const auto exact = of_one<3>("box", box<3>({{1.0, 1.0, 1.0}}), {{0.5, 0.5, 0.5}});
  std::mt19937_64 bits(5);
  std::uniform_real_distribution<double> along(-0.7, 1.7);
  double difference = 0.0, turned = 0.0;
  for (int k = 0; k < 300; ++k) {
    const auto x = point<3>::of([&](std::size_t) { return along(bits); });
    const auto a = of_triangles.at(x), b = exact.at(x);
    difference = std::max(difference, std::abs(a.distance - b.distance));
    // Where faces are equally near, either normal is right.
    turned = std::max(turned, std::abs(exact.at(x - a.distance * a.normal).distance));
  }
  BOOST_TEST(difference < 1e-12);
  BOOST_TEST(turned < 1e-12);
  // A ball of triangles approaches the sphere as the square of their size.
  const auto error = [&](int level) {
    const auto b = body_of(ball(level));
    double worst = 0.0;
    for (int k = 0; k < 100; ++k) {
      const auto x = point<3>::of([&](std::size_t) { return along(bits); });
      worst = std::max(worst, std::abs(b.at(x).distance - (norm<3>(x) - 1.0)));
    }
    return worst;
  };
  const double coarse = error(2), fine = error(3);
  BOOST_TEST(coarse / fine > 3.0);
  BOOST_TEST(coarse / fine < 5.0);
}

// A sphere taken out of a cube of triangles: edges where triangles meet a face.
BOOST_AUTO_TEST_CASE(triangles_among_other_shapes, *boost::unit_test::precondition(has_cgal)) {
  const body<3> of_triangles(
      "bowl",
      {made<3>(operation::unite, triangulated(std::make_shared<const mesh>(cube(), "cube.stl")), {{0.0, 0.0, 0.0}}),
       made<3>(operation::subtract, sphere<3>(0.4), {{0.5, 0.5, 1.0}})});
  const body<3> exact("bowl", {made<3>(operation::unite, box<3>({{1.0, 1.0, 1.0}}), {{0.5, 0.5, 0.5}}),
                               made<3>(operation::subtract, sphere<3>(0.4), {{0.5, 0.5, 1.0}})});
  std::mt19937_64 bits(9);
  std::uniform_real_distribution<double> along(-0.2, 1.2);
  double difference = 0.0;
  for (int k = 0; k < 100; ++k) {
    const auto x = point<3>::of([&](std::size_t) { return along(bits); });
    difference = std::max(difference, std::abs(of_triangles.at(x).distance - exact.at(x).distance));
  }
  BOOST_TEST(difference < 1e-9);
}

BOOST_AUTO_TEST_CASE(surfaces_that_cut_themselves, *boost::unit_test::precondition(has_cgal)) {
  auto two = cube();
  const auto size = static_cast<std::uint32_t>(two.points.size());
  const auto other = cube();
  for (const auto& p : other.points) two.points.push_back({p[0] + 0.5, p[1] + 0.4, p[2] + 0.3});
  for (const auto& c : other.corners) two.corners.push_back({c[0] + size, c[1] + size, c[2] + size});
  expect_closed(two, "two.stl");
  expect_message([&] { mesh(two, "two.stl"); }, "two.stl: the surface cuts through itself, first in facets ");
}

// What cells say of a place agrees with the triangles: the side always, and the distance as a bound.
BOOST_AUTO_TEST_CASE(places_by_cells, *boost::unit_test::precondition(has_cgal)) {
  for (const auto& [of, half] : {std::pair{ball(4), 1.2}, std::pair{cube(), 1.3}}) {
    const mesh surface(of, "surface.stl");
    std::mt19937_64 bits(11);
    std::uniform_real_distribution<double> along(-half, half);
    for (int k = 0; k < 2000; ++k) {
      const std::array x{along(bits), along(bits), along(bits)};
      const auto exact = surface.at(x);
      for (const double reach : {0.0, 0.05, 0.3}) {
        const auto known = surface.at(x, reach);
        const bool right = std::abs(exact.distance) > reach
                               ? known.distance * exact.distance > 0.0 && std::abs(known.distance) > reach &&
                                     std::abs(known.distance) <= std::abs(exact.distance) * (1.0 + 1e-12)
                               : known.distance == exact.distance;
        BOOST_TEST(right, exact.distance << " " << known.distance << " " << reach);
      }
      BOOST_TEST(surface.inside(x) == (exact.distance < 0.0));
      if (half == 1.2) BOOST_TEST((norm<3>(point<3>{x}) < 0.99) <= surface.inside(x));
    }
  }
}

// By the input: a cube of millimetres, turned by 45° about z and moved.
BOOST_AUTO_TEST_CASE(files_of_an_input, *boost::unit_test::precondition(has_cgal)) {
  const std::filesystem::path folder = TETSUAME_BINARY_DIR "/tests/solids_stl_files";
  std::filesystem::create_directories(folder);
  auto flipped = cube();
  std::swap(flipped.corners[4][0], flipped.corners[4][1]);
  std::ofstream(folder / "cube.stl", std::ios::binary) << binary(cube());
  auto around = cube();
  for (auto& p : around.points) p = {p[0] - 0.5, p[1] - 0.5, p[2] - 0.5};
  std::ofstream(folder / "around.stl", std::ios::binary) << binary(around);
  std::ofstream(folder / "flipped.stl") << ascii(flipped);
  const auto bodies_of = [&](const std::string& file, const std::string& scale = "1d-3") {
    options o;
    motion_options m;
    namelist::schema schema;
    declare(schema, o, m);
    schema.read(namelist::parse_text(
        "&solids shape = 'file' scale = " + scale + " angle_z = 45 centre_x = 2 file = '" + file + "' /",
        (folder / "case.nml").string()));
    return make_bodies<3>(schema, o);
  };
  const auto body = bodies_of("cube.stl").front();
  // Its corner (1, 1, 0) comes to (2, √2/1000, 0).
  BOOST_TEST(body.at({{2.0, 0.001 * std::sqrt(2.0) + 0.5, 0.0005}}).distance == 0.5, tt::tolerance(1e-9));
  BOOST_TEST(body.at({{2.0, 0.0005 * std::sqrt(2.0), 0.0005}}).distance == -0.0005, tt::tolerance(1e-9));
  expect_message([&] { bodies_of("flipped.stl"); }, "case.nml:1: &solids file: " + (folder / "flipped.stl").string() +
                                                        ": normals of 1 triangles point the other way");
  expect_message([&] { bodies_of("cube.stl", "1e150"); },
                 "the surface reaches 1.41e+150 m far; expected: at most 1e+30 m");
  expect_message([&] { bodies_of("cube.stl", "1e-150"); }, "rounding would lose it");
  expect_message([&] { bodies_of("cube.stl", "1e-12"); }, "rounding would lose it");
  // Beside the box, and more than a billion times as large.
  const lattice<3> box{{{1.0, 0.5, 0.5}}, 0.1};
  expect_message(
      [&] { expect_in_box<3>(bodies_of("cube.stl"), box); },
      "is smaller than the spacing of the particles; the triangles of body 'solid' reach from (1.999, 0, 0) to "
      "(2.001, 0.001414, 0.001) m, and the box to (1, 0.5, 0.5) m: is &solids scale missing");
  expect_message([&] { expect_in_box<3>(bodies_of("around.stl", "1000"), box); },
                 "solids fill the whole box; the triangles of body 'solid' reach from (");
  expect_message([&] { expect_sizes<3>(bodies_of("cube.stl", "1e10"), box.length); },
                 "body 'solid' reaches 1.41e+10 m far, more than 1e+09 times the box, 1 m");
}

// The fuzz entry over changed copies of small files: the same ones in every run.
BOOST_AUTO_TEST_CASE(changed_files) {
  std::mt19937_64 bits(20260101);
  for (const std::string& whole :
       {ascii(cube()), binary(cube()), ascii(ball(0)), binary(ball(0)),
        std::string("# t, x, y, z, angle\n0, 0, 0, 0, 0\n1, 0.1, 0, 0, 20\n2, 4e-1, .1, 0, 30\n3,1,1,1,1\n")})
    for (int k = 0; k < 1500; ++k) {
      std::string bytes = whole;
      for (std::uint64_t changes = bits() % 4; changes > 0; --changes) {
        const std::size_t at = bits() % bytes.size();
        switch (bits() % 4) {
          case 0:
            bytes[at] = static_cast<char>(bits());
            break;
          case 1:
            bytes.erase(at, 1 + bits() % 60);
            break;
          case 2:
            bytes.insert(at, bytes.substr(bits() % bytes.size(), bits() % 60));
            break;
          default:
            bytes.resize(at);
        }
        if (bytes.empty()) break;
      }
      BOOST_TEST_CONTEXT("file " << k)
      BOOST_CHECK_NO_THROW(LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()));
    }
}
