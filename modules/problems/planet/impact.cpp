#include <fmt/format.h>

#include <algorithm>
#include <boost/numeric/odeint/integrate/integrate_adaptive.hpp>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/generation/generation_runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <cmath>
#include <foundation/error.hpp>
#include <gas/setup_parts.hpp>
#include <planet/impact.hpp>
#include <planet/profile.hpp>
#include <planet/sums.hpp>
#include <run/start_file.hpp>

namespace tetsuame::planet {

namespace {

using gas::point, gas::view;

double dot(const point& a, const point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
double size(const point& a) { return std::sqrt(dot(a, a)); }
point minus(const point& a, const point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
point cross(const point& a, const point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// The snapshot's own box: bodies in open space may come from boxes of any size.
run::start_box box_of(const std::string& path, const std::string& place) {
  run::start_box b;
  b.dimension = 3;
  b.open = {{{true, true}, {true, true}, {true, true}}};
  const output::snapshot_file file(path, place);
  const auto box = file.of_box();
  const auto& lengths = box.lengths ? box.lengths : box.size;
  if (!lengths || lengths->empty())
    file.fail(": Header has neither BoxSize nor BoxLengths, so that its box is not known");
  for (std::size_t a = 0; a < 3; ++a) b.length[a] = lengths->size() == 3 ? (*lengths)[a] : lengths->front();
  b.dx = b.length[0] / std::cbrt(static_cast<double>(std::max<std::size_t>(1, file.particles())));
  return b;
}

double outer_radius(const std::vector<gas::placed>& all) {
  std::vector<std::pair<double, double>> distances;  // m, with the spacing there
  for (const auto& p : all) distances.emplace_back(size(p.x), std::cbrt(p.mass / p.now.rho));
  std::ranges::sort(distances, std::greater{});
  const std::size_t outermost = std::min(all.size(), std::max<std::size_t>(10, all.size() / 100));
  double r = 0.0, spacing = 0.0;
  for (std::size_t k = 0; k < outermost; ++k) r += distances[k].first, spacing += distances[k].second;
  return (r + 0.5 * spacing) / static_cast<double>(outermost);
}

}  // namespace

body read_body(const std::string& path, const std::string& place, std::int32_t materials) {
  run::start_options from;
  from.file = path;
  from.place = place;
  const run::start_file file(from, box_of(path, place),
                             {"Coordinates", "Velocities", "Density", "Masses", "InternalEnergy"});
  if (!file.is_of_this_program())
    file.fail(" is not of this program: its InternalEnergy begins at another zero; let `planet` settle it first");
  const auto x = file.places(), v = file.velocities(), rho = file.densities(), m = file.masses(), u = file.energies();
  const auto material = file.materials(materials);
  const auto dissolved = file.has("Concentration") ? file.concentrations() : std::vector<double>();
  body b{{}, 0.0, 0.0};
  point centre{}, motion{};
  for (std::size_t n = 0; n < m.size(); ++n) {
    b.mass += m[n];
    for (std::size_t a = 0; a < 3; ++a) centre[a] += m[n] * x[3 * n + a], motion[a] += m[n] * v[3 * n + a];
  }
  for (std::size_t n = 0; n < m.size(); ++n) {
    gas::placed p{{}, m[n], {rho[n], 0.0, {}, material[n], {}, u[n]}};
    if (!dissolved.empty()) p.now.dissolved = dissolved[n];
    for (std::size_t a = 0; a < 3; ++a) {
      p.x[a] = x[3 * n + a] - centre[a] / b.mass;
      p.now.v[a] = v[3 * n + a] - motion[a] / b.mass;
    }
    b.particles.push_back(p);
  }
  b.radius = outer_radius(b.particles);
  return b;
}

encounter before_contact(const impact_options& o, const body& target, const body& impactor) {
  const double R = target.radius + impactor.radius, GM = G * (target.mass + impactor.mass);
  encounter e{{}, {}, std::sqrt(2.0 * GM / R), 0.0};
  e.contact_speed = o.speed * e.escape_velocity;
  const double along = std::sqrt(std::max(0.0, 1.0 - o.impact_parameter * o.impact_parameter));
  using orbit = std::array<double, 6>;
  orbit y{R * along, R * o.impact_parameter, 0.0, -e.contact_speed, 0.0, 0.0};
  const auto kepler = [GM](const orbit& at, orbit& rate, double) {
    const double r = std::sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
    for (std::size_t a = 0; a < 3; ++a) {
      rate[a] = at[a + 3];
      rate[a + 3] = -GM * at[a] / (r * r * r);
    }
  };
  if (o.time_before_contact > 0.0) {
    namespace odeint = boost::numeric::odeint;
    odeint::integrate_adaptive(odeint::make_controlled(1e-6, 1e-11, odeint::runge_kutta_dopri5<orbit>()), kepler, y,
                               0.0, -o.time_before_contact,
                               -std::min(o.time_before_contact, 0.01 * R / e.contact_speed));
  }
  std::copy_n(y.begin(), 3, e.place.begin());
  std::copy_n(y.begin() + 3, 3, e.velocity.begin());
  if (size(e.place) < R * (1.0 - 1e-6))
    foundation::fail_input(fmt::format(
        "the bodies overlap at the start: {:.6g} s before contact their centres are {:.6g} m apart, and their "
        "radii add up to {:.6g} m",
        o.time_before_contact, size(e.place), R));
  return e;
}

std::vector<gas::placed> meet(const body& target, const body& impactor, const encounter& e, const point& centre) {
  std::vector<gas::placed> both;
  const double M = target.mass + impactor.mass;
  const auto add = [&](const body& b, double share) {
    for (gas::placed p : b.particles) {
      for (std::size_t a = 0; a < 3; ++a) {
        p.x[a] += centre[a] + share * e.place[a];
        p.now.v[a] += share * e.velocity[a];
      }
      both.push_back(p);
    }
  };
  add(target, -impactor.mass / M);
  add(impactor, target.mass / M);
  return both;
}

namespace {

enum class fate { planet, disk, escapes };

struct judge {
  const view& w;
  centre_of_mass planet;
  double radius;

  fate of(std::size_t i) const {
    const point r = minus(w.place(i), planet.place), v = minus(w.velocity(i), planet.velocity);
    const double distance = size(r), GM = G * planet.mass;
    if (distance <= radius) return fate::planet;
    if (0.5 * dot(v, v) >= GM / distance) return fate::escapes;
    const point h = cross(r, v);
    return dot(h, h) > GM * radius ? fate::disk : fate::planet;
  }
};

}  // namespace

remnants find_remnants(const view& w, const body& target, std::int32_t metal) {
  const double density = target.mass / (4.0 / 3.0 * pi * std::pow(target.radius, 3));
  const auto radius_of = [&](double mass) { return std::cbrt(3.0 * mass / (4.0 * pi * density)); };
  double densest = 0.0;
  for (std::size_t i = 0; i < w.n; ++i) densest = std::max(densest, w.rho[i]);
  densest = w.ranks.maximum(densest);
  centre_of_mass now = centre_of(w, [&](std::size_t i) { return w.rho[i] == densest; });
  for (int k = 0; k < 5; ++k) {
    const point at = now.place;
    now = centre_of(w, [&](std::size_t i) { return gas::distance(w.place(i), at) <= target.radius; });
  }
  judge by{w, now, radius_of(now.mass)};
  for (int k = 0; k < 100; ++k) {
    const centre_of_mass next = centre_of(w, [&](std::size_t i) { return by.of(i) == fate::planet; });
    const bool stays = std::abs(next.mass / by.planet.mass - 1.0) < 1e-6;
    by.planet = next;
    by.radius = radius_of(next.mass);
    if (stays) break;
  }
  const auto of_target = static_cast<std::int64_t>(target.particles.size());
  remnants left;
  left.planet_radius = by.radius;
  const auto fill = [&](remnants::part& part, fate which) {
    const auto belongs = [&](std::size_t i) { return by.of(i) == which; };
    point h{};  // kg m²/s
    for (std::size_t a = 0; a < 3; ++a)
      h[a] = sum_by_mass(w, belongs, [&](std::size_t i) {
        return cross(minus(w.place(i), by.planet.place), minus(w.velocity(i), by.planet.velocity))[a];
      });
    part.mass = mass_of(w, belongs);
    part.metal = mass_of(w, [&](std::size_t i) { return belongs(i) && w.material[i] == metal; });
    part.of_impactor = mass_of(w, [&](std::size_t i) { return belongs(i) && w.id[i] >= of_target; });
    part.angular_momentum = size(h);
  };
  fill(left.planet, fate::planet);
  fill(left.disk, fate::disk);
  fill(left.escaping, fate::escapes);
  return left;
}

}  // namespace tetsuame::planet
