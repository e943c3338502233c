// Linear growth of displaced interfaces in a self-gravitating cylinder of incompressible viscous layers, with a free
// surface: viscosity and inertia together. Equations: docs/theory/layered_cylinder.md.
//
// r is the distance from the axis. Perturbations are e^(growth t) times cos mθ or sin mθ; m is the degree. SI units.
#pragma once

#include <cstddef>
#include <vector>

namespace tetsuame::theory {

struct cylinder_layer {
  double outer_radius;  // m, ascending
  double density;       // kg/m³
  double viscosity;     // Pa s, > 0
};

struct layered_cylinder {
  std::vector<cylinder_layer> layers;  // from the axis outwards
  double gravitational_constant;       // m³/(kg s²)
};

// The mode of a degree that grows fastest, per metre of what the interface `fastest` is displaced by.
struct cylinder_mode {
  double growth_rate = 0.0;  // 1/s; 0: none grows
  std::size_t fastest = 0;   // of the interfaces with the denser layer outside the one that is displaced most
  std::vector<double> displacement = {};  // outwards, m/m, of the outer boundary of each layer, times cos mθ

  // At r: outwards, times cos mθ, and along θ, times sin mθ; m/m. Beyond the surface as at the surface.
  struct vector {
    double radial, tangential;
  };
  vector at(double r) const;

  // Of the stream function in each layer: the factors of its solutions.
  struct stream {
    double inner, outer, wave_number;  // m, m, 1/m
    std::vector<double> factors;
  };
  std::size_t degree = 0;
  std::vector<stream> streams = {};
};

// degree >= 1. fail_calculation: a boundary layer thinner than 1/600 of the radius.
cylinder_mode growing_mode(const layered_cylinder& cylinder, std::size_t degree);

}  // namespace tetsuame::theory
