// The force of a contact: restitution, friction, energy, and that the two grains of a pair see it alike.
#define BOOST_TEST_MODULE dem
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <dem/contact.hpp>
#include <numbers>

using namespace tetsuame;
using dem::contact_model, dem::contact_memory, dem::encounter;

namespace {

dem::contact_table table_of(contact_model model, dem::rolling_model rolling = dem::rolling_model::none) {
  dem::contact_rules rules{model, rolling, 1e5, 2.0 / 7.0, 0.3};
  dem::material glass{"glass", 2500.0, 1e9, 0.25, 0.8, 0.4, 0.1}, steel{"steel", 7800.0, 2e11, 0.3, 0.6, 0.2, 0.05};
  return {rules, {glass, steel}, {}};
}

// Of two glass beads of 1 mm.
template <int D>
encounter<D> beads(double overlap) {
  encounter<D> e{};
  e.n[0] = 1.0;
  e.overlap = overlap;
  e.R = 5e-4;
  e.m = 0.5 * 2500.0 * 4.0 / 3.0 * std::numbers::pi * 1e-9;
  e.inertia = 1.4 * e.m * 1e-6;
  return e;
}

}  // namespace

// Springs that are let go where they no longer push [T. Schwager, T. Pöschel, Granular Matter 9, 465 (2007)]: with
// ζ = α/2 < 1/√2, e = exp(-ζ/√(1 - ζ²) (π - arcsin(2 ζ √(1 - ζ²)))).
BOOST_AUTO_TEST_CASE(linear_springs_beside_the_closed_form) {
  for (const double zeta : {0.05, 0.2, 0.5, 0.7}) {
    const double w = std::sqrt(1.0 - zeta * zeta);
    const double expected = std::exp(-zeta / w * (std::numbers::pi - std::asin(2.0 * zeta * w)));
    BOOST_TEST(dem::restitution_of(contact_model::hooke, 2.0 * zeta) == expected, boost::test_tools::tolerance(2e-4));
  }
}

BOOST_AUTO_TEST_CASE(damping_gives_the_restitution) {
  for (const auto model : {contact_model::hertz_mindlin, contact_model::hooke})
    for (const double e : {0.05, 0.3, 0.7, 0.99})
      BOOST_TEST(dem::restitution_of(model, dem::damping_for(model, e)) == e, boost::test_tools::tolerance(1e-3));
  BOOST_TEST(dem::damping_for(contact_model::hertz_mindlin, 1.0) == 0.0);
}

BOOST_AUTO_TEST_CASE(pairs_of_materials) {
  const auto table = table_of(contact_model::hertz_mindlin);
  BOOST_TEST(table.of(0, 1).friction == 0.2);
  BOOST_TEST(table.of(0, 1).normal == table.of(1, 0).normal);
  BOOST_TEST(1.0 / table.of(0, 1).normal == (1.0 - 0.0625) / 1e9 + (1.0 - 0.09) / 2e11,
             boost::test_tools::tolerance(1e-14));
  BOOST_TEST(1.0 / table.of(0, 0).tangential == 2.0 * 1.75 / (1e9 / 2.5), boost::test_tools::tolerance(1e-14));
}

// The sign alone changes when the grains change places: to the bit.
BOOST_AUTO_TEST_CASE(both_grains_of_a_pair_see_it_alike) {
  for (const auto rolling : {dem::rolling_model::none, dem::rolling_model::constant_torque, dem::rolling_model::spring})
    for (const auto model : {contact_model::hertz_mindlin, contact_model::hooke}) {
      const auto table = table_of(model, rolling);
      auto e = beads<3>(3e-6);
      e.n = {{0.36, 0.48, 0.8}};
      e.approach = 0.02;
      e.slip = {{0.03, -0.01, 0.017}};
      e.way = {{2e-8, 3e-8, -2.7e-8}};
      e.rolling = {{1e-4, -3e-5, 7e-5}};
      e.roll = {{12.0, -5.0, 3.0}};
      auto other = e;
      for (auto* v : {&other.n, &other.slip, &other.way, &other.rolling, &other.roll}) *v = -1.0 * *v;
      contact_memory<3> mine{{{1e-4, 2e-4, -1.65e-4}}, 5e-5, {{1e-7, 0.0, -2e-8}}}, others = mine.reversed();
      const auto a = dem::force_of<3>(table.rules, table.of(0, 0), e, mine);
      const auto b = dem::force_of<3>(table.rules, table.of(0, 0), other, others);
      for (std::size_t k = 0; k < 3; ++k) {
        BOOST_TEST(a.force[k] == -b.force[k]);
        BOOST_TEST(a.rolling[k] == -b.rolling[k]);
        BOOST_TEST(mine.Q[k] == -others.Q[k]);
        BOOST_TEST(mine.M[k] == -others.M[k]);
      }
      BOOST_TEST(a.normal == b.normal);
    }
}

BOOST_AUTO_TEST_CASE(friction_is_at_most_coulombs) {
  const auto table = table_of(contact_model::hertz_mindlin);
  auto e = beads<2>(2e-6);
  contact_memory<2> m;
  e.slip[1] = 1.0;
  e.way[1] = 1e-3;
  const auto f = dem::force_of<2>(table.rules, table.of(0, 0), e, m);
  BOOST_TEST(f.tangential[1] == -0.4 * f.normal, boost::test_tools::tolerance(1e-12));
  BOOST_TEST(m.Q[1] == f.tangential[1]);
}

// A cycle in the plane of overlap and tangential way, without sliding: the work that the contact takes is never less
// than 0, whichever way round it goes. A spring Q = k_t(δ) ξ gives energy away in one of the two.
BOOST_AUTO_TEST_CASE(a_closed_cycle_makes_no_energy) {
  dem::contact_rules rules{contact_model::hertz_mindlin, dem::rolling_model::none, 0.0, 0.0, 0.0};
  const dem::contact_table table(rules, {{"glass", 2500.0, 1e9, 0.25, 1.0, 10.0, 0.0}}, {});
  for (const double round : {1.0, -1.0}) {
    contact_memory<2> m;
    auto e = beads<2>(2e-6);
    double taken = 0.0, before_x = 2e-6, before_y = 0.0;
    std::array<double, 2> before{};
    constexpr int steps = 4000;
    dem::force_of<2>(table.rules, table.of(0, 0), e, m);
    for (int n = 0; n <= 2 * steps; ++n) {
      const double angle = 2.0 * std::numbers::pi * n / steps;
      const double x = 2e-6 + 1e-6 * std::sin(angle), y = round * 2e-8 * (1.0 - std::cos(angle));
      e.overlap = x;
      e.way[1] = y - before_y;
      const auto f = dem::force_of<2>(table.rules, table.of(0, 0), e, m);
      // The grain is at n·r = -x, and y along the surface; work on the contact is minus that on the grain.
      if (n > steps)  // from the second time round, which begins with the force that the first one left
        taken += 0.5 * (f.force[0] + before[0]) * (x - before_x) - 0.5 * (f.force[1] + before[1]) * (y - before_y);
      before = {f.force[0], f.force[1]};
      before_x = x;
      before_y = y;
    }
    BOOST_TEST(taken > -1e-16);
  }
}
