#include <boost/test/unit_test.hpp>
#include <filesystem>
#include <foundation/error.hpp>
#include <fstream>
#include <namelist/document.hpp>

#include "message.hpp"

using namespace tetsuame;
using kind = namelist::value::kind;

namespace {

std::vector<namelist::value> values_of(const std::string& list) {
  const auto d = namelist::parse_text("&a x = " + list + "\n/\n", "text");
  return d.groups().at(0).assignments.at(0).values;
}

std::vector<std::string> words_of(const std::string& list) {
  std::vector<std::string> result;
  for (const auto& v : values_of(list)) result.push_back(v.what == kind::null ? "null" : v.content);
  return result;
}

using words = std::vector<std::string>;

}  // namespace

BOOST_AUTO_TEST_CASE(lines_are_kept) {
  const auto d = namelist::parse_text(
      "\xef\xbb\xbf! a\r\n\r\n&One\r\n x = 1, ! b\r\n  2\r\n Y(2:3) = 'p\r\nq' 3*7 &end\n$two $END", "f.nml");
  BOOST_REQUIRE_EQUAL(d.groups().size(), 2U);
  const auto& one = d.groups()[0];
  BOOST_TEST(one.name == "one");
  BOOST_TEST(one.line == 3U);
  BOOST_TEST(one.assignments.at(0).values.at(1).line == 5U);
  const auto& y = one.assignments.at(1);
  BOOST_TEST(y.key == "y");
  BOOST_TEST((y.index && y.index->section && y.index->first == 2 && y.index->last == 3));
  BOOST_TEST(y.values.at(0).content == "pq");
  BOOST_TEST(y.values.at(1).line == 7U);
  BOOST_TEST(y.values.at(1).repeat == 3U);
  BOOST_TEST(d.where(y) == "f.nml:6");
  BOOST_TEST(d.where(y, y.values.at(1)) == "f.nml:7");
  BOOST_TEST(d.groups()[1].line == 8U);
}

// The standard's reading, where gfortran 12 has another (see the cases marked "standard").
BOOST_AUTO_TEST_CASE(comments_and_commas_at_line_ends) {
  BOOST_TEST(words_of("1, ! first\n 2, ! second\n 3") == (words{"1", "2", "3"}), boost::test_tools::per_element());
  BOOST_TEST(words_of("1\n , 2\n , 3") == (words{"1", "2", "3"}), boost::test_tools::per_element());
  BOOST_TEST(words_of("1,\n,3") == (words{"1", "null", "3"}), boost::test_tools::per_element());
  BOOST_TEST(words_of("\n,2") == (words{"null", "2"}), boost::test_tools::per_element());
  BOOST_TEST(words_of("1,,") == (words{"1", "null"}), boost::test_tools::per_element());
}

BOOST_AUTO_TEST_CASE(overrides) {
  auto d = namelist::parse_text("&time dt = 1 /", "f.nml");
  d.set("Time.Method=newton");
  d.set("new.path=/data/a!b;c&d=e/it's");
  d.set("new.list(2)=1, 2*'x y' ,3");
  const auto& method = d.groups().at(0).assignments.at(1);
  BOOST_TEST(method.key == "method");
  BOOST_TEST(method.values.at(0).content == "newton");
  BOOST_TEST(d.where(method) == "--set Time.Method=newton");
  const auto& added = d.groups().at(1);
  BOOST_TEST(added.name == "new");
  BOOST_TEST(added.assignments.at(0).values.at(0).content == "/data/a!b;c&d=e/it's");
  const auto& list = added.assignments.at(1).values;
  BOOST_REQUIRE_EQUAL(list.size(), 3U);
  BOOST_TEST((list[1].repeat == 2U && list[1].content == "x y" && list[1].what == kind::text));
  BOOST_TEST((added.assignments.at(1).index && !added.assignments.at(1).index->section));
}

BOOST_AUTO_TEST_CASE(wrong_overrides) {
  for (const char* argument : {"", "dt", "dt=1", "time", "time.", "time.=1", ".dt=1", "time dt=1", "time.2=1"}) {
    namelist::document d;
    BOOST_TEST(message([&] { d.set(argument); }) ==
               std::string("--set ") + argument + ": expected --set group.key=value");
  }
  namelist::document d;
  BOOST_TEST(message([&] { d.set("time.dt"); }) == "--set time.dt: expected = after 'dt'");
  BOOST_TEST(message([&] { d.set("a.b="); }) == "--set a.b=: expected a value after =; an empty text is written ''");
  BOOST_TEST(message([&] { d.set("a.b='x"); }) == "--set a.b='x: the text 'x has no closing quote");
}

BOOST_AUTO_TEST_CASE(syntax_errors) {
  const auto told = [](const std::string& text) { return message([&] { namelist::parse_text(text, "f"); }); };
  BOOST_TEST(told("&a x=1\n") == "f:2: group &a, opened in line 1, is not closed: expected / at its end");
  BOOST_TEST(told("&a x=1\n&b y=2 /") == "f:2: group &a, opened in line 1, is not closed: expected / before '&b'");
  BOOST_TEST(told("&a /\n\n&A /") == "f:3: group &a was given before, in line 1");
  BOOST_TEST(told("&a\n x 1 /") == "f:2: expected = after 'x'");
  BOOST_TEST(told("&a\n 3 /") == "f:2: expected 'key = value', found '3'");
  BOOST_TEST(told("&a = 3 /") == "f:1: expected 'key = value', found '='");
  BOOST_TEST(told("&a x == 3 /") == "f:1: 'x': misplaced = after ''");
  BOOST_TEST(told("&a x = 3 = 4 /") == "f:1: 'x': misplaced = after ''");
  BOOST_TEST(told("&a x = 1y=2 /") == "f:1: 'x': misplaced = after '1y'");
  BOOST_TEST(told("&a x = 'b\n\n/") == "f:1: the text 'b/ has no closing quote");
  BOOST_TEST(told("&a x = 'b'c=2 /") == "f:1: 'x': expected a blank or a comma after the closing quote, found 'c'");
  BOOST_TEST(told("&a x = 0*1 /") == "f:1: 'x': a repeat count must be at least 1");
  BOOST_TEST(told("&a x = 99999999999999999999*1 /") == "f:1: 'x': the repeat count is too large");
  BOOST_TEST(told("&a x() = 1 /") == "f:1: 'x': expected a subscript such as (2) or (1:3)");
  BOOST_TEST(told("&a x(1:3:0) = 1 /") == "f:1: 'x': expected a stride other than 0");
  BOOST_TEST(told("&a x(2,1) = 1 /") == "f:1: 'x': expected ) after the subscript; arrays here have one dimension");
  BOOST_TEST(told("&a x(n) = 1 /") == "f:1: 'x': expected an integer as subscript");
  BOOST_TEST(told("&a x(99999999999999) = 1 /") == "f:1: 'x': '99999999999999' is no subscript");
  BOOST_TEST(told("&a x%y = 1 /") == "f:1: 'x%': keys here have no components");
  BOOST_TEST(told("&a x(1)(2:3) = 'b' /") ==
             "f:1: 'x': expected = after the subscript (substrings and components are not read)");
  BOOST_TEST(told("&a x = 3&end") == "f:1: expected a blank before & or $ in '3&end'");
  BOOST_TEST(told("& a x = 3 /") == "f:1: expected the name of a group directly behind &");
  BOOST_TEST(told("&a=3 /") == "f:1: expected a blank behind the name of group &a");
  const std::string lost =
      " and would be lost: a / closes the group unless it is in quotes (write numbers out, not as "
      "1/4), and a comment begins with !";
  BOOST_TEST(told("&a x = 1/4000\n y = 2 /") == "f:1: '4000' stands behind the end of group &a" + lost);
  BOOST_TEST(told("&a\n x = 1.0   / box ! of water\n y = 2 /") ==
             "f:2: 'box' stands behind the end of group &a" + lost);
  BOOST_TEST(told("&a x = 1 &end,\n") == "f:1: ',' stands behind the end of group &a" + lost);
  const std::string outside =
      " stands outside of all groups and would be lost: a group begins with & and its name, and "
      "ends with /";
  BOOST_TEST(told("&a /\nflow\n high_y = 0.5\n/\n&b /") == "f:3: 'high_y = 0.5'" + outside);
  BOOST_TEST(told("flow high_y=0.5 /\n&a /") == "f:1: 'flow high_y=0.5 /'" + outside);
  BOOST_TEST(told("&a /\n\n x = 3 ! y\n") == "f:3: 'x = 3'" + outside);
  BOOST_TEST(told("! one\r&a x = 3 /\n") ==
             "f:1: a comment goes on behind a carriage return, and would swallow the next line: end lines with a line "
             "feed");
  BOOST_TEST(told("\x89HDF\r\n\x1a\n").starts_with("f: is an HDF5 file, where a namelist is expected"));
  BOOST_TEST(told("tetsuame checkpoint 1 ").starts_with("f: is an HDF5 file, where a namelist is expected"));
  BOOST_TEST(told("\xff\xfe&") == "f: is text in UTF-16: save it as UTF-8 or ASCII");
  BOOST_TEST(told(std::string("&a x = \0 /", 11)) == "f: is a binary file, where a namelist is expected");
  BOOST_TEST(told("time step: 3\n") == "f:2: the input has no group (&name ... /): is this a namelist file?");
  BOOST_TEST(told("&a " + std::string(64, 'k') + " = 1 /") ==
             "f:1: the name '" + std::string(40, 'k') + "...' has more than 63 letters");
}

BOOST_AUTO_TEST_CASE(text_between_groups) {
  const auto d =
      namelist::parse_text("R&D(1) costs $5 & more\n&a /\n  b is 2 'x\n ! &c / x = 3\n&end\n&d / $e $end", "f");
  BOOST_REQUIRE_EQUAL(d.groups().size(), 3U);
  BOOST_TEST(d.groups()[0].name == "a");
  BOOST_TEST(d.groups()[2].name == "e");
}

BOOST_AUTO_TEST_CASE(a_text_without_a_group_is_no_input) {
  for (const char* text : {"", " \n\t\n", "! only a comment", "time%steps = 3", "\x7f\x45\x4c\x46\x02"})
    BOOST_TEST(message([&] { namelist::parse_text(text, "f"); }).find("the input has no group") != std::string::npos);
  BOOST_TEST(namelist::document("f").groups().empty());
}

BOOST_AUTO_TEST_CASE(sizes_are_bounded) {
  const auto told = [](const std::string& text) { return message([&] { namelist::parse_text(text, "f"); }); };
  const std::string many = "f:1: more than 262144 groups, keys and values";
  BOOST_TEST(told("&a x = " + std::string(1000000, ',')) == many);
  std::string keys = "&a ";
  for (int k = 0; k < 300000; ++k) keys += "x= ";
  BOOST_TEST(told(keys) == many);
  BOOST_TEST(told(std::string(namelist::maximum_bytes + 1, ' ')) ==
             "f:1: longer than 16777216 bytes: this is no input");
  BOOST_TEST(told("&a x = " + std::string(1000000, '(')) ==
             "f:1: group &a, opened in line 1, is not closed: expected / at its end");
  // A huge repeat count takes no room: it is one value.
  BOOST_TEST(values_of("999999999*1").at(0).repeat == 999999999U);
}

BOOST_AUTO_TEST_CASE(files) {
  const std::filesystem::path folder = std::filesystem::path(TETSUAME_BINARY_DIR) / "tests";
  const auto path = folder / "namelist_file.nml";
  std::ofstream(path) << "&a\n x = 3 /\n";
  const auto d = namelist::parse_file(path);
  BOOST_TEST(d.where(d.groups().at(0).assignments.at(0)) == path.string() + ":2");
  const std::string absent = (folder / "absent.nml").string();
  BOOST_TEST(message([&] { namelist::parse_file(absent); }) ==
             absent + ": the input file cannot be opened: is the path right?");
  BOOST_TEST(message([&] { namelist::parse_file(folder); }) ==
             folder.string() + ": is a directory, not a namelist file");
  BOOST_TEST(message([&] { namelist::parse_file("/dev/zero"); }) ==
             "/dev/zero:1: longer than 16777216 bytes: this is no input");
}
