// The characteristic temperature of a material as its density changes, and Grueneisen's parameter gamma =
// d ln theta/d ln rho that follows: the Debye temperature of a solid, or the temperature of a melt on its reference
// adiabat. Both by L = ln(rho/rho0).
#pragma once

#include <cmath>
#include <variant>

namespace tetsuame::eos {

struct characteristic_point {
  double theta;  // K
  double gamma;
  double slope;  // d gamma/d ln rho
};

// theta = theta0 sqrt(s), s = 1 + a f + b f^2/2, f = [(rho/rho0)^(2/3) - 1]/2, a = 6 gamma0,
// b = -12 gamma0 + 36 gamma0^2 - 18 gamma0'; gamma = (2f + 1)(a + b f)/(6 s)
// [L. Stixrude, C. Lithgow-Bertelloni, Geophys. J. Int. 162, 610 (2005)]. gamma0' = V d gamma/dV = q0 gamma0.
struct finite_strain {
  double theta0, gamma0, gamma0_slope;  // K, dimensionless

  characteristic_point at(double L) const {
    const double a = 6.0 * gamma0, b = -12.0 * gamma0 + 36.0 * gamma0 * gamma0 - 18.0 * gamma0_slope;
    const double stretch = std::exp(2.0 / 3.0 * L);  // 1 + 2f, so df/dL = stretch/3
    const double f = 0.5 * (stretch - 1.0), s = 1.0 + f * (a + 0.5 * b * f), rise = a + b * f;
    const double gamma = stretch * rise / (6.0 * s);
    const double gamma_f = ((2.0 * rise + stretch * b) - stretch * rise * rise / s) / (6.0 * s);
    return {theta0 * std::sqrt(s), gamma, gamma_f * stretch / 3.0};
  }
};

// gamma = gamma_limit + (gamma0 - gamma_limit) x^beta, x = rho0/rho;
// theta = theta0 x^-gamma_limit exp[(gamma0 - gamma_limit)/beta (1 - x^beta)]
// [L. V. Al'tshuler, S. E. Brusnikin, E. A. Kuz'menkov, J. Appl. Mech. Tech. Phys. 28, 129 (1987)].
struct altshuler {
  double theta0, gamma0, gamma_limit, beta;  // K, dimensionless

  characteristic_point at(double L) const {
    const double part = (gamma0 - gamma_limit) * std::exp(-beta * L);
    const double theta = theta0 * std::exp(gamma_limit * L + (gamma0 - gamma_limit - part) / beta);
    return {theta, gamma_limit + part, -beta * part};
  }
};

using characteristic_temperature = std::variant<finite_strain, altshuler>;

}  // namespace tetsuame::eos
