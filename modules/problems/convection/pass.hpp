// The pass over the neighbours: G, D and L of the unknowns, the noise Q, how unevenly particles stand, and where the
// viscosity varies its force and how much stiffer that makes the rates.
#pragma once

#include <convection/contrast.hpp>
#include <convection/state.hpp>
#include <convection/terms.hpp>

namespace tetsuame::convection {

template <int D>
graded_viscosity<D> viscous_term(convection_state<D>& state) {
  auto& last = state.last;
  const auto& lagged = state.lagged;
  graded_viscosity<D> term{};
  term.root = state.viscosity_root->data();
  for (std::size_t a = 0; a < D; ++a) {
    term.out[a] = last.viscous[a].data();
    term.slope[a] = last.log_slope[a].data();
    for (std::size_t b = 0; b < D; ++b) term.gradient[a][b] = last.latest.gradient[a][b].data();
  }
  if constexpr (graded_viscosity<D>::isotropic) {
    term.beta = state.at_start.beta * (D + 2.0) / (D + 4.0);
    for (std::size_t a = 0; a < D; ++a) {
      term.force[a] = lagged.force[a].data();
      term.plain[a] = last.plain_viscous[a].data();
    }
    for (std::size_t k = 0; k < angular_terms; ++k) {
      term.angular[k] = lagged.angles[k].data();
      term.next_angular[k] = last.latest.angles[k].data();
    }
  }
  return term;
}

// whole: with what is kept for the step, which the stages after the first do not need. The shift is that of the
// first.
template <int D, int K, bool graded, bool whole>
void sum_over_neighbours(convection_state<D>& state, const pairs::stretch& rows) {
  auto& w = state.world.w;
  auto& last = state.last;
  const auto& lagged = state.lagged;
  const auto& at_start = state.at_start;
  bool singular = false;
  // Laplacians of T, and of the velocity whose viscous force is no sum of its own.
  constexpr unsigned velocity = ((1U << D) - 1U) << (K == unknown<D>::count_with_z ? unknown<D>::z : 0);
  constexpr unsigned wanted = 1U << unknown<D>::T | (graded ? 0U : velocity);
  operators::consistent<D, K, whole, wanted> derivatives{{}, {}, {}, at_start.V, at_start.beta, {}, &singular};
  noise<D, K, graded> smooth{{}, at_start.V, {}};
  const auto f = unknown_arrays(state);
  for (std::size_t k = 0; k < K; ++k) {
    derivatives.f[k] = f[k];
    derivatives.P[k] = lagged.laplacian[k]->data();
    derivatives.out.laplacian[k] = last.laplacian[k].data();
    derivatives.out.plain[k] = last.latest.laplacian[k]->data();
    smooth.out[k] = last.noise[k].data();
    for (std::size_t a = 0; a < D; ++a) {
      derivatives.out.gradient[k][a] = last.latest.gradient[k][a].data();
      smooth.gradients[k * D + a] = lagged.gradient[k][a].data();
    }
  }
  for (std::size_t k = 0; k < operators::symmetric_terms(D); ++k) {
    derivatives.B[k] = lagged.tensor[k].data();
    derivatives.out.next_B[k] = last.latest.tensor[k].data();
  }
  unevenness<D> uneven{at_start.V, at_start.W_self, at_start.per_W_dx, {}, last.W.data()};
  for (std::size_t a = 0; a < D; ++a) uneven.out[a] = last.uneven[a].data();
  if constexpr (graded && whole)
    w.sum(rows, derivatives, smooth, uneven, viscous_term(state),
          contrast{state.viscosity_root->data(), state.own_viscosity->data(), last.viscous_contrast.data(),
                   last.sound_contrast.data()});
  else if constexpr (graded)
    w.sum(rows, derivatives, smooth, viscous_term(state));
  else if constexpr (whole)
    w.sum(rows, derivatives, smooth, uneven);
  else
    w.sum(rows, derivatives, smooth);
  if (singular) w.first_fault.report(0, "particles lie so that a gradient is not determined; the flow has blown up");
}

template <bool whole, int D>
void sum_over_neighbours(convection_state<D>& state, const pairs::stretch& rows) {
  const foundation::stage timed(state.world.w.times, "sums");
  if (state.layer.law.varies)
    sum_over_neighbours<D, unknown<D>::count, true, whole>(state, rows);
  else if (state.layer.relaxed)
    sum_over_neighbours<D, unknown<D>::count_with_z, false, whole>(state, rows);
  else
    sum_over_neighbours<D, unknown<D>::count, false, whole>(state, rows);
}

}  // namespace tetsuame::convection
