#include <cmath>
#include <relaxation/numbers.hpp>

namespace tetsuame::relaxation {

double sound_speed(const fluid_layer& f) { return std::sqrt(f.K / f.rho); }
double rayleigh(const fluid_layer& f) { return f.alpha * f.g * f.dT * f.L * f.L * f.L / (f.kappa * f.nu); }
double prandtl(const fluid_layer& f) { return f.nu / f.kappa; }
double thermal_mach(const fluid_layer& f) { return f.kappa / (f.L * sound_speed(f)); }
double thermal_strain(const fluid_layer& f) { return f.alpha * f.dT; }

double stokes_speed(const fluid_layer& f, bool boundary_layers) {
  return std::pow(rayleigh(f), boundary_layers ? 2.0 / 3.0 : 1.0) * f.kappa / f.L;
}

double free_fall_speed(const fluid_layer& f, bool boundary_layers) {
  return std::pow(rayleigh(f) * prandtl(f), boundary_layers ? 0.4 : 0.5) * f.kappa / f.L;
}

balance reached_balance(const fluid_layer& f, bool boundary_layers) {
  return stokes_speed(f, boundary_layers) <= free_fall_speed(f, boundary_layers) ? balance::viscous : balance::inertial;
}

double reached_speed(const fluid_layer& f, bool boundary_layers) {
  return reached_balance(f, boundary_layers) == balance::viscous ? stokes_speed(f, boundary_layers)
                                                                 : free_fall_speed(f, boundary_layers);
}

}  // namespace tetsuame::relaxation
