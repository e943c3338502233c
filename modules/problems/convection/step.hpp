// What a step begins with: what its sums lag behind (docs/theory/convection.md, "What lags"), how fast particles are,
// and the viscosity that binds it.
#pragma once

#include <convection/mirror.hpp>

namespace tetsuame::convection {

// (G(v) + G(v)ᵀ - D(v))·∇ln ν, 1/(m s). With ∇²v it is the divergence of 2 ν (e - ½ ∇·v) over ν, e the rate of strain:
// a stress that takes energy from compression too (in 2-D), where that of ∇·v = 0 alone would feed it.
template <int D>
void complete_viscous_terms(convection_state<D>& state) {
  auto& latest = state.last.latest;
  const auto& G = latest.gradient;
  const auto& slope = state.last.log_slope;
  foundation::for_all(state.fluid().fluid, [&](std::size_t i) {
    for (std::size_t a = 0; a < D; ++a) {
      double stress = 0.0;
      for (std::size_t b = 0; b < D; ++b) stress += (G[a][b][i] + G[b][a][i]) * slope[b][i] - G[b][b][i] * slope[a][i];
      latest.stress[a][i] = stress;
    }
    if (latest.viscosity == nullptr) return;
    const double nu = state.viscosity(i);
    for (std::size_t a = 0; a < D; ++a) latest.force[a][i] = nu * state.last.plain_viscous[a][i];
    (*latest.viscosity)[i] = nu;
  });
}

// Of what the last evaluation summed; extrapolated by half a step, as long as the one before.
template <int D>
void keep_lagged_terms(convection_state<D>& state) {
  if (state.layer.law.varies) complete_viscous_terms(state);
  const auto& latest = state.last.latest.all;
  const double onwards = state.has_before ? 0.5 : 0.0;
  for (std::size_t k = 0; k < latest.size(); ++k) {
    const auto& now = *latest[k];
    auto& kept = *state.lagged.all[k];
    foundation::for_all(state.fluid().fluid, [&](std::size_t i) { kept[i] = now[i]; });
    if (!state.before) continue;
    auto& earlier = *state.before->all[k];
    foundation::for_all(state.fluid().fluid, [&](std::size_t i) {
      kept[i] += onwards * (now[i] - earlier[i]);
      earlier[i] = now[i];
    });
  }
  state.has_before = state.before.has_value();
  refresh_lagged_terms(state);
}

template <int D>
void begin_step(convection_state<D>& state) {
  keep_lagged_terms(state);
  auto& start = state.start;
  start.v_max = fastest_flow(state);
  start.faster = start.v_max > 0.0 ? std::max(1.0, state.ranks().maximum(state.displacing) / start.v_max) : 1.5;
  if (!state.layer.steady || !state.layer.law.varies) return;  // inertia does not go with ν
  const auto largest = [&](const particles::array& a) {
    return state.ranks().maximum(foundation::largest_of(state.fluid().fluid, 1.0, [&](std::size_t i) { return a[i]; }));
  };
  start.viscous_contrast = largest(state.last.contrast[0]);
  start.sound_contrast = std::sqrt(largest(state.last.contrast[1]));
}

// m2/s, what the step is bound by, slowed. Where viscosity varies, compression is damped three times as strongly as
// shear.
template <int D>
double largest_viscosity(const convection_state<D>& state) {
  const auto& layer = state.layer;
  const double xi2 = layer.slowing.xi * layer.slowing.xi;
  if (layer.steady) return (layer.law.varies ? 3.0 : 1.0) * layer.instant_share * layer.nu_eff;
  if (!layer.law.varies) return std::max(layer.nu, layer.fluid.nu) / xi2;
  const double nu = foundation::largest_of(state.fluid().fluid, 0.0, [&](std::size_t i) { return state.viscosity(i); });
  return 3.0 * state.ranks().maximum(nu) / xi2;
}

}  // namespace tetsuame::convection
