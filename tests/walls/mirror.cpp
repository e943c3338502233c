// Mirror images of the fluid: where they stand, and that a wall then looks like more fluid.
#include <liquid/passes.hpp>
#include <map>
#include <run/lists.hpp>

#include <run/start.hpp>

#include "../support/scene.hpp"

using namespace tetsuame;
using namespace tetsuame::test;

namespace {

template <int D>
run::state<D> make(double jitter, std::array<bool, 3> periodic) {
  run::state<D> scene;
  domain::options box;
  box.length = {2.0, 1.0, 1.0};
  box.particles = {20, 10, 10};
  box.periodic = periodic;
  box.jitter = jitter;
  run::set_up<D>(scene, domain::communicator::world(), box, {}, {"wendland_c2", 1.3, 0.4}, 0.0);
  run::rebuild(scene, false);
  return scene;
}

struct kernel_sum {
  double* out;
  struct me {
    pairs::real W;
  };
  me begin(const pairs::cluster<>&) const { return {pairs::real(0.0)}; }
  void add(me& a, const auto& ij) const { a.W += ij.W; }
  void end(const pairs::cluster<>& i, const me& a) const { i.set(out, a.W); }
};

}  // namespace

BOOST_AUTO_TEST_CASE(a_wall_looks_like_more_fluid) {
  const auto check = []<int D>(std::integral_constant<int, D>, std::array<bool, 3> periodic) {
    const auto scene = make<D>(0.0, periodic);
    particles::array W(scene.w.s.fluid);
    scene.w.sum(scene.w.fluid(), kernel_sum{W.data()});
    const double self = std::visit([](const auto& k) { return k.self(); }, scene.w.kernel);
    for (const double sum : W)
      BOOST_TEST((sum + self) * std::pow(scene.w.dx, D) == scene.w.lattice_sum, boost::test_tools::tolerance(1e-13));
  };
  check(std::integral_constant<int, 2>{}, {false, false, false});
  check(std::integral_constant<int, 2>{}, {true, false, false});
  check(std::integral_constant<int, 3>{}, {false, false, false});
}

BOOST_AUTO_TEST_CASE(images_are_mirror_images) {
  auto scene = make<2>(0.2, {false, false, true});
  auto& s = scene.w.s;
  // Follow the fluid when it moves.
  for (std::size_t i = 0; i < s.first_wall(); ++i) s.x[1][i] += 0.01 * noise(s.id[i], 3);
  walls::move_images(scene.walls, s);
  BOOST_TEST(scene.walls.source.size() == s.walls);
  for (std::size_t r = 0; r < s.walls; ++r) {
    const std::size_t i = s.first_wall() + r, j = scene.walls.source[r];
    const std::array<double, 2> length{2.0, 1.0};
    for (std::size_t a = 0; a < 2; ++a) {
      const bool low = (scene.walls.mirrored[r] >> (2 * a) & 1U) != 0,
                 high = (scene.walls.mirrored[r] >> (2 * a + 1) & 1U) != 0;
      BOOST_TEST(!(low && high));
      const double expected = low ? -s.x[a][j] : high ? 2.0 * length[a] - s.x[a][j] : s.x[a][j];
      BOOST_TEST(s.x[a][i] == expected);
    }
  }
  // IDs differ, also from the fluid's.
  std::map<std::int64_t, int> times;
  for (std::size_t i = 0; i < s.fluid; ++i) ++times[s.id[i]];
  for (std::size_t i = s.first_wall(); i < s.total(); ++i) ++times[s.id[i]];
  for (const auto& [id, n] : times) BOOST_TEST(n == 1);
}

BOOST_AUTO_TEST_CASE(last_guard) {
  auto scene = make<2>(0.0, {false, false, true});
  auto& s = scene.w.s;
  std::int64_t moved = 0;
  for (std::size_t i = 0; i < s.fluid; ++i)
    if (s.x[1][i] < 0.1) {
      s.x[1][i] = -0.02;
      s.v[1][i] = -3.0;
      ++moved;
    }
  BOOST_TEST(walls::reflect(scene.walls, s) == moved);
  for (std::size_t i = 0; i < s.fluid; ++i) BOOST_TEST((s.x[1][i] > 0.0 && s.v[1][i] >= 0.0));
}
