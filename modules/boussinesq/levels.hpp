// Levels: the run may start with coarser lattices; each one's steady flow is interpolated to the next.
#pragma once

#include <boussinesq/measures.hpp>
#include <boussinesq/state.hpp>

namespace tetsuame::boussinesq {

// T beyond its reference and the other unknowns, at the places of the finer lattice in this rank's cell.
template <int D>
struct interpolated {
  std::vector<std::int64_t> ids;
  std::vector<std::array<double, D>> places;
  std::vector<std::array<double, unknown<D>::count_with_z>> values;
};

// Ghosts and images are those of the state.
template <int D>
interpolated<D> interpolate_state(convection_state<D>& state) {
  auto& w = state.world.w;
  const auto& s = w.s;
  particles::array excess(s.total());
  for (std::size_t i = 0; i < s.total(); ++i) excess[i] = s.T[i] - reference_temperature(state.layer, s.x[1][i]);
  const auto now = unknown_arrays(state);
  std::array<const double*, unknown<D>::count_with_z> f;
  f.fill(excess.data());
  std::ranges::copy(now, f.begin());
  f[unknown<D>::T] = excess.data();
  const interpolation<D> at(s, w.support());
  interpolated<D> finer;
  const auto n = particles_of_level(state.input, state.at_start.level - 1);
  for_each_place(state.world, n, 0.5 * w.dx, [&](std::int64_t id, const std::array<double, D>& x) {
    finer.ids.push_back(id);
    finer.places.push_back(x);
    finer.values.emplace_back();
    if (const auto found = at(x, f))
      finer.values.back() = *found;
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
  particles::allocate(s, finer.ids.size(), 0, 0, 0);
  for (std::size_t i = 0; i < finer.ids.size(); ++i) {
    s.id[i] = finer.ids[i];
    s.material[i] = 0;
    for (std::size_t a = 0; a < D; ++a) {
      s.x[a][i] = finer.places[i][a];
      s.v[a][i] = finer.values[i][a];
      if (state.layer.relaxed) state.z[a][i] = finer.values[i][unknown<D>::z + a];
    }
    s.T[i] = reference_temperature(state.layer, finer.places[i][1]) + finer.values[i][unknown<D>::T];
    state.p[i] = finer.values[i][unknown<D>::p];
  }
  remove_mean(state, state.p.data());
}

}  // namespace tetsuame::boussinesq
