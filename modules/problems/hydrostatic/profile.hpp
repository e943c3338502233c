// The exact solution of a box at rest: pressure and density by height.
#pragma once

#include <algorithm>
#include <cmath>
#include <eos/compression.hpp>
#include <hydrostatic/options.hpp>

namespace tetsuame::hydrostatic {

// Pressure of the exact solution at the height y: the initial pressure, or the hydrostatic
// dp/dy = -ρ^(p, T) g from the top, by fourth-order Runge–Kutta steps of at most Δx/16.
class profile {
 public:
  profile(const options& o, const eos::any& material) : o_(o), material_(material) {}

  double pressure(double y) const {
    if (o_.initial.profile == "uniform") return o_.initial.pressure;
    const double top = o_.domain.length[1];
    const auto n = static_cast<std::int64_t>(std::ceil(16.0 * std::abs(top - y) / o_.domain.dx()));
    const double dy = n > 0 ? (y - top) / static_cast<double>(n) : 0.0;
    double p = o_.initial.pressure;
    const double rho_top = density(p);
    for (std::int64_t k = 0; k < n; ++k) {
      const double k1 = slope(p), k2 = slope(p + 0.5 * dy * k1), k3 = slope(p + 0.5 * dy * k2), k4 = slope(p + dy * k3);
      p += dy * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;
      eos::check_column(material_, rho_top, o_.initial.temperature, top + static_cast<double>(k + 1) * dy, p,
                        density(p));
    }
    return p;
  }
  double density(double p) const { return eos::density(material_, p, o_.initial.temperature); }

 private:
  double slope(double p) const { return -density(p) * o_.g; }

  const options& o_;
  const eos::any& material_;
};

}  // namespace tetsuame::hydrostatic
