// A liquid on a reference isentrope, fourth-order Birch-Murnaghan, through (rho0, T0):
//   p(rho, T) = p0 + p_S(rho) + gamma rho c_V (T - T_S(rho)),  gamma = gamma0 (rho0/rho)^q
//   T_S = T0 exp{(gamma0/q) [1 - (rho0/rho)^q]}   (d ln T_S/d ln rho = gamma)
//   (dp/drho)_T = [K_S + gamma rho c_V ((1 - q)(T - T_S) - gamma T_S)]/rho
// with constant c_V. Liquid iron: docs/theory/eos.md.
#pragma once

#include <cmath>
#include <eos/inversion.hpp>
#include <eos/properties.hpp>
#include <eos/reference_curves.hpp>

namespace tetsuame::eos {

struct isentropic_liquid {
  description about;
  double p0, rho0, T0;        // Pa, kg/m^3, K: the reference state
  birch_murnaghan reference;  // isentrope
  double gamma0, q;           // dimensionless
  double c_V;                 // J/(kg K)

  properties evaluate(double rho, double T) const {
    const double L = std::log(rho / rho0);
    const auto isentrope = reference.at(L);
    const double G = gamma(L), T_S = isentrope_temperature(L), alpha_K = G * rho * c_V;
    return from_derivatives(rho, T, p0 + isentrope.p + alpha_K * (T - T_S),
                            isentrope.K + alpha_K * ((1.0 - q) * (T - T_S) - G * T_S), alpha_K, c_V);
  }

  // kg/m^3; fail_calculation outside the pressures of the stable branch.
  double density(double p, double T) const { return invert(*this, p, T, {0.2 * rho0, rho0, 4.0 * rho0}); }

 private:
  double gamma(double L) const { return gamma0 * std::exp(-q * L); }
  double isentrope_temperature(double L) const {
    return T0 * std::exp(q == 0.0 ? gamma0 * L : -gamma0 / q * std::expm1(-q * L));
  }
};

}  // namespace tetsuame::eos
