// Cooling from a surface whose temperature drops from T1 to T0 at t = 0 [Carslaw & Jaeger, Conduction of Heat in Solids
// (1959), 2.4 and 3.4]; y is the depth, kappa the diffusivity:
//   half space   T = T1 + (T0 - T1) erfc(y / (2 sqrt(kappa t)))
//   plate        T = T0 + (T1 - T0) [y/L + (2/pi) sum_n (1/n) exp(-kappa n² pi² t/L²) sin(n pi y/L)],  T1 at y = L
#pragma once

namespace tetsuame::conduction {

// K. depth: m >= 0; t: s >= 0.
double half_space(double T0, double T1, double kappa, double depth, double t);
// The series to 1e-14, with the half space's images where it converges slowly. 0 <= depth <= L.
double plate(double T0, double T1, double kappa, double L, double depth, double t);

}  // namespace tetsuame::conduction
