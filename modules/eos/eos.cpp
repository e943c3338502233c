#include <fmt/core.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <eos/eos.hpp>
#include <filesystem>
#include <foundation/error.hpp>
#include <utility>

namespace tetsuame::eos {

namespace {

constexpr double gas_constant = 8.314462618;   // J/(mol K), CODATA 2018
constexpr double molar_mass_iron = 55.845e-3;  // kg/mol
constexpr double molar_mass_MgSiO3 = 100.389e-3;
constexpr double atoms_MgSiO3 = 5.0;
constexpr double avogadro = 6.02214076e23;                                // 1/mol, exact
constexpr double electron_volt = 1.602176634e-19;                         // J, exact
constexpr double melt_gamma_slope = -1.94;                                // V d gamma/dV at rho0, Wolf and Bower
constexpr std::array<double, 5> melt_b{0.9821, 0.615, 1.31, -3.0, -4.1};  // eV an atom, Wolf and Bower

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
  if (!(*o.complete_energy > *o.incipient_energy))
    foundation::fail_input(
        fmt::format("equation of state 'tillotson': complete_energy = {:g} J/kg must be above "
                    "incipient_energy = {:g} J/kg",
                    *o.complete_energy, *o.incipient_energy));
  const tillotson_parameters own{find_tillotson(o.tillotson).material,
                                 *o.reference_density,
                                 *o.bulk_modulus,
                                 *o.nonlinear_modulus,
                                 *o.tillotson_a,
                                 *o.tillotson_b,
                                 *o.tillotson_energy,
                                 *o.incipient_energy,
                                 *o.complete_energy,
                                 *o.tillotson_alpha,
                                 *o.tillotson_beta,
                                 *o.heat_capacity};
  return tillotson(about, own, *o.reference_temperature, *o.heat_capacity);
}

// Dewaele and others: gamma and the terms in T^2 after the calculations of Alfe, Price and Gillan.
any build_iron_hcp(const material_options& o, const description& about) {
  const double gamma0 = *o.gruneisen, limit = 1.305;
  return debye_solid{about,
                     *o.reference_density,
                     *o.reference_temperature,
                     gas_constant / molar_mass_iron,
                     vinet{*o.bulk_modulus, *o.bulk_modulus_derivative},
                     altshuler{*o.debye_temperature, gamma0, limit, gamma0 / (gamma0 - limit)},
                     {3.7e-5, 1.87},
                     {1.95e-4, 1.339}};
}

any build_MgSiO3_solid(const material_options& o, const description& about) {
  return debye_solid{about,
                     *o.reference_density,
                     *o.reference_temperature,
                     atoms_MgSiO3 * gas_constant / molar_mass_MgSiO3,
                     birch_murnaghan::third_order(*o.bulk_modulus, *o.bulk_modulus_derivative),
                     finite_strain{*o.debye_temperature, *o.gruneisen, *o.gruneisen * *o.gruneisen_exponent},
                     {0.0, 0.0},
                     {0.0, 0.0}};
}

any build_MgSiO3_melt(const material_options& o, const description& about) {
  auto b = melt_b;
  for (double& of : b) of *= atoms_MgSiO3 * avogadro * electron_volt / molar_mass_MgSiO3;
  return rosenfeld_tarazona{about,
                            *o.reference_density,
                            *o.reference_temperature,
                            atoms_MgSiO3 * gas_constant / molar_mass_MgSiO3,
                            {*o.bulk_modulus, *o.bulk_modulus_derivative},
                            {*o.reference_temperature, *o.gruneisen, melt_gamma_slope},
                            0.6,
                            b};
}

any build_table(const material_options& o, const description& about) {
  const table_data data = read_table(o.table);
  tabulated material(about, data);
  const auto& r = material.reach();
  material.about.source = fmt::format("{} '{}', {} densities {:g} to {:g} kg/m^3, {} temperatures {:g} to {:g} K",
                                      std::filesystem::path(o.table).filename().string(), data.title, data.rho.size(),
                                      r.rho_low, r.rho_high, data.T.size(), r.T_low, r.T_high);
  if (material.lowered() > 0)
    material.about.source +=
        fmt::format("; energy that fell with temperature made level at {} nodes", material.lowered());
  return material;
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
           true},
          {{.name = "liquid_mgsio3",
            .reference_density = molar_mass_MgSiO3 / (12.949e-30 * atoms_MgSiO3 * avogadro),
            .reference_temperature = 3000.0,
            .bulk_modulus = 13.2e9,
            .bulk_modulus_derivative = 8.238,
            .gruneisen = 0.1899},
           "liquid MgSiO3, A. S. Wolf, D. J. Bower, Phys. Earth Planet. Inter. 278, 59 (2018)",
           build_MgSiO3_melt}};
}

std::vector<entry> crystals() {
  return {{{.name = "iron_hcp",
            .reference_density = molar_mass_iron / (11.214e-30 * avogadro),
            .reference_temperature = 300.0,
            .bulk_modulus = 163.4e9,
            .bulk_modulus_derivative = 5.38,
            .gruneisen = 1.875,
            .debye_temperature = 417.0},
           "hcp iron, A. Dewaele et al., Phys. Rev. Lett. 97, 215504 (2006)",
           build_iron_hcp},
          {{.name = "bridgmanite",
            .reference_density = molar_mass_MgSiO3 / 24.45e-6,
            .reference_temperature = 300.0,
            .bulk_modulus = 251e9,
            .bulk_modulus_derivative = 4.1,
            .gruneisen = 1.57,
            .gruneisen_exponent = 1.1,
            .debye_temperature = 905.0},
           "MgSiO3 perovskite, L. Stixrude, C. Lithgow-Bertelloni, Geophys. J. Int. 184, 1180 (2011)",
           build_MgSiO3_solid},
          {{.name = "post_perovskite",
            .reference_density = molar_mass_MgSiO3 / 24.42e-6,
            .reference_temperature = 300.0,
            .bulk_modulus = 231e9,
            .bulk_modulus_derivative = 4.0,
            .gruneisen = 1.89,
            .gruneisen_exponent = 1.1,
            .debye_temperature = 855.0},
           "MgSiO3 post-perovskite, L. Stixrude, C. Lithgow-Bertelloni, Geophys. J. Int. 184, 1180 (2011)",
           build_MgSiO3_solid}};
}

std::vector<entry> solids_and_gases() {
  return {{{.name = "tillotson", .tillotson = "iron", .reference_temperature = 300.0},
           "H. J. Melosh, Impact Cratering (1989); W. Benz, E. Asphaug, Icarus 142, 5 (1999); ",
           build_tillotson},
          {{.name = "ideal_gas", .heat_capacity = 717.5, .gamma = 1.4}, "ideal gas", build_stiffened_gas},  // air
          // Water: c_V so that 1000 kg/m^3 has 1e5 Pa at 300 K.
          {{.name = "stiffened_gas",
            .heat_capacity = (1e5 + 6e8) / (3.4 * 1000.0 * 300.0),
            .gamma = 4.4,
            .p_infinity = 6e8},
           "stiffened gas, F. H. Harlow, A. A. Amsden, LA-4700 (1971)",
           build_stiffened_gas},
          {{.name = "table"}, "a file", build_table}};
}

const std::vector<entry>& catalogue() {
  static const std::vector<entry> all = [] {
    auto list = liquids();
    for (auto part : {crystals(), solids_and_gases()})
      for (auto& one : part) list.push_back(std::move(one));
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
  if (!o.tillotson.empty()) {
    if (!given.tillotson.empty()) o.tillotson = given.tillotson;
    const tillotson_parameters& m = find_tillotson(o.tillotson);
    o.reference_density = m.rho0, o.bulk_modulus = m.A, o.nonlinear_modulus = m.B;
    o.tillotson_a = m.a, o.tillotson_b = m.b, o.tillotson_energy = m.E0;
    o.incipient_energy = m.E_iv, o.complete_energy = m.E_cv;
    o.tillotson_alpha = m.alpha, o.tillotson_beta = m.beta, o.heat_capacity = m.c_V;
  }
  if (o.name == "table") o.table = given.table;
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
  if (own.name == "table") keys.push_back("table");
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
  if (!given.table.empty() && o.table.empty()) refuse(o, "table");
  if (o.name == "table" && o.table.empty())
    foundation::fail_input("equation of state 'table' needs a file: give table = its path");
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
