// Gauges of water: what they read, and what is told of it beside the curves that it is held against.
#include <boost/test/unit_test.hpp>
#include <free_surface/gauges.hpp>
#include <free_surface/measures.hpp>
#include <free_surface/traction.hpp>
#include <fstream>

#include "scene.hpp"

using namespace tetsuame;
using namespace tetsuame::free_surface;
namespace tt = boost::test_tools;

// On a lattice in hydrostatic balance gauges on walls, in corners and in the water read the lattice sums' own measure
// of the pressure, which is 1.0000 of it.
BOOST_AUTO_TEST_CASE(gauges_on_a_lattice) {
  scene<2> scene(tank("high_y = 1.5 sound_factor = 100.0"));
  refresh(*scene.f);
  for (const auto& [place, depth] :
       {std::pair{point{0.3, 0.0, 0.0}, 1.5}, std::pair{point{2.0, 0.41, 0.0}, 1.09},
        std::pair{point{0.0, 0.0, 0.0}, 1.5 - 0.1 / 3.0}, std::pair{point{1.0, 0.77, 0.0}, 0.5 * (0.73 + 0.75)}})
    BOOST_TEST(pressure_at(*scene.f, place) == 9810.0 * depth, tt::tolerance(2e-3));
  BOOST_TEST(pressure_at(*scene.f, {1.0, 1.9, 0.0}) == 0.0);
  for (const double x : {0.0, 0.02, 0.7, 2.0})
    BOOST_TEST(depth_at(*scene.f, {x, 0.0, 0.0}) == 1.5, tt::tolerance(1e-12));
  BOOST_TEST(front_of(*scene.f) == 2.0, tt::tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(gauges_in_three_dimensions) {
  scene<3> scene(
      "&domain dimension = 3 length_x = 0.6 length_y = 0.8 length_z = 0.6 particles_x = 12 particles_y = 16 "
      "particles_z = 12 / &flow high_y = 0.6 sound_factor = 100.0 / &time t_end = 1.0 /");
  refresh(*scene.f);
  for (const point place : {point{0.3, 0.0, 0.27}, point{0.6, 0.21, 0.31}, point{0.6, 0.3, 0.6}, point{0.31, 0.3, 0.3}})
    BOOST_TEST(pressure_at(*scene.f, place) == 9810.0 * (0.6 - place[1]), tt::tolerance(0.01));
}

// What gauges a spacing apart along walls read adds up to the force on the water, dense or sparse: against the box's
// left side, and where a body ends the tank against that; of Riemann problems between what moves, too. Without gravity:
// the weight in the images of a rough floor pushes along it.
BOOST_AUTO_TEST_CASE(gauges_add_up_to_forces) {
  for (const auto& [body, how] :
       {std::pair{false, "alpha = 0.0"}, std::pair{true, "alpha = 0.0"}, std::pair{true, "scheme = 'riemann'"}}) {
    scene<2> scene(
        tank(std::string("high_x = 1.0 high_y = 0.75 gravity = 0.0 sound_speed = 20.0 ") + how, "jitter = 0.3 ") +
        (body ? " &solids shape = 'box' centre_x = 1.5 length_x = 1.0 length_y = 9.0 /" : ""));
    auto& s = scene.particles();
    for (std::size_t i = 0; i < s.fluid; ++i) {
      s.rho[i] *= 1.02 + 0.02 * noise(s.id[i], 3);
      s.m[i] *= 1.0 + 0.3 * noise(s.id[i], 4);  // sparse here and there
      for (std::size_t a = 0; a < 2; ++a) s.v[a][i] = noise(s.id[i], static_cast<int>(a) + 5);
    }
    scene.rebuild();  // ghosts have new masses, too
    const auto rate = scene.rates();
    const auto force = scene.sum([&](std::size_t i) { return s.m[i] * rate[2][i]; });
    double read = 0.0;
    for (int n = 0; n < 40; ++n) {
      const double y = 0.05 * (n + 0.5);
      read += 0.05 * pressure_at(*scene.f, {0.0, y, 0.0});
      if (body) read -= 0.05 * pressure_at(*scene.f, {1.0, y, 0.0});
    }
    BOOST_TEST(force == read, tt::tolerance(1e-9));
    BOOST_TEST(std::abs(force) > 10.0);
  }
}

// What is not known over all of the times that are asked for is null, with a reason, and not what there is of it.
BOOST_AUTO_TEST_CASE(curves_that_do_not_cover_the_times) {
  const series run{{0.0, 0.1, 0.2, 0.3}, {0.0, 200.0, 200.0, 200.0}}, later{{1.0, 2.0, 3.0}, {5.0, 5.0, 5.0}};
  options o;
  nlohmann::ordered_json m;
  report_height("h", run, later, m);
  BOOST_TEST(m["h_mean_error"].is_null());
  BOOST_TEST(m["h_mean_error_reason"] ==
             "the measured curve, 1 to 3 s, and the run, 0 to 0.3 s, have no time in common");
  report_pressure(o, "p", run, later, m);
  BOOST_TEST(m["p_impulse"].get<double>() == integral(run, 0.0, 0.3), tt::tolerance(1e-12));
  BOOST_TEST(m["p_impulse_reference"].is_null());
  const series of_state{{0.0, 0.1, 0.2, 0.3}, {0.0, 11.0, 30.0, 52.0}};
  report_force(o, "f", run, of_state, later, m);
  BOOST_TEST(m["f_impulse"].get<double>() == 52.0, tt::tolerance(1e-12));  // as integrated, not of readings
  BOOST_TEST(m["f_mean_error"].is_null());
  BOOST_TEST(m["f_impulse_reference"].is_null());
  parameters p;
  p.measured.front = later;
  report_front(p, run, m);
  BOOST_TEST((m["front_rms"].is_null() && m["front_rms_reason"].is_string()));
  o.gauges.impulse_from = 0.0;
  o.gauges.impulse_until = 2.5;
  nlohmann::ordered_json longer;
  const series known{{0.0, 1.0, 2.0, 3.0}, {5.0, 5.0, 5.0, 5.0}};
  report_pressure(o, "p", run, known, longer);
  BOOST_TEST(longer["p_impulse"].is_null());
  BOOST_TEST(longer["p_impulse_reason"] == "asked for from 0 to 2.5 s, and known from 0 to 0.3 s");
  BOOST_TEST(longer["p_impulse_reference"].get<double>() == 12.5, tt::tolerance(1e-12));
}
