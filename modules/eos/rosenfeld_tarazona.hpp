// A silicate melt [A. S. Wolf, D. J. Bower, Phys. Earth Planet. Inter. 278, 59 (2018)]: Vinet's isotherm at T0, a
// reference adiabat T_S(rho) through it, and the heat of Rosenfeld and Tarazona, whose part b of the potential energy
// depends on density. One free energy, x = rho0/rho, k = n R/M, f = (T/T0)^m - 1, f' = df/dT:
//   F = F_ref(rho) + b f + 3/2 k (T - T0) + T0 S(rho, T0) - T S(rho, T)
//   S = b/(m - 1) [f'(T) - f'(T_S)] + 3/2 k ln(T/T_S),  b = sum b_n (x - 1)^n
//   p = p_ref + rho [b_L f + T0 S_L(T0) - T S_L(T)],  (dp/dT)_rho = -rho S_L(T),  c_V = b f' + 3/2 k
// with the index L for d/d ln rho at constant T.
#pragma once

#include <array>
#include <eos/characteristic.hpp>
#include <eos/properties.hpp>
#include <eos/reference_curves.hpp>

namespace tetsuame::eos {

struct rosenfeld_tarazona {
  // Compressions to which b is followed; beyond, nothing is a number. A hot melt below the first would become stiffer
  // as it expands.
  static constexpr double least_compression = 0.87, most_compression = 6.0;

  description about;
  double rho0, T0;          // kg/m^3, K: zero pressure on the isotherm
  double k;                 // J/(kg K), n R/M
  vinet reference;          // isotherm at T0
  finite_strain adiabat;    // T_S, through T0 at rho0
  double m;                 // 3/5 by theory
  std::array<double, 5> b;  // J/kg

  properties evaluate(double rho, double T) const;
  // kg/m^3; fail_calculation outside the pressures of the stable branch.
  double density(double p, double T) const;
  double internal_energy(double rho, double T) const;  // J/kg, F + T S
  double temperature(double rho, double u) const;      // K
};

}  // namespace tetsuame::eos
