// Self-gravity: the pair's field against the kernel's own integral, direct summation against homogeneous bodies, the
// tree against direct summation, and that its results are the same to the last bit whatever the order of particles.
#include <omp.h>

#include <boost/test/unit_test.hpp>
#include <limits>

#include "clouds.hpp"

using namespace tetsuame;
using namespace tetsuame::test;

namespace {

// The share of a Wendland C2 kernel's mass within q = r/H, by Simpson's rule.
template <int D>
double enclosed(double q) {
  const auto integral = [](double to) {
    constexpr int steps = 400;
    const auto shell = [](double s) { return std::pow(s, D - 1) * std::pow(1.0 - s, 4) * (1.0 + 4.0 * s); };
    double sum = 0.0;
    for (int k = 0; k < steps; ++k) {
      const double a = to * k / steps, b = to * (k + 1) / steps;
      sum += (b - a) / 6.0 * (shell(a) + 4.0 * shell(0.5 * (a + b)) + shell(b));
    }
    return sum;
  };
  return q < 1.0 ? integral(q) / integral(1.0) : 1.0;
}

// Two particles of 3e5 and 2e5 kg, r apart along a diagonal.
template <int D>
bodies<D> pair(double r, double h_first, double h_second) {
  bodies<D> all;
  std::array<double, D> x{}, y{};
  y.fill(r / std::sqrt(D));
  all.add(x, 3e5, h_first);
  all.add(y, 2e5, h_second);
  return all;
}

template <int D>
void check_pair() {
  for (const double q : {0.05, 0.3, 0.7, 0.999999, 1.0, 1.000001, 3.0}) {
    const double H = 2.0, r = q * H, factor = gravity::strength<D>(G);
    const auto f = by_tree(pair<D>(r, H, 0.5), precise()), swapped = by_tree(pair<D>(r, 0.5, H), precise());
    // Simpson's rule is good to 1e-9, arithmetic to 1e-15; lengths are rounded to 1e-16, 1/q of it counts.
    BOOST_TEST(f.magnitude(0) == factor * 2e5 * enclosed<D>(q) / std::pow(r, D - 1),
               boost::test_tools::tolerance(1e-8));
    BOOST_TEST((f == swapped));
    for (std::size_t a = 0; a < D; ++a)
      BOOST_TEST(3e5 * f.acceleration[a][0] == -2e5 * f.acceleration[a][1], boost::test_tools::tolerance(1e-14));
    const double d = 1e-4 * H, slope = (by_tree(pair<D>(r + d, H, 0.5), precise()).potential[0] -
                                        by_tree(pair<D>(r - d, H, 0.5), precise()).potential[0]) /
                                       (2.0 * d);
    // A central difference: (d/H)² of the force, and a rounding of the potential over d.
    BOOST_TEST(slope == f.magnitude(0), boost::test_tools::tolerance(3e-6));
  }
  const auto near = by_tree(pair<D>(2.0 * (1.0 - 1e-9), 2.0, 0.5), precise()),
             far = by_tree(pair<D>(2.0 * (1.0 + 1e-9), 2.0, 0.5), precise());
  BOOST_TEST(near.magnitude(0) == far.magnitude(0), boost::test_tools::tolerance(1e-8));
  BOOST_TEST(near.potential[0] == far.potential[0], boost::test_tools::tolerance(1e-8));
}

template <int D>
void check_errors(const bodies<D>& all, double median, double most) {
  const auto found = by_tree(all), exact = by_direct(all);
  const auto e = compare(found, exact);
  BOOST_TEST_MESSAGE("median " << e.median << ", 99 % " << e.most << ", largest " << e.worst);
  BOOST_TEST(e.median < median);
  BOOST_TEST(e.most < most);
  double scale = 0.0, worst = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    scale = std::max(scale, std::abs(exact.potential[i]));
    worst = std::max(worst, std::abs(found.potential[i] - exact.potential[i]));
  }
  // Potentials are sums without cancellation, and expanded to an order more than forces.
  BOOST_TEST(worst < 2e-4 * scale);
  // Forces of groups on each other are opposite, what is left is rounding: of single numbers, and of double ones where
  // less is asked for.
  BOOST_TEST(momentum_error(all, found) < 6e-8);
  const auto finer = by_tree(all, precise());
  BOOST_TEST(momentum_error(all, finer) < 1e-13);
  BOOST_TEST(compare(finer, exact).median < 0.01 * median);
}

template <int D>
void check_bits(const bodies<D>& all) {
  omp_set_num_threads(1);
  const auto once = by_tree(all);
  omp_set_num_threads(2);
  BOOST_TEST((by_tree(all) == once));
  std::vector<std::size_t> at;
  const auto other = by_tree(permuted(all, at));
  std::size_t differ = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    differ += other.potential[at[i]] != once.potential[i];
    for (std::size_t a = 0; a < D; ++a) differ += other.acceleration[a][at[i]] != once.acceleration[a][i];
  }
  BOOST_TEST(differ == 0u);
  gravity::tree<D> t(gravity::tree_options{});
  for (const auto& [first, last] :
       {std::pair<std::size_t, std::size_t>{0, 1}, {17, 90}, {all.size() / 2, all.size()}}) {
    result<D> some(last - first);
    t(all.view(), first, last, some.view());
    const auto same = [&, from = first](const std::vector<double>& part, const std::vector<double>& whole) {
      return std::equal(part.begin(), part.end(), whole.begin() + static_cast<std::ptrdiff_t>(from));
    };
    BOOST_TEST(same(some.potential, once.potential));
    for (std::size_t a = 0; a < D; ++a) BOOST_TEST(same(some.acceleration[a], once.acceleration[a]));
  }
  omp_set_num_threads(1);
}

}  // namespace

BOOST_AUTO_TEST_CASE(the_field_of_a_pair_is_that_of_the_kernels_mass) {
  check_pair<2>();
  check_pair<3>();
}

// Without supports a pair is Newton's to rounding, and points at one place do not act.
BOOST_AUTO_TEST_CASE(points_without_a_support) {
  const auto f = by_tree(pair<3>(0.1, 0.0, 0.0), precise());
  BOOST_TEST(f.magnitude(1) == G * 3e5 / 0.01, boost::test_tools::tolerance(1e-14));
  BOOST_TEST(f.potential[1] == -G * 3e5 / 0.1, boost::test_tools::tolerance(1e-14));
  const auto cylinders = by_tree(pair<2>(0.1, 0.0, 0.0), precise());
  BOOST_TEST(cylinders.magnitude(1) == 2.0 * G * 3e5 / 0.1, boost::test_tools::tolerance(1e-14));
  BOOST_TEST(cylinders.potential[1] == 2.0 * G * 3e5 * std::log(0.1), boost::test_tools::tolerance(1e-14));
  const auto together = by_tree(pair<3>(0.0, 0.0, 0.0), precise());
  BOOST_TEST(together.magnitude(0) == 0.0);
  BOOST_TEST(together.potential[0] == 0.0);
}

BOOST_AUTO_TEST_CASE(none_and_one_and_two_and_three) {
  gravity::tree<3> t(gravity::tree_options{});
  bodies<3> all;
  result<3> nothing(0);
  t(all.view(), 0, 0, nothing.view());
  all.add({1.0, 2.0, 3.0}, 5.0, 0.1);
  auto found = by_tree(all);
  BOOST_TEST(found.magnitude(0) == 0.0);
  BOOST_TEST(found.potential[0] == 0.0);
  for (const double far : {1.5, 1e9}) {
    all.add({far, 2.0, 3.0}, 7.0, 0.1);
    const auto exact = by_direct(all);
    found = by_tree(all, precise());
    for (std::size_t i = 0; i < all.size(); ++i) {
      BOOST_TEST(found.acceleration[0][i] == exact.acceleration[0][i], boost::test_tools::tolerance(1e-13));
      BOOST_TEST(found.potential[i] == exact.potential[i], boost::test_tools::tolerance(1e-13));
    }
  }
}

BOOST_AUTO_TEST_CASE(many_at_one_place) {
  auto all = uniform_ball<3>(300);
  for (std::size_t i = 0; i < 100; ++i) all.add({1e6, 2e6, -1e6}, 1e22, 1e6);
  check_errors(all, 2e-4, 2e-3);
  check_bits(all);
}

// The tolerances are what tree_options promise, with room for a few hundred targets more or less: errors are a random
// sum of truncated multipoles, larger next to the centre of a ball, where the field vanishes.
BOOST_AUTO_TEST_CASE(tree_against_direct_summation_in_three_dimensions) {
  check_errors(uniform_ball<3>(4000), 1.5e-4, 1.5e-3);
  check_errors(plummer(4000), 1.5e-4, 1.5e-3);
  check_errors(two_layers(4000), 1.5e-4, 1.5e-3);
  check_errors(clumps(4000), 1.5e-4, 1.5e-3);
}

BOOST_AUTO_TEST_CASE(tree_against_direct_summation_of_cylinders) {
  // One in a hundred particles is within 0.1 R, where the field is below a tenth of that at the surface.
  check_errors(uniform_ball<2>(4000), 1.5e-4, 3e-3);
  check_errors(uniform_ball<2>(3000, 10.0, 1e15, 1e6), 1.5e-4, 3e-3);
}

BOOST_AUTO_TEST_CASE(the_same_bits_in_any_order_for_any_targets_on_any_number_of_threads) {
  check_bits(uniform_ball<3>(5000));
  check_bits(clumps(3000));
  check_bits(uniform_ball<2>(5000));
}

// A lattice of cubes (squares) in a ball: outside and half-way to the surface the field is that of the homogeneous body
// to what its stepped surface leaves, a part of spacing/R.
template <int D>
void check_homogeneous() {
  const int half = D == 3 ? 14 : 60;
  bodies<D> all;
  std::array<int, 3> at{};
  const int depth = D == 3 ? half : 1;
  for (at[0] = -half; at[0] < half; ++at[0])
    for (at[1] = -half; at[1] < half; ++at[1])
      for (at[2] = -depth; at[2] < (D == 3 ? depth : -depth + 1); ++at[2]) {
        std::array<double, D> x;
        for (std::size_t a = 0; a < D; ++a) x[a] = at[a] + 0.5;
        if (radius<D>(x) < half) all.add(x, 1e6, 2.0);
      }
  const double density = 1e6, pi = std::numbers::pi, factor = D == 3 ? 4.0 / 3.0 * pi * G : 2.0 * pi * G;
  const double mass = 1e6 * static_cast<double>(all.size());
  std::array<double, D> inside{}, outside{};
  inside[0] = 0.5 * half;
  outside[0] = 3.0 * half;
  all.add(inside, 0.0, 2.0);
  all.add(outside, 0.0, 2.0);
  const auto f = by_tree(all);
  BOOST_TEST(f.acceleration[0][all.size() - 2] == -factor * density * inside[0], boost::test_tools::tolerance(0.01));
  const double r = outside[0], far = gravity::strength<D>(G) * mass / std::pow(r, D - 1);
  // The lattice is as symmetric as a cube: the first multipole beyond the mass is of order 4.
  BOOST_TEST(f.acceleration[0][all.size() - 1] == -far, boost::test_tools::tolerance(1e-3));
  const double potential = D == 3 ? -G * mass / r : 2.0 * G * mass * std::log(r);
  BOOST_TEST(f.potential[all.size() - 1] == potential, boost::test_tools::tolerance(1e-3));
}

BOOST_AUTO_TEST_CASE(homogeneous_ball_and_cylinder) {
  check_homogeneous<2>();
  check_homogeneous<3>();
}

// A particle without mass, moved to and fro: the difference of its potential is the force. Both are sums of the same
// truncated expansions as long as the tree is the same; elsewhere they differ by the errors of the tree.
template <int D>
void check_potential(const bodies<D>& all, double step) {
  auto probe = all;
  numbers any(8);
  for (int k = 0; k < 10; ++k) {
    auto x = scaled<D>(any.in_ball<D>(), 7e6);
    probe.add(x, 0.0, 0.0);
    const std::size_t i = probe.size() - 1;
    double square = 0.0;
    const auto f = by_tree(probe);
    for (std::size_t a = 0; a < D; ++a) {
      probe.x[a][i] = x[a] + step;
      const double more = by_tree(probe).potential[i];
      probe.x[a][i] = x[a] - step;
      const double less = by_tree(probe).potential[i];
      probe.x[a][i] = x[a];
      square += std::pow((more - less) / (2.0 * step) + f.acceleration[a][i], 2);
    }
    BOOST_TEST(std::sqrt(square) < 5e-3 * f.magnitude(i));
    for (auto& one : probe.x) one.pop_back();
    probe.mass.pop_back();
    probe.support.pop_back();
    probe.id.pop_back();
  }
}

BOOST_AUTO_TEST_CASE(the_force_is_the_gradient_of_the_potential) {
  check_potential(uniform_ball<3>(2000), 3e4);
  check_potential(uniform_ball<2>(2000), 3e4);
}

// Σ m φ / 2 of a homogeneous ball is -3/5 G M²/R; softening takes a few per cent of it, random places some.
BOOST_AUTO_TEST_CASE(energy_of_a_homogeneous_ball) {
  const auto all = uniform_ball<3>(20000);
  const auto f = by_tree(all);
  double energy = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i) energy += 0.5 * all.mass[i] * f.potential[i];
  BOOST_TEST(energy == -0.6 * G * 6e24 * 6e24 / 6e6, boost::test_tools::tolerance(0.02));
}

BOOST_AUTO_TEST_CASE(input_that_is_no_number_is_refused_by_name) {
  auto all = uniform_ball<3>(50);
  const auto fails = [&](const char* fault) {
    BOOST_CHECK_EXCEPTION(by_tree(all), std::runtime_error, [&](const std::runtime_error& e) {
      const std::string text = e.what();
      return text.find("particle 1028 (index 4)") != text.npos && text.find(fault) != text.npos;
    });
  };
  const double x = all.x[1][4];
  all.x[1][4] = std::numeric_limits<double>::quiet_NaN();
  fails("position");
  all.x[1][4] = std::numeric_limits<double>::infinity();
  fails("position");
  all.x[1][4] = x;
  all.mass[4] = -1.0;
  fails("mass");
  all.mass[4] = 1.0;
  all.support[4] = -1.0;
  fails("support");
}

BOOST_AUTO_TEST_CASE(options_out_of_range_are_refused) {
  gravity::tree_options options;
  options.opening = 1.0;
  BOOST_CHECK_THROW(gravity::tree<3>{options}, std::invalid_argument);
  options = {};
  options.tolerance = 0.0;
  BOOST_CHECK_THROW(gravity::tree<2>{options}, std::invalid_argument);
}
