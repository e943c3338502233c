// Y by the iteration of Hosono et al. (2013) (programs A, B). x, m, T are held; sought is Y with
//   p_i = Σ_j Y_j W_ij,   ρ_i = m_i p_i/Y_i,   Y_i = m_i p^(ρ_i, T_i)/ρ_i.
// The residual is ln(Y_new/Y) = ln(p^/p), the same for every solver: docs/theory/hosono_iteration.md.
// Every evaluation starts from the density of the last completed step (a declared field, part of a
// checkpoint), so that what an evaluation gives does not depend on those between.
#pragma once

#include <algorithm>
#include <cmath>
#include <foundation/threads.hpp>
#include <integrators/nonlinear.hpp>
#include <kernels/lattice.hpp>
#include <limits>
#include <volume/smoothed.hpp>

namespace tetsuame::volume {

inline constexpr const char* density_guess = "DensityGuess";

// The field from which the iteration starts, with the present density in it.
template <int D>
void add_density_guess(particles::particles<D>& s) {
  particles::declare(s, density_guess, "kg/m^3", particles::role::memory, "start value of the iteration for Y") = s.rho;
}

struct hosono_iteration {
  static constexpr const char* name = "hosono_iteration";
  static constexpr carries carried = carries::nothing;

  hosono_options how;
  std::int64_t evaluations = 0;
  std::int64_t passes = 0;                 // in all evaluations
  std::vector<residual_record> residuals;  // since they were last taken away
  bool counts = true;                      // whether evaluations are added to these three

  // Y, p and what follows, of fluid and ghosts, from the start values ρ, V and Y; Y of the walls on the way.
  // Collective.
  template <int D>
  void determine(pairs::workspace<D>& w, const wall_context<D>& around);
};

namespace detail {

// ln(1 + r), continued by its tangent below -1/2: a pressure that is negative on the way to the
// solution gives a finite step. The same as ln(p^/p) where the solution is near.
inline double bounded_log(double r) {
  constexpr double edge = -0.5;
  return r > edge ? std::log1p(r) : std::log1p(edge) + (r - edge) / (1.0 + edge);
}

// What the solvers share: one pass, and the account of how it went.
template <int D>
struct pass {
  pairs::workspace<D>& w;
  const wall_context<D>& around;
  hosono_iteration& self;
  std::int64_t iteration = 0;

  // p, ρ and p^ of the owned fluid from Y.
  void evaluate() {
    auto& s = w.s;
    w.exchange_fluid({s.Y.data()});
    around.weights(w);
    smooth_by_lattice(w, around.smoothing.normalise, w.fluid());
    foundation::for_all(s.fluid, [&](std::size_t i) { s.rho[i] = s.m[i] * s.p[i] / s.Y[i]; });
    equation_of_state(w, 0, s.fluid, around.rule);
  }
  // max |ln(p^/p)| over all particles; infinite where p^ or p is not positive.
  double residual() const {
    const auto& s = w.s;
    return w.d.ranks.maximum(foundation::largest_of(s.fluid, 0.0, [&](std::size_t i) {
      const double r = std::abs(std::log(s.p_eos[i] / s.p[i]));
      return s.p_eos[i] > 0.0 && s.p[i] > 0.0 && std::isfinite(r) ? r : std::numeric_limits<double>::infinity();
    }));
  }
  void record(double residual) {
    ++iteration;
    if (!self.counts) return;
    ++self.passes;
    self.residuals.push_back({self.evaluations, iteration, residual});
  }
};

// The material's stiffness over the particles: κ = K_T/p at its largest.
template <int D>
double largest_kappa(const pairs::workspace<D>& w) {
  const auto& s = w.s;
  return w.d.ranks.maximum(foundation::largest_of(
      s.fluid, 0.0, [&](std::size_t i) { return s.p_eos[i] > 0.0 ? s.K_T[i] / s.p_eos[i] : 0.0; }));
}

// p^(ρ) has the relative rounding error κ ε: no residual below a few of these can be asked for.
inline double reachable(double tolerance, double kappa) {
  return std::max(tolerance, 8.0 * std::numeric_limits<double>::epsilon() * kappa);
}

// Local index and value of the largest |ln(p^/p)|, agreed on by all ranks as a sentence.
template <int D>
std::string worst_particle(const pairs::workspace<D>& w) {
  const auto& s = w.s;
  double largest = -1.0;
  std::size_t worst = 0;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    double r = std::abs(std::log(s.p_eos[i] / s.p[i]));
    if (!std::isfinite(r)) r = std::numeric_limits<double>::max();
    if (r > largest) largest = r, worst = i;
  }
  const double all = w.d.ranks.maximum(largest);
  constexpr auto nobody = std::numeric_limits<std::int64_t>::max();
  std::int64_t id = largest == all && s.fluid > 0 ? s.id[worst] : nobody;
  MPI_Allreduce(MPI_IN_PLACE, &id, 1, MPI_INT64_T, MPI_MIN, w.d.ranks.comm);
  int teller = s.fluid > 0 && s.id[worst] == id && largest == all ? w.d.ranks.rank : w.d.ranks.size;
  MPI_Allreduce(MPI_IN_PLACE, &teller, 1, MPI_INT, MPI_MIN, w.d.ranks.comm);
  std::string text;
  if (w.d.ranks.rank == teller)
    text = fmt::format("{} (p = {:.6g} Pa, p^ = {:.6g} Pa, rho = {:.6g} kg/m3)", pairs::describe_position(s, worst),
                       s.p[worst], s.p_eos[worst], s.rho[worst]);
  auto length = static_cast<std::int64_t>(text.size());
  MPI_Bcast(&length, 1, MPI_INT64_T, teller, w.d.ranks.comm);
  text.resize(static_cast<std::size_t>(length));
  MPI_Bcast(text.data(), static_cast<int>(length), MPI_CHAR, teller, w.d.ranks.comm);
  return text;
}

// Proof that no state with p > 0 exists (docs/theory/lattice_sum.md), as a sentence; empty if a state may exist.
template <int D>
std::string no_state_exists(pairs::workspace<D>& w, const wall_context<D>& around) {
  if (around.rule) return "";  // the bound is that of the equation of state
  auto& s = w.s;
  particles::array dV(s.total() + 1);
  const double scale = around.smoothing.normalise ? w.lattice_sum : 1.0;
  volumes_by_number(w, w.fluid(), scale, dV.data());
  double densest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < s.fluid; ++i) densest = std::min(densest, dV[i]);
  densest = w.d.ranks.minimum(densest);
  const auto& guess = particles::extra(s, density_guess);
  double p_most = -std::numeric_limits<double>::infinity(), p_start = p_most, K_T = 0.0, fullest = 0.0;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    std::visit(
        [&](const auto& material) {
          p_most = std::max(p_most, material.evaluate(s.m[i] / densest, s.T[i]).p);
          const auto start = material.evaluate(guess[i], s.T[i]);
          p_start = std::max(p_start, start.p);
          K_T = std::max(K_T, start.K_T);
          fullest = std::max(fullest, s.m[i] / (densest * guess[i]));  // kernel sum, of the best placed particle
        },
        w.materials[static_cast<std::size_t>(s.material[i])]);
  }
  p_most = w.d.ranks.maximum(p_most);
  if (p_most > 0.0) return "";
  p_start = w.d.ranks.maximum(p_start);
  K_T = w.d.ranks.maximum(K_T);
  const double deficit = 1.0 - w.d.ranks.maximum(fullest);
  // Of a lattice that is whole it is the lattice's own; without walls, more.
  const bool of_lattice = deficit < 1.5 * (1.0 - w.lattice_sum / scale);
  return fmt::format(
             "no state with p > 0 exists: the kernel's sum over a particle and its neighbours is 1 - {0:.6g} at most, "
             "which lowers the density by that factor and the pressure by {0:.6g} K_T = {1:.6g} Pa, more than p = "
             "{2:.6g} Pa (K_T/p = {3:.6g})",
             deficit, deficit * K_T, p_start, K_T / p_start) +
         (of_lattice ? ". Divide the smoothing by the kernel sum (&smoothing normalise = .true.), or use program C, D, "
                       "E or F"
                     : "");
}

// Why there is no end: κ, the growth factor of theory and of the last passes, where it began.
template <int D>
std::string account(const pass<D>& one, const std::string& outcome, double kappa, double measured,
                    const std::string& began) {
  auto& w = one.w;
  const std::string& solver = one.self.how.solver;
  const double S_min = kernels::transfer_minimum<D>(w.kernel, w.dx).value;
  const double G = (kappa - 1.0) * (1.0 - S_min);
  std::string text = fmt::format(
      "Hosono's iteration ({}) {} at iteration {}: K_T/p = {:.6g}, predicted growth factor of a pass |G| = (K_T/p - "
      "1)(1 "
      "- S_min) = {:.6g}",
      solver, outcome, one.iteration, kappa, G);
  if (std::isfinite(measured) && measured > 0.0) text += ", last measured " + number(measured);
  text += ". It began at " + began;
  const std::string proof = no_state_exists(w, one.around);
  if (!proof.empty()) return text + "; " + proof;
  return solver == "plain" ? text + ". &hosono solver = 'newton' converges where a solution exists" : text;
}

// The solution was found, or is a fixed point that repels? On a perfect lattice a single pass cannot tell.
inline bool settled(double residual, double previous, double tolerance) {
  return residual <= tolerance && residual <= previous;
}

// The exponent that no wave outgrows: ω (1 + (κ - 1)(1 - S)) stays below 2 for every particle if
// ω <= 1/κ at the present pressures, which near an open wall are far below those of the start.
// Not less than a twentieth of the start's, lest a pressure near zero on the way hold all up.
template <int D>
double stable_exponent(const pass<D>& one, double start) {
  if (one.self.how.relaxation > 0.0) return start;
  const auto& s = one.w.s;
  const double kappa = foundation::largest_of(s.fluid, 1.0 / start,
                                              [&](std::size_t i) { return s.p[i] > 0.0 ? s.K_T[i] / s.p[i] : 0.0; });
  return std::max(1.0 / one.w.d.ranks.maximum(kappa), start / 20.0);
}

// 1 and a digit in the last place, up or down by the particle's ID. On a perfect lattice the sums of all particles have
// the same bits; then nothing would disturb the plain iteration, and one that repels would stay where it is.
inline double last_place(std::int64_t id) {
  const bool up = (static_cast<std::uint64_t>(id) * 0x9e3779b97f4a7c15U >> 63) != 0;
  return up ? 1.0 + std::numeric_limits<double>::epsilon() : 1.0 - std::numeric_limits<double>::epsilon();
}

// plain and under_relaxed: Y ← Y (Y_new/Y)^ω, ω = 1 for plain. Ends when settled, or when the
// residual is below `enough`; throws when it diverged or took too many passes.
template <int D>
void relax(pass<D>& one, double omega, double tolerance, double enough, double kappa) {
  auto& [w, around, self, iteration] = one;
  auto& s = w.s;
  const bool plain = self.how.solver == "plain";
  double least = std::numeric_limits<double>::infinity(), previous = -1.0;
  std::string began;  // where the residual was when it stopped falling
  while (true) {
    one.evaluate();
    const double residual = one.residual();
    one.record(residual);
    if (settled(residual, previous, tolerance) || residual <= enough) return;
    if (residual < least)
      least = residual;
    else if (began.empty())
      began = worst_particle(w);
    const bool dead = plain && !std::isfinite(residual);
    if (dead || iteration >= self.how.max_iterations) {
      if (began.empty()) began = worst_particle(w);
      throw divergence(iteration,
                       account(one, dead ? "diverged" : "did not converge", kappa, residual / previous, began));
    }
    previous = residual;
    const double exponent = plain ? 1.0 : stable_exponent(one, omega);
    foundation::for_all(s.fluid, [&](std::size_t i) {
      s.Y[i] = plain ? s.m[i] * s.p_eos[i] / s.rho[i] * last_place(s.id[i])
                     : s.Y[i] * std::exp(exponent * bounded_log(s.p_eos[i] / s.p[i] - 1.0));
    });
  }
}

template <int D>
void fail_unconverged(const pass<D>& one, const std::string& reason, double kappa) {
  throw divergence(
      one.iteration,
      fmt::format("Hosono's iteration ({}) did not converge after {} passes: {}. K_T/p = {:.6g}; worst at {}",
                  one.self.how.solver, one.iteration, reason, kappa, worst_particle(one.w)));
}

template <int D>
int passes_left(const pass<D>& one) {
  return static_cast<int>(std::max<std::int64_t>(one.self.how.max_iterations - one.iteration, 1));
}

// x = ln(Y/Y_0), g(x) = x + ω ln(p^/p). Relative to the start, so that x and its rounding are small: the tolerance is
// ω times that of the residual, less than the rounding of ln Y itself where K_T/p is large.
template <int D>
void accelerate(pass<D>& one, double omega, double tolerance, double kappa) {
  // Far from the solution extrapolation misleads: relaxed passes first.
  constexpr double near = 0.3;
  relax(one, omega, tolerance, near, kappa);
  omega = stable_exponent(one, omega);
  auto& w = one.w;
  auto& s = w.s;
  std::vector<double> x(s.fluid, 0.0);
  const particles::array start(s.Y.begin(), s.Y.begin() + static_cast<std::ptrdiff_t>(s.fluid));
  const auto g = [&](std::span<const double> at, std::span<double> to) {
    foundation::for_all(s.fluid, [&](std::size_t i) { s.Y[i] = start[i] * std::exp(at[i]); });
    one.evaluate();
    one.record(one.residual());
    foundation::for_all(s.fluid,
                        [&](std::size_t i) { to[i] = at[i] + omega * bounded_log(s.p_eos[i] / s.p[i] - 1.0); });
    return 0;
  };
  const auto result = integrators::anderson(w.d.ranks.comm, x, g,
                                            {.tolerance = omega * tolerance,
                                             .max_iterations = passes_left(one),
                                             .depth = static_cast<int>(one.self.how.anderson_depth)});
  if (!result.converged) fail_unconverged(one, result.reason, kappa);
}

// Unknowns ln ρ; equations (p^_i - p_i)/(scale of p_i), the scale being p^ of the first guess.
template <int D>
integrators::nonlinear_result newton_from_here(pass<D>& one, double tolerance, double kappa) {
  auto& w = one.w;
  const auto& around = one.around;
  auto& s = w.s;
  std::vector<double> x(s.fluid), scale(s.fluid);
  foundation::for_all(s.fluid, [&](std::size_t i) {
    x[i] = std::log(s.rho[i]);
    scale[i] = s.p_eos[i];
  });
  const auto residual = [&](std::span<const double> at, std::span<double> f) {
    // Where no state exists, line searches go on and on: ten passes a step. All ranks count alike.
    if (one.iteration >= one.self.how.max_iterations)
      fail_unconverged(one, "&expert max_iterations allows no more", kappa);
    foundation::for_all(s.fluid, [&](std::size_t i) { s.rho[i] = std::exp(at[i]); });
    weights_by_density(w, around.V, 0, s.fluid, around.rule);
    w.exchange_fluid({s.Y.data()});
    around.weights(w);
    smooth_by_lattice(w, around.smoothing.normalise, w.fluid());
    std::atomic<bool> finite{true};
    foundation::for_all(s.fluid, [&](std::size_t i) {
      f[i] = (s.p_eos[i] - s.p[i]) / scale[i];
      if (!std::isfinite(f[i])) finite = false;
    });
    one.record(one.residual());
    return finite ? 0 : 1;
  };
  // δ(p^_i - p_i) = K_i δx_i - Σ_j ΔV_j (K_j - p^_j) δx_j W_ij; the walls' weights are linear in the fluid's.
  const auto product = [&](std::span<const double>, std::span<const double> v, std::span<double> jv) {
    foundation::for_all(s.fluid, [&](std::size_t i) { s.Y[i] = around.V[i] * (s.K_T[i] - s.p_eos[i]) * v[i]; });
    w.exchange_fluid({s.Y.data()});
    linear_weights(w, around);
    smooth_by_lattice(w, around.smoothing.normalise, w.fluid());
    foundation::for_all(s.fluid, [&](std::size_t i) { jv[i] = (s.K_T[i] * v[i] - s.p[i]) / scale[i]; });
    return 0;
  };
  const double self = self_value(w) / (around.smoothing.normalise ? w.lattice_sum : 1.0);
  const auto diagonal = [&](std::span<const double>, std::span<double> d) {
    foundation::for_all(
        s.fluid, [&](std::size_t i) { d[i] = (s.K_T[i] - around.V[i] * (s.K_T[i] - s.p_eos[i]) * self) / scale[i]; });
    return 0;
  };
  return integrators::newton_krylov(w.d.ranks.comm, x, residual, product, diagonal,
                                    {.tolerance = tolerance, .max_iterations = passes_left(one)});
}

// The equations have a second root, p = p^ = 0 everywhere, which a long step from strong disorder can reach; and a
// pressure far below its start's is not held to the tolerance by the start's scale. So a result counts only by
// |ln(p^/p)|, at the scale of its own pressure: once more from there if it is near, and from relaxed passes if not.
template <int D>
void newton(pass<D>& one, double omega, double tolerance, double kappa) {
  constexpr double near = 0.3;  // of |ln(p^/p)|
  constexpr int rounds = 5;
  auto& s = one.w.s;
  const particles::array start(s.Y.begin(), s.Y.begin() + static_cast<std::ptrdiff_t>(s.fluid));
  bool relaxed = false;
  std::string reason;
  for (int round = 0; round < rounds; ++round) {
    const auto result =
        newton_from_here(one, 0.9 * tolerance, kappa);  // the next round must not find the residual just met
    const double residual = one.residual();
    if (result.converged && residual <= tolerance) return;
    reason = result.converged ? "p is not positive, or far from p^" : result.reason;
    if (result.converged && residual <= near) {
      tolerance = std::max(tolerance, reachable(0.0, largest_kappa(one.w)));
      continue;
    }
    if (relaxed) break;
    relaxed = true;
    std::copy(start.begin(), start.end(), s.Y.begin());
    relax(one, omega, tolerance, near, kappa);
  }
  fail_unconverged(one, reason, kappa);
}

}  // namespace detail

template <int D>
void hosono_iteration::determine(pairs::workspace<D>& w, const wall_context<D>& around) {
  auto& s = w.s;
  if (counts) ++evaluations;
  const double kappa = detail::largest_kappa(w);
  const double tolerance = detail::reachable(how.tolerance, kappa);
  const double omega = how.relaxation > 0.0 ? how.relaxation : std::min(1.0, 1.0 / kappa);
  if (how.solver != "plain") {
    const std::string proof = detail::no_state_exists(w, around);
    if (!proof.empty()) throw divergence(0, "Hosono's iteration (" + how.solver + "): " + proof);
  }
  detail::pass<D> one{w, around, *this};
  try {
    if (how.solver == "anderson")
      detail::accelerate(one, omega, tolerance, kappa);
    else if (how.solver == "newton")
      detail::newton(one, omega, tolerance, kappa);
    else
      detail::relax(one, omega, tolerance, 0.0, kappa);
  } catch (const divergence&) {
    // What passes that diverge leave may be no numbers. The fault is the iteration's, not that of a field: the density
    // is again that of the last completed step.
    const auto& guess = particles::extra(s, density_guess);
    std::copy_n(guess.begin(), s.fluid, s.rho.begin());
    equation_of_state(w, 0, s.fluid, around.rule);
    foundation::for_all(s.fluid, [&](std::size_t i) {
      s.p[i] = s.p_eos[i];
      s.Y[i] = s.m[i] * s.p[i] / s.rho[i];
    });
    throw;
  }
  // Y, p and ρ of the last pass are consistent: bring them to the ghosts. For newton ρ is the unknown itself, and
  // m p/Y in its place would enlarge the residual by the factor κ - 1.
  w.exchange_fluid({s.p.data(), s.rho.data(), s.Y.data()});
  equation_of_state(w, 0, s.first_wall(), around.rule);
  foundation::for_all(s.first_wall(), [&](std::size_t i) { s.dV[i] = s.Y[i] / s.p[i]; });
}

}  // namespace tetsuame::volume
