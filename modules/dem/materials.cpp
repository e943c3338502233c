#include <algorithm>
#include <cmath>
#include <dem/materials.hpp>
#include <map>
#include <numbers>
#include <utility>

namespace tetsuame::dem {

double smaller_of(double a, double b, double neither) {
  const double least = std::fmin(a, b);  // that of one where the other is not a number
  return std::isnan(least) ? neither : least;
}

contact_table::contact_table(const contact_rules& of, std::vector<material> all, const std::vector<pair_rule>& pairs)
    : rules(of), materials(std::move(all)) {
  const std::size_t n = materials.size();
  pairs_.resize(n * n);
  std::map<double, double> damping;  // of each restitution, which takes a while
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < n; ++b) {
      const auto &m = materials[a], &w = materials[b];
      auto& c = pairs_[a * n + b];
      double e = smaller_of(m.restitution, w.restitution, default_restitution);
      c.friction = smaller_of(m.friction, w.friction, default_friction);
      c.rolling = smaller_of(m.rolling_friction, w.rolling_friction, default_rolling_friction);
      c.adhesion = smaller_of(m.adhesion, w.adhesion, default_adhesion);
      for (const auto& rule : pairs)
        if ((rule.first == a && rule.second == b) || (rule.first == b && rule.second == a)) {
          e = rule.restitution;
          c.friction = rule.friction;
          c.rolling = rule.rolling_friction;
          c.adhesion = rule.adhesion;
        }
      if (rules.model == contact_model::hooke) {
        c.normal = rules.stiffness;
        c.tangential = rules.tangential_part * rules.stiffness;
      } else {
        const auto soft = [](const material& x) { return (1.0 - x.poisson_ratio * x.poisson_ratio) / x.young_modulus; };
        const auto sheared = [](const material& x) { return (2.0 - x.poisson_ratio) / x.shear_modulus(); };
        c.normal = 1.0 / (soft(m) + soft(w));
        c.tangential = 1.0 / (sheared(m) + sheared(w));
      }
      const double k_t = (rules.model == contact_model::hooke ? 1.0 : 6.0) * c.tangential;
      c.tangential_root = std::sqrt(k_t / c.normal);
      adheres_ = adheres_ || c.adhesion > 0.0;
      const auto known = damping.find(e);
      c.damping = known != damping.end() ? known->second : (damping[e] = damping_for(rules.model, e));
    }
}

double contact_table::largest_damping() const {
  double most = 0.0;
  for (const auto& c : pairs_) most = std::max(most, c.damping);
  return most;
}

double contact_table::farthest_drawn(double radius) const {
  double most = 0.0;
  for (const auto& c : pairs_) most = std::max(most, drawn_apart(c, radius));
  return most;
}

double drawn_apart(const pair_constants& c, double R) {
  if (!(c.adhesion > 0.0)) return 0.0;
  const double a = std::cbrt(std::numbers::pi * c.adhesion * R * R / (8.0 * c.normal));
  return 3.0 * a * a / R;
}

// s = √a is the largest root of s⁴/R - b s = δ, b = √(2π w/E*): by Newton's method from above, where the left side is
// convex.
double adhesive_radius(const pair_constants& c, double R, double overlap) {
  const double b = std::sqrt(2.0 * std::numbers::pi * c.adhesion / c.normal);
  double s = std::cbrt(b * R) + std::sqrt(std::sqrt(R * std::fmax(0.0, overlap)));
  for (int n = 0; n < 60; ++n) {
    const double cube = s * s * s, slope = 4.0 * cube / R - b;
    const double next = s - ((cube / R - b) * s - overlap) / slope;
    if (!(next < s) || !(slope > 0.0)) break;
    s = next;
  }
  return s * s;
}

double rayleigh_time(const material& of, double radius) {
  return std::numbers::pi * radius * std::sqrt(of.density / of.shear_modulus()) / (0.1631 * of.poisson_ratio + 0.8766);
}

}  // namespace tetsuame::dem
