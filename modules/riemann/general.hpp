// The Riemann problem of two materials of any equation of state, by their own wave curves:
//   shock        u - u_K = 1/2 (p + p_K)(1/rho_K - 1/rho),   (v - v_K)^2 = (p - p_K)(1/rho_K - 1/rho)
//   rarefaction  du/drho = p/rho^2,   dv/d ln rho = c         (u: energy, v: velocity)
// by density as the parameter; Runge-Kutta's fourth order along the isentrope. p* is where the curves' velocities meet,
// found between brackets. For references: thousands of evaluations of the equations of state.
#pragma once

#include <eos/caloric.hpp>
#include <riemann/exact.hpp>

namespace tetsuame::riemann {

struct body {
  const eos::caloric* material;
  double rho, v, T;  // kg/m^3, m/s, K
};

struct general_state {
  double rho, v, p, u;  // kg/m^3, m/s, Pa, J/kg
};

class general_tube {
 public:
  // fail_input for a state without sound, fail_calculation where the curves do not meet above the pressures where the
  // materials have sound (a vacuum, or tension that they do not bear).
  general_tube(const body& left, const body& right);

  const general_state& star_l() const { return left_.star; }
  const general_state& star_r() const { return star_r_; }
  bool on_left(double xi) const { return xi < left_.star.v; }
  // At x/t = xi, m/s.
  general_state at(double xi) const;

 private:
  // Waves towards -x; those of the right side are mirrored.
  struct side_of {
    const eos::caloric* material;
    general_state outer, star;
    double shock;                    // m/s; not a number: rarefaction
    std::vector<general_state> fan;  // from outer to star
    double sound(const general_state& s) const { return material->at(s.rho, s.u).c; }
    general_state along(const general_state& from, double rho, int steps) const;
    general_state compressed(double rho) const;
    general_state by_density(double rho) const;
    general_state by_pressure(double p) const;
    void settle(double p);
    general_state at(double xi) const;
  };
  side_of left_, right_;
  general_state star_r_;
};

}  // namespace tetsuame::riemann
