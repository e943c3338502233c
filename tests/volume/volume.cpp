// Volumes and smoothing that need no iteration: definitions, limits, and independence of ranks.
#include <run/passes.hpp>
#include <volume/number_density.hpp>
#include <volume/our_method.hpp>
#include <volume/y_evolution.hpp>

#include "evaluate.hpp"

using namespace tetsuame;
using namespace tetsuame::test;

// Of <liquid/passes.hpp> the passes that are heavy to compile. The equation of state is not among them: it is compared
// to the bit with eos::pressure, which unlike programs does not fuse multiply and add.
#define TETSUAME_VOLUME_PASSES(D)                                                                                    \
  extern template void tetsuame::walls::detail::marker_kinematics(pairs::workspace<D>&, walls::wall_set<D>&);        \
  extern template void tetsuame::walls::detail::nonpressure_acceleration(pairs::workspace<D>&, walls::wall_set<D>&); \
  extern template void tetsuame::walls::detail::nonpressure_acceleration(pairs::workspace<D>&, walls::wall_set<D>&,  \
                                                                         const volume::weight_sum<D, false>&);       \
  extern template void tetsuame::walls::detail::nonpressure_acceleration(pairs::workspace<D>&, walls::wall_set<D>&,  \
                                                                         const volume::weight_sum<D, true>&);        \
  extern template void tetsuame::walls::detail::marker_weights(pairs::workspace<D>&, walls::wall_set<D>&);           \
  extern template void tetsuame::walls::detail::marker_pressures(pairs::workspace<D>&, walls::wall_set<D>&);         \
  extern template void tetsuame::volume::volumes_by_number(const pairs::workspace<D>&, const pairs::row_range&,      \
                                                           double, double*);                                         \
  extern template void tetsuame::volume::smooth(pairs::workspace<D>&, const particles::array&, bool,                 \
                                                const pairs::row_range&);                                            \
  extern template void tetsuame::volume::smooth(pairs::workspace<D>&, const particles::array&, bool,                 \
                                                const pairs::remainder&);                                            \
  extern template void tetsuame::volume::smooth_over_walls<D, false>(pairs::workspace<D>&, walls::wall_set<D>&);     \
  extern template void tetsuame::volume::smooth_over_walls<D, true>(pairs::workspace<D>&, walls::wall_set<D>&);      \
  extern template void tetsuame::volume::smooth_by_lattice(pairs::workspace<D>&, bool, const pairs::row_range&);     \
  extern template void tetsuame::liquid::begin_forces(run::state<D>&, const liquid::rates<D>&);                      \
  extern template void tetsuame::liquid::sum_forces<tetsuame::gradient::pattern_1, D>(                               \
      run::state<D>&, const liquid::rates<D>&, const pairs::row_range&, bool)

TETSUAME_VOLUME_PASSES(2);
TETSUAME_VOLUME_PASSES(3);

namespace {

// Disordered fluid, densities and temperatures that vary by a few per cent: p between 0.7e10 and 1.4e10 Pa.
template <int D>
hydrostatic::scene<D> disorder(const domain::communicator& ranks, bool periodic = true,
                               const std::string& treatment = "none") {
  std::array<std::int64_t, D> n;
  n.fill(8);
  n[0] = 16;
  auto scene = make_scene<D>(box<D>(n, periodic, treatment), ranks, 0.3);
  auto& w = scene.w;
  randomise<D>(w, w.s.rho, 1, 6800.0, 7200.0);
  randomise<D>(w, w.s.T, 2, 2400.0, 2700.0);
  refresh(scene);
  return scene;
}

double close_to(double is, double should) { return std::abs(is / should - 1.0); }

// The linear EOS of test::box.
double linear_pressure(double rho, double T) { return 1e10 + 1e11 * (rho / 7000.0 - 1.0 + 2.5e-5 * (T - 2500.0)); }

// Σ_j Y_j W_ij and Σ_j ΔV_j W_ij, j = i included, by a search through all particles.
template <int D>
std::pair<double, double> direct_sums(const pairs::workspace<D>& w, std::size_t i, const particles::array& Y,
                                      const particles::array& dV) {
  const auto& kernel = std::get<kernels::quintic_spline<D>>(w.kernel);
  double sum_Y = Y[i] * kernel.self(), sum_V = dV[i] * kernel.self();
  neighbours_of<D>(w, i, [&](std::size_t j, const auto&, double r) {
    sum_Y += Y[j] * kernel.value(r);
    sum_V += dV[j] * kernel.value(r);
  });
  return {sum_Y, sum_V};
}

// Sums of some 100 positive terms in two orders.
constexpr double summed = 50.0 * epsilon;

template <int D>
void check_our_method() {
  auto scene = disorder<D>(domain::communicator::world());
  auto& w = scene.w;
  auto& s = w.s;
  const auto rho = s.rho, T = s.T;
  volume::our_method how;
  for (const bool normalise : {false, true}) {
    test::evaluate<volume::smoothed>(scene, how, {normalise});
    particles::array Y(s.total() + 1), dV(s.total() + 1);
    for (std::size_t i = 0; i < s.first_wall(); ++i) {
      // p^ is a difference of 1e11-sized terms at 1e10: ten roundings' worth.
      BOOST_TEST(close_to(s.p_eos[i], linear_pressure(rho[i], T[i])) < 50.0 * epsilon);
      Y[i] = s.m[i] * s.p_eos[i] / rho[i];
      dV[i] = s.m[i] / rho[i];
      BOOST_TEST(close_to(s.Y[i], Y[i]) < 4.0 * epsilon);
      BOOST_TEST(close_to(s.dV[i], s.Y[i] / s.p[i]) < 4.0 * epsilon);
      BOOST_TEST(s.rho[i] == rho[i]);
    }
    for (std::size_t i = 0; i < s.fluid; ++i) {
      const auto [sum_Y, sum_V] = direct_sums<D>(w, i, Y, dV);
      BOOST_TEST(close_to(s.p[i], normalise ? sum_Y / sum_V : sum_Y) < summed);
    }
  }
  test::evaluate<volume::non_smoothed>(scene, how);
  for (std::size_t i = 0; i < s.first_wall(); ++i) {
    BOOST_TEST(s.p[i] == s.p_eos[i]);
    BOOST_TEST(close_to(s.dV[i], s.m[i] / rho[i]) < 4.0 * epsilon);
  }
}

}  // namespace

BOOST_AUTO_TEST_CASE(our_method_by_its_definition) {
  check_our_method<2>();
  check_our_method<3>();
}

// The same p^ with volumes in disorder: the plain sum shows the disorder, the normalised one does not.
BOOST_AUTO_TEST_CASE(normalised_smoothing_restores_constants) {
  auto scene = disorder<2>(domain::communicator::world());
  auto& s = scene.w.s;
  fill<2>(scene.w, s.rho, [](std::size_t) { return 7000.0; });
  fill<2>(scene.w, s.T, [](std::size_t) { return 2500.0; });
  volume::our_method how;
  const auto error = [&](bool normalise) {
    test::evaluate<volume::smoothed>(scene, how, {normalise});
    double largest = 0.0;
    for (std::size_t i = 0; i < s.fluid; ++i) largest = std::max(largest, close_to(s.p[i], 1e10));
    return scene.w.d.ranks.maximum(largest);
  };
  BOOST_TEST(error(true) < summed);
  BOOST_TEST(error(false) > 1e-2);
}

// On the lattice itself the plain sum is the lattice's: 1 - 5.6e-5.
BOOST_AUTO_TEST_CASE(smoothing_on_the_lattice_is_the_lattice_sum) {
  auto scene = make_scene<2>(box<2>({16, 8}, true), domain::communicator::world());
  refresh(scene);
  volume::our_method how;
  test::evaluate<volume::smoothed>(scene, how);
  for (std::size_t i = 0; i < scene.w.s.fluid; ++i) {
    BOOST_TEST(close_to(scene.w.s.p[i], 1e10 * scene.w.lattice_sum) < summed);
    BOOST_TEST(close_to(scene.w.s.p[i], 1e10) > 5e-5);
  }
}

BOOST_AUTO_TEST_CASE(pressure_without_meaning_names_its_particle) {
  auto scene = disorder<2>(domain::communicator::world());
  auto& s = scene.w.s;
  fill<2>(scene.w, s.rho, [&](std::size_t i) { return s.id[i] == 77 || s.id[i] == 99 ? 6000.0 : 7000.0; });
  volume::our_method how;
  BOOST_CHECK_EXCEPTION(test::evaluate<volume::smoothed>(scene, how), foundation::error,
                        [](const foundation::error& e) {
                          return e.status() == foundation::exit_status::calculation_failed &&
                                 std::string(e.what()).find("particle 77 ") != std::string::npos;
                        });
}

// ΔV is Δx^D on the start lattice, and does not change when the lattice is moved as a whole: to the rounding
// of coordinates up to 16 (ε 16 in an x_ij of order one) in a sum whose terms change by at most their own size.
BOOST_AUTO_TEST_CASE(number_density_on_the_lattice) {
  const auto check = []<int D>(std::array<std::int64_t, D> n) {
    for (const double shift : {0.0, 0.377}) {
      auto scene =
          make_scene<D>(box<D>(n, true), domain::communicator::world(), [&](std::int64_t, std::array<double, D> x) {
            for (std::size_t a = 0; a < D; ++a) x[a] += shift * static_cast<double>(a + 1);
            return x;
          });
      refresh(scene);
      volume::number_density how;
      test::evaluate<volume::non_smoothed>(scene, how);
      const auto& s = scene.w.s;
      for (std::size_t i = 0; i < s.first_wall(); ++i) {
        BOOST_TEST(std::abs(s.dV[i] - 1.0) < 100.0 * epsilon);
        BOOST_TEST(close_to(s.rho[i], 7000.0) < 100.0 * epsilon);
      }
    }
  };
  check.operator()<2>({16, 8});
  check.operator()<3>({16, 8, 8});
}

// By its definition on disorder, walls counted like fluid.
BOOST_AUTO_TEST_CASE(number_density_by_its_definition) {
  auto scene = disorder<2>(domain::communicator::world(), false, "virtual_marker");
  auto& w = scene.w;
  auto& s = w.s;
  volume::number_density how;
  test::evaluate<volume::non_smoothed>(scene, how);
  const particles::array ones(s.total() + 1, 1.0);
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const double sigma = direct_sums<2>(w, i, ones, ones).first / w.lattice_sum;
    BOOST_TEST(close_to(s.dV[i], 1.0 / sigma) < summed);
    BOOST_TEST(close_to(s.rho[i], s.m[i] * sigma) < summed);
    BOOST_TEST(s.p[i] == s.p_eos[i]);
    BOOST_TEST(close_to(s.Y[i], s.p[i] * s.dV[i]) < summed);
  }
}

// Y = m p^(ρ, T)/ρ along a change of ρ and T that is uniform in space, where the smoothing has nothing to do:
// the rate against a central difference. Its error is of second order: steps of 1e-5 give 1e-10, and rounding ε/1e-5
// 2e-11.
BOOST_AUTO_TEST_CASE(rate_of_y_follows_the_equation_of_state) {
  for (const std::string name : {"linear", "liquid_iron", "ideal_gas"}) {
    eos::material_options o;
    o.name = name;
    const auto material = eos::make(eos::resolve(o));
    const double rho = name == "ideal_gas" ? 1.2 : 7900.0, T = 2600.0, m = 3.0;
    const auto e = eos::evaluate(material, rho, T);
    const auto Y = [&](double r, double t) { return m * eos::pressure(material, r, t) / r; };
    for (const auto& [compression, heating] : {std::pair{1.0, 0.0}, {0.0, 40.0}, {-0.6, 25.0}}) {  // D ln ρ/Dt, DT/Dt
      const double dt = 1e-5;
      const double difference = (Y(rho * std::exp(compression * dt), T + heating * dt) -
                                 Y(rho * std::exp(-compression * dt), T - heating * dt)) /
                                (2.0 * dt);
      const double power = e.p * compression / rho;  // of the pressure, per mass
      const double rate = volume::y_evolution::rate(e.p, e.K_T, e.alpha, m / rho, m, power, heating);
      BOOST_TEST(std::abs(rate - difference) < 1e-8 * Y(rho, T));
    }
  }
}

BOOST_AUTO_TEST_CASE(y_evolution_by_its_definition) {
  auto scene = disorder<2>(domain::communicator::world());
  auto& w = scene.w;
  auto& s = w.s;
  randomise<2>(w, s.Y, 3, 0.9e10, 1.1e10);
  const auto Y = s.Y;
  volume::y_evolution how;
  test::evaluate<volume::smoothed>(scene, how);
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const double p = direct_sums<2>(w, i, Y, Y).first;
    BOOST_TEST(close_to(s.p[i], p) < summed);
    BOOST_TEST(s.Y[i] == Y[i]);
    BOOST_TEST(close_to(s.rho[i], s.m[i] * p / Y[i]) < 2.0 * summed);
    BOOST_TEST(close_to(s.dV[i], Y[i] / p) < 2.0 * summed);
    BOOST_TEST(s.p_eos[i] == eos::pressure(w.materials[0], s.rho[i], s.T[i]));
  }
  fill<2>(w, s.Y, [&](std::size_t i) { return s.id[i] == 31 ? -1.0 : Y[i]; });
  BOOST_CHECK_EXCEPTION(
      test::evaluate<volume::smoothed>(scene, how), foundation::error,
      [](const foundation::error& e) { return std::string(e.what()).find("particle 31 ") != std::string::npos; });
}

// The sums of particles near walls with markers are made in a pass with the acceleration there, and what the walls add
// later: but for rounding those of one pass.
BOOST_AUTO_TEST_CASE(smoothing_in_parts_is_one_sum) {
  const auto check = []<int D>(std::type_identity<pairs::workspace<D>>, bool normalise) {
    auto scene = disorder<D>(domain::communicator::world(), false, "virtual_marker");
    auto& w = scene.w;
    w.g[1] = -10.0;
    for (std::size_t a = 0; a < D; ++a) randomise<D>(w, w.s.v[a], 5 + a, -10.0, 10.0);
    refresh(scene);
    volume::our_method how;
    test::evaluate<volume::smoothed>(scene, how, {.normalise = normalise});
    const auto parts = fluid_by_id(scene, w.s.p);
    volume::weights_by_density(w, w.s.dV, 0, w.s.first_wall(), {});
    walls::virtual_marker::kinematics(w, scene.walls);
    walls::virtual_marker::weights(w, scene.walls);
    volume::smooth(w, w.s.dV, normalise, w.fluid());
    const auto once = fluid_by_id(scene, w.s.p);
    double apart = 0.0;
    for (std::size_t k = 0; k < once.size(); ++k)
      if (once[k] != 0.0) apart = std::max(apart, close_to(parts[k], once[k]));
    BOOST_TEST(apart < 1e-13);
  };
  for (const bool normalise : {false, true}) {
    check(std::type_identity<pairs::workspace<2>>{}, normalise);
    check(std::type_identity<pairs::workspace<3>>{}, normalise);
  }
}

BOOST_AUTO_TEST_CASE(same_bits_on_any_ranks) {
  const auto values = []<class Pressure, class Volume>(const domain::communicator& ranks, Pressure, Volume how) {
    auto scene = disorder<2>(ranks, false, "virtual_marker");
    randomise<2>(scene.w, scene.w.s.Y, 3, 0.9e10, 1.1e10);
    test::evaluate<Pressure>(scene, how, {.normalise = true});
    std::vector<double> all;
    for (const auto* a : {&scene.w.s.Y, &scene.w.s.p, &scene.w.s.dV, &scene.w.s.rho, &scene.w.s.K_T}) {
      const auto one = fluid_by_id(scene, *a);
      all.insert(all.end(), one.begin(), one.end());
    }
    return all;
  };
  const auto world = domain::communicator::world();
  const auto check = [&](auto pressure, auto how) {
    BOOST_TEST(same_bits(values(world, pressure, how), values(alone(), pressure, how)));
  };
  check(volume::smoothed{}, volume::our_method{});
  check(volume::non_smoothed{}, volume::number_density{});
  check(volume::smoothed{}, volume::y_evolution{});
}
