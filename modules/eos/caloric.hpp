// A material by density and specific internal energy, as shocks need it (docs/theory/eos.md). With the pressure of the
// equation of state,
//   u(rho, T) = u_0(rho) + E(rho, T) - E(rho, T0),   dE/dT = c_V,
//   du_0/drho = [p - T (dp/dT)_rho]/rho^2 on the isotherm T0
//   c^2 = (dp/drho)_T + (dp/dT)_rho/c_V [p/rho^2 - (du/drho)_T]
// c_V is linear in T in the gases and in the liquids on a curve, so T follows from u in closed form. Tillotson,
// crystals, the melt of MgSiO3 and tables have u and T of their own. Zero of u: c_V T of the gases, E(rho0, T0) of the
// liquids at (rho0, T0), 0 of Tillotson and the melt and T0 times its entropy of a crystal there; a table's own.
#pragma once

#include <eos/eos.hpp>
#include <vector>

namespace tetsuame::eos {

struct caloric_state {
  double p, T, c;  // Pa, K, m/s; c not a number where c^2 < 0
};

class caloric {
 public:
  explicit caloric(any material);

  // rho kg/m^3, u J/kg. Not a number beyond 0.1 to 10 rho0 (linear, liquids) or what the material reaches.
  caloric_state at(double rho, double u) const;
  double internal_energy(double rho, double T) const;  // J/kg
  double temperature(double rho, double u) const;      // K
  // dK_S/dp along the adiabat at rho, u: central difference, relative error about 1e-6.
  double stiffening(double rho, double u) const;
  const any& material() const { return material_; }

 private:
  struct part {
    double u, slope;  // J/kg, d/d ln rho
  };
  struct heat {
    double a, b, slope;  // c_V = a + b T; d ln b/d ln rho
  };
  part isotherm(double rho) const;
  heat capacity(double rho) const;

  any material_;
  bool has_own_energy_;
  double rho0_ = 1.0, T0_ = 0.0;
  double low_ = 0.0, step_ = 0.0;  // of the table, in ln(rho/rho0)
  std::vector<part> table_;        // of the isotherm; empty: in closed form
};

}  // namespace tetsuame::eos
