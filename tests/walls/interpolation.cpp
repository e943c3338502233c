// Shape functions of markers: what each order reproduces on disordered fluid beside a plane, in
// an edge and in a corner, and what becomes of clouds that do not determine the polynomial.
#include <boost/test/unit_test.hpp>
#include <kernels/splines.hpp>
#include <random>
#include <vector>
#include <walls/interpolation.hpp>

using namespace tetsuame::walls;

namespace {

constexpr std::size_t marker_lane = 1;  // beside others that see nothing

template <int D>
struct cloud {
  std::vector<std::array<double, D>> offsets;
  std::vector<double> weights;

  void add(const std::array<double, D>& e) {
    const tetsuame::kernels::quintic_spline<D> kernel(1.0);  // its support: offsets are in units of the reach
    double r2 = 0.0;
    for (const double c : e) r2 += c * c;
    offsets.push_back(e);
    weights.push_back(kernel.value(std::sqrt(r2)));
  }
  std::vector<double> phi(int order) const {
    std::vector<seen<D>> near((weights.size() + lanes - 1) / lanes);  // lanes beyond the cloud are empty
    for (auto& j : near) j = {real(0.0), tetsuame::foundation::zero<real, D>()};
    for (std::size_t k = 0; k < weights.size(); ++k) {
      near[k / lanes].weight[k % lanes] = weights[k];
      for (std::size_t a = 0; a < D; ++a) near[k / lanes].offset[a][k % lanes] = offsets[k][a];
    }
    std::vector<double> values(near.size() * lanes, -1.0);
    with_order(std::array{"shepard", "mls", "mls2"}[static_cast<std::size_t>(order)], [&](auto constant) {
      constexpr int Order = decltype(constant)::value;
      moments<D, Order> sums;
      for (const auto& j : near) sums.add(j);
      systems<D, Order> some;
      some.put(marker_lane, sums);
      const auto c = some.coefficients()[marker_lane];
      for (std::size_t k = 0; k < near.size(); ++k)
        shape_function<D, Order>(near[k], c).copy_to(values.data() + k * lanes, std::experimental::element_aligned);
    });
    values.resize(weights.size());
    return values;
  }
  double at_marker(int order, const std::vector<double>& f) const {
    const auto shape = phi(order);
    double sum = 0.0;
    for (std::size_t j = 0; j < f.size(); ++j) sum += shape[j] * f[j];
    return sum;
  }
};

// Particles at random within the marker's reach, none beyond `walls` planes that pass at the depth below it.
template <int D>
cloud<D> disorder(std::size_t n, int walls, double depth, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> coordinate(-1.0, 1.0);
  cloud<D> c;
  while (c.weights.size() < n) {
    std::array<double, D> e;
    double r2 = 0.0;
    for (double& value : e) {
      value = coordinate(random);
      r2 += value * value;
    }
    bool inside = r2 < 1.0;
    for (int a = 0; a < walls; ++a) inside = inside && e[static_cast<std::size_t>(a)] > -depth;
    if (inside) c.add(e);
  }
  return c;
}

// Monomial number `term` of walls::polynomial at each particle; at the marker it is 1 for the first, else 0.
template <int D>
std::vector<double> monomial(const cloud<D>& c, std::size_t term) {
  std::vector<double> f;
  for (const auto& e : c.offsets) f.push_back(polynomial<D>(vec<double, D>{e})[term]);
  return f;
}

// Cholesky's rounding grows with the condition of the moments, up to 1e5 in the corners here: 1e5 × 10 terms × ε
// is 2e-10; monomials are of order 0.1 and a fall to the next lower order misses by as much.
constexpr double tolerance = 1e-9;

template <int D>
void check_orders() {
  for (unsigned seed = 1; seed <= 5; ++seed)
    for (int walls = 0; walls <= D; ++walls)
      for (const double depth : {0.15, 0.6}) {
        const auto c = disorder<D>(D == 2 ? 30 : 60, walls, depth, seed);
        for (int order = 0; order <= 2; ++order)
          for (std::size_t term = 0; term < terms(order, D); ++term)
            BOOST_TEST_CONTEXT("seed " << seed << ", " << walls << " walls, depth " << depth << ", order " << order
                                       << ", term " << term)
        BOOST_TEST(std::abs(c.at_marker(order, monomial(c, term)) - (term == 0 ? 1.0 : 0.0)) < tolerance);
        // The lower orders do miss the next monomial where the cloud is lopsided: the check above can fail.
        if (walls > 0) {
          BOOST_TEST(std::abs(c.at_marker(0, monomial(c, 1))) > 1e-3);
          BOOST_TEST(std::abs(c.at_marker(1, monomial(c, 1 + D))) > 1e-4);
        }
      }
}

// Reproduces exactly the fields of one order, and misses the given monomial of the next.
template <int D>
void check_falls_to(const cloud<D>& c, int asked, int given) {
  for (std::size_t term = 0; term < terms(given, D); ++term)
    BOOST_TEST(std::abs(c.at_marker(asked, monomial(c, term)) - (term == 0 ? 1.0 : 0.0)) < tolerance);
  const auto same = c.phi(given), is = c.phi(asked);
  for (std::size_t j = 0; j < is.size(); ++j) BOOST_TEST(is[j] == same[j]);
}

}  // namespace

BOOST_AUTO_TEST_CASE(exact_for_their_order) {
  check_orders<2>();
  check_orders<3>();
}

BOOST_AUTO_TEST_CASE(shepard_is_a_mean) {
  const auto c = disorder<2>(30, 2, 0.2, 9);
  for (const double value : c.phi(0)) BOOST_TEST(value >= 0.0);
}

BOOST_AUTO_TEST_CASE(particles_in_a_line_or_plane_determine_less) {
  cloud<2> line;
  for (const double t : {-0.7, -0.3, 0.1, 0.2, 0.45, 0.8}) line.add({0.8 * t, 0.6 * t});
  check_falls_to<2>(line, 1, 0);
  check_falls_to<2>(line, 2, 0);
  cloud<2> cross;  // on the axes: no particle tells xy
  for (const double t : {-0.7, -0.3, 0.2, 0.6}) {
    cross.add({t, 0.0});
    cross.add({0.0, t});
  }
  check_falls_to<2>(cross, 2, 1);
  cloud<3> plane;
  for (const auto& e : disorder<2>(20, 1, 0.3, 4).offsets) plane.add({e[0], e[1], 0.5 * (e[0] - e[1])});
  check_falls_to<3>(plane, 1, 0);
  check_falls_to<3>(plane, 2, 0);
}

BOOST_AUTO_TEST_CASE(few_particles) {
  check_falls_to<2>(disorder<2>(5, 0, 1.0, 3), 2, 1);
  check_falls_to<2>(disorder<2>(2, 0, 1.0, 3), 1, 0);
  check_falls_to<3>(disorder<3>(3, 0, 1.0, 3), 2, 0);
  cloud<2> one;
  one.add({0.3, -0.2});
  for (int order = 0; order <= 2; ++order) BOOST_TEST(std::abs(one.phi(order)[0] - 1.0) < 1e-15);
}

BOOST_AUTO_TEST_CASE(no_fluid_in_reach_gives_zeros) {
  cloud<2> far;
  far.offsets = {{0.0, 0.0}, {0.0, 0.0}};  // as padding is handed in
  far.weights = {0.0, 0.0};
  for (int order = 0; order <= 2; ++order) {
    BOOST_TEST(cloud<2>{}.phi(order).empty());
    for (const double value : far.phi(order)) BOOST_TEST(value == 0.0);
  }
}

// Entries of weight zero, among them padding, change nothing.
BOOST_AUTO_TEST_CASE(padding_has_no_share) {
  auto c = disorder<2>(30, 1, 0.2, 6);
  const auto before = c.phi(2);
  c.offsets.push_back({0.0, 0.0});
  c.weights.push_back(0.0);
  const auto after = c.phi(2);
  for (std::size_t j = 0; j < before.size(); ++j) BOOST_TEST(after[j] == before[j]);
  BOOST_TEST(after.back() == 0.0);
}
