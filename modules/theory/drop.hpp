// Terminal velocity of drops, alone and in arrays; their largest size and oscillation; hindered settling. SI units;
// lengths are radii, not diameters. Velocities have the sign of the density difference (drop minus surroundings),
// downward positive. Equations: docs/theory/drop.md.
#pragma once

namespace tetsuame::theory {

struct drop {
  double radius;                     // m
  double density_difference;         // kg/m^3
  double gravity;                    // m/s^2
  double viscosity, drop_viscosity;  // Pa s, outside and inside; infinity inside: a rigid sphere
};

// Creeping sphere, unbounded: V = (2/3)(drho g a^2/eta)(1 + kappa)/(2 + 3 kappa)
// [J. Hadamard, C. R. Acad. Sci. 152, 1735 (1911); W. Rybczynski, Bull. Acad. Sci. Cracovie A, 40 (1911)].
double hadamard_rybczynski(const drop& d);

// Factor on it in a simple cubic array of volume fraction c in [0, 0.1], zero mean flow of drops and surroundings
// together, error of order c^2. Drop viscosity over outer viscosity may be infinite here and below.
double cubic_array_factor(double c, double viscosity_ratio);

// Two dimensions: V eta/(drho g a^2) of a circular drop in a square array of area fraction c in (0, 0.1], zero mean
// flow, error of order c^2. In any other box: stokes_box.hpp.
double square_array_velocity(double c, double viscosity_ratio);

// Largest drop that outlives Rayleigh-Taylor waves on its front: 2 capillary lengths sqrt(sigma/(|drho| g)) in radius
// [R. Clift, J. R. Grace and M. E. Weber, Bubbles, Drops, and Particles (1978), sect. 12.III].
double largest_radius(double surface_tension, double density_difference, double gravity);

// Angular frequency, 1/s, of the small oscillation r = R (1 + e cos(n theta)) of a drop, n >= 2, or of a sphere in the
// n-th Legendre polynomial (dimension 2, 3); without viscosity, in an unbounded liquid
// [Lord Rayleigh, Proc. R. Soc. London 29, 71 (1879); H. Lamb, Hydrodynamics, sects. 273, 275].
double oscillation_frequency(int n, int dimension, double surface_tension, double radius, double density,
                             double density_outside);

// Factor (1 - c)^n on the velocity in a cloud of volume fraction c in [0, 0.6], with n of the Reynolds number 2 a rho
// V/eta of one particle alone: 4.65 below 0.2, 4.35 Re^-0.03 to 1, 4.45 Re^-0.1 to 500, 2.39 above (tube much wider
// than the particle) [J. F. Richardson and W. N. Zaki, Trans. Inst. Chem. Eng. 32, 35 (1954)].
double hindered_settling_factor(double c, double reynolds);

}  // namespace tetsuame::theory
