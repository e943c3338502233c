// Friction and conduction of the gas itself, as the input has them.
#include <fmt/format.h>

#include <cmath>
#include <gas/options.hpp>

namespace tetsuame::gas {

using namelist::for_expert, namelist::positive;

void declare_transport(namelist::schema& schema, shock_options& s) {
  auto& m = s.molecular;
  const auto from_zero = [](const char* unit, const char* meaning) {
    return namelist::key_info{.unit = unit, .minimum = 0.0, .meaning = meaning};
  };
  schema.add("shock", "viscosity", m.viscosity,
             for_expert(from_zero(
                 "Pa s",
                 "mu of the gas itself, beside what a scheme has of dissipation; the stress is mu (grad v + its "
                 "transpose - 2/3 div v) + bulk_viscosity div v; walls are free of it")));
  schema.add("shock", "bulk_viscosity", m.bulk_viscosity,
             for_expert(from_zero("Pa s", "of the gas itself; 5/3 of the viscosity at most")));
  schema.add("shock", "heat_conductivity", m.heat_conductivity,
             for_expert(from_zero("W/(m K)", "of the gas itself, of one ideal or stiffened gas with a heat_capacity")));
  schema.add("shock", "heat_capacity", s.heat_capacity,
             for_expert(positive(
                 "J/(kg K)", "at constant volume: heat_conductivity is of T = (u - p_infinity/rho)/heat_capacity")));
}

namespace {

void check_conduction(const namelist::schema& schema, const options& o) {
  const auto& s = o.shock;
  if (!s.molecular.conducts()) {
    if (s.heat_capacity) schema.fail("shock", "heat_capacity", "belongs to heat_conductivity");
    return;
  }
  if (o.any_eos() || s.l.gamma != s.r.gamma || s.l.p_infinity != s.r.p_infinity)
    schema.fail("shock", "heat_conductivity", "is of one gas: left and right with one gamma and p_infinity");
  if (!s.heat_capacity)
    schema.fail("shock", "heat_conductivity", "heat flows along temperatures, which need a heat_capacity");
}

// The closed form is that of μ_L c_p = k.
void check_viscous_shock(const namelist::schema& schema, const options& o) {
  const auto& s = o.shock;
  const auto fail = [&](const char* key, const std::string& why) { schema.fail("shock", key, why); };
  if (o.any_eos() || s.l.p_infinity != 0.0 || s.r.p_infinity != 0.0) fail("test", "'viscous_shock' is of an ideal gas");
  if (!(s.l.p > s.r.p)) fail("p_l", "the gas behind a shock, on the left, has the larger pressure");
  for (const char* key : {"rho_l", "u_l"})
    if (schema.given("shock", key)) fail(key, "what is behind the shock follows from p_l and the gas on the right");
  if (!s.molecular.rubs()) fail("viscosity", "the test 'viscous_shock' has a width by it");
  const double right = s.molecular.along() * s.gamma * s.heat_capacity.value_or(0.0);
  if (!s.heat_capacity || std::abs(s.molecular.heat_conductivity / right - 1.0) > 1e-6)
    fail("heat_conductivity",
         fmt::format("the exact solution of 'viscous_shock' is that of heat_conductivity = (4/3 viscosity + "
                     "bulk_viscosity) gamma heat_capacity, {:.10g} W/(m K)",
                     right));
}

}  // namespace

void check_transport(const namelist::schema& schema, const options& o) {
  const auto& s = o.shock;
  const auto& m = s.molecular;
  if (s.test == "viscous_shock" && !m.conducts()) check_viscous_shock(schema, o);
  check_conduction(schema, o);
  if (s.test == "viscous_shock") check_viscous_shock(schema, o);
  if (!(m.symmetric() <= m.viscosity))
    schema.fail("shock", "bulk_viscosity",
                fmt::format("{} Pa s: expected 5/3 of the viscosity at most, {} Pa s", m.bulk_viscosity,
                            5.0 / 3.0 * m.viscosity));
}

}  // namespace tetsuame::gas
