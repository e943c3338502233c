#include <fmt/format.h>

#include <cmath>
#include <foundation/error.hpp>
#include <relaxation/options.hpp>

namespace tetsuame::relaxation {

namespace {

using namelist::between, namelist::for_expert, namelist::positive, namelist::up_to;

void declare(namelist::schema& schema, material_options& o) {
  schema.group("material", "the fluid (Boussinesq)");
  schema.add("material", "density", o.density,
             {.unit = "kg/m^3", .minimum = 1e-30, .meaning = "rho_0, at the reference temperature"});
  schema.add("material", "expansivity", o.expansivity, positive("1/K", "alpha, thermal"));
  schema.add("material", "heat_capacity", o.heat_capacity, positive("J/(kg K)", "c_p, at constant pressure"));
  schema.add("material", "conductivity", o.conductivity, positive("W/(m K)", "k, thermal"));
  schema.add("material", "viscosity", o.viscosity, positive("Pa s", "eta, dynamic"));
  schema.add("material", "bulk_modulus", o.bulk_modulus, positive("Pa", "K_0; sound runs at sqrt(K_0/rho_0)"));
}

void declare(namelist::schema& schema, relaxation_options& o) {
  schema.group("relaxation", "slowed sound (RSST) and inertia (VIM)");
  schema.add("relaxation", "method", o.method,
             {.choices = {"auto", "none", "rsst", "vim", "rsst_vim"},
              .expert = true,
              .meaning = "auto: rsst_vim where viscosity balances buoyancy, rsst where inertia does"});
  schema.add("relaxation", "zeta", o.zeta,
             for_expert(between(1.0, 1e30, "sound is slowed by it; not given: by the rule")));
  schema.add("relaxation", "xi", o.xi,
             for_expert(between(1.0, 1e30, "inertia is multiplied by its square; not given: by the rule")));
  schema.add("relaxation", "rule", o.rule,
             {.choices = {"slower_speed", "later"},
              .expert = true,
              .meaning = "slower_speed: note of February 2023; later: of June 2023, with boundary layers"});
  schema.add("relaxation", "boundary_layers", o.boundary_layers,
             {.expert = true, .meaning = "buoyancy acts on thermal boundary layers only: the wider bounds"});
  schema.add("relaxation", "mach", o.mach, up_to(1.0, "flow over slowed sound, V/c_eff"));
  schema.add("relaxation", "phi_xi", o.phi_xi, for_expert(up_to(1.0, "xi over its bound")));
}

}  // namespace

void declare(namelist::schema& schema, options& o) {
  declare(schema, o.material);
  schema.group("gravity", "uniform gravity");
  schema.add("gravity", "g", o.g, positive("m/s^2", "acceleration, towards -y"));
  declare(schema, o.relaxation);
}

fluid_layer layer(const namelist::schema& schema, const options& o, double height, double temperature_bottom,
                  double temperature_top) {
  const double dT = temperature_bottom - temperature_top;
  if (!(dT > 0.0))
    schema.fail("walls", "temperature_bottom",
                fmt::format("the bottom ({} K) must be hotter than the top ({} K), or nothing rises",
                            temperature_bottom, temperature_top));
  const auto& m = o.material;
  return {height,
          dT,
          m.density,
          m.conductivity / (m.density * m.heat_capacity),
          m.viscosity / m.density,
          o.g,
          m.expansivity,
          m.bulk_modulus};
}

choice wanted(const relaxation_options& o) {
  choice c;
  if (o.method == "none") c.how = method::none;
  if (o.method == "rsst") c.how = method::rsst;
  if (o.method == "vim") c.how = method::vim;
  if (o.method == "rsst_vim") c.how = method::rsst_vim;
  c.boundary_layers = o.boundary_layers;
  c.later_rule = o.rule == "later";
  c.mach = o.mach;
  c.phi_xi = o.phi_xi;
  c.zeta = o.zeta;
  c.xi = o.xi;
  return c;
}

}  // namespace tetsuame::relaxation
