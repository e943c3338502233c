// Y by its own evolution equation [S2]:
//   DY_i/Dt = -½ (1 - K_T,i/p_i) Σ_j (Y_i²/p_i + Y_j²/p_j) v_ij·∇_i W_ij + α_i K_T,i (Y_i/p_i) DT_i/Dt
// with p_i = Σ_j Y_j W_ij and ρ_i = m_i p_i/Y_i. Half the sum is the power of the pressure
// forces, which the gradient module has at hand (pattern 1 gives the note's form).
#pragma once

#include <volume/smoothed.hpp>

namespace tetsuame::volume {

struct y_evolution {
  static constexpr const char* name = "y_evolution";
  static constexpr carries carried = carries::weight;

  // Volumes by number for the walls' viscous term; the true ones follow from Y.
  template <int D>
  static void before_walls(pairs::workspace<D>& w, const wall_context<D>&) {
    auto& s = w.s;
    require_positive(w, s.Y, "the weight Y", "J");
    volumes_by_number(w, w.lattice_sum, s.dV.data());
    w.exchange_fluid({s.dV.data()});
    foundation::for_all(s.first_wall(), [&](std::size_t i) { s.rho[i] = s.m[i] / s.dV[i]; });
  }

  template <class Pressure, int D>
  static void determine(pairs::workspace<D>& w, const wall_context<D>& around) {
    auto& s = w.s;
    around.weights(w);
    smooth_by_lattice(w, around.smoothing.normalise);
    require_positive(w, s.p, "the smoothed pressure p");
    w.exchange_fluid({s.p.data()});
    volumes_from_weights(w);
    foundation::for_all(s.first_wall(), [&](std::size_t i) { s.rho[i] = s.m[i] / s.dV[i]; });
    equation_of_state(w, s.first_wall());
  }

  // W: DY_i/Dt from the power of the pressure forces per mass (W/kg) and DT/Dt (K/s).
  static double rate(double p, double K_T, double alpha, double dV, double m, double power, double dT) {
    return -(1.0 - K_T / p) * m * power + alpha * K_T * dV * dT;
  }
};

}  // namespace tetsuame::volume
