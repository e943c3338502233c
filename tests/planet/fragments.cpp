// Pieces of an impactor's metal, of which it is known where they lie.
#include <boost/test/unit_test.hpp>
#include <planet/fragments.hpp>

#include "../support/mpi.hpp"

using namespace tetsuame;

namespace {

using test::mpi_environment;
BOOST_TEST_GLOBAL_FIXTURE(mpi_environment);

constexpr std::int32_t iron = 0, rock = 1;
constexpr std::int64_t of_target = 0, of_impactor = 1000000;

struct particles_1m_apart {
  std::array<std::vector<double>, 3> x, v;
  std::vector<double> m, rho, p, volume;
  std::vector<std::int32_t> material;
  std::vector<std::int64_t> id;

  // So many along an edge, from this corner on.
  void add_cube(int edge, const gas::point& corner, std::int32_t of, std::int64_t first_id) {
    for (int k = 0; k < edge * edge * edge; ++k) {
      const std::array<int, 3> cell{k % edge, k / edge % edge, k / edge / edge};
      for (std::size_t a = 0; a < 3; ++a) {
        x[a].push_back(corner[a] + cell[a]);
        v[a].push_back(0.0);
      }
      m.push_back(5.0);
      rho.push_back(5.0);
      p.push_back(0.0);
      volume.push_back(1.0);
      material.push_back(of);
      id.push_back(first_id + static_cast<std::int64_t>(id.size()));
    }
  }
  planet::metal_of_impactor found() const {
    const auto ranks = domain::communicator::world();
    gas::view w{ranks,
                ranks.rank == 0 ? m.size() : 0,
                {},
                {},
                m.data(),
                rho.data(),
                p.data(),
                volume.data(),
                material.data(),
                id.data()};
    for (std::size_t a = 0; a < 3; ++a) {
      w.x[a] = x[a].data();
      w.v[a] = v[a].data();
    }
    return planet::find_metal_of_impactor(w, of_impactor, iron);
  }
};

}  // namespace

BOOST_AUTO_TEST_CASE(pieces_of_metal) {
  particles_1m_apart all;
  all.add_cube(6, {0.0, 0.0, 0.0}, iron, of_target);
  all.add_cube(2, {6.0, 0.0, 0.0}, iron, of_impactor);  // on the core
  all.add_cube(3, {20.0, 0.0, 0.0}, iron, of_impactor);
  all.add_cube(2, {30.0, 0.0, 0.0}, iron, of_impactor);
  all.add_cube(1, {40.0, 0.0, 0.0}, iron, of_impactor);
  all.add_cube(1, {41.0, 0.0, 0.0}, rock, of_impactor);  // no more than the metal that lies in its midst
  all.add_cube(5, {60.0, 0.0, 0.0}, rock, of_target);
  const auto found = all.found();
  BOOST_TEST(found.pieces == 3.0);
  BOOST_TEST(found.largest == 27.0 / 44.0, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(found.merged == 8.0 / 44.0, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(found.mixed == 1.0 / 44.0, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(found.distance > 8.0 * 4.0 / 44.0);
  // 1.4 m apart they hang together, 1.6 m apart no longer.
  for (const double gap : {1.4, 1.6}) {
    particles_1m_apart two;
    two.add_cube(2, {0.0, 0.0, 0.0}, iron, of_target);
    two.add_cube(1, {10.0, 0.0, 0.0}, iron, of_impactor);
    two.add_cube(1, {10.0 + gap, 0.0, 0.0}, iron, of_impactor);
    BOOST_TEST(two.found().pieces == (gap < 1.5 ? 1.0 : 2.0));
  }
}

BOOST_AUTO_TEST_CASE(without_metal_nothing_is_found) {
  particles_1m_apart all;
  all.add_cube(3, {0.0, 0.0, 0.0}, rock, of_target);
  all.add_cube(3, {3.0, 0.0, 0.0}, rock, of_impactor);
  BOOST_TEST(all.found().pieces == 0.0);
  all.add_cube(2, {9.0, 0.0, 0.0}, iron, of_target);
  BOOST_TEST(all.found().distance == 0.0);
}
