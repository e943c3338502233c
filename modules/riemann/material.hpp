// The sides of a Riemann problem between particles of any equation of state.
#pragma once

#include <eos/eos.hpp>
#include <riemann/states.hpp>

namespace tetsuame::riemann {

struct moduli {
  double K_S, K_S_prime;  // Pa; dK_S/dp along the adiabat
  double K_T, K_T_prime;  // Pa; dK_T/dp along the isotherm
};

// At rho (kg/m^3), T (K). The primes are central differences with steps of 1e-4 in ln rho, along
// d ln T = gamma_th d ln rho for the adiabat; relative error about 1e-7. K' is nearly
// constant in a liquid, so it may be taken once a material. Not a number beyond the
// equation of state's reach.
moduli local_moduli(const eos::any& material, double rho, double T);

// Fitted with K_S or with K_T; fail_calculation unless K > 0 (stable) and K' > 1.
side<double> adiabatic_side(const eos::any& material, double rho, double u, double T);
side<double> isothermal_side(const eos::any& material, double rho, double u, double T);

}  // namespace tetsuame::riemann
