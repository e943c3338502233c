// Forms in which STL files are met: each is the same cube, or refused with line or facet.
#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <cstring>
#include <foundation/error.hpp>
#include <functional>
#include <limits>

#include "stl.hpp"

using namespace tetsuame;
using namespace tetsuame::solids;

namespace {

std::string replaced(std::string text, const std::string& what, const std::string& by, bool all = true) {
  for (std::size_t at = text.find(what); at != std::string::npos;
       at = all ? text.find(what, at + by.size()) : text.npos)
    text.replace(at, what.size(), by);
  return text;
}

std::string upper(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c; });
  return text;
}

const std::string text = ascii(cube()), bytes = binary(cube());

// Bytes of a value, at a place of the binary file.
template <class T>
std::string with(std::size_t at, T value) {
  auto all = bytes;
  std::memcpy(all.data() + at, &value, sizeof value);
  return all;
}
constexpr std::size_t facet_at(std::size_t n, std::size_t corner = 0, std::size_t axis = 0) {
  return 84 + 50 * (n - 1) + 12 * (corner + 1) + 4 * axis;
}

triangles changed(const std::function<void(triangles&)>& change) {
  auto all = cube();
  change(all);
  return all;
}

// Each facet with corners of its own, as far from the cube's as said.
triangles torn(double distance) {
  triangles all;
  const auto of = cube();
  for (std::size_t t = 0; t < of.corners.size(); ++t) {
    std::array<std::uint32_t, 3> own;
    for (std::size_t k = 0; k < 3; ++k) {
      own[k] = static_cast<std::uint32_t>(all.points.size());
      auto p = of.points[of.corners[t][k]];
      p[(t + k) % 3] += t % 2 == 0 ? distance : 0.0;
      all.points.push_back(p);
    }
    all.corners.push_back(own);
  }
  return all;
}

// A facet of two equal corners, and one between three points of a line, which are no error where they join.
triangles with_slit() {
  return changed([](triangles& c) { c.corners.insert(c.corners.begin() + 2, {1, 1, 3}); });
}

std::string two_solids(const std::string& between) {
  // The first six facets in one solid, the others in another.
  const std::size_t at = [] {
    std::size_t found = 0;
    for (int k = 0; k < 6; ++k) found = text.find("endfacet\n", found) + 9;
    return found;
  }();
  return text.substr(0, at) + between + text.substr(at);
}

struct form {
  std::string name, bytes;
  std::string refused = {};  // part of the message; empty: the cube
};

std::vector<form> forms() {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN(), infinite = std::numeric_limits<float>::infinity();
  return {
      {"text", text},
      {"binary", bytes},
      {"upper case", upper(text)},
      {"mixed case", replaced(replaced(text, "facet", "Facet"), "vertex", "VERTEX")},
      {"byte order mark", "\xef\xbb\xbf" + text},
      {"CRLF", replaced(text, "\n", "\r\n")},
      {"CR", replaced(text, "\n", "\r")},
      {"tabs", replaced(replaced(text, "  ", "\t"), "vertex ", "vertex\t")},
      {"no indentation", replaced(text, "  ", "")},
      {"in one line", replaced(replaced(text, "solid written\n", "solid written "), "\n", " ")},
      {"empty name", replaced(text, " written", "")},
      {"long name", replaced(text, "solid written", "solid a cube, of one facet or more; normal (1)", false)},
      {"name in UTF-8", replaced(text, "written", "鉄雨 é")},
      {"other name at the end", replaced(text, "endsolid written", "endsolid something else")},
      {"empty lines", replaced(text, "\n", "\n\n")},
      {"blank lines before and behind", "\n  \n" + text + "\n\n \n"},
      {"no end of line at the end", text.substr(0, text.size() - 1)},
      {"exponents", replaced(replaced(text, "vertex 1", "vertex 1.0E+00"), "vertex 0", "vertex 0.0000e+000")},
      {"signs", replaced(text, "vertex 1", "vertex +1.")},
      {"Fortran's exponents", replaced(text, "vertex 1", "vertex 1D0")},
      {"minus zero", replaced(text, "vertex 0", "vertex -0.0")},
      {"normals that are none", replaced(text, "normal 0 0 0", "normal nan -nan(ind) 1.#IND")},
      {"wrong normals", replaced(text, "normal 0 0 0", "normal 1 0 0")},
      {"two solids", two_solids("endsolid written\nsolid second\n")},
      {"two solids without names", two_solids("endsolid\n\nsolid\n")},
      {"an empty solid", "solid nothing\nendsolid nothing\n" + text},
      {"binary: head begins with solid", with(0, std::array{'s', 'o', 'l', 'i', 'd', ' '})},
      {"binary: attribute bytes", with(84 + 48, std::uint16_t{0x7fff})},
      {"binary: colours in the head", with(0, std::array{'C', 'O', 'L', 'O', 'R', '=', '\1', '\2', '\3', '\4'})},
      {"binary: zeros behind the last facet", bytes + std::string(34, '\0')},
      {"binary: normals of nan", with(84, nan)},
      {"corners 1e-7 apart", ascii(torn(1e-7))},
      {"binary: corners 1e-7 apart", binary(torn(1e-7))},
      {"a facet of two equal corners", ascii(with_slit())},
      {"no STL: nothing", "", "is no STL file"},
      {"no STL: text", "this is no solid\n", "is no STL file: it begins with another word than 'solid'"},
      {"no STL: OFF", replaced(text, "solid written", "OFF", false), "is no STL file"},
      {"no facets", "solid of nothing\nendsolid\n", "holds no facets"},
      {"binary: no facets", bytes.substr(0, 80) + std::string(4, '\0'), "holds no facets"},
      {"text broken off in a number", text.substr(0, text.find("vertex", 400) + 9),
       "facet 4: expected a finite number"},
      {"text broken off in a facet", text.substr(0, text.find("endloop", 400)),
       "facet 4: expected 'endloop', and the file ends: it is broken off"},
      {"text broken off between facets", text.substr(0, text.find("  facet", 400)),
       "expected 'endsolid', and the file ends: it is broken off"},
      {"binary broken off", bytes.substr(0, 300), "its head tells of 12 facets, and it ends within facet 5"},
      {"binary: head broken off", bytes.substr(0, 82), "cube.stl: is no STL file"},
      {"binary: bytes behind the last facet", bytes + "more", "4 bytes follow the 12 facets"},
      {"binary: count too large", with(80, std::uint32_t{4000000000U}), "its head tells of 4000000000 facets"},
      {"text: nan", replaced(text, "vertex 1 0 0", "vertex 1 nan 0", false),
       "cube.stl:13: facet 2: expected a finite number, found 'nan'"},
      {"text: a word", replaced(text, "vertex 1 0 0", "vertex 1 O 0", false),
       "facet 2: expected a finite number, found 'O'"},
      {"text: two coordinates", replaced(text, "vertex 1 0 0", "vertex 1 0", false),
       "facet 2: expected a finite number"},
      {"text: a decimal comma", replaced(text, "vertex 1 0 0", "vertex 1,0 0 0", false), "found '1,0'"},
      {"text: four corners", replaced(text, "    endloop", "      vertex 0 0 0\n    endloop", false),
       "facet 1 has more than three corners"},
      {"text: two corners", replaced(text, "      vertex 1 0 0\n", "", false),
       "facet 2: expected 'vertex', found 'endloop'"},
      {"binary: nan", with(facet_at(3, 1, 2), nan), "facet 3: a coordinate of corner 2 is nan, not a finite number"},
      {"binary: infinite", with(facet_at(12, 2, 0), infinite), "facet 12: a coordinate of corner 3 is inf"},
      {"a hole", ascii(changed([](triangles& c) { c.corners.pop_back(); })), "the surface has a hole"},
      {"corners 1e-3 apart", ascii(torn(1e-3)), "the surface has a hole"},
      {"a facet twice", ascii(changed([](triangles& c) { c.corners.push_back(c.corners.front()); })),
       "3 triangles meet at the edge"},
      {"all facets twice", two_solids("endsolid\n" + text + "solid\n"), "4 triangles meet at the edge"},
      {"a facet turned", binary(changed([](triangles& c) { std::swap(c.corners[4][0], c.corners[4][1]); })),
       "the first of facet 5"},
      {"all facets turned", ascii(changed([](triangles& c) {
         for (auto& t : c.corners) std::swap(t[0], t[1]);
       })),
       "normals point inwards"},
      {"a facet without an area", ascii(changed([](triangles& c) {
         c.points.push_back({0.5, 0.0, 0.0});
         c.corners.push_back({0, 8, 1});
       })),
       "facet 13 has no area"},
      {"a wall within", ascii(changed([](triangles& c) {
         c.corners.push_back({0, 7, 5});
       })),
       "triangles meet at the edge"},
      {"far corners", replaced(text, "vertex 1", "vertex 1e300"),
       "facet 1: a corner is at 1e+300; expected: at most 1e+12"},
  };
}

std::string told(const form& f, triangles& read) {
  try {
    read = read_stl(f.bytes, "cube.stl");
    expect_closed(read, "cube.stl");
  } catch (const foundation::error& e) {
    return e.status() == foundation::exit_status::bad_input ? e.what() : "wrong status";
  }
  return "no error";
}

}  // namespace

BOOST_AUTO_TEST_CASE(forms_of_stl) {
  const auto all = forms();
  BOOST_TEST(all.size() >= 40U);
  for (const auto& f : all) BOOST_TEST_CONTEXT(f.name) {
      triangles read;
      const auto message = told(f, read);
      if (!f.refused.empty()) {
        BOOST_TEST(message.find(f.refused) != std::string::npos, message);
        continue;
      }
      BOOST_TEST(message == "no error");
      const auto exact = cube();
      BOOST_TEST_REQUIRE((read.points.size() == 8U && read.corners.size() == 12U));
      double difference = 0.0;
      for (std::size_t t = 0; t < 12; ++t)
        for (std::size_t k = 0; k < 3; ++k)
          for (std::size_t a = 0; a < 3; ++a)
            difference = std::max(difference,
                                  std::abs(read.points[read.corners[t][k]][a] - exact.points[exact.corners[t][k]][a]));
      BOOST_TEST(difference <= 2e-7);
    }
}
