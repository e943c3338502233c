// What points read of particles: linear fields as they are, anywhere, on any number of ranks.
#include <boost/test/unit_test.hpp>
#include <gauges/points.hpp>
#include <random>

#include "../support/mpi.hpp"

using namespace tetsuame;
namespace tt = boost::test_tools;

namespace {

using test::mpi_environment;
BOOST_TEST_GLOBAL_FIXTURE(mpi_environment);

// A box of 1 m x 1 m, periodic along x, with a disturbed lattice; every third particle is this rank's.
struct scene {
  std::vector<double> x, y, m, rho, h, p, u, v;
  std::vector<std::int64_t> id;
  domain::box<2> region{.length = {1.0, 1.0}, .periodic = {true, false}};
  gauges::options o;
  bool says_volumes = true;

  void add(std::int64_t number, double at_x, double at_y, double pressure) {
    const auto& ranks = domain::communicator::world();
    if (number % ranks.size != ranks.rank) return;
    id.push_back(number);
    x.push_back(at_x);
    y.push_back(at_y);
    m.push_back(1.0 + 0.5 * static_cast<double>(number % 3));
    rho.push_back(2.0);
    h.push_back(0.06 + 0.01 * static_cast<double>(number % 2));
    p.push_back(pressure);
    u.push_back(2.0 - at_y);
    v.push_back(-1.0);
  }
  void fill() {
    std::mt19937_64 random(1);
    const auto noise = [&] { return 0.02 * (static_cast<double>(random() >> 11) * 0x1p-53 - 0.5); };
    for (int n = 0; n < 400; ++n) {
      const double at_x = (n % 20 + 0.5) / 20.0 + noise(), at_y = (n / 20 + 0.5) / 20.0 + noise();
      add(n, at_x, at_y, 5.0 - 3.0 * at_y);
    }
  }
  std::vector<double> read(std::vector<std::string> fields) {
    o.fields = std::move(fields);
    output::particle_group g{0, id.size(), id.data(), {}, 2};
    output::add_quantity(g, "Coordinates", {x.data(), y.data()});
    output::add_quantity(g, "Velocities", {u.data(), v.data()});
    if (says_volumes) {
      output::add_quantity(g, "Masses", {m.data()});
      output::add_quantity(g, "Density", {rho.data()});
      output::add_quantity(g, "SmoothingLength", {h.data()});
    }
    output::add_quantity(g, "Pressure", {p.data()});
    return gauges::read<2>(o, g, region, kernels::make<2>("wendland_c2", 0.065), domain::communicator::world());
  }
};

}  // namespace

// Within, on walls, in a corner of walls and across the periodic side.
BOOST_AUTO_TEST_CASE(linear_fields) {
  scene s;
  s.fill();
  s.o.place = {{{0.43, 0.3, 0.0, 1.0, 0.02}, {0.51, 0.0, 1.0, 0.0, 0.7}, {}}};
  const auto read = s.read({"Pressure", "Velocities"});
  BOOST_REQUIRE(read.size() == 15);
  for (std::size_t n = 0; n < s.o.number(); ++n) {
    const double y = s.o.place[1][n];
    BOOST_TEST(read[3 * n] == 5.0 - 3.0 * y, tt::tolerance(1e-12));
    BOOST_TEST(read[3 * n + 1] == 2.0 - y, tt::tolerance(1e-12));
    BOOST_TEST(read[3 * n + 2] == -1.0, tt::tolerance(1e-12));
  }
}

// A fluid that has drifted across its periodic side reads as one that is put back.
BOOST_AUTO_TEST_CASE(fluid_that_drifts) {
  scene s;
  s.fill();
  s.o.place = {{{0.02, 0.97, 0.5}, {0.2, 0.4, 0.6}, {}}};
  const auto before = s.read({"Pressure"});
  for (double& x : s.x) x += 2.0;  // whole boxes: no rounding to speak of
  const auto behind = s.read({"Pressure"});
  for (std::size_t n = 0; n < before.size(); ++n) BOOST_TEST(behind[n] == before[n], tt::tolerance(1e-12));
}

// Of snapshots that say nothing of volumes and smoothing lengths.
BOOST_AUTO_TEST_CASE(equal_volumes) {
  scene s;
  s.fill();
  s.says_volumes = false;
  s.o.place = {{{0.43, 0.0}, {0.51, 0.0}, {}}};
  const auto read = s.read({"Pressure"});
  for (std::size_t n = 0; n < read.size(); ++n)
    BOOST_TEST(read[n] == 5.0 - 3.0 * s.o.place[1][n], tt::tolerance(1e-12));
}

// Where too little is near: the one particle's value, that of two between these, none.
BOOST_AUTO_TEST_CASE(few_particles) {
  scene s;
  s.add(0, 0.5, 0.5, 7.0);
  s.add(1, 0.3, 0.8, 2.0);
  s.add(2, 0.36, 0.8, 4.0);
  s.o.place = {{{0.55, 0.27, 0.8}, {0.52, 0.8, 0.2}, {}}};
  const auto read = s.read({"Pressure"});
  BOOST_TEST(read[0] == 7.0, tt::tolerance(1e-12));
  BOOST_TEST((read[1] > 2.0 && read[1] < 3.0));
  BOOST_TEST(read[2] == 0.0);
}

BOOST_AUTO_TEST_CASE(names_of_columns) {
  gauges::options o;
  o.name = {"low", "high"};
  o.place = {{{0.1, 0.2}, {0.1, 0.2}, {}}};
  o.fields = {"SmoothingLength", "Velocities"};
  std::vector<std::string> names;
  for (const auto& c : gauges::columns(o, 2)) names.push_back(c.name + " [" + c.units + "]");
  BOOST_TEST((names == std::vector<std::string>{"smoothing_length_low [m]", "velocities_low_x [m/s]",
                                                "velocities_low_y [m/s]", "smoothing_length_high [m]",
                                                "velocities_high_x [m/s]", "velocities_high_y [m/s]"}));
  o.name.clear();
  BOOST_TEST(gauges::columns(o, 3).back().name == "velocities_2_z");
}
