// Y by the iteration of Hosono et al. (2013) (programs A, B). x, m, T are held; sought is Y with
//   p_i = Σ_j Y_j W_ij,   ρ_i = m_i p_i/Y_i,   Y_i = m_i p^(ρ_i, T_i)/ρ_i.
// The residual is ln(Y_new/Y) = ln(p^/p), the same for every solver: docs/theory/hosono_iteration.md.
// Every evaluation starts from the density of the last completed step (an extra field, part of a
// checkpoint), so that what an evaluation gives does not depend on those between.
#pragma once

#include <algorithm>
#include <cmath>
#include <integrators/nonlinear.hpp>
#include <kernels/lattice.hpp>
#include <limits>
#include <volume/hosono_options.hpp>
#include <volume/smoothed.hpp>

namespace tetsuame::volume {

inline constexpr const char* density_guess = "DensityGuess";

// The field from which the iteration starts, with the present density in it: to be added once the particles are there.
template <int D>
void add_density_guess(particles::particles<D>& s) {
  s.extras.push_back({density_guess, "kg/m^3", "start value of the iteration for Y", particles::role::memory,
                      particles::array(s.rho)});
}

struct hosono_iteration {
  static constexpr const char* name = "hosono_iteration";
  static constexpr carries carried = carries::nothing;

  hosono_options how;
  std::int64_t evaluations = 0;
  std::int64_t passes = 0;                 // in all evaluations
  std::vector<residual_record> residuals;  // since they were last taken away

  template <int D>
  void before_walls(pairs::workspace<D>& w, const surroundings<D>&) const {
    auto& s = w.s;
    std::copy_n(particles::extra(s, density_guess).begin(), s.fluid, s.rho.begin());
    w.exchange_fluid({s.rho.data()});
    weights_by_density(w, 0, s.first_wall());
    require_positive(w, s.p_eos, "the start value's pressure p");
  }

  template <class Pressure, int D>
  void determine(pairs::workspace<D>& w, const surroundings<D>& around);
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
  const surroundings<D>& around;
  hosono_iteration& self;
  std::int64_t iteration = 0;

  // p, ρ and p^ of the owned fluid from Y.
  void evaluate() {
    auto& s = w.s;
    w.exchange_fluid({s.Y.data()});
    around.weights(w);
    smooth_by_lattice(w, around.smoothing.normalise);
    for (std::size_t i = 0; i < s.fluid; ++i) s.rho[i] = s.m[i] * s.p[i] / s.Y[i];
    equation_of_state(w, s.fluid);
  }
  // max |ln(p^/p)| over all particles; infinite where p^ or p is not positive.
  double residual() const {
    const auto& s = w.s;
    double largest = 0.0;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      const double r = std::abs(std::log(s.p_eos[i] / s.p[i]));
      largest = std::max(
          largest, s.p_eos[i] > 0.0 && s.p[i] > 0.0 && std::isfinite(r) ? r : std::numeric_limits<double>::infinity());
    }
    return w.d.ranks.maximum(largest);
  }
  void record(double residual) {
    ++iteration;
    ++self.passes;
    self.residuals.push_back({self.evaluations, iteration, residual});
  }
};

// The material's stiffness over the particles: κ = K_T/p at its largest.
template <int D>
double largest_kappa(const pairs::workspace<D>& w) {
  double kappa = 0.0;
  for (std::size_t i = 0; i < w.s.fluid; ++i)
    if (w.s.p_eos[i] > 0.0) kappa = std::max(kappa, w.s.K_T[i] / w.s.p_eos[i]);
  return w.d.ranks.maximum(kappa);
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
    text = where_is(s, worst) + " (p = " + number(s.p[worst]) + " Pa, p^ = " + number(s.p_eos[worst]) +
           " Pa, rho = " + number(s.rho[worst]) + " kg/m3)";
  auto length = static_cast<std::int64_t>(text.size());
  MPI_Bcast(&length, 1, MPI_INT64_T, teller, w.d.ranks.comm);
  text.resize(static_cast<std::size_t>(length));
  MPI_Bcast(text.data(), static_cast<int>(length), MPI_CHAR, teller, w.d.ranks.comm);
  return text;
}

// Proof that no state with p > 0 exists (docs/theory/lattice_sum.md), as a sentence; empty if a state may exist.
template <int D>
std::string no_state_exists(pairs::workspace<D>& w, const surroundings<D>& around) {
  auto& s = w.s;
  particles::array dV(s.total() + 1);
  const double scale = around.smoothing.normalise ? w.lattice_sum : 1.0;
  volumes_by_number(w, scale, dV.data());
  double densest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < s.fluid; ++i) densest = std::min(densest, dV[i]);
  densest = w.d.ranks.minimum(densest);
  const auto& guess = particles::extra(s, density_guess);
  double p_most = -std::numeric_limits<double>::infinity(), p_start = p_most, K_T = 0.0;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    std::visit(
        [&](const auto& material) {
          p_most = std::max(p_most, material.evaluate(s.m[i] / densest, s.T[i]).p);
          const auto start = material.evaluate(guess[i], s.T[i]);
          p_start = std::max(p_start, start.p);
          K_T = std::max(K_T, start.K_T);
        },
        w.materials[static_cast<std::size_t>(s.material[i])]);
  }
  p_most = w.d.ranks.maximum(p_most);
  if (p_most > 0.0) return "";
  p_start = w.d.ranks.maximum(p_start);
  K_T = w.d.ranks.maximum(K_T);
  const double deficit = 1.0 - w.lattice_sum / scale;
  return "no state with p > 0 exists: the kernel's sum over the lattice is 1 - " + number(deficit) +
         ", which lowers the density by that factor and the pressure by " + number(deficit) +
         " K_T = " + number(deficit * K_T) + " Pa, more than p = " + number(p_start) +
         " Pa (K_T/p = " + number(K_T / p_start) +
         "). Divide the smoothing by the kernel sum (&smoothing normalise = .true.), or use program C, D, E or F";
}

}  // namespace detail

}  // namespace tetsuame::volume

#include <volume/hosono_solvers.hpp>
