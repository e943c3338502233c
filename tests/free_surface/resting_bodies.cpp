// Water beside bodies that stand still: what stands in them, and who comes to them.
#include <boost/test/unit_test.hpp>
#include <free_surface/free_bodies.hpp>
#include <free_surface/memory.hpp>
#include <run/passes.hpp>

#include "scene.hpp"

using namespace tetsuame;
using namespace tetsuame::free_surface;
namespace tt = boost::test_tools;

namespace {

// A wedge on the floor, whose edge is well beneath the surface of the water, or above it.
std::string wedge(const std::string& high, const std::string& more = "") {
  return "&domain length_x = 2.0 length_y = 1.5 particles_x = 40 particles_y = 30 / &flow high_y = " + high +
         " around_bodies = T / &solids body = 'wedge' shape = 'box' centre_x = 1.0 centre_y = -0.01 angle_z = 45.0"
         " length_x = 0.7 length_y = 0.7 / &walls slip_top = 'free_surface' " +
         more + " / &time t_end = 1.0 /";
}

}  // namespace

// What stands in the wedge balances gravity as water would that filled it: near the wedge as elsewhere. Without the
// weight of water from the marker to the wall particle some tenths of g would be left.
BOOST_AUTO_TEST_CASE(still_water_on_a_body) {
  scene<2> scene(wedge("1.0"));
  const auto rate = scene.rates();
  auto& s = scene.particles();
  const auto& f = *scene.f;
  double near = 0.0, largest_compression_rate = 0.0;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const auto x = f.place(i);
    BOOST_TEST(f.solid.level(of_solids<2>(x)) > 0.0);
    largest_compression_rate = std::max(largest_compression_rate, std::abs(rate[4][i]) / 1000.0);
    if (x[1] > 0.2 && x[1] < 0.75) near = std::max({near, std::abs(rate[2][i]), std::abs(rate[3][i])});
  }
  BOOST_TEST(f.ranks().maximum(near) < 0.02 * f.gravity());
  BOOST_TEST(f.ranks().maximum(largest_compression_rate) < 1e-2);
  BOOST_TEST(f.ranks().sum(static_cast<std::int64_t>(f.world.walls.bodies.places.size())) > 0);
}

// A wall particle has the volume of water that its marker has about it: all of it from a spacing below the surface on,
// none of it a spacing above.
BOOST_AUTO_TEST_CASE(bodies_are_as_wet_as_their_markers) {
  scene<2> scene(wedge("0.25"));
  scene.rates();
  const auto& s = scene.particles();
  const auto& walls = scene.f->world.walls;
  const double V = scene.f->dx() * scene.f->dx();
  for (std::size_t r = 0; r < walls.bodies.places.size(); ++r) {
    const double below = 0.25 - walls.bodies.places[r].marker[1];
    const double part = s.dV[s.first_wall() + r] / V;
    if (below > scene.f->dx()) BOOST_TEST(part == 1.0, tt::tolerance(0.02));
    if (below < -scene.f->dx()) BOOST_TEST(part == 0.0);
    BOOST_TEST((part >= 0.0 && part < 1.02));
  }
}

// Each rank has the places whose markers are in its cell; when cuts move, all of them are still there, in their order.
BOOST_AUTO_TEST_CASE(places_follow_the_cuts) {
  scene<2> scene(wedge("0.25"));
  auto& f = *scene.f;
  const auto& places = f.world.walls.bodies.places;
  const auto all_of = [&](const auto& value) {
    double sum = 0.0;
    for (const auto& place : places) sum += value(place);
    std::array all{sum};
    f.ranks().sum(all);
    return all[0];
  };
  const auto number = [&] { return all_of([](const auto&) { return 1.0; }); };
  const auto numbers = [&] { return all_of([](const auto& place) { return static_cast<double>(place.number); }); };
  const auto heights = [&] { return all_of([](const auto& place) { return place.height + place.x[0]; }); };
  const double before = number(), numbers_before = numbers(), heights_before = heights();
  BOOST_TEST(before > 0.0);
  for (auto& component : f.world.w.d.cuts.at)
    for (std::size_t n = 1; n + 1 < component.size(); ++n) component[n] *= 0.7;
  hand_over_walls(f);
  BOOST_TEST(number() == before);
  BOOST_TEST(numbers() == numbers_before);
  BOOST_TEST(heights() == heights_before, tt::tolerance(1e-12));
  const auto cell = f.world.w.d.cell();
  for (const auto& place : places) BOOST_TEST(f.world.w.d.within(cell, place.marker));
  BOOST_TEST(std::ranges::is_sorted(places, {}, &walls::body_place<2>::number));
}

// What a run will need is told before anything is laid out, by places spread over the box: water, wall particles of
// bodies, images of both.
BOOST_AUTO_TEST_CASE(numbers_before_the_start) {
  scene<2> scene(wedge("1.0"));
  const auto told = numbers_at_start(scene.o, scene.p);
  const auto& f = *scene.f;
  const auto all = [&](std::size_t of_rank) {
    return static_cast<double>(f.ranks().sum(static_cast<std::int64_t>(of_rank)));
  };
  BOOST_TEST(told.fluid == all(f.world.w.s.fluid), tt::tolerance(0.03));
  BOOST_TEST(told.in_bodies == all(f.world.walls.bodies.places.size()), tt::tolerance(0.1));
  if (f.ranks().size == 1) BOOST_TEST(told.images == all(f.world.walls.source.size()), tt::tolerance(0.1));
  const auto need = need_of(scene.o, scene.p);
  BOOST_TEST(need.particles == told.fluid);
  // Each field of each particle has a place.
  const auto& s = f.world.w.s;
  BOOST_TEST(need.total() > all(s.total()) * (2 * 3 + 14) * 8.0);
}

// A little water in a large box takes what the water does: nothing is laid out for the whole box.
BOOST_AUTO_TEST_CASE(room_for_the_water_alone) {
  scene<2> scene(tank("high_x = 0.4 high_y = 0.4"));
  const auto& s = scene.particles();
  BOOST_TEST(scene.f->ranks().sum(static_cast<std::int64_t>(s.fluid)) == 64);
  BOOST_TEST(static_cast<double>(s.rho.capacity()) < 1.1 * static_cast<double>(s.total()) + 8.0);
}

// Linear in the velocity: what a wall particle has of a velocity across the surface, and along it.
BOOST_AUTO_TEST_CASE(velocities_in_bodies) {
  walls::body_place<2> of;
  of.normal = {0.6, 0.8};
  const auto across = walls::reflected_velocity<2>(of, {1.2, 1.6}, false);
  BOOST_TEST(across[0] == -1.2, tt::tolerance(1e-12));
  BOOST_TEST(across[1] == -1.6, tt::tolerance(1e-12));
  const auto along = walls::reflected_velocity<2>(of, {-0.8, 0.6}, false);
  BOOST_TEST(along[0] == -0.8, tt::tolerance(1e-12));
  of.reflection_ratio = 2.0;  // a marker half as far away as the wall particle
  const auto stuck = walls::reflected_velocity<2>(of, {-0.8, 0.6}, true);
  BOOST_TEST(stuck[0] == 1.6, tt::tolerance(1e-12));
  BOOST_TEST(stuck[1] == -1.2, tt::tolerance(1e-12));
}

// The power of water without viscosity and diffusion, above a floor of this turn (degrees) that is not along the
// lattice: of what its motion loses to pressure and its densities do not get as elastic energy, over that which they
// do.
template <class Velocity>
double lost_in_walls(const std::string& turn, const Velocity& velocity) {
  scene<2> scene(
      "&domain length_x = 1.0 length_y = 1.0 particles_x = 40 particles_y = 40 /"
      "&flow high_y = 0.7 around_bodies = T delta = 0.0 / &walls slip_top = 'free_surface' /"
      "&solids body = 'floor' shape = 'box' centre_x = 0.5 centre_y = -0.4 length_x = 3.0 length_y = 1.233 angle_z = " +
      turn + " / &kernel name = 'wendland_c2' h_over_dx = 1.5 / &time t_end = 1.0 /");
  auto& s = scene.particles();
  scene.p.kinematic_viscosity = 0.0;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const auto v = velocity(scene.f->place(i), s.id[i]);
    for (std::size_t a = 0; a < 2; ++a) s.v[a][i] = v[a];
    s.rho[i] *= 1.03 + 0.002 * noise(s.id[i], 2);
  }
  const auto rate = scene.rates();
  auto& f = *scene.f;
  const auto taken = [&](std::size_t i) {
    return -s.m[i] * (s.v[0][i] * rate[2][i] + s.v[1][i] * (rate[3][i] + f.gravity()));
  };
  const auto stored = [&](std::size_t i) { return s.m[i] * s.p[i] / (s.rho[i] * s.rho[i]) * rate[4][i]; };
  const double all = scene.sum([&](std::size_t i) { return std::abs(stored(i)); });
  return std::abs(scene.sum(taken) - scene.sum(stored)) / all;
}

// What the pressure in a body takes from motion across its surface the densities get as elastic energy, but for what is
// beyond the limit of the wall's velocities; in slow water also what it takes from motion along it.
BOOST_AUTO_TEST_CASE(bodies_take_no_energy) {
  const auto up_and_down = [](const point&, std::int64_t id) { return std::array{0.0, noise(id, 1)}; };
  BOOST_TEST(lost_in_walls("0.0", up_and_down) < 2e-4);
  const auto about = [](double speed) {
    return [speed](const point&, std::int64_t id) { return std::array{speed * noise(id, 2), speed * noise(id, 1)}; };
  };
  BOOST_TEST(lost_in_walls("20.0", about(1e-4)) < 1e-4);
  BOOST_TEST(lost_in_walls("20.0", about(1.0)) > 2e-4);  // fast water: but for motion along
}

// What has entered a body is put back to its mirror image, and moves away, slower by what it has risen.
BOOST_AUTO_TEST_CASE(bodies_let_nothing_in) {
  scene<2> scene(wedge("1.0"));
  auto& s = scene.particles();
  auto& f = *scene.f;
  find_beside_bodies(f);
  double nearest = 1.0;
  std::uint32_t i = 0;
  for (const std::uint32_t k : f.beside_bodies)
    if (const auto at = f.solid.at(of_solids<2>(f.place(k)));
        at.distance < nearest && std::abs(at.normal[0] + std::sqrt(0.5)) < 1e-6) {  // on the wedge's left face
      nearest = at.distance;
      i = k;
    }
  BOOST_REQUIRE(put_out_of_bodies(f) == 0);
  const bool mine = nearest < 1.0;
  if (mine) {
    const double to_surface = nearest * std::sqrt(0.5);
    s.x[0][i] += to_surface + 0.01;
    s.x[1][i] -= to_surface + 0.01;
    s.v[0][i] = 3.0;
    s.v[1][i] = 1.0;
  }
  BOOST_TEST(put_out_of_bodies(f) == (mine ? 1 : 0));
  if (!mine) return;
  BOOST_TEST(f.solid.at(of_solids<2>(f.place(i))).distance == 0.01 * std::sqrt(2.0), tt::tolerance(1e-9));
  const double vx = s.v[0][i], vy = s.v[1][i], risen = 0.02;
  BOOST_TEST(vy > vx);
  BOOST_TEST(vx + vy == 4.0, tt::tolerance(1e-9));  // along the face
  BOOST_TEST(vx * vx + vy * vy + 2.0 * f.gravity() * risen == 10.0, tt::tolerance(1e-9));
}

// What lies on a body stays where it is: it loses its velocity into the body, and is not accelerated into it.
BOOST_AUTO_TEST_CASE(bodies_hold_what_lies_on_them) {
  scene<2> scene(wedge("1.0"));
  auto& s = scene.particles();
  auto& f = *scene.f;
  const solids::point<2> n{{-std::sqrt(0.5), std::sqrt(0.5)}};
  std::optional<std::uint32_t> on;
  for (const std::uint32_t k : f.beside_bodies)
    if (const auto at = f.solid.at(of_solids<2>(f.place(k))); solids::norm<2>(at.normal - n) < 1e-6) {
      on = k;
      for (std::size_t a = 0; a < 2; ++a) {
        s.x[a][k] -= (at.distance + 0.01 * f.dx()) * n[a];
        s.v[a][k] = 0.2 * (n[1 - a] * (a == 0 ? 1.0 : -1.0) - n[a]);  // along the surface, and as fast into it
      }
      s.rho[k] *= 0.9;  // the water about it presses it into the body
      break;
    }
  const auto before = on ? f.place(*on) : point{};
  BOOST_TEST(put_out_of_bodies(f) == 0);
  BOOST_TEST(f.ranks().sum(static_cast<std::int64_t>(f.held.size())) == f.ranks().sum(std::int64_t{on ? 1 : 0}));
  const auto rate = scene.rates();
  f.held.clear();
  const auto free = scene.rates();
  if (!on) return;
  for (std::size_t a = 0; a < 2; ++a) BOOST_TEST(f.place(*on)[a] == before[a]);
  const solids::point<2> v{{s.v[0][*on], s.v[1][*on]}}, acceleration{{rate[2][*on], rate[3][*on]}};
  BOOST_TEST(std::abs(foundation::dot(v, n)) < 1e-12);
  BOOST_TEST(solids::norm<2>(v) == 0.2, tt::tolerance(1e-12));
  BOOST_TEST(std::abs(foundation::dot(acceleration, n)) < 1e-9);
  // Without the body it would be accelerated into it.
  BOOST_TEST(foundation::dot(solids::point<2>{{free[2][*on], free[3][*on]}}, n) < -1.0);
}

// What is too slow for what it has risen by is left without the velocity across, and with less along the body.
BOOST_AUTO_TEST_CASE(who_rises_pays) {
  const solids::point<2> up{{0.0, 1.0}};
  solids::point<2> u{{0.3, 0.1}};
  rigid::pay_for_rise<2>(9.8, 1e-3, up, u);  // 0.0196 of 0.01 + 0.09
  BOOST_TEST(u[1] == 0.0);
  BOOST_TEST(u[0] * u[0] == 0.09 + 0.01 - 0.0196, tt::tolerance(1e-12));
  rigid::pay_for_rise<2>(9.8, 1.0, up, u);
  BOOST_TEST(foundation::dot(u, u) == 0.0);
  u = {{0.3, -0.1}};
  rigid::pay_for_rise<2>(9.8, -1.0, up, u);  // sinks
  BOOST_TEST(u[0] == 0.3);
  BOOST_TEST(u[1] == -0.1, tt::tolerance(1e-12));
}
