// Sedov's and Taylor's point explosion: energy E released at r = 0 into cold ideal gas of density rho0, in D = 1, 2, 3
// dimensions. Equations and sources: docs/theory/riemann.md.
//   r_s = [E t^2/(alpha rho0)]^(1/(D+2)),  u_s = 2 r_s/((D+2) t)
// E is all of the energy: per area for both sides in 1-D (tables for one side have half our alpha), per length in 2-D.
#pragma once

#include <riemann/exact.hpp>
#include <vector>

namespace tetsuame::exact {

class sedov {
 public:
  // D = 1, 2, 3; gamma > 1, and in 3-D below 7, from where the centre is hollow; else fail_input.
  sedov(int dimension, double gamma);

  double alpha() const { return alpha_; }  // dimensionless; relative error below 1e-11

  double shock_radius(double energy, double rho0, double t) const;  // m
  double shock_speed(double energy, double rho0, double t) const;   // m/s

  // At r >= 0 (m), t > 0 (s); u is along r. Ahead of the shock rho0, 0, 0.
  riemann::primitive at(double r, double t, double energy, double rho0) const;

  struct similarity {
    double phi, g, h;  // u = u_s lambda phi, rho = rho0 g, p = rho0 u_s^2 h; lambda = r/r_s
  };
  // At 0 < lambda <= 1; relative error below 1e-9.
  similarity profile(double lambda) const;

 private:
  int dimension_;
  double gamma_, alpha_, step_;  // step_ > 0 in -ln lambda
  // At equal steps of ln lambda from the shock inwards, for cubic Hermite pieces.
  struct node {
    double ln_z, ln_g, ln_z_slope, ln_g_slope;
  };
  std::vector<node> table_;
};

}  // namespace tetsuame::exact
