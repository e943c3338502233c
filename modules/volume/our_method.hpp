// Y by "our method" [S0, section 1.1]: ρ by continuity and T by its equation are part of the
// state; p^_i = p^(ρ_i, T_i), Y_i = m_i p^_i/ρ_i; then p_i smoothed, or p^_i itself.
#pragma once

#include <volume/consistency.hpp>

namespace tetsuame::volume {

struct our_method {
  static constexpr const char* name = "our_method";
  static constexpr carries carried = carries::density;

  // dlnrho: 1/s, with what ties the density to the places.
  template <int D>
  static double tied_rate(const particles::particles<D>& s, std::size_t i, double dlnrho, double /*dT*/) {
    return s.rho[i] * dlnrho;
  }
};

}  // namespace tetsuame::volume
