// Each kind of refused value, with the words the user reads.
#include <boost/test/unit_test.hpp>
#include <namelist/schema.hpp>

#include "message.hpp"

using namespace tetsuame;

namespace {

std::string told(const std::string& text, const std::vector<std::string>& overrides = {}) {
  double dt = 1.0, free = 0.0;
  std::int64_t steps = 1, seed = 1;
  bool restart = false;
  std::string method = "euler", title;
  std::optional<double> every;
  std::vector<double> times{1.0};
  std::vector<std::string> kinds;
  namelist::schema s;
  s.group("time", "");
  s.add("time", "dt", dt, {.unit = "s", .minimum = 0.0, .exclusive_minimum = true});
  s.add("time", "steps", steps, {.minimum = 0});
  s.add("time", "seed", seed);
  s.add("time", "restart", restart);
  s.add("time", "method", method, {.choices = {"euler", "adaptive"}});
  s.add("time", "title", title);
  s.group("output", "");
  s.add("output", "interval", every, {.maximum = 9});
  s.add("output", "times", times, {.minimum = 0.0, .maximum = 1.0, .maximum_size = 4});
  s.add("output", "kinds", kinds, {.choices = {"mean", "max"}});
  s.add("output", "free", free);
  return message([&] {
    auto input = text.empty() ? namelist::document("f") : namelist::parse_text(text, "f");
    for (const std::string& o : overrides) input.set(o);
    s.read(input);
  });
}

}  // namespace

BOOST_AUTO_TEST_CASE(unknown_names) {
  BOOST_TEST(told("&time\n metod = 'euler' /") == "f:2: &time: unknown key metod; the nearest valid key is method");
  BOOST_TEST(told("&time interval = 1 /").ends_with("; &output has a key of this name"));
  BOOST_TEST(told("\n&tmie dt = 1 /") == "f:2: unknown group &tmie; the nearest valid group is &time");
  BOOST_TEST(told("&time /", {"ouput.times=1"}) ==
             "--set ouput.times=1: unknown group &ouput; the nearest valid group is &output");
  BOOST_TEST(told("", {"time.stpes=1"}) ==
             "--set time.stpes=1: &time: unknown key stpes; the nearest valid key is steps");
}

BOOST_AUTO_TEST_CASE(wrong_types) {
  BOOST_TEST(told("&time dt = 'x' /") == "f:1: &time dt: expected a real number in s > 0, found the text 'x'");
  BOOST_TEST(told("&time dt =\n\n abc /") == "f:3: &time dt: expected a real number in s > 0, found abc");
  BOOST_TEST(told("&time dt = (1,2) /") == "f:1: &time dt: expected a real number in s > 0, found (1");
  BOOST_TEST(told("&time steps = 5.0 /") == "f:1: &time steps: expected an integer >= 0, found 5.0");
  BOOST_TEST(told("&time steps = 1e3 /") == "f:1: &time steps: expected an integer >= 0, found 1e3");
  BOOST_TEST(told("&time restart = 1 /") == "f:1: &time restart: expected a logical (.true. or .false.), found 1");
  BOOST_TEST(told("&time restart = 'T' /") ==
             "f:1: &time restart: expected a logical (.true. or .false.), found the text 'T'");
  BOOST_TEST(told("&time title = word /") ==
             "f:1: &time title: expected a text in quotes, found word; did you mean 'word'?");
  BOOST_TEST(
      told("&time method = adaptve /") ==
      "f:1: &time method: expected one of 'euler', 'adaptive' in quotes, found adaptve; did you mean 'adaptive'?");
  BOOST_TEST(told("", {"time.dt=abc"}) == "--set time.dt=abc: &time dt: expected a real number in s > 0, found abc");
}

BOOST_AUTO_TEST_CASE(out_of_range) {
  BOOST_TEST(told("&time dt = 0 /") == "f:1: &time dt: expected a real number in s > 0, found 0");
  BOOST_TEST(told("&time dt = nan /") ==
             "f:1: &time dt: expected a real number in s > 0, found nan, which is not finite");
  BOOST_TEST(told("&output free = 1e999 /") ==
             "f:1: &output free: expected a real number, found 1e999, which is not finite");
  BOOST_TEST(told("&time steps = -1 /") == "f:1: &time steps: expected an integer >= 0, found -1");
  BOOST_TEST(told("&time seed = 9223372036854775808 /") ==
             "f:1: &time seed: expected an integer, found 9223372036854775808, which 64 bits cannot hold");
  BOOST_TEST(told("&output interval = 10 /") == "f:1: &output interval: expected a real number <= 9, found 10");
  BOOST_TEST(told("&output times = 0, 2 /") == "f:1: &output times: expected a real number in [0, 1], found 2");
  BOOST_TEST(told("&time method = 'eluer' /") ==
             "f:1: &time method: expected one of 'euler', 'adaptive', found 'eluer'; the nearest is 'euler'");
  BOOST_TEST(told("&output kinds = 'mean', 'mix' /") ==
             "f:1: &output kinds: expected one of 'mean', 'max', found 'mix'; the nearest is 'max'");
}

BOOST_AUTO_TEST_CASE(numbers_of_values) {
  BOOST_TEST(told("&time dt = 1, 2 /") == "f:1: &time dt: takes a single value, found a second, 2");
  BOOST_TEST(told("&time dt = 2*1 /") == "f:1: &time dt: takes a single value, found 2 of them");
  BOOST_TEST(told("&time dt = 1,,, /") == "no error");
  BOOST_TEST(told("&time title = 'two' 'words' /") == "f:1: &time title: takes a single value, found a second, words");
  BOOST_TEST(told("&time dt(1) = 1 /") == "f:1: &time dt: takes a single value: no subscript is possible");
  BOOST_TEST(told("&output times = 4*1,\n 0 /") == "f:2: &output times: too many values: at most 4 fit, found more");
  BOOST_TEST(told("&output times = 999999999*1 /") == "f:1: &output times: too many values: at most 4 fit, found more");
  BOOST_TEST(told("&output times = 999999999* /") == "f:1: &output times: too many values: at most 4 fit, found more");
  BOOST_TEST(told("&output times(2:3) = 0,0,0 /") == "f:1: &output times: too many values: at most 2 fit, found more");
  BOOST_TEST(told("&output times(5) = 1 /") == "f:1: &output times: the subscript 5 is outside 1 to 4");
  BOOST_TEST(told("&output times(0) = 1 /") == "f:1: &output times: the subscript 0 is outside 1 to 4");
  BOOST_TEST(told("&output times(2:9) = 1 /") == "f:1: &output times: the subscript 9 is outside 1 to 4");
  BOOST_TEST(told("&output times(3:2) = 1 /") == "f:1: &output times: the section 3:2:1 is empty");
  BOOST_TEST(told("&output times(4) = 1 /") == "f:1: &output times: element 2 has neither a value nor a default");
}
