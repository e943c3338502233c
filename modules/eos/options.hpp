// The parameters a user may give for a material, and each equation of state's own defaults.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tetsuame::eos {

// Everything left empty takes the default of the equation of state named; a parameter that
// this equation does not have is an error, never ignored.
struct material_options {
  std::string name = "linear";
  std::string curve{};      // liquid_silicate: 'vinet' or 'birch_murnaghan'
  std::string tillotson{};  // tillotson: 'iron', 'granite' or 'basalt'
  std::optional<double> reference_pressure{}, reference_density{}, reference_temperature{};
  std::optional<double> bulk_modulus{}, bulk_modulus_derivative{}, bulk_modulus_second_derivative{};
  std::optional<double> thermal_expansivity{}, heat_capacity{};
  std::optional<double> gruneisen{}, gruneisen_exponent{}, electronic_coefficient{}, electronic_exponent{};
  std::optional<double> gamma{}, p_infinity{};
};

// One numeric parameter: its key, unit, lowest allowed value and meaning, for inputs and messages.
struct parameter {
  enum class range { any, not_negative, positive, above_one };
  std::string_view key;
  std::optional<double> material_options::*member;
  std::string_view unit;
  range allowed;
  std::string_view meaning;
};

inline constexpr auto parameters = [] {
  using m = material_options;
  using enum parameter::range;
  return std::array<parameter, 14>{{
      {"reference_pressure", &m::reference_pressure, "Pa", any, "pressure at the reference state"},
      {"reference_density", &m::reference_density, "kg/m^3", positive, "density at the reference state"},
      {"reference_temperature", &m::reference_temperature, "K", positive, "temperature of the reference state"},
      {"bulk_modulus", &m::bulk_modulus, "Pa", positive, "bulk modulus on the reference curve"},
      {"bulk_modulus_derivative", &m::bulk_modulus_derivative, "", any, "its first derivative by pressure"},
      {"bulk_modulus_second_derivative", &m::bulk_modulus_second_derivative, "1/Pa", any,
       "its second derivative by pressure"},
      {"thermal_expansivity", &m::thermal_expansivity, "1/K", any, "expansivity at the reference state"},
      {"heat_capacity", &m::heat_capacity, "J/(kg K)", positive,
       "c_V, for liquid_iron its part that is constant (3R/M)"},
      {"gruneisen", &m::gruneisen, "", any, "Grueneisen parameter gamma0 at the reference density"},
      {"gruneisen_exponent", &m::gruneisen_exponent, "", any, "q in gamma = gamma0 (rho0/rho)^q"},
      {"electronic_coefficient", &m::electronic_coefficient, "1/K", not_negative,
       "e0 in E = c [T + e0 (rho0/rho)^g T^2]"},
      {"electronic_exponent", &m::electronic_exponent, "", any, "g in E = c [T + e0 (rho0/rho)^g T^2]"},
      {"gamma", &m::gamma, "", above_one, "ratio of specific heats"},
      {"p_infinity", &m::p_infinity, "Pa", not_negative, "stiffening pressure"},
  }};
}();

// Names of the equations of state, in the order they are offered.
const std::vector<std::string_view>& names();

// The full set that make() would use: defaults with the given values over them; parameters
// the equation of state does not have stay empty. fail_input for an unknown name, a
// parameter it does not have, or a value out of range.
material_options resolve(const material_options& given);

// Keys of the parameters that differ from the defaults of the same equation of state.
std::vector<std::string_view> changed(const material_options& resolved);

}  // namespace tetsuame::eos
