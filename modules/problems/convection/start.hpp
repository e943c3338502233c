// Temperatures of the start, K.
#pragma once

#include <convection/state.hpp>

namespace tetsuame::convection {

// Of the difference in temperature, of the particle of that ID.
inline double random_temperature(const initial_options& o, std::int64_t id) {
  if (o.temperature_noise == 0.0) return 0.0;
  return o.temperature_noise * run::random_of_particle(id, o.noise_seed).between_minus_1_and_1();
}

// Of conduction, with the disturbance of &initial.
template <int D>
double start_temperature(const convection_state<D>& state, std::size_t i) {
  const auto& s = state.fluid();
  const auto& o = state.input;
  const auto& layer = state.layer;
  const std::size_t along = layer.heat_axis, across = 1 - along;
  const double x = s.x[along][i], dT = layer.fluid.dT;
  const double conducted = along == 1 ? reference_temperature(layer, x)
                                      : layer.T_bottom + layer.heat_sign * dT * (0.5 - x / layer.heat_length);
  return conducted +
         o.initial.perturbation * dT *
             std::cos(static_cast<double>(o.initial.half_waves) * std::numbers::pi * s.x[across][i] /
                      o.domain.length[across]) *
             std::sin(std::numbers::pi * x / layer.heat_length) +
         random_temperature(o.initial, s.id[i]) * dT;
}

// Collective. Temperatures of &region.
template <int D>
void warm_regions(convection_state<D>& state) {
  auto& s = state.fluid();
  regions::apply(state.ranks(), state.layer.regions, s,
                 [&](std::size_t i, const regions::values& v) { s.T[i] = v.temperature.value_or(s.T[i]); });
}

}  // namespace tetsuame::convection
