// Measures of convection: gradients at a wall, time averages, when a flow is steady; and the input's overrides.
#define BOOST_TEST_MODULE boussinesq
#include <boost/test/unit_test.hpp>
#include <boussinesq/interpolation.hpp>
#include <boussinesq/options.hpp>
#include <boussinesq/steady.hpp>
#include <boussinesq/wall_gradient.hpp>
#include <cmath>
#include <foundation/error.hpp>
#include <namelist/parse.hpp>
#include <random>

using namespace tetsuame;
using namespace tetsuame::boussinesq;
namespace tt = boost::test_tools;

namespace {

std::vector<near_wall> samples_of(int dimension, double (*f)(double y, double x, double z)) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> jitter(-0.2, 0.2);
  std::vector<near_wall> all;
  const int depth = dimension == 3 ? 9 : 1;
  for (int row = 0; row < 4; ++row)
    for (int n = 0; n < 12; ++n)
      for (int l = 0; l < depth; ++l) {
        const double y = row + 0.5 + jitter(random), x = n + 0.5 + jitter(random);
        const double z = dimension == 3 ? l + 0.5 + jitter(random) : 0.0;
        all.push_back({y, {x, z}, f(y, x, z), static_cast<std::int64_t>(all.size())});
      }
  sort(all);
  return all;
}

parameters resolved(const std::string& text, options& o) {
  namelist::schema schema;
  declare(schema, o);
  schema.read(namelist::parse_text(text, "test.nml"));
  return resolve(schema, o);
}

}  // namespace

BOOST_AUTO_TEST_CASE(gradient_at_a_wall_is_exact_for_its_polynomial) {
  const auto flat = samples_of(2, [](double y, double x, double) {
    const double t = x - 6.0;
    return y * (2.0 + 0.3 * t - 0.05 * t * t) + y * y * y * (0.01 - 0.002 * t) + 1e-4 * y * y * y * y * y;
  });
  BOOST_TEST(wall_gradient(flat, {6.0, 0.0}, 3.5, 2) == 2.0, tt::tolerance(1e-10));
  const auto deep = samples_of(3, [](double y, double x, double z) {
    const double t = x - 6.0, s = z - 4.5;
    return y * (2.0 + 0.3 * t - 0.05 * t * t + 0.1 * s + 0.02 * s * s - 0.03 * t * s) + y * y * y * (0.01 + 0.001 * s);
  });
  BOOST_TEST(wall_gradient(deep, {6.0, 4.5}, 3.5, 3) == 2.0, tt::tolerance(1e-10));
  BOOST_TEST(std::isnan(wall_gradient({}, {6.0, 0.0}, 3.5, 2)));
}

BOOST_AUTO_TEST_CASE(interpolation_is_exact_for_polynomials_of_second_degree) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> jitter(-0.2, 0.2);
  const auto first = [](double x, double y) { return 1.0 + 2.0 * x - y + 0.3 * x * x - 0.1 * x * y + 0.2 * y * y; };
  const auto second = [](double x, double y) { return y * y - 4.0 * x; };
  particles::particles<2> s;
  particles::allocate(s, 100, 0, 0, 0);
  particles::array f(s.total()), g(s.total());
  for (std::size_t i = 0; i < s.fluid; ++i) {
    s.id[i] = static_cast<std::int64_t>(i);
    s.x[0][i] = static_cast<double>(i % 10) + jitter(random);
    s.x[1][i] = static_cast<double>(i / 10) + jitter(random);
    f[i] = first(s.x[0][i], s.x[1][i]);
    g[i] = second(s.x[0][i], s.x[1][i]);
  }
  const interpolation<2> at(s, 2.6);
  const auto inside = at({4.3, 5.1}, std::array<const double*, 2>{f.data(), g.data()});
  BOOST_REQUIRE(inside.has_value());
  BOOST_TEST((*inside)[0] == first(4.3, 5.1), tt::tolerance(1e-10));
  BOOST_TEST((*inside)[1] == second(4.3, 5.1), tt::tolerance(1e-10));
  BOOST_TEST(!at({30.0, 5.0}, std::array<const double*, 1>{f.data()}).has_value());
}

BOOST_AUTO_TEST_CASE(averages) {
  record r(2);
  for (int n = 0; n <= 100; ++n) r.add(n, {5.0 + (n % 2 == 0 ? 0.1 : -0.1), 1.0 + 1e-3 * n});
  const auto swinging = r.over(0, 40.0), growing = r.over(1, 40.0);
  BOOST_TEST(swinging.mean == 5.0, tt::tolerance(1e-12));  // 40 samples, later than 60
  BOOST_TEST(swinging.uncertainty < 1e-12);
  BOOST_TEST(growing.mean == 1.0 + 1e-3 * 80.5, tt::tolerance(1e-12));
  // Quarters' means lie at -15, -5, 5, 15 steps: standard error sqrt(500/12) steps.
  BOOST_TEST(growing.uncertainty == 1e-3 * std::sqrt(500.0 / 12.0), tt::tolerance(1e-9));
  BOOST_TEST(r.settled(0, 40.0, 1e-6));
  BOOST_TEST(!r.settled(1, 40.0, 0.01));
  BOOST_TEST(r.settled(1, 40.0, 0.03));   // halves differ by 20 steps: 1.85 %
  BOOST_TEST(!r.settled(0, 200.0, 0.1));  // not that long yet
  record again(2);
  again.restore(r.flat());
  BOOST_TEST(again.size() == r.size());
  BOOST_TEST(again.over(1, 17.0).mean == r.over(1, 17.0).mean);
}

BOOST_AUTO_TEST_CASE(numbers_override_dimensional_values) {
  {
    options o;
    const auto p = resolved("&convection rayleigh = 3e5 /", o);
    BOOST_TEST(relaxation::rayleigh(p.fluid) == 3e5, tt::tolerance(1e-12));
    BOOST_TEST(p.fluid.alpha == 2.5e-5);  // the viscosity gives way
    BOOST_TEST(p.steady);
    BOOST_TEST(p.c_eff == relaxation::sound_speed(p.fluid) / (p.slowing.zeta * p.slowing.xi), tt::tolerance(1e-12));
    BOOST_TEST(p.nu_eff == p.fluid.nu / (p.slowing.xi * p.slowing.xi), tt::tolerance(1e-12));
  }
  {
    options o;
    const auto p = resolved("&convection rayleigh = 1e4 prandtl = 0.71 /", o);
    BOOST_TEST(relaxation::rayleigh(p.fluid) == 1e4, tt::tolerance(1e-12));
    BOOST_TEST(relaxation::prandtl(p.fluid) == 0.71, tt::tolerance(1e-12));
    BOOST_TEST(!p.steady);
    BOOST_TEST(p.slowing.xi == 1.0);
  }
  {
    options o;
    const auto p = resolved("&convection zeta = 2.0 xi = 1e11 gravity_density = 'conventional' /", o);
    BOOST_TEST(p.slowing.zeta == 2.0);
    BOOST_TEST(p.slowing.xi == 1e11);
    BOOST_TEST(p.compressibility == 4.0);
  }
  options o;
  BOOST_CHECK_THROW(resolved("&convection zeta = 2.0 / &relaxation zeta = 3.0 /", o), foundation::error);
  BOOST_CHECK_THROW(resolved("&walls temperature_bottom = -1.0 /", o), foundation::error);
}
