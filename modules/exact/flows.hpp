// Exact solutions in closed form: shock tubes, Noh's implosion, Gresho's vortex. SI units or any
// consistent ones.
#pragma once

#include <cmath>
#include <numbers>
#include <riemann/exact.hpp>

namespace tetsuame::exact {

using riemann::primitive;

// Two half spaces that meet at x = 0 when t = 0 (riemann/exact.hpp).
class shock_tube {
 public:
  shock_tube(const riemann::side<double>& left, const riemann::side<double>& right)
      : left_(left), right_(right), between_(riemann::solve(left, right)) {}
  // At x (m) and t >= 0 (s).
  primitive at(double x, double t) const {
    if (t > 0.0) return riemann::sample(left_, right_, between_, x / t);
    const riemann::side<double>& s = x < 0.0 ? left_ : right_;
    return {s.rho, s.u, s.p};
  }
  const riemann::star<double>& between() const { return between_; }

 private:
  riemann::side<double> left_, right_;
  riemann::star<double> between_;
};

// Cold ideal gas that falls with speed u0 on the plane, axis or centre r = 0, in D = 1, 2, 3
// dimensions [W. F. Noh, J. Comput. Phys. 72, 78 (1987)]. The shock is at r_s = (gamma-1) u0 t/2;
//   r < r_s:  rho = rho0 [(gamma+1)/(gamma-1)]^D,  u = 0,  p = (gamma-1) rho u0^2/2
//   r > r_s:  rho = rho0 (1 + u0 t/r)^(D-1),       u = -u0,  p = 0
struct noh {
  int dimension;  // 1, 2, 3
  double gamma;   // > 1
  double rho0;    // kg/m^3
  double u0;      // m/s, > 0 inwards

  double shock_radius(double t) const { return 0.5 * (gamma - 1.0) * u0 * t; }  // m
  // r > 0, t >= 0; u is along r.
  primitive at(double r, double t) const {
    if (r < shock_radius(t)) {
      const double rho = rho0 * std::pow((gamma + 1.0) / (gamma - 1.0), dimension);
      return {rho, 0.0, 0.5 * (gamma - 1.0) * rho * u0 * u0};
    }
    return {rho0 * std::pow(1.0 + u0 * t / r, dimension - 1), -u0, 0.0};
  }
};

// A vortex at rest in pressure balance [P. M. Gresho, S. T. Chan, Int. J. Numer. Meth. Fluids 11, 621
// (1990); pressure: R. Liska, B. Wendroff, SIAM J. Sci. Comput. 25, 995 (2003)]. With q = r/radius,
// v = speed (q; 2 - q; 0) for q < 1, < 2, beyond, and, from dp/dr = rho v^2/r,
//   p = p0 + rho speed^2 (q^2/2;  4 - 4q + q^2/2 + 4 ln q;  4 ln 2 - 2)
// The usual case: radius 0.2, speed 1, rho 1, p0 5, gamma 1.4 or 5/3.
struct gresho {
  double radius = 0.2, speed = 1.0;  // m, m/s: where v is largest, and this v
  double rho = 1.0, p0 = 5.0;        // kg/m^3; Pa in the centre

  double velocity(double r) const {  // m/s, azimuthal
    const double q = r / radius;
    return speed * (q < 1.0 ? q : q < 2.0 ? 2.0 - q : 0.0);
  }
  double pressure(double r) const {  // Pa
    const double q = r / radius, inner = 0.5 * q * q;
    const double rise = q < 1.0   ? inner
                        : q < 2.0 ? 4.0 - 4.0 * q + inner + 4.0 * std::log(q)
                                  : 4.0 * std::numbers::ln2 - 2.0;
    return p0 + rho * speed * speed * rise;
  }
};

}  // namespace tetsuame::exact
