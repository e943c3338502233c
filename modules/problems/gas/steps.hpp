// What limits a step: sound and approach, Δt = cfl · 2 Δx_i/max_j(c_i + c_j - 3 min(w_ij, 0)), and what the lists
// cover.
#pragma once

#include <gas/world.hpp>
#include <integrators/explicit_integrator.hpp>

namespace tetsuame::gas {

template <int D>
integrators::step_limit largest_step(const world<D>& g) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < g.w.s.fluid; ++i) {
    const double spacing = g.S[i] / g.support_over_dx, signal = std::max(g.signal[i], 2.0 * g.sound_speed(i));
    least = std::min(least, 2.0 * spacing / signal);
  }
  return {*g.o.common.time.cfl * g.ranks().minimum(least), "sound"};
}

template <int D>
double allowance(const world<D>& g) {
  return 0.5 * (g.skin - g.room_to_grow());
}

// Displacement, or the whole allowance where a support has no more room to grow.
template <int D>
double moved(world<D>& g) {
  double growth = 0.0;
  for (std::size_t i = 0; i < g.w.s.fluid; ++i) growth = std::max(growth, g.support()[i] - g.list_support()[i]);
  const bool no_room = growth >= g.room_to_grow() * (1.0 - 1e-9);
  return no_room ? std::max(run::moved_since_lists(g), allowance(g)) : run::moved_since_lists(g);
}

}  // namespace tetsuame::gas
