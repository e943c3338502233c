// The bodies in the box of a problem as plain data: those of the input, where they are now, and what stands and lies
// beside them. moving.hpp moves them, contact.hpp has what comes to them.
#pragma once

#include <limits>
#include <rigid/motion.hpp>
#include <rigid/walls.hpp>

namespace tetsuame::rigid {

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

  double turned_by = 0.0;  // radians, of a free body in two dimensions: any number of turns

  // How far a free body has moved (m, radians), and what its springs and dampers do to it (N, N m).
  solids::rigid<D> moved() const {
    solids::rigid<D> s{now.shift, {}};
    if constexpr (D == 2) s.turning[0] = turned_by;
    return s;
  }
  solids::point<D> centre_of_mass() const { return rate.centre + solids::turn<D>(now.turned, free->lever); }  // m
  solids::rigid<D> pulled() const { return free->restrained.force(moved(), {rate.velocity, rate.angular}); }

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
      now.turned = solids::rotation_by<2>({{turned_by = angle[0]}});
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

// What the surface of a body gave a particle: a momentum (N s), or a force (N).
template <int D>
struct impact {
  std::size_t body;                                        // of the input's; behind them, the tank
  solids::point<D> x;                                      // m, where
  solids::point<D> image = foundation::zero<double, D>();  // m, away from the body, of the image that x is on
  solids::point<D> momentum;
};

// How fluid that comes to bodies all the same is held or put back (contact.hpp).
struct contact_rule {
  double gravity = 0.0;     // m/s2, towards -y: what is put back pays for its rise
  double held_below = 0.0;  // m/s, of what lies on a body and moves into it; 0: nothing lies on bodies
  double at_rest = 0.0;     // m/s, that count as none
  double deepest = 0.0;     // m: what is less deep is left to a spring that pushes it out
};

template <int D>
struct bodies {
  run::state<D>& state;                    // of the run
  box<D> in_box;                           // that they stand in
  std::vector<solids::body<D>> given;      // of the input, with their images where they do not move
  std::vector<motion_of_body<D>> motions;  // one a body
  contact_rule contact = {};
  bool fitted = false;  // wall particles fit the surfaces of bodies (solids/fit.hpp); else they stand on the lattice

  solids::body<D> all = {};    // the bodies as one, as they begin
  solids::body<D> solid = {};  // all bodies and, beyond the sides, the tank; without pieces where there are no bodies
  std::vector<std::uint32_t> beside_bodies = {};  // fluid that may come to them before the next lists
  // Of them those that lie on one now (contact.hpp); no body: on one that stands still.
  struct held_particle {
    std::uint32_t i;
    solids::point<D> normal;
    const moving_body<D>* body;
    std::size_t number;  // of the body, where impacts are counted
  };
  std::vector<held_particle> held = {};
  // Of this rank, where they are counted: what putting back and holding gave the fluid after the last step, its change
  // of energy with that of free bodies (J), and forces on what is held in the last evaluation.
  bool counts_impacts = false, pushed_apart = false;  // the latter: a free body has met some
  std::vector<impact<D>> impacts = {}, pushes = {};
  std::vector<double> energy_of_impacts = {};
  pairs::row_subset rows_near_bodies = {};  // fluid with wall particles of bodies in its lists

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
  std::vector<wall_group<D>> groups = {};   // by body, with new lists

  // The body that a wall particle moves with; none: it stands still.
  const moving_body<D>* mover(std::int32_t body) const {
    if (moving.empty()) return nullptr;
    const std::size_t n = mover_of[static_cast<std::size_t>(body)];
    return n == moving_body<D>::none ? nullptr : &moving[n];
  }

  // m, how far the image of a body that is at x, or the nearest to it, is away from the body.
  solids::point<D> image_at(std::size_t body, const solids::point<D>& x) const {
    auto away = foundation::zero<double, D>();
    if (body >= motions.size() || !motions[body].images.any) return away;  // the sides are no body of the input
    const auto& images = motions[body].images;
    const auto* b = mover(static_cast<std::int32_t>(body));
    const auto middle = b != nullptr ? b->now.to_space(b->middle) : images.middle;
    for (std::size_t a = 0; a < D; ++a)
      if (images.apart[a] > 0.0) away[a] = images.apart[a] * std::round((x[a] - middle[a]) / images.apart[a]);
    return away;
  }

  double spacing() const { return in_box.lattice.spacing; }  // m
  solids::point<D> place(std::size_t i) const { return place_of(state.w.s, i); }
};

}  // namespace tetsuame::rigid
