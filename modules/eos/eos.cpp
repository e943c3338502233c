#include <fmt/core.h>
#include <fmt/ranges.h>

#include <cmath>
#include <eos/eos.hpp>
#include <foundation/error.hpp>
#include <utility>

namespace tetsuame::eos {

namespace {

constexpr double gas_constant = 8.314462618;   // J/(mol K), CODATA 2018
constexpr double molar_mass_iron = 55.845e-3;  // kg/mol

// An equation of state as the input names it.
struct entry {
  material_options defaults;  // sources: docs/theory/eos.md
  std::string source;
  any (*build)(const material_options&, const description&);
  bool illustrative = false;
};

any build_linear(const material_options& o, const description& about) {
  return linear{about,           *o.reference_pressure,  *o.reference_density,
                *o.bulk_modulus, *o.thermal_expansivity, *o.reference_temperature,
                *o.heat_capacity};
}

any build_liquid(const material_options& o, const description& about) {
  const thermal_part thermal{*o.reference_temperature,
                             *o.gruneisen,
                             *o.gruneisen_exponent,
                             *o.heat_capacity,
                             o.electronic_coefficient.value_or(0.0),
                             o.electronic_exponent.value_or(0.0)};
  if (o.curve == birch_murnaghan::name)
    return liquid<birch_murnaghan>{about, *o.reference_pressure, *o.reference_density,
                                   birch_murnaghan::third_order(*o.bulk_modulus, *o.bulk_modulus_derivative), thermal};
  return liquid<vinet>{
      about, *o.reference_pressure, *o.reference_density, {*o.bulk_modulus, *o.bulk_modulus_derivative}, thermal};
}

any build_isentropic_liquid(const material_options& o, const description& about) {
  return isentropic_liquid{
      about,
      *o.reference_pressure,
      *o.reference_density,
      *o.reference_temperature,
      birch_murnaghan::fourth_order(*o.bulk_modulus, *o.bulk_modulus_derivative, *o.bulk_modulus_second_derivative),
      *o.gruneisen,
      *o.gruneisen_exponent,
      *o.heat_capacity};
}

any build_tillotson(const material_options& o, const description& about) {
  return tillotson(about, find_tillotson(o.tillotson), *o.reference_temperature, *o.heat_capacity);
}

any build_stiffened_gas(const material_options& o, const description& about) {
  return stiffened_gas{about, *o.gamma, o.p_infinity.value_or(0.0), *o.heat_capacity};
}

std::vector<entry> liquids() {
  return {{{.name = "linear",
            .reference_pressure = 1e5,
            .reference_density = 7000.0,
            .reference_temperature = 2500.0,
            .bulk_modulus = 100e9,
            .thermal_expansivity = 2.5e-5,
            .heat_capacity = 1000.0},
           "linear in density and temperature",
           build_linear},
          {{.name = "liquid_iron",
            .reference_pressure = 1e5,
            .reference_density = 7030.0,
            .reference_temperature = 1811.0,
            .bulk_modulus = 82.1e9,
            .bulk_modulus_derivative = 5.80,
            .heat_capacity = 3.0 * gas_constant / molar_mass_iron,
            .gruneisen = 2.02,
            .gruneisen_exponent = 0.63,
            .electronic_coefficient = 0.68e-4,
            .electronic_exponent = -1.0},
           "Y. Kuwayama et al., Phys. Rev. Lett. 124, 165701 (2020)",
           build_liquid},
          {{.name = "liquid_iron_isentrope",
            .reference_pressure = 1e5,
            .reference_density = 7019.0,
            .reference_temperature = 1811.0,
            .bulk_modulus = 109.7e9,
            .bulk_modulus_derivative = 4.66,
            .bulk_modulus_second_derivative = -0.043e-9,
            .heat_capacity = 640.0,  // c_p = 46.02 J/(mol K) over 1 + alpha gamma T = 1.287
            .gruneisen = 1.735,
            .gruneisen_exponent = 0.2},
           "W. W. Anderson, T. J. Ahrens, J. Geophys. Res. 99, 4273 (1994)",
           build_isentropic_liquid},
          {{.name = "liquid_silicate",
            .curve = vinet::name,
            .reference_pressure = 1e5,
            .reference_density = 2700.0,
            .reference_temperature = 2500.0,
            .bulk_modulus = 25e9,
            .bulk_modulus_derivative = 6.0,
            .heat_capacity = 1500.0,
            .gruneisen = 0.6,
            .gruneisen_exponent = -1.0},
           "illustrative parameters of unverified origin",
           build_liquid,
           true}};
}

std::vector<entry> solids_and_gases() {
  return {{{.name = "tillotson",
            .tillotson = "iron",
            .reference_temperature = 300.0,
            .heat_capacity = find_tillotson("iron").c_V},
           "H. J. Melosh, Impact Cratering (1989); W. Benz, E. Asphaug, Icarus 142, 5 (1999); ",
           build_tillotson},
          {{.name = "ideal_gas", .heat_capacity = 717.5, .gamma = 1.4}, "ideal gas", build_stiffened_gas},  // air
          // Water: c_V so that 1000 kg/m^3 has 1e5 Pa at 300 K.
          {{.name = "stiffened_gas",
            .heat_capacity = (1e5 + 6e8) / (3.4 * 1000.0 * 300.0),
            .gamma = 4.4,
            .p_infinity = 6e8},
           "stiffened gas, F. H. Harlow, A. A. Amsden, LA-4700 (1971)",
           build_stiffened_gas}};
}

const std::vector<entry>& catalogue() {
  static const std::vector<entry> all = [] {
    auto list = liquids();
    for (auto& one : solids_and_gases()) list.push_back(std::move(one));
    return list;
  }();
  return all;
}

const entry& find(std::string_view name) {
  for (const entry& one : catalogue())
    if (one.defaults.name == name) return one;
  foundation::fail_input(
      fmt::format("there is no equation of state '{}': choose one of {}", name, fmt::join(names(), ", ")));
}

material_options defaults(const material_options& given) {
  material_options o = find(given.name).defaults;
  if (!o.tillotson.empty() && !given.tillotson.empty()) {
    o.heat_capacity = find_tillotson(given.tillotson).c_V;
    o.tillotson = given.tillotson;
  }
  return o;
}

void check_range(const std::string& name, const parameter& key, double value) {
  using enum parameter::range;
  const auto [wanted, holds] = key.allowed == not_negative ? std::pair{"finite and not negative", value >= 0.0}
                               : key.allowed == positive   ? std::pair{"finite and positive", value > 0.0}
                               : key.allowed == above_one  ? std::pair{"finite and above 1", value > 1.0}
                                                           : std::pair{"finite", true};
  if (!(holds && std::isfinite(value)))
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
  static const std::vector<std::string_view> all = [] {
    std::vector<std::string_view> result;
    for (const entry& one : catalogue()) result.emplace_back(one.defaults.name);
    return result;
  }();
  return all;
}

material_options resolve(const material_options& given) {
  material_options o = defaults(given);
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

any make(const material_options& options) {
  const material_options o = resolve(options), own = defaults(o);
  const entry& type = find(o.name);
  std::vector<std::string_view> changed;
  for (const parameter& key : parameters)
    if (o.*key.member != own.*key.member) changed.push_back(key.key);
  std::string source = type.source + o.tillotson;
  if (!changed.empty()) source += fmt::format("; changed in the input: {}", fmt::join(changed, ", "));
  return type.build(o, {o.name, source, type.illustrative});
}

const description& about(const any& material) {
  return std::visit([](const auto& m) -> const description& { return m.about; }, material);
}

double pressure(const any& material, double rho, double T) { return evaluate(material, rho, T).p; }

double density(const any& material, double p, double T) {
  return std::visit([&](const auto& m) { return m.density(p, T); }, material);
}

properties evaluate(const any& material, double rho, double T) {
  return std::visit([&](const auto& m) { return m.evaluate(rho, T); }, material);
}

}  // namespace tetsuame::eos
