// What the force terms of the four schemes have in common: their input and output, and the signal velocity that
// limits the time step.
#pragma once

#include <schemes/common.hpp>

namespace tetsuame::schemes {

// Arrays of all particles; null: not read by the scheme.
template <int D>
struct gas {
  std::array<const double*, D> v;
  const double *m, *weight, *rho, *p, *c;
  const double *slope, *correction, *per_S;
  const double* dissipation;
  const double *gamma, *stiffness;
  std::array<const double*, D> grad_p, grad_rho;                      // limited in the pair
  std::array<const double*, static_cast<std::size_t>(D) * D> grad_v;  // [D a + b]: ∂v_a/∂x_b
  double theta;                                                       // of the limiter, 1 to 2
  bool exact;
};

// N, W and m/s.
template <int D>
struct rates {
  std::array<double*, D> force;
  double *power, *signal;
};

template <int D>
struct sums {
  vec<real, D> force;
  real power, signal;
};

template <int D>
sums<D> nothing() {
  return {foundation::zero<real, D>(), real(0.0), real(0.0)};
}

// c_i + c_j - 3 min(w_ij, 0), where the neighbour is within the support of either.
template <int D>
void keep_signal(sums<D>& a, const two_slopes& F, const real& signal) {
  real seen = signal;
  where(F.i + F.j == 0.0, seen) = 0.0;
  a.signal = greater(a.signal, seen);
}

template <int D>
void write(const rates<D>& out, std::size_t i, const sums<D>& a) {
  for (std::size_t k = 0; k < D; ++k) out.force[k][i] = pairs::sum(a.force[k]);
  out.power[i] = pairs::sum(a.power);
  std::array<double, pairs::lanes> signals;
  a.signal.copy_to(signals.data(), std::experimental::element_aligned);
  out.signal[i] = *std::max_element(signals.begin(), signals.end());
}

}  // namespace tetsuame::schemes
