#include <fmt/core.h>
#include <fmt/ranges.h>

#include <cmath>
#include <eos/options.hpp>
#include <eos/reference_curves.hpp>
#include <eos/tillotson.hpp>
#include <foundation/error.hpp>

namespace tetsuame::eos {

namespace {

constexpr double gas_constant = 8.314462618;   // J/(mol K), CODATA 2018
constexpr double molar_mass_iron = 55.845e-3;  // kg/mol

material_options linear_defaults() {
  material_options o;
  o.reference_pressure = 1e5;
  o.reference_density = 7000.0;
  o.reference_temperature = 2500.0;
  o.bulk_modulus = 100e9;
  o.thermal_expansivity = 2.5e-5;
  o.heat_capacity = 1000.0;
  return o;
}

material_options liquid_iron_defaults() {  // Kuwayama et al. (2020)
  material_options o;
  o.reference_pressure = 1e5;
  o.reference_density = 7030.0;
  o.reference_temperature = 1811.0;
  o.bulk_modulus = 82.1e9;
  o.bulk_modulus_derivative = 5.80;
  o.heat_capacity = 3.0 * gas_constant / molar_mass_iron;
  o.gruneisen = 2.02;
  o.gruneisen_exponent = 0.63;
  o.electronic_coefficient = 0.68e-4;
  o.electronic_exponent = -1.0;
  return o;
}

material_options liquid_iron_isentrope_defaults() {  // Anderson and Ahrens (1994)
  material_options o;
  o.reference_pressure = 1e5;
  o.reference_density = 7019.0;
  o.reference_temperature = 1811.0;
  o.bulk_modulus = 109.7e9;
  o.bulk_modulus_derivative = 4.66;
  o.bulk_modulus_second_derivative = -0.043e-9;
  // c_p = 46.02 J/(mol K) of liquid iron, over 1 + alpha gamma T = 1.287
  o.heat_capacity = 640.0;
  o.gruneisen = 1.735;
  o.gruneisen_exponent = 0.2;
  return o;
}

material_options liquid_silicate_defaults() {
  material_options o;
  o.curve = vinet::name;
  o.reference_pressure = 1e5;
  o.reference_density = 2700.0;
  o.reference_temperature = 2500.0;
  o.bulk_modulus = 25e9;
  o.bulk_modulus_derivative = 6.0;
  o.heat_capacity = 1500.0;
  o.gruneisen = 0.6;
  o.gruneisen_exponent = -1.0;
  return o;
}

// c_V is no part of Tillotson's fits: values of the solids near room temperature.
material_options tillotson_defaults(const std::string& material) {
  material_options o;
  o.tillotson = material.empty() ? "iron" : material;
  find_tillotson(o.tillotson);
  o.reference_temperature = 300.0;
  o.heat_capacity = o.tillotson == "iron" ? 449.0 : o.tillotson == "granite" ? 790.0 : 840.0;
  return o;
}

material_options ideal_gas_defaults() {  // air
  material_options o;
  o.gamma = 1.4;
  o.heat_capacity = 717.5;
  return o;
}

// Water: gamma and p_infinity as customary in shock problems, c_V so that 1000 kg/m^3 has
// 1e5 Pa at 300 K.
material_options stiffened_gas_defaults() {
  material_options o;
  o.gamma = 4.4;
  o.p_infinity = 6e8;
  o.heat_capacity = (1e5 + 6e8) / (3.4 * 1000.0 * 300.0);
  return o;
}

material_options defaults(const std::string& name, const std::string& tillotson_material) {
  const auto of = [&]() -> material_options {
    if (name == "linear") return linear_defaults();
    if (name == "liquid_iron") return liquid_iron_defaults();
    if (name == "liquid_iron_isentrope") return liquid_iron_isentrope_defaults();
    if (name == "liquid_silicate") return liquid_silicate_defaults();
    if (name == "tillotson") return tillotson_defaults(tillotson_material);
    if (name == "ideal_gas") return ideal_gas_defaults();
    if (name == "stiffened_gas") return stiffened_gas_defaults();
    foundation::fail_input(
        fmt::format("there is no equation of state '{}': choose one of {}", name, fmt::join(names(), ", ")));
  };
  material_options o = of();
  o.name = name;
  return o;
}

void check_range(const std::string& name, const parameter& key, double value) {
  using range = parameter::range;
  const bool good =
      std::isfinite(value) &&
      (key.allowed == range::any || (key.allowed == range::not_negative && value >= 0.0) ||
       (key.allowed == range::positive && value > 0.0) || (key.allowed == range::above_one && value > 1.0));
  if (good) return;
  const std::string_view wanted = key.allowed == range::any            ? "finite"
                                  : key.allowed == range::not_negative ? "finite and not negative"
                                  : key.allowed == range::positive     ? "finite and positive"
                                                                       : "finite and above 1";
  foundation::fail_input(
      fmt::format("equation of state '{}': {} = {} {} must be {}", name, key.key, value, key.unit, wanted));
}

[[noreturn]] void refuse(const material_options& own, std::string_view key) {
  std::vector<std::string_view> keys;
  if (!own.curve.empty()) keys.push_back("curve");
  if (!own.tillotson.empty()) keys.push_back("tillotson");
  for (const parameter& p : parameters)
    if (own.*p.member) keys.push_back(p.key);
  foundation::fail_input(
      fmt::format("equation of state '{}' has no parameter {}; it takes {}", own.name, key, fmt::join(keys, ", ")));
}

}  // namespace

const std::vector<std::string_view>& names() {
  static const std::vector<std::string_view> all{"linear",    "liquid_iron", "liquid_iron_isentrope", "liquid_silicate",
                                                 "tillotson", "ideal_gas",   "stiffened_gas"};
  return all;
}

material_options resolve(const material_options& given) {
  material_options o = defaults(given.name, given.tillotson);
  if (!given.tillotson.empty() && o.tillotson.empty()) refuse(o, "tillotson");
  if (!given.curve.empty()) {
    if (o.curve.empty()) refuse(o, "curve");
    if (given.curve != vinet::name && given.curve != birch_murnaghan::name)
      foundation::fail_input(fmt::format("equation of state '{}': there is no curve '{}': choose {} or {}", o.name,
                                         given.curve, vinet::name, birch_murnaghan::name));
    o.curve = given.curve;
  }
  for (const parameter& key : parameters) {
    const std::optional<double>& value = given.*key.member;
    if (!value) continue;
    if (!(o.*key.member)) refuse(o, key.key);
    check_range(o.name, key, *value);
    o.*key.member = value;
  }
  return o;
}

std::vector<std::string_view> changed(const material_options& resolved) {
  const material_options own = defaults(resolved.name, resolved.tillotson);
  std::vector<std::string_view> keys;
  for (const parameter& key : parameters)
    if (resolved.*key.member != own.*key.member) keys.push_back(key.key);
  return keys;
}

}  // namespace tetsuame::eos
