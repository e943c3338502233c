// Bodies and motions from a namelist.
#include <boost/test/unit_test.hpp>
#include <filesystem>
#include <foundation/error.hpp>
#include <fstream>
#include <namelist/schema.hpp>
#include <solids/extents.hpp>
#include <solids/options.hpp>
#include <sstream>

using namespace tetsuame;
using namespace tetsuame::solids;
namespace tt = boost::test_tools;

namespace {

struct input {
  options o;
  motion_options m;
  namelist::schema schema;

  explicit input(const std::string& text, const std::string& name = "case.nml") {
    declare(schema, o, m);
    schema.read(namelist::parse_text(text, name));
  }
};

template <int D>
std::vector<body<D>> bodies_of(const std::string& text) {
  const input in(text);
  return make_bodies<D>(in.schema, in.o);
}

template <int D>
void expect_message(const std::string& text, const std::string& part) {
  BOOST_CHECK_EXCEPTION(
      [&] {
        const input in(text);
        make_motions<D>(in.schema, in.m, make_bodies<D>(in.schema, in.o));
      }(),
      foundation::error,
      [&](const foundation::error& e) {
        const bool right =
            e.status() == foundation::exit_status::bad_input && std::string(e.what()).find(part) != std::string::npos;
        if (!right) BOOST_TEST_MESSAGE("message: " << e.what());
        return right;
      });
}

const char* const scene = R"(
&solids
  body(1) = 'tank'   shape(1) = 'box'   solid(1) = 'outside'
  centre_x(1) = 1.0  centre_y(1) = 0.5  length_x(1) = 2.0  length_y(1) = 1.0  angle_z(1) = 0
  body(2) = 'pillar' shape(2) = 'sphere' centre_x(2) = 0.5 centre_y(2) = 0.5 radius(2) = 0.2
  body(3) = 'pillar' shape(3) = 'sphere' centre_x(3) = 0.7 centre_y(3) = 0.5 radius(3) = 0.1 operation(3) = 'difference'
/
&motions body = 'pillar' period = 2.0 amplitude_x = 0.1 /
)";

}  // namespace

BOOST_AUTO_TEST_CASE(bodies_of_pieces) {
  const input in(scene);
  const auto bodies = make_bodies<2>(in.schema, in.o);
  BOOST_TEST_REQUIRE(bodies.size() == 2U);
  BOOST_TEST(bodies[0].name() == "tank");
  BOOST_TEST(bodies[0].at({{1.0, 0.2}}).distance == 0.2, tt::tolerance(1e-12));
  BOOST_TEST(bodies[0].at({{1.0, -0.2}}).distance == -0.2, tt::tolerance(1e-12));
  BOOST_TEST(bodies[1].pieces().size() == 2U);
  BOOST_TEST(bodies[1].solid({{0.5, 0.5}}));
  BOOST_TEST(!bodies[1].solid({{0.65, 0.5}}));
  const auto motions = make_motions<2>(in.schema, in.m, bodies);
  BOOST_TEST(!motions[0].moves());
  BOOST_TEST(motions[1].at(0.5).shift[0] == 0.1, tt::tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(resolved_and_described) {
  const input in(scene);
  std::ostringstream first, second;
  in.schema.write_resolved(first);
  const input again(first.str());
  again.schema.write_resolved(second);
  BOOST_TEST(first.str() == second.str());
  BOOST_TEST(make_bodies<2>(again.schema, again.o).size() == 2U);
  std::ostringstream described;
  in.schema.describe(described);
  const input from_description(described.str());
  BOOST_TEST(from_description.o.shape.empty());
}

BOOST_AUTO_TEST_CASE(every_shape) {
  const std::string text = R"(&solids shape = 'plane', 'box', 'sphere', 'cylinder', 'cone', 'bowl'
    centre_z = -1.0  length_x(2) = 1 length_y(2) = 1 length_z(2) = 1  radius(3:6) = 0.5, 0.5, 0.5, 0.5
    height(4:5) = 1, 1  thickness(6) = 0.1 /)";
  const auto bodies = bodies_of<3>(text);
  BOOST_TEST_REQUIRE(bodies.size() == 1U);
  BOOST_TEST(bodies[0].name() == "solid");
  BOOST_TEST(bodies[0].pieces().size() == 6U);
  BOOST_TEST(bodies[0].solid({{5.0, 5.0, -1.1}}));
  BOOST_TEST(!bodies[0].solid({{5.0, 5.0, -0.9}}));
}

BOOST_AUTO_TEST_CASE(what_cannot_be) {
  expect_message<2>("&solids shape = 'sphere' /",
                    "&solids radius: piece 1 ('sphere' of body 'solid'): expected a length above 0");
  expect_message<2>("&solids shape = 'sphere' radius = 1 height = 2 /",
                    "case.nml:1: &solids height: piece 1 ('sphere' of body 'solid'): this shape has none");
  expect_message<2>("&solids shape = 'sphere' radius = 1, 2 /", "&solids radius: has 2 elements, and shape 1");
  expect_message<2>("&solids shape = 'sphere' radius = 1 centre_z = 2 /", "there is none in two dimensions");
  expect_message<2>("&solids shape = 'sphere' radius = 1 operation = 'difference' /",
                    "the first piece of a body is united");
  expect_message<2>("&solids shape = 'file' file = 'a.stl' /", "take three dimensions");
  expect_message<3>("&solids shape = 'file' /", "expected the name of an STL file");
  expect_message<3>("&solids shape = 'file' file = 'there_is_none.stl' /",
                    "case.nml:1: &solids file: there is no file there_is_none.stl");
  expect_message<3>("&solids shape = 'ball' /", "the nearest is");
  expect_message<2>("&solids shape = 'sphere' radius = 1 / &motions body = 'a' /",
                    "&motions body: motion 1 (of body 'a'): &solids has no body of this name");
  expect_message<2>("&solids shape = 'sphere' radius = 1 / &motions body = 'solid' /", "expected a time above 0");
  expect_message<2>("&solids shape = 'sphere' radius = 1 / &motions body = 'solid', 'solid' period = 1, 1 /",
                    "moves already");
  expect_message<2>("&solids shape = 'sphere' radius = 1 / &motions body = 'solid' kind = 'table' /",
                    "expected the name of a table");
}

BOOST_AUTO_TEST_CASE(free_bodies) {
  const input in(
      "&solids body = 'boat', 'pier' shape = 'box', 'box' length_x = 1, 1 length_y = 1, 1 /"
      "&motions body = 'boat' kind = 'free' density = 500 gyration_z = 0.3 /");
  const auto free = make_free(in.schema, in.m, 2, {"boat", "pier"});
  BOOST_TEST(free[0]->density == 500.0);
  BOOST_TEST(free[0]->gyration[2] == 0.3);
  BOOST_TEST(!free[1].has_value());
  BOOST_TEST(!make_motions<2>(in.schema, in.m, make_bodies<2>(in.schema, in.o))[0].moves());
}

// Radii of gyration are those of some body: in three dimensions all of them, of which no square is above the sum of the
// others'.
BOOST_AUTO_TEST_CASE(inertia_of_a_body) {
  const auto read = [](const std::string& gyration) {
    const input in(
        "&solids body = 'boat' shape = 'sphere' radius = 1 /\n&motions body = 'boat' kind = 'free' mass = 5 " +
        gyration + " /");
    return make_free(in.schema, in.m, 3, {"boat"})[0]->gyration;
  };
  for (const char* possible : {"", "gyration_x = 0.1 gyration_y = 0.12 gyration_z = 0.13",
                               "gyration_x = 0.3 gyration_y = 0.4 gyration_z = 0.5"})  // the last one: a plate
    BOOST_CHECK_NO_THROW(read(possible));
  for (const auto& [gyration, message] :
       {std::pair{"gyration_x = 0.1",
                  "&motions gyration_y: motion 1 (of body 'boat'): expected a length "
                  "above 0: in three dimensions a body takes all three radii of gyration, or none"},
        {"gyration_y = 0.1 gyration_z = 0.1", "&motions gyration_x: motion 1"},
        {"gyration_x = 0.1 gyration_y = 0.1 gyration_z = 0.15",
         "&motions gyration_z: motion 1 (of body 'boat'): no body has a moment of inertia above the sum of its other "
         "two: expected at most 0.141421 m"},
        {"gyration_x = 2.0 gyration_y = 0.1 gyration_z = 0.1", "&motions gyration_x: motion 1"}})
    BOOST_CHECK_EXCEPTION(read(gyration), foundation::error, [&](const foundation::error& e) {
      return std::string(e.what()).find(message) != std::string::npos;
    });
}

BOOST_AUTO_TEST_CASE(bodies_that_do_not_fit) {
  const input far("&solids\n shape = 'sphere' radius = 0.3 centre_x = 9 /");
  BOOST_CHECK_EXCEPTION(
      expect_sound<2>(far.schema, make_bodies<2>(far.schema, far.o), {{{1.0, 1.0}}, 0.1}, 0.2), foundation::error,
      [](const foundation::error& e) {
        return std::string(e.what()) ==
               "case.nml:2: &solids shape: piece 1 of body 'solid' lies outside the box, or is smaller "
               "than the spacing of the particles";
      });
}

BOOST_AUTO_TEST_CASE(files_of_the_input) {
  const std::filesystem::path folder = TETSUAME_BINARY_DIR "/tests/solids_files";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "torn.stl") << "solid torn\n  facet normal 0 0 1\n    outer loop\n";
  std::ofstream(folder / "wave.csv") << "t, x, y, z, angle\n0,0,0,0,0\n1,1,0,0,0\n2,0,0,0,0\n3,0,0,0,0\n";
  const auto name = (folder / "case.nml").string(), file = (folder / "torn.stl").string();
  const input torn("&solids shape = 'file' file = 'torn.stl' /", name);
  BOOST_CHECK_EXCEPTION(make_bodies<3>(torn.schema, torn.o), foundation::error, [&](const foundation::error& e) {
    return e.status() == foundation::exit_status::bad_input &&
           std::string(e.what()).find(name + ":1: &solids file: " + file + ":4: facet 1: ") != std::string::npos;
  });
  const input moved("&solids shape = 'sphere' radius = 1 / &motions body = 'solid' kind = 'table' file = 'wave.csv' /",
                    name);
  const auto motions = make_motions<2>(moved.schema, moved.m, make_bodies<2>(moved.schema, moved.o));
  BOOST_TEST(motions[0].at(1.0).shift[0] == 1.0, tt::tolerance(1e-12));
}

// Wall particles of larger ones would be lost to rounding.
BOOST_AUTO_TEST_CASE(bodies_beyond_all_sizes) {
  for (const char* text :
       {"shape = 'sphere' radius = 1e10 centre_y = -1e10", "shape = 'box' length_x = 1e13 length_y = 1",
        "shape = 'plane' centre_x = 1e12 angle_z = 30", "shape = 'sphere' radius = 1e200"}) {
    const input in(std::string("&solids ") + text + " /");
    const auto bodies = make_bodies<2>(in.schema, in.o);
    BOOST_CHECK_EXCEPTION(expect_sizes<2>(bodies, {{1.0, 0.5}}), foundation::error, [](const foundation::error& e) {
      return std::string(e.what()).find("more than 1e+09 times the box, 1 m") != std::string::npos;
    });
  }
  const input in("&solids shape = 'sphere' radius = 1e6 centre_y = -1e6 /");
  BOOST_CHECK_NO_THROW(expect_sizes<2>(make_bodies<2>(in.schema, in.o), {{1.0, 0.5}}));
}
