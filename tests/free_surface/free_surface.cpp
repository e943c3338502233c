// Water with a free surface: the liquid, the sums over neighbours, where the surface is, gauges, exact solutions.
#include <boost/test/unit_test.hpp>
#include <free_surface/free_bodies.hpp>
#include <free_surface/measures.hpp>
#include <free_surface/surface.hpp>
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

// W'(r)/r, 1/m^4.
double slope_over_r(const pairs::workspace<2>& w, double r) {
  return std::visit([&](const auto& kernel) { return kernel.gradient_over_r(r); }, w.kernel);
}

// 1 in the continuum; what lattices lack along the axes they have across.
double shear_of_lattice(const pairs::workspace<2>& w) {
  double sum = 0.0;
  for (int i = -4; i <= 4; ++i)
    for (int j = -4; j <= 4; ++j) {
      const double x = i * w.dx, y = j * w.dx, r = std::hypot(x, y);
      if (r > 0.0) sum -= 4.0 * w.dx * w.dx * slope_over_r(w, r) * x * x * y * y / (r * r);
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
                                    slow * 20.0});
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
                                    slow * 20.0});
  for (std::size_t i = 0; i < s.fluid; i += 7) {
    double expected = 0.0;
    for (std::size_t j = 0; j < s.total(); ++j) {
      const double x = s.x[0][i] - s.x[0][j], y = s.x[1][i] - s.x[1][j];
      if (i != j) expected += 2.5 * slope_over_r(w, std::hypot(x, y)) * (3.0 * x * x + y * y);
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
  arrange(*still.f, 0.01);
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
  for (int k = 0; k < 10; ++k) arrange(*still.f, 0.002);
  for (std::size_t i = 0; i < s.fluid; ++i)
    BOOST_TEST(std::hypot(s.x[0][i] - before[0][i], s.x[1][i] - before[1][i]) <= 10.0 * 0.5 * 0.002 * (1.0 + 1e-12));
  BOOST_TEST(disorder() < 0.5 * first);
}

// Water of half its concentration loses with time what pressure it has beyond that of still water a support deep, and
// its tension at once, less of both the slower it moves; whole water loses nothing.
BOOST_AUTO_TEST_CASE(lost_concentration) {
  scene<2> scene(tank("high_x = 1.0 high_y = 0.75"));
  auto& f = *scene.f;
  auto& s = scene.particles();
  const double dt = 0.01, sound = f.p.water.sound, part = std::exp(-dt * sound / f.world.w.support());
  const double deep = f.p.water.density_beneath(9.81 * f.world.w.support());
  for (const bool whole : {true, false}) {
    for (std::size_t i = 0; i < s.fluid; ++i) {
      if (!whole) s.m[i] *= 0.5;
      s.rho[i] = s.id[i] % 2 == 0 ? 1010.0 : 995.0;
      s.v[0][i] = s.id[i] % 3 == 0 ? 0.001 * sound : 1.0;
    }
    find_arrangement(f);
    slacken(f, dt);
    for (std::size_t i = 0; i < s.fluid; ++i) {
      const double lively = s.id[i] % 3 == 0 ? 0.01 : 1.0;
      const double lost = whole && f.eigenvalue[i] >= inside ? 0.0 : lively * (s.id[i] % 2 == 0 ? 1.0 - part : 1.0);
      const double before = s.id[i] % 2 == 0 ? 1010.0 : 995.0, until = s.id[i] % 2 == 0 ? deep : 1000.0;
      BOOST_TEST(s.rho[i] == before + lost * (until - before), tt::tolerance(1e-12));
      BOOST_TEST((whole || f.eigenvalue[i] < inside));
    }
  }
}

// A beach slows the water by its rate, which rises as the square of the way in, from either end.
BOOST_AUTO_TEST_CASE(a_beach_drags) {
  for (const auto& [from, to] : {std::pair{0.5, 1.5}, std::pair{1.5, 0.5}}) {
    scene<2> with(tank(fmt::format("high_y = 1.0 beach_rate = 3.0 beach_from = {} beach_to = {}", from, to)));
    scene<2> without(tank("high_y = 1.0"));
    for (auto* s : {&with, &without}) disturb(*s);
    const auto slowed = with.rates(), free = without.rates();
    const auto& s = with.particles();
    for (std::size_t i = 0; i < s.fluid; ++i) {
      const double in = std::clamp((s.x[0][i] - from) / (to - from), 0.0, 1.0);
      for (std::size_t a = 0; a < 2; ++a)
        BOOST_TEST(slowed[2 + a][i] - free[2 + a][i] == -3.0 * in * in * s.v[a][i], tt::tolerance(1e-6));
    }
  }
}

BOOST_AUTO_TEST_CASE(exact_solutions) {
  const standing_wave wave{std::numbers::pi, 1.0, 9.81, 0.05};
  BOOST_TEST(*period_of(wave.rate(0.0)) == 1.13391748, tt::tolerance(1e-8));
  // Slightly viscous, it decays as Lamb's article 348 says.
  const double nu = 1e-7, k = std::numbers::pi;
  BOOST_TEST(-2.0 * wave.rate(nu).real() == 4.0 * nu * k * k, tt::tolerance(1e-3));
  // Rayleigh: deep standing waves are slower by (ka)²/8.
  const standing_wave deep{2.0 * k, 10.0, 9.81, 0.02};
  BOOST_TEST(deep.faster_by() == -0.125 * std::pow(2.0 * k * 0.02, 2), tt::tolerance(1e-9));
  BOOST_TEST(*wave.mean_period(0.0, 1.0) == 1.13391748 / (1.0 + wave.faster_by()), tt::tolerance(1e-8));
  // Thick as honey it creeps back without a swing.
  BOOST_TEST(!deep.mean_period(100.0, 1.0).has_value());
  // The published semi-axes have five digits.
  for (const auto& [t, b] : {std::pair{0.0008, 1.0831}, std::pair{0.0038, 1.4392}, std::pair{0.0076, 1.9445}}) {
    const auto axes = drawn_out(1.0, 100.0, t);
    BOOST_TEST(axes.b == b, tt::tolerance(1e-3));
    BOOST_TEST(axes.a * axes.b == 1.0, tt::tolerance(1e-9));
  }
}
