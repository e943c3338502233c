// Materials of grains and walls, and the constants of the contact of two of them.
#pragma once

#include <cstddef>
#include <dem/damping.hpp>
#include <limits>
#include <string>
#include <vector>

namespace tetsuame::dem {

// Restitution and frictions that are not numbers are not given: a contact has those of the other material.
struct material {
  static constexpr double not_given = std::numeric_limits<double>::quiet_NaN();
  std::string name;
  double density = 2500.0;              // kg/m3
  double young_modulus = 1e7;           // Pa
  double poisson_ratio = 0.25;          // 1
  double restitution = not_given;       // 1, e
  double friction = not_given;          // 1, μ
  double rolling_friction = not_given;  // 1, μ_r
  double adhesion = not_given;          // J/m2, work of adhesion

  double shear_modulus() const { return young_modulus / (2.0 * (1.0 + poisson_ratio)); }  // Pa
};
// Of two materials: the smaller value of both, that of one, or the default where neither is given.
double smaller_of(double a, double b, double neither);
inline constexpr double default_restitution = 0.9, default_friction = 0.5, default_rolling_friction = 0.0,
                        default_adhesion = 0.0;

// What the input says of the contact of two materials, in the place of what follows from theirs.
struct pair_rule {
  std::size_t first, second;
  double restitution, friction, rolling_friction, adhesion;
};

// Hertz and Mindlin: E*, G*; Hooke: stiffnesses of normal and tangential springs.
struct pair_constants {
  double normal = 0.0;           // Pa, E*: 1/E* = (1 - ν1²)/E1 + (1 - ν2²)/E2; or N/m
  double tangential = 0.0;       // Pa, G*: 1/G* = (2 - ν1)/G1 + (2 - ν2)/G2; or N/m
  double damping = 0.0;          // 1, α of damping.hpp
  double tangential_root = 0.0;  // 1, √(k_t δ/F)
  double friction = 0.0;         // 1, μ
  double rolling = 0.0;          // 1, μ_r
  double adhesion = 0.0;         // J/m2, w
};

// Rolling resistance [J. Ai, J.-F. Chen, J. M. Rotter, J. Y. Ooi, Powder Technol. 206, 269 (2011)]: a torque of
// constant size against rolling (their model A), or an elastic-plastic spring and dashpot (their model C).
enum class rolling_model { none, constant_torque, spring };

struct contact_rules {
  contact_model model = contact_model::hertz_mindlin;
  rolling_model rolling = rolling_model::none;
  double stiffness = 0.0;        // N/m, Hooke: of the normal spring
  double tangential_part = 0.0;  // 1, Hooke: of the tangential spring, of that
  double rolling_damping = 0.0;  // 1, model C: of the critical one
};

class contact_table {
 public:
  contact_table() = default;
  contact_table(const contact_rules& rules, std::vector<material> materials, const std::vector<pair_rule>& pairs);

  const pair_constants& of(std::size_t a, std::size_t b) const { return pairs_[a * materials.size() + b]; }
  bool adheres() const { return adheres_; }
  double largest_damping() const;  // 1, α
  // m, the farthest that surfaces of grains no larger than this are drawn apart before a contact breaks.
  double farthest_drawn(double radius) const;

  contact_rules rules;
  std::vector<material> materials;

 private:
  std::vector<pair_constants> pairs_;
  bool adheres_ = false;
};

// Adhesion after K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. Lond. A 324, 301 (1971), of spheres with R*,
// E* and the work of adhesion w: with the radius a of the contact
//
//   δ = a²/R* - √(2π w a/E*),   F = 4 E* a³/(3 R*) - √(8π w E* a³)
//
// A contact begins at δ = 0 and breaks where dδ/da = 0, at δ = -3 a²/R*, a³ = π w R*²/(8 E*).
double drawn_apart(const pair_constants& c, double R);                      // m, that -δ
double adhesive_radius(const pair_constants& c, double R, double overlap);  // m, a

// s, in which Rayleigh's wave goes through half a sphere: π R √(ρ/G)/(0.1631 ν + 0.8766).
double rayleigh_time(const material& of, double radius);

}  // namespace tetsuame::dem
