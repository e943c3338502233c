// Bodies in water that move: rigid motion of all, forces against the water's own, free bodies, restarts.
#include <mpi.h>

#include <boost/test/unit_test.hpp>
#include <free_surface/budget.hpp>
#include <free_surface/measures.hpp>
#include <free_surface/surface.hpp>
#include <namelist/document.hpp>
#include <numbers>
#include <run/passes.hpp>

#include "scene.hpp"

using namespace tetsuame;
using namespace tetsuame::free_surface;
namespace tt = boost::test_tools;

namespace {

// A block of water, 30 by 20 spacings of 0.05 m, about a tilted box in its middle, far from all sides.
std::string blob(const std::string& motion, const std::string& scheme = "delta") {
  return "&domain length_x = 2.5 length_y = 2.0 particles_x = 50 particles_y = 40 /"
         "&flow low_x = 0.5 high_x = 2.0 low_y = 0.5 high_y = 1.5 gravity = 0.0 sound_speed = 20.0 viscosity = 3.0"
         " delta = 0.0 around_bodies = .true. scheme = '" +
         scheme +
         "' /"
         "&solids body = 'box' shape = 'box' centre_x = 1.25 centre_y = 1.0 length_x = 0.5 length_y = 0.35 angle_z = "
         "20 /"
         "&motions body = 'box' " +
         motion + "/ &gauges force = 'box' / &time t_end = 1.0 /";
}

// Any state: velocities of some m/s, densities some per cent apart.
template <int D>
void disturb(scene<D>& scene) {
  auto& s = scene.particles();
  for (std::size_t i = 0; i < s.fluid; ++i) {
    for (std::size_t a = 0; a < D; ++a) s.v[a][i] = noise(s.id[i], static_cast<int>(a));
    s.rho[i] = 1000.0 * (1.02 + 0.02 * noise(s.id[i], 7));
  }
}

}  // namespace

BOOST_GLOBAL_FIXTURE(mpi_environment);

// Water that turns and travels with the body as a whole is compressed nowhere and drags nothing, wherever on its way
// the body is, though the lists are older; and again with new ones.
BOOST_AUTO_TEST_CASE(rigid_motion) {
  for (const std::string how : {"kind = 'harmonic' period = 2.0 amplitude_x = 0.2 amplitude_y = -0.1 amplitude_angle = "
                                "20 pivot_x = 1.1 pivot_y = 0.9",
                                "kind = 'free' density = 700.0"})
    for (const char* slip : {"", "&walls slip = 'no_slip' /"}) {
      scene<2> scene(blob(how) + slip);
      auto& f = *scene.f;
      auto& s = scene.particles();
      for (const bool anew : {false, true}) {
        const double t = 0.02;
        if (!f.free.empty() && f.ranks().rank == 0) {
          f.free.state[0][0] = 0.01;                 // m
          f.free.state[2][0] = 0.3;                  // m/s
          f.free.state[4][0] = 0.02;                 // radians
          f.free.state[5][0] = anew ? -0.4 : 1e-12;  // 1/s
        }
        set_bodies_at(f, t);
        BOOST_TEST(bodies_moved(f) > 0.0);
        if (anew) scene.rebuild();
        const auto& b = f.moving.front();
        BOOST_TEST(bodies_speed(f) > 0.2);
        for (std::size_t i = 0; i < s.fluid; ++i) {
          const auto u = b.rate.at(of_solids<2>(f.place(i)));
          for (std::size_t a = 0; a < 2; ++a) s.v[a][i] = u[a];
          s.rho[i] = 1000.0;
        }
        const auto rate = scene.rates();
        double compressed = 0.0, dragged = 0.0;
        for (std::size_t i = 0; i < s.fluid; ++i) {
          compressed = std::max(compressed, std::abs(rate[4][i]));
          // What accelerates the body, its spin too, presses the wall; but for that nothing acts.
          if (!f.free.empty() && !anew) dragged = std::max(dragged, std::hypot(f.force[0][i], f.force[1][i]));
        }
        BOOST_TEST(compressed < 1e-8);  // kg/(m3 s), of some 1000 where a body's velocity is not seen
        BOOST_TEST(dragged < 1e-9);     // N, of 2.5 kg particles
      }
    }
}

// A pressure that rises towards a wall as the body's acceleration has it is what its wall particles go on with: a
// straight line, so that deep water beside the body feels -∇p as that inside does.
BOOST_AUTO_TEST_CASE(accelerated_wall) {
  scene<2> scene(blob("kind = 'harmonic' period = 2.0 phase = 90 amplitude_x = 0.1 amplitude_y = 0.05"));
  auto& f = *scene.f;
  auto& s = scene.particles();
  set_bodies_at(f, 0.0);
  const auto a = f.moving.front().rate.acceleration;
  BOOST_TEST(a[0] == -0.1 * std::numbers::pi * std::numbers::pi, tt::tolerance(1e-12));
  const auto p = [&](std::size_t i) { return -1000.0 * (a[0] * (s.x[0][i] - 1.35) + a[1] * (s.x[1][i] - 1.05)); };
  for (std::size_t i = 0; i < s.fluid; ++i) s.rho[i] = f.p.water.density_at(p(i));
  scene.rates();
  double worst = 0.0;
  std::size_t wet = 0;
  for (std::size_t i = s.first_wall(); i < s.first_wall() + s.walls; ++i)
    if (s.dV[i] > 0.0) {
      worst = std::max(worst, std::abs(s.p[i] - p(i)));
      ++wet;
    }
  BOOST_TEST(f.ranks().sum(static_cast<std::int64_t>(wet)) > 20);
  BOOST_TEST(worst < 3.0);  // Pa, of 100 between a wall particle and its marker: density is not quite 1000 kg/m3
}

// What the body gains the water loses, of momentum and of angular momentum, whatever the state; about any point.
template <int D>
void balance_of(scene<D>& scene) {
  auto& f = *scene.f;
  auto& s = scene.particles();
  disturb(scene);
  const auto rate = scene.rates();
  solids::point<D> about = foundation::zero<double, D>();
  about[0] = 0.3;
  const auto load = loads_on(f, {0}, {about}).front();
  for (std::size_t a = 0; a < D; ++a) {
    const double force = scene.sum([&](std::size_t i) { return f.force[a][i]; });
    const double size = scene.sum([&](std::size_t i) { return std::abs(f.force[a][i]); });
    BOOST_TEST(size > 100.0);
    BOOST_TEST(std::abs(load.force[a]) > 1e-8 * size);  // a light body gives way
    BOOST_TEST(std::abs(force + load.force[a]) < 1e-12 * size);
    // Of water and body.
    if (!f.free.empty()) {
      double of_body = f.ranks().rank == 0 ? f.moving.front().free->mass * rate[2 * D + 1 + D + a][0] : 0.0;
      MPI_Bcast(&of_body, 1, MPI_DOUBLE, 0, f.ranks().comm);
      const double of_water = scene.sum([&](std::size_t i) { return s.m[i] * rate[D + a][i]; });
      BOOST_TEST(std::abs(of_water + of_body) < 1e-12 * size);
    }
  }
  for (std::size_t k = 0; k < (D == 2 ? 1 : 3); ++k) {
    const auto of = [&](std::size_t i) {
      const auto F = solids::point<D>::of([&](std::size_t a) { return f.force[a][i]; });
      return solids::moment<D>(of_solids<D>(f.place(i)) - about, F)[k];
    };
    const double size = scene.sum([&](std::size_t i) { return std::abs(of(i)); });
    BOOST_TEST(std::abs(scene.sum(of) + load.moment[k]) < 1e-12 * size);
  }
}

BOOST_AUTO_TEST_CASE(momentum_in_2d) {
  for (const char* how : {"kind = 'harmonic' period = 2.0 amplitude_x = 0.2 amplitude_angle = 5",
                          "kind = 'free' mass = 90.0", "kind = 'free' density = 1.0"})
    for (const char* scheme : {"delta", "riemann"}) {
      scene<2> scene(blob(how, scheme) + "&walls slip = 'no_slip' /");
      balance_of(scene);
    }
}

BOOST_AUTO_TEST_CASE(momentum_in_3d) {
  for (const std::string density : {"500.0", "1.0"}) {
    scene<3> scene(
        "&domain dimension = 3 length_x = 2.0 length_y = 2.0 length_z = 2.0 particles_x = 20 particles_y = 20 "
        "particles_z = 20 /"
        "&flow low_x = 0.6 high_x = 1.4 low_y = 0.6 high_y = 1.4 low_z = 0.6 high_z = 1.4 gravity = 0.0 sound_speed = "
        "20.0"
        " viscosity = 3.0 around_bodies = .true. /"
        "&kernel name = 'wendland_c2' h_over_dx = 1.2 skin = 0.3 /"
        "&solids body = 'box' shape = 'sphere' centre_x = 1.0 centre_y = 1.0 centre_z = 1.0 radius = 0.3 /"
        "&motions body = 'box' kind = 'free' density = " +
        density +
        " gyration_x = 0.1 gyration_y = 0.12 gyration_z = 0.13 /"
        "&gauges force = 'box' / &time t_end = 1.0 /");
    balance_of(scene);
  }
}

// The pressure of a free body's wall particles knows its acceleration, which follows from that pressure: what they have
// is what comes of it, however light the body is, in components of the spin too; and no body gains more than the water
// that is pushed away with it lets it.
template <int D>
void accelerations_of(const std::string& input) {
  scene<D> scene(input);
  auto& f = *scene.f;
  const auto rate = scene.rates();
  const auto& b = f.moving.front();
  BOOST_TEST(b.rate.acceleration[1] > 1.0);  // its draught is above what it should be
  if (f.ranks().rank != 0) return;
  const auto of_state = [&](std::size_t k) { return rate[2 * D + 1 + k][0]; };
  for (std::size_t a = 0; a < D; ++a)
    BOOST_TEST(std::abs(of_state(D + a) - b.rate.acceleration[a]) < 1e-10 * b.rate.acceleration[1]);
  constexpr std::size_t turns = moving_body<D>::turns, first = 2 * D + moving_body<D>::angles;
  solids::free_body<D> spun = *b.free;
  for (std::size_t a = 0; a < turns; ++a) spun.angular_momentum[a] = b.spin_scale() * of_state(first + a);
  const auto turning = spun.angular_velocity(b.now.turned);  // I⁻¹ T: the body has no spin
  for (std::size_t a = 0; a < turns; ++a)
    BOOST_TEST(std::abs(turning[a] - b.rate.angular_acceleration[a]) < 1e-9 * b.rate.acceleration[1]);
}

BOOST_AUTO_TEST_CASE(accelerations) {
  for (const char* scheme : {"delta", "riemann"})
    for (const char* density : {"1.0", "300.0"}) {
      accelerations_of<2>(
          "&domain length_x = 2.0 length_y = 1.4 particles_x = 40 particles_y = 28 /"
          "&flow high_y = 1.0 around_bodies = .true. scheme = '" +
          std::string(scheme) +
          "' / &solids body = 'box' shape = 'box' centre_x = 1.1 centre_y = 0.9 length_x = 0.6 length_y = 0.5 angle_z "
          "= 10 / &motions body = 'box' kind = 'free' density = " +
          density + " / &time t_end = 1.0 /");
      accelerations_of<3>(
          "&domain dimension = 3 length_x = 1.2 length_y = 1.2 length_z = 1.2 particles_x = 24 particles_y = 24"
          " particles_z = 24 / &flow high_y = 0.7 around_bodies = .true. scheme = '" +
          std::string(scheme) +
          "' / &solids body = 'ball' shape = 'sphere' centre_x = 0.55 centre_y = 0.65 centre_z = 0.6 radius = 0.25 /"
          "&motions body = 'ball' kind = 'free' density = " +
          density + " gyration_x = 0.1 gyration_y = 0.12 gyration_z = 0.13 / &time t_end = 1.0 /");
    }
}

// Without any water that is dragged along a body would be accelerated by the weight of what it displaces.
BOOST_AUTO_TEST_CASE(water_is_dragged_along) {
  scene<2> scene(
      "&domain length_x = 2.0 length_y = 1.4 particles_x = 40 particles_y = 28 /"
      "&flow high_y = 1.0 around_bodies = .true. /"
      "&solids body = 'box' shape = 'box' centre_x = 1.1 centre_y = 0.9 length_x = 0.6 length_y = 0.5 /"
      "&motions body = 'box' kind = 'free' density = 300.0 / &time t_end = 1.0 /");
  const auto rate = scene.rates();
  if (scene.f->ranks().rank == 0) BOOST_TEST(rate[5 + 3][0] < 9.81 * (0.35 / (0.3 * 0.5) - 1.0));
}

// The weight of the water that a box at rest deep in it displaces, and its centre; less exactly, as sums near walls
// are.
BOOST_AUTO_TEST_CASE(buoyancy) {
  scene<2> scene(
      "&domain length_x = 2.0 length_y = 2.0 particles_x = 40 particles_y = 40 /"
      "&flow high_y = 1.5 around_bodies = .true. sound_factor = 30.0 /"
      "&solids body = 'floor', 'box' shape = 'box', 'box' centre_x = 1.0, 1.0 centre_y = 0.0, 0.75 length_x = 5.0, 0.5"
      " length_y = 0.2, 0.5 / &gauges force = 'box' / &time t_end = 1.0 /");
  auto& f = *scene.f;
  const auto load = read_loads(f).front();
  const double weight = 1000.0 * 9.81 * 0.25;
  BOOST_TEST(load.force[1] == weight, tt::tolerance(0.03));
  // Wall particles on the diagonals from the corners have their markers on one side of these.
  BOOST_TEST(std::abs(load.force[0]) < 1e-5 * weight);
  BOOST_TEST(std::abs(load.moment[0]) < 1e-5 * weight);
  // The floor carries the rest: of 1.4 m of water, the box and its own weight left out, all below the box and beside
  // it.
  const auto all = loads_on(f, {0}, {foundation::zero<double, 2>()}).front();
  BOOST_TEST(all.force[1] == -1000.0 * 9.81 * 1.4 * 2.0, tt::tolerance(0.03));
}

// Lists may be made anew at any time: the same places, markers and IDs on any ranks; and back from a checkpoint.
BOOST_AUTO_TEST_CASE(state_of_bodies) {
  scene<2> scene(blob("kind = 'free' density = 700.0"));
  auto& f = *scene.f;
  if (f.ranks().rank == 0) {
    f.free.state[0][0] = 0.3;
    f.free.state[4][0] = 0.5;
  }
  set_bodies_at(f, 0.0);
  scene.rebuild();
  // Their number and mean place, of all ranks.
  const auto markers = [&] {
    std::vector<double> all(3, 0.0);
    for (const auto& place : f.world.walls.bodies.places) {
      all[0] += 1.0;
      for (std::size_t a = 0; a < 2; ++a) all[1 + a] += place.marker[a];
    }
    f.ranks().sum(all);
    return all;
  };
  const auto before = markers();
  auto saved = saved_bodies(f);
  saved.resize(6 + 6);
  MPI_Bcast(saved.data(), static_cast<int>(saved.size()), MPI_DOUBLE, 0, f.ranks().comm);
  if (f.ranks().rank == 0) f.free.state[0][0] = 0.0;
  set_bodies_at(f, 0.0);
  scene.rebuild();
  BOOST_TEST(markers() != before);
  restore_bodies(f, saved, 0.0);
  place_bodies_for_lists(f, true);
  BOOST_TEST(markers() == before);
  BOOST_TEST(f.moving.front().now.shift[0] == 0.3);
}

// What has entered a free body leaves it with what the body loses, of momentum and of angular momentum, and as fast as
// it came; whatever the body weighs, whoever comes first.
template <int D>
void put_back_of(const std::string& input) {
  scene<D> scene(input);
  auto& f = *scene.f;
  auto& s = scene.particles();
  const auto& b = f.moving.front();
  disturb(scene);
  // Water from beside the body goes into it, and towards its middle.
  std::size_t entered = 0;
  for (const std::uint32_t i : f.beside_bodies) {
    const auto surface = f.solid.at(of_solids<D>(f.place(i)));
    if (surface.distance > 0.8 * f.dx() || s.id[i] % 3 != 0) continue;
    for (std::size_t a = 0; a < D; ++a) {
      s.x[a][i] -= (surface.distance + 0.3 * f.dx()) * surface.normal[a];
      s.v[a][i] -= 2.0 * surface.normal[a];
    }
    ++entered;
  }
  const auto state = [&] {  // momentum, angular momentum about the origin, and of each the sum of absolute values
    constexpr std::size_t N = solids::rigid<D>::components;
    std::array<double, N> all{}, size{};
    for (std::size_t k = 0; k < N; ++k) {
      const auto of = [&](std::size_t i) {
        const auto mv = s.m[i] * rigid::velocity_of<D>(s, i);
        return k < D ? mv[k] : solids::moment<D>(of_solids<D>(f.place(i)), mv)[k - D];
      };
      const auto mv = b.free->mass * b.rate.velocity;
      all[k] = scene.sum(of) +
               (k < D ? mv[k] : solids::moment<D>(b.rate.centre, mv)[k - D] + b.free->angular_momentum[k - D]);
      size[k] = scene.sum([&](std::size_t i) { return std::abs(of(i)); });
    }
    return std::pair{all, size};
  };
  const auto places = [&] { return std::array<particles::array, D>(s.x); };
  const auto at = places();
  const auto before = state();
  const double kinetic = scene.sum([&](std::size_t i) { return 0.5 * s.m[i] * f.speed2(i); }) + energy_of_bodies(f);
  const auto put_back = f.ranks().sum(rigid::put_out_of_bodies(f));
  BOOST_TEST(f.ranks().sum(static_cast<std::int64_t>(entered)) > 5);
  BOOST_TEST(put_back >= f.ranks().sum(static_cast<std::int64_t>(entered)));
  count_put_back(f);
  for (std::size_t i = 0; i < s.fluid; ++i)  // lever arms are those of the surface, where they met
    for (std::size_t a = 0; a < D; ++a) s.x[a][i] = 0.5 * (s.x[a][i] + at[a][i]);
  auto after = state();
  for (std::size_t k = 0; k < D; ++k) {
    BOOST_TEST(std::abs(after.first[k] - before.first[k]) < 1e-13 * before.second[k]);
    BOOST_TEST(std::abs(b.free->mass * b.rate.velocity[k] - f.counted.put_back[0][k]) < 1e-13 * before.second[k]);
  }
  for (std::size_t k = D; k < after.first.size(); ++k) {
    BOOST_TEST(std::abs(b.free->angular_momentum[k - D]) > 1e-6 * before.second[k]);
    BOOST_TEST(std::abs(b.free->angular_momentum[k - D] - f.counted.put_back[0][k]) < 1e-12 * before.second[k]);
  }
  // Without gravity none of them loses energy, but those that lie on the body.
  const double now = scene.sum([&](std::size_t i) { return 0.5 * s.m[i] * f.speed2(i); }) + energy_of_bodies(f);
  BOOST_TEST(f.held.empty());
  BOOST_TEST(std::abs(now - kinetic) < 1e-12 * kinetic);
  BOOST_TEST(std::abs(f.counted.energy) < 1e-12 * kinetic);
}

BOOST_AUTO_TEST_CASE(put_back_by_free_bodies) {
  for (const char* density : {"0.5", "650.0", "8000.0"}) {
    put_back_of<2>(blob("kind = 'free' density = " + std::string(density)));
    put_back_of<3>(
        "&domain dimension = 3 length_x = 2.0 length_y = 2.0 length_z = 2.0 particles_x = 20 particles_y = 20 "
        "particles_z = 20 /"
        "&flow low_x = 0.4 high_x = 1.6 low_y = 0.4 high_y = 1.6 low_z = 0.4 high_z = 1.6 gravity = 0.0 sound_speed = "
        "20.0 around_bodies = .true. /"
        "&kernel name = 'wendland_c2' h_over_dx = 1.2 skin = 0.3 /"
        "&solids body = 'box' shape = 'box' centre_x = 1.0 centre_y = 1.05 centre_z = 0.95 length_x = 0.5 length_y = "
        "0.4"
        " length_z = 0.45 angle_z = 25 angle_x = 10 /"
        "&motions body = 'box' kind = 'free' density = " +
        std::string(density) + " / &gauges force = 'box' / &time t_end = 1.0 /");
  }
}

// What a body that stands still puts back is in the impulse of its force, and in the pressure of the gauges where it
// was put back, whose weights add up to one over the face.
BOOST_AUTO_TEST_CASE(put_back_counts) {
  std::string x, y;
  for (int k = 0; k < 18; ++k) {
    x += "1.2 ";
    y += std::to_string(0.4 + 0.05 * (k + 0.5)) + " ";
  }
  scene<2> scene(tank("high_x = 1.2 low_y = 0.6 high_y = 1.1 gravity = 0.0 sound_speed = 20.0") +
                 "&solids body = 'post' shape = 'box' centre_x = 1.35 centre_y = 1.0 length_x = 0.3 length_y = 3.0 /"
                 "&gauges force = 'post' pressure_x = " +
                 x + " pressure_y = " + y + "/");
  auto& f = *scene.f;
  auto& s = scene.particles();
  double momentum = 0.0;
  for (const std::uint32_t i : f.beside_bodies) {
    if (s.x[0][i] < 1.15) continue;
    s.x[0][i] = 1.2 + 0.004 * (1.0 + noise(s.id[i], 1));
    s.v[0][i] = 3.0 + noise(s.id[i], 2);
    s.v[1][i] = noise(s.id[i], 3);
    momentum += 2.0 * s.m[i] * s.v[0][i];
  }
  std::array all{momentum};
  f.ranks().sum(all);
  momentum = all[0];
  rigid::put_out_of_bodies(f);
  count_put_back(f);
  BOOST_TEST(f.counted.put_back[0][0] == momentum, tt::tolerance(1e-12));
  BOOST_TEST(std::abs(f.counted.put_back[0][1]) < 1e-12 * momentum);  // along the face nothing acts
  double on_gauges = 0.0;
  for (const double one : f.counted.on_gauges) on_gauges += 0.05 * one;
  BOOST_TEST(on_gauges == momentum, tt::tolerance(1e-9));
  BOOST_TEST(count_of(f).impulses.front() == momentum, tt::tolerance(1e-12));
}

// The part of the force that is friction's is what the viscosity adds to it, and the work that is counted is done by
// the whole force where its body goes.
BOOST_AUTO_TEST_CASE(friction_of_bodies) {
  for (const char* scheme : {"delta", "riemann"}) {
    scene<2> scene(blob("kind = 'harmonic' period = 2.0 amplitude_x = 0.2 amplitude_angle = 15", scheme) +
                   "&walls slip = 'no_slip' /");
    auto& f = *scene.f;
    disturb(scene);
    BOOST_TEST(f.counts_work);
    const auto rate = scene.rates();
    const auto& b = f.moving.front();
    const auto all = loads_on(f, {0}, {b.rate.centre}).front(), dragged = friction_on(f, b);
    scene.p.kinematic_viscosity = 0.0;
    scene.rates();
    const auto pressed = loads_on(f, {0}, {b.rate.centre}).front();
    for (std::size_t a = 0; a < 2; ++a) {
      BOOST_TEST(std::abs(dragged.force[a]) > 1e-4 * std::abs(all.force[a]));
      BOOST_TEST(std::abs(all.force[a] - pressed.force[a] - dragged.force[a]) < 1e-10 * std::abs(all.force[a]));
    }
    BOOST_TEST(std::abs(all.moment[0] - pressed.moment[0] - dragged.moment[0]) < 1e-10 * std::abs(all.moment[0]));
    if (f.ranks().rank != 0) continue;
    const double power = rate[rate.size() - 2][0] + rate.back()[0];  // by pressure and friction
    BOOST_TEST(power == -(all.force[0] * b.rate.velocity[0] + all.moment[0] * b.rate.angular[0]), tt::tolerance(1e-10));
    BOOST_TEST(rate.back()[0] == power_of<2>(b, dragged), tt::tolerance(1e-10));
  }
}
