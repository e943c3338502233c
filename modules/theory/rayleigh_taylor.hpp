// Linear growth of a dense layer over a light one between two horizontal boundaries: viscosity,
// inertia, compressibility and surface tension together. Equations: docs/theory/rayleigh_taylor.md.
//
// x is horizontal, y upward, y = 0 at the interface at rest. Perturbations are e^(growth t) times
// cos kx or sin kx; in 3-D k is the length of the horizontal wave vector. SI units.
#pragma once

#include <functional>
#include <vector>

namespace tetsuame::theory {

// no_slip: u = v = 0; free_slip: v = 0 and no shear stress; free_surface (lid only): no traction.
enum class boundary { no_slip, free_slip, free_surface };

struct material_state {
  double density;       // kg/m^3
  double bulk_modulus;  // Pa, rho dp/drho along the relation that base state and perturbation follow
};

// Density as a function of pressure alone: an isotherm or an adiabat.
using barotrope = std::function<material_state(double pressure)>;

// p = K (rho/rho0 - 1), so rho dp/drho = K rho/rho0; K infinite: incompressible.
barotrope linear_barotrope(double rho0, double K);

struct layer {
  double thickness;  // m, > 0
  double viscosity;  // Pa s, > 0
  barotrope material;
  // Pa s, >= -viscosity/3: stress eta (grad v + grad v^T - 2/3 div v) + bulk_viscosity div v. At -viscosity/3
  // the force is eta lap v alone, as in modules/diffusion, and the stress traceless in two dimensions.
  double bulk_viscosity = 0.0;
  double inertia = 1.0;  // xi^2, times which the density resists acceleration
};

struct two_layers {
  layer lower, upper;
  double gravity;             // m/s^2, towards -y
  double top_pressure = 0.0;  // Pa, at the lid; matters only through the materials
  boundary floor = boundary::no_slip, lid = boundary::no_slip;
  double surface_tension = 0.0;  // N/m
  bool inertia = true;           // false: creeping flow
  // zeta^2: the modulus is divided by it for what the pressure departs from that at rest by. The base state, its
  // buoyancy and the weight of what is compressed are as they were.
  double softness = 1.0;
};

// Growth rate, 1/s, at wave number k, 1/m. 0 where the interface is stable,
// (rho_upper - rho_lower) g <= surface_tension k^2; else there is exactly one growing mode.
// fail_calculation: boundary layers or decay lengths too thin for the largest resolution, 180 points a layer.
double growth_rate(const two_layers& flow, double k);

// The growing mode, per metre of the interface's amplitude.
struct mode {
  struct profile {
    std::vector<double> y;         // m, from the lower to the upper end of the layer
    std::vector<double> u, v;      // velocity, 1/s (m/s per m)
    std::vector<double> pressure;  // Eulerian perturbation, Pa/m
  };
  double k = 0.0, growth_rate = 0.0;  // 1/m, 1/s
  profile lower, upper;
};

// Fails as growth_rate does, and with fail_input where the interface is stable.
mode eigenmode(const two_layers& flow, double k);

// Amplitudes at height y, which lies inside the layers (fail_input otherwise); y = 0 is taken
// from the upper layer. The fields of an interface at y = a cos kx are a times
// displacement_x sin kx, displacement_y cos kx and pressure cos kx; velocity = growth_rate displacement.
struct mode_values {
  double displacement_x, displacement_y;  // m/m
  double pressure;                        // Eulerian perturbation, Pa/m
};
mode_values at(const mode& m, double y);

}  // namespace tetsuame::theory
