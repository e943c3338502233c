// A crystal: a reference isotherm (Vinet or third-order Birch-Murnaghan) with the thermal part of Debye's model, and of
// the terms of anharmonic vibrations and of electrons that grow with T^2. One free energy of density and temperature,
// x = rho0/rho, k = n R/M:
//   F = F_ref(rho) + F_D(theta(rho), T) - F_D(theta, T0) - A/2 (T^2 - T0^2)
//   A = 3 k (a x^m + e x^g)
//   p = p_ref + gamma rho [E_D(T) - E_D(T0)] + 3/2 k rho (m a x^m + g e x^g)(T^2 - T0^2)
// and all that `properties` holds is a derivative of it (docs/theory/eos_planets.md).
#pragma once

#include <eos/characteristic.hpp>
#include <eos/properties.hpp>
#include <eos/reference_curves.hpp>

namespace tetsuame::eos {

// Of A: coefficient in 1/K, and the exponent of x.
struct quadratic_term {
  double coefficient, exponent;
};

struct debye_solid {
  // Compressions to which the formulas are followed; beyond, nothing is a number.
  static constexpr double least_compression = 0.7, most_compression = 6.0;

  description about;
  double rho0, T0;            // kg/m^3, K: zero pressure on the isotherm
  double k;                   // J/(kg K), n R/M
  reference_curve reference;  // isotherm at T0
  characteristic_temperature vibration;
  quadratic_term anharmonic, electronic;

  properties evaluate(double rho, double T) const;
  // kg/m^3; fail_calculation outside the pressures of the stable branch.
  double density(double p, double T) const;
  double internal_energy(double rho, double T) const;  // J/kg, F + T S
  double temperature(double rho, double u) const;      // K
};

}  // namespace tetsuame::eos
