// Gravity as a pass: the central field against its potential and Kepler's third law, and that it takes the place of the
// uniform one.
#include <gravity/gravity.hpp>
#include <numbers>
#include <run/start.hpp>

#include "../support/numbers.hpp"

using namespace tetsuame;
using namespace tetsuame::test;

namespace {

// Particles that nothing but gravity moves.
template <int D>
struct free_fall {
  run::state<D> box;
  passes::evaluation<D> e{box};

  free_fall(const gravity::central<D>* field) {
    domain::options domain;
    domain.length = {40.0, 40.0, 40.0};
    domain.particles = {8, 8, 8};
    domain.periodic = {false, false, false};
    run::kernel_options kernel;
    kernel.name = "wendland_c4";
    kernel.h_over_dx = 1.3;
    kernel.skin = 0.2;
    const walls::options no_walls;
    run::set_up<D>(box, domain::communicator::world(), domain, no_walls, kernel, 3.0);
    box.w.g[1] = -9.0;
    auto& s = box.w.s;
    e.integrate_motion({});
    if (field != nullptr) field->declare(box, e);
    passes::access uses{.reads = {s.v}, .rates = {s.x, s.v}};
    if (field != nullptr) uses.reads.add({box.w.accelerations});
    e.each("rates", uses, [this](std::size_t i) {
      for (std::size_t a = 0; a < D; ++a) {
        e.rate(a)[i] = box.w.s.v[a][i];
        e.rate(D + a)[i] = box.w.gravity(a, i);
      }
    });
    e.complete(passes::behind_walls::nothing);
  }
  std::vector<std::vector<double>> rates() {
    std::vector<std::vector<double>> all(2 * D, std::vector<double>(box.w.s.fluid));
    std::vector<double*> to;
    for (auto& one : all) to.push_back(one.data());
    e.run(to);
    return all;
  }
};

// Against differences of the potential, a quarter of a mm on either side: their error is of the second order, 1e-8 of g
// at these radii, and what the surface's kink adds stays out.
template <int D>
void check_slope() {
  std::array<double, D> centre;
  centre.fill(20.0);
  const gravity::central<D> field(centre, 3.0, 7.0);
  free_fall<D> fall(&field);
  const auto rates = fall.rates();
  const double small = 2.5e-4;
  for (std::size_t i = 0; i < fall.box.w.s.fluid; i += 3)
    for (std::size_t a = 0; a < D; ++a) {
      auto above = particles::position<D>(fall.box.w.s.x, i), below = above;
      above[a] += small;
      below[a] -= small;
      const double slope = (field.potential(above) - field.potential(below)) / (2.0 * small);
      BOOST_TEST(std::abs(rates[D + a][i] + slope) < 1e-7 * 3.0);
    }
}

}  // namespace

BOOST_AUTO_TEST_CASE(uniform_gravity_is_that_of_the_workspace) {
  free_fall<2> fall(nullptr);
  const auto rates = fall.rates();
  for (std::size_t i = 0; i < fall.box.w.s.fluid; ++i) {
    BOOST_TEST(rates[2][i] == 0.0);
    BOOST_TEST(rates[3][i] == -9.0);
  }
}

BOOST_AUTO_TEST_CASE(central_gravity_is_the_slope_of_its_potential) {
  check_slope<2>();
  check_slope<3>();
}

// T = 2π √(r³/(g R²)): a circle of twice the radius closes but for what the leapfrog's steps leave, of second order.
BOOST_AUTO_TEST_CASE(a_circle_closes_after_keplers_period) {
  const double g = 9.81, R = 6.4e6, r = 2.0 * R, turn = 2.0 * std::numbers::pi;
  const gravity::central<3> field({0.0, 0.0, 0.0}, g, R);
  const double period = turn * std::sqrt(r * r * r / (g * R * R));
  const auto gap = [&](int steps) {  // of the radius, after a turn
    const double dt = period / steps;
    std::array<double, 3> x{r, 0.0, 0.0}, v{0.0, turn * r / period, 0.0};
    for (int step = 0; step < steps; ++step) {
      const auto before = field.at(x);
      for (std::size_t a = 0; a < 3; ++a) v[a] += 0.5 * dt * before[a];
      for (std::size_t a = 0; a < 3; ++a) x[a] += dt * v[a];
      const auto after = field.at(x);
      for (std::size_t a = 0; a < 3; ++a) v[a] += 0.5 * dt * after[a];
    }
    return std::hypot(x[0] - r, x[1]) / r;
  };
  const double wide = gap(500), narrow = gap(1000);
  BOOST_TEST(std::abs(std::log2(wide / narrow) - 2.0) < 0.02);
  BOOST_TEST(narrow < 1e-4);
}

BOOST_AUTO_TEST_CASE(a_radius_of_zero_is_refused) {
  BOOST_CHECK_THROW(gravity::central<2>({0.0, 0.0}, 1.0, 0.0), std::invalid_argument);
}
