// A liquid on a reference isotherm with Mie-Grueneisen thermal pressure (docs/theory/eos.md):
//   p(rho, T) = p0 + p_ref(rho) + gamma rho [E(rho, T) - E(rho, T0)]
//   E(rho, T) = c [T + e T^2],  e = e0 (rho0/rho)^g,  gamma = gamma0 (rho0/rho)^q
//   c_V = dE/dT = c (1 + 2 e T),   alpha K_T = (dp/dT)_rho = gamma rho c_V
#pragma once

#include <cmath>
#include <eos/inversion.hpp>
#include <eos/properties.hpp>
#include <eos/reference_curves.hpp>
#include <foundation/lanes_math.hpp>

namespace tetsuame::eos {

struct thermal_part {
  double T0;         // K
  double gamma0, q;  // dimensionless
  double c;          // J/(kg K)
  double e0, g;      // 1/K, dimensionless
};

template <class Curve>
struct liquid {
  description about;
  double p0, rho0;  // Pa, kg/m^3: the reference state
  Curve reference;  // isotherm at T0
  thermal_part thermal;

  template <class R>
  properties_of<R> evaluate(const R& rho, const R& T) const {
    const R L = foundation::log(R(rho / rho0));
    const auto cold = reference.at(L);
    const R e = electronic(L), gr = gamma_rho(rho, L), E = energy_difference(T, e);
    // d ln(gamma rho)/d ln rho = 1 - q,  d e/d ln rho = -g e
    const R dE = -thermal.g * thermal.c * e * (T * T - thermal.T0 * thermal.T0);
    const R c_V = thermal.c * (1.0 + 2.0 * e * T);
    return from_derivatives<R>(rho, T, p0 + cold.p + gr * E, cold.K + gr * ((1.0 - thermal.q) * E + dE), gr * c_V, c_V);
  }

  // kg/m^3; fail_calculation outside the pressures of the stable branch.
  double density(double p, double T) const { return invert(*this, p, T, {0.2 * rho0, rho0, 4.0 * rho0}); }

 private:
  template <class R>
  R electronic(const R& L) const {
    return thermal.e0 == 0.0 ? R(0.0) : R(thermal.e0 * foundation::exp(R(-thermal.g * L)));
  }
  template <class R>
  R gamma_rho(const R& rho, const R& L) const {
    return thermal.gamma0 * foundation::exp(R(-thermal.q * L)) * rho;
  }
  template <class R>
  R energy_difference(const R& T, const R& e) const {
    return thermal.c * (T - thermal.T0) * (1.0 + e * (T + thermal.T0));
  }
};

}  // namespace tetsuame::eos
