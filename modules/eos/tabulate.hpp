// A table of a material that is known by equations, on axes even in ln rho and ln T.
#pragma once

#include <eos/caloric.hpp>
#include <eos/table_file.hpp>

namespace tetsuame::eos {

struct table_axes {
  double rho_low, rho_high, T_low, T_high;  // kg/m^3, K
  std::size_t densities, temperatures;      // two at least
};

// With c along the adiabat, and the entropy by ds = c_V/T dT - alpha K_T/rho^2 drho, 0 where it is least. fail_input
// where the equations give no finite pressure, energy or heat capacity.
table_data tabulate(const caloric& material, const table_axes& axes);

}  // namespace tetsuame::eos
