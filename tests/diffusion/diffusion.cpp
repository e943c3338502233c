// Viscosity and conduction: what is exchanged, which way it flows, and how fast a wave decays.
#include <diffusion/conduction.hpp>
#include <diffusion/viscosity.hpp>
#include <liquid/passes.hpp>
#include <numbers>

#include "../support/scene.hpp"

using namespace tetsuame;
using namespace tetsuame::test;

namespace {

template <int D>
struct output_arrays {
  std::array<particles::array, D> force;
  particles::array heat;
  explicit output_arrays(std::size_t n) : heat(n, 0.0) { force.fill(particles::array(n, 0.0)); }
};

template <int D, template <int> class Term = diffusion::viscosity>
output_arrays<D> friction(const pairs::workspace<D>& w) {
  const auto& s = w.s;
  output_arrays<D> out(s.fluid);
  std::array<double*, D> force;
  for (std::size_t a = 0; a < D; ++a) force[a] = out.force[a].data();
  test::sum<D>(w, Term<D>{pairs::pointers<D>(s.v), s.eta.data(), s.dV.data(), force, out.heat.data()});
  return out;
}

template <int D>
particles::array conducted(const pairs::workspace<D>& w) {
  particles::array heat(w.s.fluid, 0.0);
  test::sum<D>(w, diffusion::conduction<D>{w.s.T.data(), w.s.k.data(), w.s.dV.data(), heat.data()});
  return heat;
}

template <int D>
hydrostatic::scene<D> disorder() {
  std::array<std::int64_t, D> n;
  n.fill(8);
  n[0] = 16;
  auto scene = make_scene<D>(box<D>(n, true), domain::communicator::world(), 0.4);
  auto& w = scene.w;
  auto& s = w.s;
  randomise<D>(w, s.dV, 2, 0.7, 1.3);
  randomise<D>(w, s.m, 3, 5e3, 9e3);
  randomise<D>(w, s.T, 7, 300.0, 3000.0);
  for (std::size_t a = 0; a < D; ++a) randomise<D>(w, s.v[a], 4 + a, -100.0, 100.0);
  // Six decades, and a third of the particles without any: the harmonic mean's hard cases.
  fill<D>(w, s.eta, [&](std::size_t i) { return s.id[i] % 3 == 0 ? 0.0 : std::pow(10.0, 3.0 * noise(s.id[i], 8)); });
  fill<D>(w, s.k, [&](std::size_t i) { return s.id[i] % 3 == 1 ? 0.0 : std::pow(10.0, 3.0 * noise(s.id[i], 9)); });
  return scene;
}

// Halves of a pair are equal and opposite but for positions rounded at a border: see tests/gradient.
constexpr double balance = 300.0 * epsilon;

template <int D, template <int> class Term = diffusion::viscosity>
void check_viscosity() {
  const auto scene = disorder<D>();
  const auto& w = scene.w;
  const auto& s = w.s;
  const auto out = friction<D, Term>(w);
  for (std::size_t a = 0; a < D; ++a) {
    const auto momentum = total<D>(w, [&](std::size_t i) { return out.force[a][i]; });
    BOOST_TEST(momentum.magnitude > 0.0);
    BOOST_TEST(std::abs(momentum.sum) <= balance * momentum.magnitude);
  }
  const auto power = [&](std::size_t i) {
    double kinetic = 0.0;
    for (std::size_t a = 0; a < D; ++a) kinetic += s.v[a][i] * out.force[a][i];
    return kinetic;
  };
  const auto kinetic = total<D>(w, power);
  const auto heat = total<D>(w, [&](std::size_t i) { return out.heat[i]; });
  const auto energy = total<D>(w, [&](std::size_t i) { return power(i) + out.heat[i]; });
  BOOST_TEST(heat.sum > 0.0);
  BOOST_TEST(std::abs(energy.sum) <= balance * (kinetic.magnitude + heat.magnitude));
  std::size_t cooled = 0, stirred = 0;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    cooled += out.heat[i] < 0.0;
    // Without viscosity of its own a particle neither rubs nor is rubbed: 4 η 0/(η + 0) = 0.
    if (s.eta[i] == 0.0) stirred += out.heat[i] != 0.0 || out.force[0][i] != 0.0;
  }
  BOOST_TEST(cooled == 0U);
  BOOST_TEST(stirred == 0U);
}

template <int D>
void check_conduction() {
  const auto scene = disorder<D>();
  const auto& w = scene.w;
  const auto heat = conducted<D>(w);
  const auto all = total<D>(w, [&](std::size_t i) { return heat[i]; });
  BOOST_TEST(all.magnitude > 0.0);
  BOOST_TEST(std::abs(all.sum) <= balance * all.magnitude);
}

// Σ_j 2 ΔV F (1 - cos k x) over the lattice: the rate of ∇² on a wave along x, 1/m².
double lattice_laplacian(const kernels::quintic_spline<2>& kernel, double k) {
  double sum = 0.0;
  for (int a = -4; a <= 4; ++a)
    for (int b = -4; b <= 4; ++b)
      if (a != 0 || b != 0) sum += 2.0 * kernel.gradient_over_r(std::hypot(a, b)) * (1.0 - std::cos(k * a));
  return sum;
}

}  // namespace

BOOST_AUTO_TEST_CASE(viscosity_balances) {
  check_viscosity<2>();
  check_viscosity<3>();
}

BOOST_AUTO_TEST_CASE(symmetric_viscosity_balances) {
  check_viscosity<2, diffusion::symmetric_viscosity>();
  check_viscosity<3, diffusion::symmetric_viscosity>();
}

// One value for all particles is an array of it.
BOOST_AUTO_TEST_CASE(one_value_for_all) {
  auto scene = disorder<3>();
  auto& s = scene.w.s;
  const double value = 3.7;
  fill<3>(scene.w, s.eta, [&](std::size_t) { return value; });
  fill<3>(scene.w, s.k, [&](std::size_t) { return value; });
  const auto by_array = friction<3, diffusion::symmetric_viscosity>(scene.w);
  output_arrays<3> by_value(s.fluid);
  std::array<double*, 3> force;
  for (std::size_t a = 0; a < 3; ++a) force[a] = by_value.force[a].data();
  const diffusion::symmetric_viscous_sum<3, double> one{pairs::pointers<3>(s.v), value, s.dV.data(), force,
                                                        by_value.heat.data()};
  test::sum<3>(scene.w, one);
  const auto conducted_by_array = conducted<3>(scene.w);
  particles::array conducted_by_value(s.fluid, 0.0);
  test::sum<3>(scene.w,
               diffusion::conduction_sum<3, double>{s.T.data(), value, s.dV.data(), conducted_by_value.data()});
  double scale = 0.0, off = 0.0, heat = 0.0, conducted_off = 0.0, conducted_scale = 0.0;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    scale = std::max(scale, std::abs(by_array.force[0][i]));
    off = std::max(off, std::abs(by_array.force[0][i] - by_value.force[0][i]));
    heat = std::max(heat, std::abs(by_array.heat[i] / by_value.heat[i] - 1.0));
    conducted_scale = std::max(conducted_scale, std::abs(conducted_by_array[i]));
    conducted_off = std::max(conducted_off, std::abs(conducted_by_array[i] - conducted_by_value[i]));
  }
  BOOST_TEST(scale > 0.0);
  BOOST_TEST(off <= 1e-13 * scale);
  BOOST_TEST(heat <= 1e-13);
  BOOST_TEST(conducted_off <= 1e-13 * conducted_scale);
}

// What turns as a solid has no stress, whatever the viscosities; with the Laplacian's sum it has where these differ.
// Away from the sides, over which the motion does not go on.
BOOST_AUTO_TEST_CASE(rotation_is_free) {
  const auto largest_force = [](auto with) {
    auto scene = disorder<2>();
    auto& s = scene.w.s;
    fill<2>(scene.w, s.v[0], [&](std::size_t i) { return -s.x[1][i]; });
    fill<2>(scene.w, s.v[1], [&](std::size_t i) { return s.x[0][i]; });
    const auto out = with(scene.w);
    double most = 0.0;
    for (std::size_t i = 0; i < s.fluid; ++i)
      if (std::abs(s.x[1][i] - 4.0) < 0.3 && std::abs(s.x[0][i] - 8.0) < 3.0)
        most = std::max(most, std::abs(out.force[0][i]));
    return scene.w.d.ranks.maximum(most);
  };
  const double laplacian = largest_force([](const auto& w) { return friction<2>(w); });
  const double symmetric = largest_force([](const auto& w) { return friction<2, diffusion::symmetric_viscosity>(w); });
  BOOST_TEST_MESSAGE("forces " << symmetric << ", " << laplacian);
  BOOST_TEST(laplacian > 0.0);
  BOOST_TEST(symmetric < 1e-12 * laplacian);
}

BOOST_AUTO_TEST_CASE(conduction_balances) {
  check_conduction<2>();
  check_conduction<3>();
}

BOOST_AUTO_TEST_CASE(harmonic_mean) {
  const auto mean = [](double a, double b) { return double{diffusion::harmonic(pairs::real(a), pairs::real(b))[0]}; };
  BOOST_TEST(mean(0.0, 0.0) == 0.0);
  BOOST_TEST(mean(0.0, 5.0) == 0.0);
  BOOST_TEST(mean(3.0, 3.0) == 6.0);
  // 4 a b/(a + b) with every step exact, or one rounding of each
  BOOST_TEST(mean(1.0, 3.0) == 3.0);
  BOOST_TEST(mean(2.0, 7.0) == mean(7.0, 2.0));
  // A lane that vanishes leaves its neighbours alone.
  pairs::real a(1.0), b(3.0);
  a[0] = b[0] = 0.0;
  const auto lanes = diffusion::harmonic(a, b);
  BOOST_TEST(double{lanes[0]} == 0.0);
  BOOST_TEST(double{lanes[1]} == 3.0);
}

// One hot particle gives, all in its reach take, the others nothing.
BOOST_AUTO_TEST_CASE(heat_flows_downhill) {
  auto scene = disorder<2>();
  auto& w = scene.w;
  auto& s = w.s;
  randomise<2>(w, s.k, 9, 1.0, 5.0);
  fill<2>(w, s.T, [&](std::size_t i) { return s.id[i] == 53 ? 900.0 : 300.0; });
  const auto heat = conducted<2>(w);
  std::int64_t takers = 0, givers = 0;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    takers += heat[i] > 0.0;
    givers += heat[i] < 0.0;
    BOOST_TEST((heat[i] < 0.0) == (s.id[i] == 53));
  }
  BOOST_TEST(w.d.ranks.sum(givers) == 1);
  // π 3.6² = 41 places in reach of the quintic's support, itself among them; ± what disorder moves over its edge
  BOOST_TEST(w.d.ranks.sum(takers) >= 30);
  BOOST_TEST(w.d.ranks.sum(takers) <= 50);
}

BOOST_AUTO_TEST_CASE(uniform_fields_rest) {
  auto scene = disorder<2>();
  auto& w = scene.w;
  fill<2>(w, w.s.T, [](std::size_t) { return 1234.5; });
  for (std::size_t a = 0; a < 2; ++a) fill<2>(w, w.s.v[a], [](std::size_t) { return -3.25; });
  const auto out = friction<2>(w);
  for (const double q : conducted<2>(w)) BOOST_TEST(q == 0.0);
  for (std::size_t i = 0; i < w.s.fluid; ++i)
    BOOST_TEST((out.force[0][i] == 0.0 && out.force[1][i] == 0.0 && out.heat[i] == 0.0));
}

// sin(k x) on the lattice is an eigenvector of the sum, with the lattice's rate; the rate is that of
// κ∇² but for terms of the order (k h)²: at 16 spacings a wave kh = 0.47, and 5 % bounds (kh)²/5.
BOOST_AUTO_TEST_CASE(sine_modes_decay) {
  auto scene = make_scene<2>(box<2>({16, 8}, true), domain::communicator::world());
  auto& w = scene.w;
  auto& s = w.s;
  const double k = 2.0 * std::numbers::pi / 16.0;
  const auto wave = [&](std::size_t i) { return std::sin(k * s.x[0][i]); };
  fill<2>(w, s.T, wave);
  fill<2>(w, s.v[0], [](std::size_t) { return 0.0; });
  fill<2>(w, s.v[1], wave);
  fill<2>(w, s.dV, [](std::size_t) { return 1.0; });
  fill<2>(w, s.k, [](std::size_t) { return 4.0; });
  fill<2>(w, s.eta, [](std::size_t) { return 9.0; });
  const double lattice = lattice_laplacian(std::get<kernels::quintic_spline<2>>(w.kernel), k);
  BOOST_TEST_MESSAGE("lattice rate/analytic rate " << lattice / (-k * k));
  BOOST_TEST(std::abs(lattice / (-k * k) - 1.0) < 0.05);
  const auto heat = conducted<2>(w);
  const auto out = friction<2>(w);
  for (std::size_t i = 0; i < s.fluid; ++i) {
    // Some 40 terms of order one.
    BOOST_TEST(std::abs(heat[i] - 4.0 * lattice * wave(i)) < 4.0 * 50.0 * epsilon);
    BOOST_TEST(std::abs(out.force[1][i] - 9.0 * lattice * wave(i)) < 9.0 * 50.0 * epsilon);
    BOOST_TEST(out.force[0][i] == 0.0);
  }
}

// Heat is added to what stands in the arrays: terms of one pass share them.
BOOST_AUTO_TEST_CASE(terms_add_to_their_arrays) {
  const auto scene = disorder<2>();
  const auto& w = scene.w;
  const auto once = conducted<2>(w);
  auto twice = once;
  test::sum<2>(w, diffusion::conduction<2>{w.s.T.data(), w.s.k.data(), w.s.dV.data(), twice.data()});
  for (std::size_t i = 0; i < w.s.fluid; ++i) BOOST_TEST(twice[i] == 2.0 * once[i]);
}
