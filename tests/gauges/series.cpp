// Curves over time: what lies between their points, differences, spans that they cover, oscillations.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <gauges/series.hpp>
#include <numbers>

using namespace tetsuame::gauges;
namespace tt = boost::test_tools;

BOOST_AUTO_TEST_CASE(curves) {
  const series run{{0.0, 1.0, 2.0, 4.0}, {0.0, 2.0, 2.0, 6.0}};
  BOOST_TEST(*value_at(run, 3.0) == 4.0);
  BOOST_TEST(!value_at(run, 4.1));
  BOOST_TEST(*first_above(run, 1.0) == 0.5);
  BOOST_TEST(!first_above(run, 6.0));
  BOOST_TEST(integral(run, 0.5, 3.0) == 0.75 + 2.0 + 3.0);
  BOOST_TEST(*rms_difference(run, {{1.0, 3.0, 9.0}, {3.0, 4.0, 100.0}}) == std::sqrt(0.5));
  BOOST_TEST(*mean_difference(run, {{1.0, 3.0, 9.0}, {3.0, 4.0, 100.0}}) == 0.5);
  series wave;
  for (int k = 0; k < 4000; ++k) {
    const double t = 0.002 * k;
    wave.time.push_back(t);
    wave.value.push_back(std::exp(-0.1 * t) * std::cos(5.0 * t));
  }
  const auto measured = measured_oscillation(wave);
  BOOST_TEST(*measured.period == 0.4 * std::numbers::pi, tt::tolerance(1e-6));
  BOOST_TEST(*measured.decay == 0.1, tt::tolerance(1e-4));
}

BOOST_AUTO_TEST_CASE(spans) {
  const series run{{0.0, 0.1, 0.2, 0.3}, {0.0, 200.0, 200.0, 200.0}}, later{{1.0, 2.0, 3.0}, {5.0, 5.0, 5.0}};
  BOOST_TEST(!mean_difference(run, later));
  BOOST_TEST(covers(run, 0.0, 0.305));
  BOOST_TEST(!covers(run, 0.0, 0.4));
  BOOST_TEST(!covers({{0.0, 0.001}, {1.0, 1.0}}, 0.0, 0.0021));
  BOOST_TEST(!covers(later, 0.1, 2.0));
}

// What a checkpoint holds is all of it.
BOOST_AUTO_TEST_CASE(readings_are_saved) {
  readings all, again;
  all.columns = again.columns = {{"a", "1"}, {"b", "m"}};
  all.add(0.0, {1.0, 2.0});
  all.add(0.5, {3.0, 4.0});
  again.restore(all.saved());
  BOOST_TEST(again.size() == 2U);
  BOOST_TEST(again.of("b").value == (std::vector{2.0, 4.0}));
  BOOST_TEST(again.of("b").time == (std::vector{0.0, 0.5}));
}
