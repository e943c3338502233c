// Forms in which tables are met: each is read with the same values, or refused with line and column.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <filesystem>
#include <foundation/error.hpp>
#include <fstream>
#include <string>
#include <tables/cells.hpp>
#include <tables/table.hpp>
#include <vector>

using namespace tetsuame;
using tables::table;

namespace {

template <class Action>
std::string message(const Action& action) {
  try {
    action();
  } catch (const foundation::error& e) {
    return e.status() == foundation::exit_status::bad_input ? e.what() : "wrong status";
  }
  return "no error";
}

struct form {
  std::string text;
  std::string refused = {};  // what the message begins with; empty: columns t and h are 0, 0.1, 0.2 and 0.2, -0.3, 400
};

const std::vector<form> forms = {
    {"t,h\n0,0.2\n0.1,-0.3\n0.2,400\n"},
    {"\xef\xbb\xbft,h\n0,0.2\n0.1,-0.3\n0.2,400\n"},
    {"t,h\r\n0,0.2\r\n0.1,-0.3\r\n0.2,400\r\n\r\n"},
    {"t,h\r0,0.2\r0.1,-0.3\r0.2,400\r"},
    {"t,h\n0,0.2\n0.1,-0.3\n0.2,400"},
    {"t;h\n0;0.2\n0.1;-0.3\n0.2;400\n"},
    {"t\th\n0\t0.2\n0.1\t-0.3\n0.2\t400\n"},
    {"t h\n0 0.2\n0.1 -0.3\n0.2 400\n"},
    {"  t     h\n  0.0   0.2\n  0.1  -0.3\n  0.2 \t400  \n"},
    {"t, h\n 0 , 0.2 \n0.1 ,-0.3\n\t0.2,\t400\n"},
    {"\"t\",\"h\"\n\"0\",\"0.2\"\n\"0.1\",\"-0.3\"\n\"0.2\",\"400\"\n"},
    {"'t' 'h'\n0 0.2\n0.1 -0.3\n0.2 400\n"},
    {"\"t\";\"h\"\r\n0;0.2\r\n0.1;-0.3\r\n0.2;400\r\n;\r\n;\r\n"},
    {"# measured\n# by hand\nt,h\n0,0.2\n# a pause\n0.1,-0.3\n\n0.2,400\n"},
    {"! measured\n% by hand\n  # so\nt,h\n0,0.2\n0.1,-0.3\n0.2,400\n"},
    {"t,h\n0,0.2 # the start\n0.1,-0.3#\n0.2,400 # the end, or so\n"},
    {"t,h\n+0,+0.2\n+.1,-3D-1\n2d-1,4E2\n"},
    {"t,h\n0.,.2\n1e-1,-0.3e0\n0.2,0.4d+3\n"},
    {"t,h\n0q0,0.2Q0\n0.1,-0.3\n0.2,400\n"},
    {"t,h\ns,m\n0,0.2\n0.1,-0.3\n0.2,400\n"},
    {"t,h\n[s],[m]\n0,0.2\n0.1,-0.3\n0.2,400\n"},
    {"\"t\",\"h\"\n\"(s)\",\"(m)\"\n0,0.2\n0.1,-0.3\n0.2,400\n"},
    {"t,h\n-,-\n0,0.2\n0.1,-0.3\n0.2,400\n"},
    {"t,other,h\n0,nan,0.2\n0.1,NaN,-0.3\n0.2,inf,400\n"},
    {"t,other,h\n0,,0.2\n0.1,-,-0.3\n0.2,N/A,400\n"},
    {"t,h,other\n0,0.2,\n0.1,-0.3,\n0.2,400,good\n"},
    {"t,h,remark\n0,0.2,\"a, b\"\n0.1,-0.3,\"he said \"\"no\"\"\"\n0.2,400,''\n"},
    {"t,h,\n0,0.2,\n0.1,-0.3,\n0.2,400,\n"},
    {"h,t\n0.2,0\n-0.3,0.1\n400,0.2\n"},
    {"x,h,y,t\n9,0.2,9,0\n9,-0.3,9,0.1\n9,400,9,0.2\n"},
    {"h,\"one, two\",t\n0.2,9,0\n-0.3,9,0.1\n400,9,0.2\n"},
    {"t,h\n0,0.2\n0.1,-0.3\n0.2,400\n\n   \n\t\n,,\n"},
    {"t,h,,\n0,0.2,,\n0.1,-0.3,,\n0.2,400,,\n"},
    {"t;h;remark\n0;0.2;1,5\n0.1;-0.3;\n0.2;400;a,b\n"},
    {"t,h\n0,0.2\n0.1 -0.3\n0.2\t\t400\n"},
    {"t\th\n0\t0.2\n0.1\t \t-0.3\n0.2 400\n"},
    {"t,\th\n0,\t0.2\n0.1,\t-0.3\n0.2,\t400\n"},
    {"", "f: holds no line of numbers"},
    {"# only\n\n", "f: holds no line of numbers"},
    {"t,h\n", "f: holds no line of numbers"},
    {"t,t,h\n0,0,1\n", "f:1: columns 1 and 2 have the same name, 't'"},
    {"t,h,\"h\"\n0,0,1\n", "f:1: columns 2 and 3 have the same name, 'h'"},
    {"t,h\n0,0.2\n0.1\n", "f:3: expected 2 columns with commas between"},
    {"t,h\n0,0.2\n0.1,1,2\n", "f:3: expected 2 columns with commas between"},
    {"t (s) h (m)\n0 0.2\n", "f:2: expected 4 columns with blanks between"},
    {"t,h\n0,0.2\n0.1,x\n", "f:3: column 2 ('h'): expected a finite number, found 'x'"},
    {"t,h\n0,0.2\n0.1,nan\n", "f:3: column 2 ('h'): expected a finite number, found 'nan'"},
    {"t,h\n0,0.2\n0.1,\n", "f:3: column 2 ('h'): expected a number, found nothing"},
    {"t,h\n0,0.2\n0.1,1e999\n", "f:3: column 2 ('h'): expected a finite number, found '1e999'"},
    {"t,h\n0,0.2\n0.1,0x10\n", "f:3: column 2 ('h'): expected a finite number, found '0x10'"},
    {"t,h\n0,0.2\n0.1,2020-01\n", "f:3: column 2 ('h'): expected a finite number, found '2020-01'"},
    {"t;h\n0;0,2\n", "f:2: column 2 ('h'): expected a finite number, found '0,2': decimals stand behind a point"},
    {"t,h\n0,0.2\nnan,1\n", "f:3: column 1 ('t'): expected a finite number, found 'nan'"},
    {"t,h\n0,0.2\n0,1\n", "f:3: column 1 ('t'): time 0 does not lie behind that of the row before, 0"},
    {"t,h\n0.1,0.2\n0,1\n", "f:3: column 1 ('t'): time 0 does not lie behind"},
    {"t,h\ns,mm\n0,1\n", "f: column 2 ('h') is in mm, and is read in units of 1 m"},
    {"t,h [cm]\n0,1\n", "f: no column h"},
    {"t,h\ns,m\nof,x\n0,1\n", "f:3: expected numbers, found 'of,x'"},
    {"a wave\nt,h\n0,1\n", "f:2: expected numbers, or the units of 1 columns, found 't,h'"},
    {"t,\"h\n0,1\n", "f:1: a quote is not closed"},
    {"t,h\n0,\"1\n", "f:2: a quote is not closed"},
    {"0,0.2\n0.1,-0.3\n", "f: no column t"},
    {std::string("t,h\n0,1\n\0", 9), "f: is a binary file"},
    {"\x89HDF\r\n\x1a\n", "f: is an HDF5 file"},
    {std::string("\xff\xfet\0", 4), "f: is text in UTF-16"},
};

void read(const std::string& text, std::vector<double>& times, std::vector<double>& values) {
  const table of(text, "f");
  const auto t = of.column("t"), h = of.column("h");
  if (!t) of.fail("no column t");
  if (!h) of.fail("no column h");
  of.expect_unit(*t, "s", 1.0);
  of.expect_unit(*h, "m", 1.0);
  times = of.ascending(*t, "time");
  values = of.numbers(*h);
}

}  // namespace

BOOST_AUTO_TEST_CASE(forms_of_tables) {
  BOOST_TEST(forms.size() >= 40U);
  for (const auto& f : forms) {
    std::vector<double> times, values;
    const auto told = message([&] { read(f.text, times, values); });
    if (f.refused.empty()) {
      BOOST_TEST(told == "no error", f.text << told);
      BOOST_TEST((times == std::vector{0.0, 0.1, 0.2}), f.text);
      BOOST_TEST((values == std::vector{0.2, -0.3, 400.0}), f.text);
    } else {
      BOOST_TEST(told.starts_with(f.refused), f.text << told);
    }
  }
}

BOOST_AUTO_TEST_CASE(without_headings) {
  const table of("300 0 1e3\n300, 1 1e2\n", "f");
  BOOST_TEST(of.columns() == 3U);
}

BOOST_AUTO_TEST_CASE(headings_with_units) {
  const table of("Time [s];Depth (m);depth\n0;1;2\n", "f");
  BOOST_TEST(*of.column_of({"t", "time"}) == 0U);
  BOOST_TEST(!of.column_of({"x"}));
  BOOST_TEST(message([&] { of.column_of({"depth"}); }) == "f: columns 2 and 3 are both 'depth'");
  BOOST_CHECK_NO_THROW(of.expect_unit(1, "m", 1.0));
  BOOST_TEST(message([&] { of.expect_unit(1, "Pa", 1.0); }) ==
             "f: column 2 ('Depth (m)') is in m, and is read in units of 1 Pa");
  BOOST_CHECK_NO_THROW(table("t [ms],h\n0,1\n", "f").expect_unit(0, "s", 1e-3));
}

BOOST_AUTO_TEST_CASE(files) {
  const std::filesystem::path folder = TETSUAME_BINARY_DIR "/tests/tables_files";
  std::filesystem::create_directories(folder);
  const auto path = (folder / "a.csv").string(), absent = (folder / "absent.csv").string();
  std::ofstream(path) << "t,h\n0,x\n";
  BOOST_TEST(message([&] { table::read(path).numbers(1); }).starts_with(path + ":2: column 2 ('h')"));
  BOOST_TEST(message([&] { table::read(absent); }) == "there is no file " + absent);
  BOOST_TEST(message([&] { table::read(folder.string()); }) == folder.string() + " is a directory, not a file");
  BOOST_TEST(message([&] { table::read("/dev/zero"); }) == "/dev/zero is no plain file, but a pipe or a device");
}
