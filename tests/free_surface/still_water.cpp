// Water that starts at rest: its density, its balance, lattices on which it stays.
#include <boost/test/unit_test.hpp>
#include <free_surface/eigenvalue.hpp>
#include <map>
#include <numbers>

#include "scene.hpp"

using namespace tetsuame;
using namespace tetsuame::free_surface;
namespace tt = boost::test_tools;

// Water that rests under its weight has dp/dd = ρ g at any depth, and no pressure at the surface.
BOOST_AUTO_TEST_CASE(water_beneath_water) {
  for (const std::int64_t exponent : {1, 2, 7}) {
    const liquid w{1000.0, 20.0, exponent};
    const auto pressure = [&](double depth) { return w.pressure(w.density_beneath(9.81 * depth)); };
    BOOST_TEST(w.density_beneath(0.0) == 1000.0);
    for (const double depth : {0.1, 1.0, 3.0}) {
      const double d = 1e-3, slope = (pressure(depth + d) - pressure(depth - d)) / (2.0 * d);
      BOOST_TEST(slope == 9.81 * w.density_beneath(9.81 * depth), tt::tolerance(1e-7));
    }
  }
}

// Deeper than three rows still water starts balanced, but for the lattice sum -Σ V F y², which is 1.0000, and what the
// sums make of a density that falls by a hundredth over the depth.
BOOST_AUTO_TEST_CASE(balanced_start) {
  scene<2> scene(
      "&domain length_x = 1.0 length_y = 1.5 particles_x = 20 particles_y = 30 / &flow high_y = 1.0 / "
      "&walls slip_top = 'free_surface' / &time t_end = 1.0 /");
  const auto rate = scene.rates();
  const auto& s = scene.particles();
  double deep = 0.0;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    if (s.x[1][i] < 0.85) deep = std::max(deep, std::abs(rate[3][i]));
    BOOST_TEST(std::abs(rate[2][i]) < 1e-9 * 9.81);
  }
  BOOST_TEST(scene.f->ranks().maximum(deep) < 0.002 * 9.81);
}

namespace {

// Of waves on a square lattice under pressure, the smallest stiffness across Σ F x sin(k·x), along which compression is
// stiff anyway: Σ (1 - cos k·x) ∇∇W, over the kernel's own scale (docs/theory/free_surface.md).
template <class Kernel>
double least_stiffness_of_lattice(double support) {
  const Kernel kernel(support);
  const auto stiffness = [&](double kx, double ky) {
    std::array<double, 3> M{};
    std::array<double, 2> q{};
    const int far = static_cast<int>(support);
    for (int i = -far; i <= far; ++i)
      for (int j = -far; j <= far; ++j) {
        const double x = i, y = j, r = std::hypot(x, y), d = 1e-5;
        if (r == 0.0 || r >= support) continue;
        const double F = kernel.gradient_over_r(r), phase = kx * x + ky * y, moves = 1.0 - std::cos(phase);
        const double per_r = (kernel.gradient_over_r(r + d) - kernel.gradient_over_r(r - d)) / (2.0 * d * r);
        M[0] += moves * (F + per_r * x * x);
        M[1] += moves * per_r * x * y;
        M[2] += moves * (F + per_r * y * y);
        q[0] += F * x * std::sin(phase);
        q[1] += F * y * std::sin(phase);
      }
    const double length = std::hypot(q[0], q[1]);
    if (length < 1e-9) return smallest_eigenvalue(M);
    const double sx = -q[1] / length, sy = q[0] / length;
    return M[0] * sx * sx + 2.0 * M[1] * sx * sy + M[2] * sy * sy;
  };
  double least = 1.0;
  for (int i = 0; i <= 16; ++i)
    for (int j = i == 0 ? 1 : 0; j <= 16; ++j)
      least = std::min(least, stiffness(std::numbers::pi * i / 16.0, std::numbers::pi * j / 16.0));
  return least;
}

}  // namespace

// Still water stays on a square lattice with the quintic spline as far as it reaches by default and a little less or
// more; with Wendland's C2 at 2 Δx alone.
BOOST_AUTO_TEST_CASE(lattices_that_stay) {
  for (const double h : {1.21, 1.25, 1.3})
    BOOST_TEST(least_stiffness_of_lattice<kernels::quintic_spline<2>>(3.0 * h) > 0.0);
  for (const double h : {1.5, 1.9, 2.1}) BOOST_TEST(least_stiffness_of_lattice<kernels::wendland_c2<2>>(2.0 * h) < 0.0);
  BOOST_TEST(least_stiffness_of_lattice<kernels::wendland_c2<2>>(4.0) > 0.0);
}

// Blocks upon each other hang together: one surface.
BOOST_AUTO_TEST_CASE(hydrostatic_start) {
  scene<2> scene(tank("low_y = 0.0, 0.5 high_x = 1.0, 0.5 high_y = 0.5, 1.0"));
  auto& s = scene.particles();
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const double top = s.x[0][i] < 0.5 ? 1.0 : 0.5;
    BOOST_TEST(s.rho[i] == scene.p.water.density_beneath(9.81 * (top - s.x[1][i])), tt::tolerance(1e-14));
  }
  BOOST_TEST(scene.sum([](std::size_t) { return 1.0; }) == 300.0);
}

namespace {

// m, to which the water at (x, y) would rise, by its density.
std::vector<double> levels(scene<2>& scene) {
  std::vector<double> all;
  const auto& s = scene.particles();
  const auto& w = scene.p.water;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const double n = static_cast<double>(w.exponent - 1), stretch = std::pow(s.rho[i] / w.density, n) - 1.0;
    all.push_back(s.x[1][i] + stretch * w.sound * w.sound / n / 9.81);
  }
  return all;
}

}  // namespace

// Three blocks, the middle one under a body: legs of a U-tube, whose water is one.
BOOST_AUTO_TEST_CASE(blocks_of_one_level) {
  scene<2> scene(
      "&domain length_x = 2.0 length_y = 1.5 particles_x = 40 particles_y = 30 / &flow low_x = 0, 0.6, 1.4 high_x = "
      "0.6, 1.4, 2 low_y = 0, 0, 0 high_y = 1, 0.3, 1 / &solids shape = 'box' centre_x = 1 centre_y = 0.9 length_x = "
      "0.8 length_y = 1.2 / &walls slip_top = 'free_surface' / &time t_end = 1 /");
  for (const double level : levels(scene)) BOOST_TEST(level == 1.0, tt::tolerance(1e-12));
}

// Two legs of different heights and what joins them beneath a body: the level falls along the passage, from one surface
// to the other.
BOOST_AUTO_TEST_CASE(blocks_of_two_levels) {
  scene<2> scene(
      tank("low_x = 0, 0.2, 1 high_x = 0.2, 1, 1.2 low_y = 0, 0, 0 high_y = 1, 0.2, 0.6 / &solids shape = "
           "'box' centre_x = 0.6 centre_y = 1.1 length_x = 0.8 length_y = 1.8"));
  const auto found = levels(scene);
  const auto& s = scene.particles();
  std::map<double, double> along_floor;  // by place
  for (std::size_t i = 0; i < s.fluid; ++i) {
    BOOST_TEST((found[i] < 1.0 && found[i] > 0.6));
    const double x = s.x[0][i], y = s.x[1][i];
    if (y < 0.05 && x > 0.2 && x < 1.0) along_floor[x] = found[i];
    if (x < 0.2 && y > 0.95) BOOST_TEST(found[i] == 1.0, tt::tolerance(0.02));
    if (x > 1.0 && y > 0.55) BOOST_TEST(found[i] == 0.6, tt::tolerance(0.04));
  }
  if (scene.f->world.w.d.ranks.size > 1) return;  // each has a part of the floor
  BOOST_TEST(along_floor.size() == 16U);
  for (auto before = along_floor.begin(), after = std::next(before); after != along_floor.end(); ++before, ++after)
    BOOST_TEST(after->second < before->second);
  // Far from the legs the passage is a channel: equal falls.
  const auto fall = [&](double x) {
    const auto at = along_floor.lower_bound(x);
    return std::prev(at)->second - at->second;
  };
  BOOST_TEST(fall(0.51) == fall(0.71), tt::tolerance(0.01));
}
