// Pressure as a function of density alone: the isotherm or isentrope to which a thermal
// part is added. Each gives p - p(rho0) and K = d p/d ln rho, of L = ln(rho/rho0), and the work from rho0,
// rho0 int p/rho^2 drho.
#pragma once

#include <cmath>
#include <foundation/lanes_math.hpp>
#include <variant>

namespace tetsuame::eos {

template <class R>
struct curve_point {
  R p, K;  // Pa
};

// p = 3 K0 (1 - x) x^-2 exp[3/2 (K0' - 1)(1 - x)], x = (rho0/rho)^(1/3)
// [P. Vinet, J. Ferrante, J. H. Rose, J. R. Smith, J. Geophys. Res. 92, 9319 (1987)].
struct vinet {
  static constexpr const char* name = "vinet";
  double K0;        // Pa
  double K0_prime;  // dimensionless

  template <class R>
  curve_point<R> at(const R& L) const {
    const R x = foundation::exp(R(L / -3.0));
    const double c = 1.5 * (K0_prime - 1.0);
    const R scale = K0 * foundation::exp(R(c * (1.0 - x))) / (x * x);
    return {3.0 * scale * (1.0 - x), scale * (2.0 - x + c * x * (1.0 - x))};
  }

  // Pa
  double energy(double L) const {
    const double c = 1.5 * (K0_prime - 1.0), y = c * (1.0 - std::exp(L / -3.0));
    return 9.0 * K0 / (c * c) * (1.0 + (y - 1.0) * std::exp(y));
  }
};

// p = 3 K0 f (1 + 2f)^(5/2) [1 + a f + b f^2], f = [(rho/rho0)^(2/3) - 1]/2,
// a = 3/2 (K0' - 4), b = 3/2 [K0 K0'' + (K0' - 4)(K0' - 3) + 35/9]; b = 0 is third order
// [F. Birch, J. Geophys. Res. 83, 1257 (1978)].
struct birch_murnaghan {
  static constexpr const char* name = "birch_murnaghan";
  double K0;  // Pa
  double a, b;

  static birch_murnaghan third_order(double K0, double K0_prime) { return {K0, 1.5 * (K0_prime - 4.0), 0.0}; }
  static birch_murnaghan fourth_order(double K0, double K0_prime, double K0_second /* 1/Pa */) {
    return {K0, 1.5 * (K0_prime - 4.0), 1.5 * (K0 * K0_second + (K0_prime - 4.0) * (K0_prime - 3.0) + 35.0 / 9.0)};
  }

  template <class R>
  curve_point<R> at(const R& L) const {
    using std::sqrt;
    const R s = foundation::exp(R(2.0 / 3.0 * L));  // 1 + 2f, so df/dL = s/3
    const R f = 0.5 * (s - 1.0);
    const R scale = K0 * s * s * sqrt(s);
    const R series = 1.0 + f * (a + b * f);
    return {3.0 * scale * f * series, scale * (5.0 * f * series + s * (1.0 + f * (2.0 * a + 3.0 * b * f)))};
  }

  // Pa
  double energy(double L) const {
    const double f = 0.5 * (std::exp(2.0 / 3.0 * L) - 1.0);
    return 9.0 * K0 * f * f * (0.5 + f * (a / 3.0 + 0.25 * b * f));
  }
};

using reference_curve = std::variant<vinet, birch_murnaghan>;

}  // namespace tetsuame::eos
