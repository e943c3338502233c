// What a run has measured says whether its end means something.
#include <boost/test/unit_test.hpp>
#include <run/doubts.hpp>

using namespace tetsuame;

namespace {

run::summary of(nlohmann::ordered_json metrics) {
  run::summary s;
  s.fluid_particles = 576;  // 24 in a row
  s.steps = 1000;
  s.metrics = std::move(metrics);
  return s;
}

}  // namespace

BOOST_AUTO_TEST_CASE(what_is_measured_within_the_limits_or_not_at_all_is_no_doubt) {
  BOOST_TEST(run::doubts(of({})) == "");
  BOOST_TEST(run::doubts(of({{"energy_residual", nullptr}, {"density_excess", nullptr}})) == "");
  BOOST_TEST(run::doubts(of({{"energy_residual", 0.19}, {"density_excess", 1.9}, {"particles_put_back", 2400}})) == "");
}

BOOST_AUTO_TEST_CASE(each_measure_beyond_its_limit_is_told) {
  const auto told = [](const char* name, double value, const std::string& part) {
    const auto text = run::doubts(of({{name, value}}));
    BOOST_TEST(text.find(part) != std::string::npos, text);
  };
  told("energy_residual", -0.21, "the energy is off by -0.21");
  told("energy_residual", 24.0, "24");
  told("density_excess", 813.0, "a factor of 813");
  told("particles_put_back", 2401, "2401 particles had to be put back inside the walls in 1000 steps");
  // The most on the way, where it is known, and not what is left of it at the end.
  BOOST_TEST(run::doubts(of({{"energy_residual", 0.01}, {"energy_residual_max", 0.3}})) != "");
  const auto both = run::doubts(of({{"energy_residual", 1.0}, {"density_excess", 3.0}}));
  BOOST_TEST(both.find("; ") != std::string::npos, both);
}

// In three dimensions it is a layer along a wall, of N^(2/3) particles.
BOOST_AUTO_TEST_CASE(particles_put_back_count_beside_those_along_a_wall) {
  auto s = of({{"particles_put_back", 9999}});
  s.fluid_particles = 1000;
  s.dimension = 3;
  BOOST_TEST(run::doubts(s) == "");
  s.metrics["particles_put_back"] = 10001;
  BOOST_TEST(run::doubts(s) != "");
}
