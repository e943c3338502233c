// A side of a Riemann problem whose gas is ideal.
#pragma once

#include <riemann/exact.hpp>

namespace tetsuame::riemann {

template <class R>
side<R> ideal_gas(const R& rho, const R& u, const R& p, const R& gamma) {
  return {rho, u, p, gamma, R(0.0)};
}

}  // namespace tetsuame::riemann
