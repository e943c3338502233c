// Water with a free surface: what a run holds, as plain data.
#pragma once

#include <algorithm>
#include <free_surface/options.hpp>
#include <limits>
#include <run/start.hpp>

namespace tetsuame::free_surface {

// A body that moves (moving.hpp).
template <int D>
struct moving_body {
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  static constexpr std::size_t turns = D == 2 ? 1 : 3, angles = D == 2 ? 1 : 4;

  std::size_t body = 0;                      // of the input's
  solids::prescribed<D> course;              // at rest, where it moves freely
  std::optional<solids::free_body<D>> free;  // mass and inertia, as it began
  std::vector<solids::point<D>> rest;        // m, places of its wall particles in the body at rest
  std::int64_t first_number = 0;             // theirs
  double radius = 0.0;                       // m, of the farthest of them about the pivot
  // m, of its bounds when lists were made; in the body at rest.
  solids::point<D> middle = foundation::zero<double, D>();
  solids::pose<D> now, at_lists;  // now, and when lists were made
  solids::rate<D> rate;           // now

  // Of a free body, the state that is integrated: displacement and velocity of its centre of mass; its angle, or
  // quaternion; its angular momentum over spin_scale().
  double spin_scale() const { return free->inertia[0][0]; }
  std::vector<double> state() const {
    std::vector<double> all;
    for (std::size_t a = 0; a < D; ++a) all.push_back(now.shift[a]);
    for (std::size_t a = 0; a < D; ++a) all.push_back(rate.velocity[a]);
    for (std::size_t a = 0; a < angles; ++a) all.push_back(D == 3 && a == 0 ? 1.0 : 0.0);
    for (std::size_t a = 0; a < turns; ++a) all.push_back(0.0);
    return all;
  }
  template <class Value>
  void set(const Value& value) {
    for (std::size_t a = 0; a < D; ++a) {
      now.shift[a] = value(a);
      rate.velocity[a] = value(D + a);
    }
    std::array<double, angles> angle;
    for (std::size_t a = 0; a < angles; ++a) angle[a] = value(2 * D + a);
    if constexpr (D == 2)
      now.turned = solids::rotation_by<2>({{angle[0]}});
    else
      now.turned = solids::rotation_of(angle);
    for (std::size_t a = 0; a < turns; ++a) free->angular_momentum[a] = spin_scale() * value(2 * D + angles + a);
    rate.centre = now.pivot + now.shift;
    rate.angular = free->angular_velocity(now.turned);
  }
};

// The state of those that move freely, on rank 0: a list with an element a body for each component.
template <int D>
struct free_bodies {
  static constexpr std::size_t components = 2 * D + moving_body<D>::angles + moving_body<D>::turns;
  std::array<std::vector<double>, components> state;
  std::size_t number = 0;
  bool empty() const { return number == 0; }
};

// Wall particles of one image of a body, or what mirrors them in some of the sides: local indices.
template <int D>
struct wall_group {
  std::size_t body = 0;
  std::uint32_t mirrored = 0;
  solids::point<D> image = foundation::zero<double, D>();  // m, away from the body
  std::vector<std::size_t> members;
};

template <int D>
struct water {
  const options& o;
  const parameters& p;
  run::state<D> world = {};

  solids::body<D> solid = {};  // all bodies and, beyond the sides, the tank; without pieces where there are no bodies
  std::vector<std::uint32_t> beside_bodies = {};  // fluid that may come to them before the next lists
  // Of them those that lie on one now (contact.hpp); no body: on one that stands still.
  struct held_particle {
    std::uint32_t i;
    solids::point<D> normal;
    const moving_body<D>* body;
  };
  std::vector<held_particle> held = {};
  pairs::row_subset rows_near_bodies = {};  // fluid with wall particles of bodies in its lists
  bool two_velocities = false;              // what stands behind walls has another one in the viscous sum (terms.hpp)

  // Bodies that move. `solid` is as they were when lists were made, and put_out_of_bodies() as they are.
  std::vector<moving_body<D>> moving = {};
  free_bodies<D> free = {};
  std::vector<std::size_t> mover_of = {};  // body: place in `moving`, or none
  solids::body<D> solid_at_rest = {};      // what does not move
  std::size_t resting = 0;                 // of the walls' places, those that do not move
  struct place_in_body {
    solids::point<D> x, marker, normal, image;  // image: m, away from the body
  };
  std::vector<place_in_body> in_body = {};  // of the walls' places

  // Where forces on bodies are asked for (loads.hpp).
  bool asks_loads = false;
  std::vector<wall_group<D>> groups = {};
  std::array<particles::array, D> force_without = {};  // N
  particles::array density_rate_without = {};

  // With free bodies: how the pressure of their wall particles follows each component of their acceleration
  // (free_bodies.hpp).
  std::array<particles::array, solids::rigid<D>::components> response = {};  // Pa s2/m, Pa s2

  // Filled by evaluations, with room for every particle.
  std::array<particles::array, D> viscous_velocity = {};  // m/s, with two velocities
  std::array<particles::array, D> force = {};             // N, but for gravity
  std::array<particles::array, D> pressed = {};           // beside bodies: of length 1, or 0 (behind_bodies.hpp)
  particles::array volume_in_bodies = {};                 // m^D, of their wall particles; of all others 0
  particles::array density_rate = {};                     // kg/(m3 s)

  // With surface tension (tension.hpp): G, smoothed G, forces; curvature and its weight.
  std::array<particles::array, D> inward = {}, normal_within = {}, tension = {};  // 1/m, 1/m, N
  particles::array curvature = {}, surface_weight = {};                           // 1/m

  // Filled by what looks at the surface (surface.hpp).
  std::array<particles::array, D> slope = {}, normal = {};          // 1/m; of length 1
  particles::array eigenvalue = {}, least_near = {}, covered = {};  // λ, the least of the neighbourhood; 1 or 0

  water(const options& of_input, const parameters& that_follow) : o(of_input), p(that_follow) {}

  void make_room() {
    std::vector<particles::array*> all{&density_rate, &eigenvalue, &least_near, &covered};
    for (auto* vectors : {&force, &slope, &normal})
      for (auto& a : *vectors) all.push_back(&a);
    if (world.walls.bodies.any()) {
      all.push_back(&volume_in_bodies);
      for (auto& a : pressed) all.push_back(&a);
    }
    if (two_velocities)
      for (auto& a : viscous_velocity) all.push_back(&a);
    if (has_tension()) {
      all.insert(all.end(), {&curvature, &surface_weight});
      for (auto* vectors : {&inward, &normal_within, &tension})
        for (auto& a : *vectors) all.push_back(&a);
    }
    if (!free.empty())
      for (auto& a : response) all.push_back(&a);
    if (asks_loads) {
      all.push_back(&density_rate_without);
      for (auto& a : force_without) all.push_back(&a);
    }
    for (auto* a : all) a->assign(world.w.s.total() + 1, 0.0);
  }

  // The body that a wall particle moves with; none: it stands still.
  const moving_body<D>* mover(std::int32_t body) const {
    if (moving.empty()) return nullptr;
    const std::size_t n = mover_of[static_cast<std::size_t>(body)];
    return n == moving_body<D>::none ? nullptr : &moving[n];
  }

  // m, how far the image of a body that is at x, or the nearest to it, is away from the body.
  solids::point<D> image_at(std::size_t body, const solids::point<D>& x) const {
    auto away = foundation::zero<double, D>();
    const auto& all = p.template motions_in<D>();
    if (body >= all.size() || !all[body].images.any) return away;  // the sides are no body of the input
    const auto& images = all[body].images;
    const auto* b = mover(static_cast<std::int32_t>(body));
    const auto middle = b != nullptr ? b->now.to_space(b->middle) : images.middle;
    for (std::size_t a = 0; a < D; ++a)
      if (images.apart[a] > 0.0) away[a] = images.apart[a] * std::round((x[a] - middle[a]) / images.apart[a]);
    return away;
  }

  const domain::communicator& ranks() const { return world.w.d.ranks; }
  bool has_tension() const { return o.flow.surface_tension > 0.0; }
  double gravity() const { return o.flow.gravity; }
  double dx() const { return world.w.dx; }
  point place(std::size_t i) const {
    point x{};
    for (std::size_t a = 0; a < D; ++a) x[a] = world.w.s.x[a][i];
    return x;
  }
  double speed2(std::size_t i) const {
    double v2 = 0.0;
    for (std::size_t a = 0; a < D; ++a) v2 += world.w.s.v[a][i] * world.w.s.v[a][i];
    return v2;
  }
};

// Water slower than this part of c0 counts as less lively, by the square of its speed, where a sum would else make or
// take energy at a rate that does not fall as that of viscosity does: its density diffuses less (in water at rest the
// pressure that its sums hold differs from the hydrostatic one), it drifts less, and walls balance more of its power.
inline constexpr double slow = 0.01;
// 1 of water that moves, less of slow water.
template <int D>
double speed_limiter(const water<D>& f, double speed) {
  return std::min(1.0, speed / (slow * f.p.water.sound));
}

// Vectors as arrays of components.
template <std::size_t N>
std::array<double*, N> places_of(std::array<particles::array, N>& a) {
  std::array<double*, N> all;
  for (std::size_t k = 0; k < N; ++k) all[k] = a[k].data();
  return all;
}
template <int D>
double length_of(const std::array<particles::array, D>& v, std::size_t i) {
  double squared = 0.0;
  for (std::size_t a = 0; a < D; ++a) squared += v[a][i] * v[a][i];
  return std::sqrt(squared);
}

}  // namespace tetsuame::free_surface
