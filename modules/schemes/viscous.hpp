// The schemes with artificial viscosity.
//
// Standard SPH with the terms of varying h [V. Springel, L. Hernquist, MNRAS 333, 649 (2002)]:
//   m_i dv_i/dt = -Σ_j m_i m_j [f_i P_i/ρ_i² ∇W_ij(h_i) + f_j P_j/ρ_j² ∇W_ij(h_j)] + viscosity
//   dU_i/dt     =  Σ_j m_i m_j  f_i P_i/ρ_i² v_ij·∇W_ij(h_i)                       + viscosity
//
// Density-independent SPH [T. R. Saitoh, J. Makino, Astrophys. J. 768, 44 (2013)] with the terms of varying h of [S4]:
//   m_i dv_i/dt = -Σ_j U_i U_j [f_i P_i/q_i² ∇W_ij(h_i) + f_j P_j/q_j² ∇W_ij(h_j)] + viscosity
//   dU_i/dt     =  Σ_j U_i U_j  f_i P_i/q_i² v_ij·∇W_ij(h_i)                       + viscosity
// P = (γ - 1) q; ρ = m q/U in the viscosity. With z for f: schemes/common.hpp. The weight may be another than U [Saitoh
// and Makino, section 5]: then P is of ρ = m y/w and u by the equation of state.
//
// The viscosity has the signal velocity of J. J. Monaghan (J. Comput. Phys. 136, 298 (1997)):
//   Π_ij = -½ α_ij v_sig w_ij/ρ̄_ij for w_ij < 0, else 0;   v_sig = c_i + c_j - 3 w_ij,   w_ij = v_ij·x_ij/r
// with the mean of both ends' α_i B_i for α_ij, B Balsara's (1995) switch |∇·v|/(|∇·v| + |∇×v| + 1e-4 c/h), and the
// mean of the two kernels' gradients. α may follow J. P. Morris & J. J. Monaghan (J. Comput. Phys. 136, 41 (1997)) with
// the source of S. Rosswog et al. (Astron. Astrophys. 360, 171 (2000)):
//   dα/dt = (α_min - α) l c/h + max(-∇·v, 0) (α_max - α),   l = 0.2
#pragma once

#include <schemes/common.hpp>

namespace tetsuame::schemes {

// m_i m_j Π_ij times the mean of the gradients' W'/r: the force on i is -it x_ij (N/m).
template <class R>
R viscous(const auto& ij, const two_slopes<R>& F, const R& closing, const R& signal) {
  const R density = ij.own(of_density) + ij(of_density);
  const R alpha = ij.own(of_dissipation) + ij(of_dissipation);
  return -0.25 * ij.own(of_mass) * ij(of_mass) * alpha * signal * closing / density * (F.i + F.j);
}

// The pair's share; from_i and from_j: of the pressures, N/m, the work of the first done on i.
template <class R>
void add_with_viscosity(auto& sum, const auto& ij, const two_slopes<R>& F, const R& from_i, const R& from_j) {
  const R v_x = ij.along(of_velocity), closing = lesser(R(v_x * ij.per_r), R(0.0));
  const R signal = ij.own(of_sound) + ij(of_sound) - 3.0 * closing;
  const R viscosity = viscous(ij, F, closing, signal);
  sum.force -= (rounded(from_i) + rounded(from_j) + viscosity) * ij.x_ij;
  sum.power += (from_i + 0.5 * viscosity) * v_x;
  keep_signal(sum, F, signal);
}

// weight = m; slope = f P/ρ²
template <int D, class Kernel>
struct ssph : forces<D, Kernel> {
  auto reads() const {
    return this->g.read(of_velocity, of_mass, of_density, of_sound, of_slope, of_per_support, of_dissipation);
  }
  void add(auto& sum, const auto& ij) const {
    const auto F = slopes_of<D>(this->unit, ij);
    const auto mm = ij.own(of_mass) * ij(of_mass);
    const auto from_i = mm * ij.own(of_slope) * F.i, from_j = mm * ij(of_slope) * F.j;
    add_with_viscosity(sum, ij, F, from_i, from_j);
  }
};

// weight = U; slope = f P/q², or P/q² with z
template <int D, class Kernel>
struct disph : forces<D, Kernel> {
  auto reads() const {
    return this->g.read(of_velocity, of_mass, of_density, of_sound, of_slope, of_per_support, of_dissipation, of_weight,
                        of_correction);
  }
  void add(auto& sum, const auto& ij) const {
    const auto F = slopes_of<D>(this->unit, ij);
    const auto U_i = ij.own(of_weight), U_j = ij(of_weight);
    const auto from_i = U_i * ij.own(of_slope) * (U_j + ij.own(of_correction)) * F.i;
    const auto from_j = U_j * ij(of_slope) * (U_i + ij(of_correction)) * F.j;
    add_with_viscosity(sum, ij, F, from_i, from_j);
  }
};

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
