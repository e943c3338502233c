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

// c_V of Tillotson's materials is no part of his fits: values of the solids near room temperature.
double tillotson_heat_capacity(const std::string& material) {
  return material == "iron" ? 449.0 : material == "granite" ? 790.0 : 840.0;
}

// Sources: docs/theory/eos.md.
material_options defaults(const std::string& name, const std::string& tillotson_material) {
  if (name == "linear")
    return {.name = name,
            .reference_pressure = 1e5,
            .reference_density = 7000.0,
            .reference_temperature = 2500.0,
            .bulk_modulus = 100e9,
            .thermal_expansivity = 2.5e-5,
            .heat_capacity = 1000.0};
  if (name == "liquid_iron")
    return {.name = name,
            .reference_pressure = 1e5,
            .reference_density = 7030.0,
            .reference_temperature = 1811.0,
            .bulk_modulus = 82.1e9,
            .bulk_modulus_derivative = 5.80,
            .heat_capacity = 3.0 * gas_constant / molar_mass_iron,
            .gruneisen = 2.02,
            .gruneisen_exponent = 0.63,
            .electronic_coefficient = 0.68e-4,
            .electronic_exponent = -1.0};
  if (name == "liquid_iron_isentrope")
    return {.name = name,
            .reference_pressure = 1e5,
            .reference_density = 7019.0,
            .reference_temperature = 1811.0,
            .bulk_modulus = 109.7e9,
            .bulk_modulus_derivative = 4.66,
            .bulk_modulus_second_derivative = -0.043e-9,
            .heat_capacity = 640.0,  // c_p = 46.02 J/(mol K) over 1 + alpha gamma T = 1.287
            .gruneisen = 1.735,
            .gruneisen_exponent = 0.2};
  if (name == "liquid_silicate")
    return {.name = name,
            .curve = vinet::name,
            .reference_pressure = 1e5,
            .reference_density = 2700.0,
            .reference_temperature = 2500.0,
            .bulk_modulus = 25e9,
            .bulk_modulus_derivative = 6.0,
            .heat_capacity = 1500.0,
            .gruneisen = 0.6,
            .gruneisen_exponent = -1.0};
  if (name == "tillotson") {
    const std::string material = tillotson_material.empty() ? "iron" : tillotson_material;
    find_tillotson(material);
    return {.name = name,
            .tillotson = material,
            .reference_temperature = 300.0,
            .heat_capacity = tillotson_heat_capacity(material)};
  }
  if (name == "ideal_gas") return {.name = name, .heat_capacity = 717.5, .gamma = 1.4};  // air
  // Water: c_V so that 1000 kg/m^3 has 1e5 Pa at 300 K.
  if (name == "stiffened_gas")
    return {.name = name, .heat_capacity = (1e5 + 6e8) / (3.4 * 1000.0 * 300.0), .gamma = 4.4, .p_infinity = 6e8};
  foundation::fail_input(
      fmt::format("there is no equation of state '{}': choose one of {}", name, fmt::join(names(), ", ")));
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
