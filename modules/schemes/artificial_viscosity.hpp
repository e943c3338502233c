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
