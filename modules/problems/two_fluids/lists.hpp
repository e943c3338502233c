// Neighbour lists of two fluids, and what of a particle stays while they hold: transport coefficients, supports.
#pragma once

#include <run/supports.hpp>
#include <two_fluids/supports.hpp>

namespace tetsuame::two_fluids {

template <int D>
void make_lists(fluids<D>& f, bool as_they_were) {
  auto& w = f.world.w;
  auto& s = w.s;
  if (f.follows)
    run::rebuild_with_supports(f.world, as_they_were, f.support(), f.list_support());
  else
    run::rebuild(f.world, as_they_were);
  w.exchange_fluid({s.m.data()});
  for (std::size_t i = 0; i < s.total(); ++i) {
    s.eta[i] = f.o.material[static_cast<std::size_t>(s.material[i])].viscosity;
    s.k[i] = f.o.conductivity;
  }
  for (auto* all : f.scratch())
    if (all->size() < s.total() + 1) all->resize(s.total() + 1);
  if (f.tense)
    for (std::size_t i = 0; i < s.total(); ++i) f.metal[i] = f.is_metal(i) ? 1.0 : 0.0;
  f.stress[s.null()] = f.factor[s.null()] = f.squared_volume[s.null()] = 0.0;
  f.partition[s.null()] = 1.0;
  if (f.follows) take_supports(f);
}

// Those of the start lattice are not yet the displaced particles'.
template <int D>
void settle_supports(fluids<D>& f) {
  for (int round = 0; round < 5; ++round) {
    if (!f.carried) count_neighbours(f);
    follow_volumes(f);
  }
}

}  // namespace tetsuame::two_fluids
