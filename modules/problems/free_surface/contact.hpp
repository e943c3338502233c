// Water that comes to bodies all the same, past what their wall particles do: what has entered one is put back, and
// what lies on one is held (docs/theory/water_and_bodies.md).
#pragma once

#include <free_surface/moving.hpp>
#include <rigid/walls.hpp>

namespace tetsuame::free_surface {

// A particle lies on a body that is in it by no more than this (spacings), and moves neither out of it nor, faster than
// slow water does, into it; more slowly than this (of the speed of sound) is not at all.
inline constexpr double deepest_held = 0.02, at_rest = 1e-9;

// Where a particle that is in a body may leave it, and how fast it is as the body sees it.
template <int D>
struct entered {
  solids::foot<D> surface;
  const moving_body<D>* body;
  solids::point<D> of_body, u;  // m/s
  double outwards;              // m/s, of u

  bool lies(const water<D>& f) const {
    const double c = f.p.water.sound;
    return surface.distance > -deepest_held * f.dx() && outwards > -slow * c && outwards <= at_rest * c;
  }
};
template <int D>
std::optional<entered<D>> entry_of(const water<D>& f, std::size_t i) {
  const auto x = of_solids<D>(f.place(i));
  if (!f.solid.solid(x)) return {};
  const auto surface = f.solid.at(x);
  if (!surface.found) return {};
  const auto* body = mover_at(f, surface.nearest);
  const auto of_body = body != nullptr ? body->rate.at(surface.nearest - f.image_at(body->body, surface.nearest))
                                       : foundation::zero<double, D>();
  const auto u = solids::point<D>::of([&](std::size_t a) { return f.world.w.s.v[a][i] - of_body[a]; });
  return entered<D>{surface, body, of_body, u, foundation::dot(u, surface.normal)};
}

// What is solid, where bodies are now.
template <int D>
void find_solid(water<D>& f) {
  if (!f.moving.empty()) f.solid = solid_with(f, [](const auto& b) { return b.now; });
}

// With new lists: what may come to bodies before the next ones, and what lies on them.
template <int D>
void find_beside_bodies(water<D>& f) {
  f.beside_bodies.clear();
  f.held.clear();
  if (!f.world.walls.bodies.any()) return;
  // Particles move half of the skin about where lists found them, and so may bodies.
  const double near = (f.moving.empty() ? 1.5 : 2.0) * f.world.skin;
  f.beside_bodies = rigid::fluid_beside(f.world, f.solid, near);
  find_solid(f);
  for (const std::uint32_t i : f.beside_bodies)
    if (const auto e = entry_of(f, i); e && e->lies(f)) f.held.push_back({i, e->surface.normal, e->body});
}

// What a particle has risen by (m) when it is put back is taken out of its velocity u (m/s) relative to the body, first
// of that along the normal: putting back makes no energy. A particle slower than this is left at rest.
template <int D>
void pay_for_rise(double g, double risen, const solids::point<D>& normal, solids::point<D>& u) {
  const double due = 2.0 * g * std::max(0.0, risen);
  const double across = foundation::dot(u, normal);
  const double left = across * across - due;
  const auto along = u - across * normal;
  if (left >= 0.0) {
    u = along + std::copysign(std::sqrt(left), across) * normal;
    return;
  }
  const double along2 = foundation::dot(along, along);
  u = along2 + left > 0.0 ? std::sqrt((along2 + left) / along2) * along : foundation::zero<double, D>();
}

// After a step. What lies on a body stays where it is, without its velocity into the body; other particles that have
// entered one are put back to their mirror image, as walls::reflect() does at plane sides, with their velocity towards
// it reversed. How many were put back.
template <int D>
std::int64_t put_out_of_bodies(water<D>& f) {
  auto& s = f.world.w.s;
  std::int64_t crossings = 0;
  f.held.clear();
  find_solid(f);
  for (const std::uint32_t i : f.beside_bodies) {
    const auto e = entry_of(f, i);
    if (!e) continue;
    const auto& n = e->surface.normal;
    auto u = e->u;
    if (e->lies(f)) {
      if (e->outwards < 0.0) u -= e->outwards * n;
      f.held.push_back({i, n, e->body});
    } else {
      const double risen = -2.0 * e->surface.distance * n[1];
      rigid::turn_back(n, u);
      pay_for_rise<D>(f.gravity(), risen, n, u);
      const auto to = rigid::put_out(e->surface);
      for (std::size_t a = 0; a < D; ++a) s.x[a][i] = to[a];
      ++crossings;
    }
    for (std::size_t a = 0; a < D; ++a) s.v[a][i] = e->of_body[a] + u[a];
  }
  return crossings;
}

// What is held is not accelerated (m/s2) into its body while it does not leave it. The force is one along the normal,
// and does no work on the particle as the body sees it.
template <int D>
void hold(const water<D>& f, std::span<double* const> acceleration) {
  const auto& s = f.world.w.s;
  for (const auto& h : f.held) {
    auto u = solids::point<D>::of([&](std::size_t a) { return s.v[a][h.i]; });
    auto rate = solids::point<D>::of([&](std::size_t a) { return acceleration[a][h.i]; });
    if (h.body != nullptr) {
      auto x = of_solids<D>(f.place(h.i));
      x -= f.image_at(h.body->body, x);
      u -= h.body->rate.at(x);
      rate -= h.body->rate.acceleration_at(x);
    }
    const double inwards = foundation::dot(rate, h.normal);
    if (!(inwards < 0.0) || foundation::dot(u, h.normal) > at_rest * f.p.water.sound) continue;
    for (std::size_t a = 0; a < D; ++a) acceleration[a][h.i] -= inwards * h.normal[a];
  }
}

}  // namespace tetsuame::free_surface
