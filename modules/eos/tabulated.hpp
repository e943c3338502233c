// A material by a table of pressure and energy (eos/table_file.hpp), both bicubic and monotone in ln rho and ln T
// (eos/surface.hpp). With the derivatives of the two surfaces
//   K_T = (dp/d ln rho)_T, alpha K_T = (dp/dT)_rho, c_V = (du/dT)_rho
//   c^2 = (dp/drho)_T + alpha K_T/c_V [p/rho^2 - (du/drho)_T]
// which is the sound of the table also where its p and u are not of one potential.
#pragma once

#include <eos/properties.hpp>
#include <eos/table_file.hpp>
#include <memory>

namespace tetsuame::eos {

struct tabulated {
  description about;

  tabulated(description about_, const table_data& table);

  // Outside the table all results are not a number.
  properties evaluate(double rho, double T) const;
  // kg/m^3; fail_calculation outside the table, and outside the pressures of the stable branch.
  double density(double p, double T) const;
  double internal_energy(double rho, double T) const;  // J/kg
  double temperature(double rho, double u) const;      // K

  // kg/m^3, K
  struct range {
    double rho_low, rho_high, T_low, T_high;
  };
  const range& reach() const { return reach_; }
  // Nodes whose energy was lowered to that of the next temperature, which had less.
  std::size_t lowered() const { return lowered_; }

 private:
  struct surfaces;
  range reach_;
  std::size_t lowered_ = 0;
  std::shared_ptr<const surfaces> surfaces_;
};

}  // namespace tetsuame::eos
