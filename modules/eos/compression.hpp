// A column at rest may weigh so much beside its bulk modulus that no lattice of particles carries it.
#pragma once

#include <fmt/core.h>

#include <eos/eos.hpp>
#include <foundation/error.hpp>

namespace tetsuame::eos {

// kg/m3 over that at the top of the column. A liquid's curves hold to a few times its density; with a factor of e in so
// many rows a column has no pressure that numbers hold.
inline constexpr double most_compressed_column = 100.0;

// Of a column of one material that is integrated downwards from a density `top` (kg/m3): fail_input where at the height
// y (m) it has come to `rho`, at the pressure p (Pa) and temperature T (K).
inline void check_column(const any& material, double top, double T, double y, double p, double rho) {
  if (rho <= most_compressed_column * top) return;  // not where it is no number
  const double K = evaluate(material, top, T).K_T;
  foundation::fail_input(fmt::format(
      "the bulk modulus is too small for the column's weight: {:.6g} Pa at {:.6g} kg/m^3, at the top. At {:.6g} m the "
      "fluid at rest would be {:.3g} times as dense (p = {:.3g} Pa), where {:g} times is the most; take a larger bulk "
      "modulus, less gravity or a lower box",
      K, top, y, rho / top, p, most_compressed_column));
}

}  // namespace tetsuame::eos
