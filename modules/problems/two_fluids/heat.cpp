#include <theory/partition.hpp>
#include <theory/stefan.hpp>
#include <two_fluids/groups.hpp>

namespace tetsuame::two_fluids {

void declare(namelist::schema& schema, melting_options& o) {
  schema.group("melting", "of the lower (outer) material, where temperature_law is 'enthalpy'");
  schema.add("melting", "curve", o.curve,
             {.choices = {"none", "mantle", "constant"},
              .meaning = "solidus and liquidus: it never melts, fits for the mantle by pressure, or two temperatures"});
  schema.add("melting", "composition", o.composition,
             {.choices = {"peridotitic", "chondritic"},
              .expert = true,
              .meaning = "curve 'mantle': of the liquidus above 20 GPa"});
  schema.add("melting", "solidus", o.solidus, for_expert(positive("K", "curve 'constant'")));
  schema.add("melting", "liquidus", o.liquidus, for_expert(positive("K", "curve 'constant'")));
  schema.add("melting", "latent_heat", o.latent_heat, for_expert(not_negative("J/kg", "of fusion")));
  schema.add("melting", "viscosity_law", o.viscosity_law,
             {.choices = {"constant", "blended", "suspension"},
              .meaning = "the material's one viscosity; or by temperature and melt fraction, smooth or with the "
                         "crystals' sudden lock at 0.4"});
  schema.add("melting", "viscosity_min", o.viscosity_min,
             for_expert(positive("Pa s", "the law's viscosity is not below this")));
  schema.add("melting", "viscosity_max", o.viscosity_max, for_expert(positive("Pa s", "nor above this")));
  schema.add("melting", "inertia_viscosity", o.inertia_viscosity,
             for_expert(not_negative("Pa s",
                                     "what is more viscous gets its inertia raised by the ratio, so that steps need "
                                     "not follow it (0: inertia as it is)")));
}

void declare(namelist::schema& schema, element_options& o) {
  schema.group("element", "dissolved in metal and silicate, exchanged at their contact");
  schema.add("element", "name", o.name,
             {.choices = {"none", "constant", "nickel", "cobalt"},
              .meaning = "whose partition coefficient: none, a constant one, or by pressure and temperature (Rubie et "
                         "al. 2015)"});
  schema.add("element", "partition_coefficient", o.partition_coefficient,
             for_expert(positive("1", "'constant': metal over silicate at equilibrium")));
  schema.add(
      "element", "iron_ratio", o.iron_ratio,
      for_expert(positive("1", "nickel, cobalt: mole fraction of Fe in the metal over that of FeO in the silicate")));
  schema.add("element", "diffusivity_silicate", o.diffusivity_silicate,
             for_expert(positive("m^2/s", "of the element")));
  schema.add("element", "diffusivity_metal", o.diffusivity_metal, for_expert(positive("m^2/s", "of the element")));
  schema.add("element", "concentration_silicate", o.concentration_silicate,
             {.minimum = 0.0, .expert = true, .meaning = "at the start, amount per mass, in a unit of choice"});
  schema.add("element", "concentration_metal", o.concentration_metal,
             {.minimum = 0.0, .expert = true, .meaning = "at the start, in the same unit"});
}

void check_element(const namelist::schema& schema, const element_options& o) {
  if (o.name == "none")
    refuse(schema, "element",
           {"diffusivity_silicate", "diffusivity_metal", "concentration_silicate", "concentration_metal"},
           "there is no element: name is 'none'");
  else if (!(o.concentration_silicate + o.concentration_metal > 0.0))
    schema.fail("element", "concentration_silicate", "there is nothing of the element in either material");
  if (o.name != "constant") refuse(schema, "element", {"partition_coefficient"}, "belongs to name = 'constant'");
  if (o.name == "none" || o.name == "constant") refuse(schema, "element", {"iron_ratio"}, "belongs to a named element");
}

// Temperatures at the start of the enthalpy law, and what else belongs to it alone.
void find_heat(const namelist::schema& schema, problem_kind kind, options& o, parameters& p) {
  const char* group = group_of(kind);
  const auto names = names_of(kind);
  auto& m = o.melting;
  const bool enthalpy = o.temperature_law == "enthalpy";
  for (const std::size_t n : {0, 1}) {  // those of &material: materials.cpp
    const std::string key = std::string("temperature_") + names[n];
    if (!enthalpy && o.material[n].temperature) schema.fail(group, key, "belongs to temperature_law = 'enthalpy'");
    if (enthalpy && o.material[n].eos != "linear")
      schema.fail(group, std::string("eos_") + names[n],
                  "with temperature_law = 'enthalpy' pressure must not depend on temperature: 'linear' only");
  }
  for (const auto& of : o.material) p.temperature.push_back(of.temperature.value_or(o.temperature));
  p.cover_temperature = o.cover_temperature.value_or(o.temperature);
  if (!enthalpy && (o.pond_top || o.cover_temperature))
    schema.fail(group, o.pond_top ? "pond_top" : "cover_temperature", "belongs to temperature_law = 'enthalpy'");
  if (o.cover_temperature && !o.pond_top)
    schema.fail(group, "cover_temperature", "nothing covers the pond: no pond_top");
  if (m.curve == "none") {
    std::vector<std::string> keys{"solidus",       "liquidus",          "viscosity_min",
                                  "viscosity_max", "inertia_viscosity", "composition"};
    if (m.latent_heat != 0.0) keys.emplace_back("latent_heat");
    if (m.viscosity_law != "constant") keys.emplace_back("viscosity_law");
    refuse(schema, "melting", keys, "nothing melts: curve is 'none'");
    m.viscosity_law = "constant";
    m.latent_heat = 0.0;
    return;
  }
  if (!enthalpy) schema.fail("melting", "curve", std::string("&") + group + " temperature_law must be 'enthalpy'");
  if (m.curve == "constant" && !(m.liquidus > m.solidus))
    schema.fail("melting", "liquidus", "must be above the solidus");
  if (m.curve == "mantle") refuse(schema, "melting", {"solidus", "liquidus"}, "curve 'mantle' has one of its own");
  if (m.viscosity_max < m.viscosity_min) schema.fail("melting", "viscosity_max", "is below viscosity_min");
  if (m.viscosity_law == "constant")
    refuse(schema, "melting", {"viscosity_min", "viscosity_max"}, "viscosity_law is 'constant'");
}

// Heat conducted across a flat contact at rest: two half spaces, as long as the heat has not reached floor and lid.
void find_melt(const options& o, parameters& p) {
  const double pressure = p.base->at(p.interface).pressure;
  const auto [T_s, T_l] = melting_range(o.melting, pressure);
  if (!(T_s < T_l))
    foundation::fail_input(fmt::format(
        "the fits for the mantle are none at {:.4g} Pa, the interface's pressure: solidus {:.6g} K, liquidus {:.6g} K",
        pressure, T_s, T_l));
  if (o.pond_top || o.material.size() > 2 || !(o.conductivity_of(0) > 0.0 && o.conductivity_of(1) > 0.0)) return;
  if (!(p.temperature[1] > p.temperature[0] && p.temperature[0] <= T_s)) return;
  const auto side = [&](std::size_t n) {
    const double y = p.interface * (n == 0 ? 1.0 - 1e-12 : 1.0);
    const auto e = eos::evaluate((*p.material)[n], p.base->at(y).density, o.temperature);
    return theory::half_space{p.base->at(y).density, e.c_V, o.conductivity_of(n), p.temperature[n]};
  };
  const auto s = theory::solve({side(1), side(0), T_s, T_l, o.melting.latent_heat});
  p.melt_conducted = s.melt_thickness(o.common.time.end()) / p.interface;
}

std::array<double, 2> melting_range(const melting_options& o, double p) {
  if (o.curve == "constant") return {o.solidus, o.liquidus};
  const double above = std::max(p, 0.0);  // the fits' range; sound may take the top below
  return {melting::solidus(above), melting::liquidus(o.composition == "chondritic" ? melting::composition::chondritic
                                                                                   : melting::composition::peridotitic,
                                                     above)};
}

double partition_coefficient(const element_options& o, double p, double T) {
  if (o.name == "constant") return o.partition_coefficient;
  return theory::partition_coefficient(o.name == "nickel" ? theory::nickel : theory::cobalt, p, T, o.iron_ratio);
}

double viscosity_by_melt(const melting_options& o, double T, double melt_fraction) {
  // The laws' liquid has a pole at 1000 K, far below every solidus: there all is solid.
  const double eta = T < 1100.0                     ? melting::solid_viscosity(T)
                     : o.viscosity_law == "blended" ? melting::blended_viscosity(T, melt_fraction)
                                                    : melting::suspension_viscosity(T, melt_fraction);
  return std::clamp(eta, o.viscosity_min, o.viscosity_max);
}

}  // namespace tetsuame::two_fluids
