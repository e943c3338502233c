#include <fmt/format.h>

#include <algorithm>
#include <convection/resolve.hpp>

namespace tetsuame::convection {

namespace {

eos::material_options material_of(const options& o, const relaxation::fluid_layer& f) {
  eos::material_options m;
  m.name = o.convection.eos;
  if (m.name != "linear") return m;
  m.reference_pressure = o.convection.p_top;
  m.reference_density = f.rho;
  m.reference_temperature = o.temperature_top();
  m.bulk_modulus = f.K;
  m.thermal_expansivity = f.alpha;
  m.heat_capacity = o.physics.material.heat_capacity;
  return m;
}

constexpr int places = 100;  // over the height

// Smallest and largest heat capacity, J/(kg K): it follows the pressure where what rises cools.
std::pair<double, double> heat_capacities(const options& o, const parameters& p) {
  const double c_p = o.physics.material.heat_capacity, T_top = o.temperature_top(), T_bottom = o.temperature_bottom();
  double least = c_p, most = c_p;
  for (int k = 0; k <= places && o.convection.adiabatic_heating; ++k)
    for (const double T : {T_top, 0.5 * (T_top + T_bottom), T_bottom}) {
      const double here = c_p + p.weighed->heat_capacity_change(p.fluid.L * k / places, T);
      least = std::min(least, here), most = std::max(most, here);
    }
  return {least, most};
}

}  // namespace

void resolve_gravity(const namelist::schema& schema, const options& o, parameters& p) {
  const auto& c = o.convection;
  const auto& f = p.fluid;
  const double c_p = o.physics.material.heat_capacity, T_top = o.temperature_top(), T_bottom = o.temperature_bottom();
  p.dissipation_number = f.alpha * f.g * f.L / c_p;
  if (c.gravity_density != "equation_of_state") return;
  if (!(T_top > 0.0))
    schema.fail("convection", "gravity_density",
                "an equation of state needs absolute temperatures: that of the top must be above 0 K");
  const auto material = schema.placed("convection", "eos", [&] { return eos::make(material_of(o, f)); });
  p.weighed = schema.placed("convection", "eos", [&] {
    return std::make_shared<gravity_density>(material,
                                             gravity_density::layer{f.L, f.g, f.rho, c.p_top, T_top, T_bottom});
  });
  const auto& w = *p.weighed;
  double mean = 0.0;
  for (int k = 0; k < places; ++k) {
    const double y = f.L * (k + 0.5) / places;
    mean += w.slope(y, w.temperature(y)) / places;
  }
  p.dissipation_number = mean * f.L / c_p;
  const auto [least, most] = heat_capacities(o, p);
  if (!(least > 0.0))
    schema.fail("convection", "eos",
                fmt::format("with this equation of state the heat capacity would fall to {:.4g} J/(kg K): give a "
                            "larger heat_capacity, or leave adiabatic_heating",
                            least));
  p.lines.push_back(fmt::format(
      "gravity feels the density of {}: at rest {:.4g} to {:.4g} kg/m3, {:.4g} to {:.4g} Pa, adiabat {:.4g} to {:.4g} "
      "K, expansivity {:.3g} to {:.3g} 1/K from top to bottom; heat capacity {:.4g} to {:.4g} J/(kg K); dissipation "
      "number {:.4g}",
      eos::about(material).name, w.density(f.L), w.density(0.0), w.pressure(f.L), w.pressure(0.0), w.temperature(f.L),
      w.temperature(0.0), w.expansivity(f.L), w.expansivity(0.0), least, most, p.dissipation_number));
}

}  // namespace tetsuame::convection
