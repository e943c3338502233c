#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <exact/viscous_shock.hpp>

namespace tetsuame::exact {

namespace {

double softplus(double z) { return std::max(z, 0.0) + std::log1p(std::exp(-std::abs(z))); }  // ln(1 + e^z)

}  // namespace

viscous_shock::viscous_shock(double rho, double p, double gamma, double behind, double friction)
    : rho_(rho), p_(p), gamma_(gamma) {
  // Rankine and Hugoniot
  w1_ = std::sqrt(0.5 * ((gamma + 1.0) * behind + (gamma - 1.0) * p) / rho);
  w2_ = w1_ * ((gamma - 1.0) * behind + (gamma + 1.0) * p) / ((gamma + 1.0) * behind + (gamma - 1.0) * p);
  l_ = 2.0 * gamma * friction / ((gamma + 1.0) * rho * w1_);
}

// With y = a + (1 - a)/(1 + e^-z): ln(1 - y) and ln(y - a) are -ln(1 + e^z) and -ln(1 + e^-z) but for constants, and
// what is looked for has a slope between -1 and -a in z.
double viscous_shock::speed_at(double s) const {
  const double a = w2_ / w1_, wanted = s * (1.0 - a) / l_ - (1.0 - a) * std::log(2.0);
  const auto miss = [&](double z) { return a * softplus(-z) - softplus(z) - wanted; };
  const double most = 2.0 + (std::abs(wanted) + 2.0) / a;
  std::uintmax_t iterations = 200;
  const auto between =
      boost::math::tools::toms748_solve(miss, -most, most, boost::math::tools::eps_tolerance<double>(50), iterations);
  const double z = 0.5 * (between.first + between.second);
  return w2_ + (w1_ - w2_) / (1.0 + std::exp(-z));
}

riemann::primitive viscous_shock::at(double x, double t) const {
  const double w = speed_at(w1_ * t - x), rho = rho_ * w1_ / w;
  const double enthalpy = gamma_ / (gamma_ - 1.0) * p_ / rho_ + 0.5 * (w1_ * w1_ - w * w);
  return {rho, w1_ - w, (gamma_ - 1.0) / gamma_ * rho * enthalpy};
}

// -w' = (w1 - w)(w - w2)/(w l) is largest at w = (w1 w2)^½: (w1^½ - w2^½)²/l.
double viscous_shock::width() const {
  const double root = std::sqrt(w1_) - std::sqrt(w2_);
  return (w1_ - w2_) * l_ / (root * root);
}

}  // namespace tetsuame::exact
