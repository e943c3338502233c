// The structure of a shock in an ideal gas with friction and conduction [R. Becker, Z. Phys. 8, 321 (1922); L. G.
// Margolin, J. M. Reisner, P. M. Jordan, Int. J. Non-Linear Mech. 95, 333 (2017)], in closed form where k = c_p μ_L,
// μ_L = 4/3 μ + ζ. Then c_p T + w²/2 is the same everywhere, w the speed of the gas in the frame of the shock, and
//
//   w w' = (w - w1)(w - w2)/l,   l = 2 γ μ_L/((γ + 1) j),   j = ρ w
//   s (1 - a)/l = ln((1 - y)/(y - a)^a) + const,   y = w/w1, a = w2/w1
//
// s: m, along the flow through the shock, 0 where w is the mean of w1 (ahead) and w2 (behind).
#pragma once

#include <riemann/exact.hpp>

namespace tetsuame::exact {

// Into gas at rest, towards larger x.
class viscous_shock {
 public:
  // rho, p: kg/m3 and Pa, of the gas ahead; behind: Pa, > p; friction: μ_L, Pa s.
  viscous_shock(double rho, double p, double gamma, double behind, double friction);

  // At x (m) from where the shock was at t = 0 (s).
  riemann::primitive at(double x, double t) const;

  double speed() const { return w1_; }              // m/s, of the shock
  double flow_behind() const { return w1_ - w2_; }  // m/s
  double density_behind() const { return rho_ * w1_ / w2_; }
  // m: the change of w over its largest slope.
  double width() const;

 private:
  double speed_at(double s) const;  // w

  double rho_, p_, gamma_;
  double w1_, w2_, l_;  // m/s, m/s, m
};

}  // namespace tetsuame::exact
