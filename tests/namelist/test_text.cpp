#include <boost/test/unit_test.hpp>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <namelist/text.hpp>
#include <random>

using namespace tetsuame::namelist;

BOOST_AUTO_TEST_CASE(shortest_form_reads_back_exactly) {
  std::mt19937_64 bits(1);
  for (int k = 0; k < 100000; ++k) {
    const double x = std::ldexp(static_cast<double>(bits()) + 0.5, static_cast<int>(bits() % 2000) - 1100);
    if (!std::isfinite(x)) continue;
    BOOST_REQUIRE_EQUAL(to_real(format_real(x)).value(), x);
    BOOST_REQUIRE_EQUAL(to_real(format_real(-x)).value(), -x);
  }
  BOOST_TEST(format_real(0.1) == "0.1");
  BOOST_TEST(to_real(format_real(5e-324)).value() == 5e-324);
  BOOST_TEST(to_real(format_real(std::numeric_limits<double>::max())).value() == std::numeric_limits<double>::max());
}

// Only the exponent tells overflow from underflow, and zeros in the mantissa shift it.
BOOST_AUTO_TEST_CASE(beyond_the_range_of_double) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const char* word : {"1e309", "1e99999", "1d99999999999999999999", "123456e304", "0.0001e313"})
    BOOST_TEST(to_real(word).value() == infinity, word);
  for (const char* word : {"1e-330", "1e-99999", "1d-99999999999999999999", "0e9999999999999", "0.0001e-321"})
    BOOST_TEST(to_real(word).value() == 0.0, word);
  BOOST_TEST(std::signbit(to_real("-1e-400").value()));
  BOOST_TEST(to_real("0." + std::string(400, '0') + "1e401").value() == 1.0);
  BOOST_TEST(to_real("1" + std::string(400, '0') + "e-400").value() == 1.0);
}

BOOST_AUTO_TEST_CASE(no_numbers) {
  bool out_of_range = false;
  for (const char* word :
       {"", "+", "-", ".", "e5", "1e", "1e+", "1.5.2", "1e5e5", "--1", "+-1", "1 ", "0x10", "1_8", "1f3"})
    BOOST_TEST(!to_real(word), word);
  for (const char* word : {"", "+", "-", "1.", "1.0", "1e3", "+-1", "0x1", "1_8"}) {
    BOOST_TEST(!to_integer(word, out_of_range), word);
    BOOST_TEST(!out_of_range, word);
  }
  BOOST_TEST(!to_integer("9223372036854775808", out_of_range));
  BOOST_TEST(out_of_range);
}

BOOST_AUTO_TEST_CASE(nearest_name) {
  const std::vector<std::string> names{"length_x", "length_y", "particles_x", "periodic_x"};
  BOOST_TEST(nearest("lenght_y", names) == "length_y");
  BOOST_TEST(nearest("PERIODICX", names) == "periodic_x");
  BOOST_TEST(nearest("particle_x", names) == "particles_x");
  BOOST_TEST(nearest("x", {}) == "");
  // A swap of neighbours is one step; two replacements would be two.
  BOOST_TEST(nearest("ab", {"xb2", "ba"}) == "ba");
}

BOOST_AUTO_TEST_CASE(excerpts_are_short_and_printable) {
  BOOST_TEST(excerpt("a\nb\x01") == "a?b?");
  BOOST_TEST(excerpt(std::string(50, 'a')) == std::string(40, 'a') + "...");
  // 39 letters and a character of two bytes, of which the second does not fit
  BOOST_TEST(excerpt(std::string(39, 'a') + "\xc3\xa9\xc3\xa9") == std::string(39, 'a') + "...");
}
