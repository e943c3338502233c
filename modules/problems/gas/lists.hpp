// Neighbour lists of particles whose supports are their own, ghosts, images, and what these take from their sources.
#pragma once

#include <gas/world.hpp>

namespace tetsuame::gas {

// The next step of Newton's method, by no more than the lists allow. S is what the sums take.
template <int D>
void next_supports(world<D>& g) {
  const double target = std::pow(g.support_over_dx, D);
  foundation::for_all(g.w.s.fluid, [&](std::size_t i) {
    const double S = g.support[i], next = schemes::next_support(S, g.count[i], g.count_slope[i], target);
    if (g.lists_follow) g.support_growth[i] = next - S;
    g.support[i] = std::min({next, g.list_support[i], g.largest_support});
    g.S[i] = g.support[i];
  });
}

// weight = 'power': one pass towards y_i = p_i^ζ with w = p^ζ V, V = w/y and p = (γ - 1) m u/V. A disturbance of wave
// number k of ln w is multiplied by (1 - ζ)(1 - S(k)), S the kernel's transfer function: it converges for every
// 0 < ζ <= 1.
template <int D>
void next_weights(world<D>& g) {
  const double exponent = g.o.shock.exponent;
  foundation::for_all(g.w.s.fluid,
                      [&](std::size_t i) { g.power_weight[i] *= std::pow(g.power_pressure(i), exponent) / g.y[i]; });
}

// What ghosts and images keep while the lists live.
template <int D>
void refresh_constants(world<D>& g) {
  auto& s = g.w.s;
  for (std::size_t i = 0; i < s.fluid; ++i) std::tie(g.gamma[i], g.stiffness[i]) = gas_of(g, s.material[i]);
  g.gamma[s.null()] = g.o.shock.gamma;
  const bool two = g.any_eos || gas_of(g, 0) != gas_of(g, 1);
  for (std::size_t i = 0; i < s.fluid; ++i) g.kind[i] = two ? s.material[i] : 0;
  walls::update_ghosts_and_images(g.w, g.walls, walls::even({&s.m, &g.start_volume, &g.gamma, &g.stiffness, &g.kind}));
  if (!g.viscosities_differ) return;
  for (std::size_t i = 0; i < s.fluid; ++i) s.eta[i] = g.largest_viscosity_of(s.material[i]);
  walls::update_ghosts_and_images(g.w, g.walls, walls::even({&s.eta}));
}

// m, what the lists cover.
template <int D>
double allowance(const world<D>& g) {
  return 0.5 * (g.skin - g.room_to_grow());
}

template <int D>
run::growing_supports supports(world<D>& g) {
  return {g.support_over_dx, g.support,         g.list_support,
          g.room_to_grow(),  g.largest_support, g.lists_follow ? &g.support_growth : nullptr};
}

// With supports of the particles' own.
template <int D>
void make_lists(world<D>& g, bool as_they_were) {
  auto& s = g.w.s;
  run::rebuild_with_supports(g, as_they_were, supports(g), g.lists_follow ? &g.motion : nullptr, allowance(g));
  const foundation::stage timed(g.w.times, "lists");
  particles::clear_derived(s);
  refresh_constants(g);
  std::copy_n(g.support.begin(), s.fluid, g.S.begin());
}

// Displacement, or the whole allowance where a support has no more room to grow.
template <int D>
run::apart moved(world<D>& g) {
  run::apart all;
  if (g.list_lifetime > 0.0) {
    all = run::ranges_used(g, g.motion, allowance(g));
  } else {
    all = run::moved_since_lists(g);
    if (run::drifted(g, all.numbers[run::apart::longest])) all.numbers[run::apart::at_least] = allowance(g);
  }
  if (supports(g).have_no_room(g.w.s.fluid))
    all.numbers[run::apart::at_least] = std::max(all.numbers[run::apart::at_least], allowance(g));
  return all;
}

// m/s
template <int D>
run::apart speed(const world<D>& g) {
  return g.list_lifetime > 0.0 ? run::speeds_of_use(g, g.motion, allowance(g)) : run::velocities(g);
}

}  // namespace tetsuame::gas
