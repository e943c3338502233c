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
    weights(w, 0, w.s.first_wall());
    require_positive(w, w.s.p_eos, "the equation of state's pressure p");
  }

  template <class Pressure, int D>
  static void determine(pairs::workspace<D>& w, const surroundings<D>& around) {
    around.weights(w);
    Pressure::determine(w, around);
  }

  // before_walls in parts: of the owned fluid, while the ghosts' state travels; of the ghosts, once it is here.
  template <int D>
  static void ahead(pairs::workspace<D>& w) {
    weights(w, 0, w.s.fluid);
    require_positive(w, w.s.p_eos, "the equation of state's pressure p");
  }
  template <int D>
  static void with_ghosts(pairs::workspace<D>& w) {
    weights(w, w.s.fluid, w.s.first_wall());
  }

 private:
  // Y and ΔV of [first, last).
  template <int D>
  static void weights(pairs::workspace<D>& w, std::size_t first, std::size_t last) {
    auto& s = w.s;
    equation_of_state(w, first, last);
    foundation::for_all(last - first, [&](std::size_t k) {
      const std::size_t i = first + k;
      s.dV[i] = s.m[i] / s.rho[i];
      s.Y[i] = s.p_eos[i] * s.dV[i];
    });
  }
};

}  // namespace tetsuame::volume
