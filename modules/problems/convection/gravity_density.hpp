// The density that gravity weighs, from any equation of state of the project, about an adiabat at rest:
//
//   dp_r/dy = -ρ_r g, T_r on the adiabat through (p_top, T_top) at y = L    (two_fluids/column.hpp)
//   b(y, T, p) = -g [ρ̂(p_r(y), T) - ρ̂(p_r(y), T_c(y))]/ρ_0 - g q p/K(y) ρ_r(y)/ρ_0,   T_c the conductive profile
//
// p is the pressure beyond what carries T_c, so that conduction is at rest. The heat capacity follows ∂c_p/∂y = T
// ∂²b/∂T², so that enthalpy is conserved (docs/theory/convection.md, "Gravity by an equation of state").
#pragma once

#include <eos/eos.hpp>
#include <vector>

namespace tetsuame::convection {

class gravity_density {
 public:
  struct layer {
    double L, g;             // m, m/s2
    double rho;              // kg/m3, ρ_0 of the flow
    double p_top;            // Pa
    double T_top, T_bottom;  // K
  };
  // fail_calculation where the equation of state has no density at a pressure of the column and a temperature between
  // T_top and T_bottom, or a tenth of their difference beyond: outside the density goes on straight.
  gravity_density(const eos::any& material, const layer& l);

  // m/s2, upwards; q: what of p gravity feels.
  double buoyancy(double y, double T, double p, double q) const;
  double slope(double y, double T) const;  // ∂b/∂T = g α ρ/ρ_0, m/(s2 K)
  // c_p(y, T) less that at the top, J/(kg K): -T ∫_y^L ∂²b/∂T² dy.
  double heat_capacity_change(double y, double T) const;

  // Of the column at rest.
  double pressure(double y) const { return value(&node::p, y); }         // Pa
  double density(double y) const { return value(&node::rho, y); }        // kg/m3
  double temperature(double y) const { return value(&node::T, y); }      // K, the adiabat
  double expansivity(double y) const { return value(&node::alpha, y); }  // 1/K

 private:
  static constexpr int degree = 10;  // in T, Chebyshev: ρ̂ at one pressure is smooth
  static constexpr int nodes = 256;  // over L, cubic between
  using polynomial = std::array<double, degree + 1>;
  struct node {
    double p, rho, T, alpha, K;
    polynomial series, above;  // of -g ρ̂/ρ_0 by s, -1 <= s <= 1; of its integral from y to L
  };
  polynomial coefficients(polynomial node::*member, double y) const;
  double value(double node::*member, double y) const;
  std::pair<double, double> series(double y, double T) const;  // -g ρ̂/ρ_0 and its slope in T

  layer l_;
  double low_, high_;  // K, of the series
  std::vector<node> nodes_;
};

}  // namespace tetsuame::convection
