// Supports that follow the volume: forces are the slope of the potential, whatever the supports do, and momentum stays.
// The same of the force of walls.
#include <liquid/passes.hpp>
#include <namelist/document.hpp>
#include <two_fluids/evaluation.hpp>
#include <two_fluids/measures.hpp>
#include <two_fluids/start.hpp>
#include <two_fluids/step_limit.hpp>

#include "../support/scene.hpp"

using namespace tetsuame;
using namespace tetsuame::two_fluids;
namespace tt = boost::test_tools;

namespace {

struct box {
  options o;
  parameters p;
  std::unique_ptr<fluids<2>> f;
  std::unique_ptr<list_of_passes<2>> passes;
  std::vector<std::vector<double>> rates;

  box(const std::string& volume, const std::string& reference, const std::string& walls,
      const std::string& slowed = "") {
    namelist::schema schema;
    two_fluids::declare(schema, problem_kind::rayleigh_taylor, o);
    schema.read(
        namelist::parse_text("&domain particles_x = 16 particles_y = 16 periodic_x = .true. /\n"
                             "&rti supports = 'volume' volume = '" +
                                 volume +
                                 "' viscosity_upper = 1e9 viscosity_lower = 1e9 amplitude = 3e4 "
                                 "start = 'displaced' p_top = 1e10 reference_pressure = '" +
                                 reference + "' " + slowed + " /\n" + walls + "&time t_end = 1.0 /",
                             "test.nml"));
    p = resolve(schema, problem_kind::rayleigh_taylor, o);
    f = std::make_unique<fluids<2>>(problem_kind::rayleigh_taylor, o, p);
    set_up(*f);
    place_fluid(*f);
    find_reference(*f);
    find_limit(*f);
    passes = std::make_unique<list_of_passes<2>>(*f, nullptr);
    passes->declare(1.0, {});
    auto& s = f->world.w.s;
    // Off the lattice, so that neither supports nor f_i are those of a lattice.
    for (std::size_t i = 0; i < s.fluid; ++i)
      for (std::size_t a = 0; a < 2; ++a) s.x[a][i] += 0.15 * f->world.w.dx * test::noise(s.id[i], static_cast<int>(a));
    // Lists leave supports some room to grow, and here they find all they need.
    for (int round = 0; round < 4; ++round) {
      two_fluids::make_lists(*f, false);
      settle_supports(*f);
    }
    two_fluids::make_lists(*f, false);
    rates.assign(9, std::vector<double>(s.fluid));
    evaluate();
  }

  // Places of ghosts and images.
  void move_ghosts() {
    auto& w = f->world.w;
    domain::exchange<2>(w.d.ranks, w.d.fluid_halo, {}, &w.s.x);
    walls::move_images(f->world.walls, w.s);
  }
  void evaluate() {
    std::vector<double*> to;
    for (auto& r : rates) to.push_back(r.data());
    passes->e.run(std::span<double* const>(to));
  }

  // With the supports that belong to the places.
  double potential() {
    auto& s = f->world.w.s;
    for (int round = 0; round < 20; ++round) {
      move_ghosts();
      count_neighbours(*f, f->world.w.fluid());
      follow_volumes(*f);
    }
    evaluate();
    double U = 0.0;
    for (std::size_t i = 0; i < s.fluid; ++i)
      U += s.m[i] * (slowed_energy(*f, i, elastic_energy(*f, i, s.rho[i])) + o.gravity * s.x[1][i]) +
           f->reference_pressure(s.x[1][i]) * s.dV[i];
    return U;
  }
};

}  // namespace

namespace {

void check_slopes(const std::string& slowed, double xi2) {
  box b("number_density", "lightest", "", slowed);
  auto& s = b.f->world.w.s;
  b.potential();
  const auto acceleration = b.rates;
  // Supports have left that of the start, and f_i has left 1.
  double widest = 0.0, factor = 0.0;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    widest = std::max(widest, std::abs(b.f->S[i] / b.f->S_0 - 1.0));
    factor = std::max(factor, std::abs(b.f->follow_factor[i] - 1.0));
  }
  BOOST_TEST(widest > 0.003);
  BOOST_TEST(factor > 0.001);
  const double small = 1e-4 * b.f->world.w.dx;
  double largest = 0.0;
  for (std::size_t i = 0; i < s.fluid; ++i) largest = std::max(largest, std::abs(acceleration[3][i]));
  // Out of reach of floor and lid, behind which the pressure goes on as that of a column.
  const double low = 1.2 * b.f->S_0, high = b.o.domain.length[1] - low;
  int tried = 0;
  for (std::size_t i = 0; i < s.fluid && tried < 8; i += 5) {
    if (s.x[1][i] < low || s.x[1][i] > high) continue;
    ++tried;
    for (std::size_t a = 0; a < 2; ++a) {
      const double x = s.x[a][i];
      s.x[a][i] = x + small;
      const double above = b.potential();
      s.x[a][i] = x - small;
      const double below = b.potential();
      s.x[a][i] = x;
      BOOST_TEST(std::abs(acceleration[2 + a][i] + (above - below) / (2.0 * small * s.m[i] * xi2)) < 1e-4 * largest);
    }
  }
  BOOST_TEST(tried == 8);
}

}  // namespace

BOOST_AUTO_TEST_CASE(forces_are_the_slope_of_the_potential) { check_slopes("", 1.0); }

// Stiffness is lost for the departure from the column at rest alone, and what lifts the volumes there is too much of
// belongs to the same energy.
BOOST_AUTO_TEST_CASE(slowed_forces_are_the_slope_of_the_potential) { check_slopes("zeta = 3.0 xi = 2.0", 4.0); }

// Along x, where the box is periodic and the walls are mirrors, behind which the pressure is as inside.
BOOST_AUTO_TEST_CASE(momentum_stays) {
  for (const char* volume : {"number_density", "our_method"}) {
    box b(volume, "none", "&walls floor = 'free_slip' lid = 'free_slip' /");
    b.o.gravity = 0.0;
    b.f->world.w.g = {};
    auto& s = b.f->world.w.s;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      s.rho[i] *= 1.0 + 0.05 * test::noise(s.id[i], 2);
      for (std::size_t a = 0; a < 2; ++a) s.v[a][i] = 100.0 * test::noise(s.id[i], 3 + static_cast<int>(a));
    }
    b.move_ghosts();
    if (!b.f->carried) count_neighbours(*b.f, b.f->world.w.fluid());
    follow_volumes(*b.f);
    b.evaluate();
    foundation::exact_sum force, scale;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      force.add(s.m[i] * b.rates[2][i]);
      scale.add(std::abs(s.m[i] * b.rates[2][i]));
    }
    BOOST_TEST(std::abs(force.value()) < 1e-13 * scale.value());
  }
}

// Of a particle at 0.1 Δx from the floor, out of 0.3, and one at as much from the lid: what the force adds to the
// acceleration is the slope of what it adds to the energies, (ω 0.2 Δx)²/2 each.
BOOST_AUTO_TEST_CASE(walls_push_what_is_near) {
  box b("number_density", "lightest", "");
  auto& f = *b.f;
  auto& s = f.world.w.s;
  const double dx = f.world.w.dx, c = 1e4, omega = 0.25 * c / dx, height = b.o.domain.length[1];
  const std::size_t low = static_cast<std::size_t>(std::min_element(s.x[1].begin(), s.x[1].begin() + s.fluid) -
                                                   s.x[1].begin()),
                    high = static_cast<std::size_t>(std::max_element(s.x[1].begin(), s.x[1].begin() + s.fluid) -
                                                    s.x[1].begin());
  s.x[1][low] = 0.1 * dx;
  s.x[1][high] = height - 0.1 * dx;
  b.evaluate();
  const auto without = b.rates;
  const double energy = find_energies(f).potential;
  f.world.walls.force = walls::make_boundary_force(dx, c);
  b.evaluate();
  for (std::size_t i = 0; i < s.fluid; ++i) {
    BOOST_TEST(b.rates[2][i] == without[2][i]);
    const double d = std::min(s.x[1][i], height - s.x[1][i]), depth = std::max(0.0, 0.3 * dx - d);
    const double push = (s.x[1][i] < 0.5 * height ? 1.0 : -1.0) * omega * omega * depth;
    BOOST_TEST(std::abs(b.rates[3][i] - without[3][i] - push) < 1e-9 * omega * omega * dx);
  }
  double expected = 0.0;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const double depth = std::max(0.0, 0.3 * dx - std::min(s.x[1][i], height - s.x[1][i]));
    expected += 0.5 * s.m[i] * omega * omega * depth * depth;
  }
  BOOST_TEST(find_energies(f).potential - energy == expected, tt::tolerance(1e-9));
}
