#include <theory/stefan.hpp>
#include <two_fluids/groups.hpp>

namespace tetsuame::two_fluids {

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
  if (m.melts() && !enthalpy)
    schema.fail("melting", "curve", std::string("&") + group + " temperature_law must be 'enthalpy'");
  melting::check(schema, m);
}

// Heat conducted across a flat contact at rest: two half spaces, as long as the heat has not reached floor and lid.
void find_melt(const options& o, parameters& p) {
  const double pressure = p.base->at(p.interface).pressure;
  const auto [T_s, T_l] = melting::range(o.melting, pressure);
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

}  // namespace tetsuame::two_fluids
