// A cold gas cloud that falls together under its own gravity [A. E. Evrard, Mon. Not. R. Astron. Soc. 235, 911 (1988)].
#include <cmath>
#include <gas/setup_parts.hpp>
#include <numbers>

namespace tetsuame::gas {

// In units with G = 1: mass M = 1 and radius R = 1, ρ = M/(2π R² r), u = 0.05 GM/R, at rest. A lattice in the ball
// whose radii q are moved to r = R (q/R)^(3/2) has this density with equal masses.
setup collapse(const options& o) {
  constexpr double M = 1.0, R = 1.0, u = 0.05;
  point centre{};
  for (std::size_t a = 0; a < 3; ++a) centre[a] = 0.5 * o.domain.length[a];
  const std::int64_t across = o.domain.particles[0];
  const double step = 2.0 * R / static_cast<double>(across);
  std::vector<point> places;
  const auto along = [&](std::int64_t k) { return (static_cast<double>(k) + 0.5) * step - R; };
  for (std::int64_t k = 0; k < across; ++k)
    for (std::int64_t j = 0; j < across; ++j)
      for (std::int64_t i = 0; i < across; ++i) {
        const point q{along(i), along(j), along(k)};
        const double from = distance(q, {});
        if (from > R || from == 0.0) continue;
        const double stretch = std::sqrt(from / R);
        places.push_back({q[0] * stretch, q[1] * stretch, q[2] * stretch});
      }
  setup t;
  for (const point& x : places) {
    const double rho = M / (2.0 * std::numbers::pi * R * R * distance(x, {}));
    const state now{rho, (o.shock.gamma - 1.0) * rho * u, {}, 0};
    t.particles.push_back(
        {{centre[0] + x[0], centre[1] + x[1], centre[2] + x[2]}, M / static_cast<double>(places.size()), now});
  }
  const double escape = std::sqrt(2.0 * M / R);
  t.scales = {M * escape, M * R * escape};
  return t;
}

void resolve_collapse(const namelist::schema& schema, options& o) {
  if (o.shock.test != "collapse") {
    if (o.softening != 1.0)
      schema.fail("shock", "softening", "is of the test 'collapse', which has gravity of its own");
    return;
  }
  if (o.domain.dimension != 3) schema.fail("domain", "dimension", "the test 'collapse' has three dimensions");
  for (std::size_t a = 0; a < 3; ++a) {
    if (o.domain.periodic[a])
      schema.fail("domain", std::string("periodic_") + "xyz"[a], "the cloud of the test 'collapse' is in open space");
    if (o.domain.length[a] != 2.0)
      schema.fail("domain", std::string("length_") + "xyz"[a],
                  "expected 2: the cloud of the test 'collapse' fills its box");
  }
  if (o.any_eos()) schema.fail("shock", "eos_l", "the test 'collapse' is of an ideal gas");
  for (const char* key : {"rho_l", "u_l", "p_l", "rho_r", "u_r", "p_r"})
    if (schema.changed("shock", key))
      schema.fail("shock", key, "the state of the test 'collapse' is given: leave it out");
  o.domain.open = {true, true, true};
  gravity::tree_options units;
  units.gravitational_constant = 1.0;
  o.self_gravity = units;
}

}  // namespace tetsuame::gas
