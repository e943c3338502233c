// Levels: the run may start with coarser lattices; each one's steady flow is interpolated to the next.
#pragma once

#include <convection/measures.hpp>
#include <convection/state.hpp>

namespace tetsuame::convection {

// A particle of the finer lattice: T beyond its reference and the other unknowns.
template <int D>
struct finer_particle {
  std::int64_t id;
  std::array<double, D> x;
  std::array<double, unknown<D>::count_with_z> f;
};

// Those of this rank's cell. Ghosts and images are those of the state.
template <int D>
std::vector<finer_particle<D>> interpolate_state(convection_state<D>& state) {
  auto& w = state.world.w;
  const auto& s = w.s;
  particles::array excess(s.total());
  for (std::size_t i = 0; i < s.total(); ++i) excess[i] = s.T[i] - reference_temperature(state.layer, s.x[1][i]);
  std::array<const double*, unknown<D>::count_with_z> f;
  f.fill(excess.data());
  std::ranges::copy(unknown_arrays(state), f.begin());
  f[unknown<D>::T] = excess.data();
  const interpolation<D> at(s, w.support());
  std::vector<finer_particle<D>> finer;
  const auto n = particles_of_level(state.input, state.at_start.level - 1);
  for_each_place(state.world, n, 0.5 * w.dx, [&](std::int64_t id, const std::array<double, D>& x) {
    if (const auto found = at(x, f))
      finer.push_back({id, x, *found});
    else
      w.first_fault.report(id, "too few particles are near a place of the finer lattice");
  });
  w.agree();
  return finer;
}

// Each rank where its particles stood; rebuild hands them on where the finer cells differ.
template <int D>
void go_to_next_level(convection_state<D>& state) {
  const auto finer = interpolate_state(state);
  lay(state, state.at_start.level - 1);
  auto& s = state.fluid();
  run::make_room(s, finer.size());  // where cuts have moved, others than the lattice's in this cell
  forget(state);
  for (std::size_t i = 0; i < finer.size(); ++i) {
    const auto& [id, x, f] = finer[i];
    s.id[i] = id;
    s.material[i] = 0;
    for (std::size_t a = 0; a < D; ++a) {
      s.x[a][i] = x[a];
      s.v[a][i] = f[a];
      if (state.layer.relaxed) state.z[a][i] = f[unknown<D>::z + a];
    }
    s.T[i] = reference_temperature(state.layer, x[1]) + f[unknown<D>::T];
    state.p[i] = f[unknown<D>::p];
  }
  remove_mean(state, state.p.data());
}

}  // namespace tetsuame::convection
