// Water with a free surface: the liquid, the sums over neighbours, where the surface is, gauges, exact solutions.
#include <mpi.h>

#include <boost/test/unit_test.hpp>
#include <free_surface/gauges.hpp>
#include <free_surface/loads.hpp>
#include <free_surface/measures.hpp>
#include <free_surface/memory.hpp>
#include <free_surface/reference.hpp>
#include <free_surface/surface.hpp>
#include <free_surface/traction.hpp>
#include <fstream>
#include <namelist/document.hpp>
#include <run/passes.hpp>

#include "scene.hpp"

using namespace tetsuame;
using namespace tetsuame::free_surface;
namespace tt = boost::test_tools;

namespace {

// Twenty by ten spacings of 0.05 m, no gravity, free-slip walls far from the block in the middle.
const std::string block_in_the_middle =
    "&domain length_x = 2.0 length_y = 2.0 particles_x = 40 particles_y = 40 jitter = 0.3 /"
    "&flow low_x = 0.5 high_x = 1.5 low_y = 0.75 high_y = 1.25 gravity = 0.0 sound_speed = 20.0 viscosity = 3.0 /"
    "&time t_end = 1.0 /";

// 1 in the continuum; what lattices lack along the axes they have across.
double shear_of_lattice(const pairs::workspace<2>& w) {
  double sum = 0.0;
  for (int i = -4; i <= 4; ++i)
    for (int j = -4; j <= 4; ++j) {
      const double x = i * w.dx, y = j * w.dx, r = std::hypot(x, y);
      if (r > 0.0)
        sum -= 4.0 * w.dx * w.dx * std::get<kernels::wendland_c2<2>>(w.kernel).gradient_over_r(r) * x * x * y * y /
               (r * r);
    }
  return sum;
}

}  // namespace

BOOST_GLOBAL_FIXTURE(mpi_environment);

// p/ρ² = de/dρ, and c² = dp/dρ, by central differences of second order.
BOOST_AUTO_TEST_CASE(pressure_is_the_slope_of_energy) {
  for (const std::int64_t exponent : {1, 7}) {
    const liquid w{1000.0, 20.0, exponent};
    BOOST_TEST(w.pressure(1000.0) == 0.0);
    for (const double rho : {970.0, 1010.0, 1050.0}) {
      const double d = 1e-2;
      const double slope = (w.elastic_energy(rho + d) - w.elastic_energy(rho - d)) / (2.0 * d);
      BOOST_TEST(slope == w.pressure(rho) / (rho * rho), tt::tolerance(1e-5));
      BOOST_TEST(w.density_at(w.pressure(rho)) == rho, tt::tolerance(1e-12));
    }
    BOOST_TEST((w.pressure(1000.01) - w.pressure(999.99)) / 0.02 == 400.0, tt::tolerance(1e-8));
  }
}

BOOST_AUTO_TEST_CASE(eigenvalues) {
  // Rotated by an angle t: of diag(0.3, 0.9), and of diag(0.2, 0.5, 0.8) about z and then x.
  for (const double t : {0.0, 0.4, 1.1, 2.5}) {
    const double c = std::cos(t), s = std::sin(t);
    BOOST_TEST(smallest_eigenvalue(
                   std::array{0.3 * c * c + 0.9 * s * s, (0.9 - 0.3) * s * c, 0.3 * s * s + 0.9 * c * c}) == 0.3,
               tt::tolerance(1e-13));
    const double xx = 0.2 * c * c + 0.5 * s * s, xy = 0.3 * s * c, yy = 0.2 * s * s + 0.5 * c * c;
    BOOST_TEST(smallest_eigenvalue(std::array{xx, c * xy, s * xy, c * c * yy + s * s * 0.8, c * s * (yy - 0.8),
                                              s * s * yy + c * c * 0.8}) == 0.2,
               tt::tolerance(1e-13));
  }
  BOOST_TEST(smallest_eigenvalue(std::array{0.7, 0.0, 0.0, 0.7, 0.0, 0.7}) == 0.7, tt::tolerance(1e-14));
}

// On any arrangement, at its surface too, uniform and rotating motion compress nothing, and a pressure that is
// hydrostatic diffuses nothing.
BOOST_AUTO_TEST_CASE(exact_on_linear_fields) {
  scene<2> scene(block_in_the_middle);
  auto& s = scene.particles();
  auto& w = scene.f->world.w;
  const double g = 9.81;
  for (std::size_t i = 0; i < s.total(); ++i) {
    s.v[0][i] = 0.3 - 2.0 * s.x[1][i];
    s.v[1][i] = -0.1 + 2.0 * s.x[0][i];
    s.rho[i] = 1000.0;
    s.p[i] = 1000.0 * g * (3.0 - s.x[1][i]);
    s.dV[i] = 0.0025;
  }
  std::array<particles::array, 2> force{particles::array(s.fluid), particles::array(s.fluid)};
  particles::array rate(s.fluid);
  w.sum(w.fluid(), motion<2, false>{{pairs::pointers<2>(s.v),
                                     {},
                                     s.p.data(),
                                     s.dV.data(),
                                     s.rho.data(),
                                     0.0,
                                     g,
                                     {force[0].data(), force[1].data()},
                                     rate.data()},
                                    0.1 * 0.065 / 20.0,
                                    0.01 * 20.0});
  // Rounding of sums of some twenty terms of 1000 · 2 1/s.
  for (std::size_t i = 0; i < s.fluid; ++i) BOOST_TEST(std::abs(rate[i]) < 1e-9);
  // Expansion by 3 1/s along x and 1 1/s along y: ρ times the sums' own measure of these, -Σ V F x².
  for (std::size_t i = 0; i < s.total(); ++i) {
    s.v[0][i] = 3.0 * s.x[0][i];
    s.v[1][i] = 1.0 * s.x[1][i];
  }
  w.sum(w.fluid(), motion<2, false>{{pairs::pointers<2>(s.v),
                                     {},
                                     s.p.data(),
                                     s.dV.data(),
                                     s.rho.data(),
                                     0.0,
                                     g,
                                     {force[0].data(), force[1].data()},
                                     rate.data()},
                                    0.0,
                                    0.01 * 20.0});
  const auto& kernel = std::get<kernels::wendland_c2<2>>(w.kernel);
  for (std::size_t i = 0; i < s.fluid; i += 7) {
    double expected = 0.0;
    for (std::size_t j = 0; j < s.total(); ++j) {
      const double x = s.x[0][i] - s.x[0][j], y = s.x[1][i] - s.x[1][j];
      if (i != j) expected += 2.5 * kernel.gradient_over_r(std::hypot(x, y)) * (3.0 * x * x + y * y);
    }
    BOOST_TEST(rate[i] == expected, tt::tolerance(1e-10));
  }
}

// Water that moves as a whole is compressed nowhere: the density's rate is diffusion, which falls as the square of the
// speed below a hundredth of sound's; above, it does not depend on the speed.
BOOST_AUTO_TEST_CASE(slow_water_diffuses_less) {
  scene<2> scene(block_in_the_middle);
  auto& s = scene.particles();
  disturb(scene);
  const double limit = slow * scene.p.water.sound;
  const auto diffused = [&](double speed) {
    for (std::size_t i = 0; i < s.fluid; ++i) s.v[0][i] = speed, s.v[1][i] = 0.0;
    const auto rate = scene.rates()[4];
    return scene.sum([&](std::size_t i) { return std::abs(rate[i]); });
  };
  const double full = diffused(limit);
  BOOST_TEST(full > 1.0);
  BOOST_TEST(diffused(7.0 * limit) == full, tt::tolerance(1e-9));
  BOOST_TEST(diffused(0.5 * limit) == 0.25 * full, tt::tolerance(1e-9));
  BOOST_TEST(diffused(0.0) == 0.0);
}

// Without walls near, forces come in pairs along the line between two particles.
BOOST_AUTO_TEST_CASE(momentum_is_exchanged_pair_by_pair) {
  scene<2> scene(block_in_the_middle);
  auto& s = scene.particles();
  disturb(scene);
  const auto rate = scene.rates();
  const auto scale = scene.sum([&](std::size_t i) { return s.m[i] * std::hypot(rate[2][i], rate[3][i]); });
  BOOST_TEST(scale > 0.0);
  // The two halves of a pair differ by the rounding of their products.
  for (const std::size_t a : {2, 3})
    BOOST_TEST(std::abs(scene.sum([&](std::size_t i) { return s.m[i] * rate[a][i]; })) < 1e-13 * scale);
  const auto torque =
      scene.sum([&](std::size_t i) { return s.m[i] * (s.x[0][i] * rate[3][i] - s.x[1][i] * rate[2][i]); });
  BOOST_TEST(std::abs(torque) < 1e-12 * scale);
}

// Viscosity takes energy whatever moves; pressure and compression exchange it: what pressure takes from the motion is
// what the densities' rates give to the elastic energy.
BOOST_AUTO_TEST_CASE(energy_goes_where_it_should) {
  scene<2> scene(block_in_the_middle);
  auto& o = scene.o;
  auto& s = scene.particles();
  o.flow.delta = 0.0;
  disturb(scene);
  const auto power = [&](const auto& rate) {
    return scene.sum([&](std::size_t i) { return s.m[i] * (s.v[0][i] * rate[2][i] + s.v[1][i] * rate[3][i]); });
  };
  const auto stored = [&](const auto& rate) {
    return scene.sum([&](std::size_t i) { return s.m[i] * s.p[i] / (s.rho[i] * s.rho[i]) * rate[4][i]; });
  };
  const auto viscous = scene.rates();
  BOOST_TEST(power(viscous) + stored(viscous) < 0.0);
  scene.p.kinematic_viscosity = 0.0;
  const auto perfect = scene.rates();
  BOOST_TEST(std::abs(power(perfect) + stored(perfect)) < 1e-12 * std::abs(stored(perfect)));
}

// Shear along a floor that the water sticks to: nothing is compressed, and the floor drags the lowest water, whose
// images move against it. On a slippery floor the sheared water next to it is dragged by the water above alone, with
// it.
BOOST_AUTO_TEST_CASE(floor_of_no_slip) {
  for (const bool sticks : {false, true}) {
    scene<2> scene(
        "&domain length_x = 2.0 length_y = 2.0 particles_x = 40 particles_y = 40 periodic_x = T /"
        "&flow high_y = 0.75 viscosity = 3.0 alpha = 0.0 delta = 0.0 /"
        "&walls slip_bottom = '" +
        std::string(sticks ? "no_slip" : "free_slip") + "' / &time t_end = 1.0 /");
    auto& s = scene.particles();
    for (std::size_t i = 0; i < s.fluid; ++i) s.v[0][i] = s.x[1][i];
    const auto rate = scene.rates();
    const double drag = scene.sum([&](std::size_t i) { return s.m[i] * rate[2][i]; });
    // 3 Pa s times 1 1/s over 2 m, times the lattice's own -4 Σ V F x² y²/r².
    if (sticks)
      BOOST_TEST(drag == -6.0 * shear_of_lattice(scene.f->world.w), tt::tolerance(1e-3));
    else
      BOOST_TEST(std::abs(drag) < 1e-12 * 1500.0);
    for (std::size_t i = 0; i < s.fluid; ++i) BOOST_TEST(std::abs(rate[4][i]) < 1e-9 * 1000.0);
  }
}

// A block in a corner of a tank: its top row and its outermost column, and no other.
BOOST_AUTO_TEST_CASE(surface_of_a_block) {
  scene<2> scene(tank("high_x = 1.0 high_y = 0.75"));
  auto& s = scene.particles();
  const auto found = find_surface(*scene.f);
  for (std::size_t i = 0; i < s.fluid; ++i)
    BOOST_TEST(found[i] == (s.x[0][i] > 0.95 || s.x[1][i] > 0.7), "particle at " << s.x[0][i] << ", " << s.x[1][i]);
}

BOOST_AUTO_TEST_CASE(surface_in_three_dimensions) {
  scene<3> scene(
      "&domain dimension = 3 length_x = 0.6 length_y = 0.8 length_z = 0.5 particles_x = 12 particles_y = 16 "
      "particles_z = "
      "10 / &flow high_x = 0.45 high_y = 0.5 / &time t_end = 1.0 /");
  auto& s = scene.particles();
  const auto found = find_surface(*scene.f);
  for (std::size_t i = 0; i < s.fluid; ++i)
    BOOST_TEST(found[i] == (s.x[0][i] > 0.4 || s.x[1][i] > 0.45),
               "particle at " << s.x[0][i] << ", " << s.x[1][i] << ", " << s.x[2][i]);
}

// Particles that rest do not drift; of those that move, none across the surface, and disorder becomes less.
BOOST_AUTO_TEST_CASE(shifting) {
  const std::string jittered = "jitter = 0.2 ";
  scene<2> still(tank("high_x = 1.0 high_y = 0.75", jittered));
  auto& s = still.particles();
  const auto before = s.x;
  shift(*still.f, 0.01);
  for (std::size_t i = 0; i < s.fluid; ++i) BOOST_TEST(s.x[0][i] == before[0][i]);

  for (std::size_t i = 0; i < s.fluid; ++i) s.v[0][i] = 1.0;
  const auto disorder = [&] {
    find_arrangement(*still.f);
    return still.sum([&](std::size_t i) {
      const bool deep = still.f->least_near[i] >= inside;
      return deep ? std::pow(still.f->slope[0][i], 2) + std::pow(still.f->slope[1][i], 2) : 0.0;
    });
  };
  const double first = disorder();
  for (int k = 0; k < 10; ++k) shift(*still.f, 0.002);
  for (std::size_t i = 0; i < s.fluid; ++i)
    BOOST_TEST(std::hypot(s.x[0][i] - before[0][i], s.x[1][i] - before[1][i]) <= 10.0 * 0.5 * 0.002 * (1.0 + 1e-12));
  BOOST_TEST(disorder() < 0.5 * first);
}

BOOST_AUTO_TEST_CASE(exact_solutions) {
  const standing_wave wave{std::numbers::pi, 1.0, 9.81, 0.05};
  BOOST_TEST(wave.period() == 1.13391748, tt::tolerance(1e-8));
  // The published semi-axes have five digits.
  for (const auto& [t, b] : {std::pair{0.0008, 1.0831}, std::pair{0.0038, 1.4392}, std::pair{0.0076, 1.9445}}) {
    const auto axes = drawn_out(1.0, 100.0, t);
    BOOST_TEST(axes.b == b, tt::tolerance(1e-3));
    BOOST_TEST(axes.a * axes.b == 1.0, tt::tolerance(1e-9));
  }
}

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
  of.odd = 2.0;  // a marker half as far away as the wall particle
  const auto stuck = walls::reflected_velocity<2>(of, {-0.8, 0.6}, true);
  BOOST_TEST(stuck[0] == 1.6, tt::tolerance(1e-12));
  BOOST_TEST(stuck[1] == -1.2, tt::tolerance(1e-12));
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

// What is too slow for what it has risen by is left without the velocity across, and with less along the body.
BOOST_AUTO_TEST_CASE(who_rises_pays) {
  const solids::point<2> up{{0.0, 1.0}};
  solids::point<2> u{{0.3, 0.1}};
  pay_for_rise<2>(9.8, 1e-3, up, u);  // 0.0196 of 0.01 + 0.09
  BOOST_TEST(u[1] == 0.0);
  BOOST_TEST(u[0] * u[0] == 0.09 + 0.01 - 0.0196, tt::tolerance(1e-12));
  pay_for_rise<2>(9.8, 1.0, up, u);
  BOOST_TEST(foundation::dot(u, u) == 0.0);
  u = {{0.3, -0.1}};
  pay_for_rise<2>(9.8, -1.0, up, u);  // sinks
  BOOST_TEST(u[0] == 0.3);
  BOOST_TEST(u[1] == -0.1, tt::tolerance(1e-12));
}
