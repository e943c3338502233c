// Stiffened gas, u = c_V T + p_inf/rho; an ideal gas has p_inf = 0:
//   p = (gamma - 1) rho c_V T - p_inf,  c^2 = gamma (p + p_inf)/rho
// [F. H. Harlow, A. A. Amsden, Fluid Dynamics, LA-4700 (1971)].
#pragma once

#include <fmt/core.h>

#include <eos/properties.hpp>
#include <foundation/error.hpp>

namespace tetsuame::eos {

struct stiffened_gas {
  description about;
  double gamma, p_infinity, c_V;  // dimensionless, Pa, J/(kg K)

  template <class R>
  properties_of<R> evaluate(const R& rho, const R& T) const {
    const R alpha_K = (gamma - 1.0) * rho * c_V;
    return from_derivatives<R>(rho, T, alpha_K * T - p_infinity, alpha_K * T, alpha_K, c_V);
  }

  // kg/m^3; fail_calculation unless p > -p_inf and T > 0.
  double density(double p, double T) const {
    if (!(p > -p_infinity && T > 0.0))
      foundation::fail_calculation(
          fmt::format("equation of state '{}': no density has p = {:g} Pa at T = {:g} K: ", about.name, p, T) +
          (about.name == "ideal_gas" ? "both must be above 0"
                                     : fmt::format("p must be above {:g} Pa and T above 0 K", -p_infinity)));
    return (p + p_infinity) / ((gamma - 1.0) * c_V * T);
  }
};

}  // namespace tetsuame::eos
