// Regions of a start: expressions, which region counts where, and what is refused.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <foundation/error.hpp>
#include <namelist/document.hpp>
#include <regions/region.hpp>
#include <sstream>

using namespace tetsuame;
using namespace tetsuame::regions;
namespace tt = boost::test_tools;

namespace {

const abilities liquids{
    .materials = {"lower", "upper"}, .temperature = true, .velocity = true, .density = true, .pressure = true};

// In a box of 4 m x 2 m x 1 m with a spacing of 0.1 m.
struct read_regions {
  options o;
  namelist::schema schema;
  all regions;

  explicit read_regions(const std::string& text, int dimension = 2, const std::string& set = "") {
    declare(schema, liquids, o);
    auto input = namelist::parse_text(text, "start.nml");
    if (!set.empty()) input.set(set);
    schema.read(input);
    regions = all(schema, liquids, o, dimension, {4.0, 2.0, dimension == 3 ? 1.0 : 0.0}, 0.1);
  }
  values at(double x, double y, double z = 0.0, double T = 1000.0) {
    std::vector<std::int64_t> counts;
    return regions.at({x, y, z}, T, counts);
  }
};

std::string told(const std::string& text, int dimension = 2) {
  try {
    read_regions made(text, dimension);
    made.at(0.0, 0.0);
  } catch (const foundation::error& e) {
    BOOST_TEST((e.status() == foundation::exit_status::bad_input));
    return e.what();
  }
  return "nothing";
}

void expect_told(const std::string& text, const std::vector<std::string>& parts) {
  const auto message = told(text);
  for (const auto& part : parts)
    BOOST_TEST(message.find(part) != std::string::npos, "'" << part << "' is not in '" << message << "'");
}

}  // namespace

BOOST_AUTO_TEST_CASE(later_regions_override_earlier_ones) {
  read_regions r(R"(
&region  material = 'lower'  temperature = 2000 /
&region  shape = 'box'  centre_x = 2  centre_y = 1  length_x = 2  length_y = 1  material = 'upper' /
&region  shape = 'sphere'  centre_x = 2  centre_y = 1  radius = 0.25  temperature = 2500  velocity_x = 3 /
)");
  BOOST_TEST(*r.at(0.1, 0.1).material == 0);
  BOOST_TEST(*r.at(1.1, 1.0).material == 1);
  BOOST_TEST(*r.at(1.1, 1.0).temperature == 2000.0);
  BOOST_TEST(!r.at(1.1, 1.0).velocity[0].has_value());
  BOOST_TEST(*r.at(2.1, 1.1).material == 1);
  BOOST_TEST(*r.at(2.1, 1.1).temperature == 2500.0);
  BOOST_TEST(*r.at(2.1, 1.1).velocity[0] == 3.0);
  BOOST_TEST(!r.at(2.1, 1.1).density.has_value());
}

BOOST_AUTO_TEST_CASE(expressions_of_the_place_and_of_constants) {
  read_regions r(R"(
&constants  name = 'A', 'mean'  value = 200, 1500 /
&region  temperature = 'mean + A*sin(2*pi*x/length_x)' /
&region  condition = 'y > 0.5*length_y && x < 1'  temperature = 'T + 10' /
)");
  for (const double x : {0.3, 1.2, 3.7})
    BOOST_TEST(*r.at(x, 0.5).temperature == 1500.0 + 200.0 * std::sin(0.5 * M_PI * x), tt::tolerance(1e-14));
  BOOST_TEST(*r.at(0.3, 1.5).temperature == 1510.0 + 200.0 * std::sin(0.15 * M_PI), tt::tolerance(1e-14));
  read_regions before("&region condition = 'hypot(x - 2, y - 1) < 6*spacing' temperature = '2*T' /");
  BOOST_TEST(*before.at(2.4, 1.4).temperature == 2000.0);  // at 0.566 m
  BOOST_TEST(!before.at(2.5, 1.4).temperature.has_value());
}

// A ring of two pieces, turned outside in by a third region.
BOOST_AUTO_TEST_CASE(pieces_of_one_name_are_one_region) {
  read_regions r(R"(
&region  name = 'ring'  shape = 'sphere'  radius = 0.5  centre_x = 1  centre_y = 1  material = 'upper' /
&region  name = 'ring'  shape = 'sphere'  radius = 0.3  centre_x = 1  centre_y = 1  operation = 'difference' /
)");
  BOOST_TEST(r.regions.size() == 1U);
  BOOST_TEST(*r.at(1.4, 1.0).material == 1);
  BOOST_TEST(!r.at(1.2, 1.0).material.has_value());
  BOOST_TEST(!r.at(1.6, 1.0).material.has_value());
  read_regions out(
      "&region shape = 'sphere' side = 'outside' radius = 0.5 centre_x = 1 centre_y = 1 material = 'upper' /");
  BOOST_TEST(*out.at(1.6, 1.0).material == 1);
  BOOST_TEST(!out.at(1.2, 1.0).material.has_value());
}

BOOST_AUTO_TEST_CASE(what_is_resolved_reads_back) {
  const std::string text = R"(
&region  material = 'lower'  temperature = 1.5d3 /
&region  shape = 'sphere', 'box'  centre_x = 1, 3  centre_y = 1, 1  radius = 0.2  length_x(2) = 0.4  length_y(2) = 0.4
         material = 'upper', 'lower' /
&region  condition = 'x > 3.9'  temperature = '3000' /
)";
  read_regions r(text);
  std::ostringstream resolved;
  r.schema.write_resolved(resolved);
  read_regions again(resolved.str());
  BOOST_TEST(again.regions.size() == 4U);
  for (const auto& [x, y] : {std::pair{0.1, 0.1}, {1.1, 1.0}, {3.1, 1.0}, {3.95, 1.0}}) {
    BOOST_TEST(*again.at(x, y).temperature == *r.at(x, y).temperature);
    BOOST_TEST(*again.at(x, y).material == *r.at(x, y).material);
  }
  BOOST_TEST(*r.at(3.95, 1.0).temperature == 3000.0);
  // --set counts the pieces of all groups.
  read_regions changed(text, 2, "region.material(2)='lower'");
  BOOST_TEST(*changed.at(1.1, 1.0).material == 0);
}

BOOST_AUTO_TEST_CASE(shapes_in_three_dimensions) {
  read_regions r(
      "&region shape = 'cylinder' radius = 0.3 height = 0.4 centre_x = 1 centre_y = 1 centre_z = 0.5 "
      "material = 'upper' velocity_z = '-z' /",
      3);
  BOOST_TEST(*r.at(1.2, 1.0, 0.6).velocity[2] == -0.6);
  BOOST_TEST(!r.at(1.2, 1.0, 0.8).material.has_value());
}

BOOST_AUTO_TEST_CASE(what_is_refused) {
  expect_told("&region temperature = '1500 + foo*x' /",
              {"start.nml:1", "&region temperature", "region 1", "foo", "length_x"});
  expect_told("&region temperature = '1500 +' /", {"start.nml:1", "&region temperature"});
  expect_told("&region temperature = 1 condition = 'x > 1 and y > 2' /", {"&region condition", "&& (and)"});
  expect_told("&region temperature = '1500 + x**2' /", {"&region temperature", "^ (power)"});
  expect_told("&region temperature = '-1500 + x' /",
              {"start.nml:1", "region 1", "temperature is -1500 K", "(0, 0, 0)"});
  expect_told("&region temperature = '1/x' /", {"its temperature is inf K"});
  expect_told("&region temperature = 'x, y' /", {"several values"});
  expect_told("&region material = 'iron' /", {"&region material", "'upper'"});
  expect_told("&region shape = 'sphere' radius = 1 /", {"says nothing"});
  expect_told("&region shape = 'sphere' material = 'upper' /", {"&region radius", "above 0", "region 1"});
  expect_told("&region material = 'upper' radius = 2 /", {"&region radius", "this shape has none"});
  expect_told("&region velocity_z = 1 /", {"&region velocity_z", "no z"});
  expect_told("&region temperature = hot /", {"&region temperature", "in quotes"});
  expect_told("&constants name = 'x' value = 1 /\n&region temperature = 1 /", {"&constants name", "meaning already"});
  expect_told("&constants name = 'a', 'b' value = 1 /\n&region temperature = 1 /", {"2 names and 1 values"});
  expect_told("&region temperature = 1 /\n&constants name = 'a' value = 1 /\n&constants name = 'a' value = 1 /",
              {"group &constants was given before"});
  read_regions r("&region shape = 'sphere' radius = 1e-3 material = 'upper' /");
  std::vector<std::int64_t> counts;
  r.regions.at({1.0, 1.0, 0.0}, 0.0, counts);
  BOOST_CHECK_EXCEPTION(r.regions.expect_used(counts), foundation::error, [](const auto& e) {
    return std::string(e.what()).find("no particle of the start lies in it") != std::string::npos;
  });
}

// Further materials of the input are known once it is read.
BOOST_AUTO_TEST_CASE(materials_of_the_input) {
  auto of_input = liquids;
  of_input.more_materials = true;
  options o;
  namelist::schema schema;
  declare(schema, of_input, o);
  schema.read(namelist::parse_text("&region material = 'lower' /\n&region material = 'Crust' /\n", "start.nml"));
  const auto made = [&] { return all(schema, of_input, o, 2, {4.0, 2.0, 0.0}, 0.1); };
  try {
    made();
    BOOST_ERROR("a material that nobody knows");
  } catch (const foundation::error& e) {
    const std::string what = e.what();
    BOOST_TEST(what.starts_with("start.nml:2: &region material"));
    BOOST_TEST(what.find("no material 'Crust'") != std::string::npos);
  }
  of_input.materials.emplace_back("crust");
  const auto regions = made();
  BOOST_TEST(regions.give_material(2));
  BOOST_TEST(!regions.give_material(1));
}
