// Levels: the run may start with coarser lattices; each one's steady flow is interpolated to the next.
#pragma once

#include <convection/measures.hpp>
#include <convection/state.hpp>

namespace tetsuame::convection {

// Each rank lays the particles of the finer lattice where its own stood; rebuild hands them on where the finer cells
// differ. What is interpolated of T is what it has beyond its reference.
template <int D>
void go_to_next_level(convection_state<D>& state) {
  constexpr std::size_t K = unknown<D>::count_with_z;
  auto& w = state.world.w;
  auto& s = w.s;
  particles::array excess(s.total());
  for (std::size_t i = 0; i < s.total(); ++i) excess[i] = s.T[i] - reference_temperature(state.layer, s.x[1][i]);
  auto f = unknown_arrays(state);
  std::array<const double*, K> coarse;
  coarse.fill(excess.data());
  std::ranges::copy(f, coarse.begin());
  coarse[unknown<D>::T] = excess.data();
  struct particle {
    std::int64_t id;
    std::array<double, D> x;
    std::array<double, K> f;
  };
  std::vector<particle> finer;
  const interpolation<D> at(s, w.support());
  const auto n = particles_of_level(state.input, state.at_start.level - 1);
  for_each_place(state.world, n, 0.5 * w.dx, [&](std::int64_t id, const std::array<double, D>& x) {
    if (const auto found = at(x, coarse))
      finer.push_back({id, x, *found});
    else
      w.first_fault.report(id, "too few particles are near a place of the finer lattice");
  });
  w.agree();
  lay(state, state.at_start.level - 1);
  run::make_room(s, finer.size());  // where cuts have moved, others than the lattice's in this cell
  forget(state);
  f = unknown_arrays(state);
  for (std::size_t i = 0; i < finer.size(); ++i) {
    s.id[i] = finer[i].id;
    s.material[i] = 0;
    for (std::size_t a = 0; a < D; ++a) s.x[a][i] = finer[i].x[a];
    for (std::size_t k = 0; k < f.size(); ++k) f[k][i] = finer[i].f[k];
    s.T[i] = reference_temperature(state.layer, s.x[1][i]) + s.T[i];
  }
  remove_mean(state, state.p.data());
}

}  // namespace tetsuame::convection
