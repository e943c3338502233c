// Volume from the number density [after Hu & Adams 2006]: nothing is integrated that could drift.
//   s = Σ W Δx^D over the start lattice; Σ_j W_ij with the walls and j = i included
//   ΔV_i = s/Σ_j W_ij,  ρ_i = m_i/ΔV_i,  Y_i = p^_i ΔV_i
// so that ΔV = Δx^D exactly on the start lattice.
#pragma once

#include <volume/smoothed.hpp>

namespace tetsuame::volume {

struct number_density {
  static constexpr const char* name = "number_density";
  static constexpr carries carried = carries::nothing;

  template <int D>
  static void before_walls(pairs::workspace<D>& w, const wall_context<D>&) {
    auto& s = w.s;
    volumes_by_number(w, w.lattice_sum, s.dV.data());
    w.exchange_fluid({s.dV.data()});
    foundation::for_all(s.first_wall(), [&](std::size_t i) { s.rho[i] = s.m[i] / s.dV[i]; });
    equation_of_state(w, s.first_wall());
    foundation::for_all(s.first_wall(), [&](std::size_t i) { s.Y[i] = s.p_eos[i] * s.dV[i]; });
  }

  template <class Pressure, int D>
  static void determine(pairs::workspace<D>& w, const wall_context<D>& around) {
    find_pressure<Pressure>(w, around);
  }
};

}  // namespace tetsuame::volume
