// Y by "our method" [S0, section 1.1]: ρ by continuity and T by its equation are part of the
// state; p^_i = p^(ρ_i, T_i), Y_i = m_i p^_i/ρ_i; then p_i smoothed, or p^_i itself.
#pragma once

#include <volume/smoothed.hpp>

namespace tetsuame::volume {

struct our_method {
  static constexpr const char* name = "our_method";
  static constexpr carries carried = carries::density;
};

}  // namespace tetsuame::volume
