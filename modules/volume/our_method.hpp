// Y by "our method" [S0, section 1.1]: ρ by continuity and T by its equation are part of the
// state; p^_i = p^(ρ_i, T_i), Y_i = m_i p^_i/ρ_i; then p_i smoothed, or p^_i itself.
#pragma once

#include <volume/smoothed.hpp>

namespace tetsuame::volume {

struct our_method {
  static constexpr const char* name = "our_method";
  static constexpr carries carried = carries::density;

  template <int D>
  static void before_walls(pairs::workspace<D>& w, const surroundings<D>&) {
    auto& s = w.s;
    equation_of_state(w, s.first_wall());
    require_positive(w, s.p_eos, "the equation of state's pressure");
    foundation::for_all(s.first_wall(), [&](std::size_t i) {
      s.dV[i] = s.m[i] / s.rho[i];
      s.Y[i] = s.p_eos[i] * s.dV[i];
    });
  }

  template <class Pressure, int D>
  static void determine(pairs::workspace<D>& w, const surroundings<D>& around) {
    around.weights(w);
    Pressure::determine(w, around);
  }
};

}  // namespace tetsuame::volume
