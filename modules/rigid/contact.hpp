// Fluid that comes to bodies all the same, past what their wall particles do: what has entered one is put back, and
// what lies on one is held (docs/theory/water_and_bodies.md).
#pragma once

#include <rigid/impacts.hpp>

namespace tetsuame::rigid {

// A particle lies on a body that is in it by no more than this (spacings), and moves neither out of it nor, faster than
// contact_rule::held_below, into it; more slowly than this (of the speed of sound) is not at all.
inline constexpr double deepest_held = 0.02, at_rest = 1e-9;

// Where a particle that is in a body may leave it, and how fast it is as the body sees it.
template <int D>
struct entered {
  solids::foot<D> surface;
  const moving_body<D>* body;
  solids::point<D> of_body, u;  // m/s
  double outwards;              // m/s, of u

  bool lies(const bodies<D>& set) const {
    const auto& rule = set.contact;
    return surface.distance > -deepest_held * set.spacing() && outwards > -rule.held_below && outwards <= rule.at_rest;
  }
};
template <int D>
std::optional<entered<D>> entry_of(const bodies<D>& set, std::size_t i) {
  const auto x = set.place(i);
  if (!set.solid.solid(x)) return {};
  const auto surface = set.solid.at(x);
  if (!surface.found) return {};
  const auto* body = mover_at(set, surface.nearest);
  const auto of_body = body != nullptr ? body->rate.at(surface.nearest - set.image_at(body->body, surface.nearest))
                                       : foundation::zero<double, D>();
  const auto u = solids::point<D>::of([&](std::size_t a) { return set.state.w.s.v[a][i] - of_body[a]; });
  return entered<D>{surface, body, of_body, u, foundation::dot(u, surface.normal)};
}

// What is solid, where bodies are now.
template <int D>
void find_solid(bodies<D>& set) {
  if (!set.moving.empty()) set.solid = solid_with(set, [](const auto& b) { return b.now; });
}

// With new lists: what may come to bodies before the next ones, and what lies on them.
template <int D>
void find_beside_bodies(bodies<D>& set) {
  set.beside_bodies.clear();
  set.held.clear();
  if (!set.state.walls.bodies.any()) return;
  // Particles move half of the skin about where lists found them, and so may bodies.
  const double near = (set.moving.empty() ? 1.5 : 2.0) * set.state.skin;
  set.beside_bodies = fluid_beside(set.state, set.solid, near);
  find_solid(set);
  for (const std::uint32_t i : set.beside_bodies)
    if (const auto e = entry_of(set, i); e && e->lies(set))
      set.held.push_back({i, e->surface.normal, e->body, number_of_body(set, e->body, e->surface.nearest)});
}

// The last guard, after a step. What lies on a body stays where it is, without its velocity into the body; other
// particles that have entered one are put back to their mirror image, as walls::reflect() does at plane sides, with
// their velocity towards it reversed. A free body takes what it gives them (impacts.hpp). How many were put back.
// Collective where impacts are counted.
template <int D>
std::int64_t put_out_of_bodies(bodies<D>& set) {
  auto& s = set.state.w.s;
  std::int64_t crossings = 0;
  set.held.clear();
  set.impacts.clear();
  set.energy_of_impacts.clear();
  find_solid(set);
  std::vector<meeting<D>> of_free;
  for (const std::uint32_t i : set.beside_bodies) {
    const auto e = entry_of(set, i);
    if (!e || e->surface.distance > -set.contact.deepest) continue;
    const auto& n = e->surface.normal;
    const bool lies = e->lies(set);
    const double risen = lies ? 0.0 : -2.0 * e->surface.distance * n[1];
    const std::size_t number = number_of_body(set, e->body, e->surface.nearest);
    if (lies) {
      set.held.push_back({i, n, e->body, number});
    } else {
      const auto to = put_out(e->surface);
      for (std::size_t a = 0; a < D; ++a) s.x[a][i] = to[a];
      ++crossings;
    }
    const auto before = velocity_of<D>(s, i);
    if (e->body != nullptr && e->body->free) {
      of_free.push_back({i, e->body, lies, risen, before, n, e->surface.nearest});
      continue;
    }
    auto u = e->u;
    leave<D>(set.contact.gravity, lies, risen, n, u);
    for (std::size_t a = 0; a < D; ++a) s.v[a][i] = e->of_body[a] + u[a];
    if (set.counts_impacts) count_impact(set, i, number, e->surface.nearest, before, risen);
  }
  if (!set.free.empty()) meet_free_bodies(set, std::move(of_free));
  return crossings;
}

// What is held is not accelerated (m/s2) into its body while it does not leave it. The force is one along the normal,
// and does no work on the particle as the body sees it; a free body meets it after the step instead.
template <int D>
void hold(bodies<D>& set, std::span<double* const> acceleration) {
  const auto& s = set.state.w.s;
  set.pushes.clear();
  for (const auto& h : set.held) {
    if (h.body != nullptr && h.body->free) continue;
    auto u = solids::point<D>::of([&](std::size_t a) { return s.v[a][h.i]; });
    auto rate = solids::point<D>::of([&](std::size_t a) { return acceleration[a][h.i]; });
    if (h.body != nullptr) {
      auto x = set.place(h.i);
      x -= set.image_at(h.body->body, x);
      u -= h.body->rate.at(x);
      rate -= h.body->rate.acceleration_at(x);
    }
    const double inwards = foundation::dot(rate, h.normal);
    if (!(inwards < 0.0) || foundation::dot(u, h.normal) > set.contact.at_rest) continue;
    for (std::size_t a = 0; a < D; ++a) acceleration[a][h.i] -= inwards * h.normal[a];
    if (set.counts_impacts) {
      const auto x = set.place(h.i);
      set.pushes.push_back({h.number, x, set.image_at(h.number, x), (-inwards * s.m[h.i]) * h.normal});
    }
  }
}

// How deep the particle i is in a body (m), where bodies stand still, and the normal of the surface there; 0 outside. A
// spring as stiff as the boundary force of the sides (walls/boundary_force.hpp) pushes it out. It begins at the surface
// itself, and not 0.3 Δx before it: particles of the start lattice stand as near to a body as its shape has it, and are
// at rest there.
template <int D>
struct depth_in_body {
  double depth = 0.0;
  solids::point<D> normal = foundation::zero<double, D>();
};
template <int D>
depth_in_body<D> depth_of(const bodies<D>& set, std::size_t i) {
  const auto x = set.place(i);
  if (!set.all.solid(x)) return {};
  const auto surface = set.all.at(x);
  if (!surface.found) return {};
  return {-surface.distance, surface.normal};
}

}  // namespace tetsuame::rigid
