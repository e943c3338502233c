// exact_sum against an independent reference: a sum of long doubles where that is
// exact, and a plain schoolbook big integer (base 2, two's complement) where it is not.
#include <algorithm>
#include <bit>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <cstdint>
#include <foundation/exact_sum.hpp>
#include <limits>
#include <random>
#include <vector>

using tetsuame::foundation::exact_sum;

namespace {

constexpr double largest = std::numeric_limits<double>::max();
constexpr double tiniest = std::numeric_limits<double>::denorm_min();
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }

double fraction_of(double x) {
  int exponent = 0;
  return std::frexp(x, &exponent);
}

double exact(const std::vector<double>& values) {
  exact_sum sum;
  for (double v : values) sum.add(v);
  return sum.value();
}

// Bit b of the array stands for 2^(b - 1074); positive and negative parts apart.
class big_integer {
 public:
  static constexpr int length = 2300;

  void add(double value) {
    int exponent = 0;
    const double fraction = std::frexp(std::fabs(value), &exponent);  // value = fraction 2^exponent
    auto mantissa = static_cast<std::uint64_t>(std::ldexp(fraction, 53));
    int position = exponent - 53 + 1074;
    for (; position < 0; ++position) mantissa >>= 1;  // a subnormal's low bits are zero
    auto& part = value < 0 ? negative_ : positive_;
    for (int b = 0; b < 53; ++b)
      if ((mantissa >> b) & 1U) increment(part, position + b);
  }

  double rounded() const {
    const bool flip = less(positive_, negative_);
    std::vector<int> d = flip ? minus(negative_, positive_) : minus(positive_, negative_);
    int top = length - 1;
    while (top >= 0 && d[static_cast<std::size_t>(top)] == 0) --top;
    if (top < 0) return 0.0;
    const int last = std::max(0, top - 52);  // the lowest bit a double keeps
    std::uint64_t mantissa = 0;
    for (int b = top; b >= last; --b)
      mantissa = 2 * mantissa + static_cast<std::uint64_t>(d[static_cast<std::size_t>(b)]);
    if (last > 0 && d[static_cast<std::size_t>(last - 1)] != 0) {
      const bool beyond_half = std::any_of(d.begin(), d.begin() + last - 1, [](int b) { return b != 0; });
      if (beyond_half || (mantissa & 1U) != 0) ++mantissa;
    }
    const double result = std::ldexp(static_cast<double>(mantissa), last - 1074);
    return flip ? -result : result;
  }

 private:
  static void increment(std::vector<int>& part, int b) {
    for (; part[static_cast<std::size_t>(b)] == 1; ++b) part[static_cast<std::size_t>(b)] = 0;
    part[static_cast<std::size_t>(b)] = 1;
  }
  static bool less(const std::vector<int>& a, const std::vector<int>& b) {
    return std::lexicographical_compare(a.rbegin(), a.rend(), b.rbegin(), b.rend());
  }
  static std::vector<int> minus(std::vector<int> a, const std::vector<int>& b) {
    int borrow = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
      a[k] -= b[k] + borrow;
      borrow = a[k] < 0;
      a[k] += 2 * borrow;
    }
    return a;
  }

  std::vector<int> positive_ = std::vector<int>(length, 0);
  std::vector<int> negative_ = std::vector<int>(length, 0);
};

double reference(const std::vector<double>& values) {
  big_integer sum;
  for (double v : values) sum.add(v);
  return sum.rounded();
}

// Any finite bit pattern, so exponents spread over the whole range, subnormals among them.
std::vector<double> wild(std::size_t n, std::mt19937_64& random) {
  std::vector<double> values;
  while (values.size() < n) {
    const double v = std::bit_cast<double>(random());
    if (std::isfinite(v)) values.push_back(v);
  }
  return values;
}

}  // namespace

BOOST_AUTO_TEST_CASE(one_value_comes_back) {
  std::mt19937_64 random(1);
  auto values = wild(20000, random);
  for (double v : {0.0, 1.0, -1.0, largest, -largest, tiniest, -tiniest, std::numeric_limits<double>::min()})
    values.push_back(v);
  for (int e = -1074; e < 1024; ++e) values.push_back(std::ldexp(1.0, e));
  for (double v : values) BOOST_REQUIRE_EQUAL(bits(exact({v})), bits(v));
  BOOST_CHECK_EQUAL(bits(exact({})), bits(0.0));
  BOOST_CHECK_EQUAL(bits(exact({-0.0})), bits(0.0));
}

BOOST_AUTO_TEST_CASE(agrees_with_the_big_integer) {
  std::mt19937_64 random(2);
  for (int trial = 0; trial < 400; ++trial) {
    auto values = wild(1 + random() % 60, random);
    // Exponents near one another too, or the largest number alone would decide.
    if (trial % 2 == 0)
      for (double& v : values)
        v = std::ldexp(fraction_of(v), static_cast<int>(random() % 120) - (trial % 4 == 0 ? 1070 : 60));
    BOOST_REQUIRE_EQUAL(bits(exact(values)), bits(reference(values)));
  }
}

BOOST_AUTO_TEST_CASE(order_of_a_long_sum_does_not_matter) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::vector<double> values(200000);
  long double longer = 0;
  for (double& v : values) {
    v = std::ldexp(std::round(std::ldexp(normal(random), 30)), -30);  // a multiple of 2^-30: the sum is exact
    longer += v;
  }
  const double sum = exact(values);
  BOOST_CHECK_EQUAL(bits(sum), bits(static_cast<double>(longer)));
  for (int trial = 0; trial < 5; ++trial) {
    std::shuffle(values.begin(), values.end(), random);
    BOOST_CHECK_EQUAL(bits(exact(values)), bits(sum));
  }
}

BOOST_AUTO_TEST_CASE(cancellation_leaves_the_small_remainder) {
  BOOST_CHECK_EQUAL(exact({1e300, 1.0, -1e300}), 1.0);
  BOOST_CHECK_EQUAL(exact({1e300, tiniest, -1e300}), tiniest);
  BOOST_CHECK_EQUAL(exact({largest, largest, -largest, -largest, -3 * tiniest}), -3 * tiniest);
  std::mt19937_64 random(4);
  auto values = wild(2000, random);
  const std::size_t n = values.size();
  for (std::size_t k = 0; k < n; ++k) values.push_back(-values[k]);
  std::shuffle(values.begin(), values.end(), random);
  BOOST_CHECK_EQUAL(bits(exact(values)), bits(0.0));
  values.push_back(-7 * tiniest);
  BOOST_CHECK_EQUAL(exact(values), -7 * tiniest);
}

BOOST_AUTO_TEST_CASE(rounds_to_nearest_ties_to_even) {
  const double ulp = std::ldexp(1.0, -52);
  BOOST_CHECK_EQUAL(exact({1.0, ulp / 2}), 1.0);
  BOOST_CHECK_EQUAL(exact({1.0 + ulp, ulp / 2}), 1.0 + 2 * ulp);
  BOOST_CHECK_EQUAL(exact({1.0, ulp / 2, tiniest}), 1.0 + ulp);
  BOOST_CHECK_EQUAL(exact({1.0 + ulp, ulp / 2, -tiniest}), 1.0 + ulp);
  BOOST_CHECK_EQUAL(exact({-1.0, -ulp / 2, -tiniest}), -1.0 - ulp);
}

BOOST_AUTO_TEST_CASE(overflow_is_the_sums_own_not_a_terms) {
  BOOST_CHECK_EQUAL(exact({largest, largest, -largest}), largest);
  BOOST_CHECK_EQUAL(exact({largest, largest}), infinity);
  BOOST_CHECK_EQUAL(exact({-largest, -largest}), -infinity);
  const double half_ulp = std::ldexp(1.0, 970);  // the tie between the largest double and 2^1024
  BOOST_CHECK_EQUAL(exact({largest, half_ulp}), infinity);
  BOOST_CHECK_EQUAL(exact({largest, half_ulp, -tiniest}), largest);
  exact_sum many;
  for (int k = 0; k < 100000; ++k) many.add(largest);
  for (int k = 0; k < 99999; ++k) many.add(-largest);
  BOOST_CHECK_EQUAL(many.value(), largest);
}

BOOST_AUTO_TEST_CASE(infinities_and_nan) {
  BOOST_CHECK_EQUAL(exact({1.0, infinity, -largest}), infinity);
  BOOST_CHECK_EQUAL(exact({-infinity, largest}), -infinity);
  BOOST_CHECK(std::isnan(exact({infinity, -infinity})));
  BOOST_CHECK(std::isnan(exact({1.0, nan_value})));
  BOOST_CHECK(std::isnan(exact({infinity, -nan_value})));
}

BOOST_AUTO_TEST_CASE(partial_sums_merge_in_any_order) {
  std::mt19937_64 random(5);
  const auto values = wild(3000, random);
  const double sum = exact(values);
  for (std::size_t parts : {1, 2, 3, 7, 64}) {
    std::vector<exact_sum> partial(parts);
    for (double v : values) partial[random() % parts].add(v);
    exact_sum merged, as_integers;
    for (auto& p : partial) merged.add(p);
    std::reverse(partial.begin(), partial.end());
    for (auto& p : partial) {
      p.normalise();
      for (std::size_t k = 0; k < p.raw().size(); ++k) as_integers.raw()[k] += p.raw()[k];
    }
    BOOST_CHECK_EQUAL(bits(merged.value()), bits(sum));
    BOOST_CHECK_EQUAL(bits(as_integers.value()), bits(sum));
  }
  exact_sum special, other;
  special.add(infinity);
  other.add(-1.0);
  other.add(special);
  BOOST_CHECK_EQUAL(other.value(), infinity);
}

BOOST_AUTO_TEST_CASE(normalising_changes_no_value) {
  std::mt19937_64 random(6);
  exact_sum carried, plain;
  for (double v : wild(5000, random)) {
    carried.add(v);
    carried.normalise();
    plain.add(v);
  }
  BOOST_CHECK_EQUAL(bits(carried.value()), bits(plain.value()));
  for (std::size_t k = 0; k + 1 < exact_sum::chunks; ++k) {
    BOOST_CHECK_GE(carried.raw()[k], 0);
    BOOST_CHECK_LT(carried.raw()[k], std::int64_t{1} << 32);
  }
}
