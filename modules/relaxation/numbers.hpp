// The non-dimensional numbers of thermal convection and the speeds it may reach.
//   Ra = alpha g DeltaT L^3/(kappa nu), Pr = nu/kappa, M_th = kappa/(L c_0), c_0 = sqrt(K_0/rho_0)
// [S1 (19)-(22), (69)], [S1]: K. Shobuzako, note of 3 February 2023 on relaxation parameters (in Japanese).
#pragma once

namespace tetsuame::relaxation {

struct fluid_layer {
  double L;      // m, height
  double dT;     // K, bottom less top
  double rho;    // kg/m3
  double kappa;  // m2/s, thermal diffusivity
  double nu;     // m2/s, kinematic viscosity
  double g;      // m/s2
  double alpha;  // 1/K
  double K;      // Pa, bulk modulus
};

double sound_speed(const fluid_layer& f);     // m/s
double rayleigh(const fluid_layer& f);        // (19)
double prandtl(const fluid_layer& f);         // (20)
double thermal_mach(const fluid_layer& f);    // (21)
double thermal_strain(const fluid_layer& f);  // epsilon = alpha DeltaT, (22)

// Speeds (m/s) at which buoyancy is balanced by viscosity (Stokes) or by inertia (free fall); with
// thermal boundary layers buoyancy acts on the layer's width sqrt(kappa L/V) only.
// The note's (24), (26) as printed have M_th under the root; it belongs outside, as in its (28).
double stokes_speed(const fluid_layer& f, bool boundary_layers);     // Ra M_th c_0, Ra^(2/3) M_th c_0: (23), (25)
double free_fall_speed(const fluid_layer& f, bool boundary_layers);  // (Ra Pr)^(1/2), (Ra Pr)^(2/5): (24), (26)

enum class balance { viscous, inertial };
// The slower of the two is what the flow reaches [S1, appendix].
balance reached_balance(const fluid_layer& f, bool boundary_layers);
double reached_speed(const fluid_layer& f, bool boundary_layers);  // m/s

}  // namespace tetsuame::relaxation
