#include <fmt/core.h>
#include <fmt/ranges.h>

#include <eos/eos.hpp>

namespace tetsuame::eos {

namespace {

description describe(const material_options& o, std::string source, bool illustrative = false) {
  const auto keys = changed(o);
  if (!keys.empty()) source += fmt::format("; changed in the input: {}", fmt::join(keys, ", "));
  return {o.name, std::move(source), illustrative};
}

thermal_part thermal_of(const material_options& o) {
  return {*o.reference_temperature,
          *o.gruneisen,
          *o.gruneisen_exponent,
          *o.heat_capacity,
          o.electronic_coefficient.value_or(0.0),
          o.electronic_exponent.value_or(0.0)};
}

any make_liquid(const material_options& o, const description& about) {
  if (o.curve == birch_murnaghan::name)
    return liquid<birch_murnaghan>{about, *o.reference_pressure, *o.reference_density,
                                   birch_murnaghan::third_order(*o.bulk_modulus, *o.bulk_modulus_derivative),
                                   thermal_of(o)};
  return liquid<vinet>{
      about, *o.reference_pressure, *o.reference_density, {*o.bulk_modulus, *o.bulk_modulus_derivative}, thermal_of(o)};
}

}  // namespace

any make(const material_options& options) {
  const material_options o = resolve(options);
  if (o.name == "linear")
    return linear{describe(o, "linear in density and temperature"),
                  *o.reference_pressure,
                  *o.reference_density,
                  *o.bulk_modulus,
                  *o.thermal_expansivity,
                  *o.reference_temperature,
                  *o.heat_capacity};
  if (o.name == "liquid_iron")
    return make_liquid(o, describe(o, "Y. Kuwayama et al., Phys. Rev. Lett. 124, 165701 (2020)"));
  if (o.name == "liquid_iron_isentrope")
    return isentropic_liquid{
        describe(o, "W. W. Anderson, T. J. Ahrens, J. Geophys. Res. 99, 4273 (1994)"),
        *o.reference_pressure,
        *o.reference_density,
        *o.reference_temperature,
        birch_murnaghan::fourth_order(*o.bulk_modulus, *o.bulk_modulus_derivative, *o.bulk_modulus_second_derivative),
        *o.gruneisen,
        *o.gruneisen_exponent,
        *o.heat_capacity};
  if (o.name == "liquid_silicate")
    return make_liquid(o, describe(o, "illustrative parameters of unverified origin", true));
  if (o.name == "tillotson")
    return tillotson(
        describe(o, "H. J. Melosh, Impact Cratering (1989); W. Benz, E. Asphaug, Icarus 142, 5 (1999); " + o.tillotson),
        find_tillotson(o.tillotson), *o.reference_temperature, *o.heat_capacity);
  if (o.name == "ideal_gas") return stiffened_gas{describe(o, "ideal gas"), *o.gamma, 0.0, *o.heat_capacity};
  return stiffened_gas{describe(o, "stiffened gas, F. H. Harlow, A. A. Amsden, LA-4700 (1971)"), *o.gamma,
                       *o.p_infinity, *o.heat_capacity};
}

const description& about(const any& material) {
  return std::visit([](const auto& m) -> const description& { return m.about; }, material);
}

double pressure(const any& material, double rho, double T) {
  return std::visit([&](const auto& m) { return m.pressure(rho, T); }, material);
}

double density(const any& material, double p, double T) {
  return std::visit([&](const auto& m) { return m.density(p, T); }, material);
}

properties evaluate(const any& material, double rho, double T) {
  return std::visit([&](const auto& m) { return m.evaluate(rho, T); }, material);
}

}  // namespace tetsuame::eos
