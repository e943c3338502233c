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
};

}  // namespace tetsuame::volume
