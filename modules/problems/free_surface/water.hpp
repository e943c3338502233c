// Water with a free surface: what a run holds, as plain data.
#pragma once

#include <algorithm>
#include <free_surface/options.hpp>
#include <limits>
#include <particles/named_fields.hpp>
#include <passes/evaluation.hpp>
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
  particles::vector_field<D> viscous_velocity = {};  // m/s, that of these; the start declares it

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

  const bool has_bodies = !p.template bodies_in<D>().empty();
  const bool has_free_bodies = std::ranges::any_of(
      p.template motions_in<D>(), [](const auto& motion) { return motion.moves() && motion.free.has_value(); });

  // Where forces on bodies are asked for (loads.hpp).
  const bool asks_loads = has_bodies && (!p.force.empty() || has_free_bodies);
  std::vector<wall_group<D>> groups = {};
  particles::vector_field<D> force_without = vector<D>(asks_loads, "ForceWithout", "N");
  particles::array& density_rate_without = field(asks_loads, "DensityRateWithout", "kg/(m^3 s)");

  // With free bodies: how the pressure of their wall particles follows each component of their acceleration, of
  // displacement and of rotation (free_bodies.hpp).
  particles::vector_field<solids::rigid<D>::components> response =
      vector<solids::rigid<D>::components>(has_free_bodies, "PressureResponse", "Pa s^2/m, Pa s^2");

  // An evaluation fills these.
  particles::vector_field<D> force = vector<D>(true, "Force", "N");  // but for gravity
  particles::array& density_rate = field(true, "DensityRate", "kg/(m^3 s)");
  // Beside bodies (behind_bodies.hpp): a direction, or 0; the volume of their wall particles, 0 elsewhere.
  particles::vector_field<D> pressed = vector<D>(has_bodies, "PressedDirection", "1");
  particles::array& volume_in_bodies = field(has_bodies, "VolumeInBodies", "m^D");

  // With surface tension (tension.hpp): G, smoothed G, forces; curvature and its weight.
  particles::vector_field<D> inward = vector<D>(has_tension(), "InwardNormal", "1/m");
  particles::vector_field<D> normal_within = vector<D>(has_tension(), "SmoothedInwardNormal", "1/m");
  particles::vector_field<D> tension = vector<D>(has_tension(), "TensionForce", "N");
  particles::array& curvature = field(has_tension(), "Curvature", "1/m");
  particles::array& surface_weight = field(has_tension(), "SurfaceWeight", "1/m");

  // What looks at the surface fills these (surface.hpp): λ, the least of the neighbourhood; 1 or 0.
  particles::vector_field<D> slope = vector<D>(true, "ConcentrationGradient", "1/m");
  particles::vector_field<D> normal = vector<D>(true, "SurfaceNormal", "1");
  particles::array& eigenvalue = field(true, "Eigenvalue", "1");
  particles::array& least_near = field(true, "LeastEigenvalueNear", "1");
  particles::array& covered = field(true, "Covered", "1");

  // Of dy/dt; of what follows from the state alone, as of now.
  passes::evaluation<D> rates{world}, present{world};

  water(const options& of_input, const parameters& that_follow) : o(of_input), p(that_follow) {}

  water(const water&) = delete;  // its fields are the state's
  water& operator=(const water&) = delete;

  particles::array& field(bool needed, const char* name, const char* unit) {
    return particles::declare_if(needed, world.w.s, name, unit, particles::role::derived);
  }
  template <std::size_t N>
  particles::vector_field<N> vector(bool needed, const char* name, const char* unit) {
    return particles::declare_vector_if<N>(needed, world.w.s, name, unit, particles::role::derived);
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

// Collective. Ghosts, pressures, volumes, and what stands behind walls, as of now.
template <int D>
void refresh(water<D>& f) {
  f.present.run({});
}

// Water slower than this part of c0 counts as less lively, by the square of its speed, where a sum would else make or
// take energy at a rate that does not fall as that of viscosity does: its density diffuses less (in water at rest the
// pressure that its sums hold differs from the hydrostatic one), it drifts less, and walls balance more of its power.
inline constexpr double slow = 0.01;
// 1 of water that moves, less of slow water.
template <int D>
double speed_limiter(const water<D>& f, double speed) {
  return std::min(1.0, speed / (slow * f.p.water.sound));
}

template <int D>
double length_of(const particles::vector_field<D>& v, std::size_t i) {
  double squared = 0.0;
  for (std::size_t a = 0; a < D; ++a) squared += v[a][i] * v[a][i];
  return std::sqrt(squared);
}

}  // namespace tetsuame::free_surface
