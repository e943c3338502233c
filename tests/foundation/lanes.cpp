// What loops over neighbours do with lanes, held against the same with doubles.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <foundation/lanes.hpp>
#include <foundation/lanes_math.hpp>
#include <limits>
#include <random>
#include <vector>

using namespace tetsuame::foundation;

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

real filled(auto&& value) {
  return real([&](auto lane) { return value(static_cast<std::size_t>(lane)); });
}

}  // namespace

BOOST_AUTO_TEST_CASE(sum_has_its_fixed_order) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  for (int n = 0; n < 100; ++n) {
    const real a = filled([&](std::size_t) { return value(random); });
    std::array<double, lanes> part;
    for (std::size_t k = 0; k < lanes; ++k) part[k] = a[k];
    for (std::size_t half = lanes / 2; half > 0; half /= 2)
      for (std::size_t k = 0; k < half; ++k) part[k] += part[k + half];
    const double is = sum(a);
    BOOST_TEST(is == part[0]);
  }
}

// Goldschmidt's two steps from 14 bits round a few times: 2 ε is what they may miss by.
BOOST_AUTO_TEST_CASE(roots_to_a_rounding_or_two) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> exponent(-200.0, 200.0);
  for (int n = 0; n < 2000; ++n) {
    const real r2 = filled([&](std::size_t) { return std::pow(10.0, exponent(random)); });
    const auto root = both_roots(r2);
    for (std::size_t k = 0; k < lanes; ++k) {
      BOOST_TEST(std::abs(root.r[k] / std::sqrt(r2[k]) - 1.0) <= 2.0 * epsilon);
      BOOST_TEST(std::abs(root.inverse[k] * std::sqrt(r2[k]) - 1.0) <= 2.0 * epsilon);
    }
  }
}

// The null particle of neighbour lists lies at 1e60: nothing may overflow there.
BOOST_AUTO_TEST_CASE(roots_of_the_far_away) {
  const auto root = both_roots(real(2e120));
  BOOST_TEST(std::abs(root.r[0] / std::sqrt(2e120) - 1.0) <= 2.0 * epsilon);
  BOOST_TEST(std::isfinite(root.inverse[0]));
}

BOOST_AUTO_TEST_CASE(bits_of_comparison) {
  for (std::uint32_t pattern = 0; pattern < 1U << lanes; ++pattern) {
    const real a = filled([&](std::size_t k) { return (pattern >> k & 1U) != 0 ? 1.0 : 3.0; });
    BOOST_TEST(bits_of_less(a, real(2.0)) == pattern);
  }
  BOOST_TEST(bits_of_less(real(2.0), real(2.0)) == 0U);
  BOOST_TEST(bits_of_less(real(std::numeric_limits<double>::quiet_NaN()), real(2.0)) == 0U);
}

BOOST_AUTO_TEST_CASE(greater_and_lesser) {
  const real a = filled([](std::size_t k) { return k % 2 == 0 ? 1.0 : -2.0; }), zero(0.0);
  const real nan(std::numeric_limits<double>::quiet_NaN());
  for (std::size_t k = 0; k < lanes; ++k) {
    const auto both = [&](const real& x, const real& y) {
      return std::array<double, 2>{greater(x, y)[k], lesser(x, y)[k]};
    };
    const double is = a[k];
    BOOST_TEST((both(a, zero) == std::array{std::max(is, 0.0), std::min(is, 0.0)}));
    BOOST_TEST((std::isnan(both(zero, nan)[0]) && std::isnan(both(zero, nan)[1])));
    BOOST_TEST((both(nan, zero) == std::array{0.0, 0.0}));
  }
}

// libmvec promises 4 units in the last place; and a value gives the same in every lane.
BOOST_AUTO_TEST_CASE(exp_and_log) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> value(-30.0, 30.0);
  for (int n = 0; n < 1000; ++n) {
    const real x = filled([&](std::size_t) { return value(random); });
    const real e = tetsuame::foundation::exp(x), l = tetsuame::foundation::log(e);
    for (std::size_t k = 0; k < lanes; ++k) {
      BOOST_TEST(std::abs(e[k] / std::exp(x[k]) - 1.0) <= 4.0 * epsilon);
      BOOST_TEST(std::abs(l[k] - std::log(e[k])) <= 4.0 * epsilon * std::max(1.0, std::abs(x[k])));
      const double moved_e = tetsuame::foundation::exp(real(x[k]))[(k + 1) % lanes], same_e = e[k];
      const double moved_l = tetsuame::foundation::log(real(e[k]))[(k + 1) % lanes], same_l = l[k];
      BOOST_TEST(moved_e == same_e);
      BOOST_TEST(moved_l == same_l);
    }
  }
}

// A register of doubles is either half of one of single numbers, in order; each rounds once.
BOOST_AUTO_TEST_CASE(single_numbers_from_doubles_and_back) {
  const real given = filled([](std::size_t k) { return -3.0 - static_cast<double>(k) / 7.0; });
  const single both = duplicate_halves(given);
  const real back = lower_half(both);
  for (std::size_t k = 0; k < lanes; ++k) {
    const double one = given[k];
    const auto is = static_cast<float>(one);
    BOOST_TEST(both[k] == is);
    BOOST_TEST(both[k + lanes] == is);
    BOOST_TEST(static_cast<double>(back[k]) == static_cast<double>(is));
  }
}

BOOST_AUTO_TEST_CASE(halves_beside_each_other) {
  const float low = 1.5F, high = -2.5F;
  const single is(concatenate(&low, &high)), exchanged = halves_exchanged(is);
  for (std::size_t k = 0; k < single::size(); ++k) {
    BOOST_TEST(is[k] == (k < lanes ? low : high));
    BOOST_TEST(exchanged[k] == (k < lanes ? high : low));
  }
}

BOOST_AUTO_TEST_CASE(single_choices_by_lane) {
  std::array<double, 2 * lanes> x, y;
  for (std::size_t k = 0; k < x.size(); ++k) {
    x[k] = static_cast<double>(k);
    y[k] = 7.5 - static_cast<double>(k);
  }
  const auto of = [](const std::array<double, 2 * lanes>& a) {
    return single(single::lanes_type([&](auto lane) { return static_cast<float>(a[lane]); }));
  };
  const single a = of(x), b = of(y), other(-1.0), mean = (a + b) * 0.5, ratio = a / (1.0 + a), opposite = -a;
  for (std::uint32_t bits = 0; bits < 1U << single::size(); bits += 7) {
    const single is = greater_where(bits, a, b, other);
    for (std::size_t k = 0; k < single::size(); ++k) {
      const double greatest = std::max(x[k], y[k]);
      BOOST_TEST(is[k] == ((bits >> k & 1U) != 0 ? greatest : -1.0));
    }
  }
  const single least = lesser(a, b), chosen = select(a < b, 1.0, b), same = select(a == a, a, b);
  for (std::size_t k = 0; k < single::size(); ++k) {
    BOOST_TEST(least[k] == std::min(x[k], y[k]));
    BOOST_TEST(chosen[k] == (x[k] < y[k] ? 1.0 : y[k]));
    BOOST_TEST(same[k] == x[k]);
    BOOST_TEST(mean[k] == 3.75);
    BOOST_TEST(ratio[k] == static_cast<float>(x[k]) / (1.0F + static_cast<float>(x[k])));
    BOOST_TEST(opposite[k] == -x[k]);
  }
}

BOOST_AUTO_TEST_CASE(single_roots_to_a_rounding_or_two) {
  constexpr double rounding = std::numeric_limits<float>::epsilon();
  std::mt19937 random(6);
  std::uniform_real_distribution<double> exponent(-16.0, 16.0);
  for (int n = 0; n < 2000; ++n) {
    const auto some = [&](std::size_t) { return std::pow(10.0, exponent(random)); };
    const single one = duplicate_halves(filled(some)), other = halves_exchanged(duplicate_halves(filled(some)));
    const single r2 = select(other < one, one, other);
    const auto root = both_roots(r2);
    for (std::size_t k = 0; k < single::size(); ++k) {
      const double exact = std::sqrt(static_cast<double>(r2[k]));
      BOOST_TEST(std::abs(root.r[k] / exact - 1.0) <= 2.0 * rounding);
      BOOST_TEST(std::abs(root.inverse[k] * exact - 1.0) <= 2.0 * rounding);
    }
  }
}
