// Tillotson's equation of state for impacts [J. H. Tillotson, GA-3216 (1962); H. J. Melosh,
// Impact Cratering (1989), appendix II; W. Benz, E. Asphaug, Icarus 142, 5 (1999)].
// With eta = rho/rho0, mu = eta - 1, omega = u/(E0 eta^2) + 1:
//   condensed, rho >= rho0 or u <= E_iv:
//     p_c = (a + b/omega) rho u + A mu + B mu^2
//   expanded and hot, rho < rho0 and u >= E_cv:
//     p_e = a rho u + [b rho u/omega + A mu exp(-beta (1/eta - 1))] exp(-alpha (1/eta - 1)^2)
//   between E_iv and E_cv: linear in u from p_c to p_e.
// A function of (rho, u); T by an isentrope, what is left out of it, and where T is an approximation:
// docs/theory/eos.md.
#pragma once

#include <eos/inversion.hpp>
#include <eos/properties.hpp>
#include <memory>
#include <string_view>

namespace tetsuame::eos {

struct tillotson_parameters {
  std::string_view material;
  double rho0, A, B;   // kg/m^3, Pa, Pa
  double a, b, E0;     // dimensionless, dimensionless, J/kg
  double E_iv, E_cv;   // J/kg: incipient and complete vaporisation
  double alpha, beta;  // dimensionless
  double c_V;          // J/(kg K), no part of the fits: of the solid near room temperature
};

// 'iron', 'granite' or 'basalt'; fail_input for another name.
const tillotson_parameters& find_tillotson(std::string_view material);

struct tillotson_state {
  double p, p_rho, p_u;  // Pa, (dp/drho)_u, (dp/du)_rho
};

// The pressure of rho (kg/m^3) and u (J/kg) with its derivatives.
tillotson_state tillotson_pressure(const tillotson_parameters& material, double rho, double u);

struct tillotson {
  static constexpr double largest_compression = 5.0;  // rho/rho0 to which the isentrope is tabulated

  description about;
  tillotson_parameters material;
  double T0, c_V;  // K, J/(kg K)

  // T0 > 0, c_V > 0. Integrates the reference isentrope.
  tillotson(description about_, const tillotson_parameters& material_, double T0_, double c_V_);

  // Above largest_compression * rho0 all results are not a number.
  properties evaluate(double rho, double T) const;
  // kg/m^3; fail_calculation outside the pressures of the stable branch.
  double density(double p, double T) const;

  double internal_energy(double rho, double T) const;  // J/kg
  double temperature(double rho, double u) const;      // K

 private:
  struct isentrope_point {
    double u, T, u_slope, T_slope;  // J/kg, K, and their d/drho
  };
  isentrope_point isentrope(double rho) const;

  struct curves;  // of the reference isentrope
  std::shared_ptr<const curves> curves_;
};

}  // namespace tetsuame::eos
