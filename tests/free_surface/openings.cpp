// Who enters and leaves at sections of the sides, and what moves the zones there.
#include <boost/test/unit_test.hpp>
#include <free_surface/openings.hpp>
#include <set>

#include "scene.hpp"

using namespace tetsuame;
using namespace tetsuame::free_surface;
namespace tt = boost::test_tools;

BOOST_GLOBAL_FIXTURE(mpi_environment);

namespace {

// One metre of water, 0.5 m deep, of twenty spacings by ten, that flows at 1.5 m/s.
const std::string channel =
    "&domain length_x = 1.0 length_y = 1.0 particles_x = 20 particles_y = 20 / &flow high_y = 0.5 / "
    "&region velocity_x = '1.5' / &inflow side = 'left' high_y = 0.5 velocity = '1 + y' / &outflow side = 'right' / "
    "&time t_end = 1.0 /";

constexpr std::size_t mass = passed_through<2>::mass, number = passed_through<2>::number;

double mass_of(scene<2>& of) {
  return of.sum([&](std::size_t i) { return of.particles().m[i]; });
}

}  // namespace

BOOST_AUTO_TEST_CASE(a_layer_enters_and_another_leaves) {
  scene<2> scene(channel);
  auto& f = *scene.f;
  auto& s = scene.particles();
  const double L = f.p.openings[0].length, before = mass_of(scene);
  BOOST_TEST(L == 5 * 0.05, tt::tolerance(1e-14));
  BOOST_TEST(!pass_openings(f));  // nobody has moved
  // The foremost layer of the one zone passes its end, that of the other stands within half the skin of the side.
  for (std::size_t i = 0; i < s.fluid; ++i)
    if (f.zone[i] != 0.0) s.x[0][i] += f.zone[i] > 0.0 ? 0.026 : 0.015;
  BOOST_TEST(pass_openings(f));
  BOOST_TEST(f.entered[number] == 10.0);
  BOOST_TEST(f.left[number] == 10.0);
  BOOST_TEST(mass_of(scene) == before + f.entered[mass] - f.left[mass], tt::tolerance(1e-15));
  const double zones = scene.sum([&](std::size_t i) { return f.zone[i] > 0.0 ? 1.0 : 0.0; });
  BOOST_TEST(zones == 50.0);
  scene.rebuild();
  // On their ranks, each where the one before it stood, less L, with the ID that is 50 above.
  const std::int64_t first = 200;  // of the zone; blocks have 200 places
  std::set<std::int64_t> ids;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    BOOST_TEST(f.world.w.d.within(f.world.w.d.cell(), particles::position<2>(s.x, i)));
    BOOST_TEST(ids.insert(s.id[i]).second);
    if (s.id[i] < first + 50) continue;
    BOOST_TEST(s.x[0][i] == 0.225 + 0.026 - L, tt::tolerance(1e-12));
    BOOST_TEST(s.v[0][i] == 1.0 + s.x[1][i], tt::tolerance(1e-14));
    BOOST_TEST(f.zone[i] == 1.0);
  }
  const double entered = scene.sum([&](std::size_t i) { return s.id[i] >= first + 50 ? 1.0 : 0.0; });
  BOOST_TEST(entered == 10.0);
}

BOOST_AUTO_TEST_CASE(zones_keep_their_state) {
  scene<2> scene(channel);
  auto& f = *scene.f;
  auto& s = scene.particles();
  disturb(scene);
  const auto rates = scene.rates();
  double moves = 0.0;
  for (std::size_t i = 0; i < s.fluid; ++i)
    for (std::size_t k = 2; k < 5; ++k) {
      if (f.zone[i] != 0.0) BOOST_TEST(rates[k][i] == 0.0);
      moves = std::max(moves, std::abs(rates[k][i]));
    }
  BOOST_TEST(f.ranks().maximum(moves) > 0.0);
}

// Of uniform motion the velocity, of still water under its weight the pressure, but for its change with density.
BOOST_AUTO_TEST_CASE(outflows_take_what_comes_behind) {
  scene<2> scene(channel);
  auto& f = *scene.f;
  auto& s = scene.particles();
  std::vector<double> still(s.fluid);
  for (std::size_t i = 0; i < s.fluid; ++i) {
    still[i] = f.p.water.pressure(f.p.water.density_beneath(9.81 * (0.5 - s.x[1][i])));
    s.rho[i] = f.p.water.density_at(still[i]);
    if (f.zone[i] < 0.0) {
      s.v[0][i] = 0.2;
      s.rho[i] = 1000.0;
    } else {
      s.v[0][i] = 1.3;
    }
  }
  // The kernel takes three and a half layers along: five are reached by the second time, and forget by and by.
  for (int n = 0; n < 60; ++n) guide_outflows(f);
  for (std::size_t i = 0; i < s.fluid; ++i) {
    if (!(f.zone[i] < 0.0)) continue;
    BOOST_TEST(s.v[0][i] == 1.3, tt::tolerance(1e-6));
    BOOST_TEST(s.v[1][i] == 0.0);
    BOOST_TEST(std::abs(f.p.water.pressure(s.rho[i]) - still[i]) < 0.01 * 9810.0 * 0.5);
  }
}

BOOST_AUTO_TEST_CASE(sums_keep_what_adding_rounds_off) {
  passed_through<2> of;
  constexpr std::size_t size = passed_through<2>::size;
  std::array<double, size> large{}, small{};
  large.fill(1.0);
  small.fill(1e-17);
  of.add(large);
  for (int n = 0; n < 1000; ++n) of.add(small);
  BOOST_TEST(of[mass] == 1.0 + 1e-14, tt::tolerance(3e-16));
  BOOST_TEST(of.sum[mass] == 1.0);
}
