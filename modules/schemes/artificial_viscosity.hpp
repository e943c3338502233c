// Artificial viscosity with the signal velocity of J. J. Monaghan (J. Comput. Phys. 136, 298 (1997)):
//   Π_ij = -½ α_ij v_sig w_ij/ρ̄_ij for w_ij < 0, else 0;   v_sig = c_i + c_j - 3 w_ij,   w_ij = v_ij·x_ij/r
// with the mean of both ends' α_i B_i for α_ij, B Balsara's (1995) switch |∇·v|/(|∇·v| + |∇×v| + 1e-4 c/h), and the
// mean of the two kernels' gradients. α may follow J. P. Morris & J. J. Monaghan (J. Comput. Phys. 136, 41 (1997)) with
// the source of S. Rosswog et al. (Astron. Astrophys. 360, 171 (2000)):
//   dα/dt = (α_min - α) l c/h + max(-∇·v, 0) (α_max - α),   l = 0.2
#pragma once

#include <schemes/common.hpp>

namespace tetsuame::schemes {

// m_i m_j Π_ij times the mean of the gradients' W'/r: the force on i is -it x_ij (N/m).
inline real viscous(const auto& ij, const two_slopes& F, const real& closing, const real& signal) {
  const real density = ij.own(of_density) + ij(of_density);
  const real alpha = ij.own(of_dissipation) + ij(of_dissipation);
  return -0.25 * ij.own(of_mass) * ij(of_mass) * alpha * signal * closing / density * (F.i + F.j);
}

// What a term with pressures of the ends' own and viscosity reads, but for the weight.
template <int D>
auto viscous_reads(const gas<D>& s) {
  return std::tuple{pairs::read(pairs::of_velocity, s.v),
                    pairs::read(of_mass, s.m),
                    pairs::read(of_density, s.rho),
                    pairs::read(of_sound, s.c),
                    pairs::read(of_slope, s.slope),
                    pairs::read(of_per_support, s.per_S),
                    pairs::read(of_dissipation, s.dissipation)};
}

// The pair's share; from_i and from_j: of the pressures, N/m, the work of the first done on i.
template <int D>
void add_with_viscosity(sums<D>& a, const auto& ij, const two_slopes& F, const real& from_i, const real& from_j) {
  const real v_x = ij.along(pairs::of_velocity), closing = lesser(real(v_x * ij.per_r), real(0.0));
  const real signal = ij.own(of_sound) + ij(of_sound) - 3.0 * closing;
  const real viscosity = viscous(ij, F, closing, signal);
  a.force -= (from_i + from_j + viscosity) * ij.x_ij;
  a.power += (from_i + 0.5 * viscosity) * v_x;
  keep_signal(a, F, signal);
}

// B of ∇·v and |∇×v| (1/s), c (m/s), h (m): near 1 where gas is compressed, near 0 where it is sheared.
inline double balsara_factor(double divergence, double curl, double c, double h) {
  const double closing = std::abs(divergence);
  return closing / (closing + curl + 1e-4 * c / h);
}

// dα/dt, 1/s.
inline double alpha_rate(double alpha, double least, double most, double divergence, double c, double h) {
  return (least - alpha) * 0.2 * c / h + std::max(-divergence, 0.0) * std::max(most - alpha, 0.0);
}

}  // namespace tetsuame::schemes
