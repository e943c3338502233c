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
      for (const auto& rule : pairs)
        if ((rule.first == a && rule.second == b) || (rule.first == b && rule.second == a)) {
          e = rule.restitution;
          c.friction = rule.friction;
          c.rolling = rule.rolling_friction;
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
      const auto known = damping.find(e);
      c.damping = known != damping.end() ? known->second : (damping[e] = damping_for(rules.model, e));
    }
}

double rayleigh_time(const material& of, double radius) {
  return std::numbers::pi * radius * std::sqrt(of.density / of.shear_modulus()) / (0.1631 * of.poisson_ratio + 0.8766);
}

}  // namespace tetsuame::dem
