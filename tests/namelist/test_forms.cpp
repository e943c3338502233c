// Forms in which namelists are met: each is read with the values that a Fortran compiler takes from it, or refused at
// its line.
#include <boost/test/unit_test.hpp>
#include <string>
#include <vector>

#include "message.hpp"
#include "sample.hpp"

using namespace tetsuame;

namespace {

struct form {
  std::string text;
  std::string refused = {};  // what the message begins with; empty: r, i, flag and s are 2.5e-4, 7, true and "a b"
};

const std::string lost = " stands behind the end of group &sample and would be lost";
const std::string outside = " stands outside of all groups and would be lost";

const std::vector<form> forms = {
    {"&sample r=2.5e-4 i=7 flag=T s='a b' /\n"},
    {"&SAMPLE R=2.5E-4, I=7, FLAG=.TRUE., S=\"a b\" /\n"},
    {"&sample\n  r = 2.5d-4\n  i = +7\n  flag = .t.\n  s = 'a b'\n/\n"},
    {"\xef\xbb\xbf&sample\r\n r = .25e-3\r\n i = 7\r\n flag = true\r\n s = 'a b'\r\n/\r\n\r\n"},
    {"&sample\rr=2.5-4\ri=7\rflag=T\rs='a b'\r/\r"},
    {"$sample r=00.00025 i=007 flag=t s='a b' $end\n"},
    {"&sample r=2.5e-4 i=7 flag=T s='a b' &end\n"},
    {"&sample r=2.5e-4; i=7; flag=T; s='a b' /\n"},
    {"&sample\tr=2.5e-4\ti=7\tflag=T\ts='a b'\t/\n"},
    {"&sample r=1 r=2.5e-4 i=7 flag=T s='a b' /\n"},
    {"&sample ! r=1 /\n r=2.5e-4 ! /\n i=7 flag=T s='a b' / ! r=3\n"},
    {"&sample r=\n2.5e-4,\n\n i=\n7 flag=T s='a\n b' /"},
    {"&sample r=1*2.5e-4 i=1*7 flag=1*T s=1*'a b' /\n"},
    {"&sample r=2.5e-4,,, i=7, flag=T, s='a b',, /\n"},
    {"&sample r=2.5e-4 r= i=7 i=,flag=T s='a b' /\n"},
    {"! r = 3\n\n  &sample r=2.5e-4 i=7 flag=T s='a b' /\n! i = 4\n"},
    {"an input of water\n&sample r=2.5e-4 i=7 flag=T s='a b' /\nthe end\n"},
    {"&sample r=2.5e-4 i=7 flag=T s='a b' /"},
    {"&sample r=2.5e-4 i=7 flag=T s='a b'/! the end"},
    {"&sample r=2.5e-4 i=7 flag=T s='a b' /   \t\r\n\n"},
    {"&sample r = 1/4000 i=7 /\n", "f:1: '4000 i=7 /'" + lost},
    {"&sample r = 1.0  / box\n i = 7\n/\n", "f:1: 'box'" + lost},
    {"&sample\n s = data/file\n i = 7\n/\n", "f:2: 'file'" + lost},
    {"&sample r=1 /, i=7 /\n", "f:1: ', i=7 /'" + lost},
    {"&sample r=1 &end i=7\n", "f:1: 'i=7'" + lost},
    {"&sample r=1 //\n", "f:1: '/'" + lost},
    {"&sample r=1 / # a comment of a shell\n", "f:1: '# a comment of a shell'" + lost},
    {"&sample r=1 /\n i = 7\n/\n", "f:2: 'i = 7'" + outside},
    {"sample\n i = 7\n/\n&sample r=1 /\n", "f:2: 'i = 7'" + outside},
    {"&sample r=1 /\nother i=7 /\n", "f:2: 'other i=7 /'" + outside},
    {"#i = 7\n&sample r=1 /\n", "f:1: '#i = 7'" + outside},
    {"! a comment\r&sample r=1 /\n", "f:1: a comment goes on behind a carriage return"},
    {"& sample r=1 /\n", "f:1: expected the name of a group directly behind &"},
    {"&sample=1 /\n", "f:1: expected a blank behind the name of group &sample"},
    {"&sample r=1\n", "f:2: group &sample, opened in line 1, is not closed"},
    {"&sample r=1\n&other /\n", "f:2: group &sample, opened in line 1, is not closed"},
    {"&sample r=1 /\n&sample i=7 /\n", "f:2: group &sample was given before, in line 1"},
    {"&sample\n s = 'a b\n/\n", "f:2: the text 'a b/ has no closing quote"},
    {"&sample r = 0,5 /\n", "f:1: &sample r: takes a single value, found a second, 5"},
    {"&sample r = 2.5e-4m /\n", "f:1: &sample r: expected a real number, found 2.5e-4m"},
    {"&sample i = 7.0 /\n", "f:1: &sample i: expected an integer, found 7.0"},
    {"&sample flag = 1 /\n", "f:1: &sample flag: expected a logical"},
    {"&sample r : 1 /\n", "f:1: expected = after 'r'"},
    {"sample: r: 1\n", "f:2: the input has no group (&name ... /)"},
    {"{\"sample\": {\"r\": 1}}\n", "f:2: the input has no group (&name ... /)"},
    {"\x89HDF\r\n\x1a\n", "f: is an HDF5 file, where a namelist is expected"},
    {std::string("&sample r=1 /\n\0\0", 16), "f: is a binary file"},
    {std::string("\xff\xfe&\0s\0", 6), "f: is text in UTF-16"},
};

}  // namespace

BOOST_AUTO_TEST_CASE(forms_of_namelists) {
  BOOST_TEST(forms.size() >= 40U);
  for (const auto& f : forms) {
    sample values;
    const auto told = message([&] { schema_of(values).read(namelist::parse_text(f.text, "f")); });
    if (f.refused.empty()) {
      BOOST_TEST(told == "no error", f.text << told);
      BOOST_TEST((values.r == 2.5e-4 && values.i == 7 && values.flag && values.s == "a b"), f.text);
    } else {
      BOOST_TEST(told.starts_with(f.refused), f.text << told);
    }
  }
}
