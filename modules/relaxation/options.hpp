// The input of a convection problem, for programs that plan it and programs that run it:
//   &domain      dimension, length_x … , particles_x … , periodic_x …
//   &material    density, expansivity, heat_capacity, conductivity, viscosity, bulk_modulus
//   &gravity     g
//   &walls       temperature_bottom, temperature_top and the rest: declared by module walls
//   &relaxation  method, zeta, xi, rule, boundary_layers, mach, phi_xi
// The diffusivities are kappa = k/(rho c_p) and nu = eta/rho.
#pragma once

#include <array>
#include <cstdint>
#include <namelist/schema.hpp>
#include <optional>
#include <relaxation/rules.hpp>
#include <string>

namespace tetsuame::relaxation {

struct domain_options {
  std::int64_t dimension = 2;
  std::array<double, 3> length{1e6, 1e6, 1e6};  // m; y is up: length[1] is the height L
  std::array<std::int64_t, 3> particles{100, 100, 100};
  std::array<bool, 3> periodic{false, false, false};
};

// Defaults: the mantle of Blankenbach et al. (1989), case 1a [S1, table 3].
struct material_options {
  double density = 4e3;         // kg/m3
  double expansivity = 2.5e-5;  // 1/K
  double heat_capacity = 1250;  // J/(kg K), at constant pressure
  double conductivity = 5.0;    // W/(m K)
  double viscosity = 1e23;      // Pa s
  double bulk_modulus = 1e11;   // Pa
};

struct relaxation_options {
  std::string method = "auto";
  std::string rule = "slower_speed";
  bool boundary_layers = true;
  double mach = 0.1, phi_xi = 0.5;
  std::optional<double> zeta, xi;
};

struct options {
  domain_options domain;
  material_options material;
  double g = 10.0;  // m/s2
  relaxation_options relaxation;
};

void declare(namelist::schema& schema, options& o);

// Checks what takes more than one key: bad_input with file and line. temperature_*: K, from &walls.
fluid_layer layer(const namelist::schema& schema, const options& o, double temperature_bottom, double temperature_top);
double volume_ratio(const domain_options& d);  // of the box to its height^dimension
choice wanted(const relaxation_options& o);

}  // namespace tetsuame::relaxation
