// Y by its own evolution equation [S2]:
//   DY_i/Dt = -½ (1 - K_T,i/p_i) Σ_j (Y_i²/p_i + Y_j²/p_j) v_ij·∇_i W_ij + α_i K_T,i (Y_i/p_i) DT_i/Dt
// with p_i = Σ_j Y_j W_ij and ρ_i = m_i p_i/Y_i. Half the sum is the power of the pressure
// forces, which the gradient module has at hand (pattern 1 gives the note's form).
//
// Tied (consistency.hpp) ρ is the root of Y = m p^(ρ, T)/ρ, so that
//   DY_i/Dt = ΔV_i [(K_T - p^) D ln ρ/Dt + α K_T DT/Dt]
// with D ln ρ/Dt of continuity, which the tie adds to: nothing is divided by p.
#pragma once

#include <volume/consistency.hpp>

namespace tetsuame::volume {

struct y_evolution {
  static constexpr const char* name = "y_evolution";
  static constexpr carries carried = carries::weight;

  // W: DY_i/Dt from the power of the pressure forces per mass (W/kg) and DT/Dt (K/s).
  static double rate(double p, double K_T, double alpha, double dV, double m, double power, double dT) {
    return -(1.0 - K_T / p) * m * power + alpha * K_T * dV * dT;
  }
  // dlnrho: 1/s, with the tie.
  template <int D>
  static double tied_rate(const particles::particles<D>& s, std::size_t i, double dlnrho, double dT) {
    return s.m[i] / s.rho[i] * ((s.K_T[i] - s.p_eos[i]) * dlnrho + s.alpha[i] * s.K_T[i] * dT);
  }
};

}  // namespace tetsuame::volume
