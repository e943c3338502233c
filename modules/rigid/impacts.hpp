// Momentum of the fluid that is put back to the surface of a body, or held there (contact.hpp): what the fluid gains
// the body loses.
//
// A particle of mass m that leaves a free body with the relative velocity u' instead of u has from it the impulse J d,
// d = u' - u, at x = c + r (derived here):
//
//   J = d²/(d²/m + d·w),   w = d/M + (I⁻¹ r × d) × r
//
// w being the velocity that d as an impulse gives the body at x. So d comes about along itself however light the body
// is, and momentum and angular momentum of both are kept. Particles meet a body one by one, in the order of their IDs.
#pragma once

#include <cstring>
#include <map>
#include <rigid/moving.hpp>

namespace tetsuame::rigid {

template <int D>
solids::point<D> velocity_of(const particles::particles<D>& s, std::size_t i) {
  return solids::point<D>::of([&](std::size_t a) { return s.v[a][i]; });
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

// The velocity u (m/s) relative to the body, of a particle that lies on it or has been put back and risen by that (m).
template <int D>
void leave(double gravity, bool lies, double risen, const solids::point<D>& normal, solids::point<D>& u) {
  if (lies) {
    if (const double outwards = foundation::dot(u, normal); outwards < 0.0) u -= outwards * normal;
    return;
  }
  turn_back(normal, u);
  pay_for_rise<D>(gravity, risen, normal, u);
}

// Which body the surface at x belongs to: the one that moves, or the nearest that does not; the tank is behind them.
template <int D>
std::size_t number_of_body(const bodies<D>& set, const moving_body<D>* moving, const solids::point<D>& x) {
  if (moving != nullptr) return moving->body;
  std::size_t nearest = set.given.size();
  if (!set.counts_impacts) return nearest;
  double least = 1e-6 * set.spacing();  // what is not on a body is on a side
  for (std::size_t b = 0; b < set.given.size(); ++b)
    if (const double away = std::abs(set.given[b].level(x)); set.mover_of[b] == moving_body<D>::none && away < least) {
      least = away;
      nearest = b;
    }
  return nearest;
}

// Of the particle i, which had that velocity, at the surface of a body.
template <int D>
void count_impact(bodies<D>& set, std::size_t i, std::size_t body, const solids::point<D>& x,
                  const solids::point<D>& before, double risen) {
  const auto& s = set.state.w.s;
  const auto after = velocity_of<D>(s, i), change = after - before;
  set.impacts.push_back({body, x, set.image_at(body, x), s.m[i] * change});
  set.energy_of_impacts.push_back(s.m[i] *
                                  (0.5 * foundation::dot(change, after + before) + set.contact.gravity * risen));
}

// About which axes a body does not turn: one that runs through periodic sides turns about their axis alone.
template <int D>
std::array<bool, solids::rigid<D>::turns> held_turns(const bodies<D>& set, std::size_t body) {
  std::array<bool, solids::rigid<D>::turns> held{};
  const auto& through = set.motions[body].images.through;
  for (std::size_t a = 0; a < D; ++a)
    for (std::size_t k = 0; k < held.size(); ++k) held[k] = held[k] || (through[a] && (D == 2 || k != a));
  return held;
}

// The components in which a free body does not move.
template <int D>
std::array<bool, solids::rigid<D>::components> held_components(const bodies<D>& set, const moving_body<D>& b) {
  auto held = b.free->restrained.held;
  const auto turns = held_turns(set, b.body);
  for (std::size_t k = 0; k < turns.size(); ++k) held[D + k] = held[D + k] || turns[k];
  return held;
}

// A particle that has come to a free body.
template <int D>
struct meeting {
  std::size_t i;
  const moving_body<D>* body;
  bool lies;
  double risen;                                // m
  solids::point<D> velocity, normal, surface;  // m/s; m, where it leaves
};

// N m s: what an impulse gives a free body of angular momentum.
template <int D>
solids::about<D> spin_of(const bodies<D>& set, const moving_body<D>& b, const solids::point<D>& r,
                         const solids::point<D>& impulse) {
  auto spin = solids::moment<D>(r, impulse);
  const auto held = held_components(set, b);
  for (std::size_t k = 0; k < spin.c.size(); ++k)
    if (held[D + k]) spin[k] = 0.0;
  return spin;
}

// N s: that part of an impulse which changes its momentum.
template <int D>
solids::point<D> taken_along(const bodies<D>& set, const moving_body<D>& b, solids::point<D> impulse) {
  const auto held = held_components(set, b);
  for (std::size_t a = 0; a < D; ++a)
    if (held[a]) impulse[a] = 0.0;
  return impulse;
}

// The impulse on a particle that leaves a free body at r from its centre with this change of the relative velocity, and
// its reaction on the body.
template <int D>
solids::point<D> push_apart(const bodies<D>& set, moving_body<D>& b, double mass, const solids::point<D>& r,
                            const solids::point<D>& change) {
  auto pushed = *b.free;
  pushed.angular_momentum = spin_of(set, b, r, change);
  const auto w =
      (1.0 / pushed.mass) * taken_along(set, b, change) + solids::cross<D>(pushed.angular_velocity(b.now.turned), r);
  const double squared = foundation::dot(change, change);
  if (!(squared > 0.0)) return foundation::zero<double, D>();
  const auto impulse = (squared / (squared / mass + foundation::dot(change, w))) * change;
  b.rate.velocity -= (1.0 / pushed.mass) * taken_along(set, b, impulse);
  b.free->angular_momentum -= spin_of(set, b, r, impulse);
  b.rate.angular = b.free->angular_velocity(b.now.turned);
  return impulse;
}

// Rank 0: velocities and spins of free bodies, to the state that is integrated. Then every rank has that. Collective.
template <int D>
void keep_free_velocities(bodies<D>& set) {
  std::size_t n = 0;
  for (const auto& b : set.moving) {
    if (!b.free) continue;
    if (set.state.w.d.ranks.rank == 0) {
      for (std::size_t a = 0; a < D; ++a) set.free.state[D + a][n] = b.rate.velocity[a];
      for (std::size_t a = 0; a < moving_body<D>::turns; ++a)
        set.free.state[2 * D + moving_body<D>::angles + a][n] = b.free->angular_momentum[a] / b.spin_scale();
    }
    ++n;
  }
  take_free_state(set);
}

// Collective. Every rank has all that meet, and computes the same.
template <int D>
void meet_free_bodies(bodies<D>& set, std::vector<meeting<D>> here) {
  auto& s = set.state.w.s;
  const auto& ranks = set.state.w.d.ranks;
  const auto most = static_cast<std::size_t>(ranks.maximum(static_cast<double>(here.size())));
  if (most == 0) return;
  set.pushed_apart = true;
  struct row {
    double id = -1.0, body = 0.0, lies = 0.0, mass = 0.0, risen = 0.0;
    std::array<solids::point<D>, 4> vectors{};  // velocity, normal, surface, image
  };
  constexpr std::size_t width = sizeof(row) / sizeof(double);
  std::vector<row> rows(most);
  for (std::size_t k = 0; k < here.size(); ++k) {
    const auto& m = here[k];
    rows[k] = {static_cast<double>(s.id[m.i]),
               static_cast<double>(m.body - set.moving.data()),
               m.lies ? 1.0 : 0.0,
               s.m[m.i],
               m.risen,
               {m.velocity, m.normal, m.surface, set.image_at(m.body->body, m.surface)}};
  }
  const auto* flat = reinterpret_cast<const double*>(rows.data());
  const auto every = ranks.every(std::span<const double>(flat, width * rows.size()));
  rows.resize(every.size() / width);
  std::memcpy(static_cast<void*>(rows.data()), every.data(), every.size() * sizeof(double));
  std::erase_if(rows, [](const row& r) { return r.id < 0.0; });
  std::ranges::sort(rows, {}, &row::id);
  std::map<double, solids::point<D>> leaving;
  std::map<double, double> of_body;  // J
  for (const auto& m : rows) {
    auto& b = set.moving[static_cast<std::size_t>(m.body)];
    const auto& [velocity, normal, surface, image] = m.vectors;
    const auto before = b.rate.at(surface - image);
    auto u = velocity - before;
    const auto come = u;
    leave<D>(set.contact.gravity, m.lies > 0.0, m.risen, normal, u);
    const auto impulse = push_apart(set, b, m.mass, surface - image - b.rate.centre, u - come);
    leaving[m.id] = velocity + (1.0 / m.mass) * impulse;
    of_body[m.id] = -0.5 * foundation::dot(impulse, before + b.rate.at(surface - image));
  }
  for (const auto& m : here) {
    const auto id = static_cast<double>(s.id[m.i]);
    for (std::size_t a = 0; a < D; ++a) s.v[a][m.i] = leaving.at(id)[a];
    if (!set.counts_impacts) continue;
    count_impact(set, m.i, m.body->body, m.surface, m.velocity, m.risen);
    set.energy_of_impacts.back() += of_body.at(id);
  }
  keep_free_velocities(set);
}

}  // namespace tetsuame::rigid
