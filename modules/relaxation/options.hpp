// The input of a convection problem, for programs that plan it and programs that run it: &material, &gravity,
// &relaxation. The diffusivities are kappa = k/(rho c_p) and nu = eta/rho.
#pragma once

#include <namelist/schema.hpp>
#include <optional>
#include <relaxation/rules.hpp>
#include <string>

namespace tetsuame::relaxation {

// Defaults: the mantle of Blankenbach et al. (1989), case 1a [S1, table 3].
struct material_options {
  double density = 4e3;         // kg/m3
  double expansivity = 2.5e-5;  // 1/K
  double heat_capacity = 1250;  // J/(kg K), at constant pressure
  double conductivity = 5.0;    // W/(m K)
  double viscosity = 1e23;      // Pa s
  double bulk_modulus = 1e11;   // Pa
};

struct options {
  material_options material;
  double g = 10.0;  // m/s2
  choice relaxation;
};

void declare(namelist::schema& schema, options& o);

// Checks what takes more than one key: bad_input with file and line. height: m; temperature_*: K, from &walls.
fluid_layer layer(const namelist::schema& schema, const options& o, double height, double temperature_bottom,
                  double temperature_top);

}  // namespace tetsuame::relaxation
