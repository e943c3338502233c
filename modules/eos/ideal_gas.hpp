// Ideal gas, u = c_V T:
//   p = (gamma - 1) rho c_V T,  K_T = p,  alpha = 1/T,  c^2 = gamma p/rho
#pragma once

#include <fmt/core.h>

#include <eos/properties.hpp>
#include <foundation/error.hpp>

namespace tetsuame::eos {

struct ideal_gas {
  description about;
  double gamma, c_V;  // dimensionless, J/(kg K)

  double pressure(double rho, double T) const { return (gamma - 1.0) * rho * c_V * T; }

  template <class R>
  properties_of<R> evaluate(const R& rho, const R& T) const {
    const R alpha_K = (gamma - 1.0) * rho * c_V;
    return from_derivatives<R>(rho, T, alpha_K * T, alpha_K * T, alpha_K, c_V);
  }

  // kg/m^3; fail_calculation unless p > 0 and T > 0.
  double density(double p, double T) const {
    if (!(p > 0.0 && T > 0.0))
      foundation::fail_calculation(fmt::format(
          "equation of state '{}': no density has p = {:g} Pa at T = {:g} K: both must be above 0", about.name, p, T));
    return p / ((gamma - 1.0) * c_V * T);
  }
};

}  // namespace tetsuame::eos
