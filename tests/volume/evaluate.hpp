// The stages of an evaluation that find Y, in the right-hand side's order.
#pragma once

#include <volume/smoothed.hpp>

#include "../support/scene.hpp"

namespace tetsuame::test {

template <class Pressure, class Volume, int D>
void evaluate(hydrostatic::scene<D>& scene, Volume& how, const volume::smoothing_options& smoothing = {}) {
  auto& w = scene.w;
  w.first_fault = {};
  const volume::wall_context<D> around{scene.treatment, scene.walls, smoothing};
  if constexpr (volume::works_ahead<Volume>) {
    how.ahead(w);
    how.with_ghosts(w);
  } else {
    how.before_walls(w, around);
  }
  w.agree();
  if constexpr (volume::works_ahead<Volume>) {
    Pressure::sum_apart(w, around, true);
    Pressure::with_kinematics(w, around);
    around.weights(w);
    Pressure::sum_apart(w, around, false);
    Pressure::add_walls(w, around);
    Pressure::begin(w);
    Pressure::end(w);
  } else {
    std::visit([&](auto t) { t.kinematics(w, scene.walls); }, scene.treatment);
    how.template determine<Pressure>(w, around);
  }
  w.agree();
  std::visit([&](auto t) { t.pressures(w, scene.walls); }, scene.treatment);
}

// The state's ghosts as the time integration would have them.
template <int D>
void refresh(hydrostatic::scene<D>& scene) {
  auto& w = scene.w;
  for (auto& component : w.s.v) w.exchange_fluid({component.data()});
  w.exchange_fluid({w.s.T.data(), w.s.rho.data(), w.s.Y.data()});
}

}  // namespace tetsuame::test
