// The materials under test and the states at which they are looked at.
#pragma once

#include <cmath>
#include <eos/eos.hpp>
#include <string>
#include <vector>

struct sample {
  std::string label;
  tetsuame::eos::any material;
  double rho_low, rho_high;  // kg/m^3
  double T_low, T_high;      // K
};

inline tetsuame::eos::any material(const std::string& name) {
  tetsuame::eos::material_options o;
  o.name = name;
  return tetsuame::eos::make(o);
}

inline tetsuame::eos::any tillotson(const std::string& name) {
  tetsuame::eos::material_options o;
  o.name = "tillotson";
  o.tillotson = name;
  return tetsuame::eos::make(o);
}

// All densities are on the stable branch of their temperatures; Tillotson's are clear of
// rho0 by more than the steps of the differences, for K_T has a kink there.
inline std::vector<sample> samples() {
  tetsuame::eos::material_options birch, no_slope;
  birch.name = "liquid_silicate";
  birch.curve = "birch_murnaghan";
  no_slope.name = "liquid_iron_isentrope";
  no_slope.gruneisen_exponent = 0.0;
  return {{"linear", material("linear"), 3000.0, 12000.0, 300.0, 6000.0},
          {"liquid_iron", material("liquid_iron"), 6800.0, 14000.0, 1500.0, 8000.0},
          {"liquid_iron_isentrope", material("liquid_iron_isentrope"), 6800.0, 14000.0, 1500.0, 8000.0},
          {"isentrope, q = 0", tetsuame::eos::make(no_slope), 6800.0, 14000.0, 1500.0, 8000.0},
          {"silicate, Vinet", material("liquid_silicate"), 2600.0, 6000.0, 1500.0, 6000.0},
          {"silicate, Birch-Murnaghan", tetsuame::eos::make(birch), 2600.0, 6000.0, 1500.0, 6000.0},
          {"tillotson iron", tillotson("iron"), 7500.0, 20000.0, 300.0, 5000.0},
          {"tillotson granite", tillotson("granite"), 2550.0, 7000.0, 300.0, 4000.0},
          {"tillotson basalt", tillotson("basalt"), 2600.0, 7000.0, 300.0, 5000.0},
          {"iron_hcp", material("iron_hcp"), 8000.0, 30000.0, 200.0, 12000.0},
          {"bridgmanite", material("bridgmanite"), 3800.0, 12000.0, 200.0, 8000.0},
          {"post_perovskite", material("post_perovskite"), 4200.0, 15000.0, 200.0, 10000.0},
          {"liquid_mgsio3", material("liquid_mgsio3"), 3000.0, 12000.0, 1800.0, 12000.0},
          {"ideal_gas", material("ideal_gas"), 1e-3, 1e3, 10.0, 1e5},
          {"stiffened_gas", material("stiffened_gas"), 500.0, 2000.0, 100.0, 5000.0}};
}

// 12 x 7 states, evenly in ln rho and in T.
template <class F>
void for_each_state(const sample& s, F f) {
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 7; ++j)
      f(s.rho_low * std::pow(s.rho_high / s.rho_low, (i + 0.37) / 12.0),
        s.T_low + (s.T_high - s.T_low) * (j + 0.41) / 7.0);
}
