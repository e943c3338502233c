// Hosono's iteration: one answer whatever the solver, the limits theory gives it, and how it fails.
#include <liquid/passes.hpp>
#include <volume/hosono_iteration.hpp>

#include "evaluate.hpp"

using namespace tetsuame;
using namespace tetsuame::test;

namespace {

constexpr double K_T = 1e11;  // Pa

hydrostatic::options at_pressure(double p) {
  auto o = box<2>({16, 8}, true);
  o.initial.pressure = p;
  o.material.eos.reference_pressure = p;
  o.material.eos.bulk_modulus = K_T;
  return o;
}

struct outcome {
  std::vector<double> Y, p, rho, p_eos;  // by ID
  std::int64_t passes;
  std::vector<double> residuals;
};

outcome solve(const hydrostatic::options& o, double jitter, volume::hosono_options options,
              const domain::communicator& ranks = domain::communicator::world(), bool normalise = false) {
  auto scene = make_scene<2>(o, ranks, jitter);
  refresh(scene);
  volume::add_density_guess(scene.w.s);
  volume::hosono_iteration how;
  how.how = std::move(options);
  test::evaluate<volume::smoothed>(scene, how, {normalise});
  const auto& s = scene.w.s;
  outcome result{fluid_by_id(scene, s.Y),
                 fluid_by_id(scene, s.p),
                 fluid_by_id(scene, s.rho),
                 fluid_by_id(scene, s.p_eos),
                 how.passes,
                 {}};
  for (const auto& r : how.residuals) result.residuals.push_back(r.residual);
  return result;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(std::log(a[i] / b[i])));
  return largest;
}

// What every solution is, whatever found it: p^ = p and ρ = m p/Y to the tolerance; p = Σ Y W holds by construction.
void check_solution(const outcome& r, double tolerance) {
  BOOST_TEST(largest_difference(r.p_eos, r.p) <= 1.01 * tolerance);
  for (std::size_t i = 0; i < r.Y.size(); ++i)
    BOOST_TEST(std::abs(r.rho[i] * r.Y[i] / (7000.0 * r.p[i]) - 1.0) <= 1.01 * tolerance);
}

}  // namespace

// With κ = K_T/p the linear operator 1 + (κ - 1)(1 - S) lies between 1 and κ: a residual of tol leaves an
// error of at most tol in ln Y times a few for the walk back through p; ten times bounds it for all.
BOOST_AUTO_TEST_CASE(all_solvers_agree_where_plain_converges) {
  const double tolerance = 1e-11;
  const auto plain = solve(at_pressure(0.7 * K_T), 0.2, {.solver = "plain", .tolerance = tolerance});
  check_solution(plain, tolerance);
  for (const std::string solver : {"under_relaxed", "anderson", "newton"}) BOOST_TEST_CONTEXT(solver) {
      const auto other = solve(at_pressure(0.7 * K_T), 0.2, {.solver = solver, .tolerance = tolerance});
      check_solution(other, tolerance);
      BOOST_TEST(largest_difference(other.Y, plain.Y) < 10.0 * tolerance);
    }
}

BOOST_AUTO_TEST_CASE(the_cures_agree_where_plain_diverges) {
  const double tolerance = 1e-10;
  const auto newton = solve(at_pressure(0.1 * K_T), 0.1, {.solver = "newton", .tolerance = tolerance});
  check_solution(newton, tolerance);
  BOOST_TEST_MESSAGE("newton: " << newton.passes << " passes");
  for (const std::string solver : {"under_relaxed", "anderson"}) BOOST_TEST_CONTEXT(solver) {
      const auto other =
          solve(at_pressure(0.1 * K_T), 0.1, {.solver = solver, .tolerance = tolerance, .max_iterations = 20000});
      BOOST_TEST_MESSAGE(solver << ": " << other.passes << " passes");
      check_solution(other, tolerance);
      BOOST_TEST(largest_difference(other.Y, newton.Y) < 10.0 * 10.0 * tolerance);  // κ = 10 between ln ρ and ln p
    }
  BOOST_CHECK_THROW(solve(at_pressure(0.1 * K_T), 0.1, {.solver = "plain"}), volume::divergence);
}

// Theory: a pass multiplies the wave of S_min by G = -(κ - 1)(1 - S_min). From a perturbation of 1e-6 the fastest
// wave leads while it is still linear; 20 % is what is left of the slower ones beside it.
BOOST_AUTO_TEST_CASE(plain_diverges_at_the_rate_of_theory) {
  for (const double ratio : {0.4, 0.3, 0.2}) {  // p/K_T
    const auto o = at_pressure(ratio * K_T);
    auto scene = make_scene<2>(o, domain::communicator::world(), 1e-6);
    refresh(scene);
    const double S_min = kernels::transfer_minimum<2>(scene.w.kernel, scene.w.dx).value;
    const double G = (1.0 / ratio - 1.0) * (1.0 - S_min);
    volume::add_density_guess(scene.w.s);
    volume::hosono_iteration how;
    how.how = {.solver = "plain", .tolerance = 1e-13, .max_iterations = 200};
    std::string message;
    try {
      test::evaluate<volume::smoothed>(scene, how);
    } catch (const volume::divergence& e) {
      message = e.what();
      BOOST_TEST(e.iteration() == static_cast<std::int64_t>(how.residuals.size()));
    }
    // Diverged, it leaves the density with which it began, and numbers.
    const auto& s = scene.w.s;
    const auto& guess = particles::extra(s, volume::density_guess);
    for (std::size_t i = 0; i < s.fluid; ++i)
      BOOST_REQUIRE((s.rho[i] == guess[i] && std::isfinite(s.p[i]) && std::isfinite(s.Y[i])));
    BOOST_REQUIRE(!message.empty());
    BOOST_TEST(message.find("solver = 'newton'") != std::string::npos);
    // The last passes whose residual is below 1 %.
    double measured = 0.0;
    for (std::size_t n = 1; n < how.residuals.size(); ++n)
      if (how.residuals[n].residual < 1e-2) measured = how.residuals[n].residual / how.residuals[n - 1].residual;
    BOOST_TEST_MESSAGE("p/K_T " << ratio << ": growth " << measured << ", theory " << G);
    BOOST_TEST(std::abs(measured / G - 1.0) < 0.2);
  }
}

BOOST_AUTO_TEST_CASE(plain_converges_above_half_the_modulus) {
  const auto r = solve(at_pressure(0.55 * K_T), 1e-6, {.solver = "plain", .tolerance = 1e-12});
  check_solution(r, 1e-12);
}

// An ideal gas at fixed T has κ = 1: Y_new = m R T whatever ρ, so the second pass confirms the first.
BOOST_AUTO_TEST_CASE(ideal_gas_converges_at_once) {
  auto o = box<2>({16, 8}, true);
  o.material.eos = {};
  o.material.eos.name = "ideal_gas";
  o.initial.temperature = 300.0;
  o.initial.pressure = 1e5;
  for (const std::string solver : {"plain", "under_relaxed"}) {
    const auto r = solve(o, 0.3, {.solver = solver, .tolerance = 1e-13});
    BOOST_TEST(r.passes <= 4);
    BOOST_TEST(largest_difference(r.p_eos, r.p) < 1e-12);
  }
}

// What moves particles does to the densities that the iteration finds, T held (docs/theory/claims_of_the_notes.md).
// With r = δ ln ρ, κ = K_T/p and θ_i = Σ_j Y_j/p_i v_ij·∇_i W_ij of positions moved by v:
//   κ_i p_i r_i - Σ_j Y_j (κ_j - 1) r_j W_ij = p_i θ_i
// so that r = θ/[1 + (κ - 1)(1 - S)] of a wave: θ where it is long, θ/κ where neighbours alternate.
BOOST_AUTO_TEST_CASE(density_follows_the_places) {
  const auto world = domain::communicator::world();
  if (world.size > 1) return;                 // loops over what one rank has
  constexpr double kappa = 5.0, step = 1e-5;  // m
  const auto o = at_pressure(K_T / kappa);
  const auto check = [&](double jitter, const auto& v) {
    const auto at = [&](double time) {
      std::vector<std::array<double, 2>> velocity(16 * 8);
      auto scene = make_scene<2>(o, world, [&](std::int64_t id, std::array<double, 2> x) {
        const auto moved = velocity[static_cast<std::size_t>(id)] = v(x);
        for (std::size_t a = 0; a < 2; ++a) x[a] += jitter * noise(id, 100 + a) + time * moved[a];
        return x;
      });
      for (std::size_t a = 0; a < 2; ++a)
        fill<2>(scene.w, scene.w.s.v[a],
                [&](std::size_t i) { return velocity[static_cast<std::size_t>(scene.w.s.id[i])][a]; });
      refresh(scene);
      volume::add_density_guess(scene.w.s);
      volume::hosono_iteration how;
      how.how = {.solver = "newton", .tolerance = 1e-13};
      test::evaluate<volume::smoothed>(scene, how);
      return scene;
    };
    const auto before = at(-step), now = at(0.0), after = at(step);
    const auto rho_before = fluid_by_id(before, before.w.s.rho), rho_after = fluid_by_id(after, after.w.s.rho);
    const auto& s = now.w.s;
    const auto r = [&](std::size_t j) {
      const auto id = static_cast<std::size_t>(s.id[j]);
      return std::log(rho_after[id] / rho_before[id]) / (2.0 * step);
    };
    const auto& kernel = std::get<kernels::quintic_spline<2>>(now.w.kernel);
    double miss = 0.0, size = 0.0, product = 0.0, square = 0.0;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      double left = s.K_T[i] * r(i) - s.Y[i] * (s.K_T[i] / s.p[i] - 1.0) * r(i) * kernel.value(0.0), theta = 0.0;
      neighbours_of<2>(now.w, i, [&](std::size_t j, const std::array<double, 2>& x_ij, double distance) {
        left -= s.Y[j] * (s.K_T[j] / s.p[j] - 1.0) * r(j) * kernel.value(distance);
        for (std::size_t a = 0; a < 2; ++a)
          theta += s.Y[j] / s.p[i] * kernel.gradient_over_r(distance) * x_ij[a] * (s.v[a][i] - s.v[a][j]);
      });
      miss = std::max(miss, std::abs(left - s.p[i] * theta));
      size = std::max(size, std::abs(s.p[i] * theta));
      product += r(i) * theta;
      square += theta * theta;
    }
    // Rounding of 1e-13 κ/step, and step² of the difference.
    BOOST_TEST(miss <= 1e-6 * size);
    return product / square;
  };
  const double pi = std::acos(-1.0);
  const auto long_wave = [&](const auto& x) { return std::array{std::sin(2.0 * pi / 16.0 * x[0]), 0.0}; };
  const auto short_wave = [&](const auto& x) {
    return std::array{std::sin(0.75 * pi * x[0]) * std::cos(pi * (x[1] - 0.5)), 0.0};
  };
  check(0.2, long_wave);
  // On the lattice: the wave's S, by the sum itself.
  const auto of_wave = [&](double k_x, double k_y) {
    const kernels::quintic_spline<2> kernel(3.6);
    double S = 0.0;
    for (int a = -4; a <= 4; ++a)
      for (int b = -4; b <= 4; ++b) S += kernel.value(std::hypot(a, b)) * std::cos(k_x * a) * std::cos(k_y * b);
    return 1.0 / (1.0 + (kappa - 1.0) * (1.0 - S));
  };
  for (const auto& [is, want] : {std::pair{check(0.0, long_wave), of_wave(2.0 * pi / 16.0, 0.0)},
                                 std::pair{check(0.0, short_wave), of_wave(0.75 * pi, pi)}}) {
    BOOST_TEST_MESSAGE("density over divergence: " << is << ", of the wave " << want);
    // κ of the solution differs from that of the start by κ times the lattice's 5.6e-5 times κ.
    BOOST_TEST(std::abs(is / want - 1.0) <= 5e-3);
  }
}

// The most that smoothing allows is p^(m σ_max); on the lattice p0 - K_T (1 - s). The proof speaks exactly where that
// is not positive, and never with normalised smoothing there.
BOOST_AUTO_TEST_CASE(proof_that_no_state_exists) {
  const auto proof = [](double p, bool normalise) {
    auto scene = make_scene<2>(at_pressure(p), domain::communicator::world());
    refresh(scene);
    volume::add_density_guess(scene.w.s);
    auto& s = scene.w.s;
    const volume::pressure_rule none;
    const volume::wall_context<2> around{scene.treatment, scene.walls, {normalise}, s.dV, none};
    volume::weights_by_density(scene.w, s.dV, 0, s.first_wall(), none);
    return volume::detail::no_state_exists(scene.w, around);
  };
  const auto scene = make_scene<2>(at_pressure(1e10), alone());
  const double least = K_T * (1.0 - scene.w.lattice_sum);
  BOOST_TEST(std::abs(least / 5.622e6 - 1.0) < 1e-3);
  BOOST_TEST(!proof(1e5, false).empty());
  BOOST_TEST(!proof(least * (1.0 - 1e-6), false).empty());
  BOOST_TEST(proof(least * (1.0 + 1e-6), false).empty());
  for (const double p : {1e5, least * (1.0 - 1e-6)}) BOOST_TEST(proof(p, true).empty());
  // Said before a single pass is made, by every solver that could go on for ever.
  for (const std::string solver : {"under_relaxed", "anderson", "newton"})
    BOOST_CHECK_EXCEPTION(
        solve(at_pressure(1e5), 0.0, {.solver = solver}), volume::divergence, [](const volume::divergence& e) {
          return e.iteration() == 0 && std::string(e.what()).find("no state with p > 0 exists") != std::string::npos;
        });
}

// p = p^ = 0 everywhere solves the equations too, and from strong disorder Newton's long steps end there: no solver may
// hand it out. The relaxed passes keep Y > 0 and show that a solution with p > 0 exists.
BOOST_AUTO_TEST_CASE(vacuum_is_no_solution) {
  const auto newton = solve(at_pressure(0.01 * K_T), 0.3, {.solver = "newton", .max_iterations = 10000});
  BOOST_TEST(*std::min_element(newton.p.begin(), newton.p.end()) > 1e8);
  BOOST_TEST(largest_difference(newton.p_eos, newton.p) < 1e-11);
  // Both to 1e-12, with the operator's factor κ = 100 at most between residual and error.
  const auto relaxed = solve(at_pressure(0.01 * K_T), 0.3, {.solver = "under_relaxed", .max_iterations = 10000});
  BOOST_TEST(largest_difference(newton.Y, relaxed.Y) < 1e-10);
  // Where the way there is longer than allowed, that is said.
  BOOST_CHECK_THROW(solve(at_pressure(0.001 * K_T), 0.1, {.solver = "newton", .max_iterations = 100}),
                    volume::divergence);
}

// ω = p/K_T = 1e-3: the tolerance on a pass's change is some ε, below the rounding of ln Y = 20.
BOOST_AUTO_TEST_CASE(anderson_reaches_its_tolerance_at_low_pressure) {
  const auto r = solve(at_pressure(0.001 * K_T), 0.1, {.solver = "anderson", .max_iterations = 10000});
  // 8 ε K_T/p = 1.8e-12 is what can be asked for.
  BOOST_TEST(largest_difference(r.p_eos, r.p) < 2e-12);
}

BOOST_AUTO_TEST_CASE(too_few_passes_are_told) {
  BOOST_CHECK_EXCEPTION(solve(at_pressure(0.1 * K_T), 0.1, {.solver = "under_relaxed", .max_iterations = 3}),
                        volume::divergence, [](const volume::divergence& e) {
                          return e.iteration() == 3 && e.status() == foundation::exit_status::calculation_failed;
                        });
}

BOOST_AUTO_TEST_CASE(same_bits_on_any_ranks) {
  for (const std::string solver : {"under_relaxed", "anderson", "newton"}) BOOST_TEST_CONTEXT(solver) {
      const volume::hosono_options how{.solver = solver, .tolerance = 1e-10};
      const auto together = solve(at_pressure(0.3 * K_T), 0.1, how),
                 lone = solve(at_pressure(0.3 * K_T), 0.1, how, alone());
      BOOST_TEST(same_bits(together.Y, lone.Y));
      BOOST_TEST(same_bits(together.p, lone.p));
      BOOST_TEST(same_bits(together.residuals, lone.residuals));
    }
}

// Column between corrected walls: the walls' weights are part of the system; all cures find the same state.
BOOST_AUTO_TEST_CASE(solvers_agree_between_corrected_walls) {
  auto o = at_pressure(0.1 * K_T);
  o.domain.periodic[1] = false;
  o.walls.treatment = "virtual_marker";
  o.g = 1e4;
  o.initial.profile = "hydrostatic";
  const double tolerance = 1e-10;
  const auto newton = solve(o, 0.05, {.solver = "newton", .tolerance = tolerance});
  BOOST_TEST(largest_difference(newton.p_eos, newton.p) <= 1.01 * tolerance);
  for (const std::string solver : {"under_relaxed", "anderson"}) {
    const auto other = solve(o, 0.05, {.solver = solver, .tolerance = tolerance, .max_iterations = 20000});
    BOOST_TEST(largest_difference(other.Y, newton.Y) < 100.0 * tolerance);
  }
}
