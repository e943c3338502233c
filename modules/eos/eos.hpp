// Equations of state by name. Each is a plain struct with
//   double density(p, T)             kg/m^3, the inverse; fail_calculation if there is none
//   properties evaluate(rho, T)      p, K_T, alpha, c_V, c; throws nothing, a state out of
//                                    reach gives not-a-number, which the caller reports
//   description about                name, source, whether its parameters are illustrative
// with rho in kg/m^3, T in K, p in Pa; those with an energy of their own also
//   double internal_energy(rho, T), temperature(rho, u)
// Equations and parameters: docs/theory/eos.md, eos_planets.md, eos_tables.md.
#pragma once

#include <array>
#include <eos/debye_solid.hpp>
#include <eos/isentropic_liquid.hpp>
#include <eos/linear.hpp>
#include <eos/liquid.hpp>
#include <eos/rosenfeld_tarazona.hpp>
#include <eos/stiffened_gas.hpp>
#include <eos/tabulated.hpp>
#include <eos/tillotson.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace tetsuame::eos {

using any = std::variant<linear, liquid<vinet>, liquid<birch_murnaghan>, isentropic_liquid, tillotson, stiffened_gas,
                         debye_solid, rosenfeld_tarazona, tabulated>;

// What a user may give for a material. Everything left empty takes the default of the equation of state named; a
// parameter that this equation does not have is an error, never ignored.
struct material_options {
  std::string name = "linear";
  std::string curve{};      // liquid_silicate: 'vinet' or 'birch_murnaghan'
  std::string tillotson{};  // tillotson: 'iron', 'granite' or 'basalt'
  std::string table{};      // table: path of the file
  std::optional<double> reference_pressure{}, reference_density{}, reference_temperature{};
  std::optional<double> bulk_modulus{}, bulk_modulus_derivative{}, bulk_modulus_second_derivative{};
  std::optional<double> thermal_expansivity{}, heat_capacity{};
  std::optional<double> gruneisen{}, gruneisen_exponent{}, electronic_coefficient{}, electronic_exponent{};
  std::optional<double> gamma{}, p_infinity{};
  std::optional<double> debye_temperature{};
  // Tillotson's B, a, b, E0, E_iv, E_cv, alpha, beta; rho0, A and c_V are above
  std::optional<double> nonlinear_modulus{}, tillotson_a{}, tillotson_b{};
  std::optional<double> tillotson_energy{}, incipient_energy{}, complete_energy{};
  std::optional<double> tillotson_alpha{}, tillotson_beta{};
};

// One numeric parameter: its key, unit, lowest allowed value and meaning, for inputs and messages.
struct parameter {
  enum class range { finite, not_negative, positive, above_one };
  std::string_view key;
  std::optional<double> material_options::*member;
  std::string_view unit;
  range allowed;
  std::string_view meaning;
};

inline constexpr auto parameters = [] {
  using m = material_options;
  using enum parameter::range;
  return std::array<parameter, 23>{{
      {"reference_pressure", &m::reference_pressure, "Pa", finite, "pressure at the reference state"},
      {"reference_density", &m::reference_density, "kg/m^3", positive, "density at the reference state"},
      {"reference_temperature", &m::reference_temperature, "K", positive, "temperature of the reference state"},
      {"bulk_modulus", &m::bulk_modulus, "Pa", positive, "bulk modulus on the reference curve"},
      {"bulk_modulus_derivative", &m::bulk_modulus_derivative, "", finite, "its first derivative by pressure"},
      {"bulk_modulus_second_derivative", &m::bulk_modulus_second_derivative, "1/Pa", finite,
       "its second derivative by pressure"},
      {"thermal_expansivity", &m::thermal_expansivity, "1/K", finite, "expansivity at the reference state"},
      {"heat_capacity", &m::heat_capacity, "J/(kg K)", positive,
       "c_V, for liquid_iron its part that is constant (3R/M)"},
      {"gruneisen", &m::gruneisen, "", finite, "Grueneisen parameter gamma0 at the reference density"},
      {"gruneisen_exponent", &m::gruneisen_exponent, "", finite,
       "q in gamma = gamma0 (rho0/rho)^q, or -d ln gamma/d ln rho at rho0"},
      {"electronic_coefficient", &m::electronic_coefficient, "1/K", not_negative,
       "e0 in E = c [T + e0 (rho0/rho)^g T^2]"},
      {"electronic_exponent", &m::electronic_exponent, "", finite, "g in E = c [T + e0 (rho0/rho)^g T^2]"},
      {"gamma", &m::gamma, "", above_one, "ratio of specific heats"},
      {"p_infinity", &m::p_infinity, "Pa", not_negative, "stiffening pressure"},
      {"debye_temperature", &m::debye_temperature, "K", positive, "of the crystals, at the reference density"},
      {"nonlinear_modulus", &m::nonlinear_modulus, "Pa", finite, "tillotson: B, with bulk_modulus as A"},
      {"tillotson_a", &m::tillotson_a, "", positive, "tillotson: a"},
      {"tillotson_b", &m::tillotson_b, "", not_negative, "tillotson: b"},
      {"tillotson_energy", &m::tillotson_energy, "J/kg", positive, "tillotson: E0"},
      {"incipient_energy", &m::incipient_energy, "J/kg", positive, "tillotson: E_iv, where vapour begins"},
      {"complete_energy", &m::complete_energy, "J/kg", positive, "tillotson: E_cv, where all is vapour"},
      {"tillotson_alpha", &m::tillotson_alpha, "", not_negative, "tillotson: alpha"},
      {"tillotson_beta", &m::tillotson_beta, "", not_negative, "tillotson: beta"},
  }};
}();

// Names of the equations of state, in the order they are offered.
const std::vector<std::string_view>& names();

// The full set that make() would use: defaults with the given values over them; parameters
// the equation of state does not have stay empty. fail_input for an unknown name, a
// parameter it does not have, or a value out of range.
material_options resolve(const material_options& given);

// fail_input as resolve() does.
any make(const material_options& options);

const description& about(const any& material);
double pressure(const any& material, double rho, double T);
double density(const any& material, double p, double T);
properties evaluate(const any& material, double rho, double T);

}  // namespace tetsuame::eos
