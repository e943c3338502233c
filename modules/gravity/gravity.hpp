// Gravity. Uniform: pairs::workspace::g, of all particles alike. Otherwise a pass writes the acceleration of each, and
// rates take it from there (pairs::workspace::gravity).
#pragma once

#include <cmath>
#include <passes/evaluation.hpp>
#include <stdexcept>

namespace tetsuame::gravity {

// The field of a homogeneous ball (2-D: cylinder) of radius R about a centre, with g at its surface:
//   a = -g (r/R) r̂ inside, -g (R/r)^(D-1) r̂ outside
// R = 0 is refused.
template <int D>
class central {
 public:
  central(const std::array<double, D>& centre, double g_surface, double radius)
      : centre_(centre), g_(g_surface), R_(radius) {
    if (!(radius > 0.0)) throw std::invalid_argument("central gravity needs a radius above 0");
  }

  // m/s2
  std::array<double, D> at(const std::array<double, D>& x) const {
    std::array<double, D> a;
    const double r = distance(x), per_r = r < R_ ? g_ / R_ : g_ * std::pow(R_ / r, D - 1) / r;
    for (std::size_t k = 0; k < D; ++k) a[k] = -per_r * (x[k] - centre_[k]);
    return a;
  }
  // J/kg, 0 at the surface.
  double potential(const std::array<double, D>& x) const {
    const double r = distance(x);
    if (r < R_) return 0.5 * g_ * (r * r / R_ - R_);
    if constexpr (D == 1) return g_ * (r - R_);
    if constexpr (D == 2) return g_ * R_ * std::log(r / R_);
    return g_ * R_ * (1.0 - R_ / r);
  }

  // The pass. The field is declared here, once a run.
  void declare(run::state<D>& box, passes::evaluation<D>& e) const {
    auto& w = box.w;
    w.accelerations = particles::declare_vector<D>(w.s, "GravitationalAcceleration", "m/s^2", particles::role::derived);
    w.gravity_varies = true;
    e.each("gravity", {.reads = {w.s.x}, .writes = {w.accelerations}}, [&w, field = *this](std::size_t i) {
      const auto a = field.at(particles::position<D>(w.s.x, i));
      for (std::size_t k = 0; k < D; ++k) w.accelerations[k][i] = a[k];
    });
  }

 private:
  double distance(const std::array<double, D>& x) const {
    double r2 = 0.0;
    for (std::size_t k = 0; k < D; ++k) r2 += (x[k] - centre_[k]) * (x[k] - centre_[k]);
    return std::sqrt(r2);
  }

  std::array<double, D> centre_;  // m
  double g_, R_;                  // m/s2, m
};

}  // namespace tetsuame::gravity
