// The pass over the neighbours: G, D and L of the unknowns, the noise Q, how unevenly particles stand, and where the
// viscosity varies its force and how much stiffer that makes the rates.
#pragma once

#include <convection/state.hpp>

namespace tetsuame::convection {

struct slopes_tag {};
inline constexpr slopes_tag of_slopes;

// Q(f) = Σ V F [2 (f_i - f_j) - (G_i + G_j)·r] [after Antuono et al., Comput. Phys. Commun. 181, 532 (2010)] of the K
// fields of operators::consistent; what G_i takes is G_i·Σ V F r. Graded: Q(p) takes the part min(1, ν_i/ν_j) of a
// pair. Where ξ² goes with ν, energy is p²/ξ²: so it falls, whatever the contrast.
template <int D, int fields, bool graded>
struct hyperdiffusion {
  static constexpr std::size_t K = fields;
  std::array<const double*, K * D> gradients;  // of each field
  double V;                                    // m^D
  std::array<double*, K> out;                  // of each field, over m^2

  template <class R>
  struct me {
    std::array<R, K> sum;                             // of 2 (f_i - f_j) - G_j·r
    pairs::vec<R, D> first;                           // Σ F r
    std::array<pairs::vec<R, D>, graded> first_of_p;  // with the part of a pair
  };
  auto reads() const { return std::tuple{pairs::read(of_slopes, gradients, -1)}; }
  template <class R>
  me<R> begin(const pairs::cluster<R>&) const {
    me<R> a;
    a.sum.fill(R(0.0));
    a.first = foundation::zero<R, D>();
    a.first_of_p.fill(foundation::zero<R, D>());
    return a;
  }
  void add(auto& a, const auto& ij) const {
    const auto G = ij(of_slopes);
    const auto f_ij = ij.difference(operators::of_fields);
    const auto Fr = ij.F * ij.x_ij;
    const auto twice_F = ij.F + ij.F;
    a.first += Fr;
    for (std::size_t k = 0; k < K; ++k) {
      if (graded && k == D + 1) continue;
      a.sum[k] += twice_F * f_ij[k];
      for (std::size_t b = 0; b < D; ++b) a.sum[k] -= G[k * D + b] * Fr[b];
    }
    if constexpr (graded) {
      constexpr std::size_t p = D + 1;
      const auto mine = ij.own(of_viscosity_root) * ij.own(of_viscosity_root);
      const auto part = mine / foundation::greater(mine, ij(of_viscosity_root) * ij(of_viscosity_root));
      const auto part_of_Fr = part * Fr;
      a.first_of_p[0] += part_of_Fr;
      a.sum[p] += part * twice_F * f_ij[p];
      for (std::size_t b = 0; b < D; ++b) a.sum[p] -= G[p * D + b] * part_of_Fr[b];
    }
  }
  void end(const auto& i, const auto& a) const {
    for (std::size_t k = 0; k < K; ++k) {
      const auto& first = graded && k == D + 1 ? a.first_of_p[0] : a.first;
      auto sum = a.sum[k];
      for (std::size_t b = 0; b < D; ++b) sum -= i(gradients[k * D + b], -1) * first[b];
      i.set(out[k], V * sum, -D - 2);
    }
  }
};

// Σ_j V F r [1 + 0.2 (W/W(Δx))⁴] (1/m), and Σ_j W with the particle itself (1/m^D).
template <int D>
struct shifting_sum {
  double V, W_self, per_W_dx;
  std::array<double*, D> out;
  double* W_sum;

  template <class R>
  struct me {
    pairs::vec<R, D> sum;
    R W, per_W_dx;
  };
  template <class R>
  me<R> begin(const pairs::cluster<R>& i) const {
    return {foundation::zero<R, D>(), R(0.0), R(per_W_dx * i.lengths.to(-D))};
  }
  void add(auto& a, const auto& ij) const {
    const auto q = ij.W * a.per_W_dx, q2 = q * q;
    a.sum += (ij.F * (1.0 + 0.2 * q2 * q2)) * ij.x_ij;
    a.W += ij.W;
  }
  void end(const auto& i, const auto& a) const {
    for (std::size_t k = 0; k < D; ++k) i.set(out[k], V * a.sum[k], -D - 1);
    i.set(W_sum, W_self * i.lengths.to(D) + a.W, -D);
  }
};

struct own_viscosity_tag {};
inline constexpr own_viscosity_tag of_own_viscosity;

// How much stiffer the viscosity's contrast makes the rates than one viscosity would, where inertia goes with ν (ξ² =
// ν/ν_eff): bounds by a row sum and by Schur's test (docs/theory/convection_viscosity.md),
//   viscous_i = Σ F ν_ij/ν_i / Σ F      coupled_i = Σ F r ν_j/ν_i / Σ F r
// the largest viscous_i and the square root of the largest coupled_i. Of the images' viscosity only lines know.
struct contrast {
  const double* root;  // ν^½, as that of graded_viscosity
  const double* own;   // ν; an image has that of its particle
  double* viscous;
  double* coupled;  // of one viscosity: both 1

  template <class R>
  struct me {
    R F, F_nu, F_r, F_r_nu;
  };
  auto reads() const { return std::tuple{pairs::read(of_viscosity_root, root), pairs::read(of_own_viscosity, own)}; }
  template <class R>
  me<R> begin(const pairs::cluster<R>&) const {
    return {R(0.0), R(0.0), R(0.0), R(0.0)};
  }
  void add(auto& a, const auto& ij) const {
    const auto F_r = ij.F * ij.r;
    a.F += ij.F;
    a.F_nu += ij.F * line_viscosity(ij.own(of_viscosity_root), ij(of_viscosity_root));
    a.F_r += F_r;
    a.F_r_nu += F_r * ij(of_own_viscosity);
  }
  void end(const auto& i, const auto& a) const {
    i.set(viscous, a.F_nu / a.F);
    i.set(coupled, a.F_r_nu / (a.F_r * i(own)));
  }
};

template <int D>
graded_viscosity<D> viscous_term(convection_state<D>& state) {
  auto& last = state.last;
  const auto& lagged = state.lagged;
  graded_viscosity<D> term{};
  term.root = state.viscosity_root->data();
  term.out = last.viscous.data();
  term.slope = last.log_slope.data();
  for (std::size_t a = 0; a < D; ++a) term.gradient[a] = last.latest.gradient[a].data();
  if constexpr (graded_viscosity<D>::isotropic) {
    term.beta = state.at_start.beta * (D + 2.0) / (D + 4.0);
    std::ranges::copy(lagged.force.data(), term.force.begin());
    term.plain = last.plain_viscous.data();
    std::ranges::copy(lagged.angles.data(), term.angular.begin());
    term.next_angular = last.latest.angles.data();
  }
  return term;
}

// whole: with what is kept for the step, which the stages after the first do not need. The shift is that of the
// first.
template <int D, int K, bool graded, bool whole>
void sum_over_neighbours(convection_state<D>& state, const pairs::row_range& rows) {
  auto& w = state.world.w;
  auto& last = state.last;
  const auto& lagged = state.lagged;
  const auto& at_start = state.at_start;
  bool singular = false;
  // Laplacians of T, and of the velocity whose viscous force is no sum of its own.
  constexpr unsigned velocity = ((1U << D) - 1U) << (K == unknown<D>::count_with_z ? unknown<D>::z : 0);
  constexpr unsigned wanted = 1U << unknown<D>::T | (graded ? 0U : velocity);
  operators::consistent<D, K, whole, wanted> derivatives{{}, {}, {}, at_start.V, at_start.beta, {}, &singular};
  hyperdiffusion<D, K, graded> smooth{{}, at_start.V, {}};
  const auto f = unknown_arrays(state);
  for (std::size_t k = 0; k < K; ++k) {
    derivatives.f[k] = f[k];
    derivatives.P[k] = lagged.laplacian[k]->data();
    derivatives.out.laplacian[k] = last.laplacian[k].data();
    derivatives.out.plain[k] = last.latest.laplacian[k]->data();
    smooth.out[k] = last.hyperdiffusion[k].data();
    for (std::size_t a = 0; a < D; ++a) {
      derivatives.out.gradient[k][a] = last.latest.gradient[k][a].data();
      smooth.gradients[k * D + a] = lagged.gradient[k][a].data();
    }
  }
  for (std::size_t k = 0; k < operators::symmetric_terms(D); ++k) derivatives.B[k] = lagged.tensor[k].data();
  derivatives.out.next_B = last.latest.tensor.data();
  const shifting_sum<D> uneven{at_start.V, at_start.W_self, at_start.per_W_dx, last.uneven.data(), last.W.data()};
  if constexpr (graded && whole)
    w.sum(rows, derivatives, smooth, uneven, viscous_term(state),
          contrast{state.viscosity_root->data(), state.own_viscosity->data(), last.contrast[0].data(),
                   last.contrast[1].data()});
  else if constexpr (graded)
    w.sum(rows, derivatives, smooth, viscous_term(state));
  else if constexpr (whole)
    w.sum(rows, derivatives, smooth, uneven);
  else
    w.sum(rows, derivatives, smooth);
  if (singular) w.first_fault.report(0, "particles lie so that a gradient is not determined; the flow has blown up");
}

template <int D, int K, bool graded>
void sum_over_neighbours(convection_state<D>& state, const pairs::row_range& rows, bool whole) {
  const foundation::stage timed(state.world.w.times, "sums");
  whole ? sum_over_neighbours<D, K, graded, true>(state, rows) : sum_over_neighbours<D, K, graded, false>(state, rows);
}

}  // namespace tetsuame::convection
