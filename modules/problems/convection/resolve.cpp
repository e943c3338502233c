// What of gravity and viscosity the input leaves open; slowing: resolve_slowing.cpp.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <convection/options.hpp>
#include <melting/melting.hpp>

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

// Pressure of a column at rest, Pa.
double pressure_at(const options& o, const parameters& p, double depth) {
  if (p.weighed) return p.weighed->pressure(p.fluid.L - depth);
  return o.convection.p_top + p.fluid.rho * p.fluid.g * depth;
}

std::vector<double> evenly(double first, double last, std::size_t steps) {
  std::vector<double> all;
  for (std::size_t k = 0; k <= steps; ++k)
    all.push_back(std::lerp(first, last, static_cast<double>(k) / static_cast<double>(steps)));
  return all;
}

// Melt fraction f between solidus and liquidus, a suspension (melting/melting.hpp).
viscosity_table by_melt(const options& o, const parameters& p) {
  const auto& c = o.convection;
  const auto kind =
      c.composition == "chondritic" ? melting::composition::chondritic : melting::composition::peridotitic;
  const double T_top = o.temperature_top(), T_bottom = o.temperature_bottom();
  const double beyond = 0.1 * std::abs(T_bottom - T_top);
  const double coldest = std::max(std::min(T_top, T_bottom) - beyond, 1.0),
               hottest = std::max(T_top, T_bottom) + beyond;
  return {evenly(coldest, hottest, 512), evenly(0.0, p.fluid.L, 256), [&](double T, double depth) {
            const double P = pressure_at(o, p, depth);
            const double f = melting::melt_fraction(T, melting::solidus(P), melting::liquidus(kind, P));
            return std::clamp(melting::suspension_viscosity(T, f), c.viscosity_min, c.viscosity_max);
          }};
}

viscosity_table from_file(const namelist::schema& schema, const options& o, double L) {
  const auto& c = o.convection;
  if (c.viscosity_file.empty())
    schema.fail("convection", "viscosity_file", "viscosity_law = 'table' needs the name of its file");
  auto table = schema.placed("convection", "viscosity_file", [&] { return viscosity_table::read(c.viscosity_file); });
  for (const double T : {o.temperature_top(), o.temperature_bottom()})
    for (const double depth : {0.0, L})
      if (!table.covers(T, depth))
        schema.fail("convection", "viscosity_file",
                    fmt::format("'{}' has {} to {} K and {} to {} m; the layer has {} K and a depth of {} m",
                                c.viscosity_file, table.temperatures().front(), table.temperatures().back(),
                                table.depths().front(), table.depths().back(), T, depth));
  return table;
}

// By the exponential law, or by one of its named cases [Blankenbach et al., Geophys. J. Int. 98, 23 (1989)].
void follow_exponents(const namelist::schema& schema, convection_options& c, viscosity_law& law) {
  const auto named = [&](const char* name, double of_temperature, double of_depth) {
    if (c.viscosity_law != name) return;
    const auto set = [&](const char* key, double& value, double wanted) {
      if (schema.given("convection", key) && std::abs(value - wanted) > 1e-12 * (1.0 + wanted))
        schema.fail("convection", key,
                    fmt::format("viscosity_law = '{}' has {} here: choose 'exponential'", name, wanted));
      value = wanted;
    };
    set("temperature_exponent", c.temperature_exponent, of_temperature);
    set("depth_exponent", c.depth_exponent, of_depth);
  };
  named("blankenbach_2a", std::log(1000.0), 0.0);
  named("blankenbach_2b", std::log(16384.0), std::log(64.0));
  law.b = c.temperature_exponent;
  law.c = c.depth_exponent;
  law.log_middle = 0.5 * (law.c - law.b);
}

// The viscosity of the top, which is that of the fluid unless numbers are given, and of the middle of the conductive
// state.
void follow_table(const options& o, parameters& p) {
  const auto& c = o.convection;
  auto& f = p.fluid;
  auto& law = p.law;
  const double T_top = o.temperature_top(), T_bottom = o.temperature_bottom();
  law.log_reference = law.table->log(T_top, 0.0);
  const bool scaled = c.rayleigh || c.prandtl;
  if (!scaled) f.nu = std::exp(law.log_reference) / f.rho;
  double least = law.log_reference, most = least;
  for (int k = 0; k < places; ++k) {
    const double s = (k + 0.5) / places, here = law.table->log(std::lerp(T_top, T_bottom, s), s * f.L);
    law.log_middle += (here - law.log_reference) / places;
    least = std::min(least, here), most = std::max(most, here);
  }
  const double top = f.rho * f.nu;
  p.lines.push_back(fmt::format(
      "viscosity by {}: {:.4g} to {:.4g} Pa s in the conductive state{}; Rayleigh number and xi are those of the top's "
      "viscosity, {:.4g} Pa s",
      c.viscosity_law == "table" ? "'" + c.viscosity_file + "'" : "melt fraction",
      top * std::exp(least - law.log_reference), top * std::exp(most - law.log_reference),
      scaled ? fmt::format(" (scaled by {:.4g} to the Rayleigh number asked for)", top / std::exp(law.log_reference))
             : "",
      top));
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

void resolve_viscosity(const namelist::schema& schema, options& o, parameters& p) {
  auto& c = o.convection;
  auto& law = p.law;
  const bool table = c.viscosity_law == "table", melt = c.viscosity_law == "melt";
  law = {};
  law.varies = c.viscosity_law != "constant";
  law.T_top = o.temperature_top();
  law.dT = p.fluid.dT;
  law.L = p.fluid.L;
  if (!table && !melt) return follow_exponents(schema, c, law);
  if (melt && !(std::min(o.temperature_top(), o.temperature_bottom()) > 0.0))
    schema.fail("convection", "viscosity_law", "'melt' needs absolute temperatures: those of top and bottom above 0 K");
  if (c.viscosity_max < c.viscosity_min) schema.fail("convection", "viscosity_max", "is below viscosity_min");
  law.table = std::make_shared<viscosity_table>(
      table ? from_file(schema, o, p.fluid.L)
            : schema.placed("convection", "viscosity_law", [&] { return by_melt(o, p); }));
  follow_table(o, p);
}

}  // namespace tetsuame::convection
