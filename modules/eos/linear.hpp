// Linear equation of state:
//   p = p0 + K [(rho/rho0 - 1) + alpha0 (T - T0)]
// K and alpha0 are the bulk modulus and expansivity at rho0: at another density
// K_T = rho dp/drho = K rho/rho0 and alpha = alpha0 rho0/rho, so that alpha K_T stays.
#pragma once

#include <fmt/core.h>

#include <eos/properties.hpp>
#include <foundation/error.hpp>

namespace tetsuame::eos {

struct linear {
  description about;
  double p0, rho0, K, alpha0, T0, c_V;  // Pa, kg/m^3, Pa, 1/K, K, J/(kg K)

  template <class R>
  properties_of<R> evaluate(const R& rho, const R& T) const {
    const R p = p0 + K * ((rho / rho0 - 1.0) + alpha0 * (T - T0));
    return from_derivatives<R>(rho, T, p, K * rho / rho0, alpha0 * K, c_V);
  }

  // kg/m^3; fail_calculation where the line gives no positive density.
  double density(double p, double T) const {
    const double rho = rho0 * (1.0 + (p - p0) / K - alpha0 * (T - T0));
    if (!(rho > 0.0))
      foundation::fail_calculation(fmt::format(
          "equation of state '{}': p = {:g} Pa at T = {:g} K gives the density {:g} kg/m^3; at this temperature p must "
          "be above {:g} Pa",
          about.name, p, T, rho, evaluate(0.0, T).p));
    return rho;
  }
};

}  // namespace tetsuame::eos
